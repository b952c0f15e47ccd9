# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures of what is asked of bodies: contacts, crossings, distances, steps, scenes."""
from __future__ import annotations

import functools

import morula
import numpy as np
from bodies import bent, limb, model, moved, moved_spheres, picture, turned
from draw import (Picture, View, balls, cut_circles, figure, number, path_of, reach, rows_of_tree, section, shape, solids, tilted)

UP = np.array([0, 0, 1.0])
ORIGIN = np.zeros(3)


def two_digits(x):
    return figure(float(f"{x:.2g}"))


@functools.cache
def crossed(depth=3, branching=4, height=0.95):
    """A limb, and another that lies across it."""
    mesh, built = limb(), model(branching=branching, depth=depth)
    a, b = morula.Collider(morula.Body(mesh, built)), morula.Collider(morula.Body(mesh, built))
    b.set_transform(turned(90, (0, 1, 0), (0.9, height, 0.0)))
    return mesh, built, a, b


@picture("front.svg")
def front():
    mesh, built, a, b = crossed()
    tree = built.tree
    page = Picture(3 * 236 + 40)
    everything = morula.collide(a, b)
    for k, budget in enumerate((20, 100, None)):
        query = morula.ContactQuery(budget=budget)
        query.add(a, b)
        found = query.start()
        cut = query.cut()
        opened = set()
        for node in [int(n) for n in cut.node_a]:
            while node:
                node = int(tree.parent[node])
                opened.add(node)
        waiting = {int(n) for n, s in zip(cut.node_a, cut.state) if s == int(morula.FrontPairState.waiting)}
        touching = {int(n) for n, s in zip(cut.node_a, cut.state) if s == int(morula.FrontPairState.finished)}
        y = 236 * k
        view = View(0, y, 340, 190, np.concatenate([mesh.positions, np.asarray(b.vertices())]), **tilted(-30, 35))
        solids(page, view, (mesh.positions, mesh.facets, "surface"), (np.asarray(b.vertices()), mesh.facets, "other"))
        nodes = sorted(touching | waiting)
        balls(page, view, tree.spheres[nodes], ["contact" if n in touching else "sphere" for n in nodes], "")
        rows_of_tree(page, tree, 360, y + 6, 350, 38, lambda n: "f-contact" if n in touching else "f-sphere" if n in waiting else "b-ink thin" if n in opened else "b-muted thin hollow", 9)
        page.text(360, y + 222, f"{found.pair_tests} tests: {int((cut.state == int(morula.FrontPairState.waiting)).sum())} pairs wait, {found.finished_count} contacts found", size=22)
    assert found.finished_count == everything.finished_count
    page.text(360, 3 * 236 + 22, "blue: pairs wait; orange: contacts; gray: opened", "muted", size=22)
    return page


def deepest_contact():
    mesh, built, a, b = crossed(depth=2, branching=8)
    contacts = morula.collide(a, b, surfaces=True)
    k = int(np.argmax(np.round(contacts.surfaces.depth, 9)))
    return mesh, built, a, b, contacts, k


