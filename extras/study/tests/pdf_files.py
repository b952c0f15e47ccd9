#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The PDF files of a study hold the texts of its SVG files, by an independent reader: pypdf, pdfminer or pdftotext.
usage: pdf_files.py path/to/morula FOLDER

Skipped, exit code 77, where there is none of them.
"""
import html
import pathlib
import re
import shutil
import subprocess
import sys


def find_reader():
    """A function from a file to the text in it, or None."""
    try:
        import pypdf

        return lambda path: pypdf.PdfReader(path, strict=True).pages[0].extract_text()
    except ImportError:
        pass
    try:
        from pdfminer.high_level import extract_text

        return extract_text
    except ImportError:
        pass
    if shutil.which("pdftotext"):
        return lambda path: subprocess.run(["pdftotext", path, "-"], check=True, capture_output=True, text=True).stdout
    return None


def main():
    command, folder = str(pathlib.Path(sys.argv[1]).resolve()), pathlib.Path(sys.argv[2])
    read = find_reader()
    if read is None:
        print("skipped: neither pypdf nor pdfminer nor pdftotext is installed")
        return 77
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    for line in ("sample limb -o body.obj --resolution 8",
                 "study --quick --mesh body.obj --frames 4 --resolution 32 --branching 4 --methods medial -o study --formats svg,pdf"):
        subprocess.run([command, *line.split()], cwd=folder, check=True, stdout=subprocess.DEVNULL)
    count = 0
    for path in sorted((folder / "study").glob("*.pdf")):
        texts = re.findall(r"<text [^>]*>([^<]*)</text>", path.with_suffix(".svg").read_text(encoding="utf-8"))
        found = " ".join(read(path).split())
        missing = [text for text in texts if " ".join(html.unescape(text).split()) not in found]
        if not texts or missing:
            print(f"{path.name}: {missing or 'no texts'} not in {found!r}")
            return 1
        count += 1
    print(f"{count} files")
    return 0 if count > 5 else 1


if __name__ == "__main__":
    sys.exit(main())
