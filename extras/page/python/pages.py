# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pages that show bodies and their spheres in motion, for browsers and notebooks."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from . import _morula

if TYPE_CHECKING:
    from .typing import FloatArray, MeshLike, Rule


class Page:
    """One self-contained HTML page; a notebook shows it in place."""

    def __init__(self, text: str) -> None:
        self.html = text

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the page, which any browser opens offline. The write is atomic."""
        _morula._write_whole(path, self.html)  # type: ignore[attr-defined]  # stubs leave out private names

    def _repr_html_(self) -> str:
        import html

        return (
            f'<iframe srcdoc="{html.escape(self.html)}" style="width:100%;height:600px;border:0" sandbox="allow-scripts"></iframe>'
        )


def page(
    mesh: MeshLike,
    model: _morula.CoveredTree,
    frames: FloatArray | None = None,
    *,
    rules: Sequence[Rule] = ("exact",),
    title: str = "Morula",
    measured: bool = False,
) -> Page:
    """The page of a body, its tree and, if frames (frames, vertices, 3) are given, its motion.

    RuntimeError, with the remedy, if the package was built without the page.
    """
    if not _morula.has_page():
        raise RuntimeError(f"no page: {_morula.why_no_page()}")
    return Page(_morula.page_html(mesh, model, frames, rules=list(rules), title=title, measured=measured))


def page_of_scenes(scenes: Sequence[_morula.PageScene], *, title: str = "Morula", study: str = "") -> Page:
    """The page of several bodies, motions, trees or rules; the reader selects one.

    scenes: from `follow_motion()` or `show_spheres()`, or `PageScene` objects made from spheres. study: the text of a study.json.
    RuntimeError, with the remedy, if the package was built without the page.
    """
    if not _morula.has_page():
        raise RuntimeError(f"no page: {_morula.why_no_page()}")
    return Page(_morula.make_page(scenes, title=title, study=study))
