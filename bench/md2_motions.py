#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Animated game bodies (MD2), kept tight by trees for known poses: beside a tree built anew for each frame, and approach 2.

    apt-get download assimp-testmodels && dpkg-deb -x assimp-testmodels_*.deb models
    python bench/md2_motions.py models/usr/share/assimp/models/MD2/*.md2

Needs the Python package. Every frame is certified. Figures are of the leaves: looseness, the volume of their union over the
body's, less 1, of an open body as its winding number tells inside from outside.
"""

import argparse
import math
import statistics
import struct
import time

import numpy

import morula

HEADER = struct.Struct("<17i")


def read_md2(path):
    """The facets, (n, 3), and the vertices of all frames, (frames, vertices, 3), of a Quake 2 model."""
    with open(path, "rb") as file:
        data = file.read()
    header = HEADER.unpack_from(data)
    if header[:2] != (0x32504449, 8):
        raise SystemExit(f"{path} is no MD2 file of version 8")
    frame_bytes, vertices, triangles, frames, first_triangle, first_frame = (header[i] for i in (4, 6, 8, 10, 13, 14))
    facets = numpy.frombuffer(data, "<u2", 6 * triangles, first_triangle).reshape(-1, 6)[:, 2::-1]
    positions = []
    for begin in range(first_frame, first_frame + frames * frame_bytes, frame_bytes):
        scale, shift = numpy.frombuffer(data, "<f4", 6, begin).reshape(2, 3).astype(float)
        steps = numpy.frombuffer(data, "u1", 4 * vertices, begin + 40).reshape(-1, 4)[:, :3]
        positions.append(steps * scale + shift)
    return facets.astype(numpy.uint32), numpy.array(positions)


def leaves(spheres, tree):
    return numpy.asarray(spheres)[numpy.asarray(tree.child_count) == 0]


def study(path, args):
    facets, frames = read_md2(path)
    mesh = morula.Mesh(frames[0], facets)
    home = morula.build(mesh, quality="fast", depth=args.depth)
    poses = [(str(i), frame) for i, frame in enumerate(frames) if i > 0]
    begin = time.process_time()
    model, _ = morula.with_known_poses(mesh, home, poses, quality="fast", pose_threshold=args.pose_threshold, max_trees=args.max_trees)
    making = time.process_time() - begin
    # Keys are few and far between: ten frames from each to the next.
    motion = [a + (b - a) * (i / args.between) for a, b in zip(frames, frames[1:]) for i in range(args.between)]
    body = morula.RebuiltBody(mesh, model, thread="none")
    paper = morula.Body(mesh, home, rules=["approach2"])
    meter = morula.LoosenessMeter(mesh)

    def looseness(positions, spheres):
        return meter.measure_open(positions, spheres, resolution=args.resolution).looseness

    over_fresh, over_paper, uncovered = [], [], 0
    for i, positions in enumerate(motion):
        body.update(positions)
        tree = body.current_tree()
        assert morula.certify(body.cover, positions, tree.spheres).covered, i
        if i % args.every:
            continue
        mesh_now = morula.Mesh(positions, facets)
        fresh = morula.build(mesh_now, quality="fast", depth=args.depth).tree
        ours = looseness(positions, leaves(tree.spheres, tree))
        over_fresh.append(ours / looseness(positions, leaves(fresh.spheres, fresh)))
        paper.update(positions)
        of_paper = paper.current_tree()
        over_paper.append(ours / looseness(positions, leaves(of_paper.spheres, of_paper)))
        uncovered = max(uncovered, morula.coverage(mesh_now, leaves(of_paper.spheres, of_paper)).uncovered_area)
    # What others on the machine cost is not meant: frame by frame the least of some rounds.
    least = [math.inf] * len(motion)
    for _ in range(args.rounds):
        for i, positions in enumerate(motion):
            begin = time.thread_time_ns()
            body.update(positions)
            least[i] = min(least[i], time.thread_time_ns() - begin)
    usual = statistics.median(least)
    print(f"{path}: {len(facets)} facets, {len(frames)} keys, {len(motion)} frames, {leaves(home.tree.spheres, home.tree).shape[0]} leaves")
    print(f"  known poses {len(model.poses)}, made in {making:.1f} s; changes {body.report.pose_switches}")
    print(f"  over a fresh tree: median {statistics.median(over_fresh):.2f}, worst {max(over_fresh):.2f}, of {len(over_fresh)} frames")
    print(f"  over approach 2: median {statistics.median(over_paper):.2f}, worst {max(over_paper):.2f}, which leaves up to {100 * uncovered:.1f} % uncovered")
    print(f"  a frame: {usual / 1000:.0f} us, the longest {max(least) / usual:.2f} times that; uncovered frames 0")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("files", nargs="+", help="MD2 files")
    parser.add_argument("--max-trees", type=int, default=24, help="known poses at most (default 24)")
    parser.add_argument("--pose-threshold", type=float, default=1.2, help="poses are added until none is served so much worse (default 1.2)")
    parser.add_argument("--depth", type=int, default=2, help="of the trees (default 2)")
    parser.add_argument("--between", type=int, default=6, help="frames from key to key (default 6)")
    parser.add_argument("--every", type=int, default=12, help="frames of which one is measured (default 12)")
    parser.add_argument("--resolution", type=int, default=128, help="voxels along the longest side (default 128)")
    parser.add_argument("--rounds", type=int, default=5, help="of timing (default 5)")
    args = parser.parse_args()
    for path in args.files:
        study(path, args)


if __name__ == "__main__":
    main()
