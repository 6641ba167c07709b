// What was made, as a plain object; as a scenario file; as the end of a link.

/** The boundaries that can be drawn, and what each begins with. Places are shares of the field. */
const KINDS = {
  line: { name: 'Line', hint: 'Drag across the field to draw another line, or move its two ends.', size: '20 x 20', points: [[0.05, 0.23], [0.95, 0.56]] },
  bend: { name: 'Bend', hint: 'Drag from left to right to draw another coast, or move its points.', size: '100 x 80', points: [[0, 0.3], [0.25, 0.62], [0.5, 0.5], [0.72, 0.7], [1, 0.45]] },
  circle: { name: 'Circle', hint: 'Drag from the middle to the rim to draw another spill, or move both.', size: '100 x 80', points: [[0.6, 0.56], [0.75, 0.56]] },
  shape: { name: 'Shape', hint: 'Drag all the way round a shape to draw it, or move its corners.', size: '100 x 80', points: [[0.42, 0.4], [0.62, 0.35], [0.8, 0.5], [0.74, 0.72], [0.6, 0.68], [0.52, 0.8], [0.4, 0.66]] },
  coast: { name: 'Random coast', hint: 'A random coast: you draw nothing. Run with another random seed for another one.', size: '100 x 80', points: [] },
};
const PLANNERS = [['lookahead', 'Look-ahead: a line'], ['cfc', 'Algorithm 1: a line'], ['scc', 'Algorithm 2: a line'], ['track', 'Track: a front'], ['lawnmower', 'Parallel tracks'], ['random', 'A random walk']];
const VEHICLES = [['unicycle', 'Rover'], ['boat', 'Boat'], ['car', 'Car']];
const SENSORS = [['1', 'never wrong'], ['0.98', 'wrong 2 % of the time'], ['0.95', 'wrong 5 % of the time'], ['0.9', 'wrong 10 % of the time'], ['0.8', 'wrong 20 % of the time']];
const SIZES = ['20 x 20', '50 x 50', '100 x 80', '200 x 150', '800 x 500'];
/** Where the four labels are known, and where the robot begins. */
const TOLD = [[0.1, 0.05], [0.1, 0.4], [0.9, 0.8], [0.9, 0.25]];
const START = [0.1, 0.05];

/** Planners of straight lines alone, and planners whose vehicle must turn on the spot. */
const OF_LINES = ['lookahead', 'cfc', 'scc'];
const HEEDLESS = ['lawnmower', 'random'];

/** What one begins with who chooses a boundary to draw. */
function begun(kind, seed = 1, size = KINDS[kind].size) {
  const { points } = KINDS[kind];
  const isLine = kind === 'line';
  const field = ground({ size, map: null });
  return { kind, size, points: places(field, points), start: places(field, [START])[0], told: isLine, moves: false, vehicle: 'unicycle', p: isLine ? '1' : '0.95', planner: isLine ? 'lookahead' : 'track', seed, map: null, raster: null, text: null };
}

/** What the form calls a value. */
function called(all, value) {
  return all.find(([own]) => own === value)[1];
}

/** The same drawing in a field of another size. An image fills the field; a grid stays where it is. */
function resized(state, size) {
  const [from, to] = [ground(state), ground({ ...state, size })];
  const [wide, high] = [to.width / from.width, to.height / from.height];
  const scaled = ([x, z]) => [tidy(x * wide), tidy(z * high)];
  const stretched = (grid) => grid.replace(/^dx (\S+)\ndy (\S+)$/m, (_, dx, dy) => `dx ${Number(dx) * wide}\ndy ${Number(dy) * high}`);
  const raster = state.raster?.isImage ? { ...state.raster, grid: stretched(state.raster.grid) } : state.raster;
  return { ...state, size, raster, points: state.points.map(scaled), start: scaled(state.start) };
}

/** Whether its planner finds straight lines alone, and its boundary is none. */
function isForLines(state) {
  return OF_LINES.includes(state.planner) && (state.kind !== 'line' || isHidden(state));
}

