// A report's page in a real browser: that it steps by buttons, keys and slider, that it loads nothing, that it fits
// and that axe finds nothing: wide and in light, narrow and in dark; with `all` also the other way round.
//
//   node page.mjs PAGE.html FOLDER [all]
//
// saves what the page looked like in the folder. Ends with status 1 and a line for each fault.

import { mkdirSync } from 'node:fs';
import { basename, join, resolve } from 'node:path';
import { pathToFileURL } from 'node:url';

import { check, conclude, launch, checkLooks } from './looks.mjs';

const [file, folder, extent] = process.argv.slice(2);
const name = basename(file, '.html');

/** What a step shows: its number, its words, its pictures. */
function shown(page) {
  return page.evaluate(() => {
    const section = document.querySelector('.chapter:not([hidden])');
    return {
      count: document.getElementById('count').textContent,
      valueText: document.getElementById('slider').getAttribute('aria-valuetext'),
      words: [...section.querySelectorAll('[role=status]')].map((it) => it.textContent),
      live: [...section.querySelectorAll('[role=status]')].map((it) => it.getAttribute('aria-live')),
      maps: [...section.querySelectorAll('.map > svg')].map((it) => it.innerHTML),
      charts: [...section.querySelectorAll('.charts svg')].map((it) => it.innerHTML),
      rows: [...section.querySelectorAll('tr[aria-current=step]')].map((it) => it.rowIndex - 1),
    };
  });
}

async function check_step(page, step, what) {
  const now = await shown(page);
  check(now.count.startsWith(`${step} of `), `${what}: expected step ${step}, found ${now.count}`);
  check(now.valueText.startsWith(`Step ${step} of `), `${what}: the slider says ${now.valueText}`);
  const heading = step === 0 ? 'Start' : `Step ${step}`;
  check(now.words.every((it) => it.startsWith(heading) || it.includes(', over')), `${what}: the words do not begin with ${heading}`);
  check(now.rows.every((it) => it <= step) && now.rows.includes(step), `${what}: the tables mark the rows ${now.rows}`);
  return now;
}

/** Every part that steps: each control goes where it should, and words, maps and charts change with it. */
async function check_stepping(page) {
  const most = Number(await page.getAttribute('#slider', 'max'));
  await check_step(page, most, 'at first');
  await page.click('#first');
  const start = await check_step(page, 0, 'first');
  await page.click('#next');
  const one = await check_step(page, 1, 'next');
  for (const part of ['words', 'maps', 'charts']) {
    check(start[part].every((it, k) => it !== one[part][k]), `next: the ${part} stay the same`);
  }
  await page.click('#back');
  const again = await check_step(page, 0, 'back');
  check(again.maps.every((it, k) => it === start.maps[k]), 'back: another map than before');
  await page.evaluate(() => document.activeElement.blur());
  for (const [key, step] of [['ArrowRight', 1], ['ArrowRight', 2], ['ArrowLeft', 1], ['Home', 0]]) {
    await page.keyboard.press(key);
    await check_step(page, step, key);
  }
  await page.focus('#slider');
  await page.keyboard.press('ArrowRight');
  await check_step(page, 1, 'ArrowRight on the slider');
  await page.fill('#slider', '4');
  await check_step(page, 4, 'the slider');
  const last = Number(await page.getAttribute('#slider', 'max'));
  await page.click('#last');
  const end = await check_step(page, last, 'last');
  check(end.words.some((it) => it.includes('Ended')), 'last: nobody says why it ended');
  const [drawn, mapped] = await page.evaluate(() => {
    const { flights, section } = chapters.find((it) => !it.section.hidden);
    const places = flights.flatMap(({ scenes, rest }) => [...scenes.flatMap((it) => it.mapped ?? []), ...(rest ?? [])]);
    return [section.querySelectorAll('.map path.front').length, places.length];
  });
  check(drawn === mapped, `last: the map of a front has ${mapped} places, and ${drawn} are drawn`);
  await page.click('#next', { force: true }); // it says that it is disabled, and does nothing
  await check_step(page, last, 'next at the end');
  await page.click('#first');
  await check_step(page, 0, 'first');
  await check_playing(page);
}

