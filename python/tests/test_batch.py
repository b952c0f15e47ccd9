# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Many meshes: every failure is a row, and a run that was killed ends as one that was not."""

import concurrent.futures
import csv
import json
import os
import signal
import struct
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


def test_meshes_outside_of_a_manifests_folder_are_refused_unless_a_root_allows_them(folder, tmp_path):
    lists = tmp_path / "lists"
    lists.mkdir()
    bar = (folder / "bar.obj").resolve()
    (lists / "a bar.obj").write_bytes(bar.read_bytes())
    (lists / "link.obj").symlink_to(bar)
    manifest = lists / "list.txt"
    manifest.write_text("a%20bar.obj\n")
    assert morula.batch.meshes_of(manifest) == [lists / "a bar.obj"]
    up = os.path.relpath(bar, lists)
    for name in (str(bar), f"file://{bar}", up, up.replace("..", "%2e%2e"), "link.obj"):
        manifest.write_text(f"a bar.obj\n{name}\n")
        with pytest.raises(ValueError, match=r"list.txt: .* lies outside .*; allow its folder with roots="):
            morula.batch.meshes_of(manifest)
        assert morula.batch.meshes_of(manifest, roots=[folder])[1].samefile(bar)
    with pytest.raises(ValueError, match="lies outside"):
        morula.batch.meshes_of(lists)
    assert morula.batch.meshes_of([bar]) == [bar], "what the caller names is the caller's"


def test_other_file_systems_give_the_same(folder, tmp_path):
    fsspec = pytest.importorskip("fsspec")
    here = morula.batch.run(folder, options, output=tmp_path / "here", archives=True)
    memory = fsspec.filesystem("memory")
    memory.put(f"{folder}/", "/meshes/", recursive=True)
    (folder / "list.txt").unlink(missing_ok=True)
    try:
        calls = []
        there = morula.batch.run(
            "memory://meshes", options, output="memory://out", archives=True, jobs=2, progress=lambda *state: calls.append(state)
        )
        assert [row["mesh"] for row in there] == [f"memory:///meshes/{row['mesh'].rsplit('/', 1)[-1]}" for row in here]
        bare = [{name: value for name, value in row.items() if name not in ("mesh", "error", "key")} for row in there]
        assert bare == [{name: value for name, value in row.items() if name not in ("mesh", "error", "key")} for row in here]
        good = [(a["key"], b["key"]) for a, b in zip(there, here) if b["status"] == "ok"]
        assert len(good) == 5 and all(a == b for a, b in good)
        broken = next(row for row in there if row["status"] != "ok")
        assert "memory:///meshes/broken.obj" in broken["error"]
        for tree in (tmp_path / "here" / "trees").iterdir():
            assert memory.cat_file(f"/out/trees/{tree.name}") == tree.read_bytes()
        mesh = morula.read_mesh(folder / "limb.obj")
        key = next(row["key"] for row in here if row["mesh"].endswith("limb.obj"))
        assert morula.batch.tree_of("memory://out", key, mesh) == morula.build(mesh, **options)
        with pytest.raises(KeyError):
            morula.batch.tree_of("memory://out", "none", mesh)
        table = memory.cat_file("/out/table.jsonl").decode()
        assert [json.loads(line)["status"] for line in table.splitlines()] == [row["status"] for row in here]
        # What is done is not done again, there too; without archives trees are files.
        done = len(calls)
        again = morula.batch.run("memory://meshes", options, output="memory://out", progress=lambda *state: calls.append(state))
        assert again == there and len(calls) == done
        memory.pipe_file("/some.csv", b"mesh\nmeshes/bar.obj\nmemory://meshes/nowhere.obj\n")
        some = morula.batch.run("memory://some.csv", options, output="memory://other")
        assert [row["status"] for row in some] == ["ok", "failed"] and "nowhere.obj" in some[1]["error"]
        memory.cat_file(f"/other/trees/{some[0]['key']}.morula")
    finally:
        memory.rm("/", recursive=True)


def test_urls_of_this_machine_are_paths(folder, tmp_path):
    url = (tmp_path / "with a space").as_uri()
    rows = morula.batch.run(folder.as_uri(), options, output=url)
    assert rows == morula.batch.run(folder, options, output=tmp_path / "plain")
    assert (tmp_path / "with a space" / "table.csv").read_bytes() == (tmp_path / "plain" / "table.csv").read_bytes()


def test_a_file_system_without_fsspec_says_what_it_needs(tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, "fsspec", None)
    with pytest.raises(ImportError, match="s3://bucket.*pip install fsspec"):
        morula.batch.run("s3://bucket/meshes", options, output=tmp_path)


def test_gltf_brings_its_buffers_from_elsewhere(tmp_path):
    fsspec = pytest.importorskip("fsspec")
    if ".gltf" not in morula.readable_mesh_extensions():
        pytest.skip("this package reads no glTF")
    positions = b"".join(struct.pack("<3f", *p) for p in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
    faces = struct.pack("<12H", 0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 3, 2)
    scene = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 1]},
            {"bufferView": 1, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": len(positions)},
            {"buffer": 0, "byteOffset": len(positions), "byteLength": len(faces)},
        ],
        "buffers": [{"uri": "data%20of/it.bin", "byteLength": len(positions) + len(faces)}],
    }
    memory = fsspec.filesystem("memory")
    try:
        memory.pipe_file("/gltf/a.gltf", json.dumps(scene).encode())
        memory.pipe_file("/gltf/data of/it.bin", positions + faces)
        row = morula.batch.run(["memory://gltf/a.gltf"], options, output=tmp_path)[0]
        assert row["status"] == "ok" and row["facets"] == 4
    finally:
        memory.rm("/", recursive=True)


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
