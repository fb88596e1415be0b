// node check_scene.js TOOL DOCS WORK: see check_schemas.sh. Exit status 1 where a schema and the tool disagree.
const fs = require('fs');
const path = require('path');
const { spawnSync } = require('child_process');
const Ajv = require('ajv');

const [tool, docs, work] = process.argv.slice(2);
const load = name => JSON.parse(fs.readFileSync(path.join(docs, name), 'utf8'));
const permits_scene = new Ajv({ allErrors: true }).compile(load('schemas/scene.schema.json'));
const permits_plan = new Ajv({ allErrors: true }).compile(load('schemas/scene-plan.schema.json'));
let checks = 0, failed = 0;
const check = (good, what) => { ++checks; if (!good) ++failed, console.log(`FAILED: ${what}`); };
const copy = json => JSON.parse(JSON.stringify(json));

const run = (scene, ...options) => {
  const file = path.join(work, 'scene.json');
  fs.writeFileSync(file, JSON.stringify(scene));
  return spawnSync(tool, ['scene', file, ...options], { encoding: 'utf8' });
};

// What the tool prints.
const scene = load('examples/scene.json');
let plan = null;
for (const [name, ...options] of [['scene'], ['scene', '--camera', '1'], ['scene', '--no-skip'], ['scene', '--chord', '0.1'],
                                  ['asteroids'], ['asteroids', '--no-cull']]) {
  const json = load(`examples/${name}.json`);
  check(permits_scene(json), `${name}.json: ${JSON.stringify(permits_scene.errors)}`);
  const { status, stdout, stderr } = run(json, '--json', ...options);
  check(status === 0, `${name} ${options}: status ${status}: ${stderr}`);
  plan = JSON.parse(stdout);
  check(permits_plan(plan), `${name} ${options}: ${JSON.stringify(permits_plan.errors)}`);
}
for (const change of [p => { delete p.needed; }, p => { p.more = 1; }, p => { p.skipped.more = 1; }, p => { p.seconds.plan = '1'; },
                      p => { p.needed.attributes.colour = 1; }, p => { p.samples_full = -1; }]) {
  const wrong = copy(plan);
  change(wrong);
  check(!permits_plan(wrong), `the schema permits the plan after ${change}`);
}

// What both permit.
for (const change of [s => { delete s.$schema; }, s => { delete s.request; }, s => { delete s.materials; s.instances = [{ surface: 'ring' }]; },
                      s => { s.instances[1].scale = [1, -2, 1]; }, s => { s.request = { chord: 0.01 }; },
                      s => { s.instances = [{ surface: 'ball', matrix: [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1] }]; },
                      s => { s.cameras[1].orthographic.near = -1; }, s => { delete s.cameras[0].up; },
                      s => { delete s.instances; s.scatter = { count: 3, nearest_radii: 2, farthest_radii: 3, surfaces: ['ball'] }; }]) {
  const right = copy(scene);
  change(right);
  check(permits_scene(right), `the schema refuses the scene after ${change}: ${JSON.stringify(permits_scene.errors)}`);
  const { status, stderr } = run(right);
  check(status === 0, `the tool refuses the scene after ${change}: ${stderr}`);
}
// What both refuse.
const scatter = { count: 3, nearest_radii: 2, farthest_radii: 3 };
for (const change of [s => { s.more = 1; }, s => { delete s.surfaces; }, s => { s.surfaces = {}; }, s => { s.surfaces.ring = 1; },
                      s => { s.materials.plain.more = true; }, s => { s.materials.plain.normal_map = 1; },
                      s => { s.materials.plain.displacement = -1; }, s => { s.cameras = []; }, s => { delete s.cameras[0].perspective; },
                      s => { s.cameras[0].orthographic = s.cameras[1].orthographic; }, s => { s.cameras[0].more = 1; },
                      s => { s.cameras[0].perspective.vertical_field_of_view_deg = 0; },
                      s => { s.cameras[0].perspective.vertical_field_of_view_deg = 180; }, s => { delete s.cameras[0].perspective.far; },
                      s => { s.cameras[0].perspective.near = 0; }, s => { s.cameras[1].orthographic.height = 0; },
                      s => { s.cameras[0].width_px = 0; }, s => { s.cameras[0].height_px = 1.5; }, s => { delete s.cameras[0].eye; },
                      s => { s.cameras[0].eye = [1, 2]; }, s => { delete s.instances; }, s => { s.instances[0].more = 1; },
                      s => { delete s.instances[0].surface; }, s => { s.instances[0].rotation = [0, 0, 1]; },
                      s => { s.instances[0].scale = 'big'; }, s => { s.instances[0].matrix = Array(16).fill(1); },
                      s => { s.instances[0].matrix = Array(15).fill(1); }, s => { s.request.chord_px = 0; }, s => { s.request.chord = -1; },
                      s => { s.request.angle_deg = 0; }, s => { s.request.attributes = []; }, s => { s.request.attributes = ['colour']; },
                      s => { s.request.more = 1; }, s => { s.scatter = { ...scatter, count: 0 }; }, s => { s.scatter = { ...scatter, more: 1 }; },
                      s => { s.scatter = { ...scatter, seed: -1 }; }, s => { s.scatter = { ...scatter, surfaces: [] }; },
                      s => { s.scatter = { count: 3 }; }]) {
  const wrong = copy(scene);
  change(wrong);
  check(!permits_scene(wrong), `the schema permits the scene after ${change}`);
  const { status, stderr } = run(wrong);
  check(status === 2 && stderr.trim().split('\n').length === 1, `the tool permits the scene after ${change}: ${status} ${stderr}`);
}
console.log(`scenes: ${checks} checks, ${failed} failures`);
process.exit(failed > 0 ? 1 : 0);
