// node check_work_precision.js TOOL DOCS WORK: see check_schemas.sh. Exit status 1 where a schema and the tool disagree.
const fs = require('fs');
const path = require('path');
const { spawnSync } = require('child_process');
const Ajv = require('ajv');

const [tool, docs, work] = process.argv.slice(2);
const load = name => JSON.parse(fs.readFileSync(path.join(docs, 'schemas', name), 'utf8'));
const ajv = new Ajv({ allErrors: true });
const permits_line = ajv.compile(load('results.schema.json'));
const permits_study = ajv.compile(load('work-precision-study.schema.json'));
const permits_document = ajv.compile(load('work-precision.schema.json'));
let checks = 0, failed = 0;
const check = (good, what) => { ++checks; if (!good) ++failed, console.log(`FAILED: ${what}`); };
const results = path.join(work, 'results.jsonl');
const call = parameters => spawnSync(tool, ['work-precision', ...parameters], { encoding: 'utf8', maxBuffer: 1 << 28 });
const run = study => {
  const file = path.join(work, 'study.json');
  fs.rmSync(results, { force: true });
  fs.writeFileSync(file, JSON.stringify(study));
  return call(['--study', file, '--results', results, '--json']);
};

const small = { command: 'work-precision', surfaces: ['sphere'], resolutions: [4], rounds: 3, points: 64, checked: 64 };
const study = { ...small, surfaces: ['torus', 'sphere'], meshes: ['jittered', 'regular'], resolutions: [4, 8], rounds: 5, seed: 3 };
check(permits_study(study), JSON.stringify(permits_study.errors));
const { status, stdout } = run(study);
check(status === 0, 'the study runs');
const document = JSON.parse(stdout);
check(permits_document(document), JSON.stringify(permits_document.errors).slice(0, 800));
const lines = fs.readFileSync(results, 'utf8').trimEnd().split('\n').map(line => JSON.parse(line));
check(lines.length === 2 + 2 * 3, `${lines.length} lines`);
for (const line of lines) check(permits_line(line), `${JSON.stringify(line).slice(0, 200)}: ${JSON.stringify(permits_line.errors).slice(0, 300)}`);
// What fails is permitted too: no call is done in a billionth of a second.
const late = JSON.parse(call(['sphere', '--methods', 'naive,face', '--resolutions', '4,8', '--timeout', '1e-9', '--json']).stdout);
check(permits_document(late), JSON.stringify(permits_document.errors).slice(0, 800));
check(!late.holds && late.samples.length === 3 && late.samples.every(s => s.failure !== null), 'calls that take too long are failures');
// The schema is no empty one.
for (const key of Object.keys(document)) {
  const { [key]: dropped, ...less } = document;
  check(!permits_document(less), `the schema permits a document without ${key}`);
}
for (const key of Object.keys(document.samples[0])) {
  const { [key]: dropped, ...less } = document.samples[0];
  check(!permits_document({ ...document, samples: [less] }), `the schema permits a sample without ${key}`);
}
const metrics = load('results.schema.json').definitions.work_sample.properties.metrics.properties;
const found = new Set(document.samples.flatMap(s => Object.keys(s.metrics)));
for (const metric of Object.keys(metrics)) check(found.has(metric), `no sample has ${metric}`);
// Two runs.
const before = path.join(work, 'before.json'), after = path.join(work, 'after.json');
fs.writeFileSync(before, stdout);
for (const [documents, verdict, exit] of [[document, 'same', 0], [{ ...late, study: document.study, samples: late.samples.map(s => ({ ...s, surface: document.samples[0].surface })) }, 'failed', 1]]) {
  fs.writeFileSync(after, JSON.stringify(documents));
  const { status, stdout } = call(['--compare', before, after, '--json']);
  const comparison = JSON.parse(stdout);
  check(permits_document(comparison), JSON.stringify(permits_document.errors).slice(0, 500));
  check(status === exit && comparison.pairs.some(p => p.verdict === verdict), `${verdict}: status ${status}`);
  for (const key of Object.keys(comparison.pairs[0])) {
    const { [key]: dropped, ...less } = comparison.pairs[0];
    check(!permits_document({ ...comparison, pairs: [less] }), `the schema permits a pair without ${key}`);
  }
}
// What both permit, and what both refuse.
for (const more of [{ $schema: 'x' }, { preset: 'quick' }, { seed: 0 }, { methods: ['naive', 'averages'] }, { meshes: ['sheared'] }, { timeout: 0.5 }]) {
  check(permits_study({ ...small, ...more }), `the schema refuses ${JSON.stringify(more)}`);
  check(run({ ...small, ...more }).status <= 1, `the tool refuses ${JSON.stringify(more)}`);
}
for (const more of [{ command: 'stability' }, { more: 1 }, { preset: 'slow' }, { surfaces: [] }, { surfaces: [1] }, { meshes: ['nope'] },
                    { methods: 'naive' }, { methods: [] }, { rounds: 2 }, { points: 15 }, { checked: 0 }, { timeout: 0 }, { rounds: 3.5 },
                    { resolutions: [] }, { resolutions: [1] }, { seed: -1 }]) {
  check(!permits_study({ ...small, ...more }), `the schema permits ${JSON.stringify(more)}`);
  check(run({ ...small, ...more }).status === 2, `the tool permits ${JSON.stringify(more)}`);
}
console.log(`${checks} checks, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
