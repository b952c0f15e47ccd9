# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Types of arguments with a few possible names, for type checkers, from the tables of the extension.

usage: choices.py FOLDER_OF_THE_PACKAGE OUTPUT
"""

import pathlib
import sys


def main() -> None:
    sys.path.insert(0, sys.argv[1])
    from morula import _morula

    lines = ["from typing import Literal", ""]
    for name, words in sorted(_morula._choices.items()):
        lines.append(f"{name} = Literal[{', '.join(map(repr, words))}]")
    pathlib.Path(sys.argv[2]).write_text("\n".join(lines) + "\n", encoding="utf-8")


main()
