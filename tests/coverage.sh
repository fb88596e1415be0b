#!/usr/bin/env bash
# coverage.sh: builds with the preset coverage, runs the tests, and prints the lines and branches of src,
# include and surfaces that they reach, by gcov. A line or branch of a header counts as reached where one of
# its instantiations is. Every file's count goes to build/coverage/files.txt, the lines not reached to
# build/coverage/missed.txt. Exit 1 where fewer than 92 % of the lines are.
#   RUN=0    counts what has run already
# Needs python3.
set -euo pipefail
cd "$(dirname "$0")/.."
if [ "${RUN:-1}" = 1 ]; then
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
    gcov = subprocess.run(["gcov", "--json-format", "--branch-probabilities", "--stdout", *map(os.path.abspath, notes[at:at + 16])],
                          cwd=build, capture_output=True)
    if gcov.returncode != 0:  # as where a source was compiled again after its test ran
        sys.exit("coverage.sh: " + gcov.stderr.decode(errors="replace"))
    for document in gcov.stdout.splitlines():
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
