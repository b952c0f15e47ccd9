# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Many meshes: every failure is a row, and a run that was killed ends as one that was not."""

import concurrent.futures
import csv
import json
import signal
import subprocess
import sys
import time

import pytest

import morula

options = {"method": "octree", "depth": 2}


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    folder = tmp_path_factory.mktemp("meshes")
    for name in ("bar", "blob", "limb", "torus"):
        morula.write_mesh(folder / f"{name}.obj", morula.sample_body(name, 8))
    (folder / "again.obj").write_bytes((folder / "bar.obj").read_bytes())
    (folder / "broken.obj").write_text("v 1 2\nf 1 2 3\n")
    return folder


def test_every_mesh_is_a_row(folder, tmp_path):
    rows = morula.batch.run(folder, options, output=tmp_path, jobs=2)
    by_name = {row["mesh"].rsplit("/", 1)[-1]: row for row in rows}
    assert [row["mesh"] for row in rows] == sorted(row["mesh"] for row in rows) and len(rows) == 6
    assert by_name["broken.obj"]["status"] == "failed" and "broken.obj" in by_name["broken.obj"]["error"]
    assert by_name["again.obj"]["key"] == by_name["bar.obj"]["key"]
    mesh = morula.read_mesh(folder / "limb.obj")
    built = morula.build(mesh, **options)
    row = by_name["limb.obj"]
    assert row["nodes"] == len(built) and row["looseness"] == [m.looseness.looseness for m in morula.measure(mesh, built)]
    assert morula.read_covered_tree(tmp_path / "trees" / f"{row['key']}.morula", mesh) == built
    with open(tmp_path / "table.csv", newline="") as file:
        assert [line["status"] for line in csv.DictReader(file)] == [row["status"] for row in rows]
    lines = [json.loads(line) for line in (tmp_path / "table.jsonl").read_text().splitlines()]
    assert [line["key"] for line in lines] == [row["key"] for row in rows]


def test_what_is_done_is_not_done_again(folder, tmp_path):
    first = morula.batch.run(folder, options, output=tmp_path)
    calls = []
    again = morula.batch.run(folder, options, output=tmp_path, progress=lambda *state: calls.append(state))
    assert again == first and calls == []
    other = morula.batch.run([folder / "bar.obj"], {**options, "depth": 1}, output=tmp_path)
    assert other[0]["key"] not in {row["key"] for row in first}
    retried = morula.batch.run(folder, options, output=tmp_path, retry=True, progress=lambda *state: calls.append(state))
    assert retried == first and len(calls) == 1


def test_shards_are_all_there_is(folder, tmp_path):
    whole = morula.batch.run(folder, options, output=tmp_path / "whole")
    parts = [morula.batch.run(folder, options, output=tmp_path / "parts", shard=(i, 3)) for i in (1, 2, 3)]
    assert sorted(row["mesh"] for part in parts for row in part) == [row["mesh"] for row in whole]
    assert (tmp_path / "parts" / "table-2-of-3.csv").exists()
    with pytest.raises(ValueError, match="shard"):
        morula.batch.run(folder, options, output=tmp_path, shard=(0, 3))


def test_manifests(folder, tmp_path):
    (folder / "list.txt").write_text("# two\nbar.obj\n\nlimb.obj\n")
    (folder / "list.csv").write_text("name,mesh\na,bar.obj\nb,limb.obj\n")
    expected = [folder / "bar.obj", folder / "limb.obj"]
    assert morula.batch.meshes_of(folder / "list.txt") == morula.batch.meshes_of(folder / "list.csv") == expected
    (folder / "wrong.csv").write_text("name\na\n")
    with pytest.raises(ValueError, match="column `mesh`"):
        morula.batch.meshes_of(folder / "wrong.csv")
    assert morula.batch.run([tmp_path / "nowhere.obj"], output=tmp_path)[0]["status"] == "failed"


def test_limits_are_rows(folder, tmp_path):
    # Python alone takes longer than this to start.
    slow = morula.batch.run([folder / "bar.obj"], options, output=tmp_path / "a", time_limit=0.005)[0]
    assert slow["status"] == "timed out" and "0.005 s" in slow["error"]
    assert morula.batch.run([folder / "bar.obj"], options, output=tmp_path / "a")[0] == slow
    assert morula.batch.run([folder / "bar.obj"], options, output=tmp_path / "a", retry=True)[0]["status"] == "ok"
    starved = morula.batch.run([folder / "bar.obj"], options, output=tmp_path / "b", memory_limit_mb=20)[0]
    assert starved["status"] in ("crashed", "out of memory", "failed")


@pytest.mark.parametrize("kind", [concurrent.futures.ThreadPoolExecutor, concurrent.futures.ProcessPoolExecutor])
def test_any_executor_gives_the_same(folder, tmp_path, kind):
    with kind(2) as executor:
        rows = morula.batch.run(folder, options, output=tmp_path / "a", executor=executor)
    assert rows == morula.batch.run(folder, options, output=tmp_path / "b")


def test_a_killed_run_ends_as_one_that_was_not(folder, tmp_path):
    arguments = [sys.executable, "-m", "morula.batch", str(folder), "--method", "octree", "--depth", "2", "-o"]
    undisturbed = subprocess.run([*arguments, str(tmp_path / "a")], capture_output=True, text=True)
    assert undisturbed.returncode == 1 and "1 of them failed" in undisturbed.stdout
    killed = subprocess.Popen([*arguments, str(tmp_path / "b")], stderr=subprocess.DEVNULL)
    rows = tmp_path / "b" / "rows"
    for _ in range(600):
        if rows.exists() and len(list(rows.glob("*.json"))) >= 2:
            break
        time.sleep(0.05)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    assert not (tmp_path / "b" / "table.csv").exists()
    subprocess.run([*arguments, str(tmp_path / "b")], capture_output=True)
    for name in ("table.csv", "table.jsonl"):
        assert (tmp_path / "b" / name).read_bytes() == (tmp_path / "a" / name).read_bytes()
    trees = [sorted(p.name for p in (tmp_path / run / "trees").glob("*.morula")) for run in "ab"]
    assert trees[0] == trees[1] and len(trees[0]) == 4
