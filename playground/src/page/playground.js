// The page: what is made, the worker that flies it, and what is shown of it.

const part = (id) => document.getElementById(id);
const form = part('form');
const acts = Object.fromEntries(['run', 'stop', 'again', 'run-text'].map((id) => [id, part(id)]));
let made = begun('line');
/** The names of what the user has set. It stays when another boundary is drawn. */
let set = new Set();
/** What the mission that is shown came to: a sentence, and more. */
let outcome = ['', ''];
let worker = null;
/** Set while a mission is flown: what is to be told of it. */
let flying = null;
let isOpen = false;
/** The boundary of the last mission. */
let boundary = [];

const STILL = matchMedia('(prefers-reduced-motion: reduce)');
/** Where the picture is below the drawing. */
const NARROW = matchMedia('(max-width: 59.99rem)');

/** What the worker does with its messages. */
const WORK = `${part('client').textContent}
let own = null;
onmessage = async ({ data: { module, number, text, files } }) => {
  try {
    own ??= await simulator(module);
    for (const [name, text] of Object.entries(files)) own.hand(name, new TextEncoder().encode(text));
    const said = own.run(text);
    postMessage({ number, ...said, chapter: said.isFlown ? own.scenes() : null });
  } catch (error) {
    own = null;
    postMessage({ number, isFlown: false, notes: 'the simulator broke off: ' + error.message, chapter: null });
  }
};`;
const WORK_AT = URL.createObjectURL(new Blob([WORK], { type: 'text/javascript' }));
const MODULE = WebAssembly.compile(Uint8Array.from(atob(part('module').textContent), (it) => it.charCodeAt(0)));

/** Flies what is made, and ends a mission that is under way. `brings`: then the page scrolls to a picture below. */
async function fly(brings = false) {
  if (flying !== null) halt();
  const number = (fly.count = (fly.count ?? 0) + 1);
  flying = { number, brings };
  part('said').textContent = 'Flying ...';
  part('refused').textContent = '';
  acts.stop.hidden = false;
  const module = await MODULE;
  if (flying?.number !== number) return;
  if (worker === null) {
    worker = new Worker(WORK_AT);
    worker.onmessage = ({ data }) => landed(data);
    worker.onerror = (event) => landed({ number: flying?.number, isFlown: false, notes: `the simulator does not start: ${event.message}`, chapter: null });
  }
  worker.postMessage({ module, number, text: toml(made), files: files(made) });
}

/** Ends a mission that is under way. */
function halt() {
  worker?.terminate();
  worker = null;
  flying = null;
  acts.stop.hidden = true;
}

/** A mission was flown, or refused. */
function landed({ number, isFlown, notes, chapter }) {
  if (flying?.number !== number) return;
  const { brings } = flying;
  flying = null;
  acts.stop.hidden = true;
  if (!isFlown) {
    refuse(notes);
    return keep();
  }
  present(chapter);
  boundary = chapter.flights[0].boundary.flatMap((it) => it.ways);
  field.draw();
  const { scenes, ended, follows } = chapter.flights[0];
  const told = [...ended, ...scenes.at(-1).told];
  const of = (heading) => told.find((it) => it.of === heading)?.text ?? '';
  const truly = of('Map').split('\n').find((it) => it.startsWith('In truth')) ?? '';
  const [plain, ...more] = notes.split('\n');
  const why = follows || plain.includes(': ') ? '' : of('Ended');
  outcome = [plain, [why, of('Estimate'), truly, ...more].filter(Boolean).join(' ')];
  tellOutcome('');
  if (brings && NARROW.matches) part('chapter-0').scrollIntoView({ behavior: STILL.matches ? 'auto' : 'smooth' });
}

/** Says that the page still shows the mission before. */
function keep() {
  tellOutcome(isOpen ? 'The run before: ' : '');
  part('before').hidden = !isOpen;
}

function tellOutcome(before) {
  const [plain, more] = outcome;
  part('said').replaceChildren(before);
  add(part('said'), 'strong', {}, plain);
  part('said').append(` ${more}`);
  part('before').hidden = true;
}