@picture("contact.svg")
def contact():
    mesh, built, a, b, contacts, k = deepest_contact()
    one = np.array(built.tree.spheres[int(contacts.node_a[k])])[None]
    two = moved_spheres(b.transform, built.tree.spheres[[int(contacts.node_b[k])]])
    along = one[0, :3] - two[0, :3]
    right = np.cross(along, (0, 0, 1))
    normal = np.cross(right, along)
    normal /= np.linalg.norm(normal)
    page = Picture(560)
    view = View(0, 10, 720, 490, np.concatenate([reach(one), reach(two)]), right=right, up=along, margin=10)
    for positions, kind in ((mesh.positions, "surface"), (np.asarray(b.vertices()), "other")):
        loops, _ = section(positions, mesh.facets, contacts.point[k], normal)
        page.add('<svg x="0" y="0" width="720" height="500">')
        shape(page, view, loops, kind)
        page.add("</svg>")
    balls(page, view, one, "sphere", "bold", "s")
    balls(page, view, two, "sphere_b", "bold dash", "s")
    point, unit, depth = contacts.point[k], contacts.normal[k], float(contacts.depth[k])
    (x, y), = view(point)
    tip = view(point + unit * 0.55 * one[0, 3])[0]
    page.arrow((x, y), tip, "contact", "bold")
    page.dot(x, y, "contact", 8)
    page.text(tip[0] + 14, tip[1] + 8, "normal", "contact", "start")
    page.text(x + 16, y + 8, "point", "contact", "start")
    # The depth, beside the point, from border to border.
    low, high = view(np.array([one[0, :3] - unit * one[0, 3], two[0, :3] + unit * two[0, 3]]))
    for end in (low, high):
        page.line([(x - 90, end[1]), (x - 8, end[1])], "ink", "thin dash")
    page.line([(x - 70, low[1]), (x - 70, high[1])], "ink", "bold")
    page.text(x - 82, (low[1] + high[1]) / 2 + 8, "depth", "ink", "end")
    page.text(360, 542, f"two spheres of {len(contacts)} pairs that overlap, {two_digits(depth)} deep")
    return page


@picture("contact_surface.svg")
def contact_surface():
    mesh, built, a, b, contacts, k = deepest_contact()
    surfaces = contacts.surfaces
    p, q, unit, depth = surfaces.point_a[k], surfaces.point_b[k], surfaces.normal[k], float(surfaces.depth[k])
    right = np.cross(unit, (0, 0, 1))
    normal = np.cross(right, unit)
    normal /= np.linalg.norm(normal)
    page = Picture(440)
    middle = contacts.point[k]
    side = right / np.linalg.norm(right)
    view = View(0, 0, 720, 384, middle + np.array([-0.8 * side + 0.43 * unit, 0.8 * side - 0.43 * unit]), right=right, up=unit, margin=0)
    page.add('<svg x="0" y="0" width="720" height="384">')
    for positions, kind in ((mesh.positions, "surface"), (np.asarray(b.vertices()), "other")):
        loops, _ = section(positions, mesh.facets, middle, normal)
        shape(page, view, loops, kind)
    balls(page, view, cut_circles(built.tree.spheres[[int(contacts.node_a[k])]], middle, normal)[0], "sphere", "thin", "s")
    balls(page, view, cut_circles(moved_spheres(b.transform, built.tree.spheres[[int(contacts.node_b[k])]]), middle, normal)[0], "sphere_b", "thin dash", "s")
    page.add("</svg>")
    for point, words, dx in ((p, "point on a", -1), (q, "point on b", 1)):
        (x, y), = view(point)
        page.dot(x, y, "contact", 8)
        page.text(x + 16 * dx, y + 8, words, "contact", "end" if dx < 0 else "start")
    (x, y), = view(middle)
    start = view(middle + side * 0.35)[0]
    page.arrow(start, view(middle + side * 0.35 + unit * depth)[0], "ink", "bold")
    page.text(start[0] + 14, start[1] - 10, "depth", "ink", "start")
    page.text(360, 424, f"depth of surfaces {two_digits(depth)}, of spheres {two_digits(float(contacts.depth[k]))}")
    return page


@picture("contact_patch.svg")
def contact_patch():
    mesh, built, a, b = crossed(depth=3, branching=8)
    contacts = morula.collide(a, b, surfaces=True)
    placed = np.asarray(b.vertices())
    deep = contacts.surfaces.depth > 0
    page = Picture(610)
    for k, (positions, facets, kind, base) in enumerate(((mesh.positions, contacts.surfaces.facet_a, "surface", "a"), (placed, contacts.surfaces.facet_b, "other", "b"))):
        names = [kind] * mesh.facet_count
        for f in facets:
            names[int(f)] = "sphere"
        for f in facets[deep]:
            names[int(f)] = "contact"
        # Each body alone, seen from where the other one is.
        y = 280 * k
        view = View(0, y, 720, 270, positions, right=(1, 0, 0) if k == 0 else (0, 0, 1), up=(0, 0.25, -1) if k == 0 else (-1, -0.25, 0), margin=10)
        solids(page, view, (positions, mesh.facets, names))
    page.text(360, 592, f"facets of {len(contacts)} contacts; orange: with a depth", size=22)
    return page


