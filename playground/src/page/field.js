// The field: what is true, drawn with mouse, finger or keys.

const FINGER = matchMedia('(pointer: coarse)');

/** An editor over a drawing. `made` returns what is made, `seen` the boundary that the
 *  simulator has seen, `changed` is told of another, `done` when a hand is lifted. */
function editor(svg, { made, changed, done, seen }) {
  let view = null;
  let drag = null;
  /** The point that gets the focus when it is drawn anew, if it is another. */
  let wanted = null;

  /** Points that can be moved, with their names. */
  const handles = () => {
    const { kind, points, start } = made();
    const names = {
      line: ['Left end of the line', 'Right end of the line'],
      circle: ['Middle of the circle', 'Rim of the circle'],
    }[kind];
    const word = kind === 'shape' ? 'Corner' : 'Point';
    const own = kind === 'coast' || made().raster !== null ? [] : points.map((at, k) => ({ key: String(k), at, name: names?.[k] ?? `${word} ${k + 1} of ${points.length}` }));
    return [...own, { key: 'start', at: start, name: 'Where the robot starts' }];
  };

  /** The nearest place of the field. */
  const within = ([x, z]) => {
    const { left, bottom, width, height } = ground(made());
    return [Math.min(left + width, Math.max(left, x)), Math.min(bottom + height, Math.max(bottom, z))].map(tidy);
  };

  const moved = (key, at) => {
    const old = made();
    if (key === 'start') return changed({ ...old, start: within(at) }, key);
    const points = [...old.points];
    points[Number(key)] = within(at);
    // A circle moves as a whole by its middle.
    if (old.kind === 'circle' && key === '0') points[1] = points[1].map((it, k) => tidy(it + points[0][k] - old.points[0][k]));
    return changed({ ...old, points });
  };

  const place = (event) => {
    const box = svg.getBoundingClientRect();
    const { left, top, scale } = view;
    const x = ((event.clientX - box.left) * svg.viewBox.baseVal.width) / box.width;
    const y = ((event.clientY - box.top) * svg.viewBox.baseVal.height) / box.height;
    return [ground(made()).left + (x - left) / scale, ground(made()).bottom + ground(made()).height - (y - top) / scale];
  };

  /** What a stroke over the field draws. */
  const drawn = (all) => {
    const old = made();
    const { width, height } = ground(old);
    const way = all.map(within);
    const [first, last] = [way[0], way.at(-1)];
    const far = Math.max(...way.map(([x, z]) => Math.hypot(x - first[0], z - first[1])));
    if (far < 0.05 * Math.max(width, height)) return;
    const round = (all) => all.map((at) => at.map(tidy));
    const points = {
      line: () => [first, last].sort((p, q) => p[0] - q[0]),
      circle: () => [first, last],
      bend: () => thinned(first[0] <= last[0] ? way : way.reverse(), width / 100, 30),
      shape: () => thinned(way, width / 100, 40),
      coast: () => [],
    }[old.kind]();
    const fewest = old.kind === 'shape' ? 3 : 2;
    if (points.length >= fewest) changed({ ...old, points: round(points) });
  };

  svg.addEventListener('pointerdown', (event) => {
    if (event.button !== 0 || drag !== null) return;
    const handle = event.target.closest('[data-key]');
    if (handle === null && (made().kind === 'coast' || made().raster !== null)) return;
    drag = { key: handle?.dataset.key ?? null, way: [place(event)], id: event.pointerId, before: made() };
    svg.setPointerCapture(event.pointerId);
    handle?.focus({ preventScroll: true });
    event.preventDefault();
  });
  svg.addEventListener('pointermove', (event) => {
    if (drag?.id !== event.pointerId) return;
    if (drag.key !== null) return moved(drag.key, place(event));
    drag.way.push(place(event));
    drawn(drag.way);
  });
  const lifted = (event) => {
    if (drag?.id !== event.pointerId) return;
    const { key, before } = drag;
    drag = null;
    if (made() !== before) done(true, key === null && event.pointerType === 'touch' ? before : null);
  };
  svg.addEventListener('pointerup', lifted);
  svg.addEventListener('pointercancel', lifted);

  const WAYS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] };
  svg.addEventListener('keydown', (event) => {
    const key = event.target.closest('[data-key]')?.dataset.key;
    if (key === undefined || event.altKey || event.ctrlKey || event.metaKey) return;
    const old = made();
    const { width, height } = ground(old);
    const way = WAYS[event.key];
    const isMany = old.kind === 'bend' || old.kind === 'shape';
    if (way) {
      const step = Math.max(width, height) / (event.shiftKey ? 400 : 40);
      const { at } = handles().find((it) => it.key === key);
      moved(key, [at[0] + way[0] * step, at[1] + way[1] * step]);
    } else if (event.key === 'Insert' && isMany && key !== 'start') {
      const k = Number(key);
      const isLast = old.kind === 'bend' && k === old.points.length - 1;
      const [from, to] = isLast ? [k - 1, k] : [k, (k + 1) % old.points.length];
      const middle = [0, 1].map((axis) => tidy((old.points[from][axis] + old.points[to][axis]) / 2));
      changed({ ...old, points: old.points.toSpliced(from + 1, 0, middle) });
    } else if (event.key === 'Delete' && isMany && key !== 'start' && old.points.length > (old.kind === 'shape' ? 3 : 2)) {
      wanted = String(Math.max(0, Number(key) - 1));
      changed({ ...old, points: old.points.toSpliced(Number(key), 1) });
    } else return;
    event.preventDefault();
    event.stopPropagation();
    done(false);
  });

  /** Draws all of it anew; whatever had the focus keeps it. */
  const draw = () => {
    const state = made();
    const field = ground(state);
    const width = Math.max(200, Math.floor(svg.getBoundingClientRect().width));
    const most = innerWidth < 640 ? 0.62 * width : 300;
    const margin = { left: 30, right: 8, top: 8, bottom: 20 };
    const scale = Math.min((width - margin.left - margin.right) / field.width, most / field.height);
    const left = margin.left + (width - margin.left - margin.right - scale * field.width) / 2;
    view = { left, top: margin.top, scale };
    const at = ([x, z]) => [left + scale * (x - field.left), margin.top + scale * (field.bottom + field.height - z)];
    const focused = svg.contains(document.activeElement) ? (wanted ?? document.activeElement.dataset.key) : null;
    wanted = null;
    blank(svg, width, Math.ceil(margin.top + scale * field.height + margin.bottom));
    const corner = { x: left, y: margin.top, width: scale * field.width, height: scale * field.height };
    add(svg, 'rect', { class: 'area border', ...corner });
    const clip = add(add(svg, 'clipPath', { id: 'within' }), 'rect', corner).parentNode;
    const inner = add(svg, 'g', { 'clip-path': `url(#${clip.id})` });
    for (const x of ticks(field.left, field.left + field.width, 5)) {
      const [px] = at([x, 0]);
      add(svg, 'text', { class: 'tick', x: px, y: margin.top + scale * field.height + 14, 'text-anchor': px > width - 16 ? 'end' : 'middle' }, figure(x, 0));
    }
    for (const z of ticks(field.bottom, field.bottom + field.height, 5)) {
      add(svg, 'text', { class: 'tick', x: left - 4, y: at([0, z])[1] + 4, 'text-anchor': 'end' }, figure(z, 0));
    }
    if (field.rings.length > 0) {
      const land = [[[field.left, field.bottom], [field.left + field.width, field.bottom], [field.left + field.width, field.bottom + field.height], [field.left, field.bottom + field.height]], ...field.rings];
      add(inner, 'path', { class: 'keep-out', 'fill-rule': 'evenodd', d: land.map((ring) => through(ring.map(at), true)).join('') });
    }
    truthOn(inner, state, at, seen());
    for (const [x, z, label] of known(state)) symbol(svg, at([x, z]), label, 5);
    for (const { key, at: where, name } of handles()) {
      const [x, y] = at(where);
      const words = `${name}: x ${figure(where[0], 2)}, z ${figure(where[1], 2)} metres`;
      const handle = add(svg, 'g', { class: `handle ${key === 'start' ? 'of-robot' : ''}`, 'data-key': key, tabindex: 0, role: 'button', 'aria-label': words, 'aria-describedby': 'handle-keys', transform: `translate(${x.toFixed(1)} ${y.toFixed(1)})` });
      const isSmall = state.points.length > 12 && key !== 'start';
      // The grip is hardly larger than its picture, so a stroke can begin beside it.
      add(handle, 'circle', { class: 'reach', r: FINGER.matches ? (isSmall ? 8 : 11) : isSmall ? 6 : 9 });
      if (key === 'start') {
        add(handle, 'circle', { class: 'halo', r: 8 });
        add(handle, 'path', { class: 'bow', d: 'M8 -4L16 0L8 4Z' });
      } else add(handle, 'circle', { class: 'grip', r: isSmall ? 4 : 7 });
      if (key === focused) handle.focus({ preventScroll: true });
    }
  };
  return { draw };
}

