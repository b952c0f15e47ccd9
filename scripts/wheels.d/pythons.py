# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pythons of other systems that run here, and scripts/wheel_test with them: 64-bit ARM under QEMU, musl, Windows under Wine.

Each is made once, below build/wheels; what it needs and this machine lacks is said instead of a result.
"""
import gzip
import json
import os
import re
import shutil
import subprocess
import zipfile

from steps import ROOT, WORK, apt, run

ARM_PACKAGES = """python3.13-minimal libpython3.13-minimal libpython3.13-stdlib libc6 libgcc-s1 libssl3t64 zlib1g libexpat1 libffi8
libbz2-1.0 liblzma5 libstdc++6 libzstd1""".split()
# CPython for Windows as files of a Go module, which the proxy of Go serves and `go mod download` verifies.
WINDOWS_MODULE = "github.com/kluctl/go-embed-python@v0.0.0-3.12.3-20240415-1"
# Later ones need zlib in Python, which musl's headers here do not have.
MUSL_NUMPY = "numpy==2.2.6"
# NumPy 2 calls functions of Microsoft's C library that Wine 8 lacks.
WINDOWS_NUMPY = "numpy==1.26.4"


def test(wheel, target, tools):
    """What scripts/wheel_test says with the target's Python, or why it was not run."""
    tests = {"manylinux-aarch64": test_arm, "musllinux-x86_64": test_musl, "windows-x86_64": test_windows}
    return tests[target](wheel, tools) if target in tests else "not run: no Python for it"


def lacking(*programs):
    missing = [name for name in programs if not shutil.which(name)]
    return f"not run: there is no {' and no '.join(missing)} (scripts/setup --platforms)" if missing else ""


def test_arm(wheel, tools):
    if reason := lacking("qemu-aarch64-static"):
        return reason
    folder = WORK / "arm64"
    root = folder / "root"
    if not (folder / "done").exists():
        env = apt(folder, "arm64", "deb", "trixie")
        run("apt-get", "download", *ARM_PACKAGES, log="arm64-download", cwd=folder, env=env)
        shutil.rmtree(root, ignore_errors=True)
        root.mkdir()
        (root / "lib").symlink_to("usr/lib")
        for package in sorted(folder.glob("*.deb")):
            run("dpkg-deb", "-x", package, root, log="arm64-unpack")
        install(tools, folder / "packages", "numpy", "3.13", "manylinux_2_28_aarch64", "manylinux_2_27_aarch64")
        (folder / "done").touch()
    install(tools, folder / "installed", wheel, "3.13", "manylinux_2_28_aarch64")
    run_test(folder, f'qemu-aarch64-static -L {root} {root}/usr/bin/python3.13', wheel)
    return "passed with Python 3.13 under QEMU"


def test_musl(wheel, tools):
    """Debian 13's source of Python, compiled for musl, and Debian 13's musl, whose loader knows the relocations in NumPy's libraries."""
    if reason := lacking("musl-gcc"):
        return reason
    folder = WORK / "musl"
    prefix = folder / "prefix"
    if not (folder / "done").exists():
        source = python_source()
        run("apt-get", "download", "musl", log="musl-download", cwd=folder, env=apt(folder, "amd64", "deb", "trixie"))
        run("dpkg-deb", "-x", next(folder.glob("musl_*.deb")), folder / "root", log="musl-unpack")
        compiler = folder / "musl-gcc"  # which names glibc's folder of libraries if it is asked
        program(compiler, 'case " $* " in *" --print-multiarch "*) exit 0 ;; esac\nexec musl-gcc "$@"')
        build = folder / "build"
        shutil.rmtree(build, ignore_errors=True)
        build.mkdir()
        run(source / "configure", f"CC={compiler}", "CXX=false", "CFLAGS=-O1 -g0", f"--prefix={prefix}", "--without-ensurepip",
            "--disable-test-modules", log="musl-configure", cwd=build, env={"PKG_CONFIG": "false"})
        run("make", f"-j{os.cpu_count()}", log="musl-make", cwd=build)
        run("make", "install", log="musl-install", cwd=build)
        shutil.rmtree(build)
        install(tools, folder / "packages", MUSL_NUMPY, "3.13", "musllinux_1_2_x86_64")
        (folder / "done").touch()
    install(tools, folder / "installed", wheel, "3.13", "musllinux_1_2_x86_64")
    run_test(folder, f"{folder}/root/usr/lib/x86_64-linux-musl/libc.so {prefix}/bin/python3.13", wheel)
    return "passed with Python 3.13 of musl"


