// The map of a mission: ground, lines, path and labels at a step.

/** The rectangle around some places. */
function around(places) {
  const bounds = { left: Infinity, right: -Infinity, bottom: Infinity, top: -Infinity };
  for (const [x, z] of places) {
    Object.assign(bounds, { left: Math.min(bounds.left, x), right: Math.max(bounds.right, x) });
    Object.assign(bounds, { bottom: Math.min(bounds.bottom, z), top: Math.max(bounds.top, z) });
  }
  return bounds;
}

/** The places of a scene that a map has to show. */
function placesOf({ at, motion, front }) {
  return [at, ...(motion?.way ?? []), ...(front?.ends ?? [])];
}

/**
 * What a map shows: the area, or of a front the track alone if that is small. While a track grows it gets more room, and
 * all of the area until the front is found.
 */
function shown(flight) {
  const longest = (it) => Math.max(it.right - it.left, it.top - it.bottom);
  const area = around(flight.area);
  const isSought = flight.isGrowing && !flight.scenes.some((it) => it.front);
  if (!flight.follows || isSought) return { bounds: area, isPart: false };
  const part = around([...flight.scenes.flatMap(placesOf), ...flight.given.map(([at]) => at)]);
  const size = flight.isGrowing ? Math.max(1.5 * longest(part), longest(area) / 8) : longest(part);
  if (size === 0 || size > 0.5 * longest(area)) return { bounds: area, isPart: false };
  const grown = (from, to) => {
    const half = Math.max(to - from, 0.4 * size) / 2 + 0.1 * size;
    return [(from + to) / 2 - half, (from + to) / 2 + half];
  };
  const [[left, right], [bottom, top]] = [grown(part.left, part.right), grown(part.bottom, part.top)];
  return { bounds: { left, right, bottom, top }, isPart: true };
}

/** Adds a scene to a mission that goes on. The part that its map shows stays as it is while the track is in it. */
function addScene(flight, scene) {
  flight.scenes.push(scene);
  const { bounds: { left, right, bottom, top }, isPart } = (flight.shown ??= shown(flight));
  const isIn = ([x, z]) => x >= left && x <= right && z >= bottom && z <= top;
  if (!isPart || !placesOf(scene).every(isIn)) flight.shown = undefined;
}

/** Where places lie on a drawing this wide. On a phone ticks are within the map, which fills the width. */
function layout({ left, right, bottom, top }, width) {
  const isNarrow = innerWidth < 640 && !PAPER.matches;
  const margin = { left: isNarrow ? 1 : 38, right: isNarrow ? 1 : 12, top: 22, bottom: 34 };
  // What is above the map leaves so much of the window.
  const most = Math.max(240, Math.min(620, width, PAPER.matches ? 620 : innerHeight - 330));
  const room = width - margin.left - margin.right;
  const scale = Math.min(room / (right - left), most / (top - bottom));
  const shift = margin.left + (room - scale * (right - left)) / 2;
  const height = margin.top + scale * (top - bottom) + margin.bottom;
  return {
    bounds: { left, right, bottom, top },
    isNarrow,
    height: Math.ceil(height),
    at: ([x, z]) => [shift + scale * (x - left), margin.top + scale * (top - z)],
  };
}

