# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pictures with matplotlib: looseness over a motion, levels of a tree, a tree's spheres in space."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy
from numpy.typing import NDArray

from . import _morula
from .typing import FloatArray, MeshLike, Rule

__all__ = ["levels_table", "looseness_curve", "looseness_of_motion", "spheres", "to_polyscope", "to_pyvista"]


def _axes(axes: Any, **kind: Any) -> Any:
    if axes is not None:
        return axes
    import matplotlib.pyplot

    return matplotlib.pyplot.figure().add_subplot(**kind)


def looseness_of_motion(
    mesh: MeshLike, model: _morula.CoveredTree, frames: FloatArray, *, rules: Rule | Sequence[Rule] = "exact", level: int = -1,
    resolution: int = 96,
) -> NDArray[numpy.float64]:
    """Looseness of one level set in every frame, in object volumes; NaN if the mesh has no inside.

    frames: (frames, vertices, 3). level: negative counts from the leaves. resolution: voxels along the longest side.
    """
    body = _morula.Body(mesh, model, rules=rules)
    nodes = model.tree.level_set(level % model.tree.level_count)
    values = []
    for positions, moved in zip(frames, body.follow(frames)):
        found = _morula.looseness(mesh, moved[nodes], positions, resolution=resolution).looseness
        values.append(numpy.nan if found is None else found)
    return numpy.array(values)


def looseness_curve(
    curves: Mapping[str, Sequence[float] | NDArray[numpy.float64]], *, parameter: Sequence[float] | None = None, axes: Any = None
) -> Any:
    """Looseness over frames, a curve per name. Returns the axes."""
    axes = _axes(axes)
    for name, values in curves.items():
        axes.plot(range(len(values)) if parameter is None else parameter, values, label=name)
    axes.set_xlabel("frame" if parameter is None else "deformation")
    axes.set_ylabel("looseness, object volumes")
    axes.set_ylim(bottom=0)
    axes.legend()
    return axes


def levels_table(measured: Sequence[_morula.LevelMeasure]) -> list[dict[str, Any]]:
    """The results of measure() as rows of plain numbers, for pandas or a printed table."""
    return [
        {
            "level": m.level,
            "spheres": m.spheres,
            "looseness": m.looseness.looseness,
            "uncovered_area": m.coverage.uncovered_area,
            "uncovered_distance": m.coverage.uncovered_distance,
            "protrusion": None if m.protrusion is None else m.protrusion.worst,
        }
        for m in measured
    ]


def spheres(rows: FloatArray, *, axes: Any = None, color: str = "#5b8def", alpha: float = 0.25, steps: int = 12) -> Any:
    """Spheres (n, 4) in space, as translucent surfaces. Returns the axes."""
    axes = _axes(axes, projection="3d")
    u, v = numpy.meshgrid(numpy.linspace(0, 2 * numpy.pi, 2 * steps), numpy.linspace(0, numpy.pi, steps))
    unit = numpy.stack([numpy.cos(u) * numpy.sin(v), numpy.sin(u) * numpy.sin(v), numpy.cos(v)])
    for x, y, z, radius in numpy.asarray(rows):
        axes.plot_surface(x + radius * unit[0], y + radius * unit[1], z + radius * unit[2], color=color, alpha=alpha, linewidth=0)
    axes.set_aspect("equal")
    return axes


def to_pyvista(rows: FloatArray, *, steps: int = 16) -> Any:
    """Spheres (n, 4) as one pyvista.PolyData."""
    import pyvista

    points = numpy.asarray(rows, dtype=float)
    cloud = pyvista.PolyData(points[:, :3])
    cloud["radius"] = points[:, 3]
    return cloud.glyph(scale="radius", orient=False, factor=1.0, geom=pyvista.Sphere(1.0, theta_resolution=steps, phi_resolution=steps))


def to_polyscope(shown: FloatArray | MeshLike, *, name: str = "Morula") -> Any:
    """Spheres (n, 4), or a mesh, as a structure of Polyscope, which is returned, between polyscope.init() and show().

    Spheres are a point cloud with true radii.
    """
    import polyscope  # type: ignore[import-not-found,import-untyped,unused-ignore]

    try:
        mesh = _morula.Mesh.of(shown)  # type: ignore[arg-type]
    except TypeError:
        rows = numpy.asarray(shown, dtype=float)
        if rows.ndim != 2 or rows.shape[1] != 4:
            raise ValueError(f"shown: an array of shape {rows.shape}, but spheres (n, 4) or a mesh are needed") from None
        cloud = polyscope.register_point_cloud(name, rows[:, :3])
        cloud.add_scalar_quantity("radius", rows[:, 3])
        cloud.set_point_radius_quantity("radius", autoscale=False)
        return cloud
    return polyscope.register_surface_mesh(name, mesh.positions, mesh.facets)
