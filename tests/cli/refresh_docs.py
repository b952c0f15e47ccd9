#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Writes what the commands print today into a page of docs: every line "$ ..." of a console block is run, in order, in
one folder, blocks marked `sh` between them, and what follows it is replaced.
Usage: refresh_docs.py path/to/morula docs/reference/cli.md"""
import os
import pathlib
import subprocess
import sys
import tempfile

command = pathlib.Path(sys.argv[1]).resolve()
page = pathlib.Path(sys.argv[2])
environment = dict(os.environ, PATH=f"{command.parent}{os.pathsep}{os.environ['PATH']}")

lines = []
with tempfile.TemporaryDirectory() as folder:
    in_console, script = False, None
    for line in page.read_text().splitlines():
        if line.startswith("```"):
            if script is not None:
                subprocess.run("\n".join(script), shell=True, cwd=folder, env=environment, stdout=subprocess.DEVNULL, check=True)
            in_console, script = line == "```console", [] if line == "```sh" else None
            lines.append(line)
        elif script is not None:
            script.append(line)
            lines.append(line)
        elif in_console and line.startswith("$ "):
            run = subprocess.run(line[2:], shell=True, cwd=folder, env=environment, text=True,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            if lines[-1] != "```console":
                lines.append("")
            lines += [line, *run.stdout.rstrip("\n").splitlines()]
        elif not in_console:
            lines.append(line)
page.write_text("\n".join(lines) + "\n")
