# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The study: the evaluation of the paper, on any meshes, on one machine or several; extras/study/docs/study.md."""

from __future__ import annotations

# What only some calls need is imported there: morula is to be there at once.
import os
import pathlib
from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING, Any, Union

from . import _morula

if TYPE_CHECKING:
    import concurrent.futures

    from .typing import FloatArray, MeshLike

__all__ = ["Study", "study"]

Bodies = Union["MeshLike", Mapping[str, "MeshLike"], str, "os.PathLike[str]", Sequence[Union[str, "os.PathLike[str]"]], None]


class Study:
    """The results of a study, as plain values.

    claims: rows of `id`, `verdict`, `numbers`, `trials`, `value` and more; tables: by id, columns by name; figures: by id, as in study.json, with
    their curves in `series`; cells: columns of cells.csv, numbers as arrays with NaN for missing values; json: all
    of study.json; faults: violated guarantees, as text.
    """

    def __init__(self, text: str, cells: str, faults: list[str]) -> None:
        import json

        self.json: dict[str, Any] = json.loads(text)
        self.faults = faults
        self.claims: list[dict[str, Any]] = self.json["claims"]
        self.figures: dict[str, dict[str, Any]] = {figure["id"]: figure for figure in self.json["figures"]}
        self.tables: dict[str, dict[str, list[Any]]] = {
            table["id"]: {
                column: [row[i] for row in table["rows"]] for i, column in enumerate(table["columns"])
            }
            for table in self.json["tables"]
        }
        self._cells = cells

    @property
    def stability(self) -> dict[str, Any] | None:
        """Verdicts of two halves of the seeds, compared: `seeds`, `compared`, `same`, `differing`; None for one seed."""
        found: dict[str, Any] | None = self.json["stability"]
        return found

    @property
    def cells(self) -> dict[str, Any]:
        """Columns of all cells: one row per body, tree, motion, rule, sample and level."""
        import csv
        import io

        import numpy

        header, *rows = csv.reader(io.StringIO(self._cells))
        columns: dict[str, Any] = {}
        for i, name in enumerate(header):
            values = [row[i] for row in rows]
            try:
                columns[name] = numpy.array([float(v) if v else numpy.nan for v in values])
            except ValueError:
                columns[name] = numpy.array(values)
        return columns

    def verdict(self, claim: str) -> str:
        """The verdict on the claim with this id: holds, partly, fails or not decided."""
        for found in self.claims:
            if found["id"] == claim:
                return str(found["verdict"])
        raise KeyError(claim)

    def __repr__(self) -> str:
        count: dict[str, int] = {}
        for claim in self.claims:
            count[claim["verdict"]] = count.get(claim["verdict"], 0) + 1
        return f"<morula.Study: {len(self.claims)} claims, {', '.join(f'{n} {word}' for word, n in sorted(count.items()))}>"


def _given(meshes: Bodies) -> tuple[dict[str, _morula.Mesh], list[str]]:
    if meshes is None:
        return {}, []
    if isinstance(meshes, (str, os.PathLike)):
        return {}, [os.fspath(meshes)]
    if isinstance(meshes, Mapping):
        return {name: _morula.Mesh.of(mesh) for name, mesh in meshes.items()}, []
    if isinstance(meshes, (list, tuple)) and all(isinstance(path, (str, os.PathLike)) for path in meshes):
        return {}, [os.fspath(path) for path in meshes]
    return {"mesh": _morula.Mesh.of(meshes)}, []  # type: ignore[arg-type]


def _shard(bodies: dict[str, _morula.Mesh], options: dict[str, Any], number: int, count: int, cells: str) -> int:
    """The function that an executor calls."""
    return _morula.study_shard(bodies, options, number, count, cells)


def _named(function: Any) -> tuple[str, str, Any]:
    """Name and version of a rule or generator of one's own, and itself."""
    return str(getattr(function, "name", None) or function.__name__), str(getattr(function, "version", "")), function


