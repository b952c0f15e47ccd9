# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The notebooks of the examples run, and are stored without what they print."""

import json
import os
import pathlib
import subprocess
import sys

import pytest

notebooks = sorted((pathlib.Path(__file__).resolve().parents[2] / "examples" / "notebooks").glob("*.ipynb"))
assert notebooks


@pytest.mark.parametrize("file", notebooks, ids=lambda path: path.stem)
def test_a_notebook_is_stored_without_outputs(file):
    cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
    assert "SPDX-License-Identifier: Apache-2.0" in "".join(cells[0]["source"])
    for cell in cells:
        assert not cell.get("outputs") and cell.get("execution_count") is None
    assert sum(cell["cell_type"] == "code" for cell in cells) >= 2


@pytest.mark.parametrize("file", notebooks, ids=lambda path: path.stem)
def test_a_notebook_runs(file, tmp_path):
    pytest.importorskip("matplotlib")
    try:
        import nbclient
        import nbformat

        import ipykernel  # noqa: F401
    except ImportError:
        # Cell by cell in a process of its own, as a kernel would.
        cells = json.loads(file.read_text(encoding="utf-8"))["cells"]
        script = tmp_path / "cells.py"
        script.write_text("\n".join("".join(cell["source"]) for cell in cells if cell["cell_type"] == "code"), encoding="utf-8")
        done = subprocess.run([sys.executable, str(script)], cwd=tmp_path, capture_output=True, text=True, timeout=600)
        assert done.returncode == 0, done.stderr
        return
    notebook = nbformat.read(file, as_version=4)
    nbformat.validate(notebook)
    environment = {**os.environ, "IPYTHONDIR": str(tmp_path), "JUPYTER_RUNTIME_DIR": str(tmp_path), "MPLBACKEND": "Agg"}
    before = dict(os.environ)
    os.environ.update(environment)
    try:
        nbclient.NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()
    finally:
        os.environ.clear()
        os.environ.update(before)
    assert any(cell.get("outputs") for cell in notebook.cells)
