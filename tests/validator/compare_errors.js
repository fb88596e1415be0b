// node compare_errors.js IN OUT: for every file of OUT the validator's errors that the file of the same name in IN, if there is one,
// lacks: an error is its code, message and place. Exit status 1 where there is one.
const fs = require('fs');
const path = require('path');
const { validateBytes } = require('gltf-validator');

async function errors(file) {
  const counts = new Map();
  if (!fs.existsSync(file)) return counts;
  const bytes = new Uint8Array(fs.readFileSync(file));
  for (const m of (await validateBytes(bytes, { maxIssues: 0 })).issues.messages) {
    if (m.severity !== 0) continue;
    const error = `${m.code} ${m.message} ${m.pointer || m.offset}`;
    counts.set(error, (counts.get(error) || 0) + 1);
  }
  return counts;
}

(async () => {
  const [, , before, after] = process.argv;
  const files = fs.readdirSync(after).sort();
  let fresh = 0;
  for (const file of files) {
    const old = await errors(path.join(before, file));
    for (const [error, count] of await errors(path.join(after, file)))
      if (count > (old.get(error) || 0)) {
        ++fresh;
        console.log(`FAILED: ${file}: ${error}, ${count} times, ${old.get(error) || 0} before`);
      }
  }
  console.log(`${files.length} files, ${fresh} new errors`);
  process.exit(fresh > 0 || files.length === 0 ? 1 : 0);
})();
