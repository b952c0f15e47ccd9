# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A broad phase for the IPC Toolkit: candidates found by Morula's surface tree.

>>> candidates = ipctk.Candidates()
>>> candidates.build(collision_mesh, vertices, inflation_radius, morula.ipctk.BroadPhase())

One object serves all frames of one mesh: it makes its tree once, and the tree follows the vertices.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import ipctk  # type: ignore[import-not-found,import-untyped,unused-ignore]
import numpy
from numpy.typing import NDArray

from . import _morula

__all__ = ["BroadPhase"]


class _Known:
    """Candidates of the last call: most candidates stay from frame to frame, and the toolkit copies its input.

    It accepts candidates as Python objects only, and creating one costs ten times as much as passing it.
    """

    def __init__(self, kind: Any) -> None:
        self._kind = kind
        self._codes: NDArray[numpy.int64] = numpy.empty(0, numpy.int64)
        self._objects: NDArray[Any] = numpy.empty(0, object)

    def of(
        self, first: NDArray[Any], second: NDArray[Any], may: Callable[[NDArray[Any], NDArray[Any]], NDArray[numpy.bool_]]
    ) -> list[Any]:
        """Candidates (first[i], second[i]), each pair once, in the order of both; may: filter, called for new ones."""
        codes = first.astype(numpy.int64) << 32 | second
        codes.sort()
        objects = numpy.empty(len(codes), object)
        if len(self._codes) and len(codes):
            place = numpy.minimum(numpy.searchsorted(self._codes, codes), len(self._codes) - 1)
            known = self._codes[place] == codes
            objects[known] = self._objects[place[known]]
            new = numpy.flatnonzero(~known)
        else:
            new = numpy.arange(len(codes))
        if len(new):
            of_new = codes[new] >> 32, codes[new] & 0xFFFFFFFF
            counts = may(*of_new)
            made = numpy.empty(len(new), object)
            made[counts] = list(map(self._kind, of_new[0][counts].tolist(), of_new[1][counts].tolist()))
            objects[new] = made
        self._codes, self._objects = codes, objects
        return [found for found in objects.tolist() if found is not None]

    def forget(self) -> None:
        self._codes, self._objects = self._codes[:0], self._objects[:0]


