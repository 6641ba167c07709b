// The page: one step for all missions that are shown, and what changes with it.

const PAGE = JSON.parse(document.getElementById('data').textContent);
const BEAT_MS = 900;
/** A long mission plays faster. */
const WHOLE_MS = 30_000;
const PAPER = matchMedia('print');

const controls = Object.fromEntries(
  ['controls', 'choice', 'chapters', 'first', 'back', 'play', 'next', 'last', 'count', 'slider', 'keys'].map((id) => [id, document.getElementById(id)]),
);
const chapters = PAGE.chapters.map((chapter, number) => stage(chapter, document.getElementById(`chapter-${number}`)));
const state = { chapter: 0, step: 0, timer: null };

/** Builds what a chapter shows; returns how to show a step, how many there are, and how to renew it with more of them. */
function stage({ flights }, section) {
  const place = section.querySelector('.stage');
  place.hidden = false;
  place.classList.toggle('solo', flights.length === 1);
  const table = flights.length > 1 ? sideBySide(place, flights) : null;
  const row = add(place, 'div', { class: 'flights' });
  const follows = flights.every((flight) => flight.follows);
  const charted = CHARTS.filter((chart) => (chart.of ?? follows) === follows);
  const extent = { steps: 0, ranges: [] };
  const views = flights.map((flight, k) => panel(row, flight, charted, extent, `${section.id}-flight-${k}`));
  const renew = () => {
    extent.steps = Math.max(...flights.map((flight) => flight.scenes.length)) - 1;
    extent.ranges = charted.map((chart) => domain(chart, flights));
    for (const view of views) view.renew();
  };
  renew();
  const rows = [...section.querySelectorAll('table.told')];
  let shown = null;
  const show = (step) => {
    for (const view of views) view.show(step, shown);
    table?.(step);
    for (const each of rows) markRow(each, step);
    shown = step;
  };
  const fit = () => shown !== null && views.forEach((view) => view.fit());
  new ResizeObserver(fit).observe(row);
  PAPER.addEventListener('change', fit);
  const quiet = (isQuiet) => views.forEach((view) => view.quiet(isQuiet));
  return { section, flights, show, fit, renew, quiet, get steps() { return extent.steps; } };
}

/** A mission's map, words and charts. */
function panel(row, flight, charted, extent, id) {
  const article = add(row, 'article', { class: 'flight', 'aria-labelledby': id });
  add(article, 'h3', { id }, flight.planner);
  const figure = add(article, 'figure', { class: flight.follows ? 'map follows' : 'map' });
  const map = add(figure, 'svg', { role: 'img' });
  const caption = add(figure, 'figcaption');
  const side = add(article, 'div', { class: 'side' });
  const told = add(side, 'div', { class: 'words', role: 'status', 'aria-live': 'polite' });
  const grid = add(side, 'div', { class: 'charts' });
  const ofLine = 'Bars: what is left; across: the truth; dots: the estimate. ';
  add(grid, 'p', {}, `By step. ${flight.follows ? '' : ofLine}Click to go there.`);
  const charts = charted.map((chart) => {
    const frame = add(grid, 'figure');
    const title = add(frame, 'figcaption');
    add(title, 'span', {}, chart.title(flight));
    const value = add(title, 'output', { 'aria-live': 'off' });
    const svg = add(frame, 'svg', { 'aria-hidden': 'true' });
    svg.addEventListener('click', (event) => go(stepAt(svg, event.clientX, extent.steps)));
    return { chart, svg, value };
  });
  let now = 0;
  const draw = (from) => {
    drawMap(map, flight, now, widthOf(figure), from);
    for (const [k, { chart, svg }] of charts.entries()) {
      drawChart(svg, chart, flight, now, extent.ranges[k], extent.steps, widthOf(svg.parentElement));
    }
  };
  return {
    fit: () => draw(null),
    renew: () => legend(caption, flight),
    quiet: (isQuiet) => told.setAttribute('aria-live', isQuiet ? 'off' : 'polite'),
    show: (step, from) => {
      now = Math.min(step, flight.scenes.length - 1);
      draw(from);
      tell(told, flight, now, step);
      map.setAttribute('aria-label', `Map after step ${now} of ${flight.scenes.length - 1}, ${flight.planner}`);
      for (const { chart, value } of charts) value.textContent = chart.told(flight.scenes[now]);
    },
  };
}

/** The pixels that a drawing has for its width; on paper they are larger, so there are fewer. */
function widthOf(element) {
  if (PAPER.matches) return element.closest('.charts') ? 230 : 400;
  return Math.max(200, Math.floor(element.querySelector(':scope > svg').getBoundingClientRect().width));
}