/** Says in the bar what was done; a state from `before` can be brought back. */
function note(words, before = null) {
  part('note').textContent = words;
  part('refused').textContent = '';
  part('close').hidden = words === '';
  part('undo').hidden = before === null;
  part('undo').onclick = () => take(before);
}

/** Says in the bar why something is not done. */
function refuse(why) {
  note('');
  part('refused').textContent = why;
  part('close').hidden = false;
}

/** Shows a mission from its start. The report's own script steps through it. */
function present(chapter) {
  const section = part('chapter-0');
  if (!isOpen) {
    part('data').textContent = JSON.stringify({ title: document.title, chapters: [chapter] });
    document.head.append(Object.assign(document.createElement('script'), { textContent: part('stepping').textContent }));
    isOpen = true;
  } else {
    pause();
    section.querySelector('.stage').replaceChildren();
    chapters[0] = stage(chapter, section);
    open(0);
  }
  reserve();
  if (!STILL.matches) play();
}

/** Keeps room for the longest words of a step and figures of a chart, so that what is below them stays where it is. */
function reserve() {
  const section = part('chapter-0');
  const words = section.querySelector('.words');
  if (words === null) return;
  const [flight] = chapters[0].flights;
  const length = ({ told }) => told.reduce((sum, it) => sum + it.text.length + 30, 0);
  const steps = flight.scenes.map((_, k) => k).slice(0, -1);
  const longest = steps.sort((a, b) => length(flight.scenes[b]) - length(flight.scenes[a])).slice(0, 8);
  const sheet = add(words.parentElement, 'div', { class: 'words', 'aria-hidden': 'true' });
  Object.assign(sheet.style, { position: 'absolute', visibility: 'hidden', width: `${words.clientWidth}px` });
  const heights = longest.map((k) => {
    tell(sheet, flight, k, k);
    return sheet.getBoundingClientRect().height;
  });
  sheet.remove();
  words.style.minHeight = `${Math.ceil(Math.max(0, ...heights))}px`;
  const charts = CHARTS.filter((it) => (it.of ?? flight.follows) === flight.follows);
  for (const [k, caption] of section.querySelectorAll('.charts figcaption').entries()) {
    const value = caption.querySelector('output');
    const now = value.textContent;
    const all = flight.scenes.map((it) => charts[k].told(it));
    value.textContent = all.reduce((long, it) => (it.length > long.length ? it : long), '');
    caption.style.minHeight = '';
    caption.style.minHeight = `${caption.offsetHeight}px`;
    value.textContent = now;
  }
}

/** Takes another state: the drawing, the form and the text show it, and the bar says what else `changed`. */
function change(next, changed = []) {
  if (made.text !== null && next.text === null) changed.push(['text', 'the text is written anew, without what you wrote']);
  if (changed.length > 0) note(`Changed: ${changed.map(([, words]) => words).join('; ')}.`);
  made = next;
  field.draw();
  for (const [kind, button] of Object.entries(kinds)) button.setAttribute('aria-pressed', String(kind === made.kind && made.raster === null));
  part('hint').textContent = made.raster === null ? KINDS[made.kind].hint : 'The raster is +1 where its value is the threshold or more.';
  form.size.querySelector('[value=file]')?.remove();
  if (made.map !== null) {
    const { width, height } = ground(made);
    add(form.size, 'option', { value: 'file' }, `${Math.round(width)} x ${Math.round(height)} m, of the file`);
  }
  for (const name of ['planner', 'vehicle', 'p', 'size', 'seed']) form[name].value = String(name === 'size' && made.map !== null ? 'file' : made[name]);
  form.told.checked = made.told && !isHidden(made);
  form.told.disabled = isHidden(made);
  part('untold').hidden = !isHidden(made);
  part('threshold').hidden = made.raster === null;
  form.threshold.value = String(made.raster?.threshold ?? 0);
  form.size.disabled = made.map !== null;
  form.moves.checked = made.moves;
  acts.again.disabled = !isRandom(made);
  part('sure').hidden = isRandom(made);
  part('text').value = toml(made);
  const beside = Object.keys(files(made));
  part('beside').hidden = beside.length === 0;
  part('beside').textContent = `The scenario names ${beside.join(', ')}: a download has that too.`;
}

