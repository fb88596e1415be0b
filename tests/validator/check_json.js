// node check_json.js SCHEMA FILE...: whether our own schema permits what `darboux validate --json` printed. Exit status 1 where it does
// not. The schema is strict, so that a key it does not know is found.
const fs = require('fs');
const Ajv = require('ajv');

const permits = new Ajv({allErrors: true}).compile(JSON.parse(fs.readFileSync(process.argv[2], 'utf8')));
let failed = 0, meshes = 0, sample = null;
for (const file of process.argv.slice(3)) {
  const report = JSON.parse(fs.readFileSync(file, 'utf8'));
  for (const f of report.files) meshes += f.meshes.length;
  if (!sample && report.files.some(f => f.meshes.length > 0)) sample = report;
  if (permits(report)) continue;
  ++failed;
  const errors = permits.errors.slice(0, 8).map(e => `${e.dataPath} ${e.message} ${JSON.stringify(e.params)}`);
  console.log(`FAILED: ${file}: ${errors.join('\n  ')}`);
}

// What is wrong must be refused, or the above says nothing.
const changes = [r => { delete r.verdict; }, r => { r.verdict = 'good'; }, r => { r.more = 1; },
                 r => { r.files.find(f => f.meshes.length > 0).meshes[0].corners = -1; },
                 r => { r.files.find(f => f.meshes.length > 0).meshes[0].references.more = {}; },
                 r => { r.files.find(f => f.meshes.length > 0).meshes[0].findings.push({code: 'A'}); }];
for (const change of changes) {
  const wrong = JSON.parse(JSON.stringify(sample));
  change(wrong);
  if (permits(wrong)) ++failed, console.log(`FAILED: the schema permits ${change}`);
}
console.log(`JSON: ${process.argv.length - 3} files, ${meshes} meshes, ${failed} failures`);
process.exit(failed > 0 || meshes === 0 ? 1 : 0);
