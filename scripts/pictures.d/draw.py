# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The language that all pictures speak: colors by meaning, widths of lines, solids, sections, spheres and trees as SVG.

A picture is 720 units wide and has to be read at half of that. Its colors follow the reader's scheme; a plate below it keeps it legible
where the page does not.
"""
from __future__ import annotations

import html
from collections import defaultdict

import numpy as np

# By meaning: in the light scheme, in the dark one. Apart for color-blind readers too; what has to be told apart also differs in its line.
COLORS = {
    "plate": ("#ffffff", "#15181d"),
    "ink": ("#1f2328", "#e8ebef"),
    "muted": ("#59636e", "#9aa4af"),
    "surface": ("#59636e", "#aab3bd"),  # the body
    "other": ("#7d6b45", "#cdbb90"),  # a second body, an obstacle
    "sphere": ("#1f6fb5", "#62b0f5"),
    "sphere_b": ("#7a4fb0", "#bb98ef"),  # of a second body
    "proof": ("#00805f", "#35c79a"),  # what is owned, proven, fresh: patches, regions
    "contact": ("#c25700", "#ff9a4d"),  # where bodies meet, and what is being looked at
    "bare": ("#b0156b", "#ff7ab8"),  # what is lost, refused, or wrongly so
}
# What is drawn as a lit solid, each in SHADES steps.
SOLIDS = {"surface": ((96, 104, 116), (226, 230, 236), (44, 50, 58), (140, 150, 162)),
          "other": ((128, 112, 78), (240, 230, 208), (58, 51, 38), (168, 152, 114)),
          "proof": ((0, 92, 68), (136, 214, 186), (8, 74, 56), (60, 190, 148)),
          "contact": ((150, 66, 0), (248, 186, 132), (110, 52, 8), (240, 146, 76)),
          "bare": ((120, 10, 72), (232, 130, 184), (96, 14, 60), (240, 110, 176)),
          "sphere": ((18, 66, 112), (150, 200, 240), (18, 60, 100), (90, 170, 235)),
          "sphere_b": ((78, 48, 118), (206, 184, 238), (62, 40, 96), (178, 148, 232))}
SHADES = 7
WIDTH = 720


def number(x):
    text = f"{x:.1f}"
    return text[:-2] if text.endswith(".0") else text


def figure(x):
    """Three digits, as the command prints them."""
    return f"{float(f'{x:.3g}'):g}" if x >= 1e-4 or x == 0 else f"{x:.2g}"


class Picture:
    def __init__(self, height, width=WIDTH):
        self.width, self.height, self.parts, self.defs, self.stamps = width, height, [], [], {}

    def add(self, *texts):
        self.parts += texts
        return self

    def stamp(self, x, y, content):
        """Content that several panels show, kept once."""
        name = self.stamps.setdefault(content, f"g{len(self.stamps)}")
        if len(self.defs) < len(self.stamps):
            self.defs.append(f'<g id="{name}">{content}</g>')
        self.add(f'<use href="#{name}" x="{number(x)}" y="{number(y)}"/>')

    def text(self, x, y, words, kind="ink", anchor="middle", size=24):
        wide = 0.58 * size * len(words)
        left = x - wide * {"start": 0, "middle": 0.5, "end": 1}[anchor]
        assert left > -4 and left + wide < self.width + 4, f"text leaves the picture: {words}"
        style = "" if size == 24 else f' font-size="{size}"'
        self.add(f'<text class="f-{kind}" x="{number(x)}" y="{number(y)}" text-anchor="{anchor}"{style}>{html.escape(words)}</text>')

    def line(self, points, kind, extra="", close=False, fill=False):
        d = "M" + "L".join(f"{number(x)} {number(y)}" for x, y in points) + ("Z" if close else "")
        self.add(f'<path class="{"b" if fill else "s"}-{kind}{" " + extra if extra else ""}" d="{d}"/>')

    def circle(self, x, y, r, kind, style="s", extra=""):
        self.add(f'<circle class="{style}-{kind}{" " + extra if extra else ""}" cx="{number(x)}" cy="{number(y)}" r="{number(r)}"/>')

    def dot(self, x, y, kind, r=5):
        self.circle(x, y, r, kind, "f")

    def arrow(self, a, b, kind, extra=""):
        a, b = np.asarray(a, float), np.asarray(b, float)
        along = (b - a) / max(np.hypot(*(b - a)), 1e-9)
        side, size = np.array([-along[1], along[0]]), 13
        self.line([a, b - along * size * 0.7], kind, extra)
        tip = [b, b - along * size + side * size * 0.45, b - along * size - side * size * 0.45]
        self.add(f'<path class="f-{kind}" d="M{"L".join(f"{number(x)} {number(y)}" for x, y in tip)}Z"/>')

    def svg(self, title):
        body = "\n".join(self.parts)
        used = sorted(set(part for chunk in (body + "".join(self.defs)).split('class="')[1:] for part in chunk.split('"')[0].split()))
        scheme = [[], []]
        for name in used:
            kind, _, color = name.partition("-")
            for dark in (0, 1):
                rule = {"f": "fill:{c}", "s": "stroke:{c};fill:none", "b": "stroke:{c};fill:{c};fill-opacity:.16"}.get(kind)
                if rule and color in COLORS:
                    scheme[dark].append(f".{name}{{{rule.format(c=COLORS[color][dark])}}}")
                elif kind == "o":  # an opaque ball
                    low, high = SOLIDS[color][2 * dark:2 * dark + 2]
                    dim, bright = ("#" + "".join(f"{c:02x}" for c in rgb) for rgb in (low, high))
                    scheme[dark].append(f".{name}{{fill:url(#{name});stroke:{dim};stroke-width:1}}.dim-{color}{{stop-color:{dim}}}.bright-{color}{{stop-color:{bright}}}")
                    if not dark:
                        self.defs.append(f'<radialGradient id="{name}" cx=".36" cy=".28" r=".82"><stop class="bright-{color}"/><stop offset="1" class="dim-{color}"/></radialGradient>')
                elif kind == "lit":
                    solid, shade = color.rsplit("-", 1)
                    low, high = SOLIDS[solid][2 * dark:2 * dark + 2]
                    c = "#" + "".join(f"{round(a + (b - a) * int(shade) / (SHADES - 1)):02x}" for a, b in zip(low, high))
                    scheme[dark].append(f".{name}{{fill:{c};stroke:{c}}}")
        plate = [f".f-plate{{fill:{c}}}text{{stroke:{c}}}" for c in COLORS["plate"]]
        lines = ("text{font:24px system-ui,'Segoe UI','DejaVu Sans',sans-serif;stroke-width:5px;stroke-linejoin:round;paint-order:stroke}"
                 "text[font-size]{font-size:22px}path,circle{stroke-width:2;stroke-linejoin:round;stroke-linecap:round}.solid path{stroke-width:6}")
        # After the colors, which they change.
        modes = {"thin": "stroke-width:1", "bold": "stroke-width:4", "dash": "stroke-dasharray:7 6", "faint": "fill-opacity:.05;stroke-opacity:.7",
                 "full": "fill-opacity:.6", "hollow": "fill-opacity:0"}
        modes = "".join(f".{name}{{{rule}}}" for name, rule in modes.items() if name in used)
        return (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {self.width} {number(self.height)}" width="{self.width}" height="{number(self.height)}" role="img">\n'
                "<!-- SPDX-FileCopyrightText: 2026 The Morula authors -->\n<!-- SPDX-License-Identifier: Apache-2.0 -->\n"
                f"<title>{html.escape(title)}</title>\n<!-- Made by scripts/pictures. -->\n"
                f"<style>{lines}\n{plate[0]}{''.join(scheme[0])}\n@media(prefers-color-scheme:dark){{{plate[1]}{''.join(scheme[1])}}}\n{modes}</style>\n"
                f"{'<defs>' + ''.join(self.defs) + '</defs>' if self.defs else ''}"
                f'<rect class="f-plate" width="{self.width}" height="{number(self.height)}" rx="6"/>\n{body}\n</svg>\n')


class View:
    """A window of the picture onto a plane of the world: right and up are world directions, the third one points to the reader."""

    def __init__(self, x, y, width, height, points, right=(1, 0, 0), up=(0, 1, 0), margin=8):
        right, up = np.asarray(right, float), np.asarray(up, float)
        right = right / np.linalg.norm(right)
        up = up - right * (up @ right)
        up = up / np.linalg.norm(up)
        self.axes = np.stack([right, up, np.cross(right, up)])
        seen = np.atleast_2d(points) @ self.axes.T
        low, high = seen.min(0)[:2], seen.max(0)[:2]
        self.scale = float(min((width - 2 * margin) / (high - low)[0], (height - 2 * margin) / (high - low)[1]))
        middle = (low + high) / 2
        self.corner = np.array([x, y])
        self.shift = np.array([x + width / 2 - self.scale * middle[0], y + height / 2 + self.scale * middle[1]])

    def __call__(self, points):
        """(n, 2) in the picture."""
        seen = np.atleast_2d(points) @ self.axes.T
        return np.stack([self.shift[0] + self.scale * seen[:, 0], self.shift[1] - self.scale * seen[:, 1]], 1)

    def depth(self, points):
        return np.atleast_2d(points) @ self.axes[2]


def reach(spheres):
    """Points that a window has to hold for spheres to be in it."""
    spheres = np.atleast_2d(spheres)
    return np.concatenate([spheres[:, :3] + spheres[:, 3:] * np.array(d) for d in ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1))])


def tilted(yaw, pitch):
    """right and up of a reader who walked around the y axis and climbed, in degrees."""
    a, b = np.radians(yaw), np.radians(pitch)
    return {"right": (np.cos(a), 0, -np.sin(a)), "up": (-np.sin(a) * np.sin(b), np.cos(b), -np.cos(a) * np.sin(b))}


def solids(picture, view, *bodies):
    """Lit surfaces, the nearer over the farther. A body: positions, facets, and a solid's name, or one per facet."""
    drawn = []
    for positions, facets, names in bodies:
        corners = np.asarray(positions)[np.asarray(facets)]
        normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        size = np.linalg.norm(normals, axis=1)
        towards = (normals @ view.axes.T) / np.maximum(size, 1e-300)[:, None]
        light = np.clip(0.3 * towards[:, 0] * -1 + 0.5 * towards[:, 1] + 0.72 * towards[:, 2], 0, 1)
        places = view(corners.reshape(-1, 3)).reshape(-1, 3, 2)
        depths = view.depth(corners.reshape(-1, 3)).reshape(-1, 3).mean(1)
        for facet in np.flatnonzero((towards[:, 2] > 0) & (size > 0)):
            name = names if isinstance(names, str) else names[facet]
            drawn.append((round(float(depths[facet]), 9), len(drawn), f"lit-{name}-{min(SHADES - 1, int(SHADES * light[facet]))}", np.rint(10 * (places[facet] - view.corner)).astype(int)))
    content, run, kind = [], [], None
    for _, _, name, p in sorted(drawn, key=lambda item: item[:2]):
        if name != kind and run:
            content.append(f'<path class="{kind}" d="{"".join(run)}"/>')
            run = []
        kind = name
        (ax, ay), (bx, by), (cx, cy) = p.tolist()
        run.append(f"M{ax} {ay}l{bx - ax} {by - ay} {cx - bx} {cy - by}z")
    if run:
        content.append(f'<path class="{kind}" d="{"".join(run)}"/>')
    picture.stamp(*view.corner, f'<g class="solid" transform="scale(.1)">{"".join(content)}</g>')


