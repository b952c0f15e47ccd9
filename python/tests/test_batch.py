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


def same_tables(a, b):
    for name in ("table.csv", "table.jsonl"):
        assert (a / name).read_bytes() == (b / name).read_bytes(), name


def trees_in(output):
    """Bytes of all trees, by their names within the output."""
    return {str(tree.relative_to(output)): tree.read_bytes() for tree in output.rglob("*.morula")}


def test_every_mesh_is_a_row(folder, tmp_path):
    rows = morula.batch.run(folder, options, output=tmp_path, jobs=2, measure=True)
    by_name = {row["name"]: row for row in rows}
    assert [row["name"] for row in rows] == ["again.obj", "bar.obj", "blob.obj", "broken.obj", "limb.obj", "torus.obj"]
    assert by_name["broken.obj"]["status"] == "refused" and by_name["broken.obj"]["message"].startswith("broken.obj:1")
    assert by_name["again.obj"]["key"] == by_name["bar.obj"]["key"]
    mesh = morula.read_mesh(folder / "limb.obj")
    model = morula.build(mesh, **options)
    row = by_name["limb.obj"]
    assert row["nodes"] == len(model) and row["looseness"] == [m.looseness.looseness for m in morula.measure(mesh, model)]
    assert row["uncovered_distance"] == [0.0] * 3 and row["closed"] is True
    assert morula.read_covered_tree(tmp_path / row["tree"], mesh) == model == morula.batch.tree_of(tmp_path, row["key"], mesh)
    with open(tmp_path / "table.csv", newline="") as file:
        lines = list(csv.DictReader(file))
    assert [line["status"] for line in lines] == [row["status"] for row in rows]
    assert json.loads(lines[4]["looseness"]) == row["looseness"]
    assert [json.loads(line) for line in (tmp_path / "table.jsonl").read_text().splitlines()] == rows


def test_the_command_and_the_package_are_one(folder, tmp_path, command):
    """Same files, undisturbed and where either goes on with what the other has begun."""
    given = ["--method", "octree", "--depth", "2"]
    command("batch", folder, "-o", tmp_path / "command", *given, "--measure", code=1)
    morula.batch.run(folder, options, output=tmp_path / "package", measure=True)
    # A half by one, the rest by the other: three of five results are there.
    one, other = tmp_path / "begun by the command", tmp_path / "begun by the package"
    command("batch", folder, "-o", one, *given, "--measure", "--shard", "1/2")
    calls = []
    morula.batch.run(folder, options, output=one, measure=True, resume=True, progress=lambda *state: calls.append(state))
    assert len(calls) == 2
    morula.batch.run(folder, options, output=other, measure=True, shard=(1, 2))
    said = json.loads(command("batch", folder, "-o", other, *given, "--measure", "--resume", "--json", code=1))
    assert said["built"] == 2 and said["kept"] == 3 and said["remade"] == 0
    for half in (one, other):
        same_tables(half, tmp_path / "command")
        assert trees_in(half) == trees_in(tmp_path / "command")
    same_tables(tmp_path / "package", tmp_path / "command")
    assert trees_in(tmp_path / "package") == trees_in(tmp_path / "command") and len(trees_in(tmp_path / "package")) == 4
    results = [sorted(str(p.relative_to(tmp_path / run)) for p in (tmp_path / run / "results").rglob("*.json")) for run in ("command", "package")]
    assert results[0] == results[1] and len(results[0]) == 5
    header = (tmp_path / "package" / "cost.csv").read_text().splitlines()[0]
    assert header == (tmp_path / "command" / "cost.csv").read_text().splitlines()[0] == "name,key,seconds,cpu_seconds,peak_mb"


def test_what_is_done_is_not_done_again(folder, tmp_path):
    first = morula.batch.run(folder, options, output=tmp_path)
    calls = []
    with pytest.raises(ValueError, match="holds results of an earlier batch: add resume=True"):
        morula.batch.run(folder, options, output=tmp_path)
    again = morula.batch.run(folder, options, output=tmp_path, resume=True, progress=lambda *state: calls.append(state))
    assert again == first and calls == []
    other = morula.batch.run([folder / "bar.obj"], {**options, "depth": 1}, output=tmp_path, resume=True)
    assert other[0]["key"] not in {row["key"] for row in first}
    retried = morula.batch.run(folder, options, output=tmp_path, retry=True, progress=lambda *state: calls.append(state))
    assert retried == first and len(calls) == 1


