# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Many meshes: a tree and its figures for each, one process a mesh, and a row for whatever happens to it.

>>> rows = morula.batch.run("meshes", {"quality": "fast"}, output="trees", jobs=2)          # doctest: +SKIP

On a command line, and so in job arrays: python -m morula.batch meshes -o trees --jobs 2 --shard 1/16 --quality fast

A result is kept under a key of the mesh file's content, the options and the version, each file written whole or not at all. So a
run that was killed goes on where it ended, with the same table in the end, and shards may share a folder.
"""

from __future__ import annotations

import argparse
import concurrent.futures
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
from collections.abc import Callable, Iterable, Mapping
from typing import TYPE_CHECKING, Any, Union

from . import _morula

if TYPE_CHECKING:
    from .typing import MeshLike

__all__ = ["Row", "meshes_of", "run", "tree_of"]

Row = dict[str, Any]
Manifest = Union[str, "os.PathLike[str]", Iterable[Union[str, "os.PathLike[str]"]]]

#: Columns of the table; those of levels are lists.
COLUMNS = (
    "mesh", "status", "error", "key", "vertices", "facets", "closed", "nodes", "spheres", "looseness", "bare_area", "gap", "protrusion"
)


def meshes_of(manifest: Manifest) -> list[pathlib.Path]:
    """Paths of meshes: of a folder, its mesh files by name; of a text file, a path per line; of a .csv, its column `mesh`.

    Paths in a file are relative to it. Any other iterable is taken as it is.
    """
    if not isinstance(manifest, (str, os.PathLike)):
        return [pathlib.Path(path) for path in manifest]
    path = pathlib.Path(manifest)
    if path.is_dir():
        known = set(_morula.readable_mesh_extensions().split())
        return sorted(p for p in path.rglob("*") if p.suffix.lower() in known)
    with open(path, encoding="utf-8", newline="") as file:
        if path.suffix.lower() == ".csv":
            rows = csv.DictReader(file)
            if "mesh" not in (rows.fieldnames or []):
                raise ValueError(f"{path}: a column `mesh` is needed; there are {', '.join(rows.fieldnames or [])}")
            names = [row["mesh"] for row in rows]
        else:
            names = [line.strip() for line in file if line.strip() and not line.startswith("#")]
    return [path.parent / name for name in names]


def key_of(mesh: pathlib.Path, options: Mapping[str, Any]) -> str:
    """Of the file's bytes, the options and the version; of the path where it cannot be read."""
    try:
        content = hashlib.sha256(mesh.read_bytes()).hexdigest()
    except OSError:
        content = f"unreadable {mesh}"
    what = json.dumps([content, mesh.suffix.lower(), dict(options), _morula.version], sort_keys=True)
    return hashlib.sha256(what.encode()).hexdigest()[:32]


def _write_whole(path: pathlib.Path, content: str | bytes) -> None:
    beside = path.with_name(f".{path.name}.{socket.gethostname()}.{os.getpid()}.{time.monotonic_ns()}")
    beside.write_bytes(content.encode() if isinstance(content, str) else content)
    os.replace(beside, path)


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


def one(task: Mapping[str, Any]) -> Row:
    """One mesh, in a process of its own; what an executor calls, here or elsewhere. Its row is on the disk when it returns."""
    start = time.perf_counter()
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
    row["key"] = task["key"]
    _write_whole(pathlib.Path(task["row"]), json.dumps({**row, "seconds": time.perf_counter() - start}))
    return row