/** What the bar says of what another boundary brings with it. */
const BROUGHT = {
  planner: (it) => `the planner is ${called(PLANNERS, it)}`,
  vehicle: (it) => `the vehicle is a ${called(VEHICLES, it)}`,
  p: (it) => `the sensor is ${called(SENSORS, it)}`,
  size: (it) => `the field is ${it} m`,
  told: (it) => (it ? 'four labels are known' : 'no label is known'),
};

/** A state that the simulator can fly, and what had to change for it: names and words. The user set `last` last. */
function allowed(state, last) {
  const changed = [];
  let { planner, vehicle } = state;
  if (state.moves && (last === 'moves' || last === 'kind') && planner !== 'track') {
    planner = 'track';
    changed.push(['planner', 'the planner is Track, which follows a boundary that moves']);
  } else if (last === 'kind' && isForLines(state)) {
    planner = 'track';
    changed.push(['planner', 'the planner is Track, as this boundary is no straight line']);
  }
  if (planner === 'lawnmower' && state.map !== null) {
    planner = 'track';
    changed.push(['planner', 'the planner is Track, as parallel tracks go straight across a field without land']);
  }
  if (HEEDLESS.includes(planner) && vehicle !== 'unicycle') {
    if (last === 'vehicle') {
      planner = state.kind === 'line' && !isHidden(state) && !state.moves ? 'lookahead' : 'track';
      changed.push(['planner', `the planner is ${called(PLANNERS, planner)}, as the one before needs a vehicle that turns on the spot`]);
    } else {
      vehicle = 'unicycle';
      changed.push(['vehicle', 'the vehicle is a Rover, as this planner needs one that turns on the spot']);
    }
  }
  return { state: { ...state, planner, vehicle }, changed };
}

/** Another boundary. It keeps what the user has `set`, and returns what else changed: names and words. */
function turned(old, next, set) {
  const [from, to] = [ground(old), ground(next)];
  const values = ['planner', 'vehicle', 'p', 'told', 'moves'].filter((it) => set.has(it)).map((it) => [it, old[it]]);
  const start = [tidy(((old.start[0] - from.left) * to.width) / from.width), tidy(((old.start[1] - from.bottom) * to.height) / from.height)];
  const staying = set.has('start') && old.map === null && next.map === null ? { start } : {};
  const { state, changed } = allowed({ ...next, ...Object.fromEntries(values), ...staying }, 'kind');
  if (next.map !== null) changed.push(['start', 'the robot starts in the water'], ['size', 'the field is that of the file']);
  if (old.told && !isHidden(old) && isHidden(state)) changed.push(['told', 'no label is known, as only the simulator knows these sides']);
  for (const [name, words] of Object.entries(BROUGHT)) {
    if (old[name] !== state[name] && !changed.some(([it]) => it === name)) changed.push([name, words(state[name])]);
  }
  return { state, changed };
}

/** Whether another seed changes the mission. */
function isRandom({ p, planner, kind, map, raster, text }) {
  return text !== null || p !== '1' || planner === 'random' || (kind === 'coast' && map === null && raster === null);
}

/** The same with another seed. The user's own text keeps all else. */
function reseeded(state) {
  const seed = state.seed + 1;
  if (state.text === null) return { ...state, seed };
  const line = /^seed\s*=.*$/m;
  const text = line.test(state.text) ? state.text.replace(line, (it) => `seed = ${(Number(it.match(/\d+/)?.[0]) || 0) + 1}`) : `seed = ${seed}\n${state.text}`;
  return { ...state, seed, text };
}

/** Where a field lies, metres; of a map also its rings, and the latitude and longitude of the origin. */
function ground({ size, map }) {
  if (map !== null) return mapped(map);
  const [width, height] = size.split(' x ').map(Number);
  return { left: 0, bottom: 0, width, height, rings: [], origin: null };
}

/** Shares of a field as metres. */
function places({ left, bottom, width, height }, shares) {
  return shares.map(([x, z]) => [tidy(left + x * width), tidy(bottom + z * height)]);
}

const UNREADABLE = 'This is no GeoJSON, PNG or ASCII grid.';

