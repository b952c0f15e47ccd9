# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""Reads a public header: its opening comment, and its public declarations with their comments, in order.

The reader relies on the form that clang-format and the rules of the house give all headers: `///` ahead of a declaration
or `///<` after it, and no macros that declare. tests/house/cpp_reference_test.py compares the result with libclang.
"""

import dataclasses
import re

CLOSED_BY = {"(": ")", "{": "}", "[": "]", "<": ">"}
TYPE = re.compile(r"(?:template <.*?>\s+)?(?:typedef )?(class|struct|enum(?: class)?)\b(?: \[\[nodiscard\]\])? (\w+)[^;({=]*\{", re.S)


@dataclasses.dataclass
class Item:
    kind: str  #: "type" with members, "function", "value" (field, constant, alias); "note" or "group" between them
    names: list[str]
    code: str  #: the declaration, without the body of a function and the members of a type
    comment: list[str] = dataclasses.field(default_factory=list)
    members: list["Item"] = dataclasses.field(default_factory=list)
    scope: str = ""  #: its namespaces, such as "morula::robot"
    joined: bool = False  #: follows the item above it without a blank line and without a comment of its own


def blanked(text: str) -> str:
    """The text, of the same length, with spaces for comments, strings and preprocessor lines."""
    tokens = re.compile(r'//[^\n]*|"(?:\\.|[^"\\\n])*"|\'(?:\\.|[^\'\\\n])\'|^[ \t]*#(?:\\\n|[^\n])*', re.M)
    return tokens.sub(lambda m: re.sub(r"[^\n]", " ", m[0]), text)


def first_branches(text: str) -> str:
    """The text, of the same length, with spaces for what #else and #elif have instead of a first branch. No nesting."""
    return re.sub(r"^#(?:else|elif)\b.*?(?=^#endif)", lambda m: re.sub(r"[^\n]", " ", m[0]), text, flags=re.M | re.S)


def skeleton(code: str) -> str:
    """The code without initializers and without the contents of brackets; parentheses stay, empty."""
    kept, open_brackets, in_initializer = "", [], False
    for place, sign in enumerate(code):
        before = code[place - 1:place]
        if sign in "({[" or (sign == "<" and re.match(r"\w", before)):
            kept += "(" if sign == "(" and not open_brackets and not in_initializer else ""
            open_brackets.append(sign)
        elif open_brackets and sign == CLOSED_BY[open_brackets[-1]] and before != "-":
            open_brackets.pop()
            kept += ")" if sign == ")" and not open_brackets and not in_initializer else ""
        elif not open_brackets:
            in_initializer = (in_initializer or sign == "=") and sign != ","
            kept += "" if in_initializer else sign
    return kept


def declared(code: str) -> tuple[str, list[str]]:
    """Kind and names of a declaration without members; no name for what declares nothing new."""
    code = re.sub(r"\[\[.*?\]\]|\bMORULA_API\b", "", " ".join(code.split())).strip(" ;,").replace("template <", "template<")
    if re.match(r"(static_assert|friend (class|struct))\b|(class|struct|enum)( class)? \w+$", code):
        return "", []
    if alias := re.match(r"(?:template<.*> )?using (\w+) =|typedef .*?(\w+)$", code):
        return "value", [alias[1] or alias[2]]
    if operator := re.search(r"\boperator *(\(\)|[^(]+?) *\(", code):
        return "function", ["operator" + " " * operator[1][0].isalpha() + operator[1]]
    if pointer := re.search(r"\(\*(\w+)\)", code):
        return "value", [pointer[1]]
    plain = skeleton(code)
    if called := [found for found in re.findall(r"((?:\w+::)?~?\w+) *\(", plain) if found != "requires"]:
        return "function", [name for name in called[:1] if "::" not in name]
    return "value", [re.findall(r"\w+", part)[-1] for part in plain.split(",")]


