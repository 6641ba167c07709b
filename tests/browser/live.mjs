// A live page in a real browser: that steps appear as they are made, that it follows them unless told otherwise, that it
// misses none when the connection breaks, that it says why the mission ended, and that it then is the report.
//
//   node live.mjs LINK REPORT.html FOLDER NAME
//
// asks for steps on standard output: a line with a number for so many more, `all` for the rest and the report. An empty
// line on standard input answers each. Saves what the page looked like in the folder. Ends with status 1 and a line for
// each fault.

import { connect, createServer } from 'node:net';
import { join, resolve } from 'node:path';
import { createInterface } from 'node:readline';
import { pathToFileURL } from 'node:url';

import { check, checkLooks, conclude, launch } from './looks.mjs';

const [link, report, folder, name] = process.argv.slice(2);
const answers = createInterface({ input: process.stdin })[Symbol.asyncIterator]();

async function fly(steps) {
  console.log(steps);
  await answers.next();
}

/** What lies between the browser and the program; it can break. */
const line = { isBroken: false, open: new Set() };
const server = createServer((near) => {
  const far = connect(new URL(link).port, '127.0.0.1');
  for (const [one, other] of [[near, far], [far, near]]) {
    line.open.add(one);
    one.on('error', () => other.destroy());
    one.on('close', () => { line.open.delete(one); other.destroy(); });
    one.pipe(other);
  }
  if (line.isBroken) near.destroy();
});
await new Promise((ready) => { server.listen(0, '127.0.0.1', ready); });
const address = `http://127.0.0.1:${server.address().port}/`;

function breakLine(isBroken) {
  line.isBroken = isBroken;
  if (isBroken) for (const it of line.open) it.destroy();
}

const browser = await launch();

async function view(width, height) {
  const page = await browser.newPage({ viewport: { width, height } });
  page.on('console', ({ type, text }) => check(/net::ERR_/.test(String(text)), `${width} px: the console says ${type}: ${text}`));
  page.on('pageerror', (error) => check(false, `${width} px: ${error}`));
  page.on('request', (request) => check(request.url().startsWith(address), `${width} px: it loads ${request.url()}`));
  await page.goto(address);
  return page;
}

/** Waits until the page says that this step of so many is shown, and looks whether all of it agrees. */
async function sees(page, step, steps, what) {
  const text = `${step} of ${steps}`;
  const isSaid = (it) => document.getElementById('count').textContent === it;
  await page.waitForFunction(isSaid, text).catch(() => check(false, `${what}: expected ${text}`));
  const found = await page.evaluate(() => {
    const [{ flights: [flight], section }] = chapters;
    const marked = [...section.querySelectorAll('tr[aria-current=step]')].map((it) => it.rowIndex - 1);
    const rows = section.querySelectorAll('table.told tbody tr').length;
    const drawn = section.querySelectorAll('.map > svg .truth').length;
    const { length: expected } = flight.scenes[marked[0]].boundary ?? flight.boundary.flatMap((it) => it.ways);
    return { marked, rows, drawn, expected, scenes: flight.scenes.length, words: section.querySelector('.words h4').textContent };
  });
  check(found.drawn === found.expected, `${what}: ${found.drawn} of ${found.expected} parts of the true boundary`);
  check(found.rows === steps + 1 && found.scenes === steps + 1, `${what}: ${found.rows} rows, ${found.scenes} scenes`);
  check(String(found.marked) === String(step), `${what}: the table marks ${found.marked}`);
  check(found.words === (step === 0 ? 'Start' : `Step ${step}`), `${what}: the words are of ${found.words}`);
}

async function says(page, begin, what) {
  const isSaid = (it) => document.getElementById('live').textContent.startsWith(it);
  await page.waitForFunction(isSaid, begin).catch(async () => check(false, `${what}: expected ${begin}, found ${await page.textContent('#live')}`));
}

const [wide, narrow] = [await view(1280, 800), await view(390, 844)];
await sees(wide, 0, 0, 'at first');
await says(wide, 'Live', 'at first');
await fly(3);
for (const page of [wide, narrow]) await sees(page, 3, 3, 'three steps');
await wide.keyboard.press('Home');
await fly(2);
await sees(wide, 0, 5, 'whoever looks at the start');
await says(wide, 'Live: go to the last step', 'whoever looks at the start');
await sees(narrow, 5, 5, 'whoever follows');
await wide.keyboard.press('End');
await fly(1);
for (const page of [wide, narrow]) await sees(page, 6, 6, 'who follows again');
for (const page of [wide, narrow]) await page.waitForTimeout(500); // the robot has come to rest
await wide.screenshot({ path: join(folder, `live-${name}-1280-under-way.png`) });
await narrow.screenshot({ path: join(folder, `live-${name}-390-under-way.png`) });
await checkLooks(wide, `${name}, wide`);
await checkLooks(narrow, `${name}, narrow`);
breakLine(true);
await says(wide, 'Not connected', 'a broken line');
await fly(3);
breakLine(false);
for (const page of [wide, narrow]) await sees(page, 9, 9, 'the line is back');
await says(wide, 'Live', 'the line is back');
const late = await view(1280, 800);
await sees(late, 9, 9, 'who comes late');
await fly('all');
for (const page of [wide, narrow, late]) {
  await says(page, 'Ended. ', 'the end');
  check(await page.evaluate(() => document.querySelector('.words').textContent.includes('Ended')), 'the end: the words do not say why');
}
// In the end it is the report: the same data, the same map, the same table.
const still = await browser.newPage({ viewport: { width: 1280, height: 800 } });
await still.goto(pathToFileURL(resolve(report)).href);
await wide.waitForTimeout(500);
const parts = (page) => page.evaluate(() => {
  const [{ flights: [{ scenes, ended, boundary }], section }] = chapters;
  const html = (of) => section.querySelector(of).innerHTML;
  return { data: JSON.stringify({ scenes, ended, boundary }), map: html('.map'), words: html('.words'), charts: html('.charts'), table: html('table.told') };
});
const [shown, expected] = [await parts(wide), await parts(still)];
for (const part of Object.keys(expected)) check(shown[part] === expected[part], `the end: the ${part} are not the report's`);
await checkLooks(wide, `${name}, wide, the end`);
await wide.screenshot({ path: join(folder, `live-${name}-1280-end.png`) });
await narrow.screenshot({ path: join(folder, `live-${name}-390-end.png`) });
await browser.close();
server.close();
conclude(name);
