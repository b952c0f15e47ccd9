# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Messages of a TypeError: the function, the argument, its type and the accepted types.

Functions of the extension know their signatures as text. A call that fits none is compared with them argument by
argument; the message describes the overload with the fewest misfits. A class without a constructor is searched in the
results of functions.
"""

from __future__ import annotations

import ast
import difflib
import functools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any

from . import _morula
#: Names that arguments take, by their types.
_CHOICES: dict[str, list[str]] = getattr(_morula, "_choices")
#: What nanobind says of a call that fits no overload.
_NO_OVERLOAD = "incompatible function arguments"
_WANTED = {
    "Array": "an array",
    "FloatArray": "an array of float32 or float64",
    "MeshLike": "a mesh: a morula.Mesh, anything with .vertices and .faces, a meshio.Mesh of triangles, or a tuple (positions, facets)",
    "Vector": "a point (three numbers) or a sphere (four)",
    "ColliderLike": "a Collider, a Body, a RebuiltBody or PosedSpheres",
    "Shape": "a HalfSpace, a Capsule, a ConvexHull or a sphere (x, y, z, radius)",
    "Obstacle": "a HalfSpace, a Capsule, a ConvexHull, a DistanceField or a sphere (x, y, z, radius)",
    "Transform": "a RigidTransform, a matrix (4, 4) or (3, 4), or a translation (x, y, z)",
    "Workers": "Workers, such as morula.Workers(2)",
    "str": "a text", "int": "an integer", "float": "a number", "bool": "True or False",
}


@dataclass
class _Parameter:
    name: str
    annotation: ast.expr | None
    is_positional: bool
    is_named: bool
    is_needed: bool


@dataclass
class _Overload:
    parameters: list[_Parameter]
    takes_any: bool
    text: str


def reworded(function: Any, given: list[Any], named: dict[str, Any], text: str, has_content: bool) -> str:
    """The message of a TypeError that `function` has raised for these arguments. has_content: False if the
    arguments begin with an instance whose __init__ was not called."""
    place = _places().get(id(function))
    label = place.label if place else f"{function.__qualname__}()"
    if place and place.owner and given:
        if not isinstance(given[0], place.owner):
            return f"{label}: self: {_described(given[0])}, but {_class_wanted(place.owner.__name__)} is needed"
        if not has_content and place.name != "__init__":
            return f"{label}: self has nothing in it: __init__() of a derived class has to call super().__init__()"
    if _NO_OVERLOAD not in text:
        return text if text.startswith(label) else f"{label}: {text}"
    overloads = [_overload(signature[0]) for signature in function.__nb_signature__]
    # The misfits of each; the one with the fewest was meant. Of several, the first.
    found = [_misfits(overload, given, named) for overload in overloads]
    best = min(found, key=len)
    takes = " or ".join(overload.text for overload in overloads)
    return f"{label}: {'; '.join(best)}. It takes {takes}"


def rejected(kind: type) -> str:
    """The message of a TypeError of a call of this class, or of a derived one, which only functions create."""
    return _rejection(next(base for base in kind.__mro__ if base.__module__.startswith(_morula.__name__)))


@functools.cache
def _rejection(own: type) -> str:
    name = re.compile(rf"(?<!typing\.)\b{own.__name__}\b")
    given = re.compile(rf"(\w+): [\w.]*Callable\[\[[^\]]*\b{own.__name__}\b")
    sources: dict[str, _Place] = {}
    calls = []
    for place, function in _functions():
        for signature, *_ in function.__nb_signature__:
            arguments, _, result = signature.rpartition(" -> ")
            if name.search(result) and not place.name.startswith("__"):
                sources.setdefault(place.full_label, place)
            elif found := given.search(arguments):
                calls.append(f"what {place.full_label} is given as {found[1]}")
    said = f"{own.__name__}(): the class cannot be called"
    if sources:
        # Functions first, and no more than tell where to look.
        return f"{said}: {_or(sorted(sources, key=lambda label: sources[label].rank)[:3])} returns one"
    return f"{said}: {_or(calls[:3])} gets one" if calls else said


def _or(parts: list[str]) -> str:
    return " or ".join([", ".join(parts[:-1]), parts[-1]] if len(parts) > 1 else parts)


@dataclass
class _Place:
    """The place of a function of the extension."""

    module: str
    kind: type | None
    name: str
    is_attribute: bool
    #: The class whose instance it is called with.
    owner: type | None

    @property
    def label(self) -> str:
        if self.kind is None:
            return f"{self.name}()"
        if self.name in ("__init__", "__new__"):
            return f"{self.kind.__name__}()"
        return f"{self.kind.__name__}.{self.name}{'' if self.is_attribute else '()'}"

    @property
    def full_label(self) -> str:
        return self.label if self.kind else f"{self.module.replace('._morula', '')}.{self.label}"

    @property
    def rank(self) -> int:
        return 0 if self.kind is None else 2 if self.is_attribute else 1


def _functions() -> Iterator[tuple[_Place, Any]]:
    """All functions of the extension, with those that read or set an attribute."""
    for module in (_morula, *(value for value in vars(_morula).values() if isinstance(value, ModuleType))):
        for name, value in vars(module).items():
            if isinstance(value, type) and value.__module__ == module.__name__:
                yield from _functions_of_class(module.__name__, value)
            elif hasattr(value, "__nb_signature__"):
                yield _Place(module.__name__, None, name, False, None), value


def _functions_of_class(module: str, kind: type) -> Iterator[tuple[_Place, Any]]:
    for name, value in vars(kind).items():
        if hasattr(value, "__nb_signature__"):
            has_self = re.match(r"def \w+\(self\b", _head(value.__nb_signature__[0][0]))
            yield _Place(module, kind, name, False, kind if has_self else None), value
        for part in ("fget", "fset"):
            function = getattr(value, part, None)
            if hasattr(function, "__nb_signature__"):
                yield _Place(module, kind, name, True, kind), function


@functools.cache
def _places() -> dict[int, _Place]:
    """Places by the id of a function; the first name of a function with several."""
    places: dict[int, _Place] = {}
    for place, function in _functions():
        places.setdefault(id(function), place)
    return places


def _head(signature: str) -> str:
    """The line of a signature with the arguments; it has no name for an attribute."""
    return next(line for line in signature.strip().splitlines() if line.startswith("def ")).replace("def (", "def _(", 1)


def _overload(signature: str) -> _Overload:
    # Defaults stand outside of the text, as \0, \1, ...
    text = re.sub(r"\\\d+", "...", signature)
    # What it returns is no business of its arguments.
    head = _head(text).rpartition(") -> ")[0]
    definition = ast.parse(f"{head}): ...").body[0]
    assert isinstance(definition, ast.FunctionDef)
    args = definition.args
    positional = [*args.posonlyargs, *args.args]
    needed = len(positional) - len(args.defaults)
    parameters = [_Parameter(a.arg, a.annotation, True, i >= len(args.posonlyargs), i < needed) for i, a in enumerate(positional)]
    parameters += [_Parameter(a.arg, a.annotation, False, True, d is None) for a, d in zip(args.kwonlyargs, args.kw_defaults)]
    if positional and positional[0].arg == "self":
        del (args.posonlyargs or args.args)[0]
    text = re.sub(r"\b(morula\.typing|morula\._morula\.robot|morula\._morula|collections\.abc|numpy\.typing|numpy|typing)\.", "", ast.unparse(args))
    return _Overload(parameters, args.vararg is not None or args.kwarg is not None, f"({text})")


def _misfits(overload: _Overload, given: list[Any], named: dict[str, Any]) -> list[str]:
    misfits = []
    positional = [p for p in overload.parameters if p.is_positional]
    if len(given) > len(positional) and not overload.takes_any:
        own = [p for p in positional if p.name != "self"]
        misfits.append(f"{_count(len(given) - (len(positional) - len(own)))} without a name, but at most {len(own)} may have none")
    pairs = list(zip(positional, given))
    taken = {p.name for p, _ in pairs}
    by_name = {p.name: p for p in overload.parameters if p.is_named}
    for name, value in named.items():
        if name in taken:
            misfits.append(f"{name} is given twice")
        elif name in by_name:
            pairs.append((by_name[name], value))
            taken.add(name)
        elif not overload.takes_any:
            near = difflib.get_close_matches(name, by_name, 1)
            misfits.append(f"there is no argument '{name}'" + (f", but there is '{near[0]}'" if near else ""))
    misfits += [f"{p.name} is missing" for p in overload.parameters if p.is_needed and p.name not in taken]
    for parameter, value in pairs:
        if parameter.annotation is not None and not _fits(parameter.annotation, value):
            misfits.append(f"{parameter.name}: {_described(value)}, but {_wanted(parameter.annotation)} is needed")
    if misfits:
        return misfits
    # All are of the right kinds: some number is beyond what the library counts with.
    beyond = [(p, v) for p, v in pairs if isinstance(v, int) and not isinstance(v, bool) and not 0 <= v < 2**31]
    if beyond:
        return [f"{p.name}: {v} is out of range" for p, v in beyond]
    return [f"{p.name}: {_described(v)} is not what is needed" for p, v in pairs if p.name != "self"]


def _count(number: int) -> str:
    return "one argument is" if number == 1 else f"{number} arguments are"


def _described(value: Any) -> str:
    if value is None or isinstance(value, (bool, int, float)):
        return repr(value)
    if isinstance(value, str):
        return repr(value if len(value) <= 40 else value[:40] + "…")
    kind = type(value).__name__
    if hasattr(value, "dtype") and hasattr(value, "shape"):
        return f"an array of {value.dtype}, shape {tuple(value.shape)}"
    if isinstance(value, (list, tuple, dict, set)):
        return f"a {kind} of {len(value)}"
    return f"an object of type {kind}"


def _wanted(annotation: ast.expr) -> str:
    if isinstance(annotation, ast.BinOp):
        return f"{_wanted(annotation.left)}, or {_wanted(annotation.right)}"
    if isinstance(annotation, ast.Subscript):
        kind, inner = _last(annotation.value), annotation.slice
        if kind == "Callable":
            return "a function"
        if kind == "Literal":
            return "one of " + ast.unparse(inner).strip("()")
        parts = inner.elts if isinstance(inner, ast.Tuple) else [inner]
        return f"a {kind.lower()} (each: {'; '.join(_wanted(p) for p in parts if not isinstance(p, ast.Constant))})"
    name = _last(annotation)
    if name in _WANTED:
        return _WANTED[name]
    if name in _CHOICES:
        return "one of " + ", ".join(_CHOICES[name])
    return name if name in ("None", "") else _class_wanted(name)


def _class_wanted(name: str) -> str:
    return f"{'an' if name[0] in 'AEIOU' else 'a'} {name}"


def _last(annotation: ast.expr) -> str:
    if isinstance(annotation, ast.Attribute):
        return annotation.attr
    return ast.unparse(annotation)


def _is_number(value: Any) -> bool:
    return isinstance(value, (bool, int, float)) or (hasattr(value, "__float__") and getattr(value, "ndim", 0) == 0)


def _is_integer(value: Any) -> bool:
    return isinstance(value, int) or (hasattr(value, "__index__") and getattr(value, "ndim", 0) == 0)


def _items(value: Any) -> list[Any] | None:
    """The items of a list-like value; None for other values."""
    if isinstance(value, (str, bytes, dict)) or not hasattr(value, "__iter__"):
        return None
    return list(value) if hasattr(value, "__len__") else []


def _fits(annotation: ast.expr, value: Any) -> bool:
    """True if an argument with this annotation accepts the value, or if that is unknown."""
    if isinstance(annotation, ast.BinOp):
        return _fits(annotation.left, value) or _fits(annotation.right, value)
    if isinstance(annotation, ast.Subscript):
        return _fits_container(_last(annotation.value), annotation.slice, value)
    name = _last(annotation)
    if name == "None":
        return value is None
    if name in ("object", "Any"):
        return True
    if value is None:
        return name == "Budget"
    if name == "str" or name in _CHOICES:
        return isinstance(value, str)
    if name == "bool":
        return isinstance(value, bool) or type(value).__name__ in ("bool_", "bool")
    if name == "int":
        return _is_integer(value)
    if name == "float":
        return _is_number(value)
    if name == "Vector":
        items = _items(value)
        return items is not None and len(items) in (3, 4) and all(_is_number(item) for item in items)
    if name == "PathLike":
        return hasattr(value, "__fspath__")
    own = getattr(_morula, name, None) or getattr(getattr(_morula, "robot", None), name, None)
    if isinstance(own, type):
        return isinstance(value, own)
    plain = {"dict": dict, "list": list, "tuple": tuple, "set": set, "bytes": bytes}.get(name)
    return plain is None or isinstance(value, plain)


def _fits_container(kind: str, inner: ast.expr, value: Any) -> bool:
    if kind == "Callable":
        return callable(value)
    if kind == "Literal":
        return isinstance(value, str)
    parts = inner.elts if isinstance(inner, ast.Tuple) else [inner]
    if kind == "dict":
        return isinstance(value, dict) and all(_fits(parts[0], k) and _fits(parts[1], v) for k, v in value.items())
    if kind == "set" and not isinstance(value, (set, frozenset)):
        return False
    items = _items(value)
    if items is None:
        return False
    if kind == "tuple" and not isinstance(parts[-1], ast.Constant):
        return len(items) == len(parts) and all(_fits(p, item) for p, item in zip(parts, items))
    return all(_fits(parts[0], item) for item in items)
