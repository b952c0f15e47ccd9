# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Pages fetch nothing from elsewhere. The theme's plugin `offline` brings in a script from a public server, so that its
search works in pages opened from a folder; our own takes its place."""
import re


def on_post_page(output, page, config):
    return re.sub(r'<script src="https?://[^"]*/iframe-worker/shim"></script>',
                  f'<script src="{"../" * page.url.count("/")}pictures/file_worker.js"></script>', output)


def on_post_template(output, template_name, config):
    # The page of a server for what is not there; nobody opens it from a folder.
    return re.sub(r'<script src="https?://[^"]*/iframe-worker/shim"></script>', "", output)