class Reader:
    """Reads the scopes of one text."""

    def __init__(self, text: str):
        self.text = first_branches(text)
        self.bare = blanked(self.text)

    def closing(self, opening: int) -> int:
        """The place of the bracket that closes the one at `opening`."""
        depth = 0
        for place in range(opening, len(self.bare)):
            depth += (self.bare[place] in "({[") - (self.bare[place] in ")}]")
            if depth == 0:
                return place
        raise ValueError(f"nothing closes {self.text[opening:opening + 60]!r}")

    def end_of(self, place: int, scope_end: int, separator: str) -> tuple[int, int]:
        """The end of the declaration that begins here, and the end without the body of a function."""
        while place < scope_end:
            if self.bare[place] == separator:
                return place + 1, place + 1
            if self.bare[place] in "({[":
                opened, place = place, self.closing(place)
                # A body ends its declaration; an initializer is followed by a sign.
                if self.bare[opened] == "{" and self.bare[place + 1:scope_end].lstrip()[:1] not in (";", ",", "{", "="):
                    return place + 1, opened if separator == ";" else place + 1
            place += 1
        # The last enumerator, ahead of a comment of its own.
        scope_end -= len(self.bare[:scope_end]) - len(self.bare[:scope_end].rstrip())
        return scope_end, scope_end

    def item(self, begin: int, end: int, without_body: int) -> Item:
        found = TYPE.match(self.text, begin, end)
        if found:
            inner_end = self.closing(found.end() - 1)
            members = self.scope(found.end(), inner_end, hidden=found[1] == "class", separator="," if "enum" in found[1] else ";")
            for member in members:
                # Constructors that are taken over have the name of this class.
                if re.match(r"using .*\b(\w+)::\1;", member.code):
                    member.names = [found[2]]
            return Item("type", [found[2]], " ".join(found[0][:-1].split()), members=members)
        column = begin - self.text.rfind("\n", 0, begin) - 1
        code = self.text[begin:without_body].strip().replace("\n" + " " * column, "\n")
        if without_body < end:
            # A constructor's initializers are part of its body.
            code = re.split(r"(?<=\))\s*:\s", code)[0].rstrip() + ";"
        kind, names = declared(code)
        return Item(kind, [] if code.startswith("friend") and without_body == end else names, code)

    def scope(self, place: int, end: int, hidden: bool = False, separator: str = ";", spaces: str = "") -> list[Item]:
        """The public items from place to end. hidden: the scope begins private. spaces: the namespaces around it."""
        items, comment, joined = [], [], False
        while (gap := re.compile(r"\s*").match(self.text, place, end)).end() < end:
            place = gap.end()
            if gap[0].count("\n") > 1:
                comment, joined = [], False
            line = self.text[place:end].partition("\n")[0]
            if opened := re.match(r'(?:inline )?(?:namespace ([\w:]+)|extern "C") \{', line):
                inner_end = self.closing(place + opened.end() - 1)
                inner = "::".join(filter(None, [spaces, opened[1]]))
                items += self.scope(place + opened.end(), inner_end, spaces=inner) if opened[1] != "detail" else []
                place = inner_end + len(self.text[inner_end:].partition("\n")[0])
            elif access := re.match(r"(public|private|protected):$", line):
                hidden, place = access[1] != "public", place + len(line)
            elif line.startswith("///"):
                comment.append(line[3:].removeprefix(" "))
                place, joined = place + len(line), False
            elif line.startswith(("//", "#")):
                title = re.fullmatch(r"// ---- (.*?)\.? ----", line)
                block = re.match(r"(?:\\\n|.)*(?:\n[ \t]*//(?!/).*)*", self.text[place:end])[0]
                place, joined = place + len(block), False
                # A comment on a directive is for maintainers.
                if line.startswith("//") and not hidden and not self.text[place:end].lstrip().startswith("#"):
                    text = " ".join(part.strip().removeprefix("//").strip() for part in block.splitlines())
                    items.append(Item("group" if title else "note", [], title[1] if title else text))
            else:
                declaration_end, without_body = self.end_of(place, end, separator)
                item = self.item(place, declaration_end, without_body)
                after = re.compile(r"[ \t]*///<[^\n]*(?:\n[ \t]*///<[^\n]*)*").match(self.text, declaration_end)
                item.comment = comment + [part.partition("///<")[2].strip() for part in (after[0] if after else "").splitlines()]
                item.joined, item.scope = joined and not after, spaces
                # A template may be declared first and defined below.
                if item.names and not hidden and (item.comment or all(item.code != other.code for other in items)):
                    items.append(item)
                place, comment, joined = after.end() if after else declaration_end, [], True
        return items


def in_cpp_comments(text: str) -> str:
    """A C header with `///` comments and without the second names of its types."""
    def converted(found: re.Match) -> str:
        before = text[: found.start()].rpartition("\n")[2]
        lines = [re.sub(r"^ *\* ?", "", line) for line in found[1].strip().splitlines()]
        if before.strip():
            return ("\n" + " " * len(before)).join("///< " + line for line in lines)
        if title := re.fullmatch(r"---- (.*?)\.? ----", found[1].strip()):
            return f"// ---- {title[1]}. ----"
        return ("\n" + before).join("/// " + line for line in lines)
    text = re.sub(r"/\*(.*?)\*/", converted, text, flags=re.S)
    text = re.sub(r"(?m)^#define (MORULA_NO_\w+) (.*)$", r"constexpr auto \1 = \2;", text)
    return re.sub(r"(?m)^typedef (struct|enum)( \w+ \{$.*?^\}) \w+;", r"\1\2;", text, flags=re.S | re.M)


def read(text: str, is_c: bool = False) -> tuple[list[str], list[Item]]:
    """The lines of the opening comment, and the items."""
    if is_c:
        text = in_cpp_comments(text)
    opening, _, rest = text.partition("#ifndef MORULA_MORULA_H" if is_c else "#pragma once")
    lines = [re.sub(r"^///? ?", "", line) for line in opening.splitlines() if "SPDX-" not in line]
    items = Reader(rest).scope(0, len(rest))
    for item in items if is_c else []:
        item.code = re.sub(r"^constexpr auto (\w+) = (.*);", r"#define \1 \2", item.code)
        item.code = item.code.removeprefix("MORULA_API ").replace("\n" + " " * len("MORULA_API "), "\n")
    return lines, items