/** The rings of all polygons of a GeoJSON file. */
function rings(text) {
  const found = [];
  const take = (it) => {
    if (Array.isArray(it)) it.forEach(take);
    else if (it?.type === 'Polygon') found.push(...it.coordinates);
    else if (it?.type === 'MultiPolygon') found.push(...it.coordinates.flat());
    else take(it?.features ?? it?.geometries ?? it?.geometry ?? []);
  };
  let read = null;
  try {
    read = JSON.parse(text);
  } catch {
    throw new Error(UNREADABLE);
  }
  take(read);
  const isPlace = (it) => Array.isArray(it) && it.length > 1 && it.slice(0, 2).every(Number.isFinite);
  if (found.length === 0 || !found.every((ring) => Array.isArray(ring) && ring.length > 2 && ring.every(isPlace))) {
    throw new Error('found no polygon, expected a GeoJSON file with a Polygon or MultiPolygon');
  }
  return found.map((ring) => ring.map(([x, z]) => [x, z]));
}

const METRES_A_DEGREE = 111_195;

/** Rings in latitude and longitude as metres about their middle, as the simulator counts them. */
function mapped(text) {
  if (mapped.text === text) return mapped.ground;
  const all = rings(text);
  const bounds = around(all.flat());
  const round = (it) => Math.round(it * 1e4) / 1e4;
  const origin = [round((bounds.top + bounds.bottom) / 2), round((bounds.left + bounds.right) / 2)];
  const metres = ([lon, lat]) => [(lon - origin[1]) * METRES_A_DEGREE * Math.cos((origin[0] * Math.PI) / 180), (lat - origin[0]) * METRES_A_DEGREE];
  const own = all.map((ring) => ring.map(metres));
  const { left, right, bottom, top } = around(own.flat());
  mapped.text = text;
  mapped.ground = { left, bottom, width: right - left, height: top - bottom, rings: own, origin };
  return mapped.ground;
}

/** In the water of a map: the place with the most room, that room, and a place to start from, far off. */
function afloat({ left, bottom, width, height, rings: shores }) {
  const sides = shores.flatMap((ring) => ring.map((from, k) => [from, ring[(k + 1) % ring.length]]));
  const off = ([x, z]) => Math.min(...sides.map(([[px, pz], [qx, qz]]) => {
    const square = (qx - px) ** 2 + (qz - pz) ** 2 || 1;
    const along = Math.min(1, Math.max(0, ((x - px) * (qx - px) + (z - pz) * (qz - pz)) / square));
    return Math.hypot(x - px - along * (qx - px), z - pz - along * (qz - pz));
  }));
  const spots = [];
  for (let k = 0; k < 900; k += 1) {
    const at = [left + (width * ((k % 30) + 0.5)) / 30, bottom + (height * (Math.floor(k / 30) + 0.5)) / 30];
    if (shores.filter((ring) => isWithin(ring, at)).length % 2 === 1) spots.push({ at, room: off(at) });
  }
  if (spots.length === 0) throw new Error('found no water, expected an area with some breadth');
  const middle = spots.reduce((best, it) => (it.room > best.room ? it : best));
  const away = ({ at }) => Math.hypot(at[0] - middle.at[0], at[1] - middle.at[1]);
  const roomy = spots.filter((it) => it.room > 0.4 * middle.room);
  const start = roomy.reduce((best, it) => (away(it) > away(best) ? it : best));
  return { middle: middle.at.map(tidy), room: middle.room, start: start.at.map(tidy) };
}

/** A shape from a file as corners in a field, and how many times smaller it is there. Latitude and longitude are brought to
 *  its middle. */