@picture("crossing.svg")
def crossing():
    mesh, built, a, b = crossed()
    found = morula.crossings(a, b)
    placed = np.asarray(b.vertices())
    page = Picture(520)
    view = View(0, 0, 400, 460, np.concatenate([mesh.positions, placed]), **tilted(-38, 50))
    solids(page, view, (mesh.positions, mesh.facets, "surface"), (placed, mesh.facets, "other"))
    for p, q in zip(found.segment_from, found.segment_to):
        page.line(view(np.array([p, q])), "contact", "bold")
    lengths = np.linalg.norm(found.segment_to - found.segment_from, axis=1)
    k = int(np.argmax(np.round(lengths, 9)))
    one, two = mesh.positions[mesh.facets[found.facet_a[k]]], placed[mesh.facets[found.facet_b[k]]]
    near = View(410, 70, 300, 300, np.concatenate([one, two]), right=(1, 0.2, -0.5), up=(0.1, 0.9, -0.4), margin=14)
    page.line(near(one), "surface", "", close=True, fill=True)
    page.line(near(two), "other", "dash", close=True, fill=True)
    page.line(near(np.array([found.segment_from[k], found.segment_to[k]])), "contact", "bold")
    for point in near(np.array([found.segment_from[k], found.segment_to[k]])):
        page.dot(*point, "contact", 7)
    page.text(200, 500, f"{len(found)} pairs of facets cross")
    page.text(560, 500, "one pair, its segment")
    return page


@picture("swept.svg")
def swept():
    mesh = limb(16)
    tool = morula.sample_body("tool", 16)
    start = moved(turned(-65, (0, 0, 1), (1.9, 2.6, 0.0)), tool.positions)
    end = start + np.array([-0.9, -3.0, 0])
    a, b = morula.SurfaceTree(mesh), morula.SurfaceTree(tool)
    a.update(mesh.positions)
    b.update(start, end)
    query = morula.SweptQuery()
    query.run(a, b)
    pairs, time = query.pairs(), query.collision_free_step()
    first = start + time * (end - start)
    page = Picture(560)
    view = View(0, 0, 720, 500, np.concatenate([mesh.positions, start, end]), margin=10)
    loops, _ = section(mesh.positions, mesh.facets, ORIGIN, UP)
    shape(page, view, loops)
    for positions, extra, words in ((start, "", "time 0"), (first, "full", f"time {time:.3f}"), (end, "thin dash hollow", "time 1")):
        loops, _ = section(positions, tool.facets, (0, 0, 0.001), UP)
        shape(page, view, loops, "other", extra)
        top = positions[np.argmax(positions[:, 1])]
        (x, y), = view(top)
        page.text(min(x + 16, 590), y + 18, words, "ink", "start", size=22)
    k = int(np.argmin(pairs.time))
    kind, ia, ib = int(pairs.kind[k]), int(pairs.a[k]), int(pairs.b[k])
    if kind == int(morula.PairKind.vertex_facet):
        point = mesh.positions[ia]
    elif kind == int(morula.PairKind.facet_vertex):
        point = first[ib]
    else:
        point = 0.5 * (mesh.positions[a.edges[ia]].mean(0) + first[b.edges[ib]].mean(0))
    way = view(np.array([start.mean(0), end.mean(0)]))
    page.arrow(way[0], way[1], "muted", "thin dash")
    page.dot(*view(point)[0], "contact", 10)
    page.text(360, 542, f"no impact before {time:.3f}; {len(pairs)} pairs may meet later", size=22)
    return page


