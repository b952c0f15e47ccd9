#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""morula.hpp includes every public header, except the tools of our programs.
usage: umbrella_test.py path/to/include"""
import pathlib
import re
import sys

include = pathlib.Path(sys.argv[1])
tools = {"geometry/reproducible.hpp"}
found, waiting = set(), ["morula.hpp"]
while waiting:
    header = waiting.pop()
    if header in found or not (include / "morula" / header).is_file():
        continue
    found.add(header)
    waiting += re.findall(r"#include <morula/([\w/.]+)>", (include / "morula" / header).read_text())
every = {path.relative_to(include / "morula").as_posix() for path in include.rglob("*.hpp")}
missing = sorted(header for header in every - found - tools)
stale = sorted(tools - every)
if missing or stale or len(found) < 50:
    sys.exit(f"morula.hpp does not include {missing}; not there: {stale}; it includes {len(found)}")