function brought(text, { left, bottom, width, height }) {
  const [longest] = rings(text).sort((a, b) => b.length - a.length);
  const isNear = longest.every(([x, z]) => x >= left && x <= left + width && z >= bottom && z <= bottom + height);
  const isGlobe = longest.every(([x, z]) => Math.abs(x) <= 180 && Math.abs(z) <= 90);
  const open = longest.filter(([x, z], k) => k === 0 || x !== longest[0][0] || z !== longest[0][1]);
  if (isNear && !(isGlobe && longest.some(([x, z]) => x % 1 && z % 1))) return { points: thinned(open, 0, 300), smaller: 1 };
  const box = around(open);
  const shrink = isGlobe ? Math.cos((((box.top + box.bottom) / 2) * Math.PI) / 180) : 1;
  const scale = 0.7 * Math.min(width / ((box.right - box.left) * shrink), height / (box.top - box.bottom));
  const middle = [(box.left + box.right) / 2, (box.bottom + box.top) / 2];
  const there = ([x, z]) => [tidy(left + width / 2 + (x - middle[0]) * shrink * scale), tidy(bottom + height / 2 + (z - middle[1]) * scale)];
  return { points: thinned(open.map(there), width / 400, 120), smaller: (isGlobe ? METRES_A_DEGREE : 1) / scale };
}

/** Fewer points of a way: those within `off` of the rest are left out, and more until there are few enough. */
function thinned(points, off, most) {
  const kept = (from, to) => {
    const [[px, pz], [qx, qz]] = [points[from], points[to]];
    const length = Math.hypot(qx - px, qz - pz) || 1;
    let [furthest, far] = [0, off];
    for (let k = from + 1; k < to; k += 1) {
      const [x, z] = points[k];
      const away = px === qx && pz === qz ? Math.hypot(x - px, z - pz) : Math.abs((qx - px) * (z - pz) - (qz - pz) * (x - px)) / length;
      if (away > far) [furthest, far] = [k, away];
    }
    return furthest === 0 ? [points[from]] : [...kept(from, furthest), ...kept(furthest, to)];
  };
  if (points.length < 3) return points;
  const all = [...kept(0, points.length - 1), points.at(-1)];
  return all.length <= most ? all : thinned(points, 1.5 * off + 1e-3, most);
}

function isWithin(ring, [x, z]) {
  const crossed = ring.filter(([px, pz], k) => {
    const [qx, qz] = ring[(k + 1) % ring.length];
    return pz <= z !== qz <= z && px + ((z - pz) / (qz - pz)) * (qx - px) < x;
  });
  return crossed.length % 2 === 1;
}

/** Metres to the millimetre. */
function tidy(metres) {
  return Math.round(metres * 1000) / 1000;
}

/** Whether only the simulator knows which side a place is on. */
function isHidden({ kind, map, raster }) {
  return map !== null || raster !== null || kind === 'coast';
}

/** Which side a place is on; null where only the simulator knows. */
function side(state, [x, z]) {
  const { kind, points } = state;
  if (isHidden(state)) return null;
  if (kind === 'circle') {
    const [middle, rim] = points;
    return Math.hypot(x - middle[0], z - middle[1]) < Math.hypot(rim[0] - middle[0], rim[1] - middle[1]) ? 1 : -1;
  }
  if (kind === 'shape') return isWithin(points, [x, z]) ? 1 : -1;
  const sorted = fromLeft(points);
  let k = 0;
  while (k < sorted.length - 2 && sorted[k + 1][0] <= x) k += 1;
  const [[px, pz], [qx, qz]] = [sorted[k], sorted[k + 1]];
  return (qx - px) * (z - pz) - (qz - pz) * (x - px) > 0 ? 1 : -1;
}

/** Points from left to right, each further right than the one before. */
function fromLeft(points) {
  const sorted = points.map((it) => [...it]).sort((p, q) => p[0] - q[0]);
  for (let k = 1; k < sorted.length; k += 1) sorted[k][0] = Math.max(sorted[k][0], tidy(sorted[k - 1][0] + 0.01));
  return sorted;
}

/** `A x + B z + C = 0` through the ends of a line, +1 above. */
function coefficients(points) {
  const [[px, pz], [qx, qz]] = fromLeft(points);
  const [a, b] = [pz - qz, qx - px];
  const length = Math.hypot(a, b);
  const round = (it) => Number((it / length).toFixed(6));
  return [round(a), round(b), round(-a * px - b * pz)];
}