@picture("proximity.svg")
def proximity():
    mesh = limb(16)
    a, b = morula.SurfaceTree(mesh), morula.SurfaceTree(mesh)
    placed = mesh.positions + np.array([0.12, 1.28, 0])
    a.update(mesh.positions), b.update(placed)
    found = morula.proximity(a, b, distance=0.3, nearest_features_once=True)
    page = Picture(520)
    view = View(0, 0, 720, 460, np.concatenate([mesh.positions, placed]), margin=10)
    for positions, kind in ((mesh.positions, "surface"), (placed, "other")):
        loops, _ = section(positions, mesh.facets, (0, 0, 0.001), UP)
        shape(page, view, loops, kind)
    seen = np.abs(found.point_a[:, 2]) + np.abs(found.point_b[:, 2]) < 0.25
    for p, q in zip(found.point_a[seen], found.point_b[seen]):
        page.line(view(np.array([p, q])), "contact", "thin")
    page.text(360, 502, f"{len(found)} pairs nearer than 0.3, those near the section", size=22)
    return page


@picture("distance.svg")
def distance():
    mesh, built = limb(), model(branching=4)
    a, b = morula.Collider(morula.Body(mesh, built)), morula.Collider(morula.Body(mesh, built))
    b.set_transform(turned(180, (0, 0, 1), (0.3, 2.3, 0.0)))
    placed = np.asarray(b.vertices())
    exact = morula.distance(a, b)
    page = Picture(640)
    view = View(0, 0, 720, 440, np.concatenate([mesh.positions, placed]), margin=10)
    for positions, kind in ((mesh.positions, "surface"), (placed, "other")):
        loops, _ = section(positions, mesh.facets, (0, 0, 0.001), UP)
        shape(page, view, loops, kind)
    ends = np.array([exact.a.point, exact.b.point])
    page.line(view(ends), "contact", "bold")
    for end in view(ends):
        page.dot(*end, "contact", 8)
    x, y = view(ends.mean(0))[0]
    page.text(x + 16, y + 8, figure(exact.upper), "contact", "start")
    budgets = (180, 250, 400, None)
    bounds = [exact if n is None else morula.distance(a, b, budget=n) for n in budgets]
    most = max(found.upper for found in bounds)
    for k, (n, found) in enumerate(zip(budgets, bounds)):
        y = 470 + 36 * k
        left, right = 210 + 470 * found.lower / most, 210 + 470 * found.upper / most
        page.text(190, y + 8, f"{found.sphere_tests + found.facet_tests} tests", "ink", "end", size=22)
        page.line([(210, y), (680, y)], "muted", "thin dash")
        page.line([(left, y), (right, y)], "sphere", "bold")
        for x in (left, right):
            page.line([(x, y - 9), (x, y + 9)], "sphere", "bold")
    page.text(445, 618, "lower and upper bound of the distance", "muted", size=22)
    return page


@picture("rays.svg")
def rays():
    mesh, built = limb(32), model(resolution=32)
    pose = bent(32, 60)
    body = morula.Body(mesh, built)
    body.update(pose)
    eye = np.array([0.1, 1.75, 0.013])
    turns = np.radians(np.linspace(-168, -12, 27))
    directions = np.column_stack([np.cos(turns), np.sin(turns), np.zeros(len(turns))])
    hits = morula.first_hits(morula.Collider(body), np.tile(eye, (len(turns), 1)), directions)
    page = Picture(470)
    view = View(0, 0, 720, 420, np.concatenate([pose, eye[None]]), margin=14)
    loops, _ = section(pose, mesh.facets, eye, UP)
    shape(page, view, loops)
    place = view(eye)[0]
    page.add('<svg x="0" y="0" width="720" height="424">')
    for t, direction, point in zip(hits.t, directions, hits.point):
        if np.isfinite(t):
            end = view(point)[0]
            page.line([place, end], "contact", "thin")
            page.dot(*end, "contact", 6)
        else:
            page.line([place, view(eye + 6 * direction)[0]], "muted", "thin dash")
    page.add("</svg>")
    page.dot(*place, "ink", 7)
    page.text(360, 456, f"{int(np.isfinite(hits.t).sum())} of {len(hits.t)} rays hit the bent surface")
    return page


