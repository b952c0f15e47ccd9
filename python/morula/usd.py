# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Meshes in motion from USD files, spheres in motion into them, through the package `usd-core`.

>>> mesh, frames, times = morula.usd.read_motion("liver.usdc")
>>> body = morula.Body(mesh, morula.build(mesh))
>>> morula.usd.write_spheres("spheres.usdc", body.follow(frames), frames_per_second=24)

Coordinates are read and written unchanged, for any up axis and any unit.
"""

from __future__ import annotations

import os
import pathlib
import tempfile
from typing import TYPE_CHECKING, Any

import numpy
from numpy.typing import NDArray

from . import _morula

try:
    from pxr import Gf, Sdf, Usd, UsdGeom, Vt  # type: ignore[import-not-found,import-untyped,unused-ignore]
except ImportError as error:  # pragma: no cover
    raise ImportError("morula.usd needs the package usd-core: pip install usd-core") from error

if TYPE_CHECKING:
    from collections.abc import Iterable

    from .typing import FloatArray, MeshLike

__all__ = ["mesh_paths", "read_mesh", "read_motion", "write_mesh", "write_spheres"]

_ENDINGS = (".usd", ".usda", ".usdc")
_KINDS = ("points", "instances")


def mesh_paths(path: str | os.PathLike[str], *, roots: Iterable[str | os.PathLike[str]] = ()) -> list[str]:
    """The meshes of a file, by their `prim`. roots: like in read_mesh."""
    return [str(prim.GetPath()) for prim in _meshes(_open(path, roots))]


def read_mesh(
    path: str | os.PathLike[str], prim: str | None = None, *, roots: Iterable[str | os.PathLike[str]] = ()
) -> _morula.Mesh:
    """A mesh in the coordinates of the world, at its first time; polygons are cut into triangles as read_mesh cuts them.

    prim: its path in the file; optional if there is one mesh. A subdivision surface is read as its control mesh.
    roots: folders, besides the file's own, that may hold the files that it refers to. Symbolic links are resolved first.
    ValueError for a missing mesh, or a prim that is not a mesh, with a list of the meshes. OSError for a file that cannot be
    read, or that refers to a file in another folder.
    """
    stage = _open(path, roots)
    mesh = _one_mesh(path, stage, prim)
    times = _times_of(mesh)
    points = _positions(path, mesh, times[0])
    return _morula.Mesh(points, _faces(path, mesh, points))


def read_motion(
    path: str | os.PathLike[str], prim: str | None = None, *, roots: Iterable[str | os.PathLike[str]] = ()
) -> tuple[_morula.Mesh, NDArray[numpy.float64], NDArray[numpy.float64]]:
    """(mesh, frames, times): the mesh at its first time, its positions (frames, vertices, 3) at every time, and these in
    seconds. Times are those of the samples of the points, or of a transform above them.

    prim, roots: like in read_mesh. ValueError if facets or the number of points change.
    """
    stage = _open(path, roots)
    mesh = _one_mesh(path, stage, prim)
    times = _times_of(mesh)
    frames = [_positions(path, mesh, time) for time in times]
    faces = _faces(path, mesh, frames[0])
    for time, frame in zip(times, frames):
        if len(frame) != len(frames[0]):
            raise ValueError(f"{path}: {mesh.GetPath()} has {len(frames[0])} points at first and {len(frame)} at time {time.GetValue()}")
    per_second = stage.GetTimeCodesPerSecond() or 24.0
    seconds = numpy.array([0.0 if time.IsDefault() else time.GetValue() / per_second for time in times])
    return _morula.Mesh(frames[0], faces), numpy.stack(frames), seconds


def write_spheres(
    path: str | os.PathLike[str],
    spheres: FloatArray | _morula.SphereTree | _morula.CoveredTree,
    *,
    level: int | None = None,
    kind: str = "points",
    frames_per_second: float = 24.0,
    up: str = "Y",
) -> None:
    """Spheres (nodes, 4), or in motion (frames, nodes, 4), x, y, z, radius; or a tree's at a level, by default the last.

    kind: "points", one UsdGeom.Points whose widths are diameters; "instances", one UsdGeom.PointInstancer of a unit
    sphere. USD stores single precision: radii are enlarged by the rounding of the centers, so that cover is
    kept. The write is atomic.
    """
    _check_ending(path)
    if kind not in _KINDS:
        raise ValueError(f"kind: {kind!r} is none of {', '.join(_KINDS)}")
    if up not in ("Y", "Z"):
        raise ValueError(f"up: {up!r} is neither Y nor Z, which USD knows")
    if isinstance(spheres, _morula.CoveredTree):
        spheres = spheres.tree
    if isinstance(spheres, _morula.SphereTree):
        spheres = spheres.level(spheres.level_count - 1 if level is None else level)
    elif level is not None:
        raise ValueError("level: it belongs to a tree, and an array was given; index the array")
    given = numpy.asarray(spheres, dtype=numpy.float64)
    moves = given.ndim == 3
    frames = given if moves else given[None]
    if frames.ndim != 3 or frames.shape[-1] != 4:
        raise ValueError(f"spheres: shape {given.shape}, but (nodes, 4) or (frames, nodes, 4) is needed: x, y, z, radius")
    if not numpy.isfinite(frames).all() or (frames[..., 3] < 0).any():
        raise ValueError("spheres: a number is not finite, or a radius is below 0")
    centers, radii = _narrowed(frames)

    stage = _new_stage(len(frames) if moves else 0, frames_per_second, up)
    root = UsdGeom.Xform.Define(stage, "/morula")
    stage.SetDefaultPrim(root.GetPrim())
    if kind == "points":
        points = UsdGeom.Points.Define(stage, "/morula/spheres")
        points.CreateIdsAttr(Vt.Int64Array.FromNumpy(numpy.arange(frames.shape[1], dtype=numpy.int64)))
        points.SetWidthsInterpolation(UsdGeom.Tokens.vertex)
        where, size, extent = points.CreatePointsAttr(), points.CreateWidthsAttr(), points.CreateExtentAttr()
        sizes = [Vt.FloatArray.FromNumpy(2 * r) for r in radii]
    else:
        instancer = UsdGeom.PointInstancer.Define(stage, "/morula/spheres")
        ball = UsdGeom.Sphere.Define(stage, "/morula/spheres/ball")
        ball.CreateRadiusAttr(1.0)
        ball.CreateExtentAttr([(-1, -1, -1), (1, 1, 1)])
        instancer.CreatePrototypesRel().SetTargets([ball.GetPath()])
        instancer.CreateProtoIndicesAttr(Vt.IntArray.FromNumpy(numpy.zeros(frames.shape[1], numpy.int32)))
        where, size, extent = instancer.CreatePositionsAttr(), instancer.CreateScalesAttr(), instancer.CreateExtentAttr()
        sizes = [Vt.Vec3fArray.FromNumpy(numpy.repeat(r[:, None], 3, axis=1)) for r in radii]
    for frame, (center, radius) in enumerate(zip(centers, radii)):
        time = Usd.TimeCode(frame) if moves else Usd.TimeCode.Default()
        where.Set(Vt.Vec3fArray.FromNumpy(center), time)
        size.Set(sizes[frame], time)
        if len(center):
            low, high = (center - radius[:, None]).min(axis=0), (center + radius[:, None]).max(axis=0)
            extent.Set(Vt.Vec3fArray.FromNumpy(numpy.array([low, high], numpy.float32)), time)
    _export(stage, path)


def write_mesh(
    path: str | os.PathLike[str],
    mesh: MeshLike,
    frames: FloatArray | None = None,
    *,
    frames_per_second: float = 24.0,
    up: str = "Y",
) -> None:
    """A mesh, and its positions (frames, vertices, 3) as time samples; in single precision. The write is atomic."""
    _check_ending(path)
    if up not in ("Y", "Z"):
        raise ValueError(f"up: {up!r} is neither Y nor Z, which USD knows")
    own = _morula.Mesh.of(mesh)
    motion = None if frames is None else numpy.asarray(frames, dtype=numpy.float64)
    if motion is not None and motion.shape[1:] != (own.vertex_count, 3):
        raise ValueError(f"frames: shape {motion.shape}, but (frames, {own.vertex_count}, 3) is needed")
    stage = _new_stage(0 if motion is None else len(motion), frames_per_second, up)
    stage.SetDefaultPrim(UsdGeom.Xform.Define(stage, "/morula").GetPrim())
    surface = UsdGeom.Mesh.Define(stage, "/morula/surface")
    surface.CreateSubdivisionSchemeAttr(UsdGeom.Tokens.none)
    faces = numpy.asarray(own.faces, dtype=numpy.int32)
    surface.CreateFaceVertexCountsAttr(Vt.IntArray.FromNumpy(numpy.full(len(faces), 3, numpy.int32)))
    surface.CreateFaceVertexIndicesAttr(Vt.IntArray.FromNumpy(numpy.ascontiguousarray(faces.ravel())))
    where, extent = surface.CreatePointsAttr(), surface.CreateExtentAttr()
    for frame, positions in enumerate([own.vertices] if motion is None else motion):
        time = Usd.TimeCode.Default() if motion is None else Usd.TimeCode(frame)
        points = numpy.ascontiguousarray(positions, dtype=numpy.float32)
        where.Set(Vt.Vec3fArray.FromNumpy(points), time)
        if len(points):
            extent.Set(Vt.Vec3fArray.FromNumpy(numpy.array([points.min(axis=0), points.max(axis=0)])), time)
    _export(stage, path)


def _narrowed(frames: NDArray[numpy.float64]) -> tuple[NDArray[numpy.float32], NDArray[numpy.float32]]:
    """Spheres in single precision that contain the given ones."""
    with numpy.errstate(over="ignore"):
        centers = frames[..., :3].astype(numpy.float32)
    if not numpy.isfinite(centers).all():
        raise ValueError("spheres: a coordinate is too large for single precision, which USD holds")
    moved = numpy.linalg.norm(centers.astype(numpy.float64) - frames[..., :3], axis=-1)
    # What the norm and the sum lose by rounding is far less than this share of them.
    return numpy.ascontiguousarray(centers), _up(frames[..., 3] + moved * (1 + 2.0**-40) + numpy.where(moved > 0, 2.0**-50, 0) * frames[..., 3])


def _up(values: NDArray[numpy.float64]) -> NDArray[numpy.float32]:
    """The least float that is not below the value."""
    near = values.astype(numpy.float32)
    return numpy.where(near.astype(numpy.float64) < values, numpy.nextafter(near, numpy.float32(numpy.inf)), near)


def _open(path: str | os.PathLike[str], roots: Iterable[str | os.PathLike[str]]) -> Any:
    name = os.fspath(path)
    if not os.path.exists(name):
        raise FileNotFoundError(f"{name}: there is no such file")
    own = os.path.dirname(os.path.abspath(name))
    folders = [pathlib.Path(os.path.realpath(folder)) for folder in (own, *roots)]
    try:
        # A layer that was opened before would be given again, whatever the file holds now.
        layer = Sdf.Layer.OpenAsAnonymous(name)
        if layer:
            _check_references(name, layer, own, folders, set())
        stage = Usd.Stage.Open(layer) if layer else None
    except OSError:
        raise
    except Exception as error:  # Tf.ErrorException, which is not to be caught by name
        raise OSError(f"{name}: {str(error).strip().splitlines()[-1]}") from None
    if stage is None:
        raise OSError(f"{name}: cannot be read as USD")
    # What is not referred to but used all the same, such as value clips.
    for used in stage.GetUsedLayers():
        if not used.anonymous:
            _check_place(name, used.realPath, folders)
    return stage


def _check_references(name: str, layer: Any, folder: str, folders: list[pathlib.Path], seen: set[str]) -> None:
    """Checks that all references of a layer lie in one of the folders, ahead of reading them."""
    for asset in layer.GetCompositionAssetDependencies():
        file = os.path.join(folder, asset)
        if not asset or file in seen or not os.path.exists(file):
            continue
        seen.add(file)
        _check_place(name, file, folders)
        below = Sdf.Layer.FindOrOpen(file)
        if below:
            _check_references(name, below, os.path.dirname(file), folders, seen)


def _check_place(name: str, file: str, folders: list[pathlib.Path]) -> None:
    real = pathlib.Path(os.path.realpath(file))
    if not any(real.is_relative_to(folder) for folder in folders):
        allowed = " and ".join(map(str, folders))
        raise OSError(f"{name}: refers to {real}, which lies outside {allowed}; allow its folder with roots=[{str(real.parent)!r}]")


def _meshes(stage: Any) -> list[Any]:
    return [prim for prim in stage.TraverseAll() if prim.IsA(UsdGeom.Mesh)]


def _one_mesh(path: str | os.PathLike[str], stage: Any, wanted: str | None) -> Any:
    found = _meshes(stage)
    if wanted is not None:
        found = [prim for prim in found if str(prim.GetPath()) == wanted]
    if len(found) == 1:
        return UsdGeom.Mesh(found[0])
    there = ", ".join(str(prim.GetPath()) for prim in _meshes(stage)[:20]) or "no meshes"
    if wanted is not None:
        raise ValueError(f"{path}: there is no mesh {wanted}; there are {there}")
    raise ValueError(f"{path}: there are {there}" + ("; name one with prim=" if found else ""))


def _times_of(mesh: Any) -> list[Any]:
    """Times at which points, or transforms above them, are given."""
    times = set(mesh.GetPointsAttr().GetTimeSamples())
    prim = mesh.GetPrim()
    while prim and not prim.IsPseudoRoot():
        if prim.IsA(UsdGeom.Xformable):
            times.update(UsdGeom.Xformable(prim).GetTimeSamples())
        prim = prim.GetParent()
    return [Usd.TimeCode(time) for time in sorted(times)] or [Usd.TimeCode.Default()]


def _positions(path: str | os.PathLike[str], mesh: Any, time: Any) -> NDArray[numpy.float64]:
    points = mesh.GetPointsAttr().Get(time)
    if points is None or len(points) == 0:
        raise ValueError(f"{path}: {mesh.GetPath()} has no points")
    matrix = numpy.array(mesh.ComputeLocalToWorldTransform(time), dtype=numpy.float64)
    local = numpy.asarray(points, dtype=numpy.float64).reshape(-1, 3)
    # Rows are multiplied from the left in USD.
    return numpy.ascontiguousarray(local @ matrix[:3, :3] + matrix[3, :3])


def _faces(path: str | os.PathLike[str], mesh: Any, points: NDArray[numpy.float64]) -> NDArray[numpy.int64]:
    """Triangles that face outward in the world. points: positions at the first time, which determine the triangulation."""
    for attribute in (mesh.GetFaceVertexCountsAttr(), mesh.GetFaceVertexIndicesAttr()):
        if len(attribute.GetTimeSamples()) > 1 and any(
            list(attribute.Get(time)) != list(attribute.Get(attribute.GetTimeSamples()[0])) for time in attribute.GetTimeSamples()
        ):
            raise ValueError(f"{path}: the facets of {mesh.GetPath()} change, and those of a motion may not")
    first = Usd.TimeCode.EarliestTime()
    counts = numpy.asarray(mesh.GetFaceVertexCountsAttr().Get(first) or [], dtype=numpy.int64)
    indices = numpy.asarray(mesh.GetFaceVertexIndicesAttr().Get(first) or [], dtype=numpy.int64)
    if (counts < 0).any() or counts.sum() != len(indices):
        raise ValueError(f"{path}: the facets of {mesh.GetPath()} have {counts.sum()} corners, and {len(indices)} are given")
    holes = numpy.asarray(mesh.GetHoleIndicesAttr().Get(first) or [], dtype=numpy.int64)
    begin = numpy.concatenate([[0], numpy.cumsum(counts)[:-1]]) if len(counts) else numpy.empty(0, numpy.int64)
    kept = numpy.ones(len(counts), bool)
    kept[holes[(holes >= 0) & (holes < len(counts))]] = False
    triangles = []
    for size in numpy.unique(counts[kept]):
        at = begin[kept & (counts == size)]
        if size < 3:
            continue
        corners = indices[at[:, None] + numpy.arange(size)]
        cut = _morula._cut_polygons(points, int(size), corners.ravel()).facets  # type: ignore[attr-defined]
        # All first facets come first, then all second ones.
        triangles.append(cut.reshape(len(at), size - 2, 3).transpose(1, 0, 2).reshape(-1, 3).astype(numpy.int64))
    faces = numpy.concatenate(triangles) if triangles else numpy.empty((0, 3), numpy.int64)
    left = mesh.GetOrientationAttr().Get() == UsdGeom.Tokens.leftHanded
    time = _times_of(mesh)[0]
    mirrored = Gf.Matrix4d(mesh.ComputeLocalToWorldTransform(time)).GetDeterminant3() < 0
    return faces[:, [0, 2, 1]] if left != mirrored else faces


def _check_ending(path: str | os.PathLike[str]) -> None:
    if pathlib.Path(path).suffix.lower() not in _ENDINGS:
        raise ValueError(f"{os.fspath(path)}: USD files end in {', '.join(_ENDINGS)}")


def _new_stage(frames: int, frames_per_second: float, up: str) -> Any:
    if not frames_per_second > 0:
        raise ValueError(f"frames_per_second: {frames_per_second} is not above 0")
    stage = Usd.Stage.CreateInMemory()
    UsdGeom.SetStageUpAxis(stage, up)
    if frames:
        stage.SetTimeCodesPerSecond(frames_per_second)
        stage.SetFramesPerSecond(frames_per_second)
        stage.SetStartTimeCode(0)
        stage.SetEndTimeCode(frames - 1)
    return stage


def _export(stage: Any, path: str | os.PathLike[str]) -> None:
    target = pathlib.Path(path)
    handle, name = tempfile.mkstemp(suffix=target.suffix, prefix=f".{target.stem}.", dir=target.parent)
    os.close(handle)
    try:
        if not stage.GetRootLayer().Export(name):
            raise OSError(f"{target}: cannot be written")
        mask = os.umask(0)
        os.umask(mask)
        os.chmod(name, 0o666 & ~mask)
        os.replace(name, target)
    except BaseException:
        pathlib.Path(name).unlink(missing_ok=True)
        raise
