# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/pictures --check finds what it is for: every kind of fault is planted and has to be named.

usage: pictures_test.py PICTURES FOLDER
"""
import pathlib
import shutil
import subprocess
import sys

script, root = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2])
shutil.rmtree(root, ignore_errors=True)
(root / "docs/pictures").mkdir(parents=True)
(root / "scripts").mkdir()
shutil.copy(script, root / "scripts/pictures")
shutil.copytree(script.parent / "pictures.d", root / "scripts/pictures.d")

LICENSE = "<!-- SPDX-FileCopyrightText: 2026 The Morula authors -->\n<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
SVG = '<svg xmlns="http://www.w3.org/2000/svg">\n' + LICENSE + "<title>t</title><style>@media(prefers-color-scheme:dark){{}}</style>{}</svg>\n"
WORDS = "A sphere around a limb"


def lay_out(files, rows, page):
    for old in (root / "docs/pictures").iterdir():
        old.unlink()
    for name, text in files.items():
        (root / "docs/pictures" / name).write_text(text)
    (root / "docs/pictures/pictures.tsv").write_text("".join("\t".join(row) + "\n" for row in rows))
    (root / "docs/tree.md").write_text(page)


def expect(code, *words):
    done = subprocess.run([sys.executable, root / "scripts/pictures", "--check"], capture_output=True, text=True)
    for word in words:
        if word not in done.stdout:
            sys.exit(f"not said: {word}\n{done.stdout}{done.stderr}")
    if done.returncode != code:
        sys.exit(f"exit code {done.returncode} instead of {code}\n{done.stdout}{done.stderr}")


row, shown = ("one.svg", WORDS, "tree.md"), f"![{WORDS}](pictures/one.svg)\n"
lay_out({"one.svg": SVG.format("")}, [row], shown)
expect(0, "1 pictures, 0 faults")
lay_out({}, [], "")
expect(1, "nothing to check")
for content, words in ((SVG.format("x" * 150_000), "150000 at most"), (SVG.format("<g>"), "is no XML"), (SVG.format("").replace("<title>t</title>", ""), "has no <title>"),
                       (SVG.format("").replace("scheme:dark", "scheme:light"), "does not follow prefers-color-scheme"),
                       (SVG.format("").replace(LICENSE, ""), "does not carry the two SPDX lines")):
    lay_out({"one.svg": content}, [row], shown)
    expect(1, f"docs/pictures/one.svg: {words}" if "at most" not in words else words, "1 pictures, 1 faults")
lay_out({"one.svg": SVG.format(""), "two.svg": SVG.format("")}, [row], shown)
expect(1, "docs/pictures/two.svg: has no row")
lay_out({}, [row], shown)
expect(1, "pictures.tsv: one.svg is not there")
lay_out({"one.svg": SVG.format("")}, [("one.svg", "limb", "tree.md")], "![limb](pictures/one.svg)\n")
expect(1, "one.svg has no alternative text")
for page in ("", "![Something else](pictures/one.svg)\n"):
    lay_out({"one.svg": SVG.format("")}, [row], page)
    expect(1, "tree.md does not show one.svg with the alternative text of its row")
print("every planted fault was named")
