#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/prose: every pattern catches its example and leaves the right sentence beside it alone; every kind of text is read; limits hold.
usage: prose_test.py path/to/scripts/prose path/to/prose_markers.tsv FOLDER"""
import pathlib
import re
import shutil
import subprocess
import sys

script, table, folder = sys.argv[1], pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[3])


def expect(condition, *what):
    if not condition:
        sys.exit("\n".join(map(str, what)))


# The examples of the table, judged by the pattern of their own row.
rows = [line.split("\t") for line in table.read_text().splitlines() if line.startswith("marker\t")]
expect(len(rows) > 30, "the table has", len(rows), "patterns")
for row in rows:
    expect(len(row) in (6, 7), row, "has no example")
    pattern = row[3].replace("START", r"(?:^|(?<=[.!?]\s))")
    expect(re.search(pattern, row[5]), pattern, "does not catch", row[5])
    expect(len(row) == 6 or not re.search(pattern, row[6]), pattern, "catches", row[-1])

# A tree of one file for each kind of text, with one marker each: "nobody".
shutil.rmtree(folder, ignore_errors=True)


def write(name, text):
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    (folder / name).write_text(text)


def run(*arguments):
    result = subprocess.run([sys.executable, script, *arguments, "--root", str(folder)], capture_output=True, text=True)
    return result.returncode, result.stdout, result.stderr


nobody = "marker\ttable\tall\t\\b[Nn]obody\\b\tno caller\tNobody.\n"
of = "marker\t3\tfields\t^of\\b\tnoun phrase\tof.\n"
kinds = {"a.md": "pages", "b.hpp": "comments", "c.cpp": "strings", "d.py": "docstrings", "e.js": "script_comments",
         "f.js": "texts", "g.html": "texts"}


def write_table(limit):
    write("tests/house/prose_markers.tsv", "# comment\n" + nobody + of + "".join(
        f"group\t{kind}_{name[0]}\t{limit}\t{kind}\t{name}\n" for name, kind in kinds.items()))


write("a.md", "# Nobody\n\nText with `nobody` and a\n[link](nobody.md).\n\n```sh\nnobody\n```\n\n| a | b |\n| - | - |\n| x | y |\n")
write("b.hpp", '// Two lines, and\n// nobody reads them.\nint a = f("nobody reads the text");  ///< of a\nint nobody_else();  // nobody_else()\n'
               "// Example:\n//   nobody\n")
write("c.cpp", 'throw x("no tree: " /* nobody */\n  "nobody built it"); // nobody\nint n = 1\'000; y("nobody"); z = \'"\';\n')
write("d.py", 'def f():\n    """First part.\n\n    Nobody is here."""\n    return "nobody at all is here"\n')
write("e.js", "const a = 'nobody reads the text';  // nobody reads\n")
write("f.js", "const a = `nobody ${b} reads the text`;  // nobody reads\n")
write("g.html", '<p title="nobody">Text</p><script>nobody</script>\n')
write_table(1000)
code, out, said = run("--list")
expect(code == 0, out, said)
found = sorted(line.partition(" (rule")[0] for line in out.splitlines())
expect(found == ["a.md:1: Nobody", "b.hpp:2: nobody", "b.hpp:3: of", "c.cpp:2: nobody", "d.py:4: Nobody", "e.js:1: nobody",
                 "f.js:1: nobody", "g.html:1: nobody"], *found)
expect(run("--list", "strings_c")[1].startswith("c.cpp:2: nobody") and "a.md" not in run("--list", "strings_c")[1], *run("--list", "strings_c"))
expect(run("--list", "no_such_group")[0] == 2 and run("--what")[0] == 2, "bad use is no 2")

# Limits: exceeded, met, lowered, never raised, never below 1.
write_table(10)
code, out, said = run()
expect(code == 1 and "pages_a: " in said and "limit 10" in said, out, said)
write_table(1000)
code, out, said = run("--lower")
lowered = (folder / "tests/house/prose_markers.tsv").read_text()
limits = dict(re.findall(r"(?m)^group\t(\w+)\t([\d.]+)", lowered))
expect(code == 0 and all(1 <= float(limit) < 1000 for limit in limits.values()), lowered, said)
expect(run()[0] == 0, *run())
write("a.md", "Sound text of enough words to pass.\n" + "Words. " * 100)
expect(run("--lower")[0] == 0 and "group\tpages_a\t1\t" in (folder / "tests/house/prose_markers.tsv").read_text(), "no limit of 1")
write("a.md", "Sound text. " * 20 + "Nobody reads.\n")
expect(run("--lower")[0] == 1 and "group\tpages_a\t1\t" in (folder / "tests/house/prose_markers.tsv").read_text(), "a limit rose")
# A group whose files have moved is a fault, and so is a row that cannot be read.
(folder / "d.py").unlink()
expect("docstrings_d: no words in d.py" in run()[2], *run())
write("tests/house/prose_markers.tsv", nobody + "marker\ttable\tall\t(\n")
expect(run()[0] == 1 and "prose_markers.tsv:2" in run()[2], *run())
