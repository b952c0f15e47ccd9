# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Morula: tight sphere trees over triangle meshes, certified to cover while the meshes deform.

>>> import morula
>>> mesh = morula.sample_body("limb", 24)
>>> built = morula.build(mesh, method="grid", depth=2)
>>> body = morula.Body(mesh, built)
>>> status = body.update(morula.deform(mesh, morula.Bend(90)))
>>> bool(body.certify(morula.deform(mesh, morula.Bend(90))))
True

Names are those of the C++ library; results are NumPy arrays. The modules `morula.plot`, `morula.ipctk`,
`morula.usd`, `morula.batch` and `morula.robot` are imported on first use; the first three need packages of their own.
"""

from __future__ import annotations

import importlib
from typing import Any

from . import _morula
from ._morula import *  # noqa: F403
from ._morula import version as __version__

# Extras that this package was built with. Named twice, for type checkers: these names are the package's.
_missing: dict[str, str] = {}
try:
    from .pages import Page as Page
    from .pages import page as page
    from .pages import page_of_scenes as page_of_scenes
except ModuleNotFoundError:
    _missing |= dict.fromkeys(("Page", "page", "page_of_scenes"), "page")
try:
    from .studies import Study as Study
    from .studies import study as study
except ModuleNotFoundError:
    _missing |= dict.fromkeys(("Study", "study"), "study")

# Modules of the extension that modules of the package stand before.
for _name in ("robot", "batch_engine"):
    globals().pop(_name, None)

__all__ = [name for name in dir(_morula) if not name.startswith("_") and name not in ("robot", "batch_engine")] + ["__version__"]
__all__ += [name for name in ("Page", "Study", "page", "page_of_scenes", "study") if name not in _missing]

_MODULES = ("batch", "ipctk", "plot", "robot", "typing", "usd")


def __getattr__(name: str) -> Any:
    if name in _MODULES:
        if name == "robot" and not hasattr(_morula, "robot"):
            raise AttributeError("morula.robot: this package was built without the extra `robot`, which needs tinyxml2 (docs/reference/python.md)")
        return importlib.import_module(f"{__name__}.{name}")
    if name in _missing:
        raise AttributeError(f"morula.{name}: this package was built without the extra `{_missing[name]}`")
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")


def __dir__() -> list[str]:
    return sorted([*__all__, *_MODULES])
