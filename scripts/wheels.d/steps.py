# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""What the parts of scripts/wheels share: folders, commands with logs, and apt with states of its own."""
import os
import pathlib
import subprocess

ROOT = pathlib.Path(__file__).resolve().parents[2]
WORK = ROOT / "build/wheels"
DIST = WORK / "dist"
LOGS = WORK / "logs"


def say(text):
    print(f"wheels: {text}", flush=True)


def run(*command, log, cwd=ROOT, env=None, through_pipe=False):
    """Runs a command with its output in a log and no input; stops with the log's end after a failure. Through a pipe: for programs of
    Windows, which under Wine cannot print to a file that they are given."""
    LOGS.mkdir(parents=True, exist_ok=True)
    path = LOGS / f"{log}.txt"
    with path.open("wb") as file:
        done = subprocess.run([str(part) for part in command], cwd=cwd, env={**os.environ, **(env or {})}, input=b"",
                              stdout=subprocess.PIPE if through_pipe else file, stderr=subprocess.STDOUT)
        file.write(done.stdout or b"")
    text = path.read_text(encoding="utf-8", errors="replace")
    if done.returncode:
        raise RuntimeError(f"{command[0]} failed with {done.returncode}; the end of {path.relative_to(ROOT)}:\n" + text[-2000:])
    return text


def apt(folder, architecture, kind, release):
    """A configuration of apt with states of its own below folder, so that the machine's stay as they are."""
    for part in ("lists/partial", "cache/archives/partial"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    (folder / "status").touch()
    address = subprocess.run(["apt-get", "indextargets", "--format", "$(REPO_URI)", "Created-By: Packages"], capture_output=True, text=True)
    mirror = next((line for line in address.stdout.split() if line.rstrip("/").endswith("/debian")), None)
    if not mirror:
        raise RuntimeError("apt knows no archive of Debian")
    keys = "/usr/share/keyrings/debian-archive-keyring.gpg"
    (folder / "sources.list").write_text(f"{kind} [signed-by={keys}] {mirror} {release} main\n")
    lines = [f'APT::Architecture "{architecture}";', f'APT::Architectures {{"{architecture}";}};', f'Dir::State "{folder}";',
             f'Dir::State::status "{folder}/status";', f'Dir::Cache "{folder}/cache";',
             f'Dir::Etc::sourcelist "{folder}/sources.list";', 'Dir::Etc::sourceparts "-";', 'APT::Sandbox::User "root";']
    (folder / "apt.conf").write_text("\n".join(lines) + "\n")
    env = {"APT_CONFIG": str(folder / "apt.conf")}
    run("apt-get", "update", log=f"{folder.name}-update", env=env)
    return env
