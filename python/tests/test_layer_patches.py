# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Layer patches of sheets: by formula, by differences of the volume, within a budget, and of one sheet with itself."""

import numpy
import pytest

import morula

H = 0.1


def sheet(size, count, height=0.0):
    """A square of count x count cells, two facets each, about the z axis."""
    x, y = numpy.meshgrid(*[numpy.linspace(-size / 2, size / 2, count + 1)] * 2, indexing="ij")
    positions = numpy.stack([x, y, numpy.full_like(x, height)], axis=-1).reshape(-1, 3)
    i, j = (k.ravel() for k in numpy.meshgrid(numpy.arange(count), numpy.arange(count), indexing="ij"))
    corner = i * (count + 1) + j
    other = corner + count + 2
    facets = numpy.concatenate([numpy.stack([corner, corner + count + 1, other], 1), numpy.stack([corner, other, corner + 1], 1)])
    return morula.Mesh(positions, facets)


def surfaces_at(low, high):
    a, b = (morula.SurfaceTree(sheet(1, 1)) for _ in range(2))
    for surface, height in ((a, low), (b, high)):
        surface.update(sheet(1, 1, height).positions)
    return a, b


@pytest.fixture
def rough():
    """Two sheets that touch in several places, and their positions."""
    rng = numpy.random.default_rng(7)
    meshes = sheet(1, 6), sheet(1, 5)
    positions = [numpy.array(mesh.positions) for mesh in meshes]
    positions[0][:, 2] += rng.uniform(0.03, 0.15, len(positions[0]))
    positions[1] += rng.uniform(-0.01, 0.01, positions[1].shape)
    surfaces = [morula.SurfaceTree(mesh) for mesh in meshes]
    for surface, moved in zip(surfaces, positions):
        surface.update(moved)
    return surfaces, positions


@pytest.mark.parametrize("gap", [0.0, 0.04, 0.099])
def test_two_squares_have_the_layers_of_the_formula(gap):
    a, b = surfaces_at(gap, 0.0)
    query = morula.LayerPatchQuery(thickness=H)
    assert query.run(a, b).finished
    patches = query.patches()
    assert len(patches) == 1 and abs(patches.volume[0] - (H - gap) ** 2 / (2 * H)) < 1e-10
    assert patches.total_volume == patches.volume[0]
    assert abs(patches.depth[0] - (H - gap)) < 1e-10 and abs(patches.mean_depth[0] - (H - gap)) < 1e-9
    numpy.testing.assert_allclose([patches.area_a[0], patches.area_b[0]], 1, atol=1e-9)
    if gap > 0:
        numpy.testing.assert_allclose(patches.normal[0], (0, 0, 1), atol=1e-9)
        numpy.testing.assert_allclose(patches.area_vector_a[0], (0, 0, -(H - gap) / H), atol=1e-9)
        numpy.testing.assert_allclose(patches.centroid[0], (0, 0, gap / 2), atol=1e-9)
        numpy.testing.assert_allclose(patches.points.point_a[:, 2], gap, atol=1e-9)
        numpy.testing.assert_allclose(patches.points.point_b[:, 2], 0, atol=1e-9)
    a, b = surfaces_at(H * 1.001, 0.0)
    assert query.run(a, b).finished and len(query.patches()) == 0 and query.patches().total_volume == 0
    assert len(patches) == 1, "results stay when the query runs again"


def test_forces_add_up_to_nothing_and_are_differences_of_the_volume(rough):
    (a, b), positions = rough
    query = morula.LayerPatchQuery(thickness=H)
    query.run(a, b)
    patches = query.patches()
    assert len(patches) > 0 and patches.total_volume > 0
    for k in range(len(patches)):
        total = patches.area_vector_a[k] + patches.area_vector_b[k]
        assert numpy.abs(total).max() < 1e-12
        for region, vector in ((patches.a, patches.area_vector_a[k]), (patches.b, patches.area_vector_b[k])):
            rows = slice(region.gradients_begin[k], region.gradients_begin[k + 1])
            numpy.testing.assert_allclose(region.gradient[rows].sum(axis=0), vector, atol=1e-12)
            assert (numpy.diff(region.vertex[rows].astype(int)) > 0).all()
            facets = region.facet[region.facets_begin[k]:region.facets_begin[k + 1]]
            assert len(facets) > 0 and (numpy.diff(facets.astype(int)) > 0).all()
        of_patch = patches.points.patch == k
        assert of_patch.sum() <= 4
        numpy.testing.assert_allclose(patches.points.force[of_patch].sum(axis=0), -patches.area_vector_a[k], atol=1e-10)
    volume = patches.total_volume
    step = 1e-5
    rng = numpy.random.default_rng(8)
    for side, surface, region in ((0, a, patches.a), (1, b, patches.b)):
        gradient = numpy.zeros_like(positions[side])
        numpy.add.at(gradient, region.vertex, region.gradient)
        for _ in range(3):
            direction = rng.standard_normal(gradient.shape)
            found = []
            for sign in (-1, 1):
                surface.update(positions[side] + sign * step * direction)
                query.run(a, b)
                found.append(query.patches().total_volume)
            expected = (gradient * direction).sum()
            assert abs((found[1] - found[0]) / (2 * step) - expected) < 1e-5 + 1e-4 * abs(expected)
        surface.update(positions[side])
    query.run(a, b)
    assert query.patches().total_volume == volume and set(query.patches().id) == set(patches.id)


