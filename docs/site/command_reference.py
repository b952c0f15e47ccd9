# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A page with every subcommand and option of the command, as `--help` prints them."""

import pathlib
import re
import subprocess


def help_of(command: pathlib.Path, *words: str) -> str:
    return subprocess.run([command, *words, "--help"], capture_output=True, text=True, check=True).stdout.rstrip()


def reference(command: pathlib.Path) -> str:
    """The page; without the command it says how it is built."""
    head = "# Reference of the command\n\nThis page has what `morula --help` and the help of every subcommand print. [The command line](cli.md) explains inputs, outputs and exit codes.\n\n"
    if not command.exists():
        return head + "This site was made without the command: `cmake --build --preset release` builds it.\n"
    general = help_of(command)
    names = re.findall(r"(?m)^  (\w+) ", general.partition("Subcommands:\n")[2].partition("\n\n")[0])
    if not names:
        raise SystemExit("site: the help of the command lists no subcommand")
    blocks = [("morula", general)] + [(f"morula {name}", help_of(command, name)) for name in names]
    return head + "\n".join(f"## {name}\n\n````text\n{text}\n````\n" for name, text in blocks)
