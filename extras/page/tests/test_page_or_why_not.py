# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A package whose page could not be bundled says so."""

import pytest

import morula


def test_the_page_is_there_or_says_why(limb, model, motion):
    if morula.has_page():
        page = morula.page(limb, model, motion)
        assert page.html.startswith("<!") and "srcdoc" in page._repr_html_()
    else:
        with pytest.raises(RuntimeError, match="MORULA_"):
            morula.page(limb, model, motion)
