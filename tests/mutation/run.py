#!/usr/bin/env python3
"""Mutation run over surfaces/darboux: does the library notice when a formula is wrong?

Each sign, operator, factor, constant and index of every function that computes (jet, frame, singular, the facts, their
helpers) is changed, one at a time; a tiny program of that one surface is compiled and the laws of testing.h are run on
it; where all hold, the tests of what no law can see (TESTS below) are compiled with the changed header. A mutant is
killed when a law or test fails, or it crashes or hangs. One that does not compile is not counted.

    tests/mutation/run.py --count                     how many mutants there are
    tests/mutation/run.py --surfaces torus,sphere     all mutants of two surfaces
    tests/mutation/run.py --per-surface 40 --seed 1   a sample, the same for the same seed
    tests/mutation/run.py --report docs/reports/mutation.md

Results are kept in --results; a run that was interrupted goes on where it stopped, and a mutant whose header has not
changed is not run again (--fresh forgets them). Needs a C++20 compiler and GoogleTest. Not part of CI.
"""

import argparse
import concurrent.futures
import datetime
import hashlib
import json
import math
import os
import platform
import random
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
HERE = Path(__file__).resolve().parent
HEADERS = ROOT / "surfaces" / "darboux"

# What the catalogue's tests ask beyond the laws: the status at declared points, the limits from either side, creases.
TESTS = ["singular_points_test", "spline_test", "tube_test", "user_functions_test", "curve_refusals_test"]

# Functions that compute nothing a law could look at: texts, accessors, the default data of splines, conversions.
NOT_FORMULAS = {"parameters", "refusal", "rebind", "example_points", "example_weights", "example_knots",
                "requires", "weights", "control_points", "knots_u", "knots_v"}

TOKEN = re.compile(
    r"""(?P<comment>//[^\n]*|/\*.*?\*/)
      | (?P<string>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
      | (?P<number>(?:0x[0-9a-fA-F]+|\d+\.?\d*(?:[eE][+-]?\d+)?)[uUlLfF]*)
      | (?P<name>[A-Za-z_]\w*)
      | (?P<op><=>|->|\+\+|--|<<=|>>=|\+=|-=|\*=|/=|==|!=|<=|>=|&&|\|\||::|\|=|[-+*/<>=!&|?:;,.(){}\[\]~^%\#])
      | (?P<space>\s+)""",
    re.S | re.X)


class Token:
    __slots__ = ("kind", "text", "at", "end", "spaced_before", "spaced_after")

    def __init__(self, kind, text, at):
        self.kind, self.text, self.at, self.end = kind, text, at, at + len(text)
        self.spaced_before = self.spaced_after = False


def tokenise(text):
    tokens, position, gap = [], 0, True
    while position < len(text):
        m = TOKEN.match(text, position)
        if not m:
            sys.exit(f"cannot read {text[position:position + 40]!r}")
        position = m.end()
        if m.lastgroup in ("comment", "space"):
            gap = True
            if tokens:
                tokens[-1].spaced_after = True
            continue
        token = Token(m.lastgroup, m.group(), m.start())
        token.spaced_before, gap = gap, False
        tokens.append(token)
    return tokens


def matching(tokens, i):
    """Index of the bracket that closes the one at i."""
    pairs = {"(": ")", "{": "}", "[": "]"}
    stack = []
    for k in range(i, len(tokens)):
        t = tokens[k].text if tokens[k].kind == "op" else ""
        if t in pairs:
            stack.append(pairs[t])
        elif stack and t == stack[-1]:
            stack.pop()
            if not stack:
                return k
    sys.exit("unbalanced brackets")


