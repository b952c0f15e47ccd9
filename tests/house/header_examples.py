#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The example at the top of each main header compiles: all in one source, each in a function of its own.

usage: header_examples.py COMPILER OUTPUT GENERATED INCLUDE...

Writes OUTPUT and checks it with COMPILER. GENERATED is the folder of headers that the build makes; every INCLUDE is a folder
of public headers. The examples are those of the table below whose first folder is in some INCLUDE. Errors name the header and
the line there.
"""
import pathlib
import re
import subprocess
import sys

# Headers of the library, without ending; extras below their own folder.
MAIN = ["accuracy/looseness", "collide/collider", "collide/contact_query", "collide/contacts", "collide/distance",
        "collide/primitives", "generators/build", "geometry/connectivity", "geometry/inspect", "io/mesh_file", "io/modal_file",
        "io/skin_file", "io/spheres_file", "robot/fit", "scene/scene", "study/plan", "study/run", "surface/haptic_probe", "surface/haptic_tool", "surface/obstacles", "surface/proximity",
        "surface/surface_crossings", "update/body", "update/modes",
        "update/skin_morphs"]
EXTRAS = {"robot", "study"}
LINES = range(3, 10)


def example_of(header: pathlib.Path) -> tuple[int, list[str]]:
    """The number of its first line, and its lines: the first block that is indented in the comment above #pragma once."""
    lines = header.read_text(encoding="utf-8").partition("#pragma once")[0].splitlines()
    example, first = [], 1
    for number, line in enumerate(lines, 1):
        code = re.match(r"//   (.*)", line)
        if code:
            first = first if example else number
            example.append(code.group(1))
        elif example:
            break
    return first, example


def main() -> int:
    compiler, output, generated, *includes = sys.argv[1:]
    source = ["#include <cstdio>", "#include <morula/morula.hpp>"]
    functions, faults, seen = [], [], set()
    for include in map(pathlib.Path, includes):
        for name in MAIN:
            header = include / "morula" / f"{name}.hpp"
            if not header.is_file():
                continue
            seen.add(name)
            first, example = example_of(header)
            if len(example) not in LINES:
                faults.append(f"{header}:{first}: the example has {len(example)} lines, not {LINES[0]} to {LINES[-1]}")
            if name.partition("/")[0] in EXTRAS:
                source.append(f"#include <morula/{name}.hpp>")
            # The parameters are the objects that examples use without making them.
            functions += [f"namespace example_of_{name.replace('/', '_')} {{",
                          "[[maybe_unused]] void run([[maybe_unused]] const morula::Mesh& mesh,",
                          "    [[maybe_unused]] const std::vector<morula::Vec3>& positions,",
                          "    [[maybe_unused]] morula::Collider& a, [[maybe_unused]] morula::Collider& b) {",
                          f'#line {first} "{header}"', *example, f'#line 1 "after the example of {name}.hpp"', "}", "}"]
    faults += [f"{name}.hpp: there is no such header" for name in MAIN
               if name not in seen and name.partition("/")[0] not in EXTRAS]
    if faults:
        print("\n".join(faults), file=sys.stderr)
        return 1
    pathlib.Path(output).write_text("\n".join(source + functions) + "\n", encoding="utf-8")
    return subprocess.run([compiler, "-std=c++20", "-fsyntax-only", "-Wall", "-Werror", "-Wno-unused-variable",
                           "-Wno-unused-but-set-variable", f"-I{generated}", *(f"-I{folder}" for folder in includes),
                           output]).returncode


sys.exit(main())
