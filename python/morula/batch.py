# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Many meshes: a tree and its figures for each, one process a mesh, and a row for whatever happens to it.

>>> rows = morula.batch.run("meshes", {"quality": "fast"}, output="trees", jobs=2)          # doctest: +SKIP

On a command line, and so in job arrays: python -m morula.batch meshes -o trees --jobs 2 --shard 1/16 --quality fast

A result is kept under a key of the mesh file's content, the options and the version, each file written whole or not at all. So a
run that was killed goes on where it ended, with the same table in the end, and shards may share a folder.

Manifests, meshes and outputs may be URLs of any file system that fsspec knows (`s3://bucket/meshes`), where it is installed.
"""

from __future__ import annotations

import argparse
import concurrent.futures
import contextlib
import csv
import hashlib
import io
import json
import os
import pathlib
import socket
import subprocess
import sys
import tarfile
import tempfile
import time
import urllib.parse
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Union

from . import _morula

if TYPE_CHECKING:
    from .typing import MeshLike

__all__ = ["RayExecutor", "Row", "meshes_of", "run", "tree_of"]

Row = dict[str, Any]
Name = Union[str, pathlib.Path]
Manifest = Union[str, "os.PathLike[str]", Iterable[Union[str, "os.PathLike[str]"]]]

#: Columns of the table; those of levels are lists.
COLUMNS = (
    "mesh", "status", "error", "key", "vertices", "facets", "closed", "nodes", "spheres", "looseness", "bare_area", "gap", "protrusion"
)


#: Where a file takes its name in one step; elsewhere, as in stores of objects, one appears whole by itself.
_RENAMES = {"file", "local", "sftp", "ssh", "smb", "ftp", "hdfs", "webhdfs", "arrow_hdfs"}


class Place:
    """A file or folder, on this machine or wherever fsspec reaches."""

    def __init__(self, name: str | os.PathLike[str], storage_options: Mapping[str, Any] | None = None) -> None:
        text = os.fspath(name)
        self.options = dict(storage_options or {})
        self.local: pathlib.Path | None = None
        self._fs: Any = None
        if text.startswith("file://"):
            from urllib.request import url2pathname

            text = url2pathname(urllib.parse.urlsplit(text).path)
        if "://" not in text:
            self.local = pathlib.Path(text)
            self.name: Name = self.local
            return
        try:
            import fsspec  # type: ignore[import-not-found,import-untyped,unused-ignore]
        except ImportError:
            raise ImportError(f"{text}: only files of this machine can be used without fsspec: pip install fsspec") from None
        self._fs, self._path = fsspec.core.url_to_fs(text, **self.options)
        self.name = text if text.endswith("://") else text.rstrip("/")

    def __truediv__(self, name: str) -> Place:
        return Place(self.local / name if self.local is not None else f"{self.name}/{name}", self.options)

    @property
    def suffix(self) -> str:
        return pathlib.PurePosixPath(str(self.name)).suffix.lower()

    def absolute(self) -> str:
        """For workers that stand in another folder."""
        return os.path.abspath(self.local) if self.local is not None else str(self.name)

    def parent(self) -> Place:
        if self.local is not None:
            return Place(self.local.parent)
        above = str(self.name).rpartition("/")[0]
        return Place(above + "/" if above.endswith(":/") else above, self.options)

    def exists(self) -> bool:
        return self.local.exists() if self.local is not None else bool(self._fs.exists(self._path))

    def is_folder(self) -> bool:
        return self.local.is_dir() if self.local is not None else bool(self._fs.isdir(self._path))

    def make_folder(self) -> None:
        if self.local is not None:
            self.local.mkdir(parents=True, exist_ok=True)
        else:
            self._fs.makedirs(self._path, exist_ok=True)

    def files(self) -> list[Name]:
        """All below a folder, sorted."""
        if self.local is not None:
            return sorted(path for path in self.local.rglob("*") if not path.is_dir())
        return sorted(str(self._fs.unstrip_protocol(path)) for path in self._fs.find(self._path))

    def read(self) -> bytes:
        if self.local is not None:
            return self.local.read_bytes()
        found: bytes = self._fs.cat_file(self._path)
        return found

    def write(self, content: str | bytes) -> None:
        """Whole or not at all."""
        data = content.encode() if isinstance(content, str) else content
        mark = f"{socket.gethostname()}.{os.getpid()}.{time.monotonic_ns()}"
        if self.local is not None:
            beside = self.local.with_name(f".{self.local.name}.{mark}")
            beside.write_bytes(data)
            os.replace(beside, self.local)
            return
        kinds = self._fs.protocol if isinstance(self._fs.protocol, (list, tuple)) else (self._fs.protocol,)
        if _RENAMES.isdisjoint(kinds):
            self._fs.pipe_file(self._path, data)
            return
        folder, _, last = self._path.rpartition("/")
        self._fs.pipe_file(f"{folder}/.{last}.{mark}", data)
        self._fs.mv(f"{folder}/.{last}.{mark}", self._path)

    def remove(self) -> None:
        if self.local is not None:
            self.local.unlink()
        else:
            self._fs.rm_file(self._path)


def _require_inside(meshes: list[Name], manifest: Name, folder: Place, roots: Iterable[str | os.PathLike[str]]) -> list[Name]:
    """The same meshes; ValueError for a local one outside of the manifest's folder and the roots, links resolved."""
    allowed = [pathlib.Path(root).resolve() for root in roots]
    if folder.local is not None:
        allowed.append(folder.local.resolve())
    for mesh in meshes:
        if not isinstance(mesh, pathlib.Path) or not mesh.exists():
            continue  # a URL, and what is missing: a row of the table says so
        there = mesh.resolve()
        if not any(there.is_relative_to(root) for root in allowed):
            outside = " and ".join(map(str, allowed)) or "this machine's folders"
            raise ValueError(f"{manifest}: {mesh} lies outside {outside}; allow its folder with roots=[{str(there.parent)!r}]")
    return meshes


