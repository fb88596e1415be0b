#!/usr/bin/env bash
# coverage.sh: builds with the preset coverage, runs the tests, and prints the lines and branches of src,
# include and surfaces that they reach, by gcov. A line or branch of a header counts as reached where one of
# its instantiations is. Every file's count goes to build/coverage/files.txt, the lines not reached to
# build/coverage/missed.txt. Exit 1 where fewer than 92 % of the lines are.
#   RUN=0          counts what has run already
#   TESTS=FOLDER   takes the objects of the tests from this build, so that only libraries and tool are compiled:
#                  less is counted, as what tests alone make of templates is not. Runs the programs of the tests
#                  (or those that PROGRAMS names), each for at most LIMIT seconds (300), and names those that fail.
# Needs python3.
set -euo pipefail
cd "$(dirname "$0")/.."
# link_test FOLDER PROGRAM: by the command that linked it there, with the libraries of build/coverage.
link_test() {
  local command
  command=$(ninja -C "$1" -t commands -s "bin/$2" | grep -oE "[^ ]*c\\+\\+ .* -o bin/$2 [^&]*")
  command=${command/-o bin\/$2/-o $PWD/build/coverage/bin/$2 --coverage}
  command=$(sed -E "s# (libdarboux[a-z_]*\\.a)# $PWD/build/coverage/\\1#g" <<<"$command")
  (cd "$1" && bash -c "$command")
}
# run_tests FOLDER PROGRAM ...: those that run the tool know it by the name that it has in FOLDER.
run_tests() {
  local folder=$1 program
  tool=$(realpath "$folder/bin/darboux")
  shift
  trap 'mv "$tool.kept" "$tool"' EXIT
  mv "$tool" "$tool.kept"
  ln -s "$PWD/build/coverage/bin/darboux" "$tool"
  for program in "$@"; do
    local arguments=()
    [[ $program != fuzz_* ]] || arguments=("$PWD/tests/fuzz/corpus/$(sed 's/^fuzz_//; s/_decoders$//' <<<"$program")" 50)
    link_test "$folder" "$program"
    (cd build/coverage && timeout "${LIMIT:-300}" "bin/$program" "${arguments[@]}" >"$program.log" 2>&1) ||
      echo "FAILED: $program" >&2
  done
}
if [ "${RUN:-1}" = 1 ] && [ -n "${TESTS:-}" ]; then
  cmake --preset coverage >/dev/null
  cmake --build --preset coverage --target darboux darboux_fit darboux_io darboux_tool >/dev/null
  find build/coverage -name '*.gcda' -delete
  read -ra programs <<<"${PROGRAMS:-$(cd "$TESTS/bin" && echo *_test fuzz_*)}"
  run_tests "$TESTS" "${programs[@]}"
elif [ "${RUN:-1}" = 1 ]; then
  cmake --preset coverage >/dev/null
  cmake --build --preset coverage >/dev/null
  find build/coverage -name '*.gcda' -delete
  ctest --preset coverage -j 2 >build/coverage/tests.log || { grep -E 'Failed|tests passed' build/coverage/tests.log >&2; exit 2; }
fi
python3 - build/coverage "$PWD" <<'END'
import gzip, json, os, subprocess, sys, collections
build, root = sys.argv[1], sys.argv[2]
lines = collections.defaultdict(dict)     # file -> line -> how often
branches = collections.defaultdict(dict)  # file -> (line, number) -> how often
notes = [os.path.join(d, f) for d, _, files in os.walk(build) for f in files if f.endswith(".gcda")]
if not notes:
    sys.exit("coverage.sh: expected .gcda files of tests that ran, got none")
for at in range(0, len(notes), 16):
    out = subprocess.run(["gcov", "--json-format", "--branch-probabilities", "--stdout", *map(os.path.abspath, notes[at:at + 16])],
                         cwd=build, capture_output=True, check=True).stdout
    for document in out.splitlines():
        if not document.startswith(b"{"):
            continue
        for file in json.loads(document)["files"]:
            name = os.path.relpath(os.path.join(build, file["file"]), root)
            if name.split(os.sep)[0] not in ("src", "include", "surfaces"):
                continue
            for line in file["lines"]:
                number = line["line_number"]
                lines[name][number] = lines[name].get(number, 0) + line["count"]
                for i, branch in enumerate(b for b in line["branches"] if not b["throw"]):
                    key = (number, i)
                    branches[name][key] = branches[name].get(key, 0) + branch["count"]
def share(counts):
    values = [c for of_file in counts for c in of_file.values()]
    return sum(c > 0 for c in values), len(values)
with open(os.path.join(build, "files.txt"), "w") as files, open(os.path.join(build, "missed.txt"), "w") as missed:
    for name in sorted(lines, key=lambda n: share([lines[n]])[0] / max(1, len(lines[n]))):
        reached, all_lines = share([lines[name]])
        print(f"{100 * reached / all_lines:6.1f} % {reached:5} of {all_lines:5}  {name}", file=files)
        for number in sorted(n for n, c in lines[name].items() if c == 0):
            print(f"{name}:{number}", file=missed)
print("| folder | lines | reached | branches | reached |\n|---|---|---|---|---|")
for folder in ("src", "include", "surfaces", ""):
    of = [n for n in lines if n.startswith(folder)]
    (r, n), (br, bn) = share(lines[f] for f in of), share(branches[f] for f in of)
    print(f"| {folder or 'all'} | {n} | {100 * r / max(1, n):.1f} % | {bn} | {100 * br / max(1, bn):.1f} % |")
reached, n = share(lines.values())
sys.exit(0 if reached >= 0.92 * n else "coverage.sh: expected 92 % of the lines, got less")
END
