// Scenarios in the module of the playground:
//
//   node played.mjs PLAYGROUND.html SCENARIOS.json FOLDER
//
// saves the trace of each, or why it is refused, as FOLDER/NUMBER. They are flown in node; in Chromium, by the page, if the
// name of the folder ends with `browser`. Ends with status 1 if the module is larger than it may be. SCENARIOS are a list
// of { text, files: { NAME: CONTENT } }.

import { readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { gzipSync } from 'node:zlib';

/** The most bytes of the module, compressed. */
const MOST = 600_000;

const [html, list, folder] = process.argv.slice(2);
const page = readFileSync(html, 'utf8');
const scenarios = JSON.parse(readFileSync(list, 'utf8'));

/** What stands in an element of the page. */
function part(id) {
  const [, text] = page.match(new RegExp(`<script type="text/plain" id="${id}">([^]*?)</script>`));
  return text;
}

/** What comes of scenarios. */
const FLY = `async ({ scenarios, module }) => {
  ${part('client')}
  const bytes = Uint8Array.from(atob(module), (it) => it.charCodeAt(0));
  const own = await simulator(await WebAssembly.compile(bytes));
  const began = performance.now();
  const results = scenarios.map(({ text, files }) => {
    for (const [name, content] of Object.entries(files)) own.hand(name, new TextEncoder().encode(content));
    const { isFlown, notes } = own.run(text);
    return isFlown ? own.trace() : notes;
  });
  return { results, milliseconds: performance.now() - began };
}`;

async function inBrowser() {
  const { launch } = await import('./looks.mjs');
  const browser = await launch();
  const page = await browser.newPage();
  const flown = await page.evaluate(`(${FLY})(${JSON.stringify({ scenarios, module: part('module') })})`);
  await browser.close();
  return flown;
}

const inNode = () => new Function(`return ${FLY}`)()({ scenarios, module: part('module') });
const { results, milliseconds } = await (folder.endsWith('browser') ? inBrowser() : inNode());
for (const [number, result] of results.entries()) writeFileSync(join(folder, String(number)), result);
console.log(`${((1000 * results.length) / milliseconds).toFixed(1)} missions a second`);
const bytes = Buffer.from(part('module'), 'base64');
const packed = gzipSync(bytes, { level: 9 }).length;
console.log(`the module: ${bytes.length} bytes, compressed ${packed}, ${MOST} at most`);
process.exitCode = packed > MOST ? 1 : 0;
