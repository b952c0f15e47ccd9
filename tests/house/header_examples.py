#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The examples at the top of the main headers compile, with one include of the library.
Usage: header_examples.py COMPILER INCLUDE... FILE: writes FILE and compiles it."""
import pathlib
import re
import subprocess
import sys

compiler, *includes, output = sys.argv[1:]
root = pathlib.Path(includes[0]) / "morula"
shown = ["generators/build", "update/body", "collide/collider", "collide/contacts", "collide/distance", "scene/scene",
         "surface/surface_crossings", "surface/proximity", "surface/obstacles", "io/mesh_file", "io/spheres_file",
         "accuracy/looseness"]

source = ["#include <cstdio>", "#include <morula/morula.hpp>"]
for name in shown:
    head = (root / f"{name}.hpp").read_text().partition("#pragma once")[0]
    example = re.findall(r"(?m)^//   (.*)$", head)
    if not 3 <= len(example) <= 9:
        sys.exit(f"{name}.hpp: its example has {len(example)} lines")
    # The parameters are what the examples speak of.
    source += [f"namespace example_of_{name.replace('/', '_')} {{",
               "[[maybe_unused]] void run([[maybe_unused]] const morula::Mesh& mesh,",
               "    [[maybe_unused]] const std::vector<morula::Vec3>& positions, [[maybe_unused]] morula::Collider& a,",
               "    [[maybe_unused]] morula::Collider& b) {", f'#line 1 "{name}.hpp, example"', *example, "}", "}"]
pathlib.Path(output).write_text("\n".join(source) + "\n")
result = subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Werror", "-Wno-unused-variable",
                         "-Wno-unused-but-set-variable", *(f"-I{folder}" for folder in includes), output])
sys.exit(result.returncode)
