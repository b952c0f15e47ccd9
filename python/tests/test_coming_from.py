# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The code of docs/how-to/coming_from.md runs, block by block, where its packages are installed."""

import importlib.util
import pathlib
import re
import subprocess
import sys

import pytest

page = (pathlib.Path(__file__).resolve().parents[2] / "docs/how-to/coming_from.md").read_text(encoding="utf-8")
blocks = [
    (section.partition("\n")[0], code)
    for section in re.split(r"(?m)^## ", page)[1:]
    for code in re.findall(r"(?ms)^```python\n(.*?)^```$", section)
]
assert len(blocks) == 7


@pytest.mark.parametrize(("title", "code"), blocks, ids=[title for title, _ in blocks])
def test_a_block_runs(title, code, tmp_path):
    for package in re.findall(r"(?m)^import (\w+)$", code):
        if importlib.util.find_spec(package) is None:
            pytest.skip(f"{package} is not installed")
    done = subprocess.run([sys.executable, "-c", code], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