def _table(rows: list[Row], folder: pathlib.Path, name: str) -> None:
    """As CSV and JSON lines; as Parquet where pyarrow is installed. No times: an interrupted run has the same table."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    for row in rows:
        writer.writerow([json.dumps(v) if isinstance(v, list) else "" if v is None else v for v in map(row.get, COLUMNS)])
    _write_whole(folder / f"{name}.csv", text.getvalue())
    lines = [json.dumps({column: row.get(column) for column in COLUMNS}) + "\n" for row in rows]
    _write_whole(folder / f"{name}.jsonl", "".join(lines))
    try:
        import pyarrow  # type: ignore[import-not-found,import-untyped,unused-ignore]
        import pyarrow.parquet  # type: ignore[import-not-found,import-untyped,unused-ignore]
    except ImportError:
        return
    table = pyarrow.Table.from_pylist([{column: row.get(column) for column in COLUMNS} for row in rows])
    pyarrow.parquet.write_table(table, folder / f"{name}.parquet")


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
    progress: Callable[[int, int, float], object] | None = None,
) -> list[Row]:
    """A tree for every mesh; returns the rows of the table in the manifest's order and writes it into `output`.

    Args:
        options: of build(), as a dict.
        jobs: so many processes at once.
        executor: anything that behaves as concurrent.futures does, in the place of `jobs`: of Dask
            (`client.get_executor()`), mpi4py.futures, submitit. Workers need this package and the same file system. What a
            worker that dies takes with it is a row with the status `lost`, unless the executor gives it to another; the
            next run tries it again.
        shard: (i, n): the i-th of n parts, from 1: every n-th mesh from the i-th on; its table is table-i-of-n.
        time_limit: seconds a mesh may take. memory_limit_mb: address space it may have (not on Windows).
        retry: meshes that failed are tried again; else their rows stay.
        archives: trees are packed into trees/KK.tar in the end, by the first two digits of their keys: for file systems that
            do not like many files. tree_of() reads them.
        progress: called with meshes done, all of them, and the seconds left, estimated.

    trees/KEY.morula are the trees, rows/KEY.json the rows with their times.
    """
    index, count = shard
    if not 1 <= index <= count:
        raise ValueError(f"shard: {index}/{count}, but 1/{count} to {count}/{count} are needed")
    folder = pathlib.Path(output)
    (folder / "trees").mkdir(parents=True, exist_ok=True)
    (folder / "rows").mkdir(exist_ok=True)
    options = dict(options or {})
    meshes = meshes_of(manifest)[index - 1 :: count]
    keys = [key_of(mesh, options) for mesh in meshes]

    rows: dict[str, Row] = {}
    tasks: dict[str, dict[str, Any]] = {}
    for mesh, key in zip(meshes, keys):
        row_file = folder / "rows" / f"{key}.json"
        if key not in rows and row_file.exists():
            row = json.loads(row_file.read_text(encoding="utf-8"))
            if row["status"] == "ok" or not retry:
                rows[key] = row
        if key not in rows:
            tasks[key] = {
                # Workers of an executor may stand in another folder.
                "mesh": os.path.abspath(mesh), "options": options, "key": key, "row": os.path.abspath(row_file),
                "tree": os.path.abspath(folder / "trees" / f"{key}.morula"), "time_limit": time_limit,
                "memory_limit_mb": memory_limit_mb,
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


def _as_completed(futures: Iterable[Any]) -> Iterable[Any]:
    """In the order in which they end; of futures that are none of concurrent.futures, in the order given."""
    if all(isinstance(future, concurrent.futures.Future) for future in futures):
        return concurrent.futures.as_completed(futures)
    return list(futures)


def _archive_of(folder: pathlib.Path, part: str, key: str) -> pathlib.Path:
    return folder / (f"{part}-{key[:2]}.tar" if part else f"{key[:2]}.tar")


def _pack(folder: pathlib.Path, part: str, keys: Iterable[str]) -> None:
    """Moves trees into archives, by the first two digits of their keys. The same bytes however often it was interrupted."""
    found: dict[pathlib.Path, set[str]] = {}
    for key in keys:
        if (folder / f"{key}.morula").exists():
            found.setdefault(_archive_of(folder, part, key), set()).add(key)
    for archive, new in found.items():
        trees = {f"{key}.morula": (folder / f"{key}.morula").read_bytes() for key in new}
        if archive.exists():
            with tarfile.open(archive) as old:
                for member in old:
                    file = old.extractfile(member)
                    if file is not None and member.name not in trees:
                        trees[member.name] = file.read()
        text = io.BytesIO()
        with tarfile.open(fileobj=text, mode="w", format=tarfile.USTAR_FORMAT) as packed:
            for name in sorted(trees):
                member = tarfile.TarInfo(name)
                member.size = len(trees[name])
                packed.addfile(member, io.BytesIO(trees[name]))
        _write_whole(archive, text.getvalue())
        for key in new:
            (folder / f"{key}.morula").unlink()


def tree_of(output: str | os.PathLike[str], key: str, mesh: MeshLike) -> _morula.CoveredTree:
    """The tree of a row, from its file or its archive. mesh: the one that it was built of.

    KeyError where there is no tree of this key.
    """
    folder = pathlib.Path(output) / "trees"
    file = folder / f"{key}.morula"
    if file.exists():
        return _morula.read_covered_tree(file, mesh)
    for archive in sorted(folder.glob(f"*{key[:2]}.tar")):
        with tarfile.open(archive) as packed:
            try:
                member = packed.extractfile(file.name)
            except KeyError:
                continue
            assert member is not None
            with tempfile.TemporaryDirectory() as scratch:
                copy = pathlib.Path(scratch) / file.name
                copy.write_bytes(member.read())
                return _morula.read_covered_tree(copy, mesh)
    raise KeyError(key)


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
        memory_limit_mb=given.memory_limit, retry=given.retry, archives=given.archives, progress=report,
    )
    failed = sum(row["status"] != "ok" for row in rows)
    print(f"{len(rows)} meshes, {failed} of them failed: {pathlib.Path(given.output) / 'table.csv' if count == '1' else given.output}")
    return 1 if failed else 0


if __name__ == "__main__":
    if sys.argv[1:] == ["--serve-task"]:
        _serve_task()
    else:
        sys.exit(main())
