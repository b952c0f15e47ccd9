# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of bodies in motion: rules, modes, skins, lazy and partial updates, rebuilding, and what is measured."""
from __future__ import annotations

import morula
import numpy as np
from bodies import bent, limb, model, picture
from draw import (Picture, View, balls, children, cut_circles, figure, number, reach, rows_of_tree, section, shape, solids, tilted)

UP = np.array([0, 0, 1.0])
ORIGIN = np.zeros(3)


def two_digits(x):
    return figure(float(f"{x:.2g}"))


def bones_of(positions):
    """Weights of three bones along x, and transforms that bend the outer ones by 45 degrees each."""
    x = positions[:, 0]
    left = np.clip((0.1 - x) / 1.2, 0, 1)
    right = np.clip((x - 0.1) / 1.2, 0, 1)
    weights = np.column_stack([left, 1 - left - right, right])
    transforms = []
    for at, angle in ((-0.5, -40), (0.0, 0), (0.7, 40)):
        a = np.radians(angle)
        turn = np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])
        pivot = np.array([at, -0.2, 0])
        transforms.append(np.column_stack([turn, pivot - turn @ pivot]))
    return weights, np.array(transforms)


def outline(page, view, loops, circles):
    """The surface's section, and over it, bold, what is in no sphere."""
    shape(page, view, loops)
    for loop in loops:
        closed = np.vstack([loop, loop[:1]])
        for p, q in zip(closed, closed[1:]):
            points = p + np.linspace(0, 1, 9)[:, None] * (q - p)
            bare = (np.linalg.norm(points[:, None] - circles[None, :, :3], axis=2) > circles[None, :, 3] + 1e-7).all(1)
            for k in np.flatnonzero(bare[:-1] & bare[1:]):
                page.line(view(points[k:k + 2]), "bare", "bold")