/** Draws a mission as it was after some step; `from` is the step that was shown before. */
function drawMap(svg, flight, step, width, from) {
  flight.shown ??= shown(flight);
  const { bounds, isPart } = flight.shown;
  const view = layout(bounds, width);
  const { at } = view;
  const ring = (places) => through(places.map(at), true);
  const sheet = blank(svg, width, view.height);
  const scene = flight.scenes[step];
  const past = flight.scenes.slice(0, step + 1);

  add(svg, 'path', { class: 'area', d: ring(flight.area) });
  drawGround(svg, scene.ground, at);
  if (isPart) svg = field(svg, view);
  drawAxes(sheet, view, width);
  const front = mapOf(flight, step);
  drawFront(svg, front, at);
  const shores = flight.shores ?? [];
  if (shores.length > 0) add(svg, 'path', { class: 'keep-out', 'fill-rule': 'evenodd', d: [flight.area, ...shores].map(ring).join('') });
  for (const keepOut of flight.keep_outs) add(svg, 'path', { class: 'keep-out', d: ring(keepOut) });
  add(svg, 'path', { class: 'border', d: ring(flight.area) });
  if (!flight.follows) drawTruth(svg, flight, scene, at);
  if (scene.estimate) add(svg, 'path', { class: 'estimate', d: through(scene.estimate.ends.map(at)) });

  // Along a front labels lie close together: small, few, and below the path and the map, which they must not hide.
  if (flight.follows) drawMarks(svg, past, at, true);
  const way = past.flatMap((it) => (it.motion ? it.motion.way : [it.at]));
  add(svg, 'path', { class: 'path', d: through(way.map(at)) });
  if (scene.motion) {
    const legs = [flight.scenes[step - 1].at, ...scene.motion.way];
    add(svg, 'path', { class: 'leg', d: through(legs.map(at)) });
    if (scene.motion.target) cross(svg, at(scene.motion.target), 'target');
  }
  for (const [number, [place, label]] of flight.given.entries()) {
    const [x, y] = at(place);
    symbol(svg, [x, y], label, 6.5);
    const isRight = x > width - 40;
    add(svg, 'text', { class: 'name', x: x + (isRight ? -10 : 10), y: y + (y < 26 ? 16 : -7), 'text-anchor': isRight ? 'end' : 'start' }, `p${number + 1}`);
  }
  if (!flight.follows) drawMarks(svg, past, at, false);
  for (const piece of front) add(svg, 'path', { class: 'estimate', d: through(piece.map((it) => at(it.at))) });
  if (flight.follows) drawTruth(svg, flight, scene, at);
  drawRobot(svg, flight, step, at, from);
  if (isPart) drawInset(sheet, flight, view);
}

/** The true boundary. If it moves, the scene has where it is. */
function drawTruth(svg, { boundary }, scene, at) {
  const draw = (ways, { stroke }) => ways.forEach((way) => add(svg, 'path', { class: stroke.class, d: through(way.map(at)) }));
  for (const it of boundary) draw(it.ways, it);
  if (scene.boundary) draw(scene.boundary, boundary.at(-1));
}

/** What was read. Of a front one mark of a kind in each cell of some pixels is enough. */
function drawMarks(svg, scenes, at, follows) {
  const [size, about] = follows ? [2.4, 4.2] : [4.5, 9];
  const taken = new Set();
  const hasSpace = ([x, y], kind, cell) => {
    const key = `${kind} ${Math.floor(x / cell)} ${Math.floor(y / cell)}`;
    return !follows || !(taken.has(key) || !taken.add(key));
  };
  for (const { motion, at: place } of scenes) {
    if (!motion) continue;
    const spot = at(place);
    const { label, truly, is_wrong, sought } = motion;
    if (truly && hasSpace(spot, 'truly', 12)) {
      add(svg, 'path', { class: 'slip', d: through([spot, at(truly)]) });
      cross(svg, at(truly), 'truly');
    }
    if (label === null) {
      if (!follows) add(svg, 'circle', { class: 'unread', cx: spot[0], cy: spot[1], r: size - 1 });
    } else if (hasSpace(spot, sought ? `sought ${label}` : label, 8)) {
      symbol(svg, spot, label, size).classList.toggle('sought', Boolean(sought));
    }
    if (is_wrong && hasSpace(spot, 'wrong', 16)) add(svg, 'circle', { class: 'wrong', cx: spot[0], cy: spot[1], r: about });
  }
}

/** A part of a drawing at which what is drawn there is cut off. */
function field(svg, { bounds: { left, right, bottom, top }, at }) {
  const [[x, y], [end, base]] = [at([left, top]), at([right, bottom])];
  add(svg, 'rect', { class: 'area border', x, y, width: end - x, height: base - y });
  return add(svg, 'svg', { x, y, width: end - x, height: base - y, viewBox: `${x} ${y} ${end - x} ${base - y}` });
}