def balls(picture, view, spheres, kind="sphere", extra="", style="b"):
    """Spheres as the circles that they are to a reader far away, the nearest last."""
    spheres = np.atleast_2d(spheres)
    kinds = [kind] * len(spheres) if isinstance(kind, str) else kind
    for i in np.argsort(np.round(view.depth(spheres[:, :3]), 9), kind="stable"):
        (x, y), = view(spheres[i, :3])
        picture.circle(x, y, spheres[i, 3] * view.scale, kinds[i], style, extra)


def section(positions, facets, origin, normal):
    """Where a plane cuts a closed mesh: loops of points; and each facet's segment, (facet, p, q)."""
    positions, facets = np.asarray(positions, float), np.asarray(facets)
    side = (positions - np.asarray(origin)) @ np.asarray(normal)
    side = np.where(np.abs(side) < 1e-9, 1e-9, side)
    follows, points, segments = {}, {}, []
    for f in np.flatnonzero((np.sign(side)[facets].min(1) < 0) & (np.sign(side)[facets].max(1) > 0)):
        ends = {}
        for k in range(3):
            a, b = int(facets[f, k]), int(facets[f, (k + 1) % 3])
            if (side[a] > 0) != (side[b] > 0):
                low, high = min(a, b), max(a, b)
                t = side[low] / (side[low] - side[high])
                points[low, high] = positions[low] + t * (positions[high] - positions[low])
                ends["out" if side[a] > 0 else "in"] = (low, high)
        follows[ends["in"]] = ends["out"]
        segments.append((int(f), points[ends["in"]], points[ends["out"]]))
    loops, left = [], dict(sorted(follows.items()))
    while left:
        start = next(iter(left))
        loop, at = [], start
        while at in left:
            loop.append(points[at])
            at = left.pop(at)
        loops.append(np.array(loop))
    return loops, segments