def test_what_is_damaged_is_done_again(folder, tmp_path):
    first = morula.batch.run(folder, options, output=tmp_path)
    before, table = trees_in(tmp_path), (tmp_path / "table.csv").read_bytes()
    trees = [tmp_path / row["tree"] for row in first if row["name"] in ("bar.obj", "limb.obj", "torus.obj")]
    trees[0].unlink()
    trees[1].write_bytes(trees[1].read_bytes()[:-1])
    trees[2].write_bytes(trees[0].with_name("x").name.encode())
    blob = next(row["key"] for row in first if row["name"] == "blob.obj")
    (tmp_path / "results" / blob[:2] / f"{blob}.json").write_text('{"status": "ok"}')
    calls = []
    with pytest.warns(UserWarning, match="4 results in the folder were damaged"):
        again = morula.batch.run(folder, options, output=tmp_path, resume=True, progress=lambda *state: calls.append(state))
    assert again == first and len(calls) == 4
    assert trees_in(tmp_path) == before and (tmp_path / "table.csv").read_bytes() == table


def test_wrong_options_are_told_once_and_before_any_mesh(folder, tmp_path, command):
    for wrong, words in (
        ({"qualty": "fast"}, "unknown option '--qualty', did you mean --quality"),
        ({"method": "gird"}, "did you mean grid"),
        ({"spheres": 8, "depth": 2}, "contradict each other"),
        ({"branching": 99}, "branching"),
        ({"depth": 1.5}, "depth"),
        ({"max_protrusion": -1}, "max-protrusion"),
    ):
        with pytest.raises(ValueError, match=words) as raised:
            morula.batch.run(folder, wrong, output=tmp_path / "out")
        words = [word for name, value in wrong.items() for word in (f"--{name.replace('_', '-')}", value)]
        done = subprocess.run(
            [sys.executable, "-m", "morula", "batch", str(folder), "-o", str(tmp_path / "out"), *map(str, words)], capture_output=True, text=True
        )
        assert (done.returncode, done.stderr) == (2, f"morula: error: {raised.value}\n")
    for arguments in ({"time_limit": 0}, {"memory_limit": 3}, {"jobs": -1}, {"shard": (0, 3)}, {"shard": (4, 3)}):
        with pytest.raises(ValueError, match=next(iter(arguments)).replace("_", "-")):
            morula.batch.run(folder, options, output=tmp_path / "out", **arguments)
    with pytest.raises(ValueError, match="argument of run"):
        morula.batch.run(folder, {"resume": True}, output=tmp_path / "out")
    assert not (tmp_path / "out").exists()


def test_shards_are_all_there_is(folder, tmp_path):
    whole = morula.batch.run(folder, options, output=tmp_path / "whole")
    parts = [morula.batch.run(folder, options, output=tmp_path / "parts", shard=(i, 3)) for i in (1, 2, 3)]
    assert sorted(row["name"] for part in parts for row in part) == [row["name"] for row in whole]
    assert (tmp_path / "parts" / "table-2-of-3.csv").exists()


def test_manifests(folder, tmp_path):
    (folder / "list.txt").write_text("# two\nbar.obj\n\nlimb.obj\n")
    (folder / "list.csv").write_text("name,mesh\na,bar.obj\nb,limb.obj\n")
    of_text = morula.batch.run(folder / "list.txt", options, output=tmp_path / "a")
    of_csv = morula.batch.run(folder / "list.csv", options, output=tmp_path / "b")
    of_paths = morula.batch.run([folder / "bar.obj", str(folder / "limb.obj")], options, output=tmp_path / "c")
    assert [row["name"] for row in of_text] == ["bar.obj", "limb.obj"] and [row["name"] for row in of_csv] == ["a", "b"]
    assert [row["name"] for row in of_paths] == [str(folder / "bar.obj"), str(folder / "limb.obj")]
    assert [row["key"] for row in of_text] == [row["key"] for row in of_csv] == [row["key"] for row in of_paths]
    (folder / "wrong.csv").write_text("name\na\n")
    with pytest.raises(ValueError, match="no column is called mesh"):
        morula.batch.run(folder / "wrong.csv", options, output=tmp_path / "d")
    nowhere = morula.batch.run([tmp_path / "nowhere.obj"], options, output=tmp_path / "e")[0]
    assert nowhere["status"] == "refused" and nowhere["message"] == f"{tmp_path}/nowhere.obj: there is no such file"