async function check_playing(page) {
  await page.click('#play');
  check((await page.getAttribute('#play', 'aria-label')) === 'Pause', 'play: the button does not say Pause');
  check((await shown(page)).live.every((it) => it === 'off'), 'play: every step would be read out');
  await page.waitForFunction(() => document.getElementById('count').textContent.startsWith('2 of '));
  await page.evaluate(() => document.activeElement.blur());
  await page.keyboard.press('Space');
  const { live, count } = await shown(page);
  check((await page.getAttribute('#play', 'aria-label')) === 'Play', 'pause: the button does not say Play');
  check(live.every((it) => it === 'polite'), 'pause: steps are not read out');
  await page.click('#last');
  check(!count.startsWith('0'), 'play: it did not go on');
}

/** What one sees before one scrolls: each map as a whole. */
async function check_first_view(page, what) {
  const bottoms = await page.evaluate(() => {
    scrollTo(0, 0);
    const section = document.querySelector('.chapter:not([hidden])');
    return [...section.querySelectorAll('.map > svg')].map((it) => it.getBoundingClientRect().bottom);
  });
  const lowest = Math.ceil(Math.max(...bottoms));
  check(lowest <= 800, `${what}: a map ends at ${lowest} px`);
}

const browser = await launch();
mkdirSync(folder, { recursive: true });
const address = pathToFileURL(resolve(file)).href;
const looks = [[1280, 800, 'light'], [360, 740, 'dark']];
if (extent === 'all') looks.push([1280, 800, 'dark'], [360, 740, 'light']);
for (const [width, height, colorScheme] of looks) {
  const what = `${name}, ${width} px, ${colorScheme}`;
  const context = await browser.newContext({ viewport: { width, height }, colorScheme, reducedMotion: colorScheme === 'dark' ? 'reduce' : 'no-preference' });
  const page = await context.newPage();
  page.on('console', (message) => check(false, `${what}: the console says ${message.text()}`));
  page.on('pageerror', (error) => check(false, `${what}: ${error}`));
  page.on('request', (request) => check(request.url() === address, `${what}: it loads ${request.url()}`));
  await page.goto(address);
  const chapters = await page.locator('#chapters option').count();
  for (let chapter = 0; chapter < chapters; chapter += 1) {
    if (chapters > 1) await page.selectOption('#chapters', String(chapter));
    if (width > 1000) await check_first_view(page, `${what}, chapter ${chapter}`);
    if (colorScheme === 'light') await check_stepping(page);
    await page.fill('#slider', '5');
    await page.waitForTimeout(500); // the robot has come to rest
    await checkLooks(page, `${what}, chapter ${chapter}`);
    await page.screenshot({ path: join(folder, `${name}-${width}-${colorScheme}-${chapter}.png`), fullPage: true });
  }
  await context.close();
}
// Without scripts there are the last pictures and the tables; and on paper no controls.
const still = await browser.newPage({ javaScriptEnabled: false, viewport: { width: 360, height: 740 } });
await still.goto(address);
check((await still.locator('.still svg').count()) > 0, 'without scripts: no picture');
check((await still.locator('table.told tbody tr').count()) > 1, 'without scripts: no table');
check(!(await still.isVisible('#controls')), 'without scripts: controls that do nothing');
await still.screenshot({ path: join(folder, `${name}-still.png`) });
const paper = await browser.newPage();
await paper.goto(address);
await paper.emulateMedia({ media: 'print', colorScheme: 'dark' });
check(!(await paper.isVisible('#controls')), 'on paper: controls');
const ink = await paper.evaluate(() => getComputedStyle(document.body).color);
check(ink === 'rgb(0, 0, 0)', `on paper: ink is ${ink}`);
await paper.pdf({ path: join(folder, `${name}.pdf`), format: 'A4', printBackground: true });
await browser.close();
conclude(name);
