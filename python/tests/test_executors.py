# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Many meshes and studies on executors of others: Dask with a worker that is killed, MPI; and as archives and Parquet."""

import concurrent.futures
import json
import os
import pathlib
import shutil
import signal
import subprocess
import sys
import tarfile
import textwrap
import time

import pytest

import morula

needs_study = pytest.mark.skipif(not hasattr(morula, "study"), reason="this package was built without the study")

options = {"method": "octree", "depth": 2}
small_study = {"quick": True, "frames": 3, "resolution": 24, "branching": 4, "methods": ["octree", "grid"], "rules": ["exact", "fresh"]}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    for name in ("bar", "blob", "limb", "torus", "tool", "capsule"):
        morula.write_mesh(folder / f"{name}.obj", morula.sample_body(name, 8))
    (folder / "broken.obj").write_text("v 1 2\nf 1 2 3\n")
    return folder


@pytest.fixture(scope="module")
def expected(folder, tmp_path_factory):
    """What one machine finds, undisturbed."""
    output = tmp_path_factory.mktemp("expected")
    return output, morula.batch.run(folder, options, output=output)


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """A Dask scheduler and two worker processes, without nannies that would start them again."""
    distributed = pytest.importorskip("distributed")
    place = tmp_path_factory.mktemp("dask")
    dask = [sys.executable, "-m", "dask"]
    address = place / "scheduler.json"
    started = [
        subprocess.Popen(
            [*dask, "scheduler", "--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", str(address)],
            cwd=place, stderr=subprocess.DEVNULL,
        )
    ]
    for name in ("one", "two"):
        started.append(
            subprocess.Popen(
                [*dask, "worker", "--scheduler-file", str(address), "--nworkers", "1", "--nthreads", "1", "--no-nanny",
                 "--no-dashboard", "--name", name, "--local-directory", str(place)],
                cwd=place, stderr=subprocess.DEVNULL,
            )
        )
    for _ in range(600):
        if address.exists() and address.read_text().strip():
            break
        time.sleep(0.1)
    client = distributed.Client(scheduler_file=str(address), timeout=60)
    client.wait_for_workers(2, timeout=120)
    yield client, started
    client.close()
    for process in reversed(started):
        process.kill()
        process.wait(60)


@needs_study
def test_a_study_on_dask_writes_the_same_bytes(cluster, tmp_path):
    client, _ = cluster
    mesh = morula.sample_body("limb", 8)
    with client.get_executor() as executor:
        spread = morula.study({"limb": mesh}, output=tmp_path / "spread", executor=executor, **small_study)
    cells = sorted((tmp_path / "spread" / "cells").glob("*.json"))
    assert len(cells) >= 2 * 3 * 2
    alone = morula.study({"limb": mesh}, output=tmp_path / "alone", **small_study)
    check_same_studies(tmp_path / "spread", tmp_path / "alone", spread, alone)


def check_same_studies(spread_folder, alone_folder, spread, alone):
    names = sorted(p.name for p in alone_folder.iterdir() if p.is_file())
    assert names == sorted(p.name for p in spread_folder.iterdir() if p.is_file()) and "study.json" in names
    timed = {"study.json", "index.html", *(f"{table['id']}.csv" for table in alone.json["tables"] if table.get("timed"))}
    compared = 0
    for name in names:
        if name in timed or "cost" in name:
            continue
        assert (spread_folder / name).read_bytes() == (alone_folder / name).read_bytes(), name
        compared += 1
    assert compared >= 5

    def untimed(found):
        kept = {key: value for key, value in found.json.items() if key not in ("cost", "claims", "tables")}
        for part in ("claims", "tables"):
            kept[part] = [{key: value for key, value in item.items() if key != "times"} for item in found.json[part] if not item.get("timed")]
        return kept

    assert json.dumps(untimed(spread)) == json.dumps(untimed(alone))
    # Cells of one machine and of many have the same names, none was in vain, and the same bytes, but for times.
    assert {p.name for p in (alone_folder / "cells").iterdir()} == {p.name for p in (spread_folder / "cells").iterdir()}
    for file in (alone_folder / "cells").glob("*.json"):
        if "cost" not in file.name:
            assert (spread_folder / "cells" / file.name).read_bytes() == file.read_bytes()


