#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/figures reads the right cell of a report, writes it as the entry asks, and refuses results that are wrong or missing.
usage: figures_test.py path/to/scripts/figures FOLDER"""
import json
import pathlib
import shutil
import subprocess
import sys

script, folder = sys.argv[1], pathlib.Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
(folder / "bin").mkdir(parents=True)


def program(name, text):
    (folder / "bin" / name).write_text(f"#!{sys.executable}\n{text}")
    (folder / "bin" / name).chmod(0o755)


def row(item, median, figures, faults=()):
    return {"item": item, "min": median / 2, "median": median, "worst": 2 * median, "figures": figures, "faults": list(faults)}


# Stands for the bench: a report for each scenario, and a line for each run.
reports = {
    "a": {"results": [row("own", 119.3e-6, {"pairs": 344.4, "us": 784.4}), row("FCL", 1, {"times ours": 19.44}),
                      row("stretch", 1, {"over": 1.041}), row("twist", 1, {"over": 0.99}), row("small", 0.0612e-3, {})]},
    "wrong": {"results": [row("own", 1, {}, ["a facet is bare"])]},
}
program("morula_bench", f"""import json, sys
open({str(folder / "runs")!r}, "a").write(" ".join(sys.argv[1:]) + "\\n")
scenario = sys.argv[sys.argv.index("--scenario") + 1]
if scenario == "ends": sys.exit("no such mesh")
print(json.dumps({reports!r}[scenario]))
""")
program("morula", "import sys\nsys.exit(0 if sys.argv[1] == 'build' else 2)\n")


def bench(item, value, scenario="a", **how):
    return {"text": "old", "measure": {"bench": f"--scenario {scenario} --mesh limb", "item": item, "value": value, **how}}


good = {
    "time": (bench("own", "median", unit="µs"), "119 µs"),
    "least": (bench("own", "min", unit="µs"), "60 µs"),
    "small": (bench("small", "median", unit="ms"), "0.061 ms"),
    "one.digit": (bench("small", "median", unit="ms", digits=1), "0.06 ms"),
    "count": (bench("own", "pairs", digits=3), "344"),
    "scaled": (bench("own", "us", unit="ms", times=1e-3), "0.78 ms"),
    "ratio": (bench("F*", "times ours"), "19"),
    "largest": (bench(["twist", "stretch"], "over", decimals=2), "1.04"),
    "below.one": (bench("twist", "over", decimals=2), "0.99"),
}
bad = {
    "fault": (bench("own", "median", "wrong", unit="s"), "a facet is bare"),
    "row": (bench("Bullet", "median", unit="s"), "no row is called Bullet"),
    "column": (bench("own", "depth"), "own has no depth"),
    "end": (bench("own", "median", "ends", unit="s"), "exit status 1: no such mesh"),
    "command": ({"text": "old", "measure": {"seconds": "paint", "unit": "s"}}, "returned non-zero exit status 2"),
}
record = {"text": "a tenth", "from": "the run of a paper"}
data = folder / "figures.json"


def run(*arguments):
    return subprocess.run([sys.executable, script, *arguments, "--build", str(folder), "--data", str(data)],
                          capture_output=True, text=True, check=False)


def expect(condition, *what):
    if not condition:
        sys.exit("\n".join(map(str, what)))


def put(entries):
    data.write_text(json.dumps({"figures": {**{name: entry for name, (entry, _) in entries.items()}, "record": record}}))


put(good)
done = run()
expect(done.returncode == 0, "sound figures are refused:", done.stderr)
for name, (_, text) in good.items():
    line = [line for line in done.stdout.splitlines() if line.startswith(name + " ")]
    expect(line and line[0].endswith(f"now {text}"), f"{name} is not {text}:", done.stdout)
expect("\nrecord " not in done.stdout, "what is of a record was measured:", done.stdout)
expect(len((folder / "runs").read_text().splitlines()) == 1, "the bench ran more than once")
expect(json.loads(data.read_text())["figures"]["time"]["text"] == "old", "written without --write")
expect(run("--write", "time", "co*").returncode == 0, "--write fails")
after = json.loads(data.read_text())["figures"]
expect([after[name]["text"] for name in ("time", "count", "ratio", "record")] == ["119 µs", "344", "old", "a tenth"], after)
expect("machine" in after["time"] and "machine" not in after["ratio"], after)
expect(run("nothing.*").returncode == 2, "an ID that does not exist is accepted")
listed = run("--list").stdout
expect("a record: the run of a paper" in listed and "morula_bench --scenario a --mesh limb" in listed, listed)
for name, (entry, words) in bad.items():
    put({name: (entry, words), "time": good["time"]})
    done = run("--write")
    expect(done.returncode == 1 and words in done.stderr, f"{name} is not refused with \"{words}\":", done.stderr, done.stdout)
    after = json.loads(data.read_text())["figures"]
    expect((after[name]["text"], after["time"]["text"]) == ("old", "119 µs"), after)

# Each entry of ours says how it is measured or from which record it is, by names of programs and units that exist.
ours = json.loads((pathlib.Path(script).parents[1] / "docs/_data/figures.json").read_text())["figures"]
for name, entry in ours.items():
    expect(("measure" in entry) != ("from" in entry), f"{name} needs either a measure or a record")
    measure = entry.get("measure", {})
    expect(measure.keys() <= {"bench", "seconds", "item", "value", "unit", "digits", "decimals", "times"}, name, measure)
    expect(measure.get("unit", "s") in ("s", "ms", "µs", "ns"), name, measure)
    expect("seconds" in measure or "bench" not in measure or {"item", "value"} <= measure.keys(), name, measure)