def formula_bodies(tokens):
    """(function name, first, last) token index ranges inside the braces of every function that computes."""
    bodies, i, classes = [], 0, set()
    while i < len(tokens):
        t = tokens[i]
        if t.kind == "name" and t.text in ("class", "struct") and tokens[i + 1].kind == "name":
            classes.add(tokens[i + 1].text)
        if t.kind == "op" and t.text == "(" and tokens[i - 1].kind == "name":
            name, k = tokens[i - 1].text, matching(tokens, i) + 1
            while k < len(tokens) and tokens[k].text in ("const", "noexcept", "override"):
                k += 1
            if tokens[k].text == ":" and name in classes:  # a constructor: over its initialisers to its body
                while not (tokens[k].text == "{" and tokens[k - 1].text == ")"):
                    k = matching(tokens, k) + 1 if tokens[k].text == "(" else k + 1
            if k < len(tokens) and tokens[k].text == "{":
                end = matching(tokens, k)
                if name not in NOT_FORMULAS and name not in classes:
                    bodies.append((name, k + 1, end))
                i = end + 1
                continue
            i = k
            continue
        if t.text == "{" and tokens[i - 1].kind == "name":
            # A class or namespace is entered, the initialiser of a member is not.
            head = " ".join(x.text for x in tokens[max(0, i - 3):i])
            if not re.search(r"\b(struct|class|namespace)\b", head):
                i = matching(tokens, i) + 1
                continue
        i += 1
    return bodies


KEYWORDS = {"const", "auto", "int", "double", "float", "bool", "if", "for", "while", "using", "return", "constexpr",
            "static_cast", "else", "true", "false", "this", "std", "typename", "template", "unsigned", "size_t", "S", "T"}
SWAPPED = {"sin": ("cos",), "cos": ("sin",), "x": ("y", "z"), "y": ("z", "x"), "z": ("x", "y"), "first": ("second",),
           "second": ("first",), "dpdu": ("dpdv",), "dpdv": ("dpdu",), "d2pdu2": ("d2pdv2",), "d2pduv": ("d2pdu2",),
           "d2pdv2": ("d2pduv",), "t": ("n",), "n": ("b",), "b": ("t",)}
FUNCTIONS = {"pi": "two_pi", "two_pi": "pi", "sinh": "cosh", "cosh": "sinh", "tanh": "sinh",
             "sincos_turns": "sincos_half_turns", "sincos_half_turns": "sincos_turns", "exp": "log", "log": "exp"}
STATUS = {"dpdu_zero": "dpdv_zero", "dpdv_zero": "dpdu_zero", "parallel": "regular", "self_intersecting": "regular",
          "crease": "regular", "no_frame": "regular", "limit_frame": "regular"}
BINARY = {"+": "-", "-": "+", "*": "/", "/": "*", "<": ">", ">": "<", "<=": ">=", ">=": "<=", "==": "!=", "!=": "==",
          "&&": "||", "||": "&&", "+=": "-=", "-=": "+=", "*=": "/=", "/=": "*=", "++": "--", "--": "++", "|": "&"}


class Mutant:
    def __init__(self, header, function, text, at, end, new, kind):
        self.header, self.function, self.at, self.end, self.new, self.kind = header, function, at, end, new, kind
        line_at = text.rfind("\n", 0, at) + 1
        line_end = text.find("\n", end)
        self.line = text.count("\n", 0, at) + 1
        self.before = text[line_at:line_end].strip()
        self.after = (text[line_at:at] + new + text[end:line_end]).strip()
        self.id = hashlib.sha256(f"{header}\n{text}\n{at} {end} {new}".encode()).hexdigest()[:20]

    def applied(self, text):
        return text[:self.at] + self.new + text[self.end:]


def plus_one(number):
    """The literal one greater: 0 becomes 1."""
    if re.fullmatch(r"\d+", number):
        return str(int(number) + 1)
    return repr(float(number) + 1)


