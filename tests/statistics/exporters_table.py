# exporters_table.py REPORT.json...: tables of verdicts per writer and format, and the files that fail.
import collections
import json
import os
import sys

print("| writer | format | files | pass | fail |")
print("|---|---|---:|---:|---:|")
failed = []
for path in sys.argv[1:]:
    writer = os.path.splitext(os.path.basename(path))[0]
    verdicts = collections.defaultdict(collections.Counter)
    for file in json.load(open(path))["files"]:
        name = os.path.basename(file["file"])
        kind = name.split(".", 1)[1]
        verdicts[kind][file["verdict"]] += 1
        if file["verdict"] == "fail":
            codes = sorted({f["code"] + f" ({f['count']})" for m in file["meshes"] for f in m["findings"] if f["severity"] == "error"})
            failed.append(f"| {writer} | {name} | {', '.join(codes)} |")
    for kind, counts in sorted(verdicts.items()):
        print(f"| {writer} | {kind} | {counts['pass'] + counts['fail']} | {counts['pass']} | {counts['fail']} |")
print()
print("| writer | file that fails | errors (corners) |")
print("|---|---|---|")
print("\n".join(failed))
