# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The Python program of README runs as it stands there, in an empty folder."""

import pathlib
import re
import subprocess
import sys

readme = (pathlib.Path(__file__).resolve().parents[2] / "README.md").read_text(encoding="utf-8")


def test_the_program_of_readme_finds_contacts(tmp_path):
    (program,) = re.findall(r"(?ms)^```python\n(.*?)^```$", readme)
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    counts = [int(line.split()[0]) for line in done.stdout.splitlines()]
    assert len(counts) == 25
    assert re.fullmatch(r"([0-9]+ (patches of contact, volume [0-9.]+|places[^\n]*)\n)+", done.stdout), done.stdout
    # The limb bends into the tool. On a busy machine the budget may end any run, which then prints places.
    assert max(counts) > 0
