# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Many meshes: `morula batch` from Python, and spread over executors, file systems and archives.

>>> rows = morula.batch.run("meshes", {"quality": "fast"}, output="trees", jobs=2)          # doctest: +SKIP

The engine is that of the command: the same options, keys, files, statuses and columns. Each continues a folder of the other.
On a command line, for example in job arrays, it is `python -m morula batch meshes -o trees --quality fast --shard 1/16`.

Manifests, meshes and outputs may be URLs of any file system of fsspec (`s3://bucket/meshes`), if it is installed.
"""

from __future__ import annotations

import atexit
import concurrent.futures
import contextlib
import inspect
import io
import json
import os
import pathlib
import sys
import tarfile
import tempfile
import threading
import time
import urllib.parse
import warnings
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, NamedTuple, Union

from . import _morula

if not hasattr(_morula, "batch_engine"):
    raise ImportError("morula.batch needs the command, which this package was built without: it needs CLI11 and fmt (docs/reference/python.md)")
from ._morula import batch_engine as engine
from ._places import Place

if TYPE_CHECKING:
    from .typing import MeshLike

__all__ = ["RayExecutor", "Row", "run", "tree_of"]

Row = dict[str, Any]
Manifest = Union[str, "os.PathLike[str]", Iterable[Union[str, "os.PathLike[str]"]]]

engine.start_workers_as(sys.executable, [sys.executable, "-m", "morula"])


class _Mesh(NamedTuple):
    name: str  # as the table has it
    place: Place
    rejection: str = ""
    is_checked: bool = False  # has to lie in the roots


def _words(options: Mapping[str, Any]) -> list[str]:
    """Options by name as arguments of the command: {"max_protrusion": 0.1} is --max-protrusion 0.1."""
    words = []
    for name, value in options.items():
        option = f"--{name.replace('_', '-')}"
        if value is None or value is False:
            continue
        if value is True:
            words.append(option)
        elif isinstance(value, (list, tuple)):
            words += [option, ",".join(map(str, value))]
        else:
            words += [option, str(value)]
    return words


def _checked_words(options: Mapping[str, Any], arguments: Mapping[str, Any]) -> list[str]:
    known = set(inspect.signature(run).parameters) | {"root", "json", "quiet"}
    for name in options:
        if name in known:
            raise ValueError(f"options: {name} is no option of the build; it is an argument of run(), if anything")
    return engine.build_words(_words({**arguments, **options}))


def _meshes_in_folder(place: Place) -> list[_Mesh]:
    if place.local is not None:
        return [_Mesh(name, Place(path), rejection, True) for name, _, path, rejection in engine.manifest(place.local)]
    known = set(_morula.readable_mesh_extensions().split())
    found = [Place(path, place.options) for path in place.files()]
    return [_Mesh(engine.text_of_name(mesh.name_in(place).encode()), mesh) for mesh in found if mesh.suffix in known]


def _mesh_named(name: str, reference: str, path: pathlib.Path, rejection: str, folder: Place) -> _Mesh:
    """The mesh that a row of a manifest names."""
    if "://" in reference and not reference.startswith("file://"):
        return _Mesh(name, Place(reference, folder.options))
    if folder.local is None and "://" not in reference and not os.path.isabs(reference):
        return _Mesh(name, folder / reference)
    return _Mesh(name, Place(path), rejection, True)


def _meshes_of(manifest: Manifest, storage_options: Mapping[str, Any] | None) -> tuple[list[_Mesh], Place | None]:
    """The meshes of a manifest, and the folder that local meshes must lie in; None: any folder."""
    if not isinstance(manifest, (str, os.PathLike)):
        return [_Mesh(engine.text_of_name(os.fsencode(mesh)), Place(mesh, storage_options)) for mesh in manifest], None
    place = Place(manifest, storage_options)
    if place.is_folder():
        return _meshes_in_folder(place), place
    folder = place.parent()
    if place.local is not None:
        rows = engine.manifest(place.local)
    else:
        try:
            rows = engine.manifest_of(place.read(), place.suffix == ".csv", "")
        except ValueError as fault:
            raise ValueError(f"{place.name}: {fault}") from None
    return [_mesh_named(*row, folder) for row in rows], folder


def _buffers_beside(mesh: Place, data: bytes) -> Iterable[tuple[str, bytes]]:
    """The existing buffers in its folder that a glTF names."""
    for name in map(urllib.parse.unquote, engine.buffers_of(data, mesh.suffix)):
        if name.startswith("/") or "://" in name or ".." in name.split("/"):
            continue
        buffer = (mesh.parent() / name).read_if_there()
        if buffer is not None:
            yield name, buffer


def _key_elsewhere(mesh: Place, words: list[str]) -> tuple[str, str]:
    try:
        data = mesh.read()
        files = [data, *(buffer for _, buffer in _buffers_beside(mesh, data))]
    except Exception as fault:  # noqa: BLE001: of whatever file system; it is a row
        return "", f"{{mesh}}: cannot be read: {type(fault).__name__}: {fault}"
    return engine.key_of_bytes(files, mesh.suffix, words), ""


def _keys_of(meshes: list[_Mesh], words: list[str], roots: list[pathlib.Path]) -> list[tuple[str, str]]:
    """The key of each mesh, or '' and the reason for its absence."""
    keys = [("", "")] * len(meshes)
    for is_checked in (True, False):
        here = {i: mesh.place.local for i, mesh in enumerate(meshes) if mesh.place.local is not None and mesh.is_checked == is_checked}
        found = engine.keys([(path, meshes[i].rejection) for i, path in here.items()], words, roots if is_checked else None)
        for i, key in zip(here, found):
            keys[i] = key
    for i, mesh in enumerate(meshes):
        if mesh.place.local is None:
            keys[i] = _key_elsewhere(mesh.place, words)
    return keys


def _result_place(folder: Place, key: str) -> Place:
    return folder / "results" / key[:2] / f"{key}.json"


def _tree_place(folder: Place, key: str) -> Place:
    return folder / "trees" / key[:2] / f"{key}.morula"


class _Kept:
    """Results of earlier batches in a folder."""

    def __init__(self, folder: Place, no_trees: bool) -> None:
        self.folder, self.no_trees, self.damaged = folder, no_trees, 0
        self._archived: dict[str, str] | None = None

    def find(self, key: str) -> str | None:
        """The text of a key's result. None if there is none, or if it or its tree is damaged."""
        place = _result_place(self.folder, key)
        data = place.read_if_there()
        if data is None and not place.exists():
            return None
        if data is None or not engine.whole_result(data, key) or not self._has_tree(key, json.loads(data)):
            self.damaged += 1
            return None
        return data.decode()

    def _has_tree(self, key: str, result: Row) -> bool:
        if self.no_trees or result["status"] != "ok":
            return True
        data = _tree_place(self.folder, key).read_if_there()
        found = engine.hash_of_bytes(data) if data is not None else self._archives().get(key)
        return bool(found == result["tree_file"])

    def _archives(self) -> dict[str, str]:
        """Hashes of the trees in archives, by key."""
        if self._archived is None:
            self._archived = {}
            for archive in _archives_in(self.folder / "trees"):
                with contextlib.suppress(tarfile.TarError, OSError):
                    for key, data in _trees_in(archive):
                        self._archived[key] = engine.hash_of_bytes(data)
        return self._archived


