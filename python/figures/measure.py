# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The figures of research/notes/python-measured.md, measured again: python python/figures/measure.py (with the package installed, nothing else running)."""

import statistics
import subprocess
import sys
import threading
import time

import numpy

import morula


def median_seconds(action, repeats=31):
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        action()
        times.append(time.perf_counter() - start)
    return statistics.median(times)


def import_milliseconds(module):
    script = f"import time; start = time.process_time(); import {module}; print(1000 * (time.process_time() - start))"
    return statistics.median(float(subprocess.check_output([sys.executable, "-c", script])) for _ in range(11))


def update_overhead():
    """What one call of update() costs beyond the same update in the loop of C++, microseconds."""
    mesh = morula.sample_body("limb", 48)
    for name, model in (("3 nodes", morula.build(mesh, spheres=2, method="octree")), ("default", morula.build(mesh, quality="fast"))):
        body = morula.Body(mesh, model)
        frames = morula.deform_frames(mesh, morula.Bend(90), frame_count=200).astype(numpy.float32)
        singles = list(frames)

        def one_by_one():
            for positions in singles:
                body.update(positions)

        differences = []
        for _ in range(21):
            in_python, in_cpp = median_seconds(one_by_one, 1), median_seconds(lambda: body.follow(frames), 1)
            differences.append((in_python - in_cpp) / len(frames) * 1e6)
        per_frame = median_seconds(lambda: body.follow(frames), 5) / len(frames) * 1e6
        print(f"update(), {name} ({len(model)} nodes): {statistics.median(differences):.2f} us over {per_frame:.1f} us a frame")


def thousand_frames():
    mesh = morula.sample_body("limb", 48)
    body = morula.Body(mesh, morula.build(mesh, quality="fast"))
    frames = morula.deform_frames(mesh, morula.Bend(90), frame_count=1000)
    seconds = median_seconds(lambda: body.follow(frames), 5)
    print(f"follow(), 1,000 frames of {mesh.vertex_count} vertices, {len(body)} nodes: {1000 * seconds:.0f} ms")


def at_once(actions):
    threads = [threading.Thread(target=action) for action in actions]
    start = time.perf_counter()
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    return time.perf_counter() - start


def seconds_of(action):
    return median_seconds(action, 1)


def two_threads():
    """Two bodies, one after the other and at once: by update() in a loop of Python, and by follow(), whose loop is C++'s own and
    never asks for the interpreter's lock: what the machine gives at best."""
    for resolution in (24, 48, 96, 192):
        mesh = morula.sample_body("limb", resolution)
        model = morula.build(mesh, quality="fast" if resolution < 100 else "draft")
        frames = morula.deform_frames(mesh, morula.Bend(90), frame_count=25).astype(numpy.float32)
        bodies = [morula.Body(mesh, model) for _ in range(2)]
        motions = [numpy.array(frames) for _ in bodies]
        per_frame = median_seconds(lambda: bodies[0].follow(motions[0]), 5) / len(frames)
        rounds = max(1, int(0.4 / (per_frame * len(frames))))

        def updates(i):
            singles = list(motions[i])
            for _ in range(rounds):
                for positions in singles:
                    bodies[i].update(positions)

        def follows(i):
            for _ in range(rounds):
                bodies[i].follow(motions[i])

        found = []
        for work in (updates, follows):
            both = [lambda i=i, work=work: work(i) for i in range(2)]
            ratios = [(seconds_of(both[0]) + seconds_of(both[1])) / at_once(both) for _ in range(9)]
            found.append(f"{statistics.median(ratios):.2f} (best {max(ratios):.2f})")
        print(
            f"two threads, bodies of {mesh.vertex_count} vertices and {len(model)} nodes, {1e6 * per_frame:.0f} us a frame: "
            f"update() {found[0]} times as fast, loop of C++ {found[1]}"
        )


print(f"import morula: {import_milliseconds('morula'):.1f} ms of the processor; import numpy: {import_milliseconds('numpy'):.1f} ms")
update_overhead()
thousand_frames()
two_threads()