def cut_circles(spheres, origin, normal):
    """What a plane cuts of spheres: rows x, y, z, radius, and which spheres they are of."""
    spheres = np.atleast_2d(spheres)
    away = (spheres[:, :3] - np.asarray(origin)) @ np.asarray(normal)
    hit = np.flatnonzero(np.abs(away) < spheres[:, 3])
    centers = spheres[hit, :3] - away[hit, None] * np.asarray(normal)
    return np.column_stack([centers, np.sqrt(spheres[hit, 3] ** 2 - away[hit] ** 2)]), hit


def path_of(view, loops):
    return "".join("M" + "L".join(f"{number(x)} {number(y)}" for x, y in view(loop)) + "Z" for loop in loops)


def shape(picture, view, loops, kind="surface", extra="", style="b"):
    picture.add(f'<path class="{style}-{kind}{" " + extra if extra else ""}" fill-rule="evenodd" d="{path_of(view, loops)}"/>')


def children(tree, node):
    first = int(tree.first_child[node])
    return range(first, first + int(tree.child_count[node]))


def rows_of_tree(picture, tree, x, y, width, row, kind_of, gap=6):
    """A tree as rows of bars, the root on top, each bar as wide as the leaves below it. kind_of: node -> class of its bar."""
    leaves = np.zeros(tree.node_count, int)
    for node in range(tree.node_count - 1, -1, -1):
        leaves[node] = sum(leaves[c] for c in children(tree, node)) or 1
    unit, bars = width / leaves[0], defaultdict(list)

    def put(node, left, level):
        w = leaves[node] * unit
        inset = min(1.0, w * 0.12)
        bars[kind_of(node)].append(f"M{number(left + inset)} {number(y + level * (row + gap))}h{number(max(w - 2 * inset, .6))}v{row}h-{number(max(w - 2 * inset, .6))}z")
        for child in children(tree, node):
            put(child, left, level + 1)
            left += leaves[child] * unit

    put(0, x, 0)
    for kind in sorted(bars):
        picture.add(f'<path class="{kind}" d="{"".join(bars[kind])}"/>')


