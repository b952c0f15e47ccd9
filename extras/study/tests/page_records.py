#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Tables that pages show of `morula demo` and `morula study`, held against what the commands find today.
usage: page_records.py demo|study|variants|record path/to/morula [--write]

Compares docs/_data/demo_rules.tsv and demo_budgets.tsv, or study_claims.tsv, row by row; --write makes them anew, and then
scripts/pages puts them into the pages. Times are left out. `record` repeats one trial of the study on record, which
scripts/report took into research/report/data, and compares it with trials.csv.
Exit status: 0 the same (or written), 1 other numbers, 2 bad usage, 77 without the corpus, which demo needs."""
import csv
import json
import pathlib
import re
import subprocess
import sys
import tempfile

DATA = pathlib.Path(__file__).resolve().parents[3] / "docs/_data"
RULES = ["traditional", "approach1", "approach2", "exact"]


def digits(value, count=3):
    """So many that count, zeros at the end too."""
    text = f"{value:#.{count}g}"
    return text.rstrip(".") if "e" not in text else f"{value:.0f}"


def uncovered(share):
    return "0" if share == 0 else "< 0.01 %" if share < 1e-4 else f"{100 * share:.1f} %"


def demo_rules(demo):
    """A row for each body at rest and for each motion: the looseness and, in brackets, the uncovered share, rule by rule."""
    rows = []
    for tree in demo["trees"]:
        if tree["method"] != "optimized":
            continue
        cells = {(cell["motion"], cell["rule"]): cell for cell in tree["cells"]}
        motions = list(dict.fromkeys(cell["motion"] for cell in tree["cells"]))
        texts = {"at rest": [cells[motions[0], rule]["frames"][0] for rule in RULES]}
        for motion in motions:
            texts[motion] = [{"looseness": cells[motion, rule]["worst_looseness"], "uncovered_area": cells[motion, rule]["worst_uncovered_area"]}
                             for rule in RULES]
        for motion, found in texts.items():
            shown = [f"{digits(f['looseness'])} ({uncovered(f['uncovered_area'])})" for f in found]
            body = tree["body"].rstrip("0123456789")
            name = f"{body}, {tree['facets']:,} facets" if motion == "at rest" else ""
            rows.append([name, motion.replace("stretch 2", "stretch × 2").replace("180", "180°").replace("90", "90°"), *shown])
    return rows


def demo_budgets(demo):
    contacts = demo["contacts"]
    total = sum(contacts["crossings"])
    return [[str(b["budget"] or "unlimited"), f"{b['contacts']:.0f}", f"{100 * b['finished_share']:.3g} %", f"{b['missed']} of {total}",
             f"{100 * b['mean_error_bound']:.1f} %", f"{b['pair_tests']:.0f}"] for b in contacts["budgets"]]


def study_claims(study):
    """A row for each claim: id, source, claim, verdict, trials, mean with its interval, cases, and what it depends on."""
    rows = []
    for claim in study["claims"]:
        value, effect, depends = claim.get("value"), claim.get("effect"), claim["depends_on"]
        mean = f"{digits(value['mean'])} ({digits(value['low'])} to {digits(value['high'])})" if value else ""
        cases = f"{effect['true']} of {effect['cases']}" if effect else ""
        flips = ", ".join(f"{name} {100 * share:.0f} %" for name, share in depends.items() if share)
        rows.append([claim["id"], claim["source"], claim["claim"], claim["verdict"], claim["numbers"].split(". ")[0].rstrip("."),
                     claim.get("quantity", ""), mean, cases, flips])
    return rows



def table_of(study, name):
    """The rows of a table of study.json as text: numbers with three digits."""
    table = next(table for table in study["tables"] if table["id"] == name)
    return [["" if cell is None else cell if isinstance(cell, str) else f"{cell:.3g}" for cell in row] for row in table["rows"]]


TABLES = {"demo": {"demo_rules": demo_rules, "demo_budgets": demo_budgets}, "study": {"study_claims": study_claims},
          "variants": {"study_variants": lambda study: table_of(study, "variants"),
                       "study_amounts": lambda study: table_of(study, "paper-amounts")}}
# Commands that are not named as their tables.
COMMANDS = {"study": ["study", "--quick", "--seeds", "3", "--rules", "traditional,weighted,approach1,approach2,exact,rebuilt,fresh"],
            "variants": ["study", "--quick", "--depth", "3", "--variants", "--paper-amounts", "--methods", "medial,grid,hubbard,spawn",
                         "--bodies", "limb", "--seeds", "1", "--rules", "traditional,approach1,approach2,exact"]}


def repeated_trial(command):
    """One trial of the record, on its second body with its first seed, compared claim by claim. Exit status."""
    folder = DATA.parents[1] / "research/report/data"
    record = json.loads((folder / "record.json").read_text())
    body, seed = record["bodies"][1]["name"], record["settings"]["seeds"][0]
    options = re.sub(r"^morula study| --seeds \d+", "", record["command"]).split()
    words = [*options, "--bodies", body, "--seeds", "1", "--seed", str(seed)]
    with tempfile.TemporaryDirectory() as out:
        run = subprocess.run([command, "study", *words, "-o", "out", "--json"], cwd=out, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(run.stderr, file=sys.stderr)
        return 1
    with (folder / "trials.csv").open(newline="") as file:
        rows = csv.DictReader(line for line in file if not line.startswith("#"))
        before = {row["id"]: row for row in rows if row["body"] == body and row["seed"] == str(seed)}
    status = 0
    for claim in json.loads(run.stdout)["claims"]:
        trial = claim["trials"][0]
        now = [trial["verdict"], str(trial["true"]), str(trial["cases"]), "" if trial["value"] is None else f"{float(trial['value']):.6g}"]
        old = [before[claim["id"]][key] for key in ("verdict", "true", "cases", "value")] if claim["id"] in before else None
        if old != now:
            print(f"{claim['id']} of {body}, seed {seed}\n  has  {old}\n  but  {now}", file=sys.stderr)
            status = 1
    if status:
        print(f"Where that is meant: {record['command']} -o FOLDER, scripts/report --data FOLDER, scripts/pages", file=sys.stderr)
    return status


def recorded(path):
    if not path.exists():
        return []
    return [line.split("\t") for line in path.read_text().splitlines() if line and not line.startswith("#")]


def main():
    arguments = [argument for argument in sys.argv[1:] if argument != "--write"]
    if len(arguments) == 2 and arguments[0] == "record" and "--write" not in sys.argv:
        return repeated_trial(pathlib.Path(arguments[1]).resolve())
    if len(arguments) != 2 or arguments[0] not in TABLES:
        print(__doc__, file=sys.stderr)
        return 2
    what, command = arguments[0], pathlib.Path(arguments[1]).resolve()
    with tempfile.TemporaryDirectory() as folder:
        run = subprocess.run([command, *COMMANDS.get(what, [what]), "-o", "out", "--json"], cwd=folder, capture_output=True, text=True, check=False)
    if run.returncode != 0:
        print(run.stderr, file=sys.stderr)
        return 1
    found, status = json.loads(run.stdout), 0
    if what == "demo" and not any(tree["body"] != "limb" for tree in found["trees"]):
        print("skipped: README's rows have a body of the corpus, which scripts/corpus fetches")
        return 77
    for name, make in TABLES[what].items():
        path, now = DATA / f"{name}.tsv", make(found)
        if "--write" in sys.argv:
            path.write_text("# SPDX-FileCopyrightText: 2026 The Morula authors\n# SPDX-License-Identifier: Apache-2.0\n"
                            f"# What `morula {' '.join(COMMANDS.get(what, [what]))}` found, as extras/study/tests/page_records.py wrote it.\n" +
                            "".join("\t".join(row) + "\n" for row in now))
            continue
        before = recorded(path)
        if len(before) != len(now):
            print(f"{path.name} has {len(before)} rows, and {len(now)} are found", file=sys.stderr)
            status = 1
        for old, new in zip(before, now):
            if old != new:
                print(f"{path.name}\n  has  {' | '.join(old)}\n  but  {' | '.join(new)}", file=sys.stderr)
                status = 1
    if status:
        print(f"Where that is meant: {sys.argv[0]} {what} {arguments[1]} --write && scripts/pages", file=sys.stderr)
    return status


if __name__ == "__main__":
    sys.exit(main())
