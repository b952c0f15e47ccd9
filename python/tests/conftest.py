# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
import subprocess
import sys

import numpy
import pytest

import morula


@pytest.fixture(scope="session")
def limb():
    return morula.sample_body("limb", 24)


@pytest.fixture(scope="session")
def model(limb):
    return morula.build(limb, method="grid", depth=2)


@pytest.fixture(scope="session")
def motion(limb):
    return morula.deform_frames(limb, morula.Bend(90), morula.Twist(60), frame_count=9)


@pytest.fixture
def command(tmp_path):
    """Runs `python -m morula` in an empty folder; fails unless it succeeds."""

    def run(*arguments, code=0):
        done = subprocess.run(
            [sys.executable, "-m", "morula", *map(str, arguments)], cwd=tmp_path, capture_output=True, text=True, timeout=600
        )
        assert done.returncode == code, done.stderr
        return done.stdout

    return run


def covers_by_sampling(mesh, positions, spheres):
    """Are samples of the moved surface inside some sphere? Shares nothing with the library's certificate."""
    generator = numpy.random.default_rng(1)
    corners = positions[mesh.facets[generator.integers(0, mesh.facet_count, 4000)]]
    weights = generator.dirichlet([1, 1, 1], 4000)
    samples = numpy.einsum("nk,nkd->nd", weights, corners)
    distances = numpy.linalg.norm(samples[:, None, :] - spheres[None, :, :3], axis=2) - spheres[None, :, 3]
    return bool((distances.min(axis=1) <= 1e-12).all())
