# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Every number and table that the report and the pages of the study quote, as text, from the tables of `study_data.py`.

`numbers(root)` maps IDs to text, `tables(root)` names to rows with their head, and `statements(root)` IDs to true or false:
sentences in words, which a page marks with <!--true ID-->.
"""
import json
import pathlib
import statistics

import study_data

UPDATES = ["traditional", "weighted", "approach1", "approach2", "exact"]
TITLES = {"traditional": "Traditional", "weighted": "Weighted", "approach1": "Approach 1", "approach2": "Approach 2", "exact": "Exact"}
MOTIONS = {"stretch": "stretch", "twist": "twist", "bend": "bend"}
SMALL_NUMBERS = ["none", "one", "two", "three", "four", "five", "six", "seven", "eight", "nine", "ten", "eleven", "twelve"]


def digits(value, count=3):
    """So many digits that count, zeros at the end too; 0 without any."""
    if value == 0:
        return "0"
    text = f"{value:#.{count}g}"
    if "e" in text:
        return f"{value:.0f}" if abs(value) >= 1 else "< 0.0001" if value > 0 else text
    return text.rstrip(".")


def percent(share):
    """A share in percent, with two digits that count."""
    value = 100 * share
    return "0 %" if value == 0 else "100 %" if value == 100 else "< 0.01 %" if value < 0.01 else f"{digits(value, 2)} %" if value < 99 else f"{value:.1f} %"


def word(count):
    return SMALL_NUMBERS[count] if 0 <= count < len(SMALL_NUMBERS) else f"{count:,}"


def listed(names):
    names = list(names)
    return names[0] if len(names) == 1 else ", ".join(names[:-1]) + " and " + names[-1] if names else "none"


def number(text):
    return float(text) if text not in ("", None) else None


class Data:
    """The record of the study, and what is computed from it for several places."""

    def __init__(self, root):
        root = pathlib.Path(root)
        folder = root / "research/report/data"
        self.record = json.loads((folder / "record.json").read_text())
        for name in ("claims", "trials", "rules", "work", "contacts", "mixes"):
            setattr(self, name, study_data.read(folder, name))
        page = lambda name: [line.split("\t") for line in (root / "docs/_data" / name).read_text().splitlines()
                             if line and not line.startswith("#")]
        self.quick, self.variants, self.amounts = page("study_claims.tsv"), page("study_variants.tsv"), page("study_amounts.tsv")
        self.claim = {claim["id"]: claim for claim in self.claims}
        self.cases = {}
        for row in self.rules:
            if row["rule"] in UPDATES and row["looseness"]:
                key = (row["body"], row["method"], row["motion"], row["level"])
                self.cases.setdefault(key, {})[row["rule"]] = (float(row["looseness"]), float(row["uncovered"]), float(row["uncovered_worst"]))
        self.cases = {key: case for key, case in self.cases.items() if "exact" in case}

    def ratios(self, rule, over, motion=""):
        return [case[rule][0] / case[over][0] for key, case in self.cases.items()
                if rule in case and over in case and key[2].startswith(motion) and case[over][0] > 0]


def claim_word(claim):
    return "better" if claim["adverse"] and claim["verdict"] == "fails" else claim["verdict"]


def add_study(data, found):
    record, settings = data.record, data.record["settings"]
    bodies = record["bodies"]
    found["study.command"] = f"`{record['command']}`"
    found["study.version"] = record["morula"]
    found["study.seeds"] = word(len(settings["seeds"]))
    found["study.bodies"] = word(len(bodies))
    found["study.body-names"] = listed(body["name"] for body in bodies)
    found["study.trials"] = str(record["trials"])
    found["study.samples"] = str(settings["samples"])
    found["study.decisive"] = word(len(settings["decisive_samples"]))
    found["study.resolution"] = str(settings["resolution"])
    found["study.branching"], found["study.depth"] = str(settings["branching"]), str(settings["depth"])
    found["study.methods"] = listed(f"`{name}`" for name in record["methods"])
    found["study.press-budgets"] = listed(f"{budget:,}" for budget in settings["press"]["budgets"])
    found["study.press-amounts"] = listed(f"{100 * amount:g}" for amount in settings["press"]["amounts"]) + " %"
    for what in ("vertices", "facets"):
        found[f"study.{what}"] = " to ".join(f"{end(body[what] for body in bodies):,}" for end in (min, max))
    for source in ("paper", "new"):
        claims = [claim for claim in data.claims if claim["source"] == source]
        found[f"{source}.claims"] = word(len(claims))
        for verdict in ("holds", "partly", "fails"):
            found[f"{source}.{verdict}"] = word(sum(claim["verdict"] == verdict for claim in claims))
    halves = record["stability"] or {"compared": 0, "same": 0, "differing": [], "seeds": [[], []]}
    found["halves.same"], found["halves.compared"] = str(halves["same"]), str(halves["compared"])
    found["halves.differing"] = listed(f"`{name}`" for name in halves["differing"])
    found["halves.seeds"] = " against ".join(", ".join(map(str, half)) for half in halves["seeds"])
    both = [claim for claim in data.claims if claim["seed"] and claim["body"]]
    for cause in ("seed", "body"):
        found[f"depends.{cause}"] = percent(statistics.fmean(float(claim[cause]) for claim in both))
    pairs = [(row[3], data.claim[row[0]]["verdict"]) for row in data.quick if row[0] in data.claim]
    decided = [pair for pair in pairs if "not decided" not in pair]
    found["quick.compared"], found["quick.same"] = str(len(decided)), str(sum(a == b for a, b in decided))
    found["quick.differing"] = listed(f"`{row[0]}`" for row in data.quick if row[0] in data.claim and "not decided" not in
                                      (row[3], data.claim[row[0]]["verdict"]) and row[3] != data.claim[row[0]]["verdict"])


def add_claims(data, found):
    for name, claim in data.claim.items():
        for key in ("holds", "partly", "fails", "trials"):
            found[f"claim.{name}.{key}"] = claim[key]
        found[f"claim.{name}.verdict"] = claim["verdict"]
        for key in ("true", "cases"):
            if claim[key]:
                found[f"claim.{name}.{key}"] = f"{int(claim[key]):,}"
        if claim["cases"]:
            found[f"claim.{name}.share"] = percent(int(claim["true"]) / int(claim["cases"]))
        for key in ("mean", "low", "high"):
            if claim[key]:
                found[f"claim.{name}.{key}"] = digits(float(claim[key]))
                found[f"claim.{name}.{key}-percent"] = percent(float(claim[key]))
        if claim["cliffs_delta"]:
            found[f"claim.{name}.delta"] = signed(float(claim["cliffs_delta"]))
        for cause in ("seed", "body", "amount", "resolution"):
            if claim[cause]:
                found[f"claim.{name}.by-{cause}"] = f"{100 * float(claim[cause]):.0f} %"


def signed(value):
    """Two decimals with a sign; 0 without."""
    return "0" if abs(value) < 0.005 else f"{value:+.2f}".replace("-", "−")


def add_rules(data, found):
    cases = data.cases
    found["cases"] = str(len(cases))
    for rule in UPDATES:
        of = [case[rule] for case in cases.values() if rule in case]
        if not of:
            continue
        found[f"rule.{rule}.over-exact"] = digits(statistics.median(data.ratios(rule, "exact")))
        for motion in MOTIONS:
            found[f"rule.{rule}.over-exact.{motion}"] = digits(statistics.median(data.ratios(rule, "exact", motion)))
            found[f"rule.exact.over-{rule}.{motion}"] = digits(statistics.median(data.ratios("exact", rule, motion)))
        found[f"rule.{rule}.uncovered"] = percent(statistics.median(c[1] for c in of) / 100)
        found[f"rule.{rule}.uncovered-most"] = percent(max(c[2] for c in of) / 100)
        found[f"rule.{rule}.cases-uncovered"] = str(sum(c[2] > 0 for c in of))
        found[f"rule.{rule}.tighter"] = str(sum(case[rule][0] < case["exact"][0] for case in cases.values() if rule in case))
    tightest = [min((case[rule][0], rule) for rule in case)[1] for case in cases.values()]
    found["tightest.exact"] = str(sum(rule == "exact" for rule in tightest))
    found["tightest.uncovered"] = str(sum(case[rule][2] > 0 for rule, case in zip(tightest, cases.values())))
    found["tightest.uncovered-share"] = percent(sum(case[rule][2] > 0 for rule, case in zip(tightest, cases.values())) / len(cases))
    covering = [[(case[rule][0], rule) for rule in case if case[rule][2] == 0] for case in cases.values()]
    found["covering.exact"] = str(sum(min(of)[1] == "exact" for of in covering))
    agree = differ = 0
    for case in cases.values():
        rules = list(case.values())
        for i, a in enumerate(rules):
            for b in rules[:i]:
                if a[1] != b[1] and a[0] != b[0]:
                    differ += 1
                    agree += (a[1] > b[1]) == (a[0] < b[0])
    found["pairs"], found["pairs.rewarded"] = f"{differ:,}", f"{agree:,}"
    found["pairs.share"] = percent(agree / max(differ, 1))
    found["pairs.delta"] = signed(2 * agree / max(differ, 1) - 1)


def add_work(data, found):
    for name in dict.fromkeys(row["what"] for row in data.work):
        of = [row for row in data.work if row["what"] == name]
        key = name.replace(" ", "-").lower()
        for column, what in (("bytes_over_boxes", "bytes"), ("points", "points"), ("distances", "distances")):
            values = [float(row[column]) for row in of]
            found[f"work.{key}.{what}"] = digits(statistics.fmean(values))
            found[f"work.{key}.{what}-range"] = f"{digits(min(values))} to {digits(max(values))}"


def middle_and_range(rows, column, show):
    values = [float(row[column]) for row in rows if row[column]]
    return f"{show(statistics.median(values))} ({show(min(values))} to {show(max(values))})" if values else "–"


def add_contacts(data, found):
    for rule in dict.fromkeys(row["rule"] for row in data.contacts):
        of = [row for row in data.contacts if row["rule"] == rule]
        found[f"contacts.{rule}.positions"] = str(sum(int(row["positions"]) for row in of))
        found[f"contacts.{rule}.lost"] = str(sum(int(row["positions_lost"]) for row in of))
        found[f"contacts.{rule}.lost-most"] = percent(max(float(row["lost_most"]) for row in of) / 100)
        found[f"contacts.{rule}.bodies"] = listed(dict.fromkeys(row["body"] for row in of if int(row["positions_lost"])))
        for method in dict.fromkeys(row["method"] for row in of):
            here = [row for row in of if row["method"] == method]
            for column in ("depth", "corrected", "sum", "corrected_sum"):
                values = [float(row[column]) for row in here if row[column]]
                if values:
                    found[f"contacts.{method}.{rule}.{column}"] = digits(statistics.median(values), 2)


def add_contact_sums(data, found):
    sums = []
    for method in ("medial", "grid", "optimized", "octree"):
        for rule in ("traditional", "approach2", "exact"):
            values = [float(row["corrected_sum"]) for row in data.contacts
                      if row["method"] == method and row["rule"] == rule and row["corrected_sum"]]
            if values:
                sums.append(statistics.median(values))
    if sums:
        found["contacts.sum-range"] = f"{min(sums):.0f}° to {max(sums):.0f}°"


def mix_rows(data):
    """Each mix over all bodies: medians of looseness over exact's, the largest uncovered area, points and times over exact's."""
    groups = study_data.grouped(data.mixes, "mix")
    exact = {row["body"]: row for row in groups.get(("exact+exact",), [])}
    rows = []
    for (mix,), of in groups.items():
        over = [float(row["looseness"]) / float(exact[row["body"]]["looseness"]) for row in of]
        points = [float(row["points_per_vertex"]) for row in of]
        times = [float(row["ns_per_vertex"]) / float(exact[row["body"]]["ns_per_vertex"]) for row in of if row["ns_per_vertex"]]
        rows.append({"mix": mix, "over": statistics.median(over), "over_ends": (min(over), max(over)), "points": statistics.median(points),
                     "covered": sum(float(row["uncovered"]) == 0 for row in of), "bodies": len(of),
                     "most": max(float(row["uncovered"]) for row in of), "time": statistics.median(times) if len(times) == len(of) else None})
    return sorted(rows, key=lambda row: (row["covered"] < row["bodies"], row["over"]))


def add_mixes(data, found):
    rows = mix_rows(data)
    covering = [row for row in rows if row["covered"] == row["bodies"]]
    found["mixes.count"], found["mixes.covering"] = str(len(rows)), str(len(covering))
    for row in rows:
        key = "mix." + row["mix"].replace("+", "-").replace(" ", "-")
        found[f"{key}.over"] = digits(row["over"])
        found[f"{key}.covered"] = word(row["covered"])
        found[f"{key}.points"] = digits(row["points"])
        if row["time"] is not None:
            found[f"{key}.time"] = digits(row["time"], 2)


def add_readings(data, found):
    for number_of, rule in ((1, "approach1"), (2, "approach2")):
        rows = [row for row in data.variants if row[0].startswith(rule)]
        found[f"readings.{rule}"] = word(len(rows))
        for column, name in ((2, "lower"), (3, "exponential"), (4, "better"), (5, "returns"), (6, "uncovered")):
            for verdict in ("holds", "partly", "fails"):
                found[f"readings.{rule}.{name}.{verdict}"] = word(sum(row[column] == verdict for row in rows))
        for column, name in ((8, "looseness"), (9, "uncovered-most")):
            values = [float(row[column]) for row in rows]
            found[f"readings.{rule}.{name}-range"] = f"{digits(min(values))} to {digits(max(values))}"
    by = {(row[1], row[2]): row[3:] for row in data.amounts}
    grid = [float(value) for value in by["stretch", "share of the voxel grid"]]
    found["amounts.grid"] = f"{min(grid):.2f} to {max(grid):.2f}"
    found["amounts.object-a"] = by["stretch", "object volumes"][0]


def numbers(root):
    data, found = Data(root), {}
    for add in (add_study, add_claims, add_rules, add_work, add_contacts, add_contact_sums, add_mixes, add_readings):
        add(data, found)
    return found


def statements(root):
    """Sentences in words that pages make of the data."""
    data = Data(root)
    claim = data.claim
    always = lambda name: int(claim[name]["cases"]) > 0 and claim[name]["true"] == claim[name]["cases"]
    share = lambda name: int(claim[name]["true"]) / int(claim[name]["cases"])
    verdict = lambda name: claim[name]["verdict"]
    middle = lambda rule, over, motion="": statistics.median(data.ratios(rule, over, motion))
    fraction = lambda what: statistics.fmean(float(row["bytes_over_boxes"]) for row in data.work if row["what"] == what)
    mixes = {row["mix"]: row for row in mix_rows(data)}
    lost = lambda rule: sum(int(row["positions_lost"]) for row in data.contacts if row["rule"] == rule)
    halves = data.record["stability"]
    boxes = {row["body"]: float(row["points"]) for row in data.work if row["what"] == "boxes"}
    median_of = lambda values: statistics.median(list(values))
    marks = {}
    for key, case in data.cases.items():
        for rule, figures in case.items():
            for mark in ((rule, key[0]), (rule, "all")):
                marks.setdefault(mark, []).append((figures[0] / case["exact"][0], figures[1]))
    return {
        "approach2-always-uncovered": always("approach2-uncovered"),
        "traditional-always-uncovered": always("traditional-uncovered") and always("weighted-uncovered"),
        "exact-always-covers": always("exact-covers"),
        "tighter-is-uncovered": always("approach2-gain-is-uncovered"),
        "approach1-loses-more": verdict("approach1-below-traditional") != "holds" and share("approach1-below-traditional") < 0.1,
        "approach2-loses-less-mostly": share("approach2-below-traditional") > 0.5 and verdict("approach2-below-traditional") == "partly",
        "approach1-sometimes-uncovered": 0 < share("approach1-uncovered") < 1,
        "orders-are-unsettled": all(verdict(name) != "holds" for name in ("level2-hubbard-medial", "level3-grid", "medial-best-average")),
        "both-return": always("returns-to-rest"),
        "not-exponential": verdict("approach1-exponential") != "holds",
        "approach2-better-than-approach1": float(claim["approach2-largely-better"]["mean"]) > 1.5,
        "exact-looser-in-stretch": middle("exact", "approach2", "stretch") > 1,
        "exact-tighter-in-twist-and-bend": middle("exact", "approach2", "twist") < 1 and middle("exact", "approach2", "bend") < 1,
        "exact-tighter-than-approach1": share("exact-below-approach1") > 0.9,
        "approach1-moves-fewer-bytes": fraction("approach1") < 0.75 and fraction("approach2") < fraction("approach1"),
        "exact-loses-no-crossing": lost("exact") == 0 and always("exact-keeps-crossings"),
        "approach2-loses-crossings": lost("approach2") > 0,
        "correction-is-nearer": share("corrected-depth") > 0.8,
        "exact-is-the-tightest-mix-that-covers": bool(mixes) and next(iter(mixes)) == "exact+exact",
        "approach1-is-loosest": max(UPDATES, key=lambda rule: middle(rule, "exact")) == "approach1",
        "no-more-than-twice-boxes": all(float(row["bytes_over_boxes"]) <= 2 and float(row["points"]) <= 2 * boxes[row["body"]]
                                        for row in data.work if row["what"] in ("approach1", "approach2")),
        "bodies-change-more-than-seeds": number_of_dependence(data, "body") > number_of_dependence(data, "seed"),
        "tighter-marks-lie-above-zero": all(median_of(case[1] for case in of) > 0 for of in marks.values() if median_of(case[0] for case in of) < 1),
        "halves-agree": bool(halves) and 10 * halves["same"] >= 9 * halves["compared"],
        "uncovered-is-rewarded": float(numbers_share(data)) > 0.5,
    }


def number_of_dependence(data, cause):
    return statistics.fmean(float(claim[cause]) for claim in data.claims if claim["seed"] and claim["body"])


def numbers_share(data):
    found = {}
    add_rules(data, found)
    return int(found["pairs.rewarded"].replace(",", "")) / int(found["pairs"].replace(",", ""))


# ---- tables: a head and rows of text ----


def bodies_with(trials, verdict, decided):
    """"limb, bar (2/3)": bodies with trials of this verdict, and their share of seeds where it is not all."""
    parts = []
    for (body,), of in study_data.grouped(decided, "body").items():
        count = sum(trial["verdict"] == verdict for trial in of)
        if count:
            parts.append(body if count == len(of) else f"{body} ({count}/{len(of)})")
    return ", ".join(parts)


def trials_text(data, claim):
    decided = [trial for trial in data.trials if trial["id"] == claim["id"] and trial["verdict"] != "not decided"]
    text = f"holds in {claim['holds']} of {claim['trials']}"
    for verdict in ("partly", "fails"):
        if int(claim[verdict]):
            names = bodies_with(data.trials, verdict, decided)
            text += f"; {verdict} on " + ("all bodies" if claim[verdict] == claim["trials"] else names)
    return text


def mean_text(claim):
    return f"{digits(float(claim['mean']))} ({digits(float(claim['low']))} to {digits(float(claim['high']))})" if claim["mean"] else ""


def depends_text(claim):
    return ", ".join(f"{cause} {100 * float(claim[cause]):.0f} %" for cause in ("seed", "body", "amount", "resolution")
                     if claim[cause] and float(claim[cause]) >= 0.005)


def cases_text(claim):
    return f"{int(claim['true']):,} of {int(claim['cases']):,}" if claim["cases"] else ""


def claims_table(data):
    """The table of study_claims.md."""
    body, last = [], None
    for claim in data.claims:
        if claim["source"] != last:
            body.append(("*of the paper*" if claim["source"] == "paper" else "*not measured there*", "", "", "", "", ""))
        last = claim["source"]
        mean = mean_text(claim)
        body.append((claim["claim"], f"**{claim_word(claim)}**", trials_text(data, claim), f"{claim['quantity']}: {mean}" if mean else "",
                     cases_text(claim), depends_text(claim)))
    return ("claim", "", "trials", "mean and 95 % interval", "true in cases", "the verdict changes with"), body


def report_claims(source):
    def make(data):
        rows = []
        for claim in (claim for claim in data.claims if claim["source"] == source):
            delta = signed(float(claim["cliffs_delta"])) if claim["cliffs_delta"] else ""
            rows.append((claim["claim"], claim_word(claim), f"{claim['holds']} / {claim['partly']} / {claim['fails']}", mean_text(claim),
                         cases_text(claim), delta, depends_text(claim)))
        return ("claim", "verdict", "holds / partly / fails", "mean (95 % interval)", "true in cases", "δ", "verdict changes with"), rows
    return make


def quantities(data):
    return ("claim", "number of the column *mean*"), [(claim["claim"], claim["quantity"]) for claim in data.claims if claim["mean"]]


def rules_table(data):
    found = {}
    add_rules(data, found)
    rows = []
    for rule in UPDATES:
        if f"rule.{rule}.over-exact" in found:
            rows.append((f"`{rule}`", *(found[f"rule.{rule}.over-exact.{motion}"] for motion in MOTIONS), found[f"rule.{rule}.uncovered"],
                         found[f"rule.{rule}.uncovered-most"], f"{found[f'rule.{rule}.cases-uncovered']} of {found['cases']}"))
    return ("rule", "stretch", "twist", "bend", "uncovered, median", "uncovered, most", "cases with uncovered surface"), rows


def work_table(data):
    found = {}
    add_work(data, found)
    rows = []
    for name in dict.fromkeys(row["what"] for row in data.work):
        key = name.replace(" ", "-").lower()
        rows.append((f"`{name}`" if name in UPDATES else name, found[f"work.{key}.points"], found[f"work.{key}.distances"],
                     found[f"work.{key}.bytes"], found[f"work.{key}.bytes-range"]))
    return ("update", "points per vertex", "distances per vertex", "bytes over those of boxes", "range over bodies"), rows


def contacts_table(data):
    """The table of study_contacts.md: medians over bodies, ranges in parentheses."""
    whole = lambda value: f"{value:.0f}"
    times = lambda value: digits(value)
    degrees = lambda value: f"{value:.0f}°"
    tenths = lambda value: f"{value:.1f}°"
    rows = []
    for method in ("medial", "grid", "optimized", "octree"):
        for rule in ("traditional", "approach2", "exact"):
            of = [row for row in data.contacts if row["method"] == method and row["rule"] == rule]
            if not of:
                continue
            lost, positions = sum(int(row["positions_lost"]) for row in of), sum(int(row["positions"]) for row in of)
            rows.append((f"`{method}`", rule, middle_and_range(of, "contacts", whole), middle_and_range(of, "depth", times),
                         middle_and_range(of, "corrected", times), middle_and_range(of, "normal", degrees),
                         middle_and_range(of, "corrected_normal", degrees), middle_and_range(of, "sum", tenths),
                         middle_and_range(of, "corrected_sum", tenths),
                         f"{lost} of {positions}, {max(float(row['lost_most']) for row in of):.0f} %"))
    return ("tree", "rule", "contacts", "largest depth over true", "corrected", "normals", "corrected", "sum", "corrected", "lost"), rows


def mixes_table(data):
    """The tightest mixes that leave nothing uncovered on any body, and the tightest of the others."""
    rows = mix_rows(data)
    covering = [row for row in rows if row["covered"] == row["bodies"]][:8]
    others = sorted((row for row in rows if row["covered"] < row["bodies"]), key=lambda row: row["over"])[:3]
    return ("inner + leaves", "looseness over exact's", "bodies without uncovered surface", "uncovered, most", "points per vertex", "time over exact's (timed)"), \
        [(row["mix"], f"{digits(row['over'])} ({digits(row['over_ends'][0])} to {digits(row['over_ends'][1])})", f"{row['covered']} of {row['bodies']}",
          percent(row["most"] / 100), digits(row["points"]), digits(row["time"], 2) if row["time"] else "") for row in covering + others]


def variants_table(data):
    return ("reading", "lower loss", "exponential", "largely better", "uncovered", "looseness", "uncovered, %"), \
        [(f"`{row[0]}`", row[2], row[3], row[4], row[6], row[8], row[9]) for row in data.variants]


def amounts_table(data):
    return ("motion", "unit", "Fig. 2 a", "b", "c", "d"), [row[1:] for row in data.amounts]


def bodies_table(data):
    return ("body", "vertices", "facets"), [(body["name"], f"{body['vertices']:,}", f"{body['facets']:,}") for body in data.record["bodies"]]


def commands(data):
    """A block of code, not a table."""
    return f"```\n{data.record['command']} -o study --formats svg,csv,pdf,pgf\nscripts/report --data study\nscripts/pages\n```"


TABLES = {"study claims": claims_table, "study contacts": contacts_table, "study mixes": mixes_table,
          "report claims of the paper": report_claims("paper"), "report claims beyond the paper": report_claims("new"),
          "report quantities": quantities, "report rules": rules_table, "report work": work_table, "report variants": variants_table,
          "report amounts": amounts_table, "report bodies": bodies_table,
          "report commands": commands}


def table(root, name):
    return TABLES[name](Data(root))
