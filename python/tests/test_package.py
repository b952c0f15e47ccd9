# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The package as a whole: names, stubs, docstrings, the command, examples."""

import doctest
import os
import pathlib
import re
import subprocess
import sys

import pytest

import morula

sources = pathlib.Path(__file__).resolve().parents[2]


def test_the_version_is_that_of_the_library():
    written = re.search(r"project\(morula VERSION ([0-9.]+)", (sources / "CMakeLists.txt").read_text(encoding="utf-8"))
    assert morula.__version__ == written.group(1)


def test_python_m_morula_is_the_command(command):
    assert morula.__version__ in command("--version")
    assert "octree" in command("build", "--help")
    command("build", "nowhere.obj", "-o", "x.morula", code=2)


def test_jobs_of_batch_are_python_again(command, tmp_path):
    command("sample", "bar", "--resolution", "8", "-o", "bar.obj")
    (tmp_path / "list.txt").write_text("bar.obj\n")
    command("batch", "list.txt", "-o", "out", "--method", "octree", "--depth", "1")
    assert list((tmp_path / "out").rglob("*.morula"))


def test_everything_is_documented():
    bare = [
        name
        for name in morula.__all__
        if callable(getattr(morula, name)) and not (getattr(morula, name).__doc__ or "").strip()
    ]
    assert bare == []
    assert "region wrapping" in morula.build.__doc__ and "ValueError" in morula.build.__doc__


def test_importing_brings_no_other_package():
    script = "import sys, morula; print([m for m in ('numpy', 'matplotlib', 'ipctk') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout == "[]\n"


def test_the_example_in_the_docstring_runs():
    assert doctest.testmod(morula).failed == 0


def test_docstrings_speak_of_python():
    modules = [morula] + ([morula.robot] if hasattr(morula._morula, "robot") else [])
    things = [(name, getattr(module, name)) for module in modules for name in module.__all__]
    parts = [(f"{name}.{part}", value) for name, thing in things if isinstance(thing, type) for part, value in vars(thing).items()]
    assert [name for name, thing in things + parts if re.search(r"\w::\w", str(thing.__doc__))] == []


def test_type_checkers_accept_stubs_and_a_script(tmp_path):
    pytest.importorskip("mypy")
    script = tmp_path / "script.py"
    script.write_text(
        '''
import numpy
import morula

mesh: morula.Mesh = morula.sample_body("limb")
built = morula.build(mesh, method="grid", depth=2, progress=lambda p: print(p.share))
body = morula.Body(mesh, built, rules=["exact"])
status: morula.UpdateStatus = body.update(numpy.asarray(mesh.positions, dtype=numpy.float32))
nodes: int = status.nodes_updated
radii = built.level(1)[:, 3]
contacts = morula.collide(body, morula.Collider(body), budget="200us")
deepest: float = float(contacts.depth.max())
figures = [m.looseness.looseness for m in morula.measure(mesh, built)]
where: tuple[float, float, float] = body.origin
scene = morula.Scene(budget="1ms", accepts=lambda a, b: a != b)
first: morula.BodyId = scene.add(body, user_data=3)
for pair in scene.pairs():
    deepest = max(deepest, float(pair.contacts.depth.max()))
query = morula.ProximityQuery(distance=0.1, budget=1000)
open_facets = [of_a.tolist() for of_a, of_b in query.open()]
'''
        + ('verdict: str = morula.study(mesh, quick=True).verdict("exact-covers")\n' if hasattr(morula, "study") else ""),
        encoding="utf-8",
    )
    (tmp_path / "wrong.py").write_text("import morula\nmorula.build(3, dept=2)\n", encoding="utf-8")
    # Packages that are large and have little to say here are not followed.
    (tmp_path / "mypy.ini").write_text(
        """
[mypy]
strict = True
[mypy-matplotlib.*,pyvista.*,ipctk.*,pyarrow.*]
follow_imports = skip
ignore_missing_imports = True
""",
        encoding="utf-8",
    )
    model = pathlib.Path(morula.__file__).parent.parent

    def check(*what):
        return subprocess.run(
            [sys.executable, "-m", "mypy", "--cache-dir", str(model / "mypy_cache"), *what],
            cwd=tmp_path, env={**os.environ, "MYPYPATH": str(model)}, capture_output=True, text=True, check=False,
        )

    right = check("script.py")
    assert right.returncode == 0, right.stdout
    package = check("-p", "morula")
    assert package.returncode == 0, package.stdout
    assert check("wrong.py").returncode == 1


@pytest.mark.parametrize("example", sorted((sources / "examples" / "python").glob("*.py")), ids=lambda path: path.stem)
def test_examples_run(example, tmp_path):
    if example.stem == "plan" and not hasattr(morula._morula, "robot"):
        pytest.skip("this package was built without robots")
    done = subprocess.run([sys.executable, str(example)], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