def contour(values, xs, ys, level):
    """Segments where a sampled function passes a level."""
    for j in range(len(ys) - 1):
        for i in range(len(xs) - 1):
            square = [(xs[i], ys[j], values[j, i]), (xs[i + 1], ys[j], values[j, i + 1]), (xs[i + 1], ys[j + 1], values[j + 1, i + 1]), (xs[i], ys[j + 1], values[j + 1, i])]
            ends = []
            for (ax, ay, av), (bx, by, bv) in zip(square, square[1:] + square[:1]):
                if (av > level) != (bv > level):
                    t = (level - av) / (bv - av)
                    ends.append((ax + t * (bx - ax), ay + t * (by - ay), 0.0))
            for n in range(0, len(ends) - 1, 2):
                yield ends[n], ends[n + 1]


@picture("signed_distance.svg")
def signed_distance():
    mesh = limb(32)
    field = morula.SignedDistance(mesh)
    xs, ys = np.linspace(-3.2, 3.1, 84), np.linspace(-1.7, 1.75, 46)
    grid = np.array([(x, y, 0.0) for y in ys for x in xs])
    values = field(grid).reshape(len(ys), len(xs))
    page = Picture(450)
    view = View(0, 0, 720, 394, grid, margin=0)
    loops, _ = section(mesh.positions, mesh.facets, ORIGIN, UP)
    shape(page, view, loops)
    for level in (-0.45, -0.3, -0.15, 0.15, 0.3, 0.45, 0.6):
        kind = "proof" if level < 0 else "sphere"
        d = "".join("M" + "L".join(f"{number(x)} {number(y)}" for x, y in view(np.array(ends))) for ends in contour(values, xs, ys, level))
        page.add(f'<path class="s-{kind}" d="{d}"/>')
    shape(page, view, loops, "surface", "bold", "s")
    page.text(360, 432, "steps of 0.15; green: inside, where it is negative", size=22)
    return page


@picture("inside.svg")
def inside():
    mesh, built = limb(32), model(resolution=32)
    pose = bent(32, 100)
    body = morula.Body(mesh, built)
    body.update(pose)
    query = morula.InsideQuery(morula.Collider(body))
    low, high = pose.min(0) - 0.2, pose.max(0) + 0.2
    xs, ys = np.arange(low[0], high[0], 0.15), np.arange(low[1], high[1], 0.15)
    points = np.array([(x, y, 0.0) for y in ys for x in xs])
    answers = query.inside(points)
    page = Picture(560)
    view = View(0, 0, 720, 500, points, margin=10)
    loops, _ = section(pose, mesh.facets, ORIGIN, UP)
    shape(page, view, loops)
    for (x, y), yes in zip(view(points), answers):
        if yes:
            page.dot(x, y, "proof", 5)
        else:
            page.circle(x, y, 3, "muted", "s", "thin")
    page.text(360, 542, f"{int(answers.sum())} of {len(points)} points are inside the bent body")
    return page


@picture("haptic.svg")
def haptic():
    mesh = limb(32)
    body = morula.Body(mesh, model(resolution=32))
    low, high = mesh.positions.min(0), mesh.positions.max(0)
    axis = int(np.argmax(high - low))
    assert axis == 0

    def at(share, y):
        return np.array((low[0] + share * (high[0] - low[0]), y, 0.0))

    probe = morula.HapticProbe(radius=0.09)
    probe.step(body, at(0.2, 1.5))
    point = at(0.2, 0.45)
    for _ in range(50):
        ball = probe.step(body, point)
    rod = np.array([(0.13 * k, 0, 0, 0.07) for k in range(-3, 4)])
    tool = morula.HapticTool(rod)
    tool.step(body, morula.RigidTransform.from_axis((0, 0, 1), 0.0, at(0.7, 1.5)))
    pose = morula.RigidTransform.from_axis((0, 0, 1), 0.2, at(0.7, -0.2))
    for _ in range(200):
        held = tool.step(body, pose)
    assert ball.touches and ball.settled and held.touches and held.settled
    page = Picture(420)
    view = View(0, 0, 720, 360, np.concatenate([mesh.positions * (1, 1, 0), at(0.7, 0.9)[None]]), margin=10)
    loops, _ = section(mesh.positions, mesh.facets, ORIGIN, UP)
    shape(page, view, loops)
    balls(page, view, np.append(point, 0.09)[None], "muted", "thin dash", "s")
    balls(page, view, np.append(ball.proxy, 0.09)[None], "contact")
    page.arrow(view(point)[0], view(np.asarray(ball.proxy))[0], "ink")
    balls(page, view, moved_spheres(pose, rod), "muted", "thin dash", "s")
    balls(page, view, moved_spheres(held.proxy, rod), "contact")
    page.arrow(view(np.asarray(pose.translation))[0], view(np.asarray(held.proxy.translation))[0], "ink")
    for contact in held.contacts:
        page.dot(*view(np.asarray(contact.point.point))[0], "proof", 5)
    page.text(360, 402, "dashed: the device; arrows: the force on the device", size=22)
    return page


