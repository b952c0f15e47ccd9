# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The types of arguments, for type checkers."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol, Union

__all__ = [
    "Array", "Axis", "Budget", "ClumpFormatName", "ClumpKind", "ColliderLike", "Features", "FloatArray", "HasFaces", "InnerBoxes",
    "InnerCenter", "MeshLike", "Method", "ModalBound", "Obstacle", "Optimizer", "Transform", "Priority", "Quality", "RebuildEffort",
    "RebuildThread", "Reduction", "Rule", "Shape", "SignMethod", "Vector", "Weights", "WrappedCenter",
]

if TYPE_CHECKING:
    import datetime

    import numpy
    from numpy.typing import NDArray

    from . import _morula

    # Literal types of the names that arguments take, made from the library's tables when the package is built.
    from ._morula.choices import Axis as Axis
    from ._morula.choices import ClumpFormatName as ClumpFormatName
    from ._morula.choices import ClumpKind as ClumpKind
    from ._morula.choices import Features as Features
    from ._morula.choices import InnerBoxes as InnerBoxes
    from ._morula.choices import InnerCenter as InnerCenter
    from ._morula.choices import Method as Method
    from ._morula.choices import ModalBound as ModalBound
    from ._morula.choices import Optimizer as Optimizer
    from ._morula.choices import Priority as Priority
    from ._morula.choices import Quality as Quality
    from ._morula.choices import RebuildEffort as RebuildEffort
    from ._morula.choices import RebuildThread as RebuildThread
    from ._morula.choices import Reduction as Reduction
    from ._morula.choices import Rule as Rule
    from ._morula.choices import SignMethod as SignMethod
    from ._morula.choices import Weights as Weights
    from ._morula.choices import WrappedCenter as WrappedCenter

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
    #: Where a body is: a matrix (4, 4) or (3, 4) acts on columns; a Vector is a translation.
    Transform = Union[_morula.RigidTransform, FloatArray, Vector]
    Obstacle = Union[_morula.HalfSpace, _morula.Capsule, _morula.ConvexHull, _morula.DistanceField, Vector]
else:
    Array = FloatArray = MeshLike = Vector = Budget = ColliderLike = Shape = Obstacle = Transform = Any
    HasFaces = object
    Axis = ClumpFormatName = ClumpKind = Features = InnerBoxes = InnerCenter = Method = ModalBound = Optimizer = Priority = str
    Quality = RebuildEffort = RebuildThread = Reduction = Rule = SignMethod = Weights = WrappedCenter = str
