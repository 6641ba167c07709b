// Small charts by step: slopes and intercepts shrink, errors fall, bits and cost add up.

const CHART = { height: 118, left: 46, right: 8, top: 8, bottom: 20 };

/** What is charted of missions, each with the text that tells its value at a step; `of` a front, of a line, or of both. */
const CHARTS = [
  {
    of: true,
    title: () => 'Half-width of the front (90 %); dashed: how far off it is, m',
    isLogarithmic: true,
    line: (scene) => scene.front?.half_width,
    dashed: (scene) => scene.front?.off,
    told: ({ front }) => (front ? [front.half_width, front.off].filter((it) => it != null).map(small).join('; ') : 'not known'),
  },
  {
    of: false,
    title: (flight) => (flight.labels_err ? 'Slopes of the 90 % set, deg' : 'Slopes left, deg'),
    bars: (scene) => scene.slopes,
    rule: (flight) => flight.truth?.angle,
    dot: (scene) => scene.estimate?.angle,
    told: (scene) => scene.slopes.map(([low, high]) => `${figure(low, 2)} to ${figure(high, 2)}`).join(' or '),
  },
  {
    of: false,
    title: (flight) => (flight.labels_err ? 'Intercepts of the 90 % set, m' : 'Intercepts left, m'),
    bars: (scene) => (scene.intercepts ? [scene.intercepts] : [[-Infinity, Infinity]]),
    rule: (flight) => flight.truth?.intercept,
    dot: (scene) => scene.estimate?.intercept,
    told: (scene) => (scene.intercepts ? `${figure(scene.intercepts[0], 2)} to ${figure(scene.intercepts[1], 2)}` : 'unbounded'),
  },
  {
    of: false,
    title: (flight) => `Estimate off the ${flight.truth || flight.boundary.length === 0 ? 'truth' : 'best line'}, deg`,
    isLogarithmic: true,
    line: (scene) => scene.estimate?.off_deg,
    told: (scene) => (scene.estimate?.off_deg == null ? 'none' : small(scene.estimate.off_deg)),
  },
  {
    of: false,
    title: () => 'Area misjudged, %',
    isLogarithmic: true,
    line: (scene) => (scene.estimate?.misclassified == null ? null : 100 * scene.estimate.misclassified),
    told: (scene) => (scene.estimate?.misclassified == null ? 'none' : small(100 * scene.estimate.misclassified)),
  },
  {
    of: false,
    title: () => 'Bits told; dashed: expected',
    line: (scene) => scene.bits,
    dashed: (scene) => scene.expected_bits,
    told: (scene) => `${figure(scene.bits, 2)}; ${figure(scene.expected_bits, 2)}`,
  },
  {
    title: () => 'Control cost so far',
    line: (scene) => scene.cost,
    told: (scene) => figure(scene.cost, 1),
  },
];

/** The values that a chart has to show of some missions; on a logarithmic scale their logarithms. */
function domain(chart, flights) {
  const values = flights.flatMap((flight) => [
    chart.rule?.(flight),
    ...flight.scenes.flatMap((scene) => [
      ...(chart.bars?.(scene).flat() ?? []),
      chart.line?.(scene),
      chart.dashed?.(scene),
    ]),
  ]);
  const shown = values.map((it) => scaled(chart, it)).filter((it) => it != null && Number.isFinite(it));
  if (shown.length === 0) return [0, 1];
  const least = chart.isLogarithmic || chart.bars ? Math.min(...shown) : Math.min(0, ...shown);
  const most = Math.max(...shown);
  return most > least ? [least, most] : [least - 0.5, most + 0.5];
}

function scaled(chart, value) {
  if (value == null) return null;
  return chart.isLogarithmic ? (value > 0 ? Math.log10(value) : null) : value;
}