def test_dask_with_a_worker_that_is_killed(cluster, folder, expected, tmp_path):
    client, started = cluster
    seen = []

    def kill_one(done, total, seconds_left):
        seen.append(done)
        if len(seen) == 2:
            os.kill(started[1].pid, signal.SIGKILL)

    with client.get_executor() as executor:
        rows = morula.batch.run(folder, options, output=tmp_path, executor=executor, progress=kill_one)
    started[1].wait(30)
    assert started[1].returncode == -signal.SIGKILL and len(client.scheduler_info()["workers"]) == 1
    output, alone = expected
    assert rows == alone and len(rows) == 7 and sum(row["status"] == "ok" for row in rows) == 6
    for name in ("table.csv", "table.jsonl"):
        assert (tmp_path / name).read_bytes() == (output / name).read_bytes()
    assert trees_in(tmp_path) == trees_in(output)


def test_mpi_on_two_ranks(folder, expected, tmp_path):
    pytest.importorskip("mpi4py")
    mpiexec = shutil.which("mpiexec", path=f"{pathlib.Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}")
    if mpiexec is None:
        pytest.skip("there is no mpiexec")
    if subprocess.run([sys.executable, "-c", "import mpi4py.MPI"], capture_output=True).returncode:
        pytest.skip("mpi4py finds no MPI library")
    program = tmp_path / "program.py"
    program.write_text(
        textwrap.dedent(
            f"""
            import morula.batch
            from mpi4py.futures import MPIPoolExecutor

            if __name__ == "__main__":
                with MPIPoolExecutor() as executor:
                    morula.batch.run({str(folder)!r}, {options!r}, output="out", executor=executor)
            """
        )
    )
    done = subprocess.run(
        [mpiexec, "-n", "2", sys.executable, "-m", "mpi4py.futures", str(program)], cwd=tmp_path, capture_output=True, text=True,
        timeout=600,
    )
    assert done.returncode == 0, done.stderr
    for name in ("table.csv", "table.jsonl"):
        assert (tmp_path / "out" / name).read_bytes() == (expected[0] / name).read_bytes()


class Breaking(concurrent.futures.ThreadPoolExecutor):
    """Loses every third task."""

    def __init__(self):
        super().__init__(1)
        self.count = 0

    def submit(self, function, *arguments):
        self.count += 1
        if self.count % 3 == 0:
            return super().submit(divmod, 1, 0)
        return super().submit(function, *arguments)


def test_what_a_lost_worker_had_is_a_row_and_tried_again(folder, expected, tmp_path):
    with Breaking() as executor:
        rows = morula.batch.run(folder, options, output=tmp_path, executor=executor)
    assert [row["status"] for row in rows].count("lost") == 2
    assert morula.batch.run(folder, options, output=tmp_path, resume=True) == expected[1]


class Job:
    """What submitit gives: a result and nothing more."""

    def __init__(self, function, arguments):
        self.function, self.arguments = function, arguments

    def result(self):
        return self.function(*self.arguments)

    def cancel(self):
        pass


class Jobs:
    def submit(self, function, *arguments):
        return Job(function, arguments)


def test_jobs_that_are_no_futures(folder, expected, tmp_path):
    assert morula.batch.run(folder, options, output=tmp_path, executor=Jobs()) == expected[1]


def trees_in(output):
    """Bytes of all trees, by their names."""
    return {tree.name: tree.read_bytes() for tree in output.rglob("*.morula")}


def same_as(expected, folder):
    for name in ("table.csv", "table.jsonl"):
        assert (folder / name).read_bytes() == (expected[0] / name).read_bytes()
    assert trees_in(folder) == trees_in(expected[0])