/** The same, and flies it. */
function take(next, { changed = [], brings = false } = {}) {
  note('');
  change(next, changed);
  fly(brings);
}

/** Turns to another boundary and keeps what the user has set. The bar says `more` beside what changed. */
function turn(next, more = '') {
  const { state, changed } = turned(made, next, set);
  take(state, { changed });
  if (more !== '') note(`${part('note').textContent} ${more}`.trim());
}

/** The first state of a kind of boundary, in a field of the size that the user has set. */
function fresh(kind) {
  return begun(kind, made.seed, set.has('size') ? made.size : undefined);
}

const kinds = Object.fromEntries(
  Object.entries(KINDS).map(([kind, { name }]) => {
    const button = add(part('kinds'), 'button', { type: 'button', class: 'wide', 'aria-pressed': 'false' }, name);
    button.addEventListener('click', () => turn(fresh(kind)));
    return [kind, button];
  }),
);
for (const [name, all] of [['planner', PLANNERS], ['vehicle', VEHICLES], ['p', SENSORS], ['size', SIZES.map((it) => [it, `${it} m`])]]) {
  for (const [value, words] of all) add(form[name], 'option', { value }, words);
}

/** What the numbers of the form may be. */
const NUMBERS = { seed: ['Random seed', 'a whole number from 0 to 999999'], threshold: ['Threshold', 'a number'] };

/** What a field of the form changes. */
form.addEventListener('change', ({ target }) => {
  const { name, type, value, checked: isChecked } = target;
  if (name === 'isArea' || type === 'file' || name === '') return;
  if (type === 'number' && (value === '' || !target.validity.valid)) {
    const [what, expected] = NUMBERS[name];
    target.value = String(made.raster && name === 'threshold' ? made.raster.threshold : made.seed);
    return refuse(`${what}: found ${value || 'none'}, expected ${expected}. It stays ${target.value}.`);
  }
  if (name === 'threshold') return take({ ...made, text: null, raster: { ...made.raster, threshold: Number(value) } });
  set.add(name);
  const next = { ...made, text: null, [name]: type === 'checkbox' ? isChecked : type === 'number' ? Number(value) : value };
  const { state, changed } = allowed(name === 'size' ? { ...resized(made, value), text: null } : next, name);
  take(state, { changed });
  if (name === 'planner' && isForLines(state)) note('This planner finds straight lines alone. Track follows this boundary.');
});
form.addEventListener('submit', (event) => event.preventDefault());

acts.run.addEventListener('click', () => { note(''); fly(true); });
acts.stop.addEventListener('click', () => { halt(); note('Stopped.'); keep(); });
acts.again.addEventListener('click', () => take(reseeded(made), { brings: true }));
acts['run-text'].addEventListener('click', () => {
  const text = part('text').value;
  if (text.trim() === '') return refuse('The text is empty.');
  take({ ...made, text }, { brings: true });
});
part('close').addEventListener('click', () => note(''));

/** The longest grid: a link holds it. */
const MOST_LETTERS = 1_000_000;