def corners_of(cover, positions):
    """All corners of a cover in a pose: the vertices, then its cut points."""
    positions = np.asarray(positions, float)
    return np.concatenate([positions, np.einsum("nk,nkd->nd", cover.cut_weights, positions[cover.cut_vertices])])


def colored_regions(cover, positions, facets, kinds):
    """A surface as triangles with a solid's name each, for solids(): kinds gives the regions of some nodes another one."""
    corners, of_patch = corners_of(cover, positions), np.full(cover.patch_count, "", dtype=object)
    for node, kind in kinds.items():
        of_patch[cover.region_begin[node]:cover.region_end[node]] = kind
    mixed = np.zeros(len(facets), bool)
    mixed[cover.patch_facet[of_patch != ""]] = True
    triangles, names = [np.asarray(positions)[np.asarray(facets)[~mixed]]], ["surface"] * int((~mixed).sum())
    for patch in np.flatnonzero(mixed[cover.patch_facet]):
        polygon = corners[cover.corners[cover.corner_begin[patch]:cover.corner_begin[patch + 1]]]
        triangles.append(np.stack([polygon[[0, j, j + 1]] for j in range(1, len(polygon) - 1)]))
        names += [of_patch[patch] or "surface"] * (len(polygon) - 2)
    points = np.concatenate(triangles).reshape(-1, 3)
    return points, np.arange(len(points)).reshape(-1, 3), names


def patches_of(cover, node, corners):
    """(facet, polygon) of every patch of a node's region."""
    for patch in range(int(cover.region_begin[node]), int(cover.region_end[node])):
        yield int(cover.patch_facet[patch]), corners[cover.corners[cover.corner_begin[patch]:cover.corner_begin[patch + 1]]]
