# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Docstrings from the comments of the public headers, so that C++ and Python share one text.

usage: docstrings.py OUTPUT HEADER...

Every `///` comment becomes a constant in namespace morula::python::doc: Body_update for Body::update, Body_update_2 for
the next overload, BuildOptions_depth for a member. A binding that names a missing comment does not compile.
"""

import pathlib
import re
import sys

# What is said in C++ and means something else here.
WORDS = {
    "std::invalid_argument": "ValueError",
    "std::bad_alloc": "MemoryError",
    "std::logic_error": "RuntimeError",
    "std::runtime_error": "RuntimeError",
    "FileError": "OSError",
    "nullptr": "None",
    "`true`": "True",
    "`false`": "False",
}
SCOPE = re.compile(r"^\s*(?:template <[^>]*>\s*)?(struct|class|enum class)\s+(?:\[\[nodiscard\]\]\s+)?(\w+)[^;(]*\{")


def declared_name(code: str) -> str:
    """The name that a declaration introduces; empty if there is none."""
    code = re.sub(r"template\s*<[^>]*>|requires\(.*?\)\)?|\[\[.*?\]\]", "", code).strip()
    scope = re.match(r"(?:struct|class|enum class)\s+(\w+)", code)
    if scope:
        return scope.group(1)
    if re.search(r"operator\s*\(\)", code):
        return "call"
    if "operator" in code or code.startswith(("using", "friend", "#", "}", "//")):
        return ""
    if code.startswith("enum"):
        return ""
    code = re.sub(r"std::function<[^;]*>", "Function", code)
    head = re.split(r"[;={]", code)[0]
    if "~" in head:
        return ""
    call = re.search(r"(\w+)\s*\(", head)
    if call:
        return call.group(1)
    names = re.findall(r"[A-Za-z_]\w*", head.split(",")[0] if "<" not in head else head)
    return names[-1] if names else ""


def comments_of(text: str):
    """Yields (name, text) of every declaration with a comment."""
    scopes: list[tuple[str, int]] = []
    depth, before, trailing = 0, [], None
    for line in text.splitlines():
        code, _, comment = line.partition("///")
        bare = code.strip()
        if not bare and line.strip().startswith("///<"):
            if trailing is not None:
                trailing[1].append(comment.lstrip("<").strip())
            continue
        if trailing is not None:
            yield trailing[0], trailing[1]
            trailing = None
        if not bare:
            if line.strip().startswith("///"):
                before.append(comment.strip())
            elif not line.strip():
                before = []
            continue
        if re.fullmatch(r"template\s*<.*>", bare):
            continue  # the declaration is on the next line
        name = declared_name(code) if not bare.startswith("//") else ""
        qualified = "_".join([scope for scope, _ in scopes] + [name])
        if name and before:
            yield qualified, before
        elif name and comment.startswith("<"):
            trailing = (qualified, [comment.lstrip("<").strip()])
        if not bare.startswith("//"):
            before = []
            opened = SCOPE.match(code)
            depth += code.count("{") - code.count("}")
            if opened and code.count("{") > code.count("}"):
                scopes.append((opened.group(2), depth))
            while scopes and depth < scopes[-1][1]:
                scopes.pop()
    if trailing is not None:
        yield trailing


def paragraphs(lines: list[str]) -> str:
    text = "\n\n".join(" ".join(part.split("\n")) for part in "\n".join(lines).split("\n\n"))
    for word, here in WORDS.items():
        text = text.replace(word, here)
    # Options are keyword arguments.
    text = re.sub(r"`?\b[A-Z]\w*Options::(\w+)`?", r"`\1`", text)
    text = re.sub(r"\b([A-Z]\w*)::(?=\w)", r"\1.", text)
    return text[:1].upper() + text[1:]


def main() -> None:
    output, headers = pathlib.Path(sys.argv[1]), [pathlib.Path(header) for header in sys.argv[2:]]
    seen: dict[str, int] = {}
    lines = ["// Made by python/docstrings.py.", "#pragma once", "namespace morula::python::doc {"]
    # In the order of <morula/…>, wherever the header stands.
    for header in sorted(headers, key=lambda header: header.parts[header.parts.index("include"):]):
        if header.parent.name == "study":
            continue
        for name, comment in comments_of(header.read_text(encoding="utf-8")):
            seen[name] = seen.get(name, 0) + 1
            if seen[name] > 1:
                name += f"_{seen[name]}"
            lines.append(f'inline constexpr const char* {name} = R"doc({paragraphs(comment)})doc";')
    lines += ["}  // namespace morula::python::doc", ""]
    text = "\n".join(lines)
    # An unchanged file keeps its time, so that nothing is compiled again.
    if not output.exists() or output.read_text(encoding="utf-8") != text:
        output.write_text(text, encoding="utf-8")


main()