/** What happened at a step, in words. */
function tell(place, flight, now, step) {
  place.replaceChildren();
  const over = now < step ? ', over' : '';
  add(place, 'h4', {}, now === 0 ? 'Start' : `Step ${now}${over}`);
  const list = add(place, 'dl');
  const isLast = now === flight.scenes.length - 1;
  for (const { of, text } of [...flight.scenes[now].told, ...(isLast ? flight.ended : [])]) {
    const pair = add(list, 'div');
    add(pair, 'dt', {}, of);
    add(pair, 'dd', {}, text);
  }
}

/** What each mark on a map means, of those that are there. */
function legend(caption, flight) {
  caption.replaceChildren();
  const list = add(caption, 'ul', { class: 'legend' });
  const item = (words, draw) => {
    const entry = add(list, 'li');
    draw(add(entry, 'svg', { viewBox: '0 0 26 18', width: 26, height: 18, 'aria-hidden': 'true' }));
    add(entry, 'span', {}, words);
  };
  const motions = flight.scenes.flatMap((scene) => scene.motion ?? []);
  const stroke = (name) => (svg) => add(svg, 'path', { class: name, d: 'M1 9H25' });
  const box = (name) => (svg) => add(svg, 'rect', { class: name, x: 1, y: 1, width: 24, height: 16 });
  const read = motions.filter((it) => !it.sought && it.label);
  if (!flight.follows || read.length > 0) {
    item('label +1', (svg) => symbol(svg, [13, 9], 1, 5));
    item('label \u22121', (svg) => symbol(svg, [13, 9], -1, 5));
  }
  const sought = motions.filter((it) => it.sought && it.label);
  for (const label of [1, -1].filter((it) => sought.some((motion) => motion.label === it))) {
    const words = `label ${label > 0 ? '+1' : '\u22121'}, while the front was sought`;
    item(words, (svg) => symbol(svg, [13, 9], label, 3).classList.add('sought'));
  }
  if (flight.given.length > 0) item('p1, p2, \u2026: given points', (svg) => { symbol(svg, [7, 9], 1, 6); symbol(svg, [20, 9], -1, 6); });
  if (motions.some((it) => it.label === 0)) item('exactly on the line', (svg) => symbol(svg, [13, 9], 0, 5));
  if (motions.some((it) => it.is_wrong)) item('a wrong label', (svg) => add(svg, 'circle', { class: 'wrong', cx: 13, cy: 9, r: 8 }));
  if (!flight.follows && motions.some((it) => it.label === null)) item('no label read', (svg) => add(svg, 'circle', { class: 'unread', cx: 13, cy: 9, r: 3.5 }));
  if (flight.scenes[0].ground.certain) {
    item('certain to be +1', box('certain above'));
    item('certain to be \u22121', box('certain below'));
    item('uncertain', box('area border'));
  }
  const { bands } = flight.scenes[0].ground;
  if (bands) {
    const levels = bands.map(({ from }) => `${Math.round(100 * from)}`).join(', ');
    item(`the line passes with a probability of ${levels} % at least, the stronger the likelier`, (svg) => {
      bands.forEach((_, k) => add(svg, 'rect', { class: 'band', x: 1 + 5 * k, y: 1, width: 25 - 1 - 5 * k, height: 16 }));
    });
  }
  for (const { name, stroke: { class: its } } of flight.boundary) item(`the ${name}`, stroke(its));
  if (flight.scenes.some((it) => it.front)) {
    const moves = flight.boundary.some((it) => it.stroke.class === 'past-truth');
    item(`the front as it ${moves ? 'was when it was' : 'is'} mapped`, stroke('estimate'));
    item(`it ${moves ? 'lay' : 'lies'} here with a probability of 90 %`, box('front'));
  }
  if (!flight.follows) item(flight.estimate, stroke('estimate'));
  item('path, and the last motion', (svg) => { add(svg, 'path', { class: 'path', d: 'M1 9H12' }); add(svg, 'path', { class: 'leg', d: 'M12 9H25' }); });
  item('robot and its heading', (svg) => { add(svg, 'circle', { class: 'halo', cx: 8, cy: 9, r: 7 }); add(svg, 'path', { class: 'bow', d: 'M16 5L24 9L16 13Z' }); });
  if (motions.some((it) => it.truly)) item('where it truly was', (svg) => cross(svg, [13, 9], 'truly'));
  if (motions.some((it) => it.target)) item('where the motion should have ended', (svg) => cross(svg, [13, 9], 'target'));
  if ((flight.shown ??= shown(flight)).isPart) item('inset: all of the area, and the part shown', box('inset'));
  if (flight.keep_outs.length > 0) item('kept out of', box('keep-out'));
  if ((flight.shores ?? []).length > 0) item('land', box('keep-out'));
}

