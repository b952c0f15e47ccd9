# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The pages with every public name of the C++ library and the C interface, made of the headers: one page per folder.

Every name has an anchor: morula-body-update for morula::Body::update, morula-body-update-2 for the next overload.
"""

import dataclasses
import pathlib
import re
import textwrap

import headers

#: Folders in the order of the pages, from what others need to what needs others; then the extras.
FOLDERS = ["geometry", "parallel", "tree", "generators", "update", "collide", "surface", "scene", "query", "medial", "accuracy", "deform",
           "io", "robot", "grains", "study", "page"]
OVERVIEW, C_PAGE = "cpp_reference.md", "c_reference.md"
INTRODUCTION = """\
`#include <morula/morula.hpp>` has all headers of the library; a single header works as well. Robots, grains, the study and
the page are extras with targets of their own. All names are in namespace `morula`; those of robots are in `morula::robot`,
those of the study in `morula::study`. [Conventions](conventions.md) hold for all of them. The pages are made of the comments
of the headers."""


@dataclasses.dataclass
class Page:
    title: str
    headers: dict[str, tuple[list[str], list[headers.Item]]]  #: by path in #include: opening comment and items


def pages_of(root: pathlib.Path) -> dict[str, Page]:
    """Pages by file name, with what their headers have."""
    pages = {f"cpp_{folder}.md": Page(f"C++: {folder}", {}) for folder in FOLDERS}
    found = sorted([*root.glob("include/morula/*/*.hpp"), *root.glob("extras/*/include/morula/*/*.hpp")], key=lambda path: path.name)
    for path in found:
        name = path.as_posix().rpartition("include/")[2]
        folder = path.parent.name
        pages.setdefault(f"cpp_{folder}.md", Page(f"C++: {folder}", {})).headers[name] = headers.read(path.read_text(encoding="utf-8"))
    version = re.search(r"VERSION (\d+\.\d+\.\d+)", (root / "CMakeLists.txt").read_text(encoding="utf-8"))[1]
    text = (root / "src/version.hpp.in").read_text(encoding="utf-8").replace("@PROJECT_VERSION@", version)
    pages[OVERVIEW] = Page("Reference of the C++ library", {"morula/version.hpp": headers.read(text)})
    c = root / "include/morula/morula.h"
    pages[C_PAGE] = Page("Reference of the C interface", {"morula/morula.h": headers.read(c.read_text(encoding="utf-8"), is_c=True)})
    return {name: page for name, page in pages.items() if page.headers}


def sentence(opening: list[str]) -> str:
    """The first sentence of a comment."""
    text = " ".join(opening).strip()
    return re.split(r"(?<=[.:]) (?=[A-Z ])|(?<=\.)$", text, maxsplit=1)[0].rstrip(":")


def escaped(text: str) -> str:
    return re.sub(r"([\\*_{}\[\]<>#|~])", r"\\\1", text)


class Writer:
    """Writes the pages. site_pages: links to other pages, by the paths that comments mention."""

    def __init__(self, pages: dict[str, Page], site_pages: dict[str, str]):
        self.pages, self.site_pages = pages, site_pages
        self.anchors: dict[int, list[str]] = {}  #: of each item, one per name
        self.targets: dict[str, str] = {}  #: of each name that a comment may mention: page and anchor
        self.taken: set[str] = set()
        for file, page in pages.items():
            for header, (_, items) in page.headers.items():
                self.targets[header.removeprefix("morula/")] = f"{file}#{self.header_anchor(header)}"
                for item in items:
                    self.find_anchors(file, item, "")

    @staticmethod
    def header_anchor(header: str) -> str:
        return "header-" + re.sub(r"\W", "-", header.removeprefix("morula/"))

    @staticmethod
    def spaces_of(item: headers.Item) -> str:
        """The prefix of a name of a namespace: that below `morula`."""
        return item.scope.removeprefix("morula").removeprefix("::") + "::" * item.scope.startswith("morula::")

    def find_anchors(self, file: str, item: headers.Item, owner: str) -> None:
        self.anchors[id(item)] = []
        for name in item.names:
            stem = slug = f"{item.scope}::{owner}{name}".removeprefix("::").replace("::", "-").replace(" ", "-").lower()
            number = 1
            while slug in self.taken:
                number += 1
                slug = f"{stem}-{number}"
            self.taken.add(slug)
            self.anchors[id(item)].append(slug)
            for prefix in ("", self.spaces_of(item)):
                self.targets.setdefault(prefix + owner + name, f"{file}#{slug}")
        for member in item.members:
            member.scope = item.scope
            self.find_anchors(file, member, f"{owner}{item.names[0]}::")

    def linked(self, word: str, owner: str, file: str) -> str:
        """A mention of a name as a link; empty for a word that may mean something else."""
        name = word.removesuffix("()").removeprefix("morula::")
        is_name = word.endswith("()") or re.search(r"::|[a-z][A-Z]|\.hpp$", name)
        target = is_name and (self.targets.get(owner + name) or self.targets.get(name))
        if not target or f"{name}::" == owner:
            return self.site_pages.get(word, "")
        return f"[`{word}`]({target.removeprefix(file) if target.startswith(file + '#') else target})"

    def prose(self, text: str, owner: str, file: str) -> str:
        """A paragraph as markdown: signs escaped outside of `code`, the first mention of a name as a link."""
        seen = set()
        mention = re.compile(r"`([^`]+)`|(?<![\w/:.])((?:[\w-]+/)*\w+\.(?:md|hpp)|~?\w+(?:::~?\w+)*(?:\(\))?)(?!\w)|.", re.S)

        def written(match: re.Match) -> str:
            word = match[1] or match[2] or ""
            link = word not in seen and self.linked(word, owner, file)
            seen.add(word if link else "")
            return link or (match[0] if match[1] else escaped(match[0]))

        return re.sub(r"^(\d+)(\.)(?= )|^([-+:])(?= )", r"\1\\\2\3", mention.sub(written, text))

    def described(self, comment: list[str], owner: str, file: str) -> list[str]:
        """A comment as blocks: paragraphs, and code or columns that are set in from them."""
        blocks, current = [], []
        for line in [*comment, ""]:
            if current and (not line.strip() or line.startswith("  ") != current[0].startswith("  ")):
                if current[0].startswith("  "):
                    text = textwrap.dedent("\n".join(current))
                    blocks.append(f"```{'cpp' if ';' in text else 'text'}\n{text}\n```")
                else:
                    text = " ".join(part.strip() for part in current)
                    blocks += [self.prose(part, owner, file) for part in re.split(r"(?<=[.)]) (?=Throws |Cost: )", text)]
                current = []
            current += [line] if line.strip() else []
        return blocks

    def anchored(self, anchors: list[str]) -> str:
        return "".join(f'<a id="{anchor}"></a>' for anchor in anchors)

    def value(self, item: headers.Item, owner: str, file: str) -> str:
        """A field or an enumerator as an entry of a list."""
        first, *others = self.anchors[id(item)]
        code = " ".join(item.code.split()).rstrip(",;")
        text = f"- {self.anchored(others)}`{code}`{{#{first}}}"
        paragraphs = self.described(item.comment, owner, file)
        return text + ("  \n    " + "\n\n    ".join(paragraphs) if paragraphs else "")

    def declarations(self, items: list[headers.Item], level: int, owner: str, file: str) -> list[str]:
        """Functions, constants and aliases of one heading. A comment follows its declaration and the overloads below it."""
        names = list(dict.fromkeys(name for item in items for name in item.names))
        titles = [name for name in names if name[0] != "~" and name != "operator="] or names
        first, *others = [anchor for item in items for anchor in self.anchors[id(item)]]
        title = escaped(owner + ", ".join(titles)) + self.anchored(others)
        blocks, together = [f"{'#' * level} {title} {{#{first} .name}}"], []
        for i, item in enumerate(items):
            together.append(item)
            following = items[i + 1] if i + 1 < len(items) else None
            if not following or not following.joined or any(part.comment for part in together) and following.names != item.names:
                blocks.append("```cpp\n" + "\n".join(part.code for part in together) + "\n```")
                blocks += [block for part in together for block in self.described(part.comment, owner, file)]
                together = []
        return blocks

    def type_blocks(self, item: headers.Item, level: int, owner: str, file: str) -> list[str]:
        """A class, struct or enum: fields first, then functions in the groups of the header, then the types within it."""
        anchor, inner = self.anchors[id(item)][0], f"{owner}{item.names[0]}::"
        blocks = [f"{'#' * level} {escaped(owner + item.names[0])} {{#{anchor} .name}}", f"```cpp\n{item.code}\n```"]
        blocks += self.described(item.comment, inner, file)
        fields = [part for part in item.members if part.kind == "value" and not part.code.startswith("using ")]
        types = [part for part in item.members if part.kind == "type"]
        others = [part for part in item.members if part not in fields and part not in types and part.kind != "note"]
        entries: list[str] = []
        for part in item.members:
            if part.kind == "note":
                blocks += ["\n".join(entries)] * bool(entries) + [self.prose(part.code, inner, file)]
                entries = []
            elif part in fields:
                entries.append(self.value(part, inner, file))
        blocks += ["\n".join(entries)] * bool(entries)
        blocks += self.listing(others, level + 1, inner, file)
        for part in types:
            blocks += self.type_blocks(part, level + 1, inner, file)
        return blocks

    def listing(self, items: list[headers.Item], level: int, owner: str, file: str) -> list[str]:
        """Items of a scope in their order; below the titles of groups if there are any."""
        below = level + any(item.kind == "group" for item in items)
        blocks, run = [], []
        for item, following in zip(items, [*items[1:], None]):
            if item.kind == "group":
                blocks.append(f"{'#' * level} {escaped(item.code)}")
            elif item.kind == "note":
                blocks.append(self.prose(item.code, owner, file))
            elif item.kind == "type":
                blocks += self.type_blocks(item, below, owner or self.spaces_of(item), file)
            else:
                run.append(item)
                continues = following and following.kind in ("function", "value") and following.scope == item.scope
                if not continues or not (following.joined or following.names == run[0].names):
                    blocks += self.declarations(run, below, owner or self.spaces_of(item), file)
                    run = []
        return blocks

    def page(self, file: str) -> str:
        page = self.pages[file]
        blocks = [f"# {page.title}", *(self.overview() if file == OVERVIEW else [])]
        for header, (opening, items) in page.headers.items():
            name = header.rpartition("/")[2]
            blocks += [f"## {name} {{#{self.header_anchor(header)}}}", f"```cpp\n#include <{header}>\n```"]
            blocks += self.described(opening, "", file) + self.listing(items, 3, "", file)
        return "\n\n".join(blocks) + "\n"

    def overview(self) -> list[str]:
        """All headers, each with the first sentence of its comment."""
        blocks = [INTRODUCTION]
        for file, page in self.pages.items():
            if file not in (OVERVIEW, C_PAGE):
                rows = [f"| [{header.rpartition('/')[2]}]({file}#{self.header_anchor(header)}) | {self.prose(sentence(opening), '', '')} |"
                        for header, (opening, _) in page.headers.items()]
                blocks += [f"## [{page.title.removeprefix('C++: ')}]({file})", "\n".join(["| header | contents |", "| --- | --- |", *rows])]
        return blocks


class Reference:
    """All pages: `texts` by file name. site_pages: links to other pages, by the paths that comments mention."""

    def __init__(self, root: pathlib.Path, site_pages: dict[str, str]):
        writer = Writer(pages_of(root), site_pages)
        self.texts = {file: writer.page(file) for file in writer.pages}
        self.targets = writer.targets

    def target(self, name: str) -> str | None:
        """Page and anchor of a name with `::`; empty for names of others, none for one that a type of ours does not have."""
        name = name.removeprefix("morula::")
        owner = name.rpartition("::")[0]
        return self.targets.get(name) or (None if owner in self.targets else "")
