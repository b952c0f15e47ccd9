#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/sbom lists what a build shows, and names code, libraries and packages that it does not know.
usage: sbom_test.py ROOT FOLDER"""
import json
import os
import pathlib
import shutil
import subprocess
import sys

root, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
shutil.rmtree(folder, ignore_errors=True)
project, build, system, programs = (folder / name for name in ("project", "build", "system", "programs"))


def write(path, text, mode=0o644):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(mode)


# A project with our licenses; headers of two components, one of which a released program loads; and a build's own records.
for path in [*root.glob("licenses/*.txt"), *root.glob("python/licenses/*.txt")]:
    (project / path.relative_to(root)).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(path, project / path.relative_to(root))
write(project / "CMakeLists.txt", 'project(morula VERSION 0.7.3 LANGUAGES CXX HOMEPAGE_URL "https://example.org/a/morula"\n  DESCRIPTION "Spheres")\n')
write(project / "src/a.cpp", "")
write(project / "viewer/src/main.js", "import * as THREE from 'three';\nimport { O } from 'three/examples/jsm/O.js';\nimport './own.js';\n")
write(project / "viewer/package-lock.json", json.dumps({"packages": {
    "node_modules/three": {"version": "0.5.1", "license": "MIT", "integrity": "sha512-" + "A" * 86 + "=="}}}))
json_header = '#define NLOHMANN_JSON_VERSION_MAJOR 3\n#define NLOHMANN_JSON_VERSION_MINOR 11\n#define NLOHMANN_JSON_VERSION_PATCH 9\n'
write(system / "nlohmann/json.hpp", json_header)
write(system / "fmt/core.h", "#define FMT_VERSION 90102\n")
write(system / "gtest/gtest.h", "")
write(build / "viewer/page.html", "")
write(build / "bin/morula", "")
deps = f"""src/CMakeFiles/morula_io.dir/a.cpp.o: #deps 3, deps mtime 1 (VALID)
    {project}/src/a.cpp
    {system}/nlohmann/json.hpp
    made/version.hpp

apps/morula/CMakeFiles/morula_app.dir/b.cpp.o: #deps 2, deps mtime 1 (VALID)
    {system}/fmt/core.h

tests/io/CMakeFiles/io_test.dir/c.cpp.o: #deps 1, deps mtime 1 (VALID)
    {system}/gtest/gtest.h
"""
write(build / "deps.txt", deps)
write(programs / "ninja", '#!/bin/sh\ncat "$2/deps.txt"\n', 0o755)
needed = " 0x1 (NEEDED) Shared library: [libfmt.so.9]\n 0x1 (NEEDED) Shared library: [libc.so.6]\n"
write(folder / "needed.txt", needed)
write(programs / "readelf", f'#!/bin/sh\ncat "{folder}/needed.txt"\n', 0o755)
write(programs / "dpkg-query", "#!/bin/sh\nexit 1\n", 0o755)


def run():
    done = subprocess.run([sys.executable, root / "scripts/sbom", build, "--root", project, "--created", "2026-01-31T12:00:00Z"],
                          env={**os.environ, "PATH": f"{programs}:{os.environ['PATH']}"}, capture_output=True, text=True)
    return done.returncode, done.stdout, done.stderr


code, text, said = run()
if code != 0 or text != run()[1]:
    sys.exit(f"the bill is not written, or differs between two runs:\n{said}")
bill = json.loads(text)
found = {package["name"]: (package["versionInfo"], package["licenseDeclared"]) for package in bill["packages"]}
expected = {"morula": ("0.7.3", "Apache-2.0"), "nlohmann-json": ("3.11.9", "MIT"), "fmt": ("9.1.2", "MIT"), "three": ("0.5.1", "MIT")}
if found != expected:
    sys.exit(f"the bill has {found}, not {expected}")
ids = {package["SPDXID"]: package["name"] for package in bill["packages"]} | {"SPDXRef-DOCUMENT": ""}
relations = {(ids[r["spdxElementId"]], r["relationshipType"], ids[r["relatedSpdxElement"]], r.get("comment", "")) for r in bill["relationships"]}
if len(ids) != 5 or not relations >= {("", "DESCRIBES", "morula", ""), ("morula", "CONTAINS", "nlohmann-json", "compiled into morula_io"),
                                      ("morula", "CONTAINS", "fmt", "compiled into morula_app"), ("morula", "DYNAMIC_LINK", "fmt", "loaded by morula")}:
    sys.exit(f"relations are missing: {relations}")
three = next(package for package in bill["packages"] if package["name"] == "three")
if three["checksums"] != [{"algorithm": "SHA512", "checksumValue": "0" * 128}] or "Copyright" not in three["copyrightText"]:
    sys.exit(f"three is described as {three}")

write(system / "other/other.h", "")
for path, old, new, fault in (
        (build / "deps.txt", "morula_io.dir/a.cpp.o: #deps 3, deps mtime 1 (VALID)\n", f"morula_io.dir/a.cpp.o: #deps 4, deps mtime 1 (VALID)\n    {system}/other/other.h\n",
         f"{system}/other/other.h was compiled into morula_io, but belongs to no component"),
        (build / "deps.txt", f"    {project}/src/a.cpp\n", f"    {project}/third_party/new/new.h\n", "third_party/new/new.h was compiled into morula_io, but"),
        (build / "deps.txt", deps, "", "ninja -t deps lists no headers"),
        (build / "deps.txt", "tests/io/CMakeFiles", "src/CMakeFiles", "gtest.h was compiled into io_test, but"),
        (folder / "needed.txt", "libfmt.so.9", "libother.so.1", "morula loads libother.so.1, which belongs to no component"),
        (project / "viewer/src/main.js", "'three'", "'other'", "the page imports other, which"),
        (project / "viewer/package-lock.json", "node_modules/three", "node_modules/drei", "the page imports three, which"),
        (project / "licenses/fmt.txt", "Permission is hereby granted", "No permission is granted", "licenses/fmt.txt does not have the words"),
        (system / "nlohmann/json.hpp", "VERSION_PATCH", "VERSION_PITCH", "nlohmann-json: its headers name no version")):
    before = path.read_text()
    if old not in before:
        sys.exit(f"{path} has no {old!r} to plant a fault in")
    path.write_text(before.replace(old, new, 1))
    code, text, said = run()
    path.write_text(before)
    if code != 1 or text or f"sbom: {fault}" not in said and fault not in said:
        sys.exit(f"exit code {code}, no {fault!r} in:\n{said}")
(project / "licenses/fmt.txt").rename(folder / "fmt.txt")
write(project / "licenses/other.txt", "other\n")
said = run()[2]
if "licenses/fmt.txt is missing" not in said or "licenses/other.txt is the license of no component" not in said:
    sys.exit(f"licenses that are missing or not used are not named:\n{said}")
print("the bill lists what the build shows, and every planted fault is named")
