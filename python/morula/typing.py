# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""What arguments may be, for type checkers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, Union

__all__ = ["Array", "Budget", "ColliderLike", "FloatArray", "HasFaces", "MeshLike", "Obstacle", "Shape", "Vector"]

if TYPE_CHECKING:
    import datetime

    import numpy
    from numpy.typing import NDArray

    from . import _morula

    class HasFaces(Protocol):
        """Anything with vertices (n, 3) and faces (m, 3), such as trimesh.Trimesh."""

        @property
        def vertices(self) -> Any: ...
        @property
        def faces(self) -> Any: ...

    class HasCells(Protocol):
        """A meshio.Mesh."""

        points: Any
        cells: Any

    #: An array of any kind: NumPy's, or what speaks DLPack or the buffer protocol.
    Array = Any
    #: Positions, float32 or float64.
    FloatArray = Union[NDArray[numpy.float64], NDArray[numpy.float32]]
    MeshLike = Union[_morula.Mesh, HasFaces, HasCells, tuple[Array, Array]]
    #: A point or direction (3), or a sphere (4).
    Vector = Union[Sequence[float], NDArray[numpy.float64], NDArray[numpy.float32]]
    #: Pair tests, or a time: "200us", "5ms", "1s".
    Budget = Union[int, datetime.timedelta, str, None]
    ColliderLike = Union[_morula.Collider, _morula.Body, _morula.RebuiltBody, _morula.PosedSpheres]
    Shape = Union[_morula.HalfSpace, _morula.Capsule, _morula.ConvexHull, Vector]
    Obstacle = Union[_morula.HalfSpace, _morula.Capsule, _morula.ConvexHull, _morula.DistanceField, Vector]
else:
    Array = FloatArray = MeshLike = Vector = Budget = ColliderLike = Shape = Obstacle = Any
    HasFaces = object
