#!/usr/bin/env bash
# sbom.sh [OUTPUT]: what Darboux is built from, as an SPDX 2.3 document: the sources of this commit, the
# Debian packages of kind "build" in .ci/packages with their versions here, and those that the tool loads or
# has compiled in. Without network. Its date is that of the commit (SOURCE_DATE_EPOCH wins), so that the
# same commit and packages give the same bytes.
set -euo pipefail
cd "$(dirname "$0")/../.."
export LC_ALL=C
output=${1:-/dev/stdout}
version=$(sed -nE 's/^project\(darboux VERSION ([0-9.]+).*/\1/p' CMakeLists.txt)
commit=$(git rev-parse HEAD)
date=$(date -u -d "@${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}" +%Y-%m-%dT%H:%M:%SZ)
missing=()
packages=() relations=()
while read -r package; do
  installed=$(dpkg-query -W -f='${Version} ${Architecture}' "$package" 2>/dev/null) || { missing+=("$package"); continue; }
  read -r of_package architecture <<<"$installed"
  id="SPDXRef-Package-${package//[^A-Za-z0-9.-]/-}"
  packages+=("    {\"SPDXID\": \"$id\", \"name\": \"$package\", \"versionInfo\": \"$of_package\",
     \"supplier\": \"Organization: Debian\", \"downloadLocation\": \"NOASSERTION\", \"filesAnalyzed\": false,
     \"licenseConcluded\": \"NOASSERTION\", \"licenseDeclared\": \"NOASSERTION\", \"copyrightText\": \"NOASSERTION\",
     \"externalRefs\": [{\"referenceCategory\": \"PACKAGE-MANAGER\", \"referenceType\": \"purl\",
       \"referenceLocator\": \"pkg:deb/debian/${package//+/%2B}@${of_package//+/%2B}?arch=$architecture\"}]}")
  case $package in
    g++ | cmake | ninja-build) relation=BUILD_TOOL_OF ;;
    *) relation=DEPENDENCY_OF ;;
  esac
  relations+=("    {\"spdxElementId\": \"$id\", \"relationshipType\": \"$relation\", \"relatedSpdxElement\": \"SPDXRef-darboux\"}")
done < <(sed -n 's/^build //p' .ci/packages)
if [ ${#missing[@]} -gt 0 ]; then
  echo "sbom.sh: expected the packages of .ci/packages, got none of: ${missing[*]}" >&2
  exit 1
fi
listed() {
  local first=1
  for entry in "$@"; do
    [ $first = 1 ] || printf ',\n'
    printf '%s' "$entry"
    first=0
  done
}
unfinished=$(mktemp)
trap 'rm -f "$unfinished"' EXIT
cat >"$unfinished" <<END
{
  "spdxVersion": "SPDX-2.3",
  "dataLicense": "CC0-1.0",
  "SPDXID": "SPDXRef-DOCUMENT",
  "name": "darboux-$version",
  "documentNamespace": "https://spdx.org/spdxdocs/darboux-$version-$commit",
  "creationInfo": {"created": "$date", "creators": ["Tool: darboux-tests-package-sbom"]},
  "packages": [
    {"SPDXID": "SPDXRef-darboux", "name": "darboux", "versionInfo": "$version",
     "downloadLocation": "NOASSERTION", "filesAnalyzed": false, "sourceInfo": "commit $commit",
     "licenseConcluded": "NOASSERTION", "licenseDeclared": "MIT",
     "copyrightText": "$(grep -m1 -i '^copyright' LICENSE | sed 's/"/\\"/g')"},
$(listed "${packages[@]}")
  ],
  "relationships": [
    {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-darboux"},
$(listed "${relations[@]}")
  ]
}
END
cat "$unfinished" >"$output"
