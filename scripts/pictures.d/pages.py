# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Photographs of the pages of `morula view` and `morula robot` and of the playground, taken by a browser, in few enough colors to be small."""
from __future__ import annotations

import functools
import pathlib
import subprocess
import tempfile

import bodies

ROOT = pathlib.Path(__file__).resolve().parents[2]
COLORS = 256


@functools.cache
def taken():
    """All three, in a folder."""
    command, viewer = ROOT / "build/release/bin/morula", ROOT / "build/release/viewer"
    if not command.exists() or not (viewer / "page.html").exists():
        raise SystemExit("pictures: build/release has no morula with its page: run scripts/test first")
    folder = pathlib.Path(tempfile.mkdtemp())

    def run(*words):
        subprocess.run([command, *words], cwd=folder, check=True, stdout=subprocess.DEVNULL)

    # The sample body at a fineness at which no facet is seen.
    run("sample", "limb", "-o", "limb.obj", "--resolution", "96")
    run("build", "limb.obj", "-o", "limb.morula", "--branching", "8", "--depth", "3")
    run("deform", "limb.obj", "-o", "bend", "--bend", "90", "--frames", "25")
    run("view", "limb.obj", "limb.morula", "bend", "-o", "limb.html", "--rule", "approach2", "--rule", "exact")
    run("robot", ROOT / "extras/robot/tests/robots/arm_description/urdf/arm.urdf", "-o", "arm", "--spheres", "12", "--page")
    subprocess.run(["node", ROOT / "viewer/pictures.mjs", viewer, folder / "limb.html", folder / "arm/robot.html", folder], check=True)
    return folder


@functools.cache
def taken_of_playground():
    """One, in a folder. Needs the npm package of scripts/web."""
    viewer, page = ROOT / "build/release/viewer", ROOT / "build/playground/index.html"
    subprocess.run([ROOT / "scripts/playground"], check=True, stdout=subprocess.DEVNULL)
    folder = pathlib.Path(tempfile.mkdtemp())
    subprocess.run(["node", ROOT / "playground/pictures.mjs", viewer, page, folder, "beside-desk"], check=True)
    (folder / "beside-desk.png").rename(folder / "playground.png")
    return folder


def photograph(name, place=taken):
    @bodies.picture(name)
    def take():
        from PIL import Image

        with Image.open(place() / name) as image:
            few = image.convert("RGB").quantize(COLORS, method=Image.Quantize.MEDIANCUT, kmeans=6, dither=Image.Dither.NONE)
            few.save(ROOT / "docs/pictures" / name, optimize=True)


for one in ("rules.png", "page.png", "robot_page.png"):
    photograph(one)
photograph("playground.png", taken_of_playground)
