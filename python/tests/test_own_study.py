# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Rules, generators, motions and metrics of one's own in a study."""

import pathlib
import re
import subprocess
import sys

import numpy
import pytest

import morula

pytestmark = pytest.mark.skipif(not hasattr(morula, "study"), reason="this package was built without the study")
small = {"quick": True, "seeds": 1, "frames": 3, "resolution": 24, "branching": 4, "methods": ["grid"]}


class Twin:
    """approach2 of the library, as if it were one's own."""

    name = "twin"

    def __init__(self, mesh, model):
        self.body = morula.Body(mesh, model, rules=["approach2"])

    def follow(self, positions):
        self.body.update(positions)
        return self.body.copy_spheres()


def test_a_rule_that_does_what_approach2_does_has_its_cells_and_verdict():
    study = morula.study(morula.sample_body("limb", 8), rules=["approach2", "exact", Twin], **small)
    cells = study.cells
    of_rule = {rule: [cells[column][cells["rule"] == rule] for column in ("looseness", "uncovered_area", "sample", "level")]
               for rule in ("twin", "approach2")}
    assert len(of_rule["twin"][0]) == 3 * 3 * 2
    numpy.testing.assert_array_equal(of_rule["twin"], of_rule["approach2"])
    assert "twin" in study.tables["rules"]["rule"]
    assert study.verdict("twin-returns-to-rest") == "holds"


def test_a_metric_is_what_its_function_returns():
    def count(mesh, spheres, level):
        return len(spheres) + level / 10

    study = morula.study(morula.sample_body("limb", 8), rules=["exact"], metrics={"count": ("spheres", count)}, **small)
    cells = study.cells
    numpy.testing.assert_allclose(cells["count"], cells["spheres"] + cells["level"] / 10)
    assert "count, mean" in study.tables["rules"]


def test_a_generator_that_builds_as_grid_does_has_its_cells():
    def lattice(mesh):
        return morula.build(mesh, method="grid", branching=4, depth=3)

    study = morula.study(morula.sample_body("limb", 8), rules=["approach2", "exact"], **{**small, "methods": ["grid", lattice]}, depth=3)
    cells = study.cells
    of_method = {method: [cells[column][cells["method"] == method] for column in ("looseness", "uncovered_area", "rule", "level")]
                 for method in ("grid", "lattice")}
    assert len(of_method["grid"][0]) == 3 * 3 * 2 * 2
    for grid, own in zip(of_method["grid"], of_method["lattice"]):
        numpy.testing.assert_array_equal(grid, own)
    assert study.verdict("lattice-below-generators") == "fails"  # as tight as grid
    assert any(series["name"] == "lattice" for series in study.figures["fig2d-bend"]["series"])


def test_balls_of_a_generator_are_made_to_cover():
    def balls(mesh):
        return morula.tree_from_spheres(numpy.c_[mesh.positions, numpy.full(len(mesh.positions), 0.01)], branching=4)

    study = morula.study(morula.sample_body("limb", 8), rules=["exact"], **{**small, "methods": ["grid", balls]}, depth=2)
    cells = study.cells
    assert (cells["uncovered_area"][cells["method"] == "balls"] == 0).all() and "balls" in cells["method"]


def test_frames_of_a_simulation_are_measured_as_by_hand():
    capsule, limb = morula.sample_body("capsule", 8), morula.sample_body("limb", 8)
    frames = numpy.stack([capsule.positions * [1, 1 + 0.2 * i, 1] for i in range(3)])
    study = morula.study({"limb": limb, "capsule": capsule}, rules=["approach2", "exact"], motions={"swell it": frames}, depth=2, **small)
    cells = study.cells
    chosen = (cells["motion"] == "swell-it") & (cells["rule"] == "approach2") & (cells["level"] == 2)
    assert set(cells["body"][cells["motion"] == "swell-it"]) == {"capsule"}
    body = morula.Body(capsule, morula.build(capsule, method="grid", branching=4, depth=2), rules=["approach2"])
    for frame, looseness, uncovered in zip(frames, cells["looseness"][chosen], cells["uncovered_area"][chosen]):
        body.update(frame)
        spheres = body.current_tree().level_set_spheres(2)
        assert looseness == morula.looseness((frame, capsule.facets), spheres, resolution=24).looseness
        assert uncovered == morula.coverage((frame, capsule.facets), spheres).uncovered_area
    with pytest.raises(ValueError, match="no body has 7 vertices"):
        morula.study(limb, motions={"short": numpy.zeros((3, 7, 3))}, **small)


def test_the_program_of_the_page_on_studies_runs(tmp_path):
    page = pathlib.Path(__file__).resolve().parents[2] / "extras/study/docs/study.md"
    (program,) = re.findall(r"(?ms)^```python\n(.*?)^```$", page.read_text(encoding="utf-8"))
    done = subprocess.run([sys.executable, "-c", program], cwd=tmp_path, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert all(word in ("holds", "partly", "fails") for word in done.stdout.split()) and len(done.stdout.split()) == 2


def test_an_exception_of_a_rule_comes_out_of_the_study():
    class Broken(Twin):
        name = "broken"

        def follow(self, positions):
            raise LookupError("no spheres today")

    with pytest.raises(LookupError, match="no spheres today"):
        morula.study(morula.sample_body("limb", 8), rules=["exact", Broken], **small)
