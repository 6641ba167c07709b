// The playground in a real browser: by mouse, by finger, by keys; what is wrong is said; it loads nothing, fits, and axe
// finds nothing.
//
//   node playground.mjs PLAYGROUND.html FOLDER
//
// saves in the folder what it looked like, and what was copied as TOML, Rust and Python. Ends with status 1 and a line for
// each fault.

import { readFileSync, writeFileSync } from 'node:fs';
import { join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { check, checkLooks, conclude, launch } from './looks.mjs';

const [file, folder] = process.argv.slice(2);
const address = pathToFileURL(resolve(file)).href;
const browser = await launch();

/** A page that has flown its first mission. */
async function opened(what, options, at = address) {
  const context = await browser.newContext({ permissions: ['clipboard-read', 'clipboard-write'], ...options });
  const page = await context.newPage();
  page.on('console', (message) => check(false, `${what}: the console says ${message.text()}`));
  page.on('pageerror', (error) => check(false, `${what}: ${error}`));
  page.on('request', (request) => check(request.url().startsWith(address) || request.url().startsWith('blob:'), `${what}: it loads ${request.url()}`));
  await page.goto(at);
  await flown(page);
  return page;
}

/** Waits until nothing flies, and returns what is said then. */
async function flown(page) {
  await page.waitForFunction(() => document.getElementById('stop').hidden && document.getElementById('said').textContent + document.getElementById('refused').textContent !== '', null, { timeout: 60_000 });
  return { said: await page.textContent('#said'), refused: await page.textContent('#refused'), note: await page.textContent('#note').catch(() => '') };
}

/** Does something, and waits until what it led to is flown. */
async function after(page, act) {
  await page.evaluate(() => { document.getElementById('said').textContent = ''; });
  await act();
  return flown(page);
}

/** A place on the field, in pixels of the page: shares of the drawing. */
async function on(page, [x, y]) {
  await page.locator('#field').scrollIntoViewIfNeeded();
  const box = await page.locator('#field rect.area').boundingBox();
  return [box.x + x * box.width, box.y + y * box.height];
}

const toml = (page) => page.inputValue('#text');

/** Whether all of an element is within the window. */
function isSeen(page, element) {
  return page.evaluate((it) => {
    const { top, bottom, height } = document.querySelector(it).getBoundingClientRect();
    return height > 0 && top >= 0 && bottom <= innerHeight;
  }, element);
}

/** The charts stay where they are while it plays. */
async function checkRest(page, what) {
  const tops = await page.evaluate(() => {
    const section = document.querySelector('.chapter');
    const last = section.querySelector('.charts figure:last-child > svg');
    return chapters[0].flights[0].scenes.slice(0, -1).map((_, k) => {
      go(k);
      return last.getBoundingClientRect().top - section.getBoundingClientRect().top;
    });
  });
  check(Math.max(...tops) - Math.min(...tops) < 1, `${what}: the charts move by ${Math.max(...tops) - Math.min(...tops)} px`);
}

/** Drags the mouse over the field. */
async function drag(page, places) {
  const [first, ...rest] = await Promise.all(places.map((it) => on(page, it)));
  await page.mouse.move(...first);
  await page.mouse.down();
  for (const at of rest) await page.mouse.move(...at, { steps: 4 });
  await page.mouse.up();
}

/** Nothing wider than the window, nothing too small for a finger, no finding. */
async function looks(page, what) {
  await page.evaluate(() => { document.getElementById('text-of').open = true; });
  await checkLooks(page, what);
  await page.evaluate(() => { document.getElementById('text-of').open = false; scrollTo(0, 0); });
  await page.screenshot({ path: join(folder, `playground-${what.replaceAll(/\W+/g, '-')}.png`) });
}

/** By mouse: a line, a circle, a shape; the time is dragged; what is copied leads back. */
async function byMouse() {
  const page = await opened('mouse', { viewport: { width: 1280, height: 800 } });
  check((await page.getAttribute('#play', 'aria-label')) === 'Pause', 'it does not play by itself');
  const line = await after(page, () => drag(page, [[0.05, 0.9], [0.95, 0.3]]));
  check(line.refused === '' && /0\.\d+ deg off the truth/.test(line.said), `a drawn line is not found: ${line.said}${line.refused}`);
  await page.fill('#slider', '3');
  check((await page.textContent('#count')).startsWith('3 of '), 'the time cannot be dragged');
  await page.click('#play');
  await looks(page, 'line 1280');
  for (const [kind, way] of [['Bend', [[0, 0.6], [0.3, 0.4], [0.7, 0.6], [1, 0.5]]], ['Circle', [[0.6, 0.45], [0.75, 0.45]]], ['Shape', [[0.25, 0.2], [0.8, 0.2], [0.75, 0.7], [0.45, 0.65], [0.25, 0.25]]]]) {
    await after(page, () => page.click(`#kinds >> text=${kind}`));
    const before = await toml(page);
    const front = await after(page, () => drag(page, way));
    check((await toml(page)) !== before, `${kind}: the stroke draws nothing`);
    check(front.refused === '' && front.said.includes('In truth it was 0.'), `${kind}: it is not found: ${front.said}${front.refused}`);
    check(/^The robot found the boundary(, but for \d+ m of it,)? with \d+ labels and \d+ motions\. In truth/.test(front.said), `${kind}: ${front.said}`);
    await page.click('#last');
    await looks(page, `${kind} 1280`);
  }
  // Copied, and back.
  await page.evaluate(() => { document.getElementById('text-of').open = true; });
  const said = await page.textContent('#said');
  for (const [what, begins, where] of [['toml', '# Save this', 'host-sim run'], ['rust', '//! In a copy', 'a Rust program'], ['python', '# pip install', 'a Python program'], ['link', 'file:', 'nobody else can open it']]) {
    await page.click(`[data-copy=${what}]`);
    await page.waitForFunction((it) => document.getElementById('note').textContent.includes(it), where, { timeout: 2000 }).catch(() => check(false, `as ${what}: it does not say that it copied ${where}`));
    check((await isSeen(page, '#note')) && (await page.textContent('#said')) === said, `as ${what}: the word is out of sight, or in place of the result`);
    const text = await page.evaluate(() => navigator.clipboard.readText());
    check(text.startsWith(begins), `as ${what}: ${text}`);
    writeFileSync(join(folder, `copied.${what}`), text);
  }
  const [download] = await Promise.all([page.waitForEvent('download'), page.click('#download')]);
  check(download.suggestedFilename() === 'scenario.toml' && readFileSync(await download.path(), 'utf8') === (await toml(page)), 'the download is another scenario');
  const other = await opened('link', {}, readFileSync(join(folder, 'copied.link'), 'utf8'));
  check((await toml(other)) === (await toml(page)), 'the link leads to another scenario');
  await other.context().close();
  // A file, and what is wrong.
  const lake = readFileSync(new URL('../../host-sim/scenarios/lakes/kyyvesi.geojson', import.meta.url));
  const shape = await after(page, () => page.setInputFiles('#file', { name: 'shape.geojson', mimeType: 'application/json', buffer: lake }));
  check(shape.refused === '' && (await toml(page)).includes('polygon = '), `a shape from a file: ${shape.refused}`);
  await page.check('[name=isArea]');
  const area = await after(page, () => page.setInputFiles('#file', { name: 'area.geojson', mimeType: 'application/json', buffer: lake }));
  check(area.refused === '' && (await toml(page)).includes('geojson = '), `an area from a file: ${area.refused}`);
  await looks(page, 'lake 1280');
  const grid = `ncols 40\nnrows 32\nxllcorner 0\nyllcorner 0\ncellsize 2.5\n${Array.from({ length: 32 }, (_, row) => Array.from({ length: 40 }, (_, column) => 20 - Math.hypot(2.5 * column - 60, 40 - 2.5 * row)).join(' ')).join('\n')}`;
  const raster = await after(page, () => page.setInputFiles('#file', { name: 'Hill.ASC', mimeType: 'text/plain', buffer: Buffer.from(grid) }));
  check(raster.refused === '' && raster.said.includes('In truth it was') && (await toml(page)).includes('raster = "truth.asc", threshold = 0'), `a raster: ${raster.said}${raster.refused}`);
  const png = await page.evaluate(() => {
    const sheet = Object.assign(document.createElement('canvas'), { width: 50, height: 40 });
    const own = sheet.getContext('2d');
    own.fillRect(0, 0, 50, 40);
    own.fillStyle = 'white';
    own.fillRect(20, 12, 16, 14);
    return sheet.toDataURL('image/png').split(',')[1];
  });
  const image = await after(page, () => page.setInputFiles('#file', { name: 'image.png', mimeType: 'image/png', buffer: Buffer.from(png, 'base64') }));
  check(image.refused === '' && image.said.includes('In truth it was') && (await toml(page)).includes('threshold = 128'), `an image: ${image.said}${image.refused}`);
  const large = await after(page, () => page.selectOption('[name=size]', '800 x 500'));
  check(large.refused === '' && large.said.startsWith('The robot found the boundary'), `an image in a larger field: ${large.said}${large.refused}`);
  await after(page, () => page.selectOption('[name=size]', '100 x 80'));
  const higher = await after(page, async () => { await page.fill('[name=threshold]', '8'); await page.press('[name=threshold]', 'Tab'); });
  check(higher.refused === '' && (await toml(page)).includes('threshold = 8'), `a threshold: ${higher.said}${higher.refused}`);
  await looks(page, 'raster 1280');
  const none = await after(page, () => page.setInputFiles('#file', { name: 'none.json', mimeType: 'application/json', buffer: Buffer.from('{"type": "Point"}') }));
  check(none.refused.includes('none.json: found no polygon'), `a file without polygons: ${none.refused}`);
  await page.evaluate(() => { document.getElementById('text-of').open = true; });
  await page.fill('#text', `${await toml(page)}stepz = 3\n`);
  const wrong = await after(page, () => page.click('#run-text'));
  check(wrong.refused.startsWith('scenario.toml:'), `a wrong key: ${wrong.refused}`);
  const again = await after(page, () => page.click('#kinds >> text=Line'));
  check(again.refused === '' && again.said !== '', 'it does not go on after a mistake');
  // A long mission is stopped.
  await page.fill('#text', (await toml(page)).replace(/stop = .*/, '').replace('steps = 60', 'steps = 10000').replace('"lookahead"', '"random"'));
  await page.click('#run-text');
  await page.click('#stop');
  check((await page.textContent('#note')) === 'Stopped.', 'it does not stop');
  await page.context().close();
}

/** By finger, on a phone. */
async function byTouch() {
  const page = await opened('touch', { viewport: { width: 390, height: 844 }, hasTouch: true, isMobile: true, colorScheme: 'dark', reducedMotion: 'reduce' });
  check((await page.getAttribute('#play', 'aria-label')) === 'Play', 'it plays for who wants no motion');
  const touch = await page.context().newCDPSession(page);
  const stroke = async (places) => {
    const pixels = [];
    for (const it of places) pixels.push(await on(page, it));
    const send = (type, touchPoints) => touch.send('Input.dispatchTouchEvent', { type, touchPoints });
    await send('touchStart', [{ x: pixels[0][0], y: pixels[0][1] }]);
    for (const [x, y] of pixels) await send('touchMove', [{ x, y }]);
    await send('touchEnd', []);
  };
  await after(page, () => page.tap('#kinds >> text=Circle'));
  const circle = await after(page, () => stroke([[0.5, 0.5], [0.6, 0.5], [0.7, 0.5]]));
  check(circle.refused === '' && circle.said.includes('In truth it was 0.'), `a circle by finger: ${circle.said}${circle.refused}`);
  check(/circle = \[(49\.9|50)/.test(await toml(page)), `another circle than was drawn: ${await toml(page)}`);
  // Who wanted to scroll takes it back.
  const drawn = await toml(page);
  const scrolled = await after(page, () => stroke([[0.3, 0.8], [0.3, 0.5], [0.31, 0.3]]));
  check(scrolled.note === 'The boundary is drawn anew.' && (await toml(page)) !== drawn, `a finger draws: ${scrolled.note}`);
  await after(page, () => page.tap('#undo'));
  check((await toml(page)) === drawn && !(await page.isVisible('#undo')), 'a stroke is not taken back');
  await page.waitForTimeout(300);
  check(await isSeen(page, '.map > svg'), 'the robot plays below the screen');
  await page.tap('#first');
  await page.tap('#next');
  check((await page.textContent('#count')).startsWith('1 of '), 'next by finger');
  await looks(page, 'circle 390');
  await page.locator('.chapter').scrollIntoViewIfNeeded();
  await page.context().close();
}

/** By keys alone. */
async function byKeys() {
  const page = await opened('keys', { viewport: { width: 1280, height: 800 } });
  const reach = async (what, isThere) => {
    for (let k = 0; k < 60; k += 1) {
      if (await page.evaluate(isThere)) return;
      await page.keyboard.press('Tab');
    }
    check(false, `Tab does not reach ${what}`);
  };
  await reach('Bend', () => document.activeElement.textContent === 'Bend');
  await after(page, () => page.keyboard.press('Enter'));
  await reach('a point', () => document.activeElement.getAttribute('data-key') === '1');
  const before = await toml(page);
  const name = () => page.evaluate(() => document.activeElement.getAttribute('aria-label'));
  const at = await name();
  await after(page, () => page.keyboard.press('ArrowUp'));
  check((await name()).startsWith('Point 2 of 5') && (await name()) !== at, `the arrows leave ${await name()}`);
  check((await toml(page)) !== before, 'the arrows change nothing');
  await after(page, () => page.keyboard.press('Insert'));
  check((await name()).startsWith('Point 2 of 6'), `Insert leaves ${await name()}`);
  await after(page, () => page.keyboard.press('Delete'));
  check((await name()).startsWith('Point 1 of 5'), `Delete leaves ${await name()}`);
  for (const id of ['run', 'first', 'slider', 'file', 'run-text']) {
    await page.evaluate(() => { document.getElementById('text-of').open = true; });
    await reach(id, `document.activeElement.id === '${id}'`);
  }
  await page.context().close();
}

/** What one trips over who sees it for the first time. */
async function asStranger() {
  const page = await opened('stranger', { viewport: { width: 1280, height: 800 } });
  const value = (name) => page.evaluate((it) => document.querySelector(`[name=${it}]`)[it === 'told' || it === 'moves' ? 'checked' : 'value'], name);
  const turn = (kind) => after(page, () => page.click(`#kinds >> text=${kind}`));
  const choose = (name, to) => after(page, () => page.selectOption(`[name=${name}]`, to));
  const type = async (name, to) => {
    await page.fill(`[name=${name}]`, to);
    await page.press(`[name=${name}]`, 'Tab');
  };
  const drop = (name, text, mimeType = '') => after(page, () => page.setInputFiles('#file', { name, mimeType, buffer: Buffer.from(text) }));
  // The result in a sentence, with the labels that were read.
  const labels = () => page.evaluate(() => chapters[0].flights[0].scenes.filter((it) => (it.motion?.label ?? null) !== null).length);
  const first = await page.textContent('#said');
  check(first.startsWith(`The robot found the boundary with ${await labels()} labels (`) && first.includes('for the audit) and'), `the first sentence: ${first}`);
  check(await page.isDisabled('#again'), 'another seed is offered where nothing is random');
  // The shade is on the side of the +1 labels, whatever the line.
  for (const line of [[[0.4, 0.9], [0.4, 0.1]], [[0.4, 0.1], [0.4, 0.9]], [[0.5, 0.95], [0.55, 0.05]], [[0.5, 0.05], [0.55, 0.95]], [[0.1, 0.2], [0.9, 0.7]]]) {
    await after(page, () => drag(page, line));
    const isShaded = await page.evaluate(() => {
      const shade = document.querySelector('#field path.certain.above');
      const marks = [...document.querySelectorAll('#field > .mark')];
      return marks.length === 4 && marks.every((it) => {
        const { x, y, width, height } = it.getBBox();
        return shade.isPointInFill(new DOMPoint(x + width / 2, y + height / 2)) === it.classList.contains('above');
      });
    });
    await checkRest(page, `the line ${line}`);
    check(isShaded, `the shade of the line ${line} is not that of the labels`);
  }
  check((await page.evaluate(() => getComputedStyle(document.querySelector('#field .of-robot .halo')).fill)) === 'none', 'the robot hides the label where it starts');
  // No choice fails for a number that nobody set.
  const tracks = await choose('planner', 'lawnmower');
  const noisy = await choose('p', '0.8');
  check(tracks.refused === '' && noisy.refused === '', `parallel tracks: ${tracks.refused}${noisy.refused}`);
  const boat = await choose('vehicle', 'boat');
  check(boat.refused === '' && boat.note.startsWith('Changed: the planner is Look-ahead'), `parallel tracks by boat: ${boat.refused}${boat.note}`);
  // What was set stays, or it is said.
  await choose('planner', 'scc');
  const bend = await turn('Bend');
  check(bend.note === 'Changed: the planner is Track, as this boundary is no straight line; the field is 100 x 80 m; no label is known.', `Algorithm 2 and a bend: ${bend.note}`);
  await choose('size', '50 x 50');
  await after(page, () => page.check('[name=moves]'));
  await after(page, () => page.check('[name=told]'));
  await turn('Circle');
  const kept = Object.fromEntries(await Promise.all(['p', 'vehicle', 'size', 'moves', 'told'].map(async (it) => [it, await value(it)])));
  check(JSON.stringify(kept) === '{"p":"0.8","vehicle":"boat","size":"50 x 50","moves":true,"told":true}', `a circle leaves ${JSON.stringify(kept)}`);
  const straight = await choose('planner', 'cfc');
  check(straight.note === 'This planner finds straight lines alone. Track follows this boundary.', `Algorithm 1 and a circle: ${straight.note}`);
  await choose('planner', 'track');
  const coast = await turn('Random coast');
  check(coast.note.includes('no label is known') && (await value('moves')) && (await page.isVisible('#untold')), `a coast: ${coast.note}`);
  const square = (size) => JSON.stringify({ type: 'Polygon', coordinates: [[[7, 46], [7 + size, 46], [7 + size, 46 + size], [7, 46 + size], [7, 46]]] });
  const shape = await drop('shape.geojson', square(0.01));
  check(/The shape is drawn \d+ times smaller/.test(shape.note) && (await value('p')) === '0.8' && (await value('size')) === '50 x 50', `a shape from a file: ${shape.note}`);
  await page.check('[name=isArea]');
  const area = await drop('area.geojson', square(0.01));
  check(area.note.includes('the field is that of the file') && (await page.textContent('[name=size] option:checked')).startsWith('772 x 1112 m'), `an area: ${area.note}`);
  await page.uncheck('[name=isArea]');
  // What is wrong is said in plain words where one looks, and the result stays.
  const result = await page.textContent('#said');
  for (const [name, mime] of [['a.txt', 'text/plain'], ['a.pdf', 'application/pdf'], ['a.docx', ''], ['a.png', 'image/png'], ['a.asc', '']]) {
    await page.setInputFiles('#file', { name, mimeType: mime, buffer: Buffer.from('%PDF-1.4 {"\u0000\ufffd') });
    await page.waitForFunction((it) => document.getElementById('refused').textContent === `${it}: This is no GeoJSON, PNG or ASCII grid.`, name, { timeout: 2000 }).catch(async () => check(false, `${name}: ${await page.textContent('#refused')}`));
  }
  check((await isSeen(page, '#refused')) && (await page.textContent('#said')) === result, 'an error is out of sight, or in place of the result');
  for (const seed of ['1e99', '-7', '2.5']) {
    await type('seed', seed);
    check((await page.inputValue('[name=seed]')) === '1', `the seed ${seed} stays in the form`);
    check((await page.textContent('#refused')).startsWith(`Random seed: found ${seed}, expected a whole number from 0 to 999999`), `the seed ${seed}: ${await page.textContent('#refused')}`);
  }
  await page.fill('#text', ' ');
  await page.click('#run-text');
  check((await page.textContent('#refused')) === 'The text is empty.', `an empty text: ${await page.textContent('#refused')}`);
  // Keys in the text are the text's, not the player's.
  await page.fill('#text', 'steps = ');
  await page.press('#text', 'End');
  for (const key of ['"', 'a', ' ', 'b', 'ArrowLeft', 'x', '"']) await page.press('#text', key);
  check((await page.inputValue('#text')) === 'steps = "a x"b', `typed into the text: ${await page.inputValue('#text')}`);
  await page.fill('#text', 'steps = "many"');
  const many = await after(page, () => page.click('#run-text'));
  check(many.refused !== '' && (await isSeen(page, '#refused')) && (await page.isVisible('#before')) && many.said.startsWith('The run before: '), `a text that cannot be flown: ${many.said}`);
  await checkLooks(page, 'a refusal');
  const own = await after(page, () => page.click('#kinds >> text=Line'));
  check(own.note.includes('the text is written anew') && !(await page.isVisible('#before')), `a text of one's own: ${own.note}`);
  await checkRest(page, 'labels that may be wrong');
  // In the words of the page: no minus zero, no plural of one.
  await after(page, async () => { await page.uncheck('[name=moves]'); });
  await choose('planner', 'lookahead');
  const wrong = await page.evaluate(() => chapters[0].flights[0].scenes.flatMap((it) => it.told.map(({ text }) => text)).filter((it) => /\b1 hypotheses|[-\u2212]0\.00/.test(it)));
  check(wrong.length === 0 && (await page.evaluate(() => chapters[0].flights[0].scenes.length)) > 10, `words: ${wrong}`);
  // Three steps are too few.
  await page.fill('#text', (await toml(page)).replace(/steps = \d+/, 'steps = 3'));
  const few = await after(page, () => page.click('#run-text'));
  check(few.said.startsWith('The robot did NOT find the boundary with 3 labels and 3 motions: all 3 steps are taken.'), `three steps: ${few.said}`);
  const again = await after(page, () => page.click('#again'));
  check(again.said.includes('all 3 steps are taken') && (await toml(page)).includes('seed = 2'), `another seed: ${again.said}`);
  // A stroke that begins beside a corner draws another shape.
  await turn('Shape');
  const corner = await page.locator('#field [data-key="0"] .grip').boundingBox();
  const box = await page.locator('#field rect.area').boundingBox();
  const beside = [(corner.x + corner.width + 3 - box.x) / box.width, (corner.y - 3 - box.y) / box.height];
  await after(page, () => drag(page, [beside, [0.8, 0.3], [0.8, 0.7], [0.5, 0.6]]));
  check((await page.locator('#field .grip').count()) === 4, 'a stroke beside a corner bends the shape');
  await page.context().close();
  const cut = await opened('cut', {}, `${address}#q1YqLkksKS1WsqpWy`);
  check((await cut.textContent('#note')) === 'This link is incomplete: this is the example.', 'a link that is cut off opens the example without a word');
  await cut.context().close();
}

await asStranger();
await byMouse();
await byTouch();
await byKeys();
await browser.close();
conclude('the playground');
