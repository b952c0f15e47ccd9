# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""docs/pictures/pictures.tsv, the one place of alternative texts, and what is checked of every picture."""
from __future__ import annotations

import pathlib
import re
import xml.etree.ElementTree as xml
from typing import NamedTuple

MOST_BYTES = 150_000
LICENSE = "<!-- SPDX-FileCopyrightText: 2026 The Morula authors -->\n<!-- SPDX-License-Identifier: Apache-2.0 -->\n"


class Row(NamedTuple):
    file: str
    words: str
    page: str


def read(root: pathlib.Path) -> dict[str, Row]:
    lines = (root / "docs/pictures/pictures.tsv").read_text().splitlines()
    rows = [Row(*line.split("\t")) for line in lines if line and not line.startswith("#")]
    return {row.file: row for row in rows}


def faults_of_file(path: pathlib.Path):
    size = path.stat().st_size
    if size > MOST_BYTES:
        yield f"{size} bytes, {MOST_BYTES} at most"
    if path.suffix == ".svg":
        text = path.read_text()
        try:
            title = xml.fromstring(text).find("{http://www.w3.org/2000/svg}title")
        except xml.ParseError as error:
            yield f"is no XML: {error}"
            return
        if title is None or not (title.text or "").strip():
            yield "has no <title>"
        if not re.search(r"@media ?\(prefers-color-scheme: ?dark\)", text):
            yield "does not follow prefers-color-scheme"
        if LICENSE not in text:
            yield "does not carry the two SPDX lines"


def pages_with(root: pathlib.Path) -> dict[str, list[tuple[str, str]]]:
    """Picture -> pages that show it, each by its name, with the alternative text there."""
    shown: dict[str, list[tuple[str, str]]] = {}
    for page in [*root.glob("*.md"), *root.glob("docs/**/*.md"), *root.glob("extras/*/docs/**/*.md")]:
        for words, file in re.findall(r"!\[([^\]]*)\]\((?:[\w./]*/)?pictures/([\w.-]+)\)", page.read_text()):
            shown.setdefault(file, []).append((page.name, words))
    return shown


def check(root: pathlib.Path) -> int:
    rows, shown, faults = read(root), pages_with(root), []
    files = {p.name: p for p in sorted((root / "docs/pictures").iterdir()) if p.suffix in (".svg", ".png")}
    for name, path in files.items():
        faults += [f"docs/pictures/{name}: {fault}" for fault in faults_of_file(path)]
        if name not in rows:
            faults.append(f"docs/pictures/{name}: has no row in pictures.tsv: file, alternative text, page")
    for name, row in rows.items():
        if name not in files:
            faults.append(f"pictures.tsv: {name} is not there")
        if len(row.words.split()) < 4:
            faults.append(f"pictures.tsv: {name} has no alternative text that says what it shows")
        if (row.page, row.words) not in shown.get(name, []):
            faults.append(f"pictures.tsv: {row.page} does not show {name} with the alternative text of its row")
    for fault in faults:
        print(fault)
    if not files:
        print("nothing to check in docs/pictures")
    print(f"{len(files)} pictures, {len(faults)} faults")
    return 1 if faults or not files else 0
