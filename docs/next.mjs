// Finds a line by asking `host-sim next` motion by motion. The robot here drives exactly and reads z > 0.41 x + 3.5.

import { spawnSync } from "node:child_process";

const mission = {
  algorithm: "lookahead",
  stop: { slope_arc_deg: 1.0 },
  steps: 60,
  oracle: [
    { x: 2, z: 1, label: -1 },
    { x: 2, z: 8, label: 1 },
    { x: 18, z: 16, label: 1 },
    { x: 18, z: 5, label: -1 },
  ],
};

function ask(request) {
  const program = process.argv[2] ?? "host-sim";
  const done = spawnSync(program, ["next"], { input: JSON.stringify(request), encoding: "utf8" });
  if (done.status !== 0) throw new Error(done.stderr);
  return JSON.parse(done.stdout);
}

let answer = ask({ ...mission, pose: { x: 2, z: 1, heading: 0 } });
while (answer.next) {
  const { x, z, heading, label: isWanted } = answer.next; // drive there, and say where you are
  const label = isWanted ? (z > 0.41 * x + 3.5 ? 1 : -1) : null; // read your sensor
  answer = ask({ ...mission, pose: { x, z, heading }, label, state: answer.state });
}
const { slope, intercept } = answer.known.estimates.centre;
console.log(`${answer.stop}: z = ${slope.toFixed(3)} x + ${intercept.toFixed(3)}`);