def test_whatever_lies_in_a_folder_is_a_row(folder, tmp_path):
    meshes = tmp_path / "in"
    (meshes / "folder.obj").mkdir(parents=True)
    bar = (folder / "bar.obj").read_bytes()
    for name in (b"a\xff.obj", b"a\\xFF.obj"):
        with open(os.path.join(os.fsencode(meshes), name), "wb") as file:
            file.write(bar)
    os.mkfifo(meshes / "fifo.obj")
    (meshes / "loop.obj").symlink_to("loop.obj")
    (meshes / "dangling.obj").symlink_to("nowhere.obj")
    rows = morula.batch.run(meshes, options, output=tmp_path / "out")
    statuses = {row["name"]: row["status"] for row in rows}
    assert statuses == {
        r"a\xFF.obj": "ok", r"a\\xFF.obj": "ok", "fifo.obj": "refused", "folder.obj": "refused", "loop.obj": "refused", "dangling.obj": "refused",
    }
    named = morula.batch.run([os.fsdecode(os.path.join(os.fsencode(meshes), b"a\xff.obj")), meshes / "fifo.obj"], options, output=tmp_path / "b")
    assert [row["status"] for row in named] == ["ok", "refused"] and named[0]["name"].endswith(r"in/a\xFF.obj")


def test_meshes_outside_of_a_manifests_folder_are_refused_unless_a_root_allows_them(folder, tmp_path):
    lists = tmp_path / "lists"
    lists.mkdir()
    bar, up = folder / "bar.obj", os.path.relpath(folder / "bar.obj", lists)
    (lists / "link.obj").symlink_to(bar)
    (lists / "a bar.obj").write_bytes(bar.read_bytes())
    manifest = lists / "list.txt"
    names = [str(bar), f"file://{bar}", up, up.replace("..", "%2e%2e"), "link.obj"]
    manifest.write_text("".join(f"{name}\n" for name in ("a bar.obj", *names)))
    rows = morula.batch.run(manifest, options, output=tmp_path / "a")
    assert [row["status"] for row in rows] == ["ok"] + ["refused"] * 5
    assert all("lies outside" in row["message"] and "allow its folder with --root" in row["message"] for row in rows[1:])
    rows = morula.batch.run(manifest, options, output=tmp_path / "b", roots=[folder])
    assert [row["status"] for row in rows] == ["ok"] * 6
    rows = morula.batch.run(lists, options, output=tmp_path / "c")
    assert {row["name"]: row["status"] for row in rows} == {"a bar.obj": "ok", "link.obj": "refused"}
    assert morula.batch.run([bar], options, output=tmp_path / "d")[0]["status"] == "ok", "what the caller names is the caller's"


def test_other_file_systems_give_the_same(folder, tmp_path):
    fsspec = pytest.importorskip("fsspec")
    for name in ("list.txt", "list.csv", "wrong.csv"):
        (folder / name).unlink(missing_ok=True)
    here = morula.batch.run(folder, options, output=tmp_path / "here", archives=True)
    memory = fsspec.filesystem("memory")
    memory.put(f"{folder}/", "/meshes/", recursive=True)
    try:
        calls = []
        arguments = {"output": "memory://out", "archives": True, "progress": lambda *state: calls.append(state)}
        there = morula.batch.run("memory://meshes", options, jobs=2, **arguments)
        assert there == here and len(here) == 6
        for name in ("table.csv", "table.jsonl", *(f"trees/{tree.name}" for tree in (tmp_path / "here" / "trees").glob("*.tar"))):
            assert memory.cat_file(f"/out/{name}") == (tmp_path / "here" / name).read_bytes(), name
        mesh = morula.read_mesh(folder / "limb.obj")
        key = next(row["key"] for row in here if row["name"] == "limb.obj")
        assert morula.batch.tree_of("memory://out", key, mesh) == morula.build(mesh, **options)
        with pytest.raises(KeyError):
            morula.batch.tree_of("memory://out", "none", mesh)
        # What is done is not done again, there too, with archives or without; what is damaged is.
        done = len(calls)
        assert morula.batch.run("memory://meshes", options, resume=True, **arguments) == there and len(calls) == done
        memory.pipe_file(f"/out/results/{key[:2]}/{key}.json", b"{}")
        with pytest.warns(UserWarning, match="1 result in the folder was damaged"):
            assert morula.batch.run("memory://meshes", options, resume=True, **arguments) == there and len(calls) == done + 1
        memory.pipe_file("/some.csv", b"mesh\nmeshes/bar.obj\nmemory://meshes/nowhere.obj\n")
        some = morula.batch.run("memory://some.csv", options, output="memory://other")
        assert [row["status"] for row in some] == ["ok", "refused"] and "nowhere.obj: cannot be read" in some[1]["message"]
        memory.cat_file(f"/other/{some[0]['tree']}")
        assert not memory.exists("/trees") and not morula.batch.run("memory://some.csv", options, output="memory://bare", no_trees=True)[0].get("tree")
        assert memory.find("/bare/trees") == []
    finally:
        memory.rm("/", recursive=True)