def mutants_of(header):
    """All mutants of one header, in the order of its text: by rule, none chosen by hand."""
    text = (HEADERS / header).read_text()
    tokens = tokenise(text)
    # The members that are parameters or hold the data a formula is made of, in the order they are declared.
    members = list(dict.fromkeys(re.findall(r"parameter<&\w+::(\w+)", text)))
    result = []
    for function, first, last in formula_bodies(tokens):
        body = tokens[first:last]
        # Constants with a name of their own: `two = lift<S>(2.0)`.
        written = text[tokens[first].at:tokens[last].at] if first < last else ""
        named = dict(re.findall(r"\b(\w+) = lift<S>\((-?[\d.]+)\)", written))

        def add(token, new, kind):
            result.append(Mutant(header, function, text, token.at, token.end, new, kind))

        def is_zero(token_range):
            s = "".join(t.text for t in token_range)
            return bool(re.match(r"(lift<S>\(0\.0\)|T\(0\)|0\b)", s)) or (
                bool(token_range) and named.get(token_range[0].text) == "0.0")

        for k, t in enumerate(body):
            before = body[k - 1] if k else Token("op", "{", 0)
            after = body[k + 1] if k + 1 < len(body) else Token("op", "}", 0)
            opens = (before.kind == "op" and before.text in ("=", "(", "{", ",", "?", ":", "[")) or before.text == "return"
            if t.kind == "op":
                if t.text in BINARY:
                    unary = t.text == "-" and (before.kind == "op" and before.text not in (")", "]", "}") or
                                               before.text == "return")
                    if unary:
                        add(t, "", "sign dropped")
                    elif t.text in ("++", "--") or (t.spaced_before and t.spaced_after):
                        add(t, BINARY[t.text], "operator")
                elif t.text == "!" and after.text != "=":
                    add(t, "", "not dropped")
            elif t.kind == "number":
                if before.text != "<":  # no template argument
                    add(t, plus_one(t.text), "constant")
            elif t.kind == "name":
                field = before.text == "."
                if field and body[k - 2].text in ("{", ",") and after.text == "=":
                    continue  # a designator
                if field:
                    for other in SWAPPED.get(t.text, ()):
                        add(t, other, "index")
                elif t.text in named and after.text != "=":
                    add(t, f"lift<S>({plus_one(named[t.text])})", "constant")
                elif t.text in members and len(members) > 1 and before.text != "::":
                    add(t, members[(members.index(t.text) + 1) % len(members)], "parameter")
                elif t.text in ("u", "v") and after.text != "=":
                    add(t, "v" if t.text == "u" else "u", "index")
                elif t.text in FUNCTIONS and after.text in ("(", "<") and before.text not in ("::", ","):
                    add(t, FUNCTIONS[t.text], "function")
                elif before.text == "::" and t.text in STATUS:
                    add(t, STATUS[t.text], "status")
            # A sign where a term begins; not one of zero, or of what is only compared with zero or tested.
            if opens and t.kind in ("name", "number", "op") and t.text not in KEYWORDS and (
                    t.kind != "op" or t.text == "("):
                if t.kind == "number" and (before.text in ("[", "(") or float(t.text) == 0):
                    continue
                if before.text == "(" and k >= 2 and body[k - 2].text in ("if", "while", "switch", "for"):
                    continue
                if named.get(t.text) == "0.0" or t.text == "lift" and is_zero(body[k:k + 7]):
                    continue
                e, depth = k, 0
                while e < len(body):
                    x = body[e]
                    if x.text in "([{" and x.kind == "op":
                        e = matching(body, e)
                    elif x.kind == "op" and (x.text in (")", "]", "}", ",", ";", "?", ":", "&&", "||", "==", "!=", "|") or
                                             x.text in ("+", "-", "<", "<=", ">", ">=") and x.spaced_before):
                        break
                    e += 1
                stop = body[e].text if e < len(body) else ""
                if stop in ("?", "&&", "||", "|", "=") or stop in ("==", "!=") and is_zero(body[e + 1:e + 8]):
                    continue
                if body[k + 1].text in ("=", "::") or stop == "," and is_zero(body[e + 1:e + 8]) and k >= 2 and (
                        body[k - 2].text == "equal"):
                    continue
                if before.text == "(" and k >= 2 and (body[k - 2].text in ("*", "/", "+", "-", "(") and stop == ")" or
                                                      "".join(x.text for x in body[max(0, k - 5):k]) == "lift<S>("):
                    continue  # the sign of the term this bracket stands in, which has its own mutant
                result.append(Mutant(header, function, text, t.at, t.at, "-", "sign added"))
    return result


# ---- running them ----------------------------------------------------------------------------------------------

PRECOMPILED = """#include <algorithm>
#include <array>
#include <charconv>
#include <concepts>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>
#include <darboux/any_surface.h>
#include <darboux/framed_curve.h>
#include <darboux/spline_patch.h>
#include <darboux/surface.h>
"""


