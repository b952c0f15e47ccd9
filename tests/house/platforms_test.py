# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/platforms sees planted faults and records what it ran; a stopped run records nothing.

usage: platforms_test.py REPOSITORY FOLDER       exit code: 0 as promised, 1 otherwise

A copy of the script runs in FOLDER with a cmake of its own, whose programs print the hashes that a variable of the environment gives.
"""
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import time

repository, folder = (pathlib.Path(argument).resolve() for argument in sys.argv[1:])
TARGET = "x86_64-linux-libcxx"
# Hashes of the reference, and of the target with the fault of PLANTED. A build with "slow" says where it is and waits.
CMAKE = """#!/bin/sh
if [ "$1" = --preset ]; then mkdir -p "build/$2/bin"; touch "build/$2/CMakeCache.txt"; exit 0; fi
case $2-$PLANTED in
*libcxx-broken) echo "a.cpp:1:1: error: planted"; exit 1 ;;
*libcxx-ended) kill -TERM $$ ;;
*libcxx-slow) echo $$ >slow; sleep 600 ;;
*libcxx-wrong) two=ffffffffffffffff ;;
*) two=2222222222222222 ;;
esac
printf '#!/bin/sh\\necho "1111111111111111 a tree"\\necho "%s an update"\\n' $two >"$2/bin/morula_bits"
printf '#!/bin/sh\\n' >"$2/bin/example_c"
printf '#!/bin/sh\\n[ $1 != robot ] || { mkdir -p robot; touch robot/spheres.json; }\\n' >"$2/bin/morula"
cp part_of_a_test "$2/bin/shape_test"
chmod +x "$2"/bin/*
for program in morula_bits example_c morula shape_test; do cp "$2/bin/$program" "$2/bin/$program.exe"; done
"""
# Wine runs a program; its server does nothing.
WINE = """#!/bin/sh
program=$1
shift
exec "$program" "$@"
"""
NINJA = """#!/bin/sh
echo "cmake_object_order_depends_target_shape_test: phony"
echo "shape_test: phony"
"""
# A test program of six tests, of which each of two parts runs three. What Wine did not start is in the messages of a test.
PART_OF_A_TEST = """#!/bin/sh
case $PLANTED-$1 in
unstarted-*is_round) echo "[  PASSED  ] 1 test."; exit 0 ;;
never_started-*is_round) echo "[  PASSED  ] 0 tests."; echo "[  FAILED  ] Shape.is_round (1 ms)"; exit 1 ;;
*started-*)
  echo "[  PASSED  ] 3 tests."
  echo "no process can be started, error 1359 of Windows"
  echo "[  FAILED  ] Shape.is_round (1 ms)"
  echo "[  FAILED  ] Shape.is_flat (1 ms)"
  exit 1 ;;
esac
echo "[  PASSED  ] $((GTEST_TOTAL_SHARDS == 2 ? 2 : 99)) tests."
case $PLANTED-$GTEST_SHARD_INDEX in
failing-1) echo "[  FAILED  ] Shape.is_round (1 ms)"; exit 1 ;;
crashing-0) exit 134 ;;
*) echo "[  SKIPPED ] 1 test." ;;
esac
"""
OLD = "# a comment\n`windows-gnu`\tanother target\n`" + TARGET + "`\tan older result\n"


def plant():
    shutil.rmtree(folder, ignore_errors=True)
    for name in ("scripts", "bin", "docs/_data", "build/third_party"):
        (folder / name).mkdir(parents=True)
    shutil.copy(repository / "scripts/platforms", folder / "scripts/platforms")
    for path, text in (("scripts/zig", "#!/bin/sh\n"), ("bin/cmake", CMAKE), ("bin/ninja", NINJA), ("part_of_a_test", PART_OF_A_TEST),
                       ("bin/wine64", WINE), ("bin/wineserver", "#!/bin/sh\n")):
        (folder / path).write_text(text)
        (folder / path).chmod(0o755)
    (folder / "docs/_data/targets.tsv").write_text(OLD)


def start(planted, *options, target=TARGET):
    if "--resume" not in options:
        plant()
    environment = {**os.environ, "PATH": f"{folder / 'bin'}:{os.environ['PATH']}", "PLANTED": planted}
    return subprocess.Popen([sys.executable, folder / "scripts/platforms", *(options or ["--hashes"]), "--record", target], cwd=folder, env=environment,
                            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)


def table():
    return (folder / "docs/_data/targets.tsv").read_text()


faults = []
# A test in the background has it ignored, which programs inherit.
signal.signal(signal.SIGINT, signal.default_int_handler)


def expect(what, holds, output=""):
    if not holds:
        faults.append(f"{what}\n{output}")


def expect_row(planted, code, *columns, options=(), target=TARGET):
    run = start(planted, *options, target=target)
    output = run.communicate()[0]
    lines, old = table().splitlines(), OLD.splitlines()
    row = next(number for number, line in enumerate(old) if line.startswith(f"`{target}`"))
    expect(f"{planted}: exit code {run.returncode}", run.returncode == code, output)
    expect(f"{planted}: other rows", lines[:row] + lines[row + 1:] == old[:row] + old[row + 1:], table())
    cells = lines[row].split("\t")
    expect(f"{planted}: the row", cells[:1] + cells[2:] == [f"`{target}`", *columns], table())


expect_row("nothing", 0, "the core", "not run", "not run", "2 of 2", "all but the core's hashes (--hashes)")
expect_row("wrong", 1, "the core", "not run", "not run", "1 of 2", "all but the core's hashes (--hashes)")
with_tests = {"options": ("--jobs", "2")}
parts = "the core, files, robots and the command, C, 1 of 1 test programs"
expect_row("nothing", 0, parts, "passed", "4 passed, 0 failed, 2 skipped", "2 of 2", "-", **with_tests)
expect_row("failing", 1, parts, "passed", "4 passed, 1 failed, 1 skipped", "2 of 2", "-", **with_tests)
expect_row("crashing", 1, parts, "passed", "4 passed, 1 failed, 1 skipped", "2 of 2", "-", **with_tests)
# Part 1 has crashed and is run again, part 2 has passed and would fail if it ran: it does not, until its program changes.
resumed = {"options": ("--jobs", "2", "--resume")}
expect_row("crashing", 1, parts, "passed", "4 passed, 1 failed, 1 skipped", "2 of 2", "-", **with_tests)
expect_row("failing", 0, parts, "passed", "4 passed, 0 failed, 2 skipped", "2 of 2", "-", **resumed)
with (folder / "part_of_a_test").open("a") as file:
    file.write("# changed\n")
expect_row("failing", 1, parts, "passed", "4 passed, 1 failed, 1 skipped", "2 of 2", "-", **resumed)
# Only the test whose program Wine did not start runs once more.
with_wine = {"options": ("--jobs", "2"), "target": "windows-gnu"}
again = "4 passed, 1 failed, 0 skipped (1 of them in a second run: Wine did not start a program)"
expect_row("unstarted", 1, parts, "passed", again, "2 of 2", "-", **with_wine)
expect_row("never_started", 1, parts, "passed", "3 passed, 2 failed, 0 skipped", "2 of 2", "-", **with_wine)
expect_row("broken", 1, "no", "not run", "not run", "not run", "morula_bits does not compile; all but the core's hashes (--hashes)")

ended = start("ended")
output = ended.communicate()[0]
expect("a compiler that somebody ended", ended.returncode == 130 and table() == OLD, output + table())

for number in (signal.SIGTERM, signal.SIGINT):
    stopped = start("slow")
    while not (folder / "slow").exists() or not (folder / "slow").read_text().endswith("\n"):
        time.sleep(0.01)
    compiler = int((folder / "slow").read_text())
    stopped.send_signal(number)
    output = stopped.communicate()[0]
    expect(f"a run ended by {number.name}", stopped.returncode == 130 and table() == OLD, output + table())
    try:
        os.kill(compiler, 0)
        expect(f"{number.name}: its compiler still runs", False)
    except ProcessLookupError:
        pass

print("\n".join(faults) or "as promised")
sys.exit(1 if faults else 0)