def _named(name: str, folder: Place, storage_options: Mapping[str, Any] | None) -> Name:
    """What a line of a manifest means, also one that is written as in a URI: `a%20mesh.obj`."""
    if "://" in name or os.path.isabs(name):
        place = Place(name, storage_options)
    else:
        place = folder / name
    if place.local is not None and not place.local.exists():
        decoded = pathlib.Path(urllib.parse.unquote(str(place.local)))
        if "\0" not in str(decoded) and decoded.exists():
            return decoded
    return place.name


def meshes_of(
    manifest: Manifest, storage_options: Mapping[str, Any] | None = None, roots: Iterable[str | os.PathLike[str]] = ()
) -> list[Name]:
    """Paths of meshes: of a folder, its mesh files by name; of a text file, a path per line; of a .csv, its column `mesh`.

    Paths in a file are relative to it, and may be URLs. Meshes of this machine have to lie in the manifest's folder or in one of
    `roots`, once links are resolved, else ValueError. Any other iterable is taken as it is. Local ones are pathlib.Path.
    """
    if not isinstance(manifest, (str, os.PathLike)):
        return [Place(path, storage_options).name for path in manifest]
    place = Place(manifest, storage_options)
    if place.is_folder():
        known = set(_morula.readable_mesh_extensions().split())
        found = [path for path in place.files() if pathlib.PurePosixPath(path).suffix.lower() in known]
        return _require_inside(found, place.name, place, roots)
    lines = io.StringIO(place.read().decode(), newline="")
    if place.suffix == ".csv":
        rows = csv.DictReader(lines)
        if "mesh" not in (rows.fieldnames or []):
            raise ValueError(f"{manifest}: a column `mesh` is needed; there are {', '.join(rows.fieldnames or [])}")
        names = [row["mesh"] for row in rows]
    else:
        names = [line.strip() for line in lines if line.strip() and not line.startswith("#")]
    folder = place.parent()
    return _require_inside([_named(name, folder, storage_options) for name in names], place.name, folder, roots)


def key_of(mesh: str | os.PathLike[str], options: Mapping[str, Any], storage_options: Mapping[str, Any] | None = None) -> str:
    """Of the file's bytes, the options and the version; of the path where it cannot be read."""
    place = Place(mesh, storage_options)
    try:
        content = hashlib.sha256(place.read()).hexdigest()
    except OSError:
        content = f"unreadable {mesh}"
    what = json.dumps([content, place.suffix, dict(options), _morula.version], sort_keys=True)
    return hashlib.sha256(what.encode()).hexdigest()[:32]


def _build(task: Mapping[str, Any]) -> Row:
    """In a process of its own."""
    mesh = _morula.read_mesh(task["mesh"])
    report = _morula.inspect(mesh)
    built = _morula.build(mesh, **task["options"])
    if faults := built.validate(mesh):
        raise RuntimeError("; ".join(faults))
    measured = _morula.measure(mesh, built)
    _morula.write_tree(task["tree"], built)
    return {
        "status": "ok",
        "vertices": report.vertex_count,
        "facets": report.facet_count,
        "closed": report.closed,
        "nodes": len(built),
        "spheres": [m.spheres for m in measured],
        "looseness": [m.looseness.looseness for m in measured],
        "bare_area": [m.coverage.bare_area for m in measured],
        "gap": [m.coverage.gap for m in measured],
        "protrusion": [None if m.protrusion is None else m.protrusion.worst for m in measured],
    }


