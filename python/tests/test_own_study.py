# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Rules and metrics of one's own in a study."""

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


def test_an_exception_of_a_rule_comes_out_of_the_study():
    class Broken(Twin):
        name = "broken"

        def follow(self, positions):
            raise LookupError("no spheres today")

    with pytest.raises(LookupError, match="no spheres today"):
        morula.study(morula.sample_body("limb", 8), rules=["exact", Broken], **small)