class Workshop:
    """A temporary folder with what all mutants share, compiled once."""

    def __init__(self, arguments):
        self.folder = Path(tempfile.mkdtemp(prefix="mutation-"))
        self.compiler, self.timeout = arguments.compiler, {}
        clang = "clang" in subprocess.run([self.compiler, "--version"], capture_output=True, text=True).stdout
        self.flags = ["-std=c++20", "-ffp-contract=off", "-w", f"-I{ROOT}/include", f"-I{ROOT}/src", *arguments.include]
        # Quick to compile and run: clang instantiates the shared templates once, g++ does not.
        self.mutant_flags = ["-O0", "-fpch-instantiate-templates"] if clang else ["-O1"]
        (self.folder / "shared.h").write_text(PRECOMPILED)
        self.objects = []
        # All that the tests need.
        formulas = (ROOT / "src/surface/multiprecision.cpp", ROOT / "src/surface/refusals.cpp", HERE / "no_batches.cpp")
        for source in (HERE / "check_mutant.cpp", ROOT / "src/laws/testing.cpp", *sorted((ROOT / "src/laws").glob("*.cpp")),
                       *formulas):
            tell(f"compiling {source.name}")
            target = self.folder / f"{len(self.objects)}.o"
            self.run([self.compiler, *self.flags, "-O2", "-c", str(source), "-o", str(target)], must=True)
            self.objects.append(str(target))
        self.test_objects = self.objects[-len(formulas):]
        precompiled = self.folder / ("shared.h.pch" if clang else "shared.h.gch")
        self.run([self.compiler, *self.flags, *self.mutant_flags, "-x", "c++-header", str(self.folder / "shared.h"),
                  "-o", str(precompiled)], must=True)

    def run(self, command, must=False, timeout=300, text=True):
        done = subprocess.run(command, capture_output=True, text=text, timeout=timeout)
        if must and done.returncode:
            sys.exit(f"{' '.join(command)}\n{done.stderr}")
        return done

    def build(self, header, text, name):
        """The program for a header with this text; None where it does not compile."""
        folder = self.folder / name
        (folder / "darboux").mkdir(parents=True)
        (folder / "darboux" / header).write_text(text)
        (folder / "mutant.cpp").write_text(
            f"#include <darboux/{header}>\n#include <vector>\nnamespace darboux {{\n"
            f"std::vector<AnySurface> mutated_surfaces() {{ return {{{', '.join(instances(header))}}}; }}\n}}\n")
        program = folder / "mutant"
        done = self.run([self.compiler, *self.flags, *self.mutant_flags, f"-I{folder}", "-include",
                         str(self.folder / "shared.h"), *self.objects, str(folder / "mutant.cpp"), "-o", str(program)])
        return program if done.returncode == 0 else None

    def check(self, header, text, name):
        """(outcome, what told it). The unmutated header comes first: thrice its time is a hang."""
        try:
            program = self.build(header, text, name)
            if program is None:
                return "not compiling", ""
            try:
                begin = time.monotonic()
                done = self.run([str(program), "check"], timeout=self.timeout.get(header))
                self.timeout.setdefault(header, 10 + 3 * (time.monotonic() - begin))
            except subprocess.TimeoutExpired:
                return "killed", "hangs"
            if done.returncode == 0:
                return self.test(header, text, name)
            if done.returncode == 1:
                return "killed", done.stdout.strip()
            return "killed", f"crashes ({done.returncode})"
        finally:
            shutil.rmtree(self.folder / name, ignore_errors=True)

    def test(self, header, text, name):
        """The same of the tests beside the laws."""
        for test in TESTS:
            folder = self.folder / name
            program = folder / test
            built = self.run([self.compiler, *self.flags, "-O0", f"-I{folder}", f"-I{HEADERS.parent}", f"-I{ROOT}/tests",
                              f"-I{ROOT}/tests/support",
                              str(ROOT / "tests/surface" / f"{test}.cpp"), *self.test_objects, "-lgtest", "-lgtest_main",
                              "-lpthread", "-o", str(program)])
            if built.returncode:
                return "not compiling", f"in {test}: {built.stderr.strip().splitlines()[-1:]}"
            try:
                done = self.run([str(program), "--gtest_brief=1", "--gtest_fail_fast"], timeout=300)
            except subprocess.TimeoutExpired:
                return "killed", f"{test} hangs"
            if done.returncode:
                failed = re.search(r"\[  FAILED  \] (\S+)", done.stdout)
                return "killed", f"{test} {failed.group(1) if failed else f'crashes ({done.returncode})'}"
        return "survived", ""

    def values(self, header, text, name):
        try:
            program = self.build(header, text, name)
            return self.run([str(program), "values"], text=False).stdout if program else b""
        finally:
            shutil.rmtree(self.folder / name, ignore_errors=True)

    def close(self):
        shutil.rmtree(self.folder, ignore_errors=True)


