#!/usr/bin/env bash
# check_sbom.sh SOURCE: tests/package/sbom.sh writes JSON with every package of kind "build" in
# .ci/packages, and the same bytes twice. Skipped, aloud, outside of a git repository or where packages are
# not from Debian.
set -euo pipefail
cd "$1"
git rev-parse HEAD >/dev/null 2>&1 || { echo "SKIPPED: no git repository"; exit 77; }
command -v node >/dev/null || { echo "SKIPPED: no node"; exit 77; }
command -v dpkg-query >/dev/null || { echo "SKIPPED: no dpkg"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
tests/package/sbom.sh "$work/one"
tests/package/sbom.sh "$work/two"
cmp "$work/one" "$work/two"
node - "$work/one" .ci/packages <<'END'
const assert = require('assert'), fs = require('fs');
const document = JSON.parse(fs.readFileSync(process.argv[2], 'utf8'));
assert.equal(document.spdxVersion, 'SPDX-2.3');
assert.match(document.creationInfo.created, /^\d{4}-\d\d-\d\dT\d\d:\d\d:\d\dZ$/);
const names = document.packages.map((p) => p.name);
const listed = fs.readFileSync(process.argv[3], 'utf8').split('\n').filter((l) => l.startsWith('build ')).map((l) => l.split(' ')[1]);
assert.deepEqual(names, ['darboux', ...listed]);
const ids = new Set(['SPDXRef-DOCUMENT', ...document.packages.map((p) => p.SPDXID)]);
assert.equal(ids.size, names.length + 1);
for (const r of document.relationships) assert(ids.has(r.spdxElementId) && ids.has(r.relatedSpdxElement));
assert(document.packages.every((p) => p.versionInfo));
console.log(`${names.length} packages`);
END