def test_urls_of_this_machine_are_paths(folder, tmp_path):
    url = (tmp_path / "with a space").as_uri()
    rows = morula.batch.run(folder.as_uri(), options, output=url)
    assert rows == morula.batch.run(folder, options, output=tmp_path / "plain")
    same_tables(tmp_path / "with a space", tmp_path / "plain")


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
        row = morula.batch.run(["memory://gltf/a.gltf"], options, output=tmp_path / "there")[0]
        assert row["status"] == "ok" and row["facets"] == 4
        memory.get("/gltf", str(tmp_path), recursive=True)
        assert morula.batch.run([tmp_path / "gltf" / "a.gltf"], options, output=tmp_path / "here")[0]["key"] == row["key"]
        # Another buffer is another mesh.
        memory.pipe_file("/gltf/data of/it.bin", positions[:-4] + struct.pack("<f", 2) + faces)
        other = morula.batch.run(["memory://gltf/a.gltf"], options, output=tmp_path / "there", resume=True)[0]
        assert other["key"] != row["key"] and other["mesh_hash"] != row["mesh_hash"]
    finally:
        memory.rm("/", recursive=True)


def test_limits_are_rows(folder, tmp_path):
    morula.write_mesh(tmp_path / "large.obj", morula.sample_body("limb", 384))
    (tmp_path / "tetrahedron.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n")
    # The large one takes minutes.
    meshes = [tmp_path / "large.obj", tmp_path / "tetrahedron.obj"]
    slow, quick = morula.batch.run(meshes, {"quality": "best"}, output=tmp_path / "a", time_limit=6.5, jobs=1)
    assert (slow["status"], slow["message"]) == ("time limit", "not done after 6.5 s") and quick["status"] == "ok"
    assert morula.batch.run(meshes, {"quality": "best"}, output=tmp_path / "a", resume=True)[0] == slow
    starved, good = morula.batch.run([tmp_path / "large.obj", folder / "bar.obj"], options, output=tmp_path / "b", memory_limit=64, jobs=1)
    assert starved["status"] == "memory limit" and good["status"] == "ok"


def test_an_interrupted_run_ends_its_workers(folder, tmp_path):
    morula.write_mesh(tmp_path / "limb.obj", morula.sample_body("limb", 96))
    program = f"import morula.batch; morula.batch.run([{str(tmp_path / 'limb.obj')!r}], {{'quality': 'best'}}, output={str(tmp_path / 'out')!r})"
    running = subprocess.Popen([sys.executable, "-c", program], stderr=subprocess.PIPE, text=True, start_new_session=True)
    for _ in range(3000):
        if list(tmp_path.glob("out/trees/*")):
            break
        time.sleep(0.01)
    running.send_signal(signal.SIGINT)
    assert "KeyboardInterrupt" in running.communicate(timeout=60)[1]
    with pytest.raises(ProcessLookupError):
        for _ in range(500):
            os.killpg(running.pid, 0)
            time.sleep(0.01)
    assert not [p for p in tmp_path.rglob("*") if p.is_file() and p.name != "limb.obj"]


@pytest.mark.parametrize("kind", [concurrent.futures.ThreadPoolExecutor, concurrent.futures.ProcessPoolExecutor])
def test_any_executor_gives_the_same(folder, tmp_path, kind):
    with kind(2) as executor:
        rows = morula.batch.run(folder, options, output=tmp_path / "a", executor=executor)
    assert rows == morula.batch.run(folder, options, output=tmp_path / "b")


def test_a_killed_run_ends_as_one_that_was_not(folder, tmp_path):
    def arguments(output):
        return [sys.executable, "-m", "morula", "batch", str(folder), "--method", "octree", "--depth", "2", "--resume", "-o", str(output)]

    undisturbed = subprocess.run(arguments(tmp_path / "a"), capture_output=True, text=True)
    assert undisturbed.returncode == 1 and "refused        1" in undisturbed.stdout
    killed = subprocess.Popen([*arguments(tmp_path / "b"), "--jobs", "1"], stderr=subprocess.DEVNULL)
    for _ in range(6000):
        if len(list((tmp_path / "b").glob("results/*/*.json"))) >= 2:
            break
        time.sleep(0.005)
    killed.send_signal(signal.SIGKILL)
    killed.wait()
    assert not (tmp_path / "b" / "table.csv").exists()
    morula.batch.run(folder, options, output=tmp_path / "b", resume=True)
    same_tables(tmp_path / "a", tmp_path / "b")
    assert trees_in(tmp_path / "a") == trees_in(tmp_path / "b") and len(trees_in(tmp_path / "b")) == 4


def test_the_module_names_the_command_that_is_meant():
    done = subprocess.run([sys.executable, "-m", "morula.batch", "meshes"], capture_output=True, text=True, check=False)
    assert done.returncode == 1
    assert "python -m morula batch" in done.stderr