def type_name(header):
    """The catalogue's type declared in a header."""
    text = (HEADERS / header).read_text()
    for name in re.findall(r"(\w+)<>", (HEADERS / "catalogue.h").read_text()):
        if re.search(rf"\b(struct|class) {name}\b", text):
            return name
    sys.exit(f"{header}: no type of the catalogue")


def instances(header):
    """The surface with its defaults, and what tests/mutation/instances.txt adds: cases the defaults do not show."""
    result = [type_name(header) + "<>{}"]
    for line in (HERE / "instances.txt").read_text().splitlines():
        if line.startswith(header + ":"):
            result.append(line.split(":", 1)[1].strip())
    return result


VALUES_PER_POINT = 36  # that check_mutant.cpp writes


def how_different(one, other):
    """How many values differ, and the largest difference relative to the scale of its quantity over all points."""
    if one == other and one:
        return {"differ": 0, "largest": 0}
    if len(one) != len(other) or not one:
        return {"differ": -1, "largest": -1}
    a, b = (struct.unpack(f"{len(x) // 8}d", x) for x in (one, other))
    scale = [max([abs(x) for x in a[k::VALUES_PER_POINT] if math.isfinite(x)], default=0) or 1 for k in range(VALUES_PER_POINT)]
    count, largest = 0, 0.0
    for k, (x, y) in enumerate(zip(a, b)):
        if x != y and not (math.isnan(x) and math.isnan(y)):
            count += 1
            d = abs(x - y) / scale[k % VALUES_PER_POINT]
            largest = max(largest, d if math.isfinite(d) else 1e300)
    return {"differ": count, "of": len(a), "largest": largest}


# ---- survivors and the report ----------------------------------------------------------------------------------


def explanations():
    """(header, mutated line) -> (class, why), from survivors.txt."""
    result, why = {}, ("open", "")
    for line in (HERE / "survivors.txt").read_text().splitlines():
        if not line.strip() or line.startswith("#"):
            continue
        if m := re.match(r"\[(equivalent|accuracy|hole|redundant)\] (.*)", line):
            why = (m.group(1), m.group(2))
        elif m := re.match(r"(\w+\.h): (.*)", line):
            result[(m.group(1), m.group(2).strip())] = why
        else:
            sys.exit(f"survivors.txt: not understood: {line}")
    return result


def tell(text):
    print(text, file=sys.stderr, flush=True)


