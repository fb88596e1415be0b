// node check_normalmap.js TOOL DOCS WORK: see check_schemas.sh. Exit status 1 where the schema and the tool
// disagree.
const fs = require('fs');
const path = require('path');
const { spawnSync } = require('child_process');
const Ajv = require('ajv');

const [tool, docs, work] = process.argv.slice(2);
const permits = new Ajv({ allErrors: true })
  .compile(JSON.parse(fs.readFileSync(path.join(docs, 'schemas/normalmap.schema.json'), 'utf8')));
let checks = 0, failed = 0;
const check = (good, what) => { ++checks; if (!good) ++failed, console.log(`FAILED: ${what}`); };
const call = (...parameters) => spawnSync(tool, parameters, { encoding: 'utf8', cwd: work });

call('mesh', 'torus', '--grid', '12x6', '-o', 'low.glb');
call('mesh', 'torus', '--grid', '12x6', '--mirror', '-o', 'mirrored.glb');
call('mesh', 'sphere', '--grid', '12x6', '-o', 'sphere.glb');
const bake = ['bake', '--surface', 'torus', '--mesh', 'low.glb', '--size', '64x64', '-o', 'tangent.png'];
const to_object = ['normalmap', 'tangent.png', '--from', 'tangent', '--to', 'object', '-o', 'object.png'];
for (const [status, ...parameters] of [
  [0, ...bake], [0, ...bake, '--samples', '0'],
  [0, 'bake', '--surface', 'sphere', '--mesh', 'sphere.glb', '--size', '32x16', '-o', 'sphere.exr'],
  [0, ...to_object, '--mesh', 'low.glb'], [1, ...to_object, '--mesh', 'mirrored.glb'],
  [0, ...to_object, '--surface', 'torus'],
  [0, 'normalmap', '--check', 'tangent.png'], [1, 'normalmap', '--check', 'object.png'],
  [0, 'normalmap', '--compare', 'tangent.png', 'tangent.png'],
  [1, 'normalmap', '--compare', 'tangent.png', 'object.png', '--mesh', 'low.glb'],
  [0, 'normalmap', 'tangent.png', '--from', 'tangent', '--mesh', 'low.glb', '--render', 'lit.png',
    '--size', '40x30']]) {
  const result = call(...parameters, '--json');
  check(result.status === status, `${parameters.join(' ')}: status ${result.status}: ${result.stderr}`);
  const json = JSON.parse(result.stdout);
  check(permits(json), `${parameters.join(' ')}: ${JSON.stringify(permits.errors).slice(0, 800)}`);
  // The schema is no empty one.
  for (const key of Object.keys(json)) {
    const { [key]: dropped, ...less } = json;
    check(!permits(less), `the schema permits ${parameters[0]} without ${key}`);
  }
  check(!permits({ ...json, more: 1 }), `the schema permits ${parameters[0]} with another key`);
}
console.log(`${checks} checks, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