def _archives_in(trees: Place) -> list[Place]:
    if trees.local is not None:
        return [Place(path) for path in sorted(trees.local.glob("*.tar")) if path.is_file()]
    return [Place(name, trees.options) for name in trees.files() if str(name).endswith(".tar")] if trees.exists() else []


def _trees_in(archive: Place) -> Iterable[tuple[str, bytes]]:
    with tarfile.open(archive.local) if archive.local else tarfile.open(fileobj=io.BytesIO(archive.read())) as packed:
        for member in packed:
            file = packed.extractfile(member)
            if file is not None:
                yield member.name.removesuffix(".morula"), file.read()


def _copy_here(mesh: Place, folder: pathlib.Path) -> pathlib.Path:
    """Copies a mesh from another machine, with the buffers that a glTF names."""
    copy = folder / f"mesh{mesh.suffix}"
    data = mesh.read()
    copy.write_bytes(data)
    for name, buffer in _buffers_beside(mesh, data):
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(buffer)
    return copy


class _Seats:
    """Workers, one for each task at a time; idle ones wait for the next."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._idle: list[engine.Seat] = []
        self._all: list[engine.Seat] = []

    def build(self, *task: Any) -> str:
        with self._lock:
            if not self._idle:
                self._all.append(engine.Seat())
                self._idle.append(self._all[-1])
            seat = self._idle.pop()
        try:
            text = seat.build(*task)
        finally:
            with self._lock:
                self._idle.append(seat)
        if text is None:
            raise RuntimeError("the batch was stopped")
        return text

    def stop(self) -> None:
        with self._lock:
            for seat in self._all:
                seat.stop()

    def forget(self) -> None:
        """Ends idle workers; in a forked process, drops the workers of the parent."""
        self.__init__()  # type: ignore[misc]


#: Of tasks that an executor runs in this process.
_seats = _Seats()
atexit.register(_seats.forget)
os.register_at_fork(after_in_child=_seats.forget)


def one(task: Mapping[str, Any], seats: _Seats | None = None) -> str:
    """Builds one mesh in a worker and stores the result; returns its text. Executors call this function."""
    elsewhere = task["storage_options"]
    mesh, tree, result = (Place(task[name], elsewhere) for name in ("mesh", "tree", "result"))
    is_here = mesh.local is not None and tree.local is not None
    with contextlib.nullcontext("") if is_here else tempfile.TemporaryDirectory() as scratch:
        try:
            mesh_here = mesh.local if mesh.local is not None else _copy_here(mesh, pathlib.Path(scratch))
        except Exception as fault:  # noqa: BLE001: it could be read for its key; it is tried again the next time
            return engine.result_without_build(task["key"], "failed", f"{{mesh}}: cannot be read: {type(fault).__name__}: {fault}")
        tree_here = tree.local if tree.local is not None else pathlib.Path(scratch) / "tree.morula"
        text = (seats or _seats).build(
            task["key"], mesh_here, tree_here, result.local, task["words"], task["time_limit"], task["memory_limit"],
            task["no_trees"] and tree.local is not None,
        )
        if tree.local is None:
            try:
                if json.loads(text)["status"] == "ok" and not task["no_trees"]:
                    tree.write(tree_here.read_bytes())
                result.write(text)
            except Exception as fault:  # noqa: BLE001
                return engine.result_without_build(task["key"], "failed", f"cannot be kept: {type(fault).__name__}: {fault}")
    return text


def _processors() -> int:
    return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1


def _work_off(
    tasks: dict[str, dict[str, Any]], results: dict[str, str], jobs: int, executor: concurrent.futures.Executor | None,
    progress: Callable[[int, int, float], object] | None,
) -> None:
    start, total, own, seats = time.perf_counter(), len(results) + len(tasks), None, None
    if executor is None:
        seats = _Seats()
        own = concurrent.futures.ThreadPoolExecutor(min(jobs, max(1, len(tasks))))
        futures = {own.submit(one, task, seats): key for key, task in tasks.items()}
    else:
        futures = {executor.submit(one, task): key for key, task in tasks.items()}
    try:
        for done, future in enumerate(_as_completed(futures), 1):
            key = futures[future]
            try:
                results[key] = future.result()
            except Exception as fault:  # noqa: BLE001: a worker that is gone costs its meshes; nothing is kept of that
                results[key] = engine.result_without_build(key, "lost", f"{type(fault).__name__}: {fault}")
            if progress is not None:
                progress(len(results), total, (time.perf_counter() - start) / done * (len(tasks) - done))
    finally:
        for future in futures:
            future.cancel()
        if own is not None and seats is not None:
            seats.stop()  # nothing runs any more, unless this was interrupted
            own.shutdown()


def _write_tables(texts: tuple[str, str, str], folder: Place, suffix: str) -> list[Row]:
    """Writes the table as CSV and JSON lines, and as Parquet if pyarrow is installed. Returns the rows."""
    names = (f"table{suffix}.csv", f"table{suffix}.jsonl", f"cost{suffix}.csv")
    for name, text in zip(names, texts):
        (folder / name).write(text)
    rows = [json.loads(line) for line in texts[1].splitlines()]
    try:
        import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
        import pyarrow.parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        return rows
    columns = texts[0].partition("\n")[0].split(",")
    packed = io.BytesIO()
    pyarrow.parquet.write_table(pyarrow.Table.from_pylist([{name: row.get(name) for name in columns} for row in rows]), packed)
    (folder / f"table{suffix}.parquet").write(packed.getvalue())
    return rows


def run(
    manifest: Manifest,
    options: Mapping[str, Any] | None = None,
    *,
    output: str | os.PathLike[str],
    jobs: int | None = None,
    executor: concurrent.futures.Executor | None = None,
    shard: tuple[int, int] = (1, 1),
    time_limit: float | None = None,
    memory_limit: int | None = None,
    resume: bool = False,
    retry: bool = False,
    no_trees: bool = False,
    measure: bool = False,
    archives: bool = False,
    storage_options: Mapping[str, Any] | None = None,
    roots: Iterable[str | os.PathLike[str]] = (),
    progress: Callable[[int, int, float], object] | None = None,
) -> list[Row]:
    """Builds a tree for every mesh; returns the rows of the table in the manifest's order and writes it into `output`.

    Files, keys, statuses and columns are those of the command `morula batch`, and so are arguments unless noted. A row is a
    dict of its columns.

    Args:
        manifest: a folder, a .csv or a list of paths, as for the command; or an iterable of paths in any folders.
        options: options of the build, by the names of the command with `_` for `-`, as a dict: {"method": "grid", "depth": 2}.
            A wrong option raises ValueError ahead of any work.
        jobs: number of processes at once; None: one per processor.
        executor: an object like those of concurrent.futures, instead of `jobs`: from Dask (`client.get_executor()`),
            mpi4py.futures or submitit; RayExecutor() for Ray. Workers need this package and the same file system. A mesh whose
            worker dies gets a row with the status `lost`, unless the executor runs it again; `resume` retries it.
        shard: (i, n): the i-th of n parts, from 1: every n-th mesh from the i-th on; its table is table-i-of-n.
        time_limit: seconds per mesh. memory_limit: megabytes of address space per mesh, from 64.
        resume: continue with the results in the folder. Results that are damaged or without a tree are built again, with a warning.
        retry: like resume, and retry failed meshes.
        no_trees: write only the table.
        measure: adds the columns closed, looseness, uncovered_area, uncovered_distance and protrusion; the last four also per level.
        archives: packs trees into trees/KK.tar at the end, by the first two digits of their keys, for file systems that are slow
            with many files. tree_of() reads them.
        storage_options: options of fsspec, for a manifest, meshes and an output with URLs (`s3://bucket/meshes`). Workers read
            and write there directly; each mesh is built from a copy.
        roots: folders that may contain meshes, besides the manifest's own.
        progress: called with the number of finished meshes, the number of all, and an estimate of the seconds left.
    """
    index, count = shard
    words = _checked_words(
        dict(options or {}),
        {"jobs": jobs, "shard": f"{index}/{count}", "time_limit": time_limit, "memory_limit": memory_limit, "measure": measure},
    )
    folder = Place(output, storage_options)
    if count == 1 and not resume and not retry and (folder / "results").exists():
        raise ValueError(f"{output} holds results of an earlier batch: add resume=True to go on with them, or name another folder")
    meshes, own_root = _meshes_of(manifest, storage_options)
    meshes = meshes[index - 1 :: count]
    allowed = [pathlib.Path(root) for root in roots]
    if own_root is not None and own_root.local is not None:
        allowed.append(own_root.local)
    keys = _keys_of(meshes, words, allowed)
    folder.make_folder()

    kept = _Kept(folder, no_trees)
    results: dict[str, str] = {}
    tasks: dict[str, dict[str, Any]] = {}
    for mesh, (key, _) in zip(meshes, keys):
        if not key or key in results or key in tasks:
            continue
        found = kept.find(key)
        if found is not None and (not retry or json.loads(found)["status"] == "ok"):
            results[key] = found
            continue
        # Workers of an executor may stand in another folder.
        tasks[key] = {
            "mesh": mesh.place.absolute(), "tree": _tree_place(folder, key).absolute(), "result": _result_place(folder, key).absolute(),
            "key": key, "words": words, "time_limit": time_limit, "memory_limit": memory_limit, "no_trees": no_trees,
            "storage_options": dict(storage_options or {}),
        }
    if kept.damaged:
        warnings.warn(engine.remade_text(kept.damaged), stacklevel=2)
    _work_off(tasks, results, jobs or _processors(), executor, progress)

    suffix = "" if count == 1 else f"-{index}-of-{count}"
    if archives:
        _pack(folder, suffix, [key for key, text in results.items() if json.loads(text)["status"] == "ok"])
    named = [(mesh.name, key, message) for mesh, (key, message) in zip(meshes, keys)]
    return _write_tables(engine.tables(named, results, no_trees), folder, suffix)


class RayExecutor:
    """Tasks of Ray, as an executor for run() and morula.study(). options: options of ray.remote, such as num_cpus.

    Uses the running Ray, or starts one.
    """

    def __init__(self, **options: Any) -> None:
        import ray  # type: ignore[import-not-found,import-untyped,unused-ignore]

        if not ray.is_initialized():
            ray.init()
        self._remote = ray.remote(**{"num_cpus": 1, **options})(_call)

    def submit(self, function: Callable[..., Any], /, *arguments: Any) -> concurrent.futures.Future[Any]:
        found: concurrent.futures.Future[Any] = self._remote.remote(function, *arguments).future()
        return found


def _call(function: Callable[..., Any], *arguments: Any) -> Any:
    return function(*arguments)


def _as_completed(futures: Iterable[Any]) -> Iterable[Any]:
    """Futures in the order of completion; futures of other kinds than concurrent.futures in the given order."""
    if all(isinstance(future, concurrent.futures.Future) for future in futures):
        return concurrent.futures.as_completed(futures)
    return list(futures)


def _pack(folder: Place, suffix: str, keys: Iterable[str]) -> None:
    """Moves trees into archives, by the first two digits of their keys. Interruptions do not change the bytes."""
    found: dict[str, dict[str, bytes]] = {}
    for key in sorted(keys):
        data = _tree_place(folder, key).read_if_there()
        if data is not None:
            found.setdefault(f"{suffix[1:]}-{key[:2]}.tar" if suffix else f"{key[:2]}.tar", {})[key] = data
    for name, new in found.items():
        archive = folder / "trees" / name
        trees = dict(new)
        if archive.exists():
            with contextlib.suppress(tarfile.TarError):
                trees = {**dict(_trees_in(archive)), **new}
        packed_text = io.BytesIO()
        with tarfile.open(fileobj=packed_text, mode="w", format=tarfile.USTAR_FORMAT) as packed:
            for key in sorted(trees):
                member = tarfile.TarInfo(f"{key}.morula")
                member.size = len(trees[key])
                packed.addfile(member, io.BytesIO(trees[key]))
        archive.write(packed_text.getvalue())
        for key in new:
            _tree_place(folder, key).remove()


def tree_of(
    output: str | os.PathLike[str], key: str, mesh: MeshLike, *, storage_options: Mapping[str, Any] | None = None
) -> _morula.CoveredTree:
    """The tree of a row, from its file or its archive. mesh: the mesh that it was built from.

    KeyError if there is no tree with this key.
    """
    folder = Place(output, storage_options)
    data = _tree_place(folder, key).read_if_there()
    if data is not None:
        return _tree_in(data, mesh)
    for archive in _archives_in(folder / "trees"):
        if not str(archive.name).endswith(f"{key[:2]}.tar"):
            continue
        for found, data in _trees_in(archive):
            if found == key:
                return _tree_in(data, mesh)
    raise KeyError(key)


def _tree_in(data: bytes, mesh: MeshLike) -> _morula.CoveredTree:
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch) / "tree.morula"
        copy.write_bytes(data)
        return _morula.read_covered_tree(copy, mesh)


if __name__ == "__main__":
    raise SystemExit("morula.batch is no command: python -m morula batch is")
