// What the playground copies of scenarios of each kind:
//
//   node programs.mjs FOLDER
//
// saves FOLDER/NAME.scenario, NAME.rs and NAME.py; and as choices/NUMBER.scenario what comes of each choice of
// boundary, planner, sensor and vehicle.

import { mkdirSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';

const [folder] = process.argv.slice(2);
const source = (path) => readFileSync(new URL(`../../${path}`, import.meta.url), 'utf8');
const text = ['host-sim/src/report/page/map.js', 'playground/src/page/scenario.js', 'playground/src/page/programs.js'].map(source).join('\n');
const { allowed, begun, toml, rust, python, KINDS, PLANNERS, SENSORS, VEHICLES } = new Function(`${text}; return { allowed, begun, toml, rust, python, KINDS, PLANNERS, SENSORS, VEHICLES };`)();
const lake = source('host-sim/scenarios/lakes/kyyvesi.geojson');
const states = {
  ...Object.fromEntries(Object.keys(KINDS).map((kind) => [kind, begun(kind)])),
  noisy: { ...begun('line'), p: '0.9' },
  sought: { ...begun('line'), told: false },
  scc: { ...begun('line'), planner: 'scc', p: '0.8' },
  cfc: { ...begun('line'), planner: 'cfc', vehicle: 'car' },
  moving: { ...begun('bend'), moves: true, vehicle: 'car' },
  boat: { ...begun('circle'), size: '200 x 150', vehicle: 'boat' },
  lake: { ...begun('circle'), map: lake, vehicle: 'boat', start: [0, 0] },
};
for (const [name, state] of Object.entries(states)) {
  for (const [ending, program] of [['scenario', toml], ['rs', rust], ['py', python]]) writeFileSync(join(folder, `${name}.${ending}`), program(state));
}
writeFileSync(join(folder, 'area.geojson'), lake);
// Shapes, coasts and lakes take long to read.
const sensors = [SENSORS[0], SENSORS.at(-1)];
const choices = Object.keys(KINDS).map((kind) => states[kind]).concat(states.lake).flatMap((state) =>
  PLANNERS.flatMap(([planner]) => sensors.flatMap(([p]) => VEHICLES.flatMap(([vehicle]) => (state.kind === 'line' || state.kind === 'bend' ? [true, false] : [true]).map((told) => ({ ...state, planner, p, vehicle, told }))))));
const beside = join(folder, 'choices');
rmSync(beside, { recursive: true, force: true });
mkdirSync(beside);
for (const [number, choice] of choices.entries()) writeFileSync(join(beside, `${number}.scenario`), toml(allowed(choice, number % 7 < 3 ? 'vehicle' : 'planner').state));
writeFileSync(join(beside, 'area.geojson'), lake);