@picture("update_rules.svg")
def update_rules():
    mesh, built = limb(32), model(resolution=32, branching=10, depth=2)
    weights, transforms = bones_of(mesh.positions)
    skin = morula.Skin(weights)
    pose = morula.move_by_skin(skin, mesh.positions, transforms)
    modes = morula.Modes((pose - mesh.positions)[None])
    loops, _ = section(pose, mesh.facets, ORIGIN, UP)
    page = Picture(4 * 262)
    for k, rule in enumerate(morula.all_rules()):
        body = morula.Body(mesh, built, rules=rule, modes=modes, skin=skin) if rule in ("modal", "skinned") else morula.Body(mesh, built, rules=rule)
        if rule == "modal":
            body.update_modal(np.ones(1))
        elif rule == "skinned":
            body.update_skinned(transforms)
        else:
            body.update(pose)
        spheres = body.copy_spheres()[built.tree.level_set(1)]
        cover = morula.coverage(mesh, spheres, pose)
        x, y = 360 * (k % 2), 262 * (k // 2)
        view = View(x, y, 360, 196, pose * [1.22, 1.22, 1])
        circles, _ = cut_circles(spheres, ORIGIN, UP)
        balls(page, view, circles, "sphere", "")
        outline(page, view, loops, circles)
        loose = morula.looseness(mesh, spheres, pose, resolution=160).looseness
        bare = "covers" if cover.covered else f"uncovered {two_digits(100 * cover.uncovered_area)} %"
        page.text(x + 180, y + 216, f"{rule}: looseness {two_digits(loose)}", size=22)
        page.text(x + 180, y + 244, bare, "ink" if cover.covered else "bare", size=22)
    return page


@picture("deform.svg")
def deform():
    mesh = limb(18)
    page = Picture(3 * 200)
    kinds = (("stretch", morula.Stretch(1.6)), ("twist", morula.Twist(180)), ("bend", morula.Bend(90)), ("poke", morula.Poke((0.25, 0.6, 1.0), (0, 0, -0.2), 0.16)),
             ("noise", morula.Noise(0.06, 0.12)), ("rotate", morula.Rotate(30, "z")))
    for k, (name, how) in enumerate(kinds):
        x, y = 360 * (k % 2), 200 * (k // 2)
        view = View(x, y, 360, 165, np.concatenate([[[-3.9, -1.5, 0], [3.6, 1.5, 0]]]), **(tilted(-10, 50) if name == "poke" else {}))
        solids(page, view, (morula.deform(mesh, how), mesh.facets, "surface"))
        page.text(x + 180, y + 186, name)
    return page


@picture("modal.svg")
def modal():
    mesh, built = limb(32), model(resolution=32, branching=8, depth=1)
    modes = morula.sample_modes(mesh.positions, 4)
    frames = morula.sample_coordinates(4, 9)
    worst = max(frames, key=lambda q: float(np.abs(q).sum()))
    page = Picture(620)
    for k, q in enumerate((np.zeros(4), worst)):
        pose = morula.move_by_modes(modes, mesh.positions, q)
        loops, _ = section(pose, mesh.facets, ORIGIN, UP)
        y = 300 * k
        spheres = {}
        for name, options in (("shift", {"rules": "modal", "modal_bound": "shift"}), ("gradient", {"rules": "modal"}), ("exact", {"rules": "exact"})):
            body = morula.Body(mesh, built, modes=modes, **options)
            body.update_modal(q)
            assert body.certify(pose).covered
            spheres[name] = body.copy_spheres()[built.tree.level_set(1)]
        if k == 0:
            box = None
        view = View(0, y, 720, 262, np.concatenate([reach(cut_circles(spheres["gradient"], ORIGIN, UP)[0]), [[-3, -1.2, 0], [3, 1.2, 0]]]), margin=10)
        shape(page, view, loops)
        for name, kind, extra in (("shift", "sphere_b", "dash"), ("gradient", "sphere", ""), ("exact", "muted", "thin")):
            if k or name == "gradient":
                balls(page, view, cut_circles(spheres[name], ORIGIN, UP)[0], kind, extra, "s")
        page.text(360, y + 292, ("rest: all coordinates 0", "")[k])
    x = 40
    for name, kind, extra in (("exact", "muted", "thin"), ("modal, gradient", "sphere", ""), ("modal, shift", "sphere_b", "dash")):
        page.line([(x, 596), (x + 36, 596)], kind, extra)
        page.text(x + 46, 604, name, kind, "start", size=22)
        x += 46 + 12 * len(name) + 40
    return page


@picture("skinned.svg")
def skinned():
    mesh, built = limb(32), model(resolution=32, branching=10, depth=1)
    weights, transforms = bones_of(mesh.positions)
    skin = morula.Skin(weights)
    names = ["other", "surface", "contact"]
    of_facet = [names[int(np.argmax(weights[f].mean(0)))] for f in mesh.facets]
    pose = morula.move_by_skin(skin, mesh.positions, transforms)
    page = Picture(600)
    view = View(0, 0, 720, 230, mesh.positions, margin=10)
    solids(page, view, (mesh.positions, mesh.facets, of_facet))
    page.text(360, 262, "three bones: each facet in the color of its heaviest")
    loose, spheres = {}, {}
    for rule in ("exact", "skinned"):
        body = morula.Body(mesh, built, rules=rule, skin=skin)
        body.update_skinned(transforms)
        assert body.certify(pose).covered
        spheres[rule] = body.copy_spheres()[built.tree.level_set(1)]
        loose[rule] = two_digits(morula.looseness(mesh, spheres[rule], pose, resolution=160).looseness)
    loops, _ = section(pose, mesh.facets, ORIGIN, UP)
    circles, _ = cut_circles(spheres["skinned"], ORIGIN, UP)
    view = View(0, 280, 720, 270, np.concatenate([reach(circles), pose]), margin=10)
    balls(page, view, circles, "sphere", "")
    outline(page, view, loops, circles)
    page.text(360, 586, f"skinned leaves cover; looseness {loose['skinned']} (exact: {loose['exact']})")
    return page


def spheres_by_center(mesh, built, weights, transforms, level):
    """Leaves moved by the mean weights of their region's vertices alone, with the radii of rest."""
    tree, cover = built.tree, built.cover
    nodes = tree.level_set(level)
    moved = np.array(built.spheres[nodes], float)
    for sphere, node in zip(moved, nodes):
        first, last = cover.corner_begin[[cover.region_begin[node], cover.region_end[node]]]
        corners = np.unique(cover.corners[first:last])
        mean = np.tensordot(weights[corners[corners < mesh.vertex_count]].mean(0), transforms, 1)
        sphere[:3] = mean[:, :3] @ sphere[:3] + mean[:, 3]
    return moved


@picture("skinned_cover.svg")
def skinned_cover():
    mesh, built = limb(32), model(resolution=32, branching=10, depth=1)
    weights, transforms = bones_of(mesh.positions)
    skin = morula.Skin(weights)
    pose = morula.move_by_skin(skin, mesh.positions, transforms)
    body = morula.Body(mesh, built, rules="skinned", skin=skin)
    body.update_skinned(transforms)
    assert body.certify(pose).covered
    by_center = spheres_by_center(mesh, built, weights, transforms, 1)
    uncovered = morula.coverage(mesh, by_center, pose)
    assert not uncovered.covered
    loops, _ = section(pose, mesh.facets, ORIGIN, UP)
    page = Picture(600)
    for y, spheres, kind, words in ((0, by_center, "bare", f"moved by mean weights alone: {two_digits(100 * uncovered.uncovered_area)} % uncovered"),
                                    (300, body.copy_spheres()[built.tree.level_set(1)], "sphere", "skinned: radii pay for the spread of weights, and cover")):
        circles, _ = cut_circles(spheres, ORIGIN, UP)
        view = View(0, y, 720, 250, pose * [1.22, 1.3, 1], margin=10)
        balls(page, view, circles, kind, "")
        outline(page, view, loops, circles)
        page.text(360, y + 282, words, "bare" if kind == "bare" else "ink", size=22)
    return page


@picture("lazy.svg")
def lazy():
    mesh, built = limb(), model(branching=4)
    tool = morula.sample_body("tool", 16)
    steel = morula.Collider(morula.Body(tool, morula.build(tool, branching=4, depth=3)))
    steel.set_transform((2.3, 1.15, 0.0))
    pose = bent(24, 40)
    body = morula.Body(mesh, built)
    body.update_lazily(pose, 1)
    tree = built.tree
    before = [n for n in range(tree.node_count) if body.is_fresh(n)]
    morula.collide(morula.Collider(body), steel, refresh_children=True)
    after = [n for n in range(tree.node_count) if body.is_fresh(n)]
    page = Picture(700)
    placed = np.asarray(steel.vertices())
    last = {n for n in after if not any(c in set(after) for c in children(tree, n))}
    view = View(0, 0, 720, 380, np.concatenate([pose, placed]), margin=14)
    solids(page, view, (pose, mesh.facets, "surface"), (placed, tool.facets, "other"))
    spheres = body.copy_spheres()
    balls(page, view, spheres[sorted(last)], "proof", "faint")
    rows_of_tree(page, tree, 20, 410, 680, 44, lambda n: "f-proof" if n in set(after) else "b-muted thin", 10)
    page.text(360, 668, f"green: {len(after)} of {tree.node_count} spheres, brought up to date", size=22)
    assert len(before) < len(after) < tree.node_count
    return page


@picture("partial.svg")
def partial():
    mesh, built = limb(), model(branching=4)
    order = morula.leaf_order(built)
    mesh, built = morula.renumbered(built, mesh, order)
    pose = morula.deform(mesh, morula.Poke((0.8, 0.6, 1.0), (0, 0, -0.08), 0.1))
    touched = np.flatnonzero((pose != mesh.positions).any(1))
    ends = np.flatnonzero(np.diff(touched) > 8)
    ranges = [(int(a), int(b) + 1) for a, b in zip(touched[np.r_[0, ends + 1]], touched[np.r_[ends, -1]])]
    body, whole = morula.Body(mesh, built), morula.Body(mesh, built)
    body.update(mesh.positions), whole.update(mesh.positions)
    at_rest = body.copy_spheres()
    part, full = body.update(pose, ranges), whole.update(pose)
    assert body.hash() == whole.hash()
    changed = set(np.flatnonzero((body.copy_spheres() != at_rest).any(1)))
    tree = built.tree
    page = Picture(620)
    view = View(0, 0, 720, 300, mesh.positions, **tilted(-10, 30), margin=14)
    moved = set(touched.tolist())
    solids(page, view, (pose, mesh.facets, ["contact" if any(int(v) in moved for v in f) else "surface" for f in mesh.facets]))
    leaves = [n for n in range(tree.node_count) if tree.is_leaf(n)]
    balls(page, view, body.copy_spheres()[[n for n in leaves if n in changed]], "proof", "hollow")
    rows_of_tree(page, tree, 20, 330, 680, 44, lambda n: "f-proof" if n in changed else "b-muted thin", 10)
    page.text(360, 580, f"{len(touched)} of {mesh.vertex_count} vertices moved; {len(changed)} spheres, green, changed", size=22)
    page.text(360, 608, f"{part.points_tested} points tested, {full.points_tested} by a full update", "muted", size=22)
    return page


@picture("rebuild.svg")
def rebuild():
    mesh, built = limb(32), model(resolution=32, branching=8, depth=2)
    pose = morula.deform(mesh, morula.Stretch(2.0))
    body = morula.RebuiltBody(mesh, built, thread="caller", rebuild_every=2, quality="default", look_ahead=False)
    old = morula.Body(mesh, built)
    old.update(pose)
    for _ in range(200):
        body.update(pose)
        if body.report.swapped:
            break
    assert body.report.swapped
    page = Picture(560)
    loops, _ = section(pose, mesh.facets, ORIGIN, UP)
    for k, (spheres, words) in enumerate(((old.copy_spheres()[built.tree.level_set(2)], "the tree of rest"), (body.copy_spheres()[body.tree.level_set(2)], "rebuilt for this pose"))):
        assert morula.coverage(mesh, spheres, pose).covered
        circles, _ = cut_circles(spheres, ORIGIN, UP)
        view = View(0, 280 * k, 720, 234, np.concatenate([pose, reach(cut_circles(old.copy_spheres()[built.tree.level_set(2)], ORIGIN, UP)[0])]), margin=8)
        balls(page, view, circles, "sphere", "thin faint")
        shape(page, view, loops, style="b")
        loose = morula.looseness(mesh, spheres, pose, resolution=160).looseness
        page.text(360, 280 * k + 266, f"{words}: looseness {two_digits(loose)}")
    return page


@picture("looseness.svg")
def looseness():
    mesh, built = limb(32), model(resolution=32, branching=8, depth=2)
    loops, _ = section(mesh.positions, mesh.facets, ORIGIN, UP)
    page = Picture(560)
    for k, level in enumerate((1, 2)):
        spheres = built.tree.level_set_spheres(level)
        circles, _ = cut_circles(spheres, ORIGIN, UP)
        view = View(0, 280 * k, 720, 236, reach(cut_circles(built.tree.level_set_spheres(1), ORIGIN, UP)[0]), margin=8)
        page.add('<g opacity=".55">')
        balls(page, view, circles, "contact", style="f")
        page.add("</g>")
        shape(page, view, loops, "plate", style="f")
        shape(page, view, loops, "surface", "full", style="b")
        found = morula.looseness(mesh, spheres, resolution=160)
        page.text(360, 280 * k + 268, f"orange {two_digits(found.outside_volume)} / gray {two_digits(found.object_volume)} = looseness {two_digits(found.looseness)}")
    return page


@picture("uncovered.svg")
def uncovered():
    mesh, built = limb(32), model(resolution=32, branching=6, depth=2)
    pose = bent(32, 90)
    body = morula.Body(mesh, built, rules="approach2")
    body.update(pose)
    spheres = body.copy_spheres()[built.tree.level_set(2)]
    cover = morula.coverage(mesh, spheres, pose)
    points = (pose[mesh.facets[cover.worst_facet]].T @ np.array([(i, j, 12 - i - j) for i in range(13) for j in range(13 - i)]).T / 12).T
    gaps = np.linalg.norm(points[:, None] - spheres[None, :, :3], axis=2) - spheres[None, :, 3]
    point = points[int(np.argmax(np.round(gaps.min(1), 9)))]
    nearest = spheres[int(np.argmin(gaps[int(np.argmax(np.round(gaps.min(1), 9)))]))]
    towards = nearest[:3] - point
    along = np.array([1, 0.35, 0]) * np.sign(point[0] or 1)
    normal = np.cross(along, towards)
    normal /= np.linalg.norm(normal)
    loops, _ = section(pose, mesh.facets, point, normal)
    circles, _ = cut_circles(spheres, point, normal)
    page = Picture(450)
    up = -towards
    frame = point + towards * 0.5 + np.outer((-1, 1), along / np.linalg.norm(along) * 0.75) + np.outer((-1, 1), up / np.linalg.norm(up) * 0.4)
    view = View(0, 0, 720, 400, frame, right=along, up=up, margin=0)
    page.add('<svg x="0" y="0" width="720" height="400">')
    balls(page, view, circles, "sphere", "faint")
    outline(page, view, loops, circles)
    page.line(view(np.array([point, point + towards * (1 - nearest[3] / np.linalg.norm(towards))])), "ink", "bold")
    page.add("</svg>")
    page.text(360, 434, f"uncovered: {two_digits(100 * cover.uncovered_area)} % of the area, at most {two_digits(cover.uncovered_distance)} away", "bare", size=22)
    return page
