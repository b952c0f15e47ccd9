# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""What wheels are made of: options, pinned archives, and the checks of scripts/wheels. No wheel is built here."""

import hashlib
import importlib.machinery
import importlib.util
import pathlib
import re
import shutil
import subprocess
import tarfile

import pytest

sources = pathlib.Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def wheels():
    loader = importlib.machinery.SourceFileLoader("wheels", str(sources / "scripts/wheels"))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader("wheels", loader))
    loader.exec_module(module)
    return module


def test_a_wheel_leaves_no_part_out_silently():
    settings = (sources / "pyproject.toml").read_text(encoding="utf-8")
    given = dict(re.findall(r'^(MORULA_\w+) = "(\w+)"$', settings, re.MULTILINE))
    declared = (sources / "CMakeLists.txt").read_text(encoding="utf-8")
    assert [name for name in given if not re.search(rf"(?:option|set)\({name} ", declared)] == []
    assert {name: given[name] for name in ("MORULA_ROBOT", "MORULA_GLTF", "MORULA_VIEWER", "MORULA_PYTHON")} == dict.fromkeys(
        ("MORULA_ROBOT", "MORULA_GLTF", "MORULA_VIEWER", "MORULA_PYTHON"), "ON"
    )


def fetch(folder, *lines):
    """Runs functions of cmake/MorulaThirdParty.cmake with an address and a hash of the test's own."""
    script = folder / "fetch.cmake"
    head = [
        "cmake_minimum_required(VERSION 3.24)",
        f"set(PROJECT_SOURCE_DIR {folder})",
        f"set(PROJECT_BINARY_DIR {folder}/build)",
        f"include({sources}/cmake/MorulaThirdParty.cmake)",
    ]
    script.write_text("\n".join([*head, *lines]) + "\n")
    return subprocess.run(["cmake", "-P", script], capture_output=True, text=True)


@pytest.fixture
def archive(tmp_path):
    (tmp_path / "fmt-9.1.0/include/fmt").mkdir(parents=True)
    (tmp_path / "fmt-9.1.0/include/fmt/format.h").write_text("// a header\n")
    path = tmp_path / "9.1.0.tar.gz"
    with tarfile.open(path, "w:gz") as file:
        file.add(tmp_path / "fmt-9.1.0", "fmt-9.1.0")
    shutil.rmtree(tmp_path / "fmt-9.1.0")
    return path


def test_an_archive_with_the_pinned_hash_is_used(tmp_path, archive):
    pin = hashlib.sha256(archive.read_bytes()).hexdigest()
    ran = fetch(tmp_path, f"set(MORULA_fmt_URL file://{archive})", f"set(MORULA_fmt_SHA256 {pin})", "morula_fetch(fmt)",
                "message(STATUS ${folder})")
    assert ran.returncode == 0, ran.stderr
    assert (tmp_path / "build/third_party/fmt/include/fmt/format.h").read_text() == "// a header\n"


def test_an_archive_with_another_hash_is_not_used(tmp_path, archive):
    ran = fetch(tmp_path, f"set(MORULA_fmt_URL file://{archive})", "morula_fetch(fmt)")
    assert ran.returncode != 0 and "not used" in " ".join(ran.stderr.split())
    assert not (tmp_path / "build/third_party/fmt").exists()


def test_a_single_header_is_fetched_as_an_archive_is(tmp_path):
    header = tmp_path / "tiny_gltf.h"
    header.write_text("// another\n")
    pin = hashlib.sha256(header.read_bytes()).hexdigest()
    ran = fetch(tmp_path, f"set(MORULA_tinygltf_URL file://{header})", f"set(MORULA_tinygltf_SHA256 {pin})", "morula_fetch(tinygltf)")
    assert ran.returncode == 0, ran.stderr
    assert (tmp_path / "build/third_party/tinygltf/tiny_gltf.h").read_text() == "// another\n"


def test_the_message_names_packages_and_addresses(tmp_path):
    ran = fetch(tmp_path, f"set(MORULA_fmt_URL file://{tmp_path}/nowhere.tar.gz)", "morula_fetch(fmt)",
                "set(MORULA_MISSING fmt tinyxml2)", "morula_check_provided()")
    text = " ".join(ran.stderr.split())
    assert ran.returncode != 0
    assert "not found: fmt, tinyxml2" in text and "apt-get install libfmt-dev libtinyxml2-dev" in text and "nowhere.tar.gz" in text


