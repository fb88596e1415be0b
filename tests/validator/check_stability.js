// node check_stability.js TOOL DOCS WORK: see check_schemas.sh. Exit status 1 where a schema and the tool disagree.
const fs = require('fs');
const path = require('path');
const { spawnSync } = require('child_process');
const Ajv = require('ajv');

const [tool, docs, work] = process.argv.slice(2);
const load = name => JSON.parse(fs.readFileSync(path.join(docs, 'schemas', name), 'utf8'));
const ajv = new Ajv({ allErrors: true });
const permits_line = ajv.compile(load('results.schema.json'));
const permits_study = ajv.compile(load('stability-study.schema.json'));
const permits_document = ajv.compile(load('stability.schema.json'));
let checks = 0, failed = 0;
const check = (good, what) => { ++checks; if (!good) ++failed, console.log(`FAILED: ${what}`); };
const results = path.join(work, 'results.jsonl');
const run = study => {
  const file = path.join(work, 'study.json');
  fs.rmSync(results, { force: true });
  fs.writeFileSync(file, JSON.stringify(study));
  return spawnSync(tool, ['stability', '--study', file, '--results', results, '--json'],
                   { encoding: 'utf8', maxBuffer: 1 << 28 });
};

const study = { command: 'stability', surfaces: ['torus', 'sphere', 'bezier-patch'], points: 5, samples: 1, seed: 3 };
check(permits_study(study), JSON.stringify(permits_study.errors));
const { status, stdout } = run(study);
check(status <= 1, 'the study runs');
const document = JSON.parse(stdout);
check(permits_document(document), JSON.stringify(permits_document.errors).slice(0, 500));
check(document.curves.some(c => c.error_u.includes(null)), 'an error without end is null');
const lines = fs.readFileSync(results, 'utf8').trimEnd().split('\n').map(line => JSON.parse(line));
check(lines.length > 20, `${lines.length} lines`);
for (const line of lines) check(permits_line(line), `${JSON.stringify(line).slice(0, 200)}: ${JSON.stringify(permits_line.errors).slice(0, 300)}`);
// The schema is no empty one.
for (const key of Object.keys(document)) {
  const { [key]: dropped, ...less } = document;
  check(!permits_document(less), `the schema permits a document without ${key}`);
}
for (const key of Object.keys(document.curves[0])) {
  const { [key]: dropped, ...less } = document.curves[0];
  check(!permits_document({ ...document, curves: [less] }), `the schema permits a curve without ${key}`);
}
// Every sweep and route that the tool knows is known to the schema, and the other way round.
const help = spawnSync(tool, ['stability', '--help'], { encoding: 'utf8' }).stdout.replace(/\s+/g, ' ');
const curve = load('results.schema.json').definitions.stability_curve.properties;
for (const [option, names] of [['--sweeps', curve.sweep.enum], ['--routes', curve.route.enum]])
  check(help.includes(`some of ${names.join(', ')} [all]`), `${option}: the help lists ${names.join(', ')}`);
// What both permit, and what both refuse.
const small = { command: 'stability', surfaces: ['sphere'], points: 2, samples: 1 };
for (const more of [{ $schema: 'x' }, { preset: 'quick' }, { seed: 0 }, { sweeps: ['scale'] }, { routes: ['naive'] }]) {
  check(permits_study({ ...small, ...more }), `the schema refuses ${JSON.stringify(more)}`);
  check(run({ ...small, ...more }).status <= 1, `the tool refuses ${JSON.stringify(more)}`);
}
for (const more of [{ command: 'converge' }, { more: 1 }, { preset: 'slow' }, { surfaces: [] }, { surfaces: [1] }, { sweeps: ['nope'] },
                    { routes: 'double' }, { points: 1 }, { samples: 0 }, { points: 2.5 }, { seed: -1 }]) {
  check(!permits_study({ ...small, ...more }), `the schema permits ${JSON.stringify(more)}`);
  check(run({ ...small, ...more }).status === 2, `the tool permits ${JSON.stringify(more)}`);
}
console.log(`${checks} checks, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
