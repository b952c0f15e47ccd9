#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The report's numbers follow from its trials and cases, computed here a second time, and scripts/report names planted faults.
usage: report_test.py ROOT FOLDER | --latex ROOT FOLDER | --citation ROOT

--latex compiles the report, and ends with 77 where there is no pdflatex. --citation compares CITATION.cff with the project.
"""
import csv
import json
import math
import pathlib
import re
import shutil
import subprocess
import sys
from collections import defaultdict


def expect(condition, *what):
    if not condition:
        sys.exit("\n".join(map(str, what)))


def rows(path):
    with path.open(newline="") as file:
        expect(file.readline().startswith("# morula study"), path, "does not name its command")
        return list(csv.DictReader(file))


def near(text, value, digits=4):
    return text != "" and math.isclose(float(text), value, rel_tol=10 ** -digits, abs_tol=1e-9)


def joined(verdicts, guarantee):
    """The verdict over trials, from its sentence in study.md."""
    holds, fails = (sum(v == wanted for v in verdicts) for wanted in ("holds", "fails"))
    if not verdicts:
        return "not decided"
    if holds == len(verdicts) if guarantee else holds >= 0.9 * len(verdicts):
        return "holds"
    return "fails" if fails >= 0.9 * len(verdicts) else "partly"


def differing(pairs):
    pairs = list(pairs)
    return sum(a != b for a, b in pairs) / len(pairs) if pairs else None


def claims_follow_from_trials(data):
    trials = defaultdict(list)
    for row in rows(data / "trials.csv"):
        trials[row["id"]].append(row)
    claims = rows(data / "claims.csv")
    expect(len(claims) == len(trials) > 10, "claims without trials")
    for claim in claims:
        every = trials[claim["id"]]
        decided = [trial for trial in every if trial["verdict"] != "not decided"]
        verdicts = [trial["verdict"] for trial in decided]
        name = claim["id"]
        expect(claim["verdict"] == joined(verdicts, claim["guarantee"] == "yes"), name, claim["verdict"], verdicts)
        expect([int(claim[v]) for v in ("holds", "partly", "fails")] == [verdicts.count(v) for v in ("holds", "partly", "fails")], name)
        true, cases = (sum(int(trial[key]) for trial in every) for key in ("true", "cases"))
        if cases:
            expect((int(claim["true"]), int(claim["cases"])) == (true, cases), name, true, cases)
            expect(near(claim["cliffs_delta"], (2 * true - cases) / cases), name, "delta", claim["cliffs_delta"])
        values = [float(trial["value"]) for trial in every if trial["value"]]
        if claim["mean"]:
            means = [sum(values) / len(values)]
            if min(values) > 0:
                means.append(math.exp(sum(map(math.log, values)) / len(values)))
            expect(any(near(claim["mean"], mean) for mean in means), name, "mean", claim["mean"], means)
            expect(float(claim["low"]) <= float(claim["mean"]) <= float(claim["high"]), name, "interval")
        pairs = [(a, b) for i, a in enumerate(decided) for b in decided[:i]]
        causes = {"seed": differing((a["verdict"], b["verdict"]) for a, b in pairs if a["body"] == b["body"]),
                  "body": differing((a["verdict"], b["verdict"]) for a, b in pairs if a["body"] != b["body"] and a["seed"] == b["seed"])}
        for cause, column in (("amount", "at_half_amount"), ("resolution", "at_half_resolution")):
            causes[cause] = differing((trial["verdict"], trial[column]) for trial in decided if trial[column] not in ("", "not decided"))
        for cause, share in causes.items():
            expect(claim[cause] == "" if share is None else near(claim[cause], share), name, cause, claim[cause], share)
    record = json.loads((data / "record.json").read_text())
    same = compared = 0
    for name, every in trials.items():
        guarantee = next(claim["guarantee"] for claim in claims if claim["id"] == name) == "yes"
        halves = [joined([t["verdict"] for t in every if int(t["seed"]) in half and t["verdict"] != "not decided"], guarantee)
                  for half in record["stability"]["seeds"]]
        if "not decided" not in halves:
            compared += 1
            same += halves[0] == halves[1]
    expect((record["stability"]["same"], record["stability"]["compared"]) == (same, compared), "stability", same, compared)


def text_follows_from_cases(root):
    data = root / "research/report/data"
    text = (root / "research/report/report.md").read_text()
    shown = lambda name: re.findall(rf"<!--figure {re.escape(name)}-->(.*?)<!--/-->", text, re.S)
    by_case = defaultdict(dict)
    for row in rows(data / "rules.csv"):
        if row["rule"] in ("traditional", "weighted", "approach1", "approach2", "exact"):
            by_case[row["body"], row["method"], row["motion"], row["level"]][row["rule"]] = (
                float(row["looseness"]), float(row["uncovered"]), float(row["uncovered_worst"]))
    expect(set(shown("cases")) == {str(len(by_case))}, "cases", shown("cases"))
    uncovered = sum(min(case.values())[2] > 0 for case in by_case.values())
    expect(set(shown("tightest.uncovered")) == {str(uncovered)}, "tightest", shown("tightest.uncovered"), uncovered)
    covering = sum(min((v, rule) for rule, v in case.items() if v[2] == 0)[1] == "exact" for case in by_case.values())
    expect(set(shown("covering.exact")) == {str(covering)}, "covering", covering)
    pairs = [(a, b) for case in by_case.values() for i, a in enumerate(case.values()) for b in list(case.values())[:i] if a[1] != b[1] and a[0] != b[0]]
    rewarded = sum((a[0] - b[0]) * (a[1] - b[1]) < 0 for a, b in pairs)
    expect(shown("pairs") == [f"{len(pairs):,}"] and shown("pairs.rewarded") == [f"{rewarded:,}"], "pairs", len(pairs), rewarded)
    most = max(case["approach2"][2] for case in by_case.values())
    expect(set(shown("rule.approach2.uncovered-most")) == {f"{most:.0f} %"}, "most", most)
    for claim in rows(data / "claims.csv"):
        for key in ("true", "cases"):
            expect(set(shown(f"claim.{claim['id']}.{key}")) <= {f"{int(claim[key] or 0):,}"}, claim["id"], key)
        for key in ("mean", "low", "high"):
            for said in shown(f"claim.{claim['id']}.{key}"):
                expect(abs(float(said) / float(claim[key]) - 1) < 0.006, claim["id"], key, said, claim[key])


def copy_of_report(root, folder):
    shutil.rmtree(folder, ignore_errors=True)
    for part in ("research/report/data", "research/report/figures", "docs/_data"):
        shutil.copytree(root / part, folder / part)
    for part in ("research/report/report.md", "docs/references.bib"):
        shutil.copyfile(root / part, folder / part)


def planted_faults_are_named(root, folder):
    copy_of_report(root, folder)
    page, data = folder / "research/report/report.md", folder / "research/report/data"

    def check():
        run = subprocess.run([sys.executable, root / "scripts/report", "--check", "--root", folder], capture_output=True, text=True, check=False)
        return run.returncode, run.stderr

    expect(check() == (0, ""), "a sound report is rejected:", *check())
    for path, old, new, fault in (
            (page, r"<!--figure cases-->\d+", "<!--figure cases-->7", "generated parts are not current"),
            (page, "figure cases-->", "figure causes-->", "there is no number causes"),
            (page, "scripts/pages: report rules", "scripts/pages: report rulers", "there is no table report rulers"),
            (page, "true both-return", "true both-turn", "there is no statement both-turn"),
            (page, r"\[barr1984\]", "[barr1985]", "docs/references.bib has no barr1985"),
            (page, "has three questions", "has 3 questions", '"3" is typed'),
            (page, r"\A", "In 2,000 cases. ", '"2,000" is typed'),
            (data / "rules.csv", r"(limb,medial,stretch 2,2,exact,\d+,[\d.]+),[\d.]+", r"\1,0.001", "generated parts are not current"),
            (folder / "research/report/figures/rules.svg", "<svg", "<svg ", "rules.svg is not current")):
        sound = path.read_text()
        planted = re.sub(old, new, sound, count=1)
        expect(planted != sound, path, "has no", old)
        path.write_text(planted)
        code, said = check()
        expect(code == 1 and fault in said, f"planted: {new}", "is not named:", said)
        path.write_text(sound)
    # Sentences in words that the data do not say.
    claims = data / "claims.csv"
    sound = claims.read_text()
    first, *lines = sound.splitlines(True)
    table = list(csv.DictReader(lines))
    for name, statement in (("approach2-uncovered", "approach2-always-uncovered"), ("approach2-gain-is-uncovered", "tighter-is-uncovered")):
        with claims.open("w", newline="") as file:
            file.write(first)
            out = csv.DictWriter(file, table[0].keys(), lineterminator="\n")
            out.writeheader()
            out.writerows(row | {"true": int(row["true"]) - 1} if row["id"] == name else row for row in table)
        code, said = check()
        expect(code == 1 and f"the data do not say {statement}" in said, name, "is not named:", said)
    claims.write_text(sound)
    expect(check() == (0, ""), "a sound report is rejected:", *check())


def small_study():
    """A study of two bodies, worked by hand: seeds 1 and 2, one generator, one motion, two rules."""
    claim = {"id": "covers", "source": "new", "claim": "It covers", "verdict": "partly", "counts": {"trials": 2, "holds": 1, "partly": 0, "fails": 1},
             "quantity": "share", "value": {"mean": 0.5, "low": 0, "high": 1}, "effect": {"true": 3, "cases": 6, "cliffs_delta": 0, "median_ratio": None},
             "depends_on": {"seed": 1.0, "body": None, "amount": None, "resolution": None}, "guarantee": True,
             "trials": [{"body": "limb", "seed": seed, "verdict": verdict, "true": true, "cases": 3, "value": value, "at_half_amount": None,
                         "at_half_resolution": None} for seed, verdict, true, value in ((1, "holds", 3, 1.0), (2, "fails", 0, 0.0))]}
    rules = [["limb", "grid", seed, "stretch 2", 2, rule, 0.1, mean, mean, bare, bare, 0] for seed, rule, mean, bare in
             ((1, "approach2", 0.25, 4.0), (2, "approach2", 0.75, 6.0), (1, "exact", 1.0, 0.0), (2, "exact", 2.0, 0.0))]
    work = [["limb", "grid", seed, what, points, 1, 0, bytes_read, 8, over] for seed, what, points, bytes_read, over in
            ((1, "boxes", 2, 32, 1.0), (2, "boxes", 4, 40, 1.0), (1, "approach1", 4, 16, 0.5), (2, "approach1", 8, 10, 0.25))]
    contacts = [["limb", "grid", 1, "exact", axis, pressed, 0.7, query, 10, 4, 4, 2, depth, depth / 2, 3.0, 9.0, 2.0, 8.0, 1.0, None, 20, lost, 0.1]
                for axis, pressed, query, depth, lost in (("x", 0.1, "leaves", 50.0, 5), ("x", 1.0, "leaves", 2.0, 0), ("y", 1.0, "leaves", 4.0, 0),
                                                          ("z", 2.0, "leaves", 9.0, 1), ("x", 1.0, "level 1", 99.0, 20))]
    head = {"rules": "body,method,seed,motion,level,rule,at rest,mean,worst,uncovered; %,uncovered distance; %,protrusion; %",
            "work": "body,method,seed,what,points,children,distances,bytes read,bytes written,bytes over boxes",
            "contacts": "body,method,seed,rule,axis,pressed; %,true depth; %,query,pair tests,contacts,finished,kept,depth,corrected,normal,90 %,"
                        "corrected normal,90 %,sum,corrected sum,crossings,lost,error bound; %",
            "trees": "body,method"}
    tables = [{"id": name, "columns": [column.replace(";", ",") for column in head[name].split(",")], "rows": lines}
              for name, lines in (("rules", rules), ("work", work), ("contacts", contacts), ("trees", [["limb", "grid"]]))]
    settings = {"quick": True, "samples": 3, "decisive_samples": [0, 1, 2], "levels": [2], "branching": 8, "depth": 2, "seeds": [1, 2], "resolution": 24,
                "unit": "volume", "motions": ["stretch 2"], "rules": ["approach2", "exact"], "press": {}, "trials": [{}, {}]}
    return {"morula": "0.1.0", "settings": settings, "bodies": [{"name": "limb", "vertices": 8, "facets": 12, "volume": 1}], "claims": [claim],
            "stability": None, "skipped": [], "tables": tables,
            "figures": [{"id": "fig2a", "series": [{"name": "exact", "style": {"light": "#123456", "marker": "circle"}}]}]}


def small_study_is_taken(root, folder):
    sys.dont_write_bytecode = True
    sys.path.insert(0, str(root / "research/report"))
    import study_data
    shutil.rmtree(folder, ignore_errors=True)
    for part in ("study", "data", "figures"):
        (folder / part).mkdir(parents=True)
    (folder / "study/study.json").write_text(json.dumps(small_study()))
    (folder / "study/fig2a.svg").write_text("<svg/>")
    copied = study_data.extract(folder / "study", folder / "data", folder / "figures")
    expect(copied == ["fig2a.svg"] and (folder / "figures/fig2a.svg").read_text() == "<svg/>", copied)
    command = (folder / "data/rules.csv").read_text().splitlines()[0]
    expect(command == "# morula study --quick --seeds 2 --rules approach2,exact", command)
    for name, wanted in (
            ("rules", [["limb", "grid", "stretch 2", "2", "approach2", "2", "0.1", "0.5", "5", "6", "6"],
                       ["limb", "grid", "stretch 2", "2", "exact", "2", "0.1", "1.5", "0", "0", "0"]]),
            ("work", [["limb", "boxes", "2", "3", "1", "0", "36", "8", "1"], ["limb", "approach1", "2", "6", "1", "0", "13", "8", "0.375"]]),
            # The press of 0.1 % is no part of medians; lost crossings count in all four positions.
            ("contacts", [["limb", "grid", "exact", "4", "4", "9", "2", "4.5", "3", "2", "1", "", "4", "2", "25"]]),
            ("trials", [["covers", "limb", "1", "holds", "3", "3", "1", "", ""], ["covers", "limb", "2", "fails", "0", "3", "0", "", ""]]),
            ("claims", [["covers", "new", "It covers", "partly", "1", "0", "1", "2", "share", "0.5", "0", "1", "3", "6", "0", "", "1", "", "", "", "", "yes"]])):
        found = [list(row.values()) for row in rows(folder / f"data/{name}.csv")]
        expect(found == wanted, name, *found)


def built_report_is_whole(root, folder):
    """Without LaTeX: one page that fetches nothing, with every figure, table and reference."""
    run = subprocess.run([sys.executable, root / "scripts/report", "--root", folder, "--out", folder / "out"], capture_output=True, text=True,
                         check=False, env={"PATH": "/nonexistent"})
    expect(run.returncode == 0 and "there is no pdflatex" in run.stdout, run.stdout, run.stderr)
    page = (folder / "out/report.html").read_text()
    source = (folder / "research/report/report.md").read_text()
    expect(page.count("<figure>") == source.count("\n![") > 4, "figures")
    expect(page.count("<table>") == len(re.findall(r"^\| ---", source, re.M)), "tables")
    expect(not re.search(r'(src|href)="(https?:)?//|url\(', page), "the page fetches something")
    expect("<!--" not in page and "?]" not in page and "**" not in re.sub(r"<pre>.*?</pre>", "", page, flags=re.S), "marks are left")
    tex = (folder / "out/report.tex").read_text()
    expect(tex.count(r"\begin{figure}") == page.count("<figure>") and tex.count("{") == tex.count("}"), "LaTeX")
    keys = set(re.findall(r"\\bibitem\{(\w+)\}", tex))
    expect(keys == {key for group in re.findall(r"\\cite(?:\[[^]]*\])?\{([^}]*)\}", tex) for key in group.split(",")}, "references", keys)


def main():
    what, *paths = sys.argv[1:] if sys.argv[1].startswith("--") else ["", *sys.argv[1:]]
    root = pathlib.Path(paths[0]).resolve()
    if what == "--citation":
        wanted = re.search(r"project\(morula VERSION ([\d.]+)", (root / "CMakeLists.txt").read_text())[1]
        citation = (root / "CITATION.cff").read_text()
        expect(re.findall(r"^version: (\S+)$", citation, re.M) == [wanted], "CITATION.cff has another version than", wanted)
        expect(f"Morula {wanted}" in citation, "CITATION.cff names the report of another version")
        page = (root / "docs/index.md").read_text()
        expect(f"version = {{{wanted}}}" in page, "docs/index.md cites another version than", wanted)
        title = re.search(r"^# (.*)$", (root / "research/report/report.md").read_text(), re.M)[1]
        expect(f'title: "{title}"' in citation and f"{{{title}}}" in page, "the report has another title")
        return 0
    folder = pathlib.Path(paths[1]).resolve()
    if what == "--latex":
        if not shutil.which("pdflatex"):
            print("skipped: there is no pdflatex")
            return 77
        copy_of_report(root, folder)
        run = subprocess.run([sys.executable, root / "scripts/report", "--root", folder, "--out", folder / "out"], capture_output=True, text=True, check=False)
        expect(run.returncode == 0 and (folder / "out/report.pdf").stat().st_size > 100_000, run.stdout, run.stderr)
        return 0
    claims_follow_from_trials(root / "research/report/data")
    text_follows_from_cases(root)
    small_study_is_taken(root, folder)
    planted_faults_are_named(root, folder)
    copy_of_report(root, folder)
    built_report_is_whole(root, folder)
    return 0


sys.exit(main())