def test_a_tag_promises_no_older_system_than_auditwheel_finds(wheels):
    shown = 'x.whl is consistent with the following platform tag: "manylinux_2_{}_x86_64". The wheel'
    assert wheels.consistent(shown.format(17), "manylinux_2_28_x86_64")
    assert wheels.consistent(shown.format(28), "manylinux_2_28_x86_64")
    assert not wheels.consistent(shown.format(35), "manylinux_2_28_x86_64")
    assert not wheels.consistent(shown.format(28), "manylinux_2_28_aarch64")
    assert not wheels.consistent(shown.replace("manylinux_2_{}", "linux"), "manylinux_2_28_x86_64")


def test_a_wheel_for_windows_loads_what_every_windows_and_every_python_has(wheels):
    shown = "\n".join(f"\tDLL Name: {name}" for name in ("python3.dll", "KERNEL32.dll", "api-ms-win-crt-math-l1-1-0.dll", "ntdll.dll"))
    assert wheels.foreign_libraries(shown) == []
    assert wheels.foreign_libraries(shown + "\n\tDLL Name: python312.dll\n\tDLL Name: libc++.dll\n") == ["python312.dll", "libc++.dll"]


def test_every_pinned_package_has_its_license(wheels):
    for name, (_, _, licence) in wheels.THIRD_PARTY.items():
        assert (sources / f"licenses/{licence}.txt").is_file()
        version, address, pin = wheels.pinned(name)
        assert version in address and re.fullmatch("[0-9a-f]{64}", pin)


@pytest.mark.parametrize(("packaged", "source", "expected"), [(True, True, "compiled"), (True, False, "headers"), (False, True, "headers")])
def test_a_package_compiles_the_functions_of_fmt_once(tmp_path, packaged, source, expected):
    """As headers they are compiled with every batch. Where their source is not at hand, and in an installed library, they are headers."""
    for name in ("fmt/include/fmt/format.h", *["fmt/src/format.cc"] * source):
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text("")
    lines = [
        "cmake_minimum_required(VERSION 3.24)",
        "project(p LANGUAGES CXX)",
        *["set(SKBUILD 2)"] * packaged,
        f"include({sources}/cmake/MorulaTargets.cmake)",
        f"include({sources}/cmake/MorulaThirdParty.cmake)",
        f"morula_target_of_fmt({tmp_path}/fmt)",
        "get_target_property(as_headers fmt::fmt-header-only INTERFACE_COMPILE_DEFINITIONS)",
        'if(as_headers MATCHES "FMT_HEADER_ONLY" AND NOT TARGET morula_fmt)',
        '  message(STATUS "fmt: headers")',
        "elseif(NOT as_headers AND TARGET morula_fmt)",
        '  message(STATUS "fmt: compiled")',
        "endif()",
    ]
    (tmp_path / "CMakeLists.txt").write_text("\n".join(lines) + "\n")
    made = subprocess.run(["cmake", "-S", tmp_path, "-B", tmp_path / "build"], capture_output=True, text=True)
    assert made.returncode == 0, made.stderr
    assert f"-- fmt: {expected}\n" in made.stdout


def published(version):
    systems = ("manylinux_2_27_x86_64.manylinux_2_28_x86_64", "manylinux_2_28_aarch64", "musllinux_1_2_x86_64", "musllinux_1_2_aarch64",
               "macosx_13_3_arm64", "macosx_13_3_x86_64", "win_amd64")
    wheels = [f"morula-{version}-{python}-{system}.whl" for python in ("cp310-cp310", "cp311-cp311", "cp312-abi3") for system in systems]
    return [f"morula-{version}.tar.gz", *wheels]


