// node check_sarif.js FILE...: whether the schema of SARIF 2.1.0 permits the files. Exit status 1 where it does not.
const fs = require('fs');
const Ajv = require('ajv');
const schema = require('@microsoft/jest-sarif/lib/schemas/sarif-2.1.0-rtm.5.json');

const ajv = new Ajv({schemaId: 'id', meta: false, format: 'full', allErrors: true});  // as draft 4 has it
ajv.addMetaSchema(require('ajv/lib/refs/json-schema-draft-04.json'));
const permits = ajv.compile(schema);

let failed = 0, results = 0;
for (const file of process.argv.slice(2)) {
  const text = fs.readFileSync(file, 'utf8'), log = JSON.parse(text);
  for (const run of log.runs) results += run.results.length;
  const fault = text => { ++failed, console.log(`FAILED: ${file}: ${text}`); };
  // Links lead to the web, or there are none: a path where the tool was installed says nothing to a reader.
  for (const rule of log.runs.flatMap(run => run.tool.driver.rules))
    if (rule.helpUri && !/^https?:.*\/findings\.md#/.test(rule.helpUri)) fault(`${rule.id} links to ${rule.helpUri}`);
    else if (!rule.help?.text) fault(`${rule.id} has no help`);
  const seen = new Set();
  for (const r of log.runs.flatMap(run => run.results)) {
    const key = r.locations[0].physicalLocation.artifactLocation.uri + ' ' + r.partialFingerprints.primaryLocationLineHash;
    if (seen.has(key)) fault(`two results have the fingerprint ${key}`);
    seen.add(key);
  }
  if (permits(log)) continue;
  ++failed;
  console.log(`FAILED: ${file}: ${ajv.errorsText(permits.errors, {separator: '\n  '})}`);
}

// What is wrong must be refused, or the above says nothing.
const wrong = change => {
  const result = {ruleId: 'R', level: 'error', message: {text: 'm'},
                  locations: [{physicalLocation: {artifactLocation: {uri: 'a'}, region: {startLine: 1}}}]};
  change(result);
  return {version: '2.1.0', runs: [{tool: {driver: {name: 'darboux'}}, results: [result]}]};
};
const changes = [r => { delete r.message; }, r => { r.level = 'fatal'; }, r => { r.baselineState = 'known'; }, r => { r.file = 'a'; },
                 r => { r.locations[0].physicalLocation.artifactLocation.uri = 'a b'; },
                 r => { r.locations[0].physicalLocation.region.startLine = 0; }];
if (!permits(wrong(() => {})) || changes.some(change => permits(wrong(change)))) {
  ++failed;
  console.log('FAILED: the schema does not tell right from wrong');
}
console.log(`SARIF: ${process.argv.length - 2} files, ${results} results, ${failed} failures`);
process.exit(failed > 0 || results === 0 ? 1 : 0);
