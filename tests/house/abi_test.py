#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/abi accepts a copy of the headers, names every kind of change that is planted, and lets a released version keep its
binary interface. usage: abi_test.py ROOT FOLDER        exit code 77 without abidiff and a C compiler"""
import pathlib
import shutil
import subprocess
import sys

root, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
needed = ["CMakeLists.txt", "CHANGELOG.md", "scripts/abi", "src/version.hpp.in", "docs/site/cpp_reference.py", "docs/site/headers.py"]
needed += [str(path.relative_to(root)) for pattern in ("include/**/*.h*", "extras/*/include/**/*.hpp", "tests/golden/*")
           for path in root.glob(pattern) if path.is_file()]
for name in needed:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(root / name, folder / name)
golden = {path: path.read_bytes() for path in (folder / "tests/golden").glob("*") if path.is_file()}


def run(*arguments):
    done = subprocess.run([sys.executable, folder / "scripts/abi", *arguments], capture_output=True, text=True)
    if done.returncode == 77:
        print(done.stderr)
        sys.exit(77)
    return done.returncode, done.stdout + done.stderr


def expect(result, code, *words):
    if result[0] != code or any(word not in result[1] for word in words):
        sys.exit(f"expected exit code {code} and {words}, not {result[0]}:\n{result[1][-3000:]}")


class Planted:
    """Text in place of another in a file, until the end of the block; the lists are restored, too."""

    def __init__(self, name, old, new):
        self.path, self.old, self.new = folder / name, old, new

    def __enter__(self):
        self.text = self.path.read_text()
        if self.old not in self.text:
            sys.exit(f"{self.path.name} has no {self.old!r} to plant a change in")
        self.path.write_text(self.text.replace(self.old, self.new, 1))

    def __exit__(self, *_):
        self.path.write_text(self.text)
        for path, text in golden.items():
            path.write_bytes(text)


c = "include/morula/morula.h"
box = "include/morula/geometry/box.hpp"
expect(run(), 0, "has the interface on record", "headers: ")

# Changes that break programs: (text, text in its place, what abidiff calls it).
breaking = [
    ("MORULA_API size_t morula_mesh_vertex_count(const morula_mesh* mesh);\n", "", "morula_mesh_vertex_count"),
    ("  double x, y, z, radius;\n", "  double x, y, z, radius, weight;\n", "type size changed from 256 to 320"),
    ("  double x, y, z, radius;\n", "  double radius, x, y, z;\n", "offset changed from"),
    ("MORULA_BAD_FILE = 2,", "MORULA_BAD_FILE = 7,", "morula_status::MORULA_BAD_FILE' from value '2' to '7'"),
    ("morula_mesh_sample(const char* name, int resolution,", "morula_mesh_sample(const char* name, long resolution,", "from 'int' to 'long int'"),
    # A field of options in what was padding.
    ("} morula_haptic_tool_options;", "  int added;\n} morula_haptic_tool_options;", "added"),
    ("  size_t size;               /*", "  int first; size_t size;    /*", "morula_build_options"),
]
additions = [
    ("MORULA_API size_t morula_mesh_vertex_count(", "MORULA_API int morula_mesh_kind(const morula_mesh* mesh);\nMORULA_API size_t morula_mesh_vertex_count(",
     "morula_mesh_kind"),
    ("} morula_build_options;", "  double added_at_the_end;\n} morula_build_options;", "added_at_the_end"),
]
released = "\n## 0.1.0 - 2026-01-31\n"
for old, new, words in breaking:
    with Planted(c, old, new):
        expect(run(), 1, words, "an incompatible change", "scripts/abi --refresh")
with Planted(c, *breaking[1][:2]):
    with Planted("CHANGELOG.md", "## Unreleased", "## Unreleased" + released):
        expect(run("--refresh"), 1, "is released, and programs that use it would break")
        if (folder / "tests/golden/libmorula.abi").read_bytes() != golden[folder / "tests/golden/libmorula.abi"]:
            sys.exit("a rejected change was written")
        with Planted("CMakeLists.txt", "project(morula VERSION 0.1.0", "project(morula VERSION 0.2.0"):
            expect(run("--refresh"), 0, "libmorula.abi is written")
    expect(run("--refresh"), 0, "libmorula.abi is written")
    expect(run(), 0, "has the interface on record")
for old, new, words in additions:
    with Planted(c, old, new), Planted("CHANGELOG.md", "## Unreleased", "## Unreleased" + released):
        expect(run(), 1, words, "additions, compared with")
        expect(run("--refresh"), 0, "libmorula.abi is written")
with Planted("CMakeLists.txt", "project(morula VERSION 0.1.0", "project(morula VERSION 0.2.0"):
    expect(run(), 1, "SONAME changed from 'libmorula.so.0.1' to 'libmorula.so.0.2'")

# Names of headers that are gone, new, or overloaded less often.
with Planted(box, "diagonal()", "length_of_diagonal()"):
    expect(run("--names"), 1, "- morula/geometry/box.hpp: morula::Box::diagonal", "+ morula/geometry/box.hpp: morula::Box::length_of_diagonal")
    expect(run("--names", "--refresh"), 0, "1 lines gone, 1 new")
    expect(run("--names"), 0)
with Planted(box, "/// ", "void added_here();\n/// "):
    expect(run("--names"), 1, "0 lines gone, 1 new", "added_here")
with Planted("tests/golden/public_names.txt", "morula::Box::add 2", "morula::Box::add 3"):
    expect(run("--names"), 1, "- morula/geometry/box.hpp: morula::Box::add 3")

# Options of a command and names of a package that are gone.
(folder / "morula").mkdir()
stub, command = folder / "morula/__init__.pyi", folder / "command"
stub.write_text("".join(f"class C{i}:\n    def run(self) -> int: ...\n    def _hidden(self) -> int: ...\n" for i in range(150)))
command.write_text("""#!/bin/sh
if [ $# = 1 ]; then printf 'Options:\\n  -h,--help  Help\\nSubcommands:\\n  one  1\\n  two  2\\n  three  3\\n  four  4\\n  five  5\\n\\n'
else for i in 1 2 3 4 5 6 7 8 9; do echo "  -$i,--first-$i,--second-$i X  Option"; done; fi
""")
command.chmod(0o755)
built = ("--names", "--command", command, "--python", folder / "morula")
expect(run(*built, "--refresh"), 0, "command_options.txt is written", "python_names.txt is written")
golden.update({path: path.read_bytes() for path in golden})
expect(run(*built), 0, "command: 143 lines, as on record", "Python: 301 lines, as on record")
with Planted("command", "--second-$i", ""):
    expect(run(*built), 1, "- morula one: --second-1", "command: 45 lines gone, 0 new", "Python: 301 lines, as on record")
with Planted("morula/__init__.pyi", "class C7:", "class D7:"):
    expect(run(*built), 1, "- __init__.pyi: C7.run", "+ __init__.pyi: D7", "Python: 2 lines gone, 2 new")
command.write_text("#!/bin/sh\necho no help\n")
expect(run("--names", "--command", command), 1, "lists no subcommands and options")

# A library that lacks a function, has one too many, or another soname.
functions = [line.split("(")[0].split()[-1].lstrip("*") for line in (folder / c).read_text().splitlines()
             if line.startswith("MORULA_API ") and "(" in line]
for source, soname, fault in (("", "libmorula.so.0.1", None),
                              ("int morula_extra(void) { return 0; }", "libmorula.so.0.1", "exports morula_extra, which"),
                              ("", "libmorula.so.7", "has the soname 'libmorula.so.7'"),
                              (None, "libmorula.so.0.1", f"does not export {functions[-1]}")):
    kept = functions if source is not None else functions[:-1]
    text = "".join(f"void {name}(void) {{}}\n" for name in kept) + (source or "")
    (folder / "built.c").write_text(text)
    subprocess.run(["cc", "-shared", "-fPIC", f"-Wl,-soname,{soname}", folder / "built.c", "-o", folder / "built.so"], check=True)
    expect(run("--library", folder / "built.so"), 1 if fault else 0, *([fault] if fault else ["functions of morula.h alone"]))
print("every planted change is named")