def test_all_wheels_are_published_or_none(wheels, tmp_path):
    version = re.search(r"project\(morula VERSION ([0-9.]+)", (sources / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    names = published(version)
    for name in names:
        (tmp_path / name).touch()
    assert wheels.incomplete(tmp_path) == []
    for name in names:
        (tmp_path / name).unlink()
        assert len(wheels.incomplete(tmp_path)) == 1, name
        (tmp_path / name).touch()
    (tmp_path / f"morula-{version}-cp312-abi3-linux_x86_64.whl").touch()
    assert len(wheels.incomplete(tmp_path)) == 1


def test_the_workflow_names_the_systems_that_are_published(wheels):
    """pyproject.toml and the workflow list what the check before publication expects."""
    settings = (sources / "pyproject.toml").read_text(encoding="utf-8").partition("[tool.cibuildwheel]")[2]
    pythons = re.findall(r'"(cp\d+)-\*"', settings)
    assert pythons == [tag.split("-")[0] for tag in wheels.PUBLISHED_PYTHONS]
    archs = {arch.lower() for listed in re.findall(r"archs = \[(.*)\]", settings) for arch in re.findall(r'"(\w+)"', listed)}
    assert archs == {re.search("x86_64|aarch64|arm64|amd64", system)[0] for system in wheels.PUBLISHED_SYSTEMS}
    jobs = (sources / ".github/workflows/wheels.yml").read_text(encoding="utf-8")
    systems = re.search(r"system: \[(.*)\]", jobs)[1].split(", ")
    assert [name.partition("-")[0] for name in systems] == ["ubuntu", "ubuntu", "macos", "macos", "windows"]
    assert "scripts/wheels --complete dist" in jobs.partition("publish:")[2].partition("gh-action-pypi-publish")[0]


def private_names(source):
    """What a source defines in namespaces without a name: names of types and constants; functions with their parameters' types."""
    found, depth = [], 0
    for line in source.read_text(encoding="utf-8").splitlines():
        if line.startswith("namespace {"):
            depth += 1
        elif line.startswith("}  // namespace") and depth:
            depth -= line.rstrip() == "}  // namespace"
        elif depth and (kind := re.match(r"(?:struct|class|enum class|enum|using) (\w+)[ {]", line)):
            found.append(kind[1])
        elif depth and re.match(r"(?:static |inline )*const(?:expr)? [^()]*[={;]", line):
            declared = re.sub(r"=[^,;]*(?=[,;])", "=", line.partition('"')[0] + " ")  # without values
            found += re.findall(r"\b([A-Za-z_]\w*)(?:\[[^]]*\])? ?[={;](?!=)", declared)
        elif depth and (function := re.match(r"[A-Za-z](?:[\w:<>,&* ]*[ &*])?(\w+)\((.*)\)(?: const| noexcept)* \{$", line)):
            types = [re.sub(r"\b\w+$", "", part.partition("=")[0].strip()).strip() for part in function[2].split(",")]
            found.append(f"{function[1]}({', '.join(types)})")
    return found


def batches():
    """Sources that a package compiles in one go, by target; those that stand alone are left out."""
    def below(*patterns):
        return [path for pattern in patterns for path in sorted(sources.glob(pattern))]

    yield "morula_io", [path for path in below("src/io/**/*.cpp") if path != sources / "src/io/gltf/model.cpp"]
    yield "morula_commands", below("apps/morula/*/**/*.cpp", "extras/*/command/**/*.cpp")
    yield "morula_python", below("python/src/**/*.cpp", "extras/*/python/**/*.cpp")
    yield "morula_toolbox", below("toolbox/*.cpp")
    for extra in ("grains", "page", "robot", "study"):
        yield f"morula_{extra}", below(f"extras/{extra}/src/**/*.cpp")
    core = re.findall(r"foreach\(folder (.*)\)", (sources / "src/CMakeLists.txt").read_text(encoding="utf-8"))
    for folder in " ".join(core).split():
        yield f"src/{folder}", [path for path in below(f"src/{folder}/**/*.cpp")
                                if "every_processor.inl" not in path.read_text(encoding="utf-8")]


def test_names_are_private_to_a_source_that_is_compiled_with_others():
    """Two sources of a batch share their namespaces without a name: a package would not compile. scripts/test does not build one."""
    clashes, count = [], 0
    for target, files in batches():
        owners = {}
        for path in files:
            for name in set(private_names(path)):
                count += 1
                owners.setdefault(name, []).append(path.name)
        # A function and a constant of one name, too.
        plain = {name for name in owners if "(" not in name}
        clashes += [f"{target}: {name} in {', '.join(paths)}" for name, paths in owners.items() if len(paths) > 1]
        clashes += [f"{target}: {name} is a function, too" for name in {name.partition("(")[0] for name in owners if "(" in name} & plain]
    assert count > 1000
    assert clashes == []
