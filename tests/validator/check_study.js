// node check_study.js TOOL DOCS WORK: see check_schemas.sh. Exit status 1 where a schema and the tool disagree.
const fs = require('fs');
const path = require('path');
const { spawnSync } = require('child_process');
const Ajv = require('ajv');

const [tool, docs, work] = process.argv.slice(2);
const load = name => JSON.parse(fs.readFileSync(path.join(docs, 'schemas', name), 'utf8'));
const permits_study = new Ajv({ allErrors: true }).compile(load('converge-study.schema.json'));
const ajv = new Ajv({ allErrors: true });
const permits_line = ajv.compile(load('results.schema.json')), permits_document = ajv.compile(load('converge.schema.json'));
let checks = 0, failed = 0;
const check = (good, what) => { ++checks; if (!good) ++failed, console.log(`FAILED: ${what}`); };
const results = path.join(work, 'results.jsonl');
const run = study => {
  const file = path.join(work, 'study.json');
  fs.rmSync(results, { force: true });
  fs.writeFileSync(file, JSON.stringify(study));
  return spawnSync(tool, ['converge', '--study', file, '--results', results, '--quiet'], { encoding: 'utf8' });
};

const study = { command: 'converge', surfaces: ['torus', 'sphere'], methods: ['face', 'quadratic'], meshes: ['jittered'],
                resolutions: [4, 6, 8], v_range: [0, 1], seed: 3 };
check(permits_study(study), JSON.stringify(permits_study.errors));
check(run(study).status <= 1, 'the study runs');
const lines = fs.readFileSync(results, 'utf8').trimEnd().split('\n').map(line => JSON.parse(line));
check(lines.length === 2 + 18, `${lines.length} lines`);
// The document: nothing is missing, and nothing may be.
const document = JSON.parse(spawnSync(tool, ['converge', '--study', path.join(work, 'study.json'), '--json'],
                                      { encoding: 'utf8', maxBuffer: 1 << 28 }).stdout);
check(permits_document(document), JSON.stringify(permits_document.errors).slice(0, 800));
for (const key of Object.keys(document)) {
  const { [key]: dropped, ...less } = document;
  check(!permits_document(less), `the schema permits a document without ${key}`);
}
for (const key of Object.keys(document.studies[0])) {
  const { [key]: dropped, ...less } = document.studies[0];
  check(!permits_document({ ...document, studies: [less] }), `the schema permits a study without ${key}`);
}
for (const line of lines) check(permits_line(line), `${JSON.stringify(line).slice(0, 200)}: ${JSON.stringify(permits_line.errors)}`);
// The schema is no empty one.
for (const line of lines)
  for (const key of Object.keys(line)) {
    const { [key]: dropped, ...less } = line;
    check(!permits_line(less), `the schema permits a line without ${key}`);
    check(!permits_line({ ...line, more: 1 }), 'the schema permits another key');
  }
// What both permit.
for (const more of [{ $schema: 'x' }, { preset: 'quick' }, { seed: 0 }, { meshes: ['regular', 'sheared', 'jittered-diagonals', 'mirrored', 'graded', 'inverted'] },
                    { surfaces: ['sphere'], meshes: ['shared-poles'] }, { surfaces: ['cylinder'], meshes: ['lantern'] },
                    { seeds: 1 }]) {
  const right = { ...study, ...more };
  check(permits_study(right), `the schema refuses ${JSON.stringify(more)}`);
  const { status, stderr } = run(right);
  check(status <= 1, `the tool refuses ${JSON.stringify(more)}: ${stderr}`);
}
// What both refuse.
for (const more of [{ command: 'check' }, { more: 1 }, { preset: 'slow' }, { surfaces: [] }, { surfaces: [1] }, { methods: 'face' },
                    { meshes: ['nope'] }, { resolutions: [4, 8] }, { resolutions: [4, 8, 2000] }, { resolutions: [4, 8, 8.5] },
                    { v_range: [0] }, { v_range: [0, 2] }, { seed: -1 }, { seed: '1' }, { seeds: 0 }, { seeds: 1.5 }]) {
  const wrong = { ...study, ...more };
  check(!permits_study(wrong), `the schema permits ${JSON.stringify(more)}`);
  check(run(wrong).status === 2, `the tool permits ${JSON.stringify(more)}`);
}
console.log(`${checks} checks, ${failed} failed`);
process.exit(failed > 0 ? 1 : 0);
