#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Lays out the pages of the site: README, the pages of docs and those beside README in one folder, with their links.

A link to another page leads to that page, one to a public header and a name of C++ such as `Body::update` to the
reference, one to another source to a copy of that source. A link to nothing is an error, and so is a name that a class
of ours does not have.
usage: stage.py FOLDER
"""
import pathlib
import posixpath
import re
import shutil
import sys
import textwrap

import command_reference
import cpp_reference
import python_reference

ROOT = pathlib.Path(__file__).resolve().parents[2]
LANGUAGES = {".cpp": "cpp", ".hpp": "cpp", ".py": "python", ".cmake": "cmake", ".txt": "cmake", ".bib": "bibtex"}


def main():
    folder = pathlib.Path(sys.argv[1])
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "pictures").mkdir(parents=True)
    for picture in (ROOT / "docs/pictures").iterdir():
        shutil.copy(picture, folder / "pictures")
    for extra in ("mark.svg", "file_worker.js", "site.css"):
        shutil.copy(ROOT / "docs/site" / extra, folder / "pictures")

    (folder / "pictures/report").mkdir()
    for picture in (ROOT / "research/report/figures").glob("*.svg"):
        shutil.copy(picture, folder / "pictures/report")

    pages = {p.relative_to(ROOT).as_posix(): p.name for p in sorted([*ROOT.glob("docs/**/*.md"), *ROOT.glob("extras/*/docs/*.md"),
                                                                     *ROOT.glob("research/report/*.md")])}
    if len(set(pages.values())) < len(pages):
        sys.exit("site: two pages have one name; all pages of the site lie in one folder")
    pages |= {p.name: p.name.lower() for p in sorted(ROOT.glob("*.md"))}
    sources, faults = {}, []

    def place(source, link):
        """Where a link of a page leads on the site."""
        path, _, anchor = link.partition("#")
        if not path or re.match(r"[a-z]+:", link):
            return link
        target = posixpath.normpath(posixpath.join(posixpath.dirname(source), path))
        if target in pages:
            return pages[target] + (f"#{anchor}" if anchor else "")
        if target.startswith("research/report/figures/"):
            return target.replace("research/report/figures/", "pictures/report/")
        if target.startswith("docs/pictures/"):
            return target.removeprefix("docs/")
        if header := reference.targets.get(target.rpartition("include/morula/")[2] if "include/morula/" in target else ""):
            return header
        if not (ROOT / target).is_file():
            faults.append(f"{source}: a link to {link}")
            return link
        return sources.setdefault(target, "source/" + target.replace("/", "_").replace(".", "_") + ".md")

    titles = {name: (ROOT / source).read_text().partition("# ")[2].partition("\n")[0] for source, name in pages.items()}
    titles["readme.md"] = "README"

    def rewritten(source, text, link):
        """A link, whose text is the title of its page where it was the name of a file."""
        target = place(source, link)
        name = target.partition("#")[0]
        if name in titles and re.fullmatch(r"([\w/.]+/)?\w+\.md", text):
            text = titles[name]
        return f"[{text}]({target})"

    reference = cpp_reference.Reference(ROOT, {source: f"[{titles[name]}]({name})" for source, name in pages.items()})

    def referred(source, code):
        """A name of C++ as a link to the reference; in other links it stays as it is."""
        name = reference.target(code[1]) if code[1] else ""
        if name is None and source != "CHANGELOG.md":
            faults.append(f"{source}: {code[1]} is not in the reference of C++")
        return f"[{code[0]}]({name})" if name else code[0]

    def tabs(block):
        """Blocks of code with a name each in bold, as tabs of the site."""
        text = re.sub(r"(?m)^<!--.*-->\n", "", block[1])
        parts = re.split(r"(?m)^\*\*(.+?)\*\*$\n", text)[1:]
        return "\n".join(f'=== "{name}"\n' + textwrap.indent(code.rstrip("\n"), "    ") + "\n" for name, code in zip(parts[::2], parts[1::2]))

    for source, name in pages.items():
        # What a fence encloses is code: every second piece.
        pieces = re.split(r"(?m)(^```.*?^```$)", (ROOT / source).read_text(), flags=re.S)
        for i in range(0, len(pieces), 2):
            pieces[i] = re.sub(r"\[([^][]*)\]\(([^()\s]+)\)", lambda m: rewritten(source, m[1], m[2]), pieces[i])
            pieces[i] = re.sub(r"\[[^][]*\]\([^()\s]+\)|`((?:\w+::)+\w+)[^`]*`", lambda m: referred(source, m), pieces[i])
        (folder / name).write_text(re.sub(r"(?ms)^<!-- tabs -->\n(.*?)^<!-- end tabs -->$", tabs, "".join(pieces)))

    (folder / "source").mkdir()
    for target, name in sources.items():
        language = LANGUAGES.get(pathlib.Path(target).suffix, "text")
        text = (ROOT / target).read_text()
        (folder / name).write_text(f"# {target}\n\n````{language}\n{text}````\n")

    stub = ROOT / "build/release/python/morula/_morula/__init__.pyi"
    (folder / "command_reference.md").write_text(command_reference.reference(ROOT / "build/release/bin/morula"))
    (folder / "python_reference.md").write_text(python_reference.reference(ROOT, stub))

    for name, text in reference.texts.items():
        (folder / name).write_text(text)

    if faults:
        sys.exit("\n".join(faults))
    print(f"site: {len(pages)} pages, {len(sources)} sources")


main()