@picture("penetration.svg")
def penetration():
    mesh, built, a, b = crossed(depth=3, branching=8, height=0.6)
    placed = np.asarray(b.vertices())
    page = Picture(560)
    origin, normal = np.array([0.9, 0, 0.02]), np.array([0, 0, 1.0])
    view = View(0, 0, 720, 330, np.concatenate([mesh.positions, placed]), margin=10)
    clips = []
    for positions, kind in ((mesh.positions, "surface"), (placed, "other")):
        loops, _ = section(positions, mesh.facets, origin, normal)
        shape(page, view, loops, kind)
        clips.append(path_of(view, loops))
    page.defs.append(f'<clipPath id="a"><path d="{clips[0]}"/></clipPath>')
    page.add(f'<path class="f-contact" clip-path="url(#a)" d="{clips[1]}"/>')
    query = morula.PenetrationQuery(a, b)
    budgets, found = (200, 1000, 5000, 20000), []
    for k, n in enumerate(budgets):
        found.append(query.run(tolerance=0.0, budget=n))
    most = max(f.upper for f in found)
    for k, (n, f) in enumerate(zip(budgets, found)):
        y = 366 + 36 * k
        left, right, at = (220 + 460 * v / most for v in (f.lower, f.upper, f.estimate))
        page.text(200, y + 8, f"{n} probes", "ink", "end", size=22)
        page.line([(220, y), (680, y)], "muted", "thin dash")
        page.line([(left, y), (right, y)], "sphere", "bold")
        for x in (left, right):
            page.line([(x, y - 9), (x, y + 9)], "sphere", "bold")
        page.dot(at, y, "contact", 7)
    page.text(360, 536, f"bounds of the shared volume; dot: the estimate, {two_digits(found[-1].estimate)}", size=22)
    return page