def test_windows(wheel, tools):
    if reason := lacking("go"):
        return reason
    wine = shutil.which("wine64", path=os.environ["PATH"] + ":/usr/lib/wine")
    if not wine:
        return "not run: there is no Wine (scripts/setup --platforms)"
    folder = WORK / "windows"
    root = folder / "root"
    if not (folder / "done").exists():
        folder.mkdir(parents=True, exist_ok=True)
        module = json.loads(run("go", "mod", "download", "-json", WINDOWS_MODULE, log="windows-download", cwd=folder))
        shutil.rmtree(root, ignore_errors=True)
        inside = "/python/internal/data/windows-amd64/"
        with zipfile.ZipFile(module["Zip"]) as archive:
            for entry in archive.infolist():
                if inside not in entry.filename or entry.is_dir():
                    continue
                path, data = root / entry.filename.partition(inside)[2], archive.read(entry)
                path.parent.mkdir(parents=True, exist_ok=True)
                if path.suffix == ".gz":
                    path, data = path.with_suffix(""), gzip.decompress(data)
                path.write_bytes(data)
        install(tools, folder / "packages", WINDOWS_NUMPY, "3.12", "win_amd64")
        (folder / "done").touch()
    install(tools, folder / "installed", wheel, "3.12", "win_amd64")
    paths = ";".join("Z:" + str(folder / name).replace("/", "\\") for name in ("installed", "packages"))
    run(wine, root / "python.exe", ROOT / "scripts/wheel_test", log=f"test-{wheel.stem}", cwd=folder, through_pipe=True,
        env={"PYTHONPATH": paths, "WINEPREFIX": str(folder / "prefix"), "WINEDEBUG": "-all", "WINEDLLOVERRIDES": "winedbg.exe=d"})
    return "passed with Python 3.12 of Windows under Wine"


def install(tools, folder, what, version, *platforms):
    shutil.rmtree(folder, ignore_errors=True)
    chosen = [part for name in platforms for part in ("--platform", name)]
    run(tools / "pip", "install", "--disable-pip-version-check", "--target", folder, "--only-binary", ":all:", *chosen, "--python-version",
        version, "--no-deps", what, log=f"{folder.parent.name}-{folder.name}")


def program(path, text):
    path.write_text(f"#!/bin/sh\n{text}\n", encoding="utf-8")
    path.chmod(0o755)


def run_test(folder, python, wheel):
    """Programs that the test starts need the same loader or emulator as it does: a script stands in Python's place."""
    here = folder / "python"
    program(here, f'exec {python} "$@"')
    test_file = ROOT / "scripts/wheel_test"
    run(here, "-c", f"import sys, runpy; sys.executable = {str(here)!r}; runpy.run_path({str(test_file)!r}, run_name='__main__')",
        log=f"test-{wheel.stem}", cwd=folder, env={"PYTHONPATH": f"{folder}/installed:{folder}/packages", "OPENBLAS_NUM_THREADS": "1"})


def python_source():
    """Debian 13's source package of Python 3.13, unpacked."""
    folder = WORK / "python_source"
    source = folder / "source"
    if not (source / "configure").exists():
        env = apt(folder, "amd64", "deb-src", "trixie")
        run("apt-get", "source", "--download-only", "python3.13", log="python_source", cwd=folder, env=env)
        shutil.rmtree(source, ignore_errors=True)
        source.mkdir()
        run("tar", "xf", next(folder.glob("python3.13_*.orig.tar.xz")), "-C", source, "--strip-components=1", log="python_source-untar")
    return source


def windows_development(python, version):
    """A folder with headers and the import library with which an extension for Windows is compiled: the interpreter's headers with the
    configuration of Windows, and the functions of the stable interface, which python3.dll has in every version."""
    folder = WORK / "windows_development"
    source = python_source()
    own = subprocess.run([python, "-c", "import sysconfig; print(sysconfig.get_path('include'))"], capture_output=True, text=True, check=True)
    shutil.rmtree(folder, ignore_errors=True)
    shutil.copytree(own.stdout.strip(), folder / "include")
    shutil.copyfile(source / "PC/pyconfig.h.in", folder / "include/pyconfig.h")
    exported = re.findall(r"^EXPORT_(FUNC|DATA)\((\w+)\)", (source / "PC/python3dll.c").read_text(encoding="utf-8"), re.M)
    (folder / "python3.def").write_text("LIBRARY python3.dll\nEXPORTS\n" + "".join(f"  {name}{' DATA' * (kind == 'DATA')}\n" for kind, name in exported))
    zig = next(ROOT.glob("build/zig/venv/lib/python*/site-packages/ziglang/zig"))
    # CMake looks for the library of one version of Python, too, but an extension of the stable interface does not link it.
    for name in ("python3", f"python{version}"):
        run(zig, "dlltool", "-m", "i386:x86-64", "-d", folder / "python3.def", "-l", folder / f"{name}.lib", log="windows-dlltool")
    return folder
