# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Small tables of a study's folder, which the report and the pages of the study quote.

`extract` writes them from study.json, one file a table, each with the command that made it in its first line; `read` returns
the rows of one. Numbers keep six digits.
"""
import csv
import json
import pathlib
import re
import statistics
import zlib

FIGURES = ["fig1", "fig2a", "fig2b", "fig2c-stretch", "fig2d-stretch"]


def read(folder, name):
    """The rows of NAME.csv as dicts of text; none where the file is not there."""
    path = pathlib.Path(folder) / f"{name}.csv"
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def write(folder, name, command, columns, rows):
    with (pathlib.Path(folder) / f"{name}.csv").open("w", newline="") as file:
        file.write(f"# {command}\n")
        table = csv.writer(file, lineterminator="\n")
        table.writerow(columns)
        for row in rows:
            table.writerow("" if cell is None else f"{cell:.6g}" if isinstance(cell, float) else cell for cell in row)


def table_of(study, name):
    """The rows of a table of study.json as dicts; of columns with one name the later ones get a number."""
    found = [table for table in study["tables"] if table["id"] == name]
    if not found:
        return []
    columns, seen = [], {}
    for column in found[0]["columns"]:
        seen[column] = seen.get(column, 0) + 1
        columns.append(column if seen[column] == 1 else f"{column} {seen[column]}")
    return [dict(zip(columns, row)) for row in found[0]["rows"]]


def grouped(rows, *keys):
    groups = {}
    for row in rows:
        groups.setdefault(tuple(row[key] for key in keys), []).append(row)
    return groups


def known(rows, column):
    return [row[column] for row in rows if row[column] is not None]


def claim_rows(study):
    for claim in study["claims"]:
        counts, value, effect, depends = claim["counts"], claim.get("value") or {}, claim.get("effect") or {}, claim["depends_on"]
        decided = counts["holds"] + counts["partly"] + counts["fails"]
        yield [claim["id"], claim["source"], claim["claim"], claim["verdict"], counts["holds"], counts["partly"], counts["fails"], decided,
               claim.get("quantity", ""), *(value.get(end) for end in ("mean", "low", "high")), effect.get("true"), effect.get("cases"),
               effect.get("cliffs_delta"), effect.get("median_ratio"), *(depends[cause] for cause in ("seed", "body", "amount", "resolution")),
               "yes" if claim.get("adverse") else "", "yes" if claim.get("guarantee") else ""]


def trial_rows(study):
    for claim in study["claims"]:
        for trial in claim["trials"]:
            yield [claim["id"], trial["body"], trial["seed"], trial["verdict"], trial["true"], trial["cases"], trial["value"],
                   trial["at_half_amount"], trial["at_half_resolution"]]


def rule_rows(study):
    """Each body, generator, motion, level and rule: means over seeds, and the largest uncovered area of a seed."""
    for key, rows in grouped(table_of(study, "rules"), "body", "method", "motion", "level", "rule").items():
        looseness, uncovered = known(rows, "mean"), known(rows, "uncovered, %")
        yield [*key, len(rows), statistics.fmean(known(rows, "at rest")) if known(rows, "at rest") else None,
               statistics.fmean(looseness) if looseness else None, statistics.fmean(uncovered), max(uncovered),
               max(known(rows, "uncovered distance, %"))]


def work_rows(study):
    """Counted work of an update of each body, means over generators and seeds."""
    columns = ["points", "children", "distances", "bytes read", "bytes written", "bytes over boxes"]
    for key, rows in grouped(table_of(study, "work"), "body", "what").items():
        yield [*key, len(rows), *(statistics.fmean(float(row[column]) for row in rows) for column in columns)]


def contact_rows(study):
    """The query of all leaves for each body, tree and rule, as study_contacts.md explains it."""
    leaves = [row for row in table_of(study, "contacts") if row["query"] == "leaves"]
    for key, rows in grouped(leaves, "body", "method", "rule").items():
        deep = [row for row in rows if row["pressed, %"] > 0.5]
        middle = lambda column: statistics.median(known(deep, column)) if known(deep, column) else None
        yield [*key, middle("contacts"), middle("depth"), max(known(deep, "depth"), default=None), middle("corrected"),
               max(known(deep, "corrected"), default=None), middle("normal"), middle("corrected normal"), middle("sum"),
               middle("corrected sum"), len(rows), sum(row["lost"] > 0 for row in rows),
               100 * max(row["lost"] / row["crossings"] if row["crossings"] else 0.0 for row in rows)]


TABLES = {
    "claims": (claim_rows, ["id", "source", "claim", "verdict", "holds", "partly", "fails", "trials", "quantity", "mean", "low", "high", "true",
                            "cases", "cliffs_delta", "median_ratio", "seed", "body", "amount", "resolution", "adverse", "guarantee"]),
    "trials": (trial_rows, ["id", "body", "seed", "verdict", "true", "cases", "value", "at_half_amount", "at_half_resolution"]),
    "rules": (rule_rows, ["body", "method", "motion", "level", "rule", "seeds", "rest", "looseness", "uncovered", "uncovered_worst", "distance_worst"]),
    "work": (work_rows, ["body", "what", "trees", "points", "children", "distances", "bytes_read", "bytes_written", "bytes_over_boxes"]),
    "contacts": (contact_rows, ["body", "method", "rule", "contacts", "depth", "depth_most", "corrected", "corrected_most", "normal",
                                "corrected_normal", "sum", "corrected_sum", "positions", "positions_lost", "lost_most"]),
}


def command_of(study):
    """The command of a study without other options than these."""
    settings = study["settings"]
    words = ["morula", "study", *(["--quick"] if settings["quick"] else []), "--seeds", str(len(settings["seeds"]))]
    usual = ["traditional", "weighted", "approach1", "approach2", "exact", "rebuilt", *([] if settings["quick"] else ["fresh"])]
    if settings["rules"] != usual:
        words += ["--rules", ",".join(settings["rules"])]
    return " ".join(words)


def compressed_pdf(text):
    """A PDF of the study with its drawing compressed: the objects are numbered from 1, without gaps."""
    objects = re.findall(rb"(?ms)^\d+ 0 obj\n(.*?)\nendobj$", text)
    out, places = b"%PDF-1.4\n", []
    for number, body in enumerate(objects, 1):
        if drawing := re.fullmatch(rb"(?s)<< /Length \d+ >>\s*stream\n(.*?)\n?endstream", body):
            packed = zlib.compress(drawing[1], 9)
            body = b"<< /Filter /FlateDecode /Length %d >>\nstream\n%s\nendstream" % (len(packed), packed)
        places.append(len(out))
        out += b"%d 0 obj\n%s\nendobj\n" % (number, body)
    table = b"".join(b"%010d 00000 n \n" % place for place in places)
    return out + (b"xref\n0 %d\n0000000000 65535 f \n%strailer\n<< /Size %d /Root 1 0 R >>\nstartxref\n%d\n%%%%EOF\n"
                  % (len(places) + 1, table, len(places) + 1, len(out)))


def extract(source, data, figures, command=None):
    """Writes the tables of SOURCE/study.json into DATA, and the figures that the report shows into FIGURES."""
    source = pathlib.Path(source)
    study = json.loads((source / "study.json").read_text())
    command = command or command_of(study)
    for name, (make, columns) in TABLES.items():
        write(data, name, command, columns, make(study))
    settings = study["settings"]
    kept = ("quick", "samples", "decisive_samples", "levels", "branching", "depth", "seeds", "resolution", "unit", "motions", "rules", "press")
    record = {"command": command, "morula": study["morula"], "settings": {key: settings[key] for key in kept},
              "trials": len(settings["trials"]), "methods": list(dict.fromkeys(row["method"] for row in table_of(study, "trees"))),
              "bodies": study["bodies"], "stability": study["stability"], "skipped": study["skipped"],
              "styles": {line["name"]: line["style"] for figure in study["figures"] if figure["id"] == "fig2a" for line in figure["series"]}}
    (pathlib.Path(data) / "record.json").write_text(json.dumps(record, indent=1, ensure_ascii=False) + "\n")
    copied = []
    for name in FIGURES:
        for ending in ("svg", "pgf", "pdf") if name == "fig1" else ("svg", "pgf"):
            if (source / f"{name}.{ending}").exists():
                content = (source / f"{name}.{ending}").read_bytes()
                (pathlib.Path(figures) / f"{name}.{ending}").write_bytes(compressed_pdf(content) if ending == "pdf" else content)
                copied.append(f"{name}.{ending}")
    return copied


def extract_mixes(source, data):
    """mixes.csv from SOURCE/BODY/study.json, the runs of one body each."""
    rows = []
    for path in sorted(pathlib.Path(source).glob("*/study.json")):
        study = json.loads(path.read_text())
        body = study["bodies"][0]["name"]
        times = {row["mix"]: row["ns per vertex"] for row in table_of(study, "mixes-cost")}
        for row in table_of(study, "mixes"):
            looseness = next(value for column, value in row.items() if column.startswith("looseness"))
            rows.append([body, row["mix"], looseness, row["worst uncovered area, %"], row["points per vertex"], times.get(row["mix"])])
    order = ["limb", "bar", "torus", "blob", "hand", "vessel"]
    rows.sort(key=lambda row: order.index(row[0]) if row[0] in order else len(order))
    write(data, "mixes", "morula study --mixes --methods medial --rules exact,approach2 --seeds 1 --bodies BODY", 
          ["body", "mix", "looseness", "uncovered", "points_per_vertex", "ns_per_vertex"], rows)