/** The boundary as it is drawn, and the ground on its +1 side. */
function truthOn(svg, state, at, seen) {
  const { kind, points } = state;
  const { left, bottom, width, height } = ground(state);
  if (kind === 'coast' || state.raster !== null) {
    for (const way of seen) add(svg, 'path', { class: 'truth', d: through(way.map(at)) });
    return;
  }
  if (kind === 'circle') {
    const [cx, cy] = at(points[0]);
    const [rx, ry] = at(points[1]);
    add(svg, 'circle', { class: 'certain above', cx, cy, r: Math.hypot(rx - cx, ry - cy) });
    add(svg, 'circle', { class: 'truth', cx, cy, r: Math.hypot(rx - cx, ry - cy) });
    return;
  }
  const far = 100 * Math.max(width, height);
  const sorted = kind === 'shape' ? points : fromLeft(points);
  const beyond = ([px, pz], [qx, qz]) => {
    const length = Math.hypot(px - qx, pz - qz) || 1;
    return [px + ((px - qx) / length) * far, pz + ((pz - qz) / length) * far];
  };
  const whole = kind === 'shape' ? sorted : [beyond(sorted[0], sorted[1]), ...sorted, beyond(sorted.at(-1), sorted.at(-2))];
  // Corners far away close it counter-clockwise. Its ends may lie above or below the field.
  const above = kind === 'shape' ? whole : [...whole, [2 * far, whole.at(-1)[1]], [2 * far, 2 * far], [-2 * far, 2 * far], [-2 * far, whole[0][1]]];
  add(svg, 'path', { class: 'certain above', d: through(above.map(at), true) });
  add(svg, 'path', { class: 'truth', d: through(whole.map(at), kind === 'shape') });
}
