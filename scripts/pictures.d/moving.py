# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A limb that bends and straightens, with the spheres of three levels that follow it, each frame certified."""
from __future__ import annotations

import math
import pathlib

import bodies
import morula
import numpy as np

TARGET = pathlib.Path(__file__).resolve().parents[2] / "docs/pictures/moving.svg"
BRANCHING, LEVELS = 5, (1, 2, 3)
FRAMES_OUT, POSES_OUT = 48, 7  # of the motion; of the picture, one way
SECONDS = 7
PANEL, HEIGHT, SCALE = 400, 350, 74  # pixels; pixels per mesh unit
SHADES = 10  # of the body
FILL_OPACITY = {1: 0.16, 2: 0.1, 3: 0.035}
HUES = ("#2a78d6", "#1b9e77", "#d95f02", "#8a5fd0", "#c2318b")


def animate(name, values):
    """The poses out and back, in a loop."""
    text = ";".join(values + values[-2::-1])
    return f'<animate attributeName="{name}" dur="{SECONDS}s" repeatCount="indefinite" values="{text}"/>'


def normals(pose, facets):
    corners = pose[facets]
    n = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    return n / np.linalg.norm(n, axis=1)[:, None]


def branch_of(tree, node):
    while tree.parent[node] != 0:
        node = int(tree.parent[node])
    return node - int(tree.first_child[0])


@bodies.picture("moving.svg")
def moving():
    mesh = morula.sample_body("limb", 12)
    built = morula.build(mesh, branching=BRANCHING, depth=max(LEVELS))
    tree, body = built.tree, morula.Body(mesh, built)
    motion = morula.deform_frames(mesh, morula.Bend(90), frame_count=FRAMES_OUT + 1, and_back=False)
    poses, spheres = [], []
    for i in range(POSES_OUT):
        # Poses are dense where the motion turns, so that it turns softly.
        pose = motion[round(FRAMES_OUT * (1 - math.cos(math.pi * i / (POSES_OUT - 1))) / 2)]
        body.update(pose)
        assert body.certify(pose).covered
        poses.append(pose)
        spheres.append(body.copy_spheres())
    every = np.concatenate(poses)
    middle = (every.min(0) + every.max(0)) / 2

    def screen(p):
        return round(PANEL / 2 + SCALE * float(p[0] - middle[0])), round(HEIGHT / 2 - SCALE * float(p[1] - middle[1]))

    drawn, facets = [], np.asarray(mesh.facets)
    light = [normals(pose, facets) for pose in poses]
    for facet in np.argsort(np.round(poses[0][facets][:, :, 2].sum(1), 9), kind="stable"):
        if all(n[facet, 2] <= 0 for n in light):
            continue
        n = light[0][facet]
        shade = min(SHADES - 1, int(SHADES * max(0.0, 0.45 * n[1] + 0.75 * n[2] - 0.3 * n[0])))
        values = [" ".join("{},{}".format(*screen(pose[v])) for v in facets[facet]) for pose in poses]
        drawn.append(f'<polygon class="s{shade}">{animate("points", values)}</polygon>')

    panels = []
    for place, level in enumerate(LEVELS):
        circles = {}
        nodes = range(int(tree.level_begin[level]), int(tree.level_begin[level + 1]))
        for node in nodes:
            track = [s[node] for s in spheres]
            centers = [screen(t) for t in track]
            attributes = {"cx": [str(c[0]) for c in centers], "cy": [str(c[1]) for c in centers], "r": [str(math.ceil(SCALE * float(t[3]))) for t in track]}
            circles.setdefault(branch_of(tree, node), []).append("<circle>" + "".join(animate(name, values) for name, values in attributes.items()) + "</circle>")
        groups = "".join(f'<g fill="{HUES[b]}" stroke="{HUES[b]}">{"".join(c)}</g>' for b, c in sorted(circles.items()))
        panels.append(f'<g transform="translate({place * PANEL} 0)"><use href="#limb"/><g class="spheres" fill-opacity="{FILL_OPACITY[level]}">{groups}</g>'
                      f'<text x="{PANEL // 2}" y="{HEIGHT - 8}">level {level}: {len(nodes)} spheres</text></g>')

    shades = ""
    for shade in range(SHADES):
        gray = 95 + 130 * shade // (SHADES - 1)
        shades += f".s{shade} {{ fill: rgb({gray} {gray} {gray + 8}); stroke: rgb({gray} {gray} {gray + 8}) }}\n"
    TARGET.write_text(
        f"""<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {PANEL * len(LEVELS)} {HEIGHT}" role="img">
<!-- SPDX-FileCopyrightText: 2026 The Morula authors -->
<!-- SPDX-License-Identifier: Apache-2.0 -->
<title>{bodies.TITLES["moving.svg"]}</title>
<!-- Made by scripts/pictures. -->
<style>
text {{ font: 21px sans-serif; text-anchor: middle; fill: #57606a }}
{shades}.spheres {{ stroke-opacity: .75; stroke-width: 1.2 }}
@media (prefers-color-scheme: dark) {{ text {{ fill: #9aa4af }} }}
</style>
<defs><g id="limb" stroke-width=".6">{"".join(drawn)}</g></defs>
{chr(10).join(panels)}
</svg>
""")