def write_report(path, arguments, population, results, chosen, seconds):
    known = explanations()
    lines = ["# Mutation run over surfaces/", "",
             "Written by `tests/mutation/run.py`, which tells what a mutant is; the explanations are those of "
             "`tests/mutation/survivors.txt`.", ""]
    compiler = subprocess.run([arguments.compiler, "--version"], capture_output=True, text=True).stdout.splitlines()[0]
    done = [m for m in chosen if m.id in results]
    total = sum(len(x) for x in population.values())
    counted = [m for m in done if results[m.id]["outcome"] != "not compiling"]
    survived = [m for m in counted if results[m.id]["outcome"] == "survived"]

    def kind_of(m):
        if (m.header, m.after) in known:
            return known[(m.header, m.after)]
        r = results[m.id]
        return "open", ("not explained yet; the values are the same bit for bit wherever they were compared" if r.get("differ") == 0
                        else f"not explained yet; the values differ by up to {r.get('largest', 0):.1e} of their scale")

    kinds = {m.id: kind_of(m) for m in survived}
    real = [m for m in survived if kinds[m.id][0] not in ("equivalent",)]
    alive = len(counted) - len([m for m in survived if kinds[m.id][0] == "equivalent"])
    killed = len(counted) - len(survived)
    machine = f"{platform.system()} {platform.machine()}, {os.cpu_count()} cores, {arguments.jobs} used"
    command = ["tests/mutation/run.py", f"--seed {arguments.seed}"]
    if arguments.per_surface:
        command.append(f"--per-surface {arguments.per_surface}")
    if arguments.share < 1:
        command.append(f"--share {arguments.share}")
    if arguments.surfaces:
        command.append(f"--surfaces {arguments.surfaces}")
    lines += [f"- date: {datetime.date.today()}", f"- machine: {machine}", f"- compiler: {compiler}",
              f"- command: `{' '.join(command)}`", f"- time: {sum(results[m.id]['seconds'] for m in done):.0f} s in all, "
              f"{sum(results[m.id]['seconds'] for m in done) / max(1, len(done)):.1f} s a mutant",
              f"- mutants: {len(done)} of all {total}, {len(done) - len(counted)} of them do not compile and are not counted",
              "", f"**{killed} of {alive} killed: {100 * killed / max(1, alive):.2f} %**, leaving out the "
              f"{len(counted) - alive} that compute the same (listed below). Of all {len(counted)} that compile "
              f"{100 * killed / max(1, len(counted)):.2f} %.", "",
              "| surface | mutants there are | run | not compiling | killed | survived, equivalent | survived, other |",
              "|---|---:|---:|---:|---:|---:|---:|"]
    for header, all_of_it in population.items():
        mine = [m for m in done if m.header == header]
        if not mine:
            continue
        outcome = [results[m.id]["outcome"] for m in mine]
        same = sum(1 for m in mine if m.id in kinds and kinds[m.id][0] == "equivalent")
        lines.append(f"| {header[:-2].replace('_', '-')} | {len(all_of_it)} | {len(mine)} | {outcome.count('not compiling')} | "
                     f"{outcome.count('killed')} | {same} | {outcome.count('survived') - same} |")
    titles = {"open": "Survivors not explained", "hole": "Survivors that the laws do not see",
              "accuracy": "Survivors that only round differently",
              "redundant": "Survivors in what is written for another purpose",
              "equivalent": "Equivalent: what the change leaves as it was"}
    for kind, title in titles.items():
        these = [m for m in survived if kinds[m.id][0] == kind]
        if not these:
            continue
        lines += ["", f"## {title} ({len(these)})", ""]
        reasons = {}
        for m in these:
            reasons.setdefault(kinds[m.id][1], []).append(m)
        for reason, which in reasons.items():
            lines += [f"{reason[0].upper()}{reason[1:]}:", ""]
            for m in which:
                lines.append(f"- `{m.header}` {m.function}, {m.kind}: `{m.after}` for `{m.before}`")
            lines.append("")
    while lines[-1] == "":
        lines.pop()
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text("\n".join(lines) + "\n")
    tell(f"{killed} of {alive} killed, {len(real)} survivors other than equivalent; report in {path}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--surfaces", default="", help="names, comma-separated; all by default")
    parser.add_argument("--seed", type=int, default=1, help="of the sample")
    parser.add_argument("--per-surface", type=int, default=0, help="at most this many mutants of each surface")
    parser.add_argument("--share", type=float, default=1, help="this share of each surface's mutants")
    parser.add_argument("--jobs", type=int, default=1, help="mutants at a time")
    parser.add_argument("--minutes", type=float, default=0, help="stop after so many; 0: run to the end")
    parser.add_argument("--compiler", default=os.environ.get("CXX") or ("clang++" if shutil.which("clang++") else "c++"),
                        help="$CXX, else clang++, which is twice as fast here, else c++")
    parser.add_argument("--include", action="append", default=[], help="further compiler flag, such as -I/path/of/eigen")
    parser.add_argument("--results", type=Path, default=ROOT / "build" / "mutation" / "results.jsonl")
    parser.add_argument("--survivors", action="store_true", help="run those again that survived: the laws have changed")
    parser.add_argument("--fresh", action="store_true", help="forget earlier results")
    parser.add_argument("--report", type=Path, help="write the report there")
    parser.add_argument("--count", action="store_true", help="count the mutants and stop")
    parser.add_argument("--list", action="store_true", help="list the mutants and stop")
    arguments = parser.parse_args()
    for eigen in ("/usr/include/eigen3", "/usr/local/include/eigen3", "/opt/homebrew/include/eigen3"):
        if Path(eigen).is_dir():
            arguments.include.append(f"-I{eigen}")
            break

    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))  # so that the temporary folder goes
    headers = sorted(h.name for h in HEADERS.glob("*.h") if h.name != "catalogue.h")
    if arguments.surfaces:
        wanted = [s.strip().replace("-", "_") + ".h" for s in arguments.surfaces.split(",")]
        for w in wanted:
            if w not in headers:
                sys.exit(f"unknown surface {w[:-2]}, known are {', '.join(h[:-2] for h in headers)}")
        headers = wanted
    population = {h: mutants_of(h) for h in headers}
    chosen = []
    for header, mutants in population.items():
        size = min(len(mutants), arguments.per_surface or len(mutants))
        size = min(size, math.ceil(len(mutants) * arguments.share))
        order = list(range(len(mutants)))
        random.Random(f"{arguments.seed} {header}").shuffle(order)  # a larger sample holds the smaller one
        chosen += [mutants[i] for i in sorted(order[:size])]
    if arguments.list:
        for m in chosen:
            print(f"{m.header}:{m.line}: {m.function}, {m.kind}: {m.before}  ->  {m.after}")
        return
    if arguments.count:
        for header, mutants in population.items():
            print(f"{header[:-2]:24} {len(mutants)}")
        print(f"{'all':24} {sum(map(len, population.values()))}, chosen {len(chosen)}")
        return

    results = {}
    arguments.results.parent.mkdir(parents=True, exist_ok=True)
    if arguments.fresh:
        arguments.results.unlink(missing_ok=True)
    if arguments.results.exists():
        for line in arguments.results.read_text().splitlines():
            entry = json.loads(line)
            results[entry["id"]] = entry
    todo = [m for m in chosen if m.id not in results or arguments.survivors and results[m.id]["outcome"] == "survived"]
    tell(f"{len(chosen)} of {sum(map(len, population.values()))} mutants chosen, {len(todo)} to run")
    start = time.monotonic()
    if todo:
        if not shutil.which(arguments.compiler):
            sys.exit(f"{arguments.compiler}: no such compiler, name one with --compiler")
        workshop = Workshop(arguments)
        try:
            unsound = run_all(workshop, todo, results, arguments, start)
        finally:
            workshop.close()
        if unsound:
            sys.exit(f"no report: {', '.join(unsound)} disobeyed the laws before any mutation")
    if arguments.report:
        write_report(arguments.report, arguments, population, results, chosen, time.monotonic() - start)