/** The keys of the true boundary. */
function truth(state) {
  const { kind, points } = state;
  const pairs = (those) => `[${those.map(([x, z]) => `[${x}, ${z}]`).join(', ')}]`;
  const { width, height } = ground(state);
  const isLine = kind === 'line' && state.raster === null;
  const own = state.raster !== null ? `raster = "${RASTER}", threshold = ${state.raster.threshold}` : {
    line: () => `line = [${coefficients(points).join(', ')}]`,
    bend: () => `polyline = ${pairs(fromLeft(points))}`,
    circle: () => `circle = [${points[0].join(', ')}, ${tidy(Math.hypot(points[1][0] - points[0][0], points[1][1] - points[0][1]))}]`,
    shape: () => `polygon = ${pairs(points)}`,
    coast: () => `coast = { height = ${tidy(height / 10)}, length = ${tidy(width / 5)}, seed = ${state.seed} }`,
  }[kind]();
  const drift = speed(state);
  return state.moves ? `${own}, drift = ${isLine ? `[${drift}, 0]` : `[0, ${drift}]`}` : own;
}

/** How far a boundary moves with each motion, metres. */
function speed(state) {
  return tidy(ground(state).width / 2000);
}

/** Lengths of motions that there are. */
const LENGTHS = 20;

/** The longest motion, metres. */
function reach(state) {
  const { width, height } = ground(state);
  const longer = Math.max(width, height);
  return longer <= 100 ? 2 : tidy(LENGTHS * tidy(longer / 50 / LENGTHS));
}

function vehicle(state) {
  const longest = reach(state);
  const own = { unicycle: '', boat: ', sharpest = 0.8', car: `, radius = ${tidy(longest / 2)}` }[state.vehicle];
  return `{ kind = "${state.vehicle}", reach = ${longest}, step = ${tidy(longest / LENGTHS)}${own} }`;
}

/** The places whose labels are known, with them. */
function known(state) {
  if (!state.told) return [];
  return places(ground(state), TOLD).map((at) => [...at, side(state, at)]).filter((it) => it[2] !== null);
}

/** The names of the map and of the raster in a scenario. */
const MAP = 'area.geojson';
const RASTER = 'truth.asc';

/** The files beside a scenario. */
function files({ map, raster }) {
  return { ...(map === null ? {} : { [MAP]: map }), ...(raster === null ? {} : { [RASTER]: raster.grid }) };
}

/** The most cells of an image along a side. */
const MOST_CELLS = 160;

/** An image as a grid over a field: the luminance of its cells, 0 to 255. */
async function gridded(file, { left, bottom, width, height }) {
  const image = await createImageBitmap(file).catch(() => {
    throw new Error(UNREADABLE);
  });
  const scale = Math.min(1, MOST_CELLS / Math.max(image.width, image.height));
  const [columns, rows] = [image.width, image.height].map((it) => Math.max(2, Math.round(it * scale)));
  const sheet = new OffscreenCanvas(columns, rows).getContext('2d');
  sheet.drawImage(image, 0, 0, columns, rows);
  const { data } = sheet.getImageData(0, 0, columns, rows);
  const cell = (k) => Math.round(0.2126 * data[4 * k] + 0.7152 * data[4 * k + 1] + 0.0722 * data[4 * k + 2]);
  const line = (row) => Array.from({ length: columns }, (_, column) => cell(row * columns + column)).join(' ');
  const head = `ncols ${columns}\nnrows ${rows}\nxllcorner ${left}\nyllcorner ${bottom}\ndx ${width / columns}\ndy ${height / rows}\n`;
  return `${head}${Array.from({ length: rows }, (_, row) => line(row)).join('\n')}\n`;
}

/** The labels that a planner holds where they may be wrong. */
const ROOM = 68;