class BroadPhase(ipctk.BroadPhase):  # type: ignore[misc,unused-ignore]
    """Pairs of edges, and of faces and vertices, that are within twice the inflation radius, at one time or in a step.

    The toolkit's own broad phases find all pairs whose boxes, enlarged by the radius, overlap. Most of these are farther
    apart, and the toolkit tests them again. Collisions and collision-free steps are the same; with `boxes=True` so are the
    candidates.

    Meshes must be triangle meshes in three dimensions, with every edge and vertex on a face. Pairs that share a vertex are
    skipped. The mesh's filter (`can_collide`) is called for pairs that were not near in the previous call; after a change of
    the filter, call forget().
    """

    def __init__(self, workers: _morula.Workers | None = None, *, boxes: bool = False) -> None:
        ipctk.BroadPhase.__init__(self)
        self._workers = workers
        self._boxes = boxes
        self._surface: _morula.SurfaceTree | None = None
        self._faces: NDArray[Any] | None = None
        self._edges: NDArray[Any] = numpy.empty((0, 2), numpy.int32)
        self._edge_of: NDArray[numpy.int64] = numpy.empty(0, numpy.int64)
        self._found: _morula.FeaturePairs | _morula.ProximityPairs | _morula.SweptPairs | None = None
        self._radius = 0.0
        self._edge_edge = _Known(ipctk.EdgeEdgeCandidate)
        self._face_vertex = _Known(ipctk.FaceVertexCandidate)

    def name(self) -> str:
        return "Morula"

    def build(self, vertices: NDArray[Any], *rest: Any) -> None:
        """build(vertices, edges, faces, radius), or with the vertices at the end of a step after the first ones."""
        is_step = numpy.asarray(rest[0]).dtype.kind == "f"
        to = numpy.ascontiguousarray(rest[0]) if is_step else None
        edges, faces, *radius = rest[1:] if is_step else rest
        self._radius = float(radius[0]) if radius else 0.0
        start = numpy.ascontiguousarray(vertices)
        if start.shape[1] != 3:
            raise ValueError(f"vertices: shape {start.shape}, but Morula's surfaces are in three dimensions")
        self._follow_topology(start, edges, faces)
        assert self._surface is not None
        self._surface.update(start, to, workers=self._workers)
        self._found = None

    def clear(self) -> None:
        """Drops candidates; the tree stays, for the next frame."""
        self._found = None

    def forget(self) -> None:
        """Drops candidates and the results of the filter."""
        self._found = None
        self._edge_edge.forget()
        self._face_vertex.forget()

    def _follow_topology(self, start: NDArray[Any], edges: NDArray[Any], faces: NDArray[Any]) -> None:
        if (
            self._surface is not None
            and self._faces is not None
            and self._surface.vertex_count == len(start)
            and numpy.array_equal(self._faces, faces)
            and len(edges) == len(self._edge_of)
        ):
            return
        if len(faces) == 0 or len(numpy.unique(faces)) != len(start):
            raise ValueError("faces: every vertex has to be on a face; give other meshes to a broad phase of the toolkit's own")
        surface = _morula.SurfaceTree((start, numpy.ascontiguousarray(faces)))
        count = len(start)
        theirs = numpy.sort(numpy.asarray(edges, numpy.int64), axis=1) @ numpy.array([count, 1])
        order = numpy.argsort(theirs)
        ours = surface.edges.astype(numpy.int64) @ numpy.array([count, 1])
        if len(ours) != len(theirs) or not numpy.array_equal(theirs[order], ours):
            raise ValueError("edges: they have to be those of the faces; give other meshes to a broad phase of the toolkit's own")
        self._surface, self._faces, self._edges, self._edge_of = surface, numpy.array(faces), numpy.array(edges), order
        self.forget()

    def _pairs(self, kind: _morula.PairKind) -> tuple[NDArray[Any], NDArray[Any]]:
        if self._surface is None:
            raise RuntimeError("nothing was built")
        if self._found is None:
            # The toolkit inflates both boxes.
            distance = 2 * self._radius
            if self._boxes:
                self._found = _morula.swept_candidates(self._surface, distance=distance, workers=self._workers)
            elif self._surface.is_step:
                self._found = _morula.swept(self._surface, distance=distance, workers=self._workers)
            else:
                # A little farther than where the toolkit's distances, computed otherwise, could still be less.
                self._found = _morula.proximity(self._surface, distance=distance * (1 + 1e-9), workers=self._workers)
        chosen = self._found.kind == int(kind)
        return self._found.a[chosen], self._found.b[chosen]

    def detect_edge_edge_candidates(self) -> list[Any]:
        a, b = self._pairs(_morula.PairKind.edge_edge)
        first, second = self._edge_of[a], self._edge_of[b]
        return self._edge_edge.of(
            numpy.minimum(first, second), numpy.maximum(first, second), lambda i, j: self._may(self._edges[i], self._edges[j])
        )

    def detect_face_vertex_candidates(self) -> list[Any]:
        vertex, face = self._pairs(_morula.PairKind.vertex_facet)
        assert self._faces is not None
        faces = self._faces
        return self._face_vertex.of(face, vertex, lambda f, v: self._may(faces[f], v[:, None]))

    def _may(self, a: NDArray[Any], b: NDArray[Any]) -> NDArray[numpy.bool_]:
        """True if the filter allows a vertex of a[i] to collide with a vertex of b[i]."""
        allows = self.can_vertices_collide
        may = numpy.zeros(len(a), bool)
        for j in range(b.shape[1]):
            for i in range(a.shape[1]):
                rest = numpy.flatnonzero(~may)
                if len(rest):
                    may[rest] = list(map(allows, a[rest, i].tolist(), b[rest, j].tolist()))
        return may
