#!/usr/bin/env python3
# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The site's reference has every public name of every public header once, with its whole declaration. libclang lists them.
usage: cpp_reference_test.py ROOT COMPILER        exit code 77 where there is no libclang: scripts/site brings it"""
import collections
import pathlib
import re
import subprocess
import sys

root, compiler = pathlib.Path(sys.argv[1]).resolve(), sys.argv[2]
sys.path[:0] = [str(root / "docs/site"), *map(str, (root / "build/site_tools").glob("lib/python*/site-packages"))]
try:
    from clang import cindex
    from clang.cindex import CursorKind as Kind
    index = cindex.Index.create()
except Exception as error:  # the package, or the library below it, is missing
    print(f"reference: skipped: {error}", file=sys.stderr)
    sys.exit(77)
import cpp_reference  # noqa: E402, found by the path above

version = re.search(r"VERSION (\d+\.\d+\.\d+)", (root / "CMakeLists.txt").read_text())[1]
TYPES = {Kind.CLASS_DECL, Kind.STRUCT_DECL, Kind.CLASS_TEMPLATE, Kind.ENUM_DECL}
FUNCTIONS = {Kind.FUNCTION_DECL, Kind.FUNCTION_TEMPLATE, Kind.CXX_METHOD, Kind.CONSTRUCTOR, Kind.DESTRUCTOR, Kind.CONVERSION_FUNCTION}
VALUES = {Kind.FIELD_DECL, Kind.VAR_DECL, Kind.ENUM_CONSTANT_DECL, Kind.TYPE_ALIAS_DECL, Kind.TYPEDEF_DECL, Kind.USING_DECLARATION}
SCOPES = {Kind.NAMESPACE, Kind.LINKAGE_SPEC, Kind.UNEXPOSED_DECL, Kind.FRIEND_DECL}


def packed(text):
    """Code without comments and space."""
    text = re.sub(r"//[^\n]*|/\*.*?\*/", "", text, flags=re.S)
    return re.sub(r"\s+", "", text).replace("MORULA_API", "").replace("@PROJECT_VERSION@", version)


def name_of(cursor):
    name = re.sub(r"\bmorula::(\w+::)*", "", cursor.spelling)
    name = name if "operator" in name else re.sub(r"<.*", "", name)
    return re.sub(r" (?=[&*])", "", name).replace(" ", "-").lower()


def declaration(cursor, source):
    """The text of a declaration up to its body, or to the sign that ends it."""
    begin, end = cursor.extent.start.offset, cursor.extent.end.offset
    if cursor.kind in TYPES:
        return source[begin:source.index("{", begin)]
    if cursor.kind in VALUES:
        return source[begin:end]
    bodies = [child.extent.start.offset for child in cursor.get_children() if child.kind == Kind.COMPOUND_STMT]
    text = source[begin:bodies[0] if bodies else source.index(";", end)]
    return re.split(r"(?<=\))\s*:\s", text)[0] if cursor.kind in (Kind.CONSTRUCTOR, Kind.FUNCTION_TEMPLATE) else text


class Oracle:
    """What libclang finds: (header, anchor, declaration) of every public name."""

    def __init__(self, paths):
        self.found, self.sources = [], {str(path): (name, path.read_bytes()) for name, path in paths.items()}

    def parse(self, paths, arguments):
        text = "".join(f'#include "{path}"\n' for path in paths)
        file = "all.c" if "c" in arguments else "all.cpp"
        unit = index.parse(file, ["-x", *arguments], [(file, text)], cindex.TranslationUnit.PARSE_DETAILED_PROCESSING_RECORD)
        errors = [str(fault) for fault in unit.diagnostics if fault.severity >= cindex.Diagnostic.Error]
        if errors:
            sys.exit("reference: libclang does not read the headers:\n" + "\n".join(errors[:5]))
        for cursor in unit.cursor.get_children():
            if cursor.location.file and str(cursor.location.file.name) in self.sources:
                self.visit(cursor, [])

    def visit(self, cursor, scope):
        header, source = self.sources[str(cursor.location.file.name)]
        is_hidden = cursor.access_specifier in (cindex.AccessSpecifier.PRIVATE, cindex.AccessSpecifier.PROTECTED)
        if is_hidden or cursor.spelling == "detail" or cursor.kind == Kind.FRIEND_DECL and not any(c.is_definition() for c in cursor.get_children()):
            return
        if cursor.kind in SCOPES:
            for child in cursor.get_children():
                self.visit(child, scope + [cursor.spelling] * (cursor.kind == Kind.NAMESPACE))
            return
        is_constant = cursor.kind == Kind.MACRO_DEFINITION and cursor.spelling.startswith("MORULA_NO_")
        # An alias of a C struct of the same name declares nothing new if the struct is defined.
        is_second_name = cursor.kind == Kind.TYPEDEF_DECL and any(c.kind in TYPES and c.spelling == cursor.spelling and c.is_definition()
                                                                  for c in cursor.get_children())
        is_new = cursor.kind in TYPES and cursor.is_definition() or cursor.kind in FUNCTIONS and cursor == cursor.canonical \
            or cursor.kind in VALUES and not is_second_name or is_constant
        if not is_new:
            return
        text = "" if is_constant else declaration(cursor, source.decode("latin-1")).encode("latin-1").decode()
        self.found.append((header, "-".join([*scope, name_of(cursor)]), packed(text)))
        if cursor.kind in TYPES:
            for child in cursor.get_children():
                self.visit(child, [*scope, name_of(cursor)])


def sections(pages):
    """The text of each header on the pages."""
    found = {}
    for text in pages.values():
        for part in re.split(r"(?m)^(?=## )", text):
            header = re.search(r"(?m)^#include <(.*)>$", part)
            if header:
                found[header[1]] = part
    return found


def faults(pages, oracle):
    found, messages = sections(pages), []
    for header in sorted(oracle.sources.values()):
        header, part = header[0], found.get(header[0], "")
        on_page = re.findall(r'\{#(?!header-)([^ }]*)(?: \.name)?\}|<a id="([^"]*)">', part)
        names = collections.Counter(re.sub(r"-\d+$", "", first or second) for first, second in on_page)
        expected = collections.Counter(name for where, name, _ in oracle.found if where == header)
        messages += [f"{header}: {name}: {names[name]} times on the page, {expected[name]} in the header"
                     for name in sorted(set(names) | set(expected)) if names[name] != expected[name]]
        code = packed(part)
        messages += [f"{header}: {name}: cut: {text}" for where, name, text in oracle.found if where == header and text not in code]
    return messages


def standard_includes():
    """The folders of the compiler's own headers; libclang from a registry comes without any."""
    result = subprocess.run([compiler, "-xc++", "-E", "-v", "-"], input="", capture_output=True, text=True, check=True)
    return re.findall(r"(?m)^ (/\S+)$", result.stderr.partition("search starts here")[2])


