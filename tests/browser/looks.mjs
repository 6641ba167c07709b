// What every check of a page in a browser needs: the browser, a list of faults, and whether a page fits and axe finds
// nothing.

import { readFileSync } from 'node:fs';
import { createRequire } from 'node:module';

import { chromium } from 'playwright-core';

const AXE = readFileSync(createRequire(import.meta.url).resolve('axe-core/axe.min.js'), 'utf8');
const faults = [];

export function check(isTrue, what) {
  if (!isTrue) faults.push(what);
}

export function launch() {
  return chromium.launch({
    executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
    args: ['--no-sandbox', '--disable-gpu', '--disable-quic', '--no-first-run', '--disable-background-networking', '--disable-component-update', '--disable-sync'],
  });
}

/** Nothing wider than the window, and no finding. */
export async function checkLooks(page, what) {
  const [content, window] = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
  check(content <= window, `${what}: ${content} px in a window of ${window}`);
  await page.evaluate(AXE);
  const { violations, passes } = await page.evaluate(() => globalThis.axe.run());
  check(passes.length > 20, `${what}: axe looked at ${passes.length} rules only`);
  for (const { id, help, nodes } of violations) {
    check(false, `${what}: axe: ${id}: ${help}: ${nodes.map((it) => it.target.join(' ')).join(', ')}`);
  }
}

/** Ends the program: with status 1 and a line for each fault, if there are any. */
export function conclude(name) {
  for (const fault of faults) console.log(fault);
  console.log(faults.length === 0 ? `${name}: as it should be` : `${name}: ${faults.length} faults`);
  process.exit(faults.length === 0 ? 0 : 1);
}
