# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""python -m morula: the command."""

import sys

from . import _morula


def main() -> int:
    if not hasattr(_morula, "command_line"):
        print("morula: this package was built without the command: it needs CLI11 and fmt (docs/reference/python.md)", file=sys.stderr)
        return 2
    sys.stdout.flush()
    code: int = _morula.command_line(["morula", *sys.argv[1:]], [sys.executable, "-m", "morula"])
    return code


if __name__ == "__main__":
    sys.exit(main())
