#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Files of every format version, read by the layout that docs/reference/formats.md documents and nothing else: their parts agree with
each other, and each sphere contains its region. usage: golden_files_test.py ROOT"""
import json
import math
import pathlib
import struct
import sys

folder = pathlib.Path(sys.argv[1]) / "tests/golden/files"


def expect(condition, *what):
    if not condition:
        sys.exit(" ".join(map(str, what)))


def fnv1a(data):
    value = 0xcbf29ce484222325
    for byte in data:
        value = (value ^ byte) * 0x100000001b3 % 2**64
    return value


def read_native(path, version):
    """Header and arrays of a .morula file."""
    data = path.read_bytes()
    found, length, size = struct.unpack_from("<IIQ", data, 8)
    expect(data[:8] == b"MORULA\r\n" and found == version and size == len(data), path, "has another beginning")
    expect(fnv1a(data[:-8]) == struct.unpack_from("<Q", data, size - 8)[0], path, "has another checksum")
    expect((24 + length) % 8 == 0, path, "has a header of", length, "bytes")
    header, arrays = json.loads(data[24:24 + length]), {}
    for array in header["arrays"]:
        count, code = array["width"] * array["rows"], {"uint32": "I", "float64": "d"}[array["type"]]
        values = struct.unpack_from(f"<{count}{code}", data, 24 + length + array["offset"])
        width = array["width"]
        arrays[array["name"]] = list(values) if width == 1 else [values[i:i + width] for i in range(0, count, width)]
        expect(array["offset"] % 8 == 0, array["name"], "is not at a multiple of 8")
    return header, arrays


def point_of(corner, positions, arrays, before):
    if corner < len(positions):
        return positions[corner]
    vertices, weights = (arrays[f"{before}cut_point_{part}"][corner - len(positions)] for part in ("vertices", "weights"))
    return tuple(sum(w * positions[v][axis] for v, w in zip(vertices, weights)) for axis in range(3))


def check_tree(arrays, before, positions):
    """Children are adjacent and in order; every corner of a node's patches is in its sphere."""
    spheres, counts = arrays[before + "spheres"], arrays[before + "child_count"]
    expect(len(spheres) == len(counts) == arrays[before + "level_begin"][-1] and sum(counts) == len(spheres) - 1, "nodes do not add up")
    begin, corners = arrays[before + "corner_begin"], arrays[before + "corners"]
    for (x, y, z, r), first, end in zip(spheres, arrays[before + "region_begin"], arrays[before + "region_end"]):
        points = [point_of(corner, positions, arrays, before) for corner in corners[begin[first]:begin[end]]]
        expect(points and all(math.dist((x, y, z), point) <= r * (1 + 1e-12) for point in points), "a sphere does not contain its region")
    return spheres


lines = [line.split() for line in (folder / "octahedron.obj").read_text().splitlines()]
positions = [tuple(map(float, words[1:])) for words in lines if words[0] == "v"]
trees = sorted(folder.glob("tree_*.morula"))
expect(trees, "there is no tree")
for path in trees:
    header, arrays = read_native(path, int(path.stem.rpartition("_")[2]))
    expect(header["mesh"]["vertices"] == len(positions) and len(header["poses"]) == 1, path, "is of another mesh")
    spheres = check_tree(arrays, "", positions)
    check_tree(arrays, "pose 0 ", arrays["pose 0 positions"])
    # The same tree as JSON.
    text = json.loads((folder / "spheres_1.json").read_text())
    expect(text["format"] == "morula spheres" and text["version"] == 1, "spheres_1.json is of another version")
    expect([(*node["center"], node["radius"]) for node in text["nodes"]] == spheres, path, "has other spheres than spheres_1.json")
    expect([len(node["children"]) for node in text["nodes"]] == arrays["child_count"], path, "has other children than spheres_1.json")
for path in folder.glob("robot_spheres_*.json"):
    text = json.loads(path.read_text())
    expect(text["format"] == "morula robot spheres" and text["format_version"] == int(path.stem.rpartition("_")[2]), path, "is of another version")
    expect(text["spheres"] == sum(len(link["spheres"]) for link in text["links"]), path, "has another number of spheres")
print(f"{len(trees)} trees, their spheres, and files of robots are as documented")
