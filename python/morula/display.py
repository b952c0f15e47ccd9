# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A tree in notebooks: a picture and a table."""

from __future__ import annotations

from . import _morula

_COLORS = ("#9aa5b1", "#5b8def", "#e0823d", "#3aa876", "#b5679c", "#8d6e4a", "#4aa8b5", "#c0564b", "#6b6f9c")


def tree_svg(tree: _morula.SphereTree, width: int = 480) -> str:
    """The levels of a tree in one row, seen along its box's shortest side."""
    import numpy

    root = tree.spheres[0]
    levels = [tree.level(level) for level in range(tree.level_count)]
    spread = numpy.ptp(levels[-1][:, :3], axis=0)
    across, up = sorted(numpy.argsort(spread)[-2:])
    side = width / max(1, len(levels))
    scale = side / (2.1 * root[3]) if root[3] > 0 else 1.0
    drawn = []
    for level, spheres in enumerate(levels):
        for sphere in spheres:
            x = (sphere[across] - root[across]) * scale + side * (level + 0.5)
            y = (root[up] - sphere[up]) * scale + side / 2
            drawn.append(f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{max(0.2, sphere[3] * scale):.1f}"/>')
        drawn.append(f'</g><g fill="none" stroke-width="0.6" stroke="{_COLORS[(level + 1) % len(_COLORS)]}">')
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{side:.0f}" viewBox="0 0 {width} {side:.1f}">'
        f'<g fill="none" stroke-width="0.6" stroke="{_COLORS[0]}">{"".join(drawn)}</g></svg>'
    )


def tree_html(model: _morula.CoveredTree) -> str:
    """Picture and table of a covered tree."""
    import html

    tree = model.tree
    rows = "".join(
        f"<tr><td>{level}</td><td>{len(tree.level(level))}</td><td>{tree.level(level)[:, 3].max():.4g}</td></tr>"
        for level in range(tree.level_count)
    )
    return (
        f"<div><b>{html.escape(repr(model).strip('<>'))}</b><br/>{tree_svg(tree)}"
        f"<table><tr><th>level</th><th>spheres</th><th>largest radius</th></tr>{rows}</table></div>"
    )