/** Draws a chart of a mission; `range` and `steps` are those of all that stand beside it. */
function drawChart(svg, chart, flight, step, range, steps, width) {
  const { height, left, right, top, bottom } = CHART;
  blank(svg, width, height);
  const across = linear([0, steps], [left + 4, width - right - 4]);
  const up = linear(range, [height - bottom, top]);
  const limited = (value) => Math.min(height - bottom, Math.max(top, up(value)));
  drawScales(svg, chart, range, steps, across, up, width);
  add(svg, 'path', { class: 'axis', d: through([[across(step), top], [across(step), height - bottom]]) });
  const breadth = Math.max(1.5, Math.min(9, (across(1) - across(0)) * 0.6));
  for (const [number, scene] of flight.scenes.entries()) {
    const when = number === step ? ' now' : number > step ? ' later' : '';
    for (const [low, high] of chart.bars?.(scene) ?? []) {
      const y = limited(high);
      const length = Math.max(1.5, limited(low) - y);
      add(svg, 'rect', { class: `bar${when}`, x: across(number) - breadth / 2, y, width: breadth, height: length });
    }
  }
  if (chart.rule?.(flight) != null) {
    const y = up(chart.rule(flight));
    add(svg, 'path', { class: 'truth', d: through([[left, y], [width - right, y]]) });
  }
  for (const [number, scene] of flight.scenes.entries()) {
    const when = number === step ? ' now' : number > step ? ' later' : '';
    const dot = chart.dot?.(scene);
    if (dot != null && dot >= range[0] && dot <= range[1]) {
      add(svg, 'circle', { class: `dot${when}`, cx: across(number), cy: up(dot), r: number === step ? 3.5 : 2.2 });
    }
  }
  for (const [kind, of] of [['dashed', chart.dashed], ['line', chart.line]]) {
    if (!of) continue;
    const points = flight.scenes.flatMap((scene, number) => {
      const value = scaled(chart, of(scene));
      return value == null ? [] : [{ number, pixel: [across(number), up(value)] }];
    });
    // It has a gap where there is no value. Of length 0, a value between two gaps is a dot.
    const begin = (number, before) => (before?.number === number - 1 ? 'L' : 'M');
    const pixels = (those) => those.map(({ number, pixel: [x, y] }, k) => `${begin(number, those[k - 1])}${x.toFixed(1)} ${y.toFixed(1)}h0`).join('');
    add(svg, 'path', { class: `${kind} later`, d: pixels(points.filter((it) => it.number >= step)) });
    add(svg, 'path', { class: kind, d: pixels(points.filter((it) => it.number <= step)) });
    const now = points.find((it) => it.number === step);
    if (now && kind === 'line') add(svg, 'circle', { class: 'dot now', cx: now.pixel[0], cy: now.pixel[1], r: 3.5 });
  }
}

function drawScales(svg, chart, range, steps, across, up, width) {
  const { height, left, right, top, bottom } = CHART;
  const values = chart.isLogarithmic ? wholes(range) : ticks(range[0], range[1], 3);
  const step = values.length > 1 ? values[1] - values[0] : 1;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  for (const value of values) {
    const y = up(value);
    const text = chart.isLogarithmic ? small(10 ** value) : figure(value, decimals);
    add(svg, 'path', { class: 'grid', d: through([[left, y], [width - right, y]]) });
    add(svg, 'text', { class: 'tick', x: left - 5, y: y + 4, 'text-anchor': 'end' }, text);
  }
  for (const number of ticks(0, steps, Math.min(steps, 5)).filter(Number.isInteger)) {
    add(svg, 'text', { class: 'tick', x: across(number), y: height - 5, 'text-anchor': 'middle' }, String(number));
  }
  add(svg, 'path', { class: 'axis', d: through([[left, top], [left, height - bottom], [width - right, height - bottom]]) });
}

/** Round sizes in a range of logarithms, as logarithms: four or so. */
function wholes([from, to]) {
  const sizes = to - from < 1.5 ? [1, 2, 5] : [1];
  const all = [];
  for (let k = Math.floor(from); k <= to; k += 1) all.push(...sizes.map((size) => k + Math.log10(size)));
  const within = all.filter((it) => it >= from && it <= to);
  const every = Math.ceil(within.length / 4) || 1;
  return within.length > 0 ? within.filter((_, k) => k % every === 0) : [from, to];
}

/** The step that a place on a chart stands for. */
function stepAt(svg, clientX, steps) {
  const box = svg.getBoundingClientRect();
  const x = ((clientX - box.left) / box.width) * svg.viewBox.baseVal.width;
  const { left, right } = CHART;
  const share = (x - left - 4) / (svg.viewBox.baseVal.width - left - right - 8);
  return Math.max(0, Math.min(steps, Math.round(share * steps)));
}