@picture("scene.svg")
def scene():
    random = np.random.default_rng(7)
    meshes = {name: morula.sample_body(name, 12) for name in ("blob", "capsule", "tool", "limb")}
    built = {name: morula.build(m, branching=8, depth=2, quality="fast") for name, m in meshes.items()}
    world, boxes, placed = morula.Scene(), morula.BroadPhase(), []
    names = list(meshes)
    for k in range(14):
        name = names[k % 4]
        collider = morula.Collider(morula.Body(meshes[name], built[name]))
        where = (2.3 * (k % 5) + random.uniform(-0.6, 0.6), 2.1 * (k // 5) + random.uniform(-0.5, 0.5), 0.0)
        collider.set_transform(turned(random.uniform(0, 180), (0, 0, 1), where))
        world.add(collider)
        points = np.asarray(collider.vertices())
        boxes.add(tuple(points.min(0)), tuple(points.max(0)))
        placed.append((name, points))
    boxes.update()
    world.update()
    pairs = world.pairs()
    touching = {(int(p), int(q)) for p, q in zip(pairs.place_a, pairs.place_b)}
    page = Picture(520)
    every = np.concatenate([p for _, p in placed])
    view = View(0, 0, 720, 450, every, margin=10)
    for k, (name, points) in enumerate(placed):
        loops, _ = section(points, meshes[name].facets, (0, 0, 0.003), UP)
        shape(page, view, loops, "surface")
        low, high = points.min(0), points.max(0)
        page.line(view(np.array([(low[0], low[1], 0), (high[0], low[1], 0), high * [1, 1, 0], (low[0], high[1], 0)])), "sphere", "thin", close=True)
    near = [tuple(map(int, pair)) for pair in boxes.pairs()]
    middles = view(np.array([p.mean(0) for _, p in placed]))
    for i, j in near:
        meets = (i, j) in touching or (j, i) in touching
        page.line([middles[i], middles[j]], "contact" if meets else "sphere", "bold" if meets else "dash")
    for x, y in middles:
        page.dot(x, y, "ink", 4)
    assert touching and len(touching) < len(near)
    page.text(360, 502, f"boxes of {len(near)} pairs overlap, spheres of {len(touching)} meet")
    return page


@picture("obstacle.svg")
def obstacle():
    mesh = limb(24)
    hills = lambda p: 0.8 * (p[1] + 1.05 - 0.3 * np.sin(2.2 * p[0]) - 0.12 * np.cos(3 * p[2]))  # a height field over y, flatter than 1
    field = morula.DistanceField(hills, lipschitz=1.0)
    surface = morula.SurfaceTree(mesh)
    pose = np.array(mesh.positions)
    surface.update(pose)
    query = morula.ObstacleQuery(margin=0.12, features="facets")
    query.run(surface, field)
    found = query.contacts()
    page = Picture(500)
    xs = np.linspace(-3, 2.8, 90)
    ground = np.column_stack([xs, -1.05 + 0.3 * np.sin(2.2 * xs) + 0.12, np.zeros(90)])
    view = View(0, 0, 720, 440, np.concatenate([pose, ground, [[0, -1.7, 0]]]), margin=0)
    edge = view(ground)
    page.line(np.concatenate([edge, [[edge[-1][0], 448], [edge[0][0], 448]]]), "other", "", close=True, fill=True)
    near = {int(f): float(d) for f, d in zip(found.feature, found.distance)}
    names = ["bare" if near.get(f, 1) < 0 else "contact" if f in near else "surface" for f in range(mesh.facet_count)]
    solids(page, view, (pose, mesh.facets, names))
    page.line(edge, "other", "bold")
    for k in np.argsort(found.feature)[::14]:
        if abs(found.point[k, 2]) < 0.5:
            p = found.point[k]
            page.arrow(view(p)[0], view(p + 0.4 * found.normal[k])[0], "ink", "thin")
    inside_count = sum(1 for d in near.values() if d < 0)
    page.text(360, 482, f"{inside_count} facets in the ground, {len(near) - inside_count} nearer than 0.12", size=22)
    return page


@picture("self_crossing.svg")
def self_crossing():
    mesh = limb(32)
    ring = morula.Mesh(morula.deform(mesh, morula.Bend(268)), mesh.facets)
    pose = morula.deform(ring, morula.Poke((0.76, 0.95, 0.5), (-0.45, 0, 0), 0.35))
    tree = morula.SurfaceTree(mesh)
    tree.update(pose)
    found = morula.surface_crossings(tree)
    hit = set(map(int, found.a)) | set(map(int, found.b))
    page = Picture(520)
    view = View(0, 0, 720, 460, pose, **tilted(-10, 30), margin=14)
    solids(page, view, (pose, mesh.facets, ["contact" if f in hit else "surface" for f in range(mesh.facet_count)]))
    page.text(360, 502, f"{len(found)} pairs of facets of one surface cross, in orange")
    return page


@picture("grains.svg")
def grains():
    mesh = morula.sample_body("blob", 20)
    page = Picture(330)
    field = morula.SignedDistance(mesh)
    for k, (kind, words) in enumerate((("cover", "cover: contains"), ("inner", "inner: is inside"))):
        clump = morula.fit_clump(mesh, kind=kind, spheres=12)
        loops, _ = section(mesh.positions, mesh.facets, (0, 0, 0.1), UP)
        view = View(360 * k, 0, 360, 280, np.concatenate([mesh.positions * 1.25]), margin=10)
        shape(page, view, loops)
        balls(page, view, cut_circles(clump.spheres, np.array([0, 0, 0.1]), UP)[0], "sphere" if k == 0 else "proof", "faint")
        page.text(360 * k + 180, 312, f"{words}, {len(clump.spheres)}")
    return page
