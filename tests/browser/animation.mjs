// The picture of docs/try-it.md: what the playground shows of its first mission, step after step, as one SVG.
//
//   node animation.mjs PLAYGROUND.html PICTURE.svg

import { readFileSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { resolve } from 'node:path';

import { launch } from './looks.mjs';

const [file, picture] = process.argv.slice(2);
const STEP_S = 0.5;
/** The last picture stays so many steps longer. */
const REST = 4;
const browser = await launch();
const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: 'light', reducedMotion: 'reduce' });
await page.goto(pathToFileURL(resolve(file)).href);
await page.waitForSelector('#controls:not([hidden])');
const { field, frames, style } = await page.evaluate(() => {
  // Colours stand in the style sheet as variables.
  const root = getComputedStyle(document.documentElement);
  const valued = (text) => text.replaceAll(/var\((--[\w-]+)\)/g, (_, name) => root.getPropertyValue(name).trim());
  const own = 'text tick area border grid certain region keep-out truth estimate path leg mark unread wrong halo bow name grip robot handle'.split(' ');
  const isOwn = ({ selectorText }) => selectorText?.split(',').some((it) => own.some((name) => new RegExp(`^\\s*(text|\\.${name})(\\.[\\w-]+)*( \\.\\w+)*\\s*$`).test(it)));
  const rules = [...document.styleSheets[0].cssRules].filter(isOwn).map((it) => valued(it.cssText));
  const drawn = (svg) => ({ width: svg.viewBox.baseVal.width, height: svg.viewBox.baseVal.height, inner: svg.innerHTML.replaceAll(/ (tabindex|role|aria-\w+|data-key)="[^"]*"/g, '') });
  const field = drawn(document.getElementById('field'));
  document.getElementById('first').click();
  const frames = [];
  for (let k = 0; k <= Number(document.getElementById('slider').max); k += 1) {
    frames.push(drawn(document.querySelector('.map > svg')));
    document.getElementById('next').click();
  }
  return { field, frames, style: rules.join('\n') };
});
await browser.close();

const shorter = (text) => text.replaceAll(/(\d+\.\d)\d+/g, '$1').replaceAll('></path>', '/>').replaceAll('></rect>', '/>').replaceAll('></circle>', '/>').replaceAll('px,', ',').replaceAll('px)', ')').replaceAll('deg)', ')').replaceAll(/style="transform: ([^"]*);"/g, 'transform="$1"');
const [{ width, height }] = frames;
const lasts = frames.length + REST;
const seconds = (lasts * STEP_S).toFixed(1);
const scenes = frames.map(({ inner }, k) => {
  const from = k / lasts;
  const to = k + 1 === frames.length ? 1 : (k + 1) / lasts;
  const times = k === 0 ? [0, to] : [0, from, ...(to < 1 ? [to] : [])];
  const values = k === 0 ? ['inline', 'none'] : ['none', 'inline', ...(to < 1 ? ['none'] : [])];
  const timing = `dur="${seconds}s" repeatCount="indefinite" calcMode="discrete"`;
  const still = k + 1 === frames.length ? 'inline' : 'none';
  return `<g display="${still}"><animate attributeName="display" ${timing} keyTimes="${times.map((it) => it.toFixed(4)).join(';')}" values="${values.join(';')}"/>${shorter(inner)}</g>`;
});
const top = 30;
const gap = 20;
const title = (x, text) => `<text class="title" x="${x}" y="18">${text}</text>`;
const svg = `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${field.width + gap + width} ${top + height}" role="img" aria-label="A line that was drawn, and what the robot knows of it step by step">
<style>
${style}
.title { font-weight: 600; font-size: 14px; }
.handle .reach, .handle .grip { display: none; }
</style>
<rect width="100%" height="100%" fill="#fbfaf7"/>
${title(30, 'You draw a boundary')}
<g transform="translate(0 ${top})">${shorter(field.inner)}</g>
${title(field.width + gap + 38, 'What the robot knows of it, step by step')}
<g transform="translate(${field.width + gap} ${top})">
${scenes.join('\n')}
</g>
</svg>
`;
writeFileSync(picture, svg);