/** The scenario file. */
function toml(state) {
  if (state.text !== null) return state.text;
  const isSure = state.p === '1';
  const { width, height, origin } = ground(state);
  const follows = state.planner === 'track';
  const isSpill = state.kind === 'circle' || state.kind === 'shape';
  const given = known(state);
  const [x, z] = state.start;
  const degrees = () => [origin[0] + z / METRES_A_DEGREE, origin[1] + x / METRES_A_DEGREE / Math.cos((origin[0] * Math.PI) / 180)].map((it) => it.toFixed(6));
  const lines = [
    '# Save this as scenario.toml, and run it: host-sim run scenario.toml --figure scenario.svg',
    `algorithm = "${state.planner}"`,
    `steps = ${follows ? 600 : state.planner !== 'lawnmower' ? 60 : isSure ? 200 : ROOM - given.length}`,
    `seed = ${state.seed}`,
    state.map !== null ? `area = { geojson = "${MAP}" }` : `area = { x = [0, ${width}], z = [0, ${height}] }`,
    `vehicle = ${vehicle(state)}`,
    ...(isSure ? [] : [`noise = { p = ${state.p} }   # a label is true with this probability`]),
    ...(state.planner === 'lookahead' ? [`stop = { slope_arc_deg = ${isSure ? 0.5 : 5} }   # it is enough to know the slope so well`] : []),
    ...(follows && state.moves ? [`front = { speed = ${speed(state)} }   # how far the front may move in a step`] : []),
    ...(follows && given.length === 0 ? [`seek = { likely = "${isSpill ? 'spill' : 'coast'}" }`] : []),
    state.map !== null ? `start = { lat = ${degrees()[0]}, lon = ${degrees()[1]} }` : `start = { x = ${x}, z = ${z} }`,
    given.length === 0 ? 'oracle = []   # no label is known' : `oracle = [\n${given.map(([px, pz, label]) => `  { x = ${px}, z = ${pz}, label = ${label} },\n`).join('')}]`,
    `truth = { ${truth(state)} }   # the planner is not told`,
  ];
  return `${lines.join('\n')}\n`;
}

/** The end of a link: all of it, compressed. */
async function linked(state) {
  const packed = new Blob([JSON.stringify(state)]).stream().pipeThrough(new CompressionStream('deflate-raw'));
  const bytes = new Uint8Array(await new Response(packed).arrayBuffer());
  const text = btoa(Array.from(bytes, (it) => String.fromCharCode(it)).join(''));
  return `#${text.replaceAll('+', '-').replaceAll('/', '_').replaceAll('=', '')}`;
}

/** What the end of a link holds; null if it is none of ours. */
async function unlinked(hash) {
  try {
    const text = atob(hash.slice(1).replaceAll('-', '+').replaceAll('_', '/'));
    const bytes = Uint8Array.from(text, (it) => it.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate-raw'));
    return checked(JSON.parse(await new Response(stream).text()));
  } catch {
    return null;
  }
}

/** Somebody else wrote it: only what this page could have made is taken. */
function checked(found) {
  const isPlace = (it) => Array.isArray(it) && it.length === 2 && it.every(Number.isFinite);
  const among = (all, it) => all.some(([own]) => own === it);
  const { kind, size, points, start, told, moves, vehicle: drives, p, planner, seed, map, raster, text } = found;
  const isText = (it) => it === null || (typeof it === 'string' && it.length < 2_000_000);
  const isRaster = raster === null || (isText(raster.grid) && Number.isFinite(raster.threshold));
  const isSound =
    Object.hasOwn(KINDS, kind) && SIZES.includes(size) && Array.isArray(points) && points.length <= 500 && points.every(isPlace) && isPlace(start) &&
    points.length >= { line: 2, bend: 2, circle: 2, shape: 3, coast: 0 }[kind] && among(VEHICLES, drives) && among(SENSORS, p) && among(PLANNERS, planner) &&
    Number.isSafeInteger(seed) && seed >= 0 && isText(map) && isText(text) && isRaster;
  if (!isSound) return null;
  if (map !== null) mapped(map);
  return { kind, size, points, start, told: told === true, moves: moves === true, vehicle: drives, p, planner, seed, map, raster: raster && { grid: raster.grid, threshold: raster.threshold, isImage: raster.isImage === true }, text };
}