def test_submitit_runs_jobs_of_its_own(folder, expected, tmp_path):
    submitit = pytest.importorskip("submitit")
    executor = submitit.AutoExecutor(folder=tmp_path / "logs", cluster="local")
    executor.update_parameters(timeout_min=10)
    assert morula.batch.run(folder, options, output=tmp_path / "out", executor=executor) == expected[1]
    same_as(expected, tmp_path / "out")


def test_tasks_of_ray(folder, expected, tmp_path):
    ray = pytest.importorskip("ray")
    ray.init(num_cpus=2, include_dashboard=False, log_to_driver=False)
    try:
        rows = morula.batch.run(folder, options, output=tmp_path / "out", executor=morula.batch.RayExecutor())
    finally:
        ray.shutdown()
    assert rows == expected[1]
    same_as(expected, tmp_path / "out")


def test_jobs_of_slurm_through_dask_jobqueue(folder, expected, tmp_path, monkeypatch):
    """SLURM's commands are stood in for by two that start and end processes here; all else is what a cluster sees."""
    jobqueue = pytest.importorskip("dask_jobqueue")
    distributed = pytest.importorskip("distributed")
    commands = tmp_path / "bin"
    commands.mkdir()
    (commands / "sbatch").write_text(
        f"""#!/bin/sh
job=$(mktemp -p {tmp_path})
cp "$1" "$job"
setsid sh "$job" >"$job.log" 2>&1 &
echo $! >>{tmp_path}/jobs
echo Submitted batch job $!
"""
    )
    (commands / "scancel").write_text('#!/bin/sh\nkill -- "-$1" 2>/dev/null || kill "$1"\n')
    for command in commands.iterdir():
        command.chmod(0o755)
    monkeypatch.setenv("PATH", f"{commands}{os.pathsep}{os.environ['PATH']}")
    with jobqueue.SLURMCluster(
        cores=1, processes=1, memory="2GB", python=sys.executable, interface=None, local_directory=str(tmp_path),
        log_directory=str(tmp_path / "logs"), walltime="00:10:00",
        scheduler_options={"host": "127.0.0.1", "dashboard": False, "dashboard_address": None},
    ) as cluster:
        cluster.scale(jobs=2)
        with distributed.Client(cluster, timeout=120) as client:
            client.wait_for_workers(2, timeout=120)
            with client.get_executor() as executor:
                rows = morula.batch.run(folder, options, output=tmp_path / "out", executor=executor)
    assert rows == expected[1] and len((tmp_path / "jobs").read_text().split()) == 2
    same_as(expected, tmp_path / "out")


def test_relative_paths_reach_workers_elsewhere(folder, expected, tmp_path, monkeypatch):
    with concurrent.futures.ProcessPoolExecutor(1, initializer=os.chdir, initargs=("/",)) as executor:
        executor.submit(os.getcwd).result()
        monkeypatch.chdir(tmp_path)
        rows = morula.batch.run(os.path.relpath(folder), options, output="out", executor=executor)
    assert rows == expected[1]


def test_archives_hold_the_trees(folder, expected, tmp_path):
    output, alone = expected
    rows = morula.batch.run(folder, options, output=tmp_path / "packed", archives=True)
    assert rows == alone
    trees = tmp_path / "packed" / "trees"
    assert not list(trees.rglob("*.morula"))
    found = {}
    for archive in sorted(trees.glob("*.tar")):
        with tarfile.open(archive) as packed:
            for member in packed:
                assert member.name[:2] == archive.name[:2]
                found[member.name] = packed.extractfile(member).read()
    assert found == trees_in(output)
    for row in rows:
        if row["status"] == "ok":
            mesh = morula.read_mesh(folder / row["name"])
            tree = morula.batch.tree_of(tmp_path / "packed", row["key"], mesh)
            assert tree == morula.build(mesh, **options) == morula.batch.tree_of(output, row["key"], mesh)
    with pytest.raises(KeyError):
        morula.batch.tree_of(output, "no such key", morula.sample_body("bar", 4))
    # In parts, and again: the same bytes.
    meshes = sorted(folder.iterdir())
    for some in (meshes[:3], meshes):
        morula.batch.run(some, options, output=tmp_path / "parts", archives=True, resume=True)
    assert {p.name: p.read_bytes() for p in (tmp_path / "parts" / "trees").glob("*.tar")} == {
        p.name: p.read_bytes() for p in trees.glob("*.tar")
    }
    # A tree in an archive is there; one in a damaged archive is not.
    calls = []
    progress = lambda *state: calls.append(state)  # noqa: E731
    assert morula.batch.run(folder, options, output=tmp_path / "packed", archives=True, resume=True, progress=progress) == alone and not calls
    next(trees.glob("*.tar")).write_bytes(b"damaged")
    with pytest.warns(UserWarning, match="damaged"):
        assert morula.batch.run(folder, options, output=tmp_path / "packed", archives=True, resume=True, progress=progress) == alone and calls


