#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/packaging accepts a copy of the recipes and names every kind of fault that is planted.
usage: packaging_test.py ROOT FOLDER"""
import pathlib
import shutil
import subprocess
import sys

root, folder = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
shutil.rmtree(folder, ignore_errors=True)
# What the script reads.
needed = ["CMakeLists.txt", "LICENSE", "pyproject.toml", "package.xml", "colcon.pkg", "Dockerfile", "scripts/packaging",
          "docs/contributing/packaging.md"]
needed += [str(path.relative_to(root)) for pattern in ("src/CMakeLists.txt", "toolbox/CMakeLists.txt", "apps/*/CMakeLists.txt",
                                                       "extras/*/CMakeLists.txt", "licenses/*.txt", "packaging/**/*")
           for path in root.glob(pattern) if path.is_file()]
for name in needed:
    (folder / name).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(root / name, folder / name)


def run():
    done = subprocess.run([sys.executable, folder / "scripts/packaging"], capture_output=True, text=True)
    return done.returncode, done.stdout + done.stderr


code, said = run()
if code != 0 or "8 recipes, 0 faults" not in said:
    sys.exit(f"the recipes are not sound:\n{said}")

spack = "packaging/spack/spack_repo/morula/packages/morula/package.py"
port = "packaging/vcpkg/morula/portfile.cmake"
manifest = "packaging/vcpkg/morula/vcpkg.json"
everywhere = ("vcpkg", "Conan", "conda", "Homebrew", "Spack", "Nix", "colcon", "Docker")
for name, old, new, faults in (
        ("CMakeLists.txt", "option(MORULA_BENCH ", "option(MORULA_BENCHMARKS ", [f"{r}: MORULA_BENCH is no option" for r in everywhere]),
        ("CMakeLists.txt", "option(MORULA_BITS ", "option(MORULA_TOYS \"\" ${PROJECT_IS_TOP_LEVEL})\noption(MORULA_BITS ",
         [f"{r}: does not turn MORULA_TOYS off" for r in everywhere]),
        ("CMakeLists.txt", "VERSION 0.", "VERSION 9.", [f"{r}: has version 0." for r in everywhere[:7] if r != "Conan"]),
        ("CMakeLists.txt", "DESCRIPTION \"C", "DESCRIPTION \"Un-c", ["colcon: is described as", "Spack: has another description"]),
        ("pyproject.toml", 'license = "Apache-2.0"', 'license = "MIT"', ["conda: has license Apache-2.0, the project MIT", "Nix: has another license"]),
        ("src/CMakeLists.txt", "nlohmann_json 3.10", "nlohmann_json 3.12",
         ["Conan: does not ask for \"nlohmann_json/[>=3.12", "vcpkg: does not ask for", "conda: does not ask for", "Spack: does not ask for"]),
        ("apps/morula/CMakeLists.txt", "find_package(fmt 9 REQUIRED)", "find_package(fmt 9 REQUIRED)\nfind_package(zlib REQUIRED)",
         [f"{r}: does not ask for" for r in everywhere[:7]]),
        (manifest, '"default-features"', "'default-features'", ["vcpkg: is not parsed: JSONDecodeError"]),
        (manifest, '"robot": {', '"robots": {', ["vcpkg: features of vcpkg.json and of portfile.cmake differ"]),
        (port, "vcpkg_cmake_install()", "vcpkg_cmake_install(", ["vcpkg: CMake Error"]),
        (port, "vcpkg_cmake_install()", "vcpkg_cmake_instal()", ["vcpkg: CMake Error"]),
        (port, "/LICENSE", "/LICENCE.txt", ["there is no"]),
        (port, "/usage", "/uses", ["vcpkg: "]),
        ("packaging/conan/conanfile.py", "    def layout(self):", "    def layout(self)", ["Conan: is not parsed: SyntaxError"]),
        ("packaging/conan/conanfile.py", "self.version = re.search(", "self.version = \"0.1.0\" or (", ["Conan: does not read the version"]),
        ("packaging/conan/test_package/conanfile.py", "class", "clas", ["Conan: is not parsed: SyntaxError"]),
        (spack, 'variant("grains"', 'variant("clumps"', ["Spack: variants"]),
        (spack, "cmake@3.24:", "cmake@3.20:", ["Spack: does not ask for CMake 3.24"]),
        ("packaging/conda/recipe.yaml", "MORULA_TESTS=OFF", "MORULA_TESTS=ON", ["conda: does not turn MORULA_TESTS off"]),
        ("packaging/homebrew/morula.rb", "-DMORULA_IO=ON", "-DMORULA_FILES=ON", ["Homebrew: MORULA_FILES is no option"]),
        ("package.xml", "</version>", "", ["colcon: is not parsed: ParseError"]),
        ("Dockerfile", "WORKDIR /src", "FOLDER /src", ["Docker: unknown instructions"]),
        ("docs/contributing/packaging.md", "| Nix |", "| Nyx |", ["docs/contributing/packaging.md: has no row for Nix"]),
):
    text = (folder / name).read_text()
    if old not in text:
        sys.exit(f"{name} has no {old!r} to plant a fault in")
    (folder / name).write_text(text.replace(old, new, 1))
    code, said = run()
    (folder / name).write_text(text)
    for fault in faults:
        if code != 1 or f"packaging: {fault}" not in said and (fault != "there is no" or fault not in said):
            sys.exit(f"{name} with {new!r}: exit code {code}, no {fault!r} in:\n{said}")
print("every planted fault is named")