def _serve_task() -> None:
    task = json.load(sys.stdin)
    if limit := task["memory_limit_mb"]:
        import resource

        resource.setrlimit(resource.RLIMIT_AS, (limit << 20, limit << 20))
    try:
        row = _build(task)
    except MemoryError:
        row = {"status": "out of memory", "error": f"more than {limit} MB" if limit else "out of memory"}
    except Exception as fault:  # noqa: BLE001: whatever it is, it is a row
        row = {"status": "failed", "error": str(fault)}
    json.dump(row, sys.stdout)


def _copy_here(mesh: Place, folder: pathlib.Path) -> pathlib.Path:
    """A mesh from elsewhere, with the buffers of a .gltf."""
    copy = folder / f"mesh{mesh.suffix}"
    data = mesh.read()
    copy.write_bytes(data)
    if mesh.suffix == ".gltf":
        for buffer in json.loads(data).get("buffers", []):
            name = urllib.parse.unquote(buffer.get("uri", "data:"))
            if name.startswith("data:") or name.startswith("/") or ".." in name.split("/"):
                continue
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes((mesh.parent() / name).read())
    return copy


def one(task: Mapping[str, Any]) -> Row:
    """One mesh, in a process of its own; what an executor calls, here or elsewhere. Its row is on the disk when it returns."""
    start = time.perf_counter()
    elsewhere = task.get("storage_options") or {}
    mesh, tree = Place(task["mesh"], elsewhere), Place(task["tree"], elsewhere)
    with tempfile.TemporaryDirectory() if mesh.local is None or tree.local is None else contextlib.nullcontext("") as scratch:
        here = {name: value for name, value in task.items() if name != "storage_options"}
        row: Row = {}
        try:
            if mesh.local is None:
                here["mesh"] = os.fspath(_copy_here(mesh, pathlib.Path(scratch)))
        except (OSError, ValueError) as fault:
            row = {"status": "failed", "error": f"{mesh.name}: cannot be read: {fault}"}
        if tree.local is None:
            here["tree"] = os.path.join(scratch, "tree.morula")
        row = row or _one_here(here)
        if mesh.local is None and "error" in row:
            row["error"] = row["error"].replace(str(here["mesh"]), str(mesh.name))
        if tree.local is None and row["status"] == "ok":
            tree.write(pathlib.Path(here["tree"]).read_bytes())
    row["key"] = task["key"]
    Place(task["row"], elsewhere).write(json.dumps({**row, "seconds": time.perf_counter() - start}))
    return row


def _one_here(task: Mapping[str, Any]) -> Row:
    try:
        done = subprocess.run(
            [sys.executable, "-m", "morula.batch", "--serve-task"], input=json.dumps(task), capture_output=True, text=True,
            timeout=task["time_limit"], check=False,
        )
        try:
            row: Row = json.loads(done.stdout)
        except ValueError:
            said = done.stderr.strip().splitlines()[-1:] or [""]
            row = {"status": "crashed", "error": f"exit code {done.returncode} {said[0]}".strip()}
    except subprocess.TimeoutExpired:
        row = {"status": "timed out", "error": f"more than {task['time_limit']} s"}
    return row