/** All of the area in a corner that the track leaves free, and the part of it that the map shows. */
function drawInset(svg, flight, { bounds, at, isNarrow }) {
  const area = around(flight.area);
  const scale = (isNarrow ? 60 : 90) / Math.max(area.right - area.left, area.top - area.bottom);
  const [wide, high] = [scale * (area.right - area.left), scale * (area.top - area.bottom)];
  const [[x, y], [end, base]] = [at([bounds.left, bounds.top]), at([bounds.right, bounds.bottom])];
  // The name of a given point is to its right, above it.
  const given = flight.given.map(([place]) => at(place)).flatMap(([gx, gy]) => [[gx, gy], [gx + 16, gy - 12]]);
  const spots = [...flight.scenes.map((it) => at(it.at)), ...given];
  const hidden = ([left, top]) => spots.filter(([sx, sy]) => sx > left - 4 && sx < left + wide + 4 && sy > top - 4 && sy < top + high + 4).length;
  const corners = [[end - wide - 8, y + 8], [end - wide - 8, base - high - 8], [x + 8, y + 8], [x + 8, base - high - 8]];
  const [left, top] = corners.reduce((best, it) => (hidden(it) < hidden(best) ? it : best));
  const spot = ([px, pz]) => [left + scale * (px - area.left), top + scale * (area.top - pz)];
  add(svg, 'path', { class: 'area border', d: through(flight.area.map(spot), true) });
  // The map may show ground beyond the border.
  const within = ([px, pz]) => [Math.min(Math.max(px, area.left), area.right), Math.min(Math.max(pz, area.bottom), area.top)];
  const part = [[bounds.left, bounds.top], [bounds.right, bounds.top], [bounds.right, bounds.bottom], [bounds.left, bounds.bottom]].map(within);
  add(svg, 'path', { class: 'inset', d: through(part.map(spot), true) });
}

/**
 * The map of a front after a step, by its pieces. What the robot has passed since the last place of the map is shown as it
 * was known then: the map may drop it. At the end the map is whole.
 */
function mapOf({ scenes, rest, isGrowing }, step) {
  const isEnd = step === scenes.length - 1 && !isGrowing;
  const places = scenes.slice(0, step + 1).flatMap((it) => it.mapped ?? []).concat((isEnd && rest) || []);
  const pieces = [];
  for (const place of places) {
    if (place.begins) pieces.push([]);
    pieces.at(-1).push(place);
  }
  if (isEnd && places.length > 0) return pieces;
  let last = places.at(-1);
  for (const { front } of scenes.slice((last?.passed ?? 0) + 1, step + 1)) {
    if (front) last ? pieces.at(-1).push(front) : pieces.push([front]);
    last = front;
  }
  return pieces;
}

/** Where a front lies with a probability of 90 %, from each place of its map to the next. */
function drawFront(svg, pieces, at) {
  for (const piece of pieces) {
    const [first] = piece;
    for (const [k, { ends }] of piece.entries()) {
      const { ends: before } = k > 0 ? piece[k - 1] : first;
      add(svg, 'path', { class: 'front', d: through([before[0], ends[0], ends[1], before[1]].map(at), true) });
    }
  }
}

function drawGround(svg, ground, at) {
  if (ground.certain) {
    for (const [k, sign] of ['+1', '\u22121'].entries()) {
      const corners = ground.certain[k].map(at);
      if (corners.length < 3) continue;
      add(svg, 'path', { class: k === 0 ? 'certain above' : 'certain below', d: through(corners, true) });
      const middle = [0, 1].map((i) => corners.reduce((sum, it) => sum + it[i], 0) / corners.length);
      const spread = Math.max(...corners.map((it) => it[1])) - Math.min(...corners.map((it) => it[1]));
      if (spread > 60) {
        add(svg, 'text', { class: k === 0 ? 'region above' : 'region below', x: middle[0], y: middle[1] + 8 }, sign);
      }
    }
  }
  // Each band lies within the one before it, so shades add up.
  for (const { rings } of ground.bands ?? []) {
    add(svg, 'path', { class: 'band', d: rings.map((ring) => through(ring.map(at), true)).join('') });
  }
}

