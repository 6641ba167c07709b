// The page: what is made, the worker that flies it, and what is shown of it.

const part = (id) => document.getElementById(id);
const form = part('form');
const acts = Object.fromEntries(['run', 'stop', 'again', 'run-text'].map((id) => [id, part(id)]));
let made = begun('line');
let worker = null;
/** Set while a mission is flown: what is to be told of it. */
let flying = null;
let isOpen = false;
/** The boundary of the last mission. */
let boundary = [];

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

/** Flies what is made. A mission that is under way is given up. */
async function fly() {
  if (flying !== null) halt();
  const number = (fly.count = (fly.count ?? 0) + 1);
  flying = { number };
  show('Flying ...');
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
  flying = null;
  acts.stop.hidden = true;
  if (!isFlown) return show('', notes);
  present(chapter);
  boundary = chapter.flights[0].boundary.flatMap((it) => it.ways);
  field.draw();
  const { scenes, ended } = chapter.flights[0];
  const told = [...ended, ...scenes.at(-1).told];
  const of = (heading) => told.find((it) => it.of === heading)?.text ?? '';
  const truly = of('Map').split('\n').find((it) => it.startsWith('In truth')) ?? '';
  show([`${scenes.length - 1} steps.`, of('Ended'), of('Estimate'), truly, notes].filter(Boolean).join(' '));
}

function show(said, refused = '') {
  part('said').textContent = said;
  part('refused').textContent = refused;
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
  if (!matchMedia('(prefers-reduced-motion: reduce)').matches) play();
}

/** Takes another thing that was made: its drawing, its form and its text show it. */
function change(next) {
  made = next;
  field.draw();
  for (const [kind, button] of Object.entries(kinds)) button.setAttribute('aria-pressed', String(kind === made.kind && made.raster === null));
  part('hint').textContent = made.raster === null ? KINDS[made.kind].hint : 'The raster is +1 where its value is the threshold or more.';
  for (const name of ['planner', 'vehicle', 'p', 'size', 'seed']) form[name].value = String(made[name]);
  form.told.checked = made.told && !isHidden(made);
  form.told.disabled = isHidden(made);
  part('threshold').hidden = made.raster === null;
  form.threshold.value = String(made.raster?.threshold ?? 0);
  form.size.disabled = made.map !== null;
  form.moves.checked = made.moves;
  part('text').value = toml(made);
  const beside = Object.keys(files(made));
  part('beside').hidden = beside.length === 0;
  part('beside').textContent = `Save your file beside it, as ${beside.join(', ')}.`;
}

/** The same, and flies it. */
function take(next) {
  change(next);
  fly();
}

const kinds = Object.fromEntries(
  Object.entries(KINDS).map(([kind, { name }]) => {
    const button = add(part('kinds'), 'button', { type: 'button', class: 'wide', 'aria-pressed': 'false' }, name);
    button.addEventListener('click', () => take(begun(kind, made.seed)));
    return [kind, button];
  }),
);
for (const [name, all] of [['planner', PLANNERS], ['vehicle', VEHICLES], ['p', SENSORS], ['size', SIZES.map((it) => [it, `${it} m`])]]) {
  for (const [value, words] of all) add(form[name], 'option', { value }, words);
}

/** What a field of the form changes. */
form.addEventListener('change', ({ target }) => {
  const { name, type, value, checked: isChecked } = target;
  if (name === 'isArea' || type === 'file' || name === '') return;
  const next = { ...made, text: null, [name]: type === 'checkbox' ? isChecked : type === 'number' ? Math.max(0, Math.trunc(Number(value)) || 0) : value };
  if (name === 'size') {
    // The same drawing on another scale.
    const [from, to] = [ground(made), ground(next)];
    const scaled = ([x, z]) => [tidy((x * to.width) / from.width), tidy((z * to.height) / from.height)];
    Object.assign(next, { points: made.points.map(scaled), start: scaled(made.start) });
  }
  if (name === 'threshold') Object.assign(next, { raster: { ...made.raster, threshold: Number(value) || 0 }, threshold: undefined });
  // What moves is no straight line that stays.
  if (name === 'moves' && isChecked) Object.assign(next, { planner: 'track' });
  take(next);
});
form.addEventListener('submit', (event) => event.preventDefault());

acts.run.addEventListener('click', () => fly());
acts.stop.addEventListener('click', () => { halt(); show('Stopped.'); });
acts.again.addEventListener('click', () => take({ ...made, text: null, seed: made.seed + 1 }));
acts['run-text'].addEventListener('click', () => take({ ...made, text: part('text').value }));

/** The longest grid: a link holds it. */
const MOST_LETTERS = 1_000_000;

/** Takes a file, dropped or chosen. */
async function takeFile(file) {
  if (!file) return;
  try {
    if (file.type.startsWith('image/') || /\.asc$/i.test(file.name)) {
      const next = begun('shape', made.seed);
      const isGrid = !file.type.startsWith('image/');
      const grid = isGrid ? await file.text() : await gridded(file, ground(next));
      if (grid.length > MOST_LETTERS) throw new Error(`found ${grid.length} letters, expected ${MOST_LETTERS} at most`);
      return take({ ...next, raster: { grid, threshold: isGrid ? 0 : 128 } });
    }
    const text = await file.text();
    if (form.isArea.checked) {
      const next = { ...begun('circle', made.seed), map: text };
      const { middle, room, start } = afloat(mapped(text));
      take({ ...next, vehicle: 'boat', start, points: [middle, [tidy(middle[0] + 0.6 * room), middle[1]]] });
    } else {
      const next = begun('shape', made.seed);
      take({ ...next, points: brought(text, ground(next)) });
    }
  } catch (error) {
    show('', `${file.name}: ${error.message}`);
  }
}
part('file').addEventListener('change', ({ target }) => takeFile(target.files[0]));
document.addEventListener('dragover', (event) => event.preventDefault());
document.addEventListener('drop', (event) => {
  event.preventDefault();
  takeFile(event.dataTransfer?.files[0]);
});

/** What the copy buttons copy. */
const COPIES = {
  link: async () => new URL(await linked(made), location.href).href,
  toml: () => toml(made),
  rust: () => rust(made),
  python: () => python(made),
};
for (const button of document.querySelectorAll('[data-copy]')) {
  button.addEventListener('click', async () => {
    const what = button.dataset.copy;
    const text = await COPIES[what]();
    if (what === 'link') history.replaceState(null, '', text);
    try {
      await navigator.clipboard.writeText(text);
      show('Copied.');
    } catch {
      part('text').value = text;
      part('text').select();
      show('Select the text below to copy it.');
    }
  });
}

const field = editor(part('field'), { made: () => made, changed: (next) => change({ ...next, text: null }), done: () => fly(), seen: () => boundary });
new ResizeObserver(() => field.draw()).observe(part('field').parentElement);
async function begin() {
  const found = location.hash.length > 1 ? await unlinked(location.hash) : null;
  take(found ?? begun('line'));
}
addEventListener('hashchange', begin);
begin();
