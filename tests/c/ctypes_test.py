#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The C interface as another language calls it: no header, no compiler. Spheres are judged here: each point of the
moved surface lies in a leaf's sphere.
Usage: ctypes_test.py path/to/libmorula.so"""
import ctypes
import math
import sys

lib = ctypes.CDLL(sys.argv[1])
pointer, size = ctypes.c_void_p, ctypes.c_size_t
lib.morula_message.restype = lib.morula_version.restype = ctypes.c_char_p
for name in ("mesh_vertex_count", "mesh_facet_count", "model_node_count", "model_level_count", "body_node_count"):
    function = getattr(lib, "morula_" + name)
    function.restype, function.argtypes = size, [pointer]
lib.morula_mesh_positions.restype = ctypes.POINTER(ctypes.c_double)
lib.morula_mesh_facets.restype = ctypes.POINTER(ctypes.c_uint32)
for name in ("mesh_positions", "mesh_facets", "mesh_destroy", "model_destroy", "body_destroy"):
    getattr(lib, "morula_" + name).argtypes = [pointer]


def must(status):
    if status != 0:
        sys.exit(f"status {status}: {lib.morula_message().decode()}")


def handle():
    return ctypes.c_void_p()


mesh, model, body = handle(), handle(), handle()
must(lib.morula_mesh_sample(b"torus", 16, ctypes.byref(mesh)))
must(lib.morula_build(mesh, None, ctypes.byref(model)))
must(lib.morula_body_create(mesh, model, None, ctypes.byref(body)))
vertices, facets = lib.morula_mesh_vertex_count(mesh), lib.morula_mesh_facet_count(mesh)
rest, corners = lib.morula_mesh_positions(mesh), lib.morula_mesh_facets(mesh)
positions = (ctypes.c_double * (3 * vertices))()
for v in range(vertices):
    x, y, z = rest[3 * v], rest[3 * v + 1], rest[3 * v + 2]
    positions[3 * v], positions[3 * v + 1], positions[3 * v + 2] = 1.5 * x + 0.2 * y * z, y, z + 0.3 * math.sin(3 * x)
must(lib.morula_body_update_double(body, positions, size(vertices), size(0)))
nodes = lib.morula_body_node_count(body)
spheres = (ctypes.c_double * (4 * nodes))()
must(lib.morula_body_spheres(body, spheres))
level = lib.morula_model_level_count(model) - 1
count = size()
must(lib.morula_model_level_set(model, size(level), None, size(0), ctypes.byref(count)))
leaves = (ctypes.c_uint32 * count.value)()
must(lib.morula_model_level_set(model, size(level), leaves, count, ctypes.byref(count)))

bare = 0
weights = [(1, 0, 0), (0.5, 0.5, 0), (0.2, 0.3, 0.5), (0, 0.1, 0.9)]
for facet in range(facets):
    a, b, c = (positions[3 * corners[3 * facet + k]:3 * corners[3 * facet + k] + 3] for k in range(3))
    for u, v, w in weights:
        p = [u * a[k] + v * b[k] + w * c[k] for k in range(3)]
        if not any(math.dist(p, spheres[4 * n:4 * n + 3]) <= spheres[4 * n + 3] * (1 + 1e-9) for n in leaves):
            bare += 1
if bare:
    sys.exit(f"{bare} points of the surface lie in no leaf's sphere")
positions[7] = math.nan
if lib.morula_body_update_double(body, positions, size(vertices), size(0)) != 3 or not lib.morula_message():
    sys.exit("a position that is not finite was taken")
lib.morula_mesh_destroy(mesh)
lib.morula_model_destroy(model)
must(lib.morula_body_spheres(body, spheres))
lib.morula_body_destroy(body)
print(f"morula {lib.morula_version().decode()}: {len(weights) * facets} points lie in {count.value} spheres")