paths = {path.as_posix().rpartition("include/")[2]: path
         for path in [*root.glob("include/morula/**/*.hpp"), *root.glob("extras/*/include/**/*.hpp")] if path.name != "morula.hpp"}
paths["morula/version.hpp"] = root / "src/version.hpp.in"
folders = [f"-I{folder}" for folder in [root / "include", *root.glob("extras/*/include")]]
system = [argument for folder in standard_includes() for argument in ("-isystem", folder)]
c_header = root / "include/morula/morula.h"
oracle = Oracle(paths | {"morula/morula.h": c_header})
oracle.parse(paths.values(), ["c++", "-std=c++20", "-nostdinc", "-nostdinc++", *system, *folders])
oracle.parse([c_header], ["c", "-nostdinc", *system])

pages = cpp_reference.Reference(root, {}).texts
messages = faults(pages, oracle)
if messages or len(oracle.found) < 1000:
    sys.exit("\n".join(messages[:40]) + f"\nreference: {len(messages)} faults, {len(oracle.found)} names")

# The comparison finds a name that is missing, one that is there twice, and a declaration that is cut.
update = pages["cpp_update.md"]
planted = {
    "missing": update.replace("#morula-body-update_lazily", ""),
    "twice": update.replace("{#morula-body-frame ", '<a id="morula-body-frame-2"></a>{#morula-body-frame '),
    "cut": update.replace("std::span<const VertexRange> changed,\n", ""),
}
for fault, text in planted.items():
    if text == update or len(faults(pages | {"cpp_update.md": text}, oracle)) != 1:
        sys.exit(f"reference: a planted fault is not found: {fault}")
print(f"reference: {len(oracle.found)} names of {len(oracle.sources)} headers")
