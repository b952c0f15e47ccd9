# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of trees, covers and generators."""
from __future__ import annotations

import morula
import numpy as np
from bodies import limb, model, picture
from draw import (Picture, View, balls, children, colored_regions, corners_of, cut_circles, figure, reach, rows_of_tree, section,
                  shape, solids, tilted)

TILT = tilted(-18, 22)


def loose_text(mesh, spheres, positions=None):
    return figure(float(f"{morula.looseness(mesh, spheres, positions, resolution=160).looseness:.2g}"))


@picture("levels.svg")
def levels():
    mesh, built = limb(), model()
    page = Picture(462)
    for level in range(4):
        x, y = 360 * (level % 2), (0, 228)[level // 2]
        spheres = built.tree.level_set_spheres(level)
        view = View(x, y, 360, 240, reach(built.tree.spheres[:1]) if level == 0 else reach(built.tree.level_set_spheres(1)), **TILT)
        solids(page, view, (mesh.positions, mesh.facets, "surface"))
        balls(page, view, spheres, style="o" if level > 1 else "b")
        page.text(x + 180, y + (264, 222)[level // 2], f"{len(spheres)} sphere{'s' * (level > 0)}, looseness {loose_text(mesh, spheres)}", size=22)
    return page


def owners(tree, cover):
    """Leaf of every patch."""
    leaf = np.zeros(cover.patch_count, int)
    for node in range(tree.node_count):
        if tree.is_leaf(node):
            leaf[cover.region_begin[node]:cover.region_end[node]] = node
    return leaf


def plane_of(corners):
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    return normal / np.linalg.norm(normal)


def area(polygon):
    return 0.5 * sum(np.linalg.norm(np.cross(polygon[j] - polygon[0], polygon[j + 1] - polygon[0])) for j in range(1, len(polygon) - 1))


def coarse():
    """A limb of few facets, so that each is shared by several leaves."""
    return morula.sample_body("limb", 8), model("limb", 8, depth=2, method="grid")


def patch_polygon(cover, corners, patch):
    return corners[cover.corners[cover.corner_begin[patch]:cover.corner_begin[patch + 1]]]


def best_shared_facet(mesh, built, count):
    """The facet of so many leaves whose smallest patch is largest: its patches are seen best."""
    cover, leaf, corners = built.cover, owners(built.tree, built.cover), corners_of(built.cover, mesh.positions)
    best = (0.0, None, None)
    for facet in range(cover.facet_count):
        patches = np.flatnonzero(cover.patch_facet == facet)
        if len(patches) == count == len(set(leaf[patches])):
            best = max(best, (min(area(patch_polygon(cover, corners, p)) for p in patches), facet, tuple(patches)), key=lambda item: item[0])
    return best[1], best[2], leaf, corners


@picture("patch.svg")
def patch():
    mesh, built = coarse()
    facet, patches, leaf, corners = best_shared_facet(mesh, built, 3)
    triangle = mesh.positions[mesh.facets[facet]]
    normal = plane_of(triangle)
    longest = max(range(3), key=lambda k: np.linalg.norm(triangle[(k + 1) % 3] - triangle[k]))
    right = triangle[(longest + 1) % 3] - triangle[longest]
    page = Picture(400)
    facing = normal[2] > 0
    whole = View(0, 10, 340, 330, mesh.positions, right=(1 if facing else -1, 0, 0), up=(0, 0.93, 0.36 if facing else -0.36))
    solids(page, whole, (mesh.positions, mesh.facets, ["contact" if f == facet else "surface" for f in range(mesh.facet_count)]))
    view = View(360, 20, 350, 320, triangle, right=right, up=np.cross(normal, right), margin=12)
    green = max(patches, key=lambda p: area(patch_polygon(built.cover, corners, p)))
    for p in patches:
        page.line(view(patch_polygon(built.cover, corners, p)), "proof" if p == green else "surface", "full" if p == green else "", close=True, fill=True)
    page.line(view(triangle), "contact", "bold", close=True)
    for c in sorted(set(int(c) for p in patches for c in built.cover.corners[built.cover.corner_begin[p]:built.cover.corner_begin[p + 1]])):
        (x, y), = view(corners[c])
        page.circle(x, y, 7, "ink" if c < mesh.vertex_count else "plate", "f")
        page.circle(x, y, 7, "ink")
    page.text(170, 385, "one facet of a body")
    page.text(535, 385, f"its {len(patches)} patches, one in green")
    return page


@picture("cut.svg")
def cut():
    mesh, built = coarse()
    facet, patches, leaf, corners = best_shared_facet(mesh, built, 2)
    triangle = mesh.positions[mesh.facets[facet]]
    normal = plane_of(triangle)
    circles, hit = cut_circles(built.tree.spheres[leaf[list(patches)]], triangle[0], normal)
    right = circles[1, :3] - circles[0, :3]
    view = View(0, 0, 720, 440, np.concatenate([triangle, in_plane(circles, normal)]), right=right, up=np.cross(normal, right), margin=10)
    page = Picture(490)
    for k, kind in enumerate(("proof", "sphere_b")):
        page.line(view(patch_polygon(built.cover, corners, patches[k])), kind, "full", close=True, fill=True)
        for circle in circles[hit == k]:
            balls(page, view, circle[None], kind, "dash" if k else "", "s")
    for k in range(2):
        for x, y in view(patch_polygon(built.cover, corners, patches[k])):
            page.dot(x, y, "ink", 7)
    page.text(360, 474, "two leaves share a facet: each keeps a patch")
    return page


def in_plane(circles, normal):
    """Points around circles of a plane."""
    a = np.cross(normal, (1, 0, 0) if abs(normal[0]) < 0.9 else (0, 1, 0))
    a /= np.linalg.norm(a)
    b = np.cross(normal, a)
    turns = np.linspace(0, 2 * np.pi, 16, endpoint=False)
    ring = np.cos(turns)[:, None] * a + np.sin(turns)[:, None] * b
    return (circles[:, None, :3] + circles[:, 3, None, None] * ring).reshape(-1, 3)


@picture("region.svg")
def region():
    mesh, built = limb(16), model(resolution=16, depth=2)
    tree, cover = built.tree, built.cover
    node = max(children(tree, 0), key=lambda n: tree.spheres[n, 0])
    node = sorted(children(tree, 0), key=lambda n: tree.spheres[n, 0])[2]
    page = Picture(620)
    colors = ["proof", "sphere", "contact", "sphere_b", "other", "bare"]
    below = list(children(tree, node))
    for k, (title, kinds) in enumerate((("a node: its sphere and its region, in green", {node: "proof"}),
                                        ("the regions of its children share it out", {n: colors[i % 6] for i, n in enumerate(below)}))):
        view = View(0, 310 * k, 720, 264, mesh.positions, **tilted(-12, 24), margin=10)
        solids(page, view, colored_regions(cover, mesh.positions, mesh.facets, kinds))
        if k == 0:
            balls(page, view, tree.spheres[[node]], "sphere", "bold hollow")
        page.text(360, 310 * k + 296, title)
    return page


@picture("proof.svg")
def proof():
    mesh, built = coarse()
    facet, patches, leaf, corners = best_shared_facet(mesh, built, 3)
    pose = morula.deform(mesh, morula.Stretch(1.5), morula.Bend(70))
    body = morula.Body(mesh, built)
    p = max(patches, key=lambda q: area(patch_polygon(built.cover, corners, q)))
    page = Picture(440)
    for k, positions in enumerate((mesh.positions, pose)):
        body.update(np.ascontiguousarray(positions))
        assert body.certify(positions).covered
        triangle = positions[mesh.facets[facet]]
        normal = plane_of(triangle)
        circles, _ = cut_circles(np.array([body.sphere(int(leaf[p]))]), triangle[0], normal)
        view = View(360 * k, 10, 360, 370, np.concatenate([triangle, in_plane(circles, normal)]), right=triangle[1] - triangle[0], up=np.cross(normal, triangle[1] - triangle[0]), margin=14)
        polygon = view(patch_polygon(built.cover, corners_of(built.cover, positions), p))
        page.line(view(triangle), "surface", close=True, fill=True)
        page.line(polygon, "proof", "full", close=True, fill=True)
        balls(page, view, circles, "sphere", "bold", "s")
        (cx, cy), = view(circles[0, :3])
        for point in polygon:
            page.line([(cx, cy), point], "sphere", "thin dash")
            page.dot(*point, "ink", 7)
        page.text(360 * k + 180, 424, ("at rest", "moved: corners inside")[k])
    return page


@picture("nested.svg")
def nested():
    mesh = limb()
    page = Picture(560)
    origin, normal = np.zeros(3), np.array([0, 0, 1.0])
    looser = morula.build(mesh, branching=8, depth=2, nested=True)
    loops, _ = section(mesh.positions, mesh.facets, origin, normal)
    edge = np.concatenate([mesh.positions, in_plane(cut_circles(looser.tree.level(1), origin, normal)[0], normal)])
    for k, built in enumerate((model(depth=2), looser)):
        view = View(0, 280 * k, 720, 240, edge, margin=6)
        shape(page, view, loops)
        node = sorted(children(built.tree, 0), key=lambda n: built.tree.spheres[n, 0])[2]
        balls(page, view, cut_circles(np.delete(built.tree.level(1), node - 1, axis=0), origin, normal)[0], "muted", "thin", "s")
        balls(page, view, cut_circles(built.tree.spheres[list(children(built.tree, node))], origin, normal)[0], "sphere")
        balls(page, view, cut_circles(built.tree.spheres[[node]], origin, normal)[0], "sphere_b", "bold", "s")
        page.text(360, 280 * k + 268, f"{('parents wrap: looseness', 'nested parents contain: looseness')[k]} {loose_text(mesh, built.tree.level(1))}")
    return page


@picture("generators.svg")
def generators():
    mesh = limb()
    page = Picture(4 * 216)
    for k, method in enumerate(morula.all_methods()):
        x, y = 360 * (k % 2), 216 * (k // 2)
        spheres = model(method=method, branching=16, depth=1).tree.level(1)
        view = View(x, y, 360, 180, mesh.positions * 1.2, **TILT)
        solids(page, view, (mesh.positions, mesh.facets, "surface"))
        balls(page, view, spheres)
        page.text(x + 180, y + 200, f"{method}: looseness {loose_text(mesh, spheres)}", size=22)
        assert len(spheres) == 16
    page.text(540, 3 * 216 + 110, "16 spheres each", "muted")
    return page


def cut_by_protrusion(tree, bound, share):
    """The nodes where a walk from the root stops: spheres that stick out by no more than share, and leaves."""
    stop, opened, todo = [], [], [0]
    while todo:
        node = todo.pop()
        if tree.is_leaf(node) or bound(node) <= share:
            stop.append(node)
        else:
            opened.append(node)
            todo += children(tree, node)
    return sorted(stop), sorted(opened)


@picture("tree_cut.svg")
def tree_cut():
    mesh, built = limb(), model(branching=4)
    tree = built.tree
    distance = morula.SignedDistance(mesh)
    page = Picture(640)
    for k, share in enumerate((0.3, 0.1)):
        y = 320 * k
        stop, opened = cut_by_protrusion(tree, lambda n: distance.protrusion_bound(tuple(tree.spheres[n])), share)
        view = View(0, y, 400, 270, reach(tree.level(1)), **TILT)
        solids(page, view, (mesh.positions, mesh.facets, "surface"))
        balls(page, view, tree.spheres[stop])
        chosen, above = set(stop), set(opened)
        rows_of_tree(page, tree, 415, y + 40, 295, 40, lambda n: "f-sphere" if n in chosen else "b-contact" if n in above else "b-muted thin", 10)
        page.text(360, y + 300, f"a cut of {len(stop)} spheres: protrusion {share:g} at most")
    return page


@picture("rounding.svg")
def rounding():
    """At rest a body of this rule has the spheres of the tree, narrowed to float."""
    mesh, built = limb(), model()
    tree, narrow = built.tree, morula.Body(mesh, built, rules="approach1").copy_spheres()
    move = np.linalg.norm(narrow[:, :3] - tree.spheres[:, :3], axis=1)
    near = narrow[:, 3] - move - tree.spheres[:, 3]  # how far the new border is outside the old one where the center moved away from it
    assert near.min() >= 0
    node = int(np.argmax(np.where(near < 0.5 * move, near, 0)))
    near, far = near[node], near[node] + 2 * move[node]
    page = Picture(360)
    scale = 52 / move[node]
    for x, title in ((120, "border"), (360, "center"), (600, "border")):
        page.circle(x, 170, 110, "muted", "s", "thin")
        page.text(x, 36, title)
    page.line([(75, 170), (645, 170)], "muted", "thin dash")
    for x, gap, out in ((120, near, -1), (600, far, 1)):
        start = x - 60 if gap == far else x + 20
        for at, kind, extra in ((start, "surface", "bold dash"), (start + out * gap * scale, "sphere", "bold")):
            page.line([(at, 85), (at, 255)], kind, extra)
    for at, kind, dy in ((360, "surface", 44), (360 + 52, "sphere", -28)):
        for d in ((11, 0), (0, 11)):
            page.line([(at - d[0], 170 - d[1]), (at + d[0], 170 + d[1])], kind, "bold")
    page.text(290, 318, "double", "surface", "end")
    page.line([(300, 310), (350, 310)], "surface", "bold dash")
    page.text(430, 318, "float", "sphere", "start")
    page.line([(370, 310), (420, 310)], "sphere", "bold")
    page.text(360, 352, f"the longest gap is {far:.1e} mesh units".replace("e-07", " · 10⁻⁷"), "muted", size=22)
    return page


@picture("medial.svg")
def medial():
    mesh = limb(32)
    found = morula.inner_ball_candidates(mesh, morula.SignedDistance(mesh), candidates=1500)
    page = Picture(560)
    origin, normal = np.zeros(3), np.array([0, 0, 1.0])
    loops, _ = section(mesh.positions, mesh.facets, origin, normal)
    for k, count in enumerate((120, 16)):
        view = View(0, 280 * k, 720, 236, mesh.positions)
        shape(page, view, loops)
        balls(page, view, cut_circles(morula.fullest_balls(found, count), origin, normal)[0], "proof", "thin" if k == 0 else "", "b")
        page.text(360, 280 * k + 268, f"the {count} inscribed balls that fill most")
    return page
