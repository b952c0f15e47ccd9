# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The Markdown of the report as HTML and as LaTeX: headings, paragraphs, lists, tables, code, figures, citations.

A figure is a paragraph ![caption](figures/NAME.svg); a citation is [key2005] or [key2005, sec. 3], a key of docs/references.bib.
"""
import base64
import html
import pathlib
import re

COMMENT = re.compile(r"<!--.*?-->", re.S)
CITATION = re.compile(r"\[([a-z]+[12]\d{3})((?:, [a-z]+[12]\d{3})*)(, [^][]*)?\](?!\()")
INLINE = re.compile(r"`([^`]+)`|\*\*(.+?)\*\*|\*(.+?)\*|\[([^][]+)\]\(([^()\s]+)\)|" + CITATION.pattern)


def blocks(text):
    """The blocks of a text without its comments: ("heading", level, text), ("list", items), ("table", rows) and so on."""
    found = []
    for part in re.split(r"\n{2,}", COMMENT.sub("", text).strip("\n")):
        lines = [line for line in part.split("\n") if line.strip()]
        if not lines:
            continue
        if heading := re.fullmatch(r"(#+) (.*)", lines[0]):
            found.append(("heading", len(heading[1]), heading[2]))
            lines = lines[1:]
        if not lines:
            continue
        if figure := re.fullmatch(r"!\[(.*)\]\((\S+)\)", " ".join(lines), re.S):
            found.append(("figure", figure[1], figure[2]))
        elif lines[0].startswith("```"):
            found.append(("code", "\n".join(lines[1:-1])))
        elif all(line.startswith("|") for line in lines):
            found.append(("table", [[cell.strip() for cell in line.strip("|").split("|")] for i, line in enumerate(lines) if i != 1]))
        elif re.match(r"- |\d+\. ", lines[0]):
            kind = "list" if lines[0].startswith("- ") else "numbers"
            items = re.split(r"\n(?=- |\d+\. )", "\n".join(lines))
            found.append((kind, [" ".join(re.sub(r"^(- |\d+\. )", "", item).split()) for item in items]))
        else:
            found.append(("paragraph", " ".join(" ".join(lines).split())))
    return found


# ---- the bibliography ----


def bibliography(path):
    """The entries of a .bib file by key: their fields, with braces and accents as plain text."""
    entries = {}
    for kind, key, body in re.findall(r"^@(\w+)\{([^,]+),\n(.*?)^\}", pathlib.Path(path).read_text(), re.M | re.S):
        fields = dict(re.findall(r"(\w+)\s*=\s*\{(.*)\},?\s*$", body, re.M))
        entries[key] = {"kind": kind} | {name: plain(value) for name, value in fields.items()}
    return entries


ACCENTS = {"'i": "í", "'a": "á", "'e": "é", "'o": "ó", "`e": "è", '"u': "ü", '"o': "ö", '"a': "ä", "u a": "ă", "'c": "ć", "~n": "ñ", "v c": "č", "^e": "ê"}


def plain(text):
    def accent(match):
        key = (match[1] + match[2]) if match[1] not in "uv" else f"{match[1]} {match[2]}"
        return ACCENTS.get(key, match[2])
    text = re.sub(r"\{?\\(['`\"~^uv])\{?\\?([a-zA-Z])\}?\}?", accent, text)
    text = text.replace(r"{\ae}", "æ").replace(r"\ae", "æ").replace("--", "–").replace(r"\&", "&")
    return re.sub(r"[{}]", "", text)


def reference(entry):
    """An entry as one sentence: authors, title in quotes, place, year."""
    authors = [" ".join(reversed(name.split(", "))) for name in entry["author"].split(" and ")]
    who = authors[0] if len(authors) == 1 else ", ".join(authors[:-1]) + " and " + authors[-1]
    place = entry.get("journal") or entry.get("booktitle") or entry.get("school") or entry.get("publisher") or ""
    if entry.get("volume"):
        place += f", vol. {entry['volume']}" if entry.get("journal") else f", {entry.get('series', '')} vol. {entry['volume']}".replace(",  ", ", ")
    if entry.get("pages"):
        place += f", p. {entry['pages']}"
    return f"{who}: “{entry['title']}”. {place}, {entry['year']}."


def cited(text, entries):
    """The keys that a text cites, in the order of their names, and those that the bibliography does not have."""
    keys = set()
    for match in CITATION.finditer(COMMENT.sub("", text)):
        keys |= {match[1], *filter(None, match[2].split(", "))}
    return sorted(keys & set(entries)), sorted(keys - set(entries))


# ---- HTML ----

STYLE = """body{max-width:52rem;margin:2rem auto;padding:0 1rem;font:1.05rem/1.55 Georgia,'Times New Roman',serif;color:#1b1b1b;background:#fff}
h1{font-size:1.9rem;line-height:1.2}h2{font-size:1.35rem;margin-top:2.2rem}h3{font-size:1.1rem}
table{border-collapse:collapse;font-size:.82rem;line-height:1.35;margin:1rem 0;display:block;overflow-x:auto}
th,td{padding:.25rem .5rem;text-align:left;vertical-align:top;border-bottom:1px solid #ccc}th{border-bottom:2px solid #555}
figure{margin:1.5rem 0}figure img{max-width:100%;height:auto}figcaption{font-size:.9rem}
code{font-size:.92em}pre{background:#f4f4f2;padding:.6rem;overflow-x:auto}a{color:#0b5a8a}
@media(prefers-color-scheme:dark){body{color:#e6e6e6;background:#16181c}th,td{border-color:#444}pre{background:#22252b}a{color:#7dbde8}}"""


class Html:
    def __init__(self, folder, entries, keys, link):
        self.folder, self.entries, self.numbers, self.link = pathlib.Path(folder), entries, {key: i + 1 for i, key in enumerate(keys)}, link
        self.figures = 0

    def inline(self, text):
        parts, at = [], 0
        for match in INLINE.finditer(text):
            parts.append(html.escape(text[at:match.start()], quote=False))
            at = match.end()
            code, bold, em, words, target, key, more, place = match.groups()
            if code:
                parts.append(f"<code>{html.escape(code, quote=False)}</code>")
            elif bold or em:
                tag = "strong" if bold else "em"
                parts.append(f"<{tag}>{self.inline(bold or em)}</{tag}>")
            elif target:
                address = self.link(target)
                parts.append(f'<a href="{html.escape(address)}">{self.inline(words)}</a>' if address else self.inline(words))
            else:
                links = [f'<a href="#{one}">{self.numbers.get(one, "?")}</a>' for one in [key, *filter(None, more.split(", "))]]
                parts.append("[" + ", ".join(links) + html.escape(place or "") + "]")
        return "".join(parts) + html.escape(text[at:], quote=False)

    def block(self, block):
        kind = block[0]
        if kind == "heading":
            anchor = re.sub(r"[^a-z0-9 -]", "", block[2].lower()).replace(" ", "-")
            return f'<h{block[1]} id="{anchor}">{self.inline(block[2])}</h{block[1]}>'
        if kind == "paragraph":
            return f"<p>{self.inline(block[1])}</p>"
        if kind in ("list", "numbers"):
            tag = "ul" if kind == "list" else "ol"
            return f"<{tag}>" + "".join(f"<li>{self.inline(item)}</li>" for item in block[1]) + f"</{tag}>"
        if kind == "code":
            return f"<pre><code>{html.escape(block[1], quote=False)}</code></pre>"
        if kind == "table":
            head = "".join(f"<th>{self.inline(cell)}</th>" for cell in block[1][0])
            rows = "".join("<tr>" + "".join(f"<td>{self.inline(cell)}</td>" for cell in row) + "</tr>" for row in block[1][1:])
            return f"<table><thead><tr>{head}</tr></thead><tbody>{rows}</tbody></table>"
        self.figures += 1
        # Drawings have styles of their own, so each is an image of its own.
        drawing = base64.b64encode((self.folder / block[2]).read_bytes()).decode()
        return (f'<figure><img alt="{html.escape(plain(block[1]))}" src="data:image/svg+xml;base64,{drawing}">'
                f"<figcaption><b>Figure {self.figures}.</b> {self.inline(block[1])}</figcaption></figure>")

    def document(self, text):
        body = "\n".join(self.block(block) for block in blocks(text))
        list_of = "".join(f'<li id="{key}">{html.escape(reference(self.entries[key]))}</li>' for key in self.numbers)
        title = html.escape(re.search(r"^# (.*)$", text, re.M)[1])
        return (f'<!doctype html>\n<html lang="en"><head><meta charset="utf-8"><meta name="viewport" content="width=device-width">'
                f"<title>{title}</title><style>{STYLE}</style></head><body>\n{body}\n<h2 id=\"references\">References</h2>\n<ol>{list_of}</ol>\n</body></html>\n")


# ---- LaTeX ----

SIGNS = {"\\": r"\textbackslash{}", "&": r"\&", "%": r"\%", "$": r"\$", "#": r"\#", "_": r"\_", "{": r"\{", "}": r"\}", "~": r"\textasciitilde{}",
         "^": r"\textasciicircum{}", "<": r"\ensuremath{<}", ">": r"\ensuremath{>}", "|": r"\textbar{}", "×": r"\ensuremath{\times}", "≥": r"\ensuremath{\geq}",
         "≤": r"\ensuremath{\leq}", "−": r"\ensuremath{-}", "δ": r"\ensuremath{\delta}", "Σ": r"\ensuremath{\Sigma}", "°": r"\ensuremath{^\circ}", "·": r"\ensuremath{\cdot}",
         "²": r"\ensuremath{^2}", "³": r"\ensuremath{^3}", "–": "--", "—": "---", "“": "``", "”": "''", "’": "'", "ă": r"\u{a}", "æ": r"\ae{}", "…": r"\dots{}", "\u00a0": "~"}
PREAMBLE = r"""\documentclass[10pt,a4paper]{article}
\usepackage[utf8]{inputenc}
\usepackage{textcomp}
\usepackage[margin=2.4cm]{geometry}
\usepackage{graphicx,array,longtable,booktabs}
\usepackage{pgfplots}
\pgfplotsset{compat=1.16}
\usepgfplotslibrary{groupplots}
\usetikzlibrary{decorations.pathreplacing}
\usepackage[hidelinks]{hyperref}
\setlength{\emergencystretch}{3em}
"""


class Latex:
    def __init__(self, folder, entries, keys, link):
        self.folder, self.entries, self.keys, self.link = pathlib.Path(folder), entries, keys, link

    @staticmethod
    def escaped(text):
        return "".join(SIGNS.get(sign, sign) for sign in text)

    def inline(self, text):
        parts, at = [], 0
        for match in INLINE.finditer(text):
            parts.append(self.escaped(text[at:match.start()]))
            at = match.end()
            code, bold, em, words, target, key, more, place = match.groups()
            if code:
                parts.append(r"\texttt{" + self.escaped(code).replace("-", "{-}") + "}")
            elif bold or em:
                parts.append((r"\textbf{" if bold else r"\emph{") + self.inline(bold or em) + "}")
            elif target:
                address = self.link(target)
                parts.append(r"\href{" + address.replace("%", r"\%").replace("#", r"\#") + "}{" + self.inline(words) + "}" if address else self.inline(words))
            else:
                keys = ",".join([key, *filter(None, more.split(", "))])
                parts.append(r"\cite" + (f"[{self.escaped(place[2:])}]" if place else "") + "{" + keys + "}")
        return "".join(parts) + self.escaped(text[at:])

    def table(self, rows):
        columns = len(rows[0])
        lengths = [max(4, min(46, max(len(COMMENT.sub("", row[i])) for row in rows))) for i in range(columns)]
        # A column is at least as wide as its longest word.
        words = [max(len(word) for row in rows for word in [*row[i].replace("`", "").split(), ""]) for i in range(columns)]
        spare = 0.97 - 0.024 * columns
        shares = [max(length, 1.25 * word) for length, word in zip(lengths, words)]
        layout = "".join(rf">{{\raggedright\arraybackslash}}p{{{spare * share / sum(shares):.3f}\textwidth}}" for share in shares)
        line = lambda row: " & ".join(self.inline(cell) for cell in row) + r" \\"
        return "\n".join([r"{\footnotesize\setlength{\tabcolsep}{0.012\textwidth}", rf"\begin{{longtable}}{{@{{}}{layout}@{{}}}}", r"\toprule", line(rows[0]),
                          r"\midrule\endhead", *(line(row) for row in rows[1:]), r"\bottomrule", r"\end{longtable}}"])

    def figure(self, caption, path):
        stem = pathlib.PurePosixPath(path).stem
        if (self.folder / "figures" / f"{stem}.pgf").exists():
            content = rf"\resizebox{{\ifdim\width>\textwidth\textwidth\else\width\fi}}{{!}}{{\input{{figures/{stem}.pgf}}}}"
        elif (self.folder / "figures" / f"{stem}.pdf").exists():
            content = rf"\includegraphics[width=\textwidth]{{figures/{stem}.pdf}}"
        else:
            content = rf"\fbox{{The drawing is in \texttt{{{self.escaped(path)}}}.}}"
        return "\n".join([r"\begin{figure}[tp]\centering", content, rf"\caption{{{self.inline(caption)}}}", r"\end{figure}"])

    def block(self, block):
        kind = block[0]
        if kind == "heading":
            return "\\" + ("", "", "section", "subsection", "subsubsection")[block[1]] + "{" + self.inline(re.sub(r"^\d+\. ", "", block[2])) + "}"
        if kind == "paragraph":
            return self.inline(block[1])
        if kind in ("list", "numbers"):
            name = "itemize" if kind == "list" else "enumerate"
            return f"\\begin{{{name}}}\n" + "\n".join(r"\item " + self.inline(item) for item in block[1]) + f"\n\\end{{{name}}}"
        if kind == "code":
            return "\\begin{verbatim}\n" + block[1] + "\n\\end{verbatim}"
        if kind == "table":
            return self.table(block[1])
        return self.figure(block[1], block[2])

    def document(self, text):
        first, *rest = blocks(text)
        authors, *rest = rest
        parts = [PREAMBLE, r"\title{" + self.inline(first[2]) + "}", r"\author{" + self.inline(authors[1]) + "}", r"\date{}", r"\begin{document}", r"\maketitle"]
        parts += [self.block(block) for block in rest]
        parts.append(r"\begin{thebibliography}{99}")
        parts += [rf"\bibitem{{{key}}} {self.escaped(reference(self.entries[key]))}" for key in self.keys]
        return "\n\n".join([*parts, r"\end{thebibliography}", r"\end{document}"]) + "\n"