def study(
    meshes: Bodies = None,
    *,
    output: str | os.PathLike[str] | None = None,
    samples: Sequence[str] = (),
    motions: Sequence[str | os.PathLike[str]] | Mapping[str, FloatArray] = (),
    methods: Sequence[str | Callable[..., Any]] = (),
    rules: Sequence[str | Callable[..., Any]] = (),
    mixes: bool = False,
    trees: str | os.PathLike[str] = "",
    sph_origin: str = "bbox-center",
    frames: int = 0,
    resolution: int = 0,
    branching: int = 8,
    depth: int = 0,
    seed: int = 1,
    seeds: int = 0,
    unit: str = "volume",
    quick: bool = False,
    formats: Sequence[str] = ("svg", "csv"),
    metrics: Mapping[str, tuple[str, Callable[..., float]]] | None = None,
    variants: bool = False,
    paper_amounts: bool = False,
    executor: concurrent.futures.Executor | None = None,
    shards: int = 32,
    progress: Callable[[float, str], object] | None = None,
    workers: _morula.Workers | None = None,
) -> Study:
    """Repeats the evaluation of the paper, like `morula study`, with a verdict on each claim.

    Args:
        meshes: a mesh; meshes by name; paths of files; None for the sample bodies of the command. Options are those of the command,
            with its defaults.
        samples: names of sample bodies.
        motions: files of frames; or by name, arrays of shape (frames, vertices, 3). Each is of the first body that it fits.
        methods: names, and one's own generators: functions of (mesh) that return a CoveredTree, or a SphereTree, which is then
            made to cover. Own generators alone leave the default methods in place. Names and versions are as for rules.
        seeds: number of seeds from `seed` on, 0 for the default of 3, or 2 of a quick study: each body has a trial with each.
        rules: names, and one's own: classes or functions of (mesh, model), whose result has `follow(positions)`, which returns
            the spheres of all nodes as an array (nodes, 4). Own rules alone leave the default ones in place. The name is that
            of the class or its attribute `name`; an attribute `version` lets the study keep its cells.
        metrics: by name a unit and a function of (deformed mesh, spheres, level) that returns a number; its attribute `version`
            does the same. Without one, cells are measured in every run.
        variants, paper_amounts: tables of the command's options of these names.
        output: a folder for figures, tables, pictures and finished cells: the same files as the command's. A study that was
            interrupted continues from it. None: no files.
        formats: files of figures in the folder, of svg, csv, pdf and pgf.
        executor: an object like those of concurrent.futures, including Dask's and mpi4py's. It computes `shards` parts and
            stores their cells in the folder, which all workers must share. Figures are the same; only times differ.
        progress: called with the completed share and the present step; an exception of it ends the study.
        workers: threads of this process.

    ValueError for wrong options; ImportError if the package was built without the command.
    """
    if not hasattr(_morula, "study_files"):
        raise ImportError("morula.study: this package was built without the command: it needs CLI11 and fmt (docs/reference/python.md)")
    bodies, files = _given(meshes)
    options: dict[str, Any] = {
        "meshes": files, "methods": [method for method in methods if isinstance(method, str)],
        "own_generators": [_named(method) for method in methods if not isinstance(method, str)],
        "rules": [rule for rule in rules if isinstance(rule, str)],
        "own_rules": [_named(rule) for rule in rules if not isinstance(rule, str)],
        "metrics": [(name, of, str(getattr(value, "version", "")), value) for name, (of, value) in (metrics or {}).items()],
        "variants": variants, "paper_amounts": paper_amounts, "mixes": mixes, "trees": os.fspath(trees),
        "sph_origin": sph_origin, "frames": frames, "resolution": resolution, "branching": branching, "depth": depth,
        "seed": seed, "seeds": seeds, "unit": unit, "quick": quick, "formats": list(formats),
        "samples": list(samples), "motions": [] if isinstance(motions, Mapping) else [os.fspath(path) for path in motions],
        "own_motions": list(motions.items()) if isinstance(motions, Mapping) else [],
    }
    if executor is not None:
        if output is None:
            raise ValueError("output: a folder that all workers of the executor see is needed")
        _spread(bodies, options, pathlib.Path(output).absolute(), executor, shards, progress)
    return Study(*_morula.study_files(bodies, options, output, progress, workers))


def _spread(
    bodies: dict[str, _morula.Mesh], options: dict[str, Any], output: pathlib.Path, executor: concurrent.futures.Executor,
    shards: int, progress: Callable[[float, str], object] | None,
) -> None:
    """Runs all parts on an executor."""
    cells = output / "cells"
    cells.mkdir(parents=True, exist_ok=True)
    for name in "meshes", "motions":
        options = {**options, name: [os.path.abspath(path) for path in options[name]]}
    if options["trees"]:
        options["trees"] = os.path.abspath(options["trees"])
    futures = [executor.submit(_shard, bodies, options, number, shards, os.fspath(cells)) for number in range(1, shards + 1)]
    try:
        # Not as_completed: futures of Dask and others are not of the same class.
        for done, future in enumerate(futures, 1):
            future.result()
            if progress is not None:
                progress(done / shards, f"part {done} of {shards}")
    except BaseException:
        for future in futures:
            future.cancel()
        raise