def _table(rows: list[Row], folder: Place, name: str) -> None:
    """As CSV and JSON lines; as Parquet where pyarrow is installed. No times: an interrupted run has the same table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow([json.dumps(v) if isinstance(v, list) else "" if v is None else v for v in map(row.get, COLUMNS)])
    (folder / f"{name}.csv").write(text.getvalue())
    lines = [json.dumps({column: row.get(column) for column in COLUMNS}) + "\n" for row in rows]
    (folder / f"{name}.jsonl").write("".join(lines))
    try:
        import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
        import pyarrow.parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        return
    table = pyarrow.Table.from_pylist([{column: row.get(column) for column in COLUMNS} for row in rows])
    packed = io.BytesIO()
    pyarrow.parquet.write_table(table, packed)
    (folder / f"{name}.parquet").write(packed.getvalue())


def run(
    manifest: Manifest,
    options: Mapping[str, Any] | None = None,
    *,
    output: str | os.PathLike[str],
    jobs: int = 1,
    executor: concurrent.futures.Executor | None = None,
    shard: tuple[int, int] = (1, 1),
    time_limit: float | None = None,
    memory_limit_mb: int | None = None,
    retry: bool = False,
    archives: bool = False,
    storage_options: Mapping[str, Any] | None = None,
    roots: Iterable[str | os.PathLike[str]] = (),
    progress: Callable[[int, int, float], object] | None = None,
) -> list[Row]:
    """A tree for every mesh; returns the rows of the table in the manifest's order and writes it into `output`.

    Args:
        options: of build(), as a dict.
        jobs: so many processes at once.
        executor: anything that behaves as concurrent.futures does, in the place of `jobs`: of Dask
            (`client.get_executor()`), mpi4py.futures, submitit; RayExecutor() of Ray. Workers need this package and the same file system. What a
            worker that dies takes with it is a row with the status `lost`, unless the executor gives it to another; the
            next run tries it again.
        shard: (i, n): the i-th of n parts, from 1: every n-th mesh from the i-th on; its table is table-i-of-n.
        time_limit: seconds a mesh may take. memory_limit_mb: address space it may have (not on Windows).
        retry: meshes that failed are tried again; else their rows stay.
        archives: trees are packed into trees/KK.tar in the end, by the first two digits of their keys: for file systems that
            do not like many files. tree_of() reads them.
        storage_options: of fsspec, for a manifest, meshes and an output that are URLs (`s3://bucket/meshes`). Workers read and
            write there themselves; the mesh is built from a copy.
        roots: folders, besides the manifest's own, in which its meshes may lie.
        progress: called with meshes done, all of them, and the seconds left, estimated.

    trees/KEY.morula are the trees, rows/KEY.json the rows with their times.
    """
    index, count = shard
    if not 1 <= index <= count:
        raise ValueError(f"shard: {index}/{count}, but 1/{count} to {count}/{count} are needed")
    folder = Place(output, storage_options)
    for name in ("trees", "rows"):
        (folder / name).make_folder()
    options = dict(options or {})
    meshes = meshes_of(manifest, storage_options, roots)[index - 1 :: count]
    keys = [key_of(mesh, options, storage_options) for mesh in meshes]

    rows: dict[str, Row] = {}
    tasks: dict[str, dict[str, Any]] = {}
    for mesh, key in zip(meshes, keys):
        row_file = folder / "rows" / f"{key}.json"
        if key not in rows and row_file.exists():
            row = json.loads(row_file.read())
            if row["status"] == "ok" or not retry:
                rows[key] = row
        if key not in rows:
            tasks[key] = {
                # Workers of an executor may stand in another folder.
                "mesh": Place(mesh, storage_options).absolute(), "options": options, "key": key, "row": row_file.absolute(),
                "tree": (folder / "trees" / f"{key}.morula").absolute(), "time_limit": time_limit,
                "memory_limit_mb": memory_limit_mb, "storage_options": dict(storage_options or {}),
            }

    start, total = time.perf_counter(), len(rows) + len(tasks)
    own = concurrent.futures.ThreadPoolExecutor(max(1, jobs)) if executor is None else None
    futures = {(own or executor).submit(one, task): key for key, task in tasks.items()}  # type: ignore[union-attr]
    try:
        for done, future in enumerate(_as_completed(futures), 1):
            key = futures[future]
            try:
                rows[key] = future.result()
            except Exception as fault:  # noqa: BLE001: a worker that is gone costs its meshes; nothing is kept of that
                rows[key] = {"status": "lost", "error": f"{type(fault).__name__}: {fault}", "key": key}
            if progress is not None:
                progress(len(rows), total, (time.perf_counter() - start) / done * (len(tasks) - done))
    finally:
        for future in futures:
            future.cancel()
        if own is not None:
            own.shutdown()

    table = [{**rows[key], "mesh": str(mesh)} for mesh, key in zip(meshes, keys)]
    for row in table:
        row.pop("seconds", None)
    part = "" if count == 1 else f"{index}-of-{count}"
    if archives:
        _pack(folder / "trees", part, [row["key"] for row in table if row["status"] == "ok"])
    _table(table, folder, f"table-{part}" if part else "table")
    return table


class RayExecutor:
    """Tasks of Ray, as an executor for run() and morula.study(). options: of ray.remote, such as num_cpus.

    Uses the Ray that runs already, or starts one here.
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
    """In the order in which they end; of futures that are none of concurrent.futures, in the order given."""
    if all(isinstance(future, concurrent.futures.Future) for future in futures):
        return concurrent.futures.as_completed(futures)
    return list(futures)