/** The table of several missions after the same step; returns what fills it in. */
function sideBySide(place, flights) {
  const scroll = add(place, 'div', { class: 'scroll', role: 'region', tabindex: '0', 'aria-label': 'Side by side' });
  const table = add(scroll, 'table', { class: 'beside' });
  const caption = add(table, 'caption');
  const head = add(add(table, 'thead'), 'tr');
  for (const name of ['planner', 'bits told', 'estimate off, deg', 'area misjudged, %', 'control cost', 'metres']) {
    add(head, 'th', { scope: 'col' }, name);
  }
  const body = add(table, 'tbody');
  const rows = flights.map((flight) => {
    const row = add(body, 'tr');
    add(row, 'th', { scope: 'row' }, flight.planner);
    return Array.from({ length: 5 }, () => add(row, 'td'));
  });
  return (step) => {
    caption.textContent = step === 0 ? 'Side by side at the start' : `Side by side after step ${step}`;
    for (const [k, { scenes }] of flights.entries()) {
      const { bits, estimate, cost, metres } = scenes[Math.min(step, scenes.length - 1)];
      const off = estimate?.off_deg;
      const share = estimate?.misclassified;
      const texts = [figure(bits, 2), off == null ? '\u2013' : small(off), share == null ? '\u2013' : small(100 * share), figure(cost, 1), figure(metres, 1)];
      texts.forEach((text, column) => { rows[k][column].textContent = text; });
    }
  };
}

function markRow(table, step) {
  const rows = table.tBodies[0].rows;
  const now = Math.min(step, rows.length - 1);
  for (const [k, row] of [...rows].entries()) {
    if (k === now) row.setAttribute('aria-current', 'step');
    else row.removeAttribute('aria-current');
  }
}

/** Shows a step of the chapter that is open. */
function go(step) {
  const { steps, show } = chapters[state.chapter];
  state.step = Math.max(0, Math.min(steps, step));
  show(state.step);
  showCount();
  if (state.step === steps) pause();
}

/** Which step is shown, of how many. */
function showCount() {
  const { steps } = chapters[state.chapter];
  controls.slider.max = steps;
  controls.slider.value = state.step;
  controls.slider.setAttribute('aria-valuetext', `Step ${state.step} of ${steps}`);
  controls.count.textContent = `${state.step} of ${steps}`;
  for (const [button, isEnd] of [['first', state.step === 0], ['back', state.step === 0], ['next', state.step === steps], ['last', state.step === steps]]) {
    controls[button].setAttribute('aria-disabled', String(isEnd));
  }
}

function open(number) {
  pause();
  state.chapter = number;
  for (const [k, { section }] of chapters.entries()) section.hidden = k !== number;
  go(chapters[number].steps); // where it led; `Play` begins at the start
}

/** Goes on by itself, without a word to screen readers until it pauses. */
function play() {
  const { steps, quiet } = chapters[state.chapter];
  if (state.step === steps) go(0);
  quiet(true);
  controls.play.setAttribute('aria-label', 'Pause');
  controls.play.classList.add('playing');
  state.timer = setInterval(() => go(state.step + 1), Math.min(BEAT_MS, WHOLE_MS / steps));
}

function pause() {
  if (state.timer === null) return;
  clearInterval(state.timer);
  state.timer = null;
  controls.play.setAttribute('aria-label', 'Play');
  controls.play.classList.remove('playing');
  const { quiet, show } = chapters[state.chapter];
  quiet(false);
  show(state.step);
}

function toggle() {
  if (state.timer === null) play();
  else pause();
}

/** What keys do, wherever they have no other meaning. */
const KEYS = {
  ArrowLeft: () => go(state.step - 1),
  ArrowRight: () => go(state.step + 1),
  Home: () => go(0),
  End: () => go(chapters[state.chapter].steps),
  ' ': toggle,
};

addEventListener('keydown', (event) => {
  const isTaken = event.altKey || event.ctrlKey || event.metaKey || event.target.closest('input, select, textarea, .scroll');
  const isPressed = event.key === ' ' && event.target.closest('button');
  if (isTaken || isPressed || !KEYS[event.key]) return;
  event.preventDefault();
  KEYS[event.key]();
});
for (const [id, act] of [['first', KEYS.Home], ['back', KEYS.ArrowLeft], ['play', toggle], ['next', KEYS.ArrowRight], ['last', KEYS.End]]) {
  controls[id].addEventListener('click', act);
}
controls.slider.addEventListener('input', () => go(Number(controls.slider.value)));
controls.chapters.addEventListener('change', () => open(Number(controls.chapters.value)));
for (const [k, { title }] of PAGE.chapters.entries()) add(controls.chapters, 'option', { value: k }, title);
controls.choice.hidden = PAGE.chapters.length < 2;
controls.controls.hidden = false;
controls.keys.hidden = false;
open(0);
