// The planner alone as a WebAssembly module, in node: that it finds a line, and how large it is.
//
//   node alone.mjs MODULE.wasm
//
// Ends with status 1 if it does not, or if it is too large.

import { readFileSync } from 'node:fs';
import { gzipSync } from 'node:zlib';

/** Bytes, compressed. */
const MOST = 40_000;

const bytes = readFileSync(process.argv[2]);
const { exports } = (await WebAssembly.instantiate(bytes, {})).instance;
const { memory } = exports;
// Memory of the caller: a page for numbers, and pages for the planner.
const PAGE = 65_536;
const numbers = memory.grow(1 + Math.ceil(exports.bytes() / PAGE)) * PAGE;
const planner = numbers + PAGE;
const view = new Float64Array(memory.buffer, numbers);
const put = (at, values) => {
  view.set(values, at);
  return numbers + 8 * at;
};
const [SLOPE, INTERCEPT] = [0.41, 3.5];
const side = ([x, z]) => Math.sign(z - SLOPE * x - INTERCEPT);
const given = [[2, 1], [2, 8], [18, 16], [18, 5]].flatMap((it) => [...it, side(it)]);
let isSound = exports.begin(planner, put(0, [20, 20, 5, 0.95]), put(10, given)) !== 0;
let pose = [2, 1, 0];
let steps = 0;
while (steps < 60 && exports.plan(planner, put(30, pose), numbers + 8 * 40) !== 0) {
  pose = [...view.subarray(40, 43)];
  isSound = exports.observe(planner, put(30, pose), side(pose)) !== 0 && isSound;
  steps += 1;
}
isSound = exports.estimate(planner, numbers + 8 * 50) !== 0 && isSound;
const [a, b] = view.subarray(50, 52);
const off = Math.abs(Math.atan2(-a, b) - Math.atan(SLOPE)) * (180 / Math.PI);
const packed = gzipSync(bytes, { level: 9 }).length;
console.log(`${steps} steps, ${off.toFixed(2)} deg off; ${bytes.length} bytes, compressed ${packed}, ${MOST} at most`);
process.exitCode = isSound && steps > 5 && off < 5 && packed <= MOST ? 0 : 1;