/** Takes a file, dropped or chosen. */
async function takeFile(file) {
  if (!file) return;
  try {
    if (file.type.startsWith('image/') || /\.asc$/i.test(file.name)) {
      const next = fresh('shape');
      const isGrid = !file.type.startsWith('image/');
      const grid = isGrid ? await file.text() : await gridded(file, ground(next));
      if (!/^\s*ncols\s/i.test(grid)) throw new Error(UNREADABLE);
      if (grid.length > MOST_LETTERS) throw new Error(`found ${grid.length} letters, expected ${MOST_LETTERS} at most`);
      return turn({ ...next, raster: { grid, threshold: isGrid ? 0 : 128, isImage: !isGrid } });
    }
    const text = await file.text();
    if (form.isArea.checked) {
      const next = { ...fresh('circle'), map: text };
      const { middle, room, start } = afloat(mapped(text));
      turn({ ...next, vehicle: 'boat', start, points: [middle, [tidy(middle[0] + 0.6 * room), middle[1]]] });
    } else {
      const next = fresh('shape');
      const { points, smaller } = brought(text, ground(next));
      const times = Number((smaller < 1 ? 1 / smaller : smaller).toPrecision(2));
      turn({ ...next, points }, times === 1 ? '' : `The shape is drawn ${times} times ${smaller > 1 ? 'smaller' : 'larger'} than it is, to fit the field.`);
    }
  } catch (error) {
    refuse(`${file.name}: ${error.message}`);
  }
}
part('file').addEventListener('change', async ({ target }) => {
  await takeFile(target.files[0]);
  // The bar says what was wrong, and the drawing shows what was right. Its name would stay with another drawing.
  target.value = '';
});
document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', (event) => {
  event.preventDefault();
  takeFile(event.dataTransfer?.files[0]);
});

/** What the copy buttons copy, and what to do with it. */
const COPIES = {
  link: [async () => new URL(await linked(made), location.href).href, location.protocol === 'file:'
    ? 'a link. It leads to this file on your disk, so nobody else can open it. Send the file with it, or put the page on a server.'
    : 'a link. Whoever opens it sees this mission.'],
  toml: [() => toml(made), 'a scenario. Save it as scenario.toml, and run it: host-sim run scenario.toml.'],
  rust: [() => rust(made), 'a Rust program. Save it as planner-core/examples/mine.rs in a copy of the repository, and run it: cargo run -p planner-core --example mine.'],
  python: [() => python(made), 'a Python program. Save it as mine.py. It needs the package: pip install ./python in a copy of the repository.'],
};
for (const button of document.querySelectorAll('[data-copy]')) {
  button.addEventListener('click', async () => {
    const [copied, words] = COPIES[button.dataset.copy];
    const text = await copied();
    if (button.dataset.copy === 'link') history.replaceState(null, '', text);
    try {
      await navigator.clipboard.writeText(text);
      const lacks = button.dataset.copy === 'rust' && made.text !== null ? ' It has none of your changes to the text.' : '';
      note(`Copied: ${words}${lacks}${part('text').value.trim() === toml(made).trim() ? '' : ' What you changed in the text is not in it: press Run this text first.'}`);
    } catch {
      part('text').value = text;
      part('text').select();
      note('Nothing could be copied. Copy the text that is selected.');
    }
  });
}
part('download').addEventListener('click', () => {
  const all = { 'scenario.toml': toml(made), ...files(made) };
  for (const [name, text] of Object.entries(all)) {
    const href = URL.createObjectURL(new Blob([text], { type: 'text/plain' }));
    add(document.body, 'a', { href, download: name }).click();
    document.body.lastChild.remove();
  }
  note(`Downloaded: ${Object.keys(all).join(', ')}. Run it: host-sim run scenario.toml.`);
});

const field = editor(part('field'), {
  made: () => made,
  changed: (next, key) => {
    if (key === 'start') set.add(key);
    change({ ...next, text: null });
    keep();
  },
  // A finger that wanted to scroll has drawn, too.
  done: (isHand, before) => {
    if (before) note('The boundary is drawn anew.', before);
    fly(isHand);
  },
  seen: () => boundary,
});
// A word on what was done before is over when a hand or a key does something else.
for (const type of ['pointerdown', 'keydown']) part('field').addEventListener(type, () => note(''), { capture: true });
new ResizeObserver(() => field.draw()).observe(part('field').parentElement);
new ResizeObserver(() => isOpen && reserve()).observe(part('chapter-0'));
async function begin() {
  const found = location.hash.length > 1 ? await unlinked(location.hash) : null;
  const first = begun(found?.kind ?? 'line');
  set = new Set(found === null ? [] : ['planner', 'vehicle', 'p', 'told', 'moves', 'size'].filter((it) => found[it] !== first[it]));
  take(found ?? first);
  if (found === null && location.hash.length > 1) note('This link is incomplete: this is the example.');
}
addEventListener('hashchange', begin);
begin();