def _pack(folder: Place, part: str, keys: Iterable[str]) -> None:
    """Moves trees into archives, by the first two digits of their keys. The same bytes however often it was interrupted."""
    found: dict[str, set[str]] = {}
    for key in keys:
        if (folder / f"{key}.morula").exists():
            found.setdefault(f"{part}-{key[:2]}.tar" if part else f"{key[:2]}.tar", set()).add(key)
    for name, new in found.items():
        archive = folder / name
        trees = {f"{key}.morula": (folder / f"{key}.morula").read() for key in new}
        if archive.exists():
            with tarfile.open(fileobj=io.BytesIO(archive.read())) as old:
                for member in old:
                    file = old.extractfile(member)
                    if file is not None and member.name not in trees:
                        trees[member.name] = file.read()
        text = io.BytesIO()
        with tarfile.open(fileobj=text, mode="w", format=tarfile.USTAR_FORMAT) as packed:
            for tree in sorted(trees):
                member = tarfile.TarInfo(tree)
                member.size = len(trees[tree])
                packed.addfile(member, io.BytesIO(trees[tree]))
        archive.write(text.getvalue())
        for key in new:
            (folder / f"{key}.morula").remove()


def tree_of(
    output: str | os.PathLike[str], key: str, mesh: MeshLike, *, storage_options: Mapping[str, Any] | None = None
) -> _morula.CoveredTree:
    """The tree of a row, from its file or its archive. mesh: the one that it was built of.

    KeyError where there is no tree of this key.
    """
    folder = Place(output, storage_options) / "trees"
    file = folder / f"{key}.morula"
    if file.exists():
        return _tree_in(file.read(), mesh)
    for name in folder.files() if folder.exists() else []:
        if not str(name).endswith(f"{key[:2]}.tar"):
            continue
        archive = Place(name, storage_options)
        with tarfile.open(archive.local) if archive.local else tarfile.open(fileobj=io.BytesIO(archive.read())) as packed:
            try:
                member = packed.extractfile(f"{key}.morula")
            except KeyError:
                continue
            assert member is not None
            return _tree_in(member.read(), mesh)
    raise KeyError(key)


def _tree_in(data: bytes, mesh: MeshLike) -> _morula.CoveredTree:
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch) / "tree.morula"
        copy.write_bytes(data)
        return _morula.read_covered_tree(copy, mesh)


def main() -> int:
    parser = argparse.ArgumentParser(prog="python -m morula.batch", description="A tree and its figures for each of many meshes.")
    parser.add_argument("manifest", help="a folder, a text file with a path per line, or a .csv with a column `mesh`")
    parser.add_argument("-o", "--output", required=True, help="folder for trees, rows and the table")
    parser.add_argument("--jobs", type=int, default=1, help="processes at once")
    parser.add_argument("--shard", default="1/1", help="i/n: the i-th of n parts, from 1")
    parser.add_argument("--time-limit", type=float, help="seconds a mesh may take")
    parser.add_argument("--memory-limit", type=int, help="megabytes of address space it may have")
    parser.add_argument("--retry", action="store_true", help="try again what failed; what is done stays in any case")
    parser.add_argument("--archives", action="store_true", help="trees in tar archives, by the first two digits of their keys")
    parser.add_argument("--root", action="append", default=[], help="a folder, besides the manifest's own, in which its meshes may lie")
    parser.add_argument("--method", default="morula")
    parser.add_argument("--quality", default="default")
    parser.add_argument("--branching", type=int, default=8)
    parser.add_argument("--depth", type=int)
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    index, _, count = given.shard.partition("/")
    options = {name: getattr(given, name) for name in ("method", "quality", "branching", "depth", "seed")}

    def report(done: int, total: int, seconds_left: float) -> None:
        print(f"{done} of {total}, {seconds_left:.0f} s left", file=sys.stderr)

    rows = run(
        given.manifest, options, output=given.output, jobs=given.jobs, shard=(int(index), int(count)), time_limit=given.time_limit,
        memory_limit_mb=given.memory_limit, retry=given.retry, archives=given.archives, roots=given.root, progress=report,
    )
    failed = sum(row["status"] != "ok" for row in rows)
    where = (Place(given.output) / "table.csv").name if count == "1" else given.output
    print(f"{len(rows)} meshes, {failed} of them failed: {where}")
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--serve-task"]:
        _serve_task()
    else:
        sys.exit(main())