def run_all(workshop, todo, results, arguments, start):
    texts = {h: (HEADERS / h).read_text() for h in {m.header for m in todo}}
    sound = {}  # header -> whether it obeys the laws as it is
    lock = threading.Lock()
    originals = {}

    def one(m):
        if arguments.minutes and time.monotonic() - start > 60 * arguments.minutes:
            return m, None
        with lock:
            if m.header not in sound:
                outcome, why = workshop.check(m.header, texts[m.header], "original-" + m.header)
                sound[m.header] = outcome == "survived"
                if not sound[m.header]:
                    tell(f"SKIPPED {m.header}: as it is, {outcome} {why}")
        if not sound[m.header]:
            return m, None
        begin = time.monotonic()
        outcome, why = workshop.check(m.header, m.applied(texts[m.header]), m.id)
        entry = {"id": m.id, "surface": m.header, "function": m.function, "kind": m.kind, "line": m.line,
                 "after": m.after, "outcome": outcome, "why": why}
        entry["seconds"] = round(time.monotonic() - begin, 2)
        if outcome == "survived":
            if m.header not in originals:
                originals[m.header] = workshop.values(m.header, texts[m.header], "values-" + m.id)
            entry |= how_different(originals[m.header],
                                   workshop.values(m.header, m.applied(texts[m.header]), "mutated-" + m.id))
        return m, entry

    with open(arguments.results, "a") as file, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        for number, (m, entry) in enumerate(pool.map(one, todo), 1):
            if entry is None:
                continue
            results[m.id] = entry
            file.write(json.dumps(entry) + "\n")
            file.flush()
            if entry["outcome"] == "survived":
                tell(f"SURVIVED {m.header}:{m.line} {m.function}, {m.kind}: {m.before}  ->  {m.after}  "
                     f"[{entry.get('differ')} of {entry.get('of', '')} values differ, by {entry.get('largest')}]")
            if number % 25 == 0:
                tell(f"{number} of {len(todo)}, {(time.monotonic() - start) / number:.2f} s each")
    return [header for header, obeys in sound.items() if not obeys]


if __name__ == "__main__":
    main()
