# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Contact patches of boxes, whose overlap is known, and of bodies without an inside."""

import numpy
import pytest

import morula


def box_collider():
    hull = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    box = morula.Mesh(hull.vertices, hull.facets)
    return morula.Collider(morula.Body(box, morula.build(box, method="octree", depth=2)))


def test_the_patch_of_two_boxes_is_a_box():
    a, b = box_collider(), box_collider()
    query = morula.ContactPatchQuery(a, b)
    a.set_transform((0.5, 0.25, 0.9))
    patches = query.run()
    assert len(patches) == 1 and patches.certified
    assert abs(patches.volume[0] - 0.5 * 0.75 * 0.1) < 1e-14 and patches.total_volume == patches.volume[0]
    numpy.testing.assert_allclose(patches.centroid[0], (0.75, 0.625, 0.95), atol=1e-14)
    numpy.testing.assert_allclose(patches.area_vector_a, -patches.area_vector_b, atol=1e-14)
    region = patches.a
    assert region.facets_begin == [0, len(region.facet)] and region.gradients_begin == [0, len(region.vertex)]
    numpy.testing.assert_allclose(region.gradient.sum(axis=0), patches.area_vector_a[0], atol=1e-14)
    numpy.testing.assert_allclose(region.area_vector.sum(axis=0), patches.area_vector_a[0], atol=1e-14)
    points = patches.points
    assert len(points) == 4 and list(points.patch) == [0] * 4 and sorted(points.id) == [0, 1, 2, 3]
    numpy.testing.assert_allclose(points.force.sum(axis=0), -patches.area_vector_a[0], atol=1e-14)
    assert abs(points.volume.sum() - patches.volume[0]) < 1e-13
    identity = patches.id[0]
    a.set_transform((0.5, 0.2, 0.9))
    assert query.run(max_points=0, depths=False).id[0] == identity
    assert len(query.run(max_points=3).points) == 3
    assert len(patches.points) == 4, "results stay when the query runs again"
    a.set_transform((0.5, 0.2, 1.1))
    assert len(query.run()) == 0


def test_a_budget_leaves_all_patches_or_contacts():
    a, b = box_collider(), box_collider()
    query = morula.ContactPatchQuery(a, b)
    a.set_transform((0.5, 0.25, 0.9))
    complete = query.run(budget=1000000)
    assert complete.is_finished and len(complete.contacts) == 0 and len(complete) == 1
    left = query.run(budget=1)
    assert not left.is_finished and len(left) == 0 and left.total_volume == 0
    assert len(left.contacts) > 0 and not left.contacts.finished.all()
    center = numpy.array((0.75, 0.625, 0.95))
    assert (numpy.linalg.norm(left.contacts.point - center, axis=1) <= left.contacts.error_bound).any()
    assert query.run(budget="10s").is_finished and query.run().id[0] == complete.id[0]
    with pytest.raises(ValueError):
        query.run(budget=-1)
def test_the_patch_of_a_body_with_itself_is_that_of_its_parts():
    hull = morula.ConvexHull.box((0, 0, 0), (1, 1, 1))
    mesh = morula.Mesh(
        numpy.concatenate([hull.vertices, hull.vertices + (0.5, 0.25, 0.9)]),
        numpy.concatenate([hull.facets, hull.facets + len(hull.vertices)]),
    )
    body = morula.Body(mesh, morula.build(mesh, method="octree", depth=2))
    query = morula.ContactPatchQuery(body)
    patches = query.run()
    assert len(patches) == 1 and abs(patches.volume[0] - 0.5 * 0.75 * 0.1) < 1e-14
    numpy.testing.assert_allclose(patches.centroid[0], (0.75, 0.625, 0.95), atol=1e-14)
    assert set(patches.a.vertex) <= set(range(len(hull.vertices)))
    assert set(patches.b.vertex).isdisjoint(range(len(hull.vertices)))
    moved = mesh.positions.copy()
    moved[len(hull.vertices):] += (0, 0, 1)
    body.update(moved)
    assert len(query.run()) == 0
    with pytest.raises(ValueError, match="the body is not closed"):
        plate = morula.Mesh(numpy.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float), numpy.array([(0, 1, 2)]))
        morula.ContactPatchQuery(morula.Body(plate, morula.build(plate, method="octree", depth=1)))


def test_bodies_without_an_inside_are_refused_by_name():
    plate = morula.Mesh(numpy.array([(0, 0, 0), (1, 0, 0), (0, 1, 0)], float), numpy.array([(0, 1, 2)]))
    open_body = morula.Collider(morula.Body(plate, morula.build(plate, method="octree", depth=1)))
    with pytest.raises(ValueError, match="second body is not closed"):
        morula.ContactPatchQuery(box_collider(), open_body)
    query = morula.ContactPatchQuery(box_collider(), box_collider())
    with pytest.raises(ValueError):
        query.run(max_points=17)