def test_points_are_as_many_as_asked(rough):
    surfaces, _ = rough
    for max_points in (0, 1, 3):
        query = morula.LayerPatchQuery(thickness=H, max_points=max_points)
        query.run(*surfaces)
        patches = query.patches()
        counts = numpy.bincount(patches.points.patch, minlength=len(patches))
        assert counts.max() <= max_points and (max_points == 0 or counts.min() > 0)


@pytest.mark.parametrize("workers", [None, 2])
def test_a_budget_ends_a_run_which_goes_on(rough, workers):
    surfaces, _ = rough
    threads = morula.Workers(workers) if workers else None
    whole = morula.LayerPatchQuery(thickness=H)
    whole.run(*surfaces)
    query = morula.LayerPatchQuery(thickness=H, budget=40)
    status = query.run(*surfaces, threads)
    assert not status.finished and len(query.open()) > 0
    assert query.patches().total_volume < whole.patches().total_volume
    calls = 1
    while not status.finished:
        status = query.resume(threads)
        calls += 1
    assert calls > 2 and query.open() == []
    assert query.patches() == whole.patches()
    query.set_budget(None)
    assert query.run(*surfaces).finished and query.patches().total_volume == whole.patches().total_volume


def test_a_folded_sheet_has_a_patch_with_itself():
    mesh = sheet(1, 8)
    surface = morula.SurfaceTree(mesh)
    folded = numpy.array(mesh.positions)
    right = folded[:, 0] > 0
    folded[right, 0] *= -1
    folded[right, 2] = 0.05
    query = morula.LayerPatchQuery(thickness=H, rest_distance=2 * H)
    assert query.run(surface).finished and len(query.patches()) == 0, "neighbors at rest are left out"
    surface.update(folded)
    query.run(surface)
    patches = query.patches()
    assert len(patches) == 1 and abs(patches.depth[0] - 0.05) < 1e-10
    assert numpy.abs(patches.area_vector_a + patches.area_vector_b).max() < 1e-12
    assert abs(abs(patches.normal[0][2]) - 1) < 0.05
    # More rings than there are edges leave nothing.
    rings = morula.LayerPatchQuery(thickness=H, rings=20)
    rings.run(surface)
    assert len(rings.patches()) == 0
    none = morula.LayerPatchQuery(thickness=H, rest_distance=2 * H, accepts=lambda kind, i, j: False)
    none.run(surface)
    assert len(none.patches()) == 0
    ones = numpy.ones(len(surface.facets), int)
    apart = morula.LayerPatchQuery(thickness=H, rest_distance=2 * H, masks_a=(ones, 0 * ones))
    apart.run(surface)
    assert len(apart.patches()) == 0


def test_what_is_refused():
    a, b = surfaces_at(0.05, 0)
    for wrong in (
        {"thickness": 0.0}, {"thickness": -1.0}, {"thickness": numpy.nan}, {"thickness": numpy.inf},
        {"thickness": H, "max_points": 17}, {"thickness": H, "budget": -1},
    ):
        with pytest.raises(ValueError):
            morula.LayerPatchQuery(**wrong)
    with pytest.raises(TypeError):
        morula.LayerPatchQuery()
    with pytest.raises(ValueError):
        morula.LayerPatchQuery(thickness=H).resume()
    failing = morula.LayerPatchQuery(thickness=H, accepts=lambda kind, i, j: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        failing.run(a, b)
    with pytest.raises(ValueError):
        failing.resume()
    masks = morula.LayerPatchQuery(thickness=H, masks_a=(numpy.ones(5, int), numpy.ones(5, int)))
    with pytest.raises(ValueError):
        masks.run(a, b)
    assert len(morula.LayerPatchQuery(thickness=H).patches()) == 0