function drawAxes(svg, view, width) {
  const { left, right, bottom, top } = view.bounds;
  const { at } = view;
  const [, base] = at([left, bottom]);
  for (const x of ticks(left, right, Math.max(2, Math.min(10, width / 70)))) {
    const [px, py] = at([x, top]);
    add(svg, 'path', { class: 'grid', d: through([[px, py], [px, base]]) });
    const anchor = px > width - 16 ? 'end' : px < 16 ? 'start' : 'middle';
    add(svg, 'text', { class: 'tick', x: px, y: base + 15, 'text-anchor': anchor }, figure(x, x % 1 ? 1 : 0));
  }
  for (const z of ticks(bottom, top, Math.max(2, Math.min(10, view.height / 60)))) {
    const [px, py] = at([left, z]);
    add(svg, 'path', { class: 'grid', d: through([[px, py], at([right, z])]) });
    const [, peak] = at([left, top]);
    if (view.isNarrow && (py > base - 8 || py < peak + 14)) continue;
    const place = view.isNarrow ? { x: px + 3, y: py - 3 } : { x: px - 6, y: py + 4, 'text-anchor': 'end' };
    add(svg, 'text', { class: 'tick', ...place }, figure(z, z % 1 ? 1 : 0));
  }
  const [end] = at([right, bottom]);
  add(svg, 'text', { class: 'tick', x: end, y: base + 29, 'text-anchor': 'end' }, 'x, m');
  const [start, peak] = at([left, top]);
  const name = view.isNarrow ? { x: start + 3 } : { x: start - 6, 'text-anchor': 'end' };
  add(svg, 'text', { class: 'tick', ...name, y: peak - 8 }, 'z, m');
}

/** A label's symbol: a disc for +1, a square for -1, a diamond on the line itself. */
function symbol(svg, [x, y], label, size) {
  if (label > 0) return add(svg, 'circle', { class: 'mark above', cx: x, cy: y, r: size });
  if (label < 0) {
    const side = 1.8 * size;
    return add(svg, 'rect', { class: 'mark below', x: x - side / 2, y: y - side / 2, width: side, height: side });
  }
  const diamond = [[x - size, y], [x, y - size], [x + size, y], [x, y + size]];
  return add(svg, 'path', { class: 'mark on-line', d: through(diamond, true) });
}

function cross(svg, [x, y], name) {
  const d = `M${x - 4} ${y - 4}l8 8M${x - 4} ${y + 4}l8 -8`;
  add(svg, 'path', { class: name, d });
}

/** The robot with its heading. One step on it travels there, unless whoever looks wants no motion. */
function drawRobot(svg, flight, step, at, from) {
  const { at: place, heading, motion } = flight.scenes[step];
  const [x, y] = at(place);
  const turn = (-heading * 180) / Math.PI;
  const robot = add(svg, 'g', { class: 'robot' });
  const pose = ([px, py]) => `translate(${px}px, ${py}px) rotate(${turn}deg)`;
  robot.style.transform = pose([x, y]);
  add(robot, 'circle', { class: 'halo', r: 11 });
  add(robot, 'path', { class: 'bow', d: 'M11 -4.5L20 0L11 4.5Z' });
  const isStill = matchMedia('(prefers-reduced-motion: reduce)').matches;
  if (motion && from === step - 1 && !isStill) {
    const way = [flight.scenes[from].at, ...motion.way];
    robot.animate(way.map((it) => ({ transform: pose(at(it)) })), { duration: 350, easing: 'ease-in-out' });
  }
}
