#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""scripts/release in a small repository: it names every kind of fault that is planted, changes nothing in a dry run, makes the
same archive twice, and publishes what it says, to a bare repository.
usage: release_test.py ROOT FOLDER        exit code 77 without git"""
import datetime
import hashlib
import os
import pathlib
import shutil
import subprocess
import sys
import tarfile

root, folder = pathlib.Path(sys.argv[1]).resolve(), pathlib.Path(sys.argv[2]).resolve()
if not shutil.which("git"):
    print("skipped: there is no git")
    sys.exit(77)
shutil.rmtree(folder, ignore_errors=True)
clone, programs, remote = folder / "clone", folder / "programs", folder / "remote.git"
# Nothing of the user's settings: no hooks, no key, no name.
environment = {**{k: v for k, v in os.environ.items() if not k.startswith("GIT_")}, "HOME": str(folder), "GIT_CONFIG_NOSYSTEM": "1",
               "GIT_CONFIG_GLOBAL": str(folder / "gitconfig"), "PATH": f"{programs}:{os.environ['PATH']}"}
address = "https://example.org/morula/morula"
changelog = "# Changelog\n\n## Unreleased\n\n## 0.1.0 - unreleased\n\nThe first release.\n\n- [Spheres](docs/tree.md#a).\n"


def write(path, text, mode=0o644):
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    path.chmod(mode)


def git(*arguments, cwd=clone):
    return subprocess.run(["git", *map(str, arguments)], cwd=cwd, env=environment, capture_output=True, text=True, check=True).stdout.strip()


def commit(text):
    git("add", "-A")
    git("commit", "--quiet", "--allow-empty", "-m", text)


def run(*arguments, typed=""):
    done = subprocess.run([sys.executable, clone / "scripts/release", *map(str, arguments)], env=environment, capture_output=True, text=True, input=typed)
    return done.returncode, done.stdout + done.stderr


def expect(result, code, *words):
    if result[0] != code or any(word not in result[1] for word in words):
        sys.exit(f"expected exit code {code} and {words}, not {result[0]}:\n{result[1][-3000:]}")


for name in ("CMakeLists.txt", "CITATION.cff", "package.xml", "pyproject.toml", "scripts/release"):
    (clone / name).parent.mkdir(parents=True, exist_ok=True)
    shutil.copy(root / name, clone / name)
# The version of this test, whatever the project's is. The scripts that compare texts have tests of their own.
text = (clone / "CMakeLists.txt").read_text()
begin = text.index("project(morula VERSION ") + len("project(morula VERSION ")
write(clone / "CMakeLists.txt", text[:begin] + "0.1.0" + text[text.index(" ", begin):])
write(clone / "CHANGELOG.md", changelog)
write(clone / ".gitignore", "build\n__pycache__\n")
write(clone / "web/package.json", '{"version": "0.1.0"}')
write(clone / "web/package-lock.json", '{"version": "0.1.0", "packages": {"": {"version": "0.1.0"}}}')
passes, fails, skips = "import sys\nsys.exit(0)\n", "import sys\nsys.exit('vcpkg: has version 7')\n", "import sys\nsys.exit(77)\n"
for name in ("scripts/packaging", "scripts/abi", "tests/house/report_test.py"):
    write(clone / name, passes)
write(folder / "gitconfig", "[user]\nname = Someone\nemail = someone@example.org\n[init]\ndefaultBranch = main\n")
git("init", "--quiet")
commit("First")
light = ["--without-python", "--without-debs"]

# Bad use.
for arguments in ((), ("0.1",), ("0.1.0", "--check", "--publish"), ("0.1.0", "--date", "tomorrow"), ("0.1.0", "--date", "9999-12-31"),
                  ("0.1.0", "--address", address)):
    expect(run(*arguments), 2, "release: error:")
expect(run("--help"), 0, "usage: scripts/release VERSION")

# The address: missing, malformed, written, and different in a copy.
expect(run("0.1.0", "--check", *light), 1, "HOMEPAGE_URL of project(morula) is empty")
for url in ("http://example.org/a/morula", "https://example.org/", "https://example.org/a/morula.git", "https://example.org/a b"):
    expect(run("--address", url), 1, "is no address such as")
expect(run("--address", address + "2"), 0)
expect(run("--address", address), 0, "CMakeLists.txt names", "CITATION.cff names", "package.xml names", "pyproject.toml names")
for name in ("CMakeLists.txt", "CITATION.cff", "package.xml", "pyproject.toml"):
    text = (clone / name).read_text()
    if text.count(address) != 1 or address + "2" in text:
        sys.exit(f"{name} does not have the address once")
commit("Address")
expect(run("0.1.0", "--check", *light), 0, "0.1.0 is ready")

for name, old, new, faults in (
        ("CMakeLists.txt", "VERSION 0.1.0", "VERSION 0.2.0", ["CMakeLists.txt has version 0.2.0, not 0.1.0"]),
        ("CMakeLists.txt", address, address + "2", ["CITATION.cff, package.xml, pyproject.toml: not the address of CMakeLists.txt"]),
        ("package.xml", address, address + "2", ["package.xml: not the address of CMakeLists.txt"]),
        ("CHANGELOG.md", "## Unreleased\n", "", ['the first section is not "## Unreleased"']),
        ("CHANGELOG.md", "## Unreleased\n", "## Unreleased\n\n- A line.\n", ["there are entries under Unreleased"]),
        ("CHANGELOG.md", "## 0.1.0 - unreleased", "## 0.1.1 - unreleased", ['has 0 sections "## 0.1.0 - …"']),
        ("CHANGELOG.md", "## 0.1.0 - unreleased", "## 0.2.0 - unreleased\n\n## 0.1.0 - unreleased", ["is not the one below Unreleased"]),
        ("CHANGELOG.md", "- unreleased", "- 2020-02-02", ["says '2020-02-02', not unreleased or"]),
        ("CHANGELOG.md", "- [Sp", "- A line.\n" * 80 + "- [Sp", ["has 83 lines: a summary has 1 to 80"]),
        ("CHANGELOG.md", "The first release.\n\n- [Spheres](docs/tree.md#a).\n", "", ["has 0 lines"]),
        ("web/package.json", "0.1.0", "0.2.0", ["web: package.json or package-lock.json has version 0.2.0, not 0.1.0"]),
        ("web/package-lock.json", '{"": {"version": "0.1.0"', '{"": {"version": "0.3.0"', ["has version 0.3.0, not 0.1.0"]),
        ("scripts/packaging", passes, fails, ["recipes: scripts/packaging fails: vcpkg: has version 7"]),
        ("scripts/abi", passes, fails, ["public names and binary interface: scripts/abi fails"]),
        ("scripts/abi", passes, skips, ["public names and binary interface: scripts/abi cannot run"]),
        ("tests/house/report_test.py", passes, fails, ["citation: tests/house/report_test.py fails"])):
    text = (clone / name).read_text()
    if old not in text:
        sys.exit(f"{name} has no {old!r} to plant a fault in")
    write(clone / name, text.replace(old, new, 1))
    expect(run("0.1.0", "--check", *light), 1, "the tree has changes", *faults)
    write(clone / name, text)
for tag, fault in (("v0.1.0", "the tag v0.1.0 exists"), ("v0.10.0", "v0.10.0 is newer than 0.1.0")):
    git("tag", tag)
    expect(run("0.1.0", "--check", *light), 1, fault)
    git("tag", "-d", tag)
expect(run("0.1.0", "--publish", *light), 1, "git signs no tags here", "there is no remote origin")

# A dry run changes nothing, and makes the same bytes each time.
before, output = git("rev-parse", "HEAD"), clone / "build/release-0.1.0"
sums = []
for _ in range(2):
    expect(run("0.1.0", "--dry-run", "--date", "2026-01-31", *light), 0, "left out, --without-python", "left out, --without-debs", "dry run")
    sums.append((output / "SHA256SUMS").read_text())
archive = output / "morula-0.1.0-source.tar.gz"
if sums[0] != sums[1] or hashlib.sha256(archive.read_bytes()).hexdigest() not in sums[0]:
    sys.exit(f"two runs differ, or their sums are wrong:\n{''.join(sums)}")
if git("rev-parse", "HEAD") != before or git("status", "--porcelain") or git("tag"):
    sys.exit("a dry run changed the clone")
if sorted(path.name for path in output.iterdir()) != ["NOTES.md", "SHA256SUMS", archive.name]:
    sys.exit(f"{output} has other files than these")
if (output / "NOTES.md").read_text() != f"The first release.\n\n- [Spheres]({address}/blob/v0.1.0/docs/tree.md#a).\n":
    sys.exit("the notes are not the section of the change log")
with tarfile.open(archive) as packed:
    # A later time of the day could be to come, and ninja ends at files of such a time.
    if {member.mtime for member in packed.getmembers()} != {int(datetime.datetime(2026, 1, 31, tzinfo=datetime.timezone.utc).timestamp())}:
        sys.exit("files of the archive are not of the first second of the day")
    dated = {name: packed.extractfile(f"morula-0.1.0/{name}").read().decode() for name in ("CHANGELOG.md", "CITATION.cff")}
if "## 0.1.0 - 2026-01-31\n" not in dated["CHANGELOG.md"] or dated["CITATION.cff"].count("date-released: 2026-01-31\n") != 1:
    sys.exit("the archive has no date")

# Publishing: stand-ins for gpg and gh, and a bare repository.
write(programs / "gpg", "#!/bin/sh\ncat >/dev/null\necho '[GNUPG:] SIG_CREATED D' >&2\necho '-----BEGIN PGP SIGNATURE-----'\n", 0o755)
write(programs / "gh", f'#!/bin/sh\nprintf "%s\\n" "$@" >"{folder}/gh.txt"\n', 0o755)
subprocess.run(["git", "init", "--quiet", "--bare", remote], env=environment, check=True)
git("remote", "add", "origin", remote)
git("config", "user.signingkey", "1234")
expect(run("0.1.0", "--publish", *light, typed="0.1\n"), 1, "nothing is published")
if git("tag") or git("for-each-ref", cwd=remote) or (folder / "gh.txt").exists():
    sys.exit("something is published without consent")
released = git("rev-parse", "HEAD")
if git("rev-parse", "HEAD~1") != before or git("log", "-1", "--format=%s") != "Release 0.1.0" or git("status", "--porcelain"):
    sys.exit("the branch does not have the release's commit")
expect(run("0.1.0", "--publish", *light, typed="0.1.0\n"), 0, f"the branch has the commit {released[:12]}", "git push --atomic origin HEAD v0.1.0")
if git("rev-parse", "HEAD") != released or git("rev-parse", "v0.1.0^{commit}", cwd=remote) != released or git("rev-parse", "main", cwd=remote) != released:
    sys.exit("branch and tag are not where they were pushed")
said = (folder / "gh.txt").read_text().splitlines()
if said[:3] != ["release", "create", "v0.1.0"] or str(archive) not in said or str(output / "SHA256SUMS") not in said:
    sys.exit(f"gh got {said}")
expect(run("0.1.0", "--check", *light), 1, "the tag v0.1.0 exists")
print("every planted fault is named; a dry run changes nothing; what is said is published")