def test_the_table_as_parquet(expected):
    parquet = pytest.importorskip("pyarrow.parquet")
    output, rows = expected
    read = parquet.read_table(output / "table.parquet").to_pylist()
    assert [row["key"] for row in read] == [row["key"] for row in rows]
    for found, row in zip(read, rows):
        assert all(found[name] == row.get(name) for name in found) and found["name"] == row["name"]


@needs_study
def test_a_study_is_that_of_the_command(command, tmp_path):
    command("sample", "limb", "--resolution", "8", "-o", "body.obj")
    arguments = ["--quick", "--frames", "3", "--resolution", "24", "--branching", "4", "--methods", "octree,grid", "--rules", "exact,fresh"]
    command("study", "-o", "theirs", "--mesh", "body.obj", *arguments)
    shutil.copytree(tmp_path / "theirs" / "cells", tmp_path / "ours" / "cells")
    told = []
    ours = morula.study(tmp_path / "body.obj", output=tmp_path / "ours", progress=lambda *state: told.append(state), **small_study)
    # Times are kept among the cells: with these, every byte is the same.
    for file in sorted((tmp_path / "theirs").iterdir()):
        if file.is_file():
            assert (tmp_path / "ours" / file.name).read_bytes() == file.read_bytes(), file.name
    assert ours.json == json.loads((tmp_path / "theirs" / "study.json").read_text()) and ours.faults == []
    cells = ours.cells
    assert len({len(column) for column in cells.values()}) == 1 and len(cells) > 5
    assert ours.verdict("exact-covers") == "holds" and "claims" in repr(ours)
    # Python says the words of study.json, also for claims that lack what decides them.
    verdicts = {claim["id"]: claim["verdict"] for claim in json.loads((tmp_path / "theirs" / "study.json").read_text())["claims"]}
    assert {name: ours.verdict(name) for name in verdicts} == verdicts
    undecided = list(verdicts.values()).count("not decided")
    assert undecided > 0 and f"{undecided} not decided" in repr(ours)
    with pytest.raises(KeyError):
        ours.verdict("nothing")
    table = next(iter(ours.tables.values()))
    assert len({len(column) for column in table.values()}) == 1
    assert 0 <= told[0][0] <= told[-1][0] <= 1


@needs_study
def test_a_study_says_what_is_wrong(tmp_path):
    mesh = morula.sample_body("limb", 6)
    with pytest.raises(ValueError, match="nonsense"):
        morula.study(mesh, methods=["nonsense"], quick=True)
    with pytest.raises(ValueError, match="output"):
        morula.study(mesh, executor=Jobs(), quick=True)
    with pytest.raises(TypeError, match="frames"):
        morula.study(mesh, frames="many", quick=True)

    def stop(share, what):
        raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        morula.study(mesh, progress=stop, **small_study)


@needs_study
def test_a_study_on_any_executor_is_the_same(tmp_path):
    mesh = morula.sample_body("limb", 8)
    with concurrent.futures.ProcessPoolExecutor(2) as executor:
        spread = morula.study({"limb": mesh}, output=tmp_path / "spread", executor=executor, **small_study)
    alone = morula.study({"limb": mesh}, output=tmp_path / "alone", **small_study)
    check_same_studies(tmp_path / "spread", tmp_path / "alone", spread, alone)
