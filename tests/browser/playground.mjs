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
  return { said: await page.textContent('#said'), refused: await page.textContent('#refused') };
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
  const drag = async (places) => {
    const [first, ...rest] = await Promise.all(places.map((it) => on(page, it)));
    await page.mouse.move(...first);
    await page.mouse.down();
    for (const at of rest) await page.mouse.move(...at, { steps: 4 });
    await page.mouse.up();
  };
  check((await page.getAttribute('#play', 'aria-label')) === 'Pause', 'it does not play by itself');
  const line = await after(page, () => drag([[0.05, 0.9], [0.95, 0.3]]));
  check(line.refused === '' && /0\.\d+ deg off the truth/.test(line.said), `a drawn line is not found: ${line.said}${line.refused}`);
  await page.fill('#slider', '3');
  check((await page.textContent('#count')).startsWith('3 of '), 'the time cannot be dragged');
  await page.click('#play');
  await looks(page, 'line 1280');
  for (const [kind, way] of [['Bend', [[0, 0.6], [0.3, 0.4], [0.7, 0.6], [1, 0.5]]], ['Circle', [[0.6, 0.45], [0.75, 0.45]]], ['Shape', [[0.25, 0.2], [0.8, 0.2], [0.75, 0.7], [0.45, 0.65], [0.25, 0.25]]]]) {
    await after(page, () => page.click(`#kinds >> text=${kind}`));
    const before = await toml(page);
    const front = await after(page, () => drag(way));
    check((await toml(page)) !== before, `${kind}: the stroke draws nothing`);
    check(front.refused === '' && front.said.includes('In truth it lies 0.'), `${kind}: it is not found: ${front.said}${front.refused}`);
    await page.click('#last');
    await looks(page, `${kind} 1280`);
  }
  // Copied, and back.
  await page.evaluate(() => { document.getElementById('text-of').open = true; });
  for (const [what, begins] of [['toml', '# Save this'], ['rust', '//! In a copy'], ['python', '# pip install'], ['link', 'file:']]) {
    await after(page, () => page.click(`[data-copy=${what}]`));
    const text = await page.evaluate(() => navigator.clipboard.readText());
    check(text.startsWith(begins), `as ${what}: ${text}`);
    writeFileSync(join(folder, `copied.${what}`), text);
  }
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
  check(raster.refused === '' && raster.said.includes('In truth it lies') && (await toml(page)).includes('raster = "truth.asc", threshold = 0'), `a raster: ${raster.said}${raster.refused}`);
  const png = await page.evaluate(() => {
    const sheet = Object.assign(document.createElement('canvas'), { width: 50, height: 40 });
    const own = sheet.getContext('2d');
    own.fillRect(0, 0, 50, 40);
    own.fillStyle = 'white';
    own.fillRect(20, 12, 16, 14);
    return sheet.toDataURL('image/png').split(',')[1];
  });
  const image = await after(page, () => page.setInputFiles('#file', { name: 'image.png', mimeType: 'image/png', buffer: Buffer.from(png, 'base64') }));
  check(image.refused === '' && image.said.includes('In truth it lies') && (await toml(page)).includes('threshold = 128'), `an image: ${image.said}${image.refused}`);
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
  check((await page.textContent('#said')) === 'Stopped.', 'it does not stop');
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
  check(circle.refused === '' && circle.said.includes('In truth it lies 0.'), `a circle by finger: ${circle.said}${circle.refused}`);
  check(/circle = \[(49\.9|50)/.test(await toml(page)), `another circle than was drawn: ${await toml(page)}`);
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

await byMouse();
await byTouch();
await byKeys();
await browser.close();
conclude('the playground');
