# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""The figure of looseness against uncovered area: a small mark for each rule and body, a large one for the rule.

A body's mark is at the median of its cases of looseness over that of `exact`, and at the median of the uncovered area. The
vertical axis is the square root of the area, so that 0 is on it.
"""
import html
import math
import statistics

from report_numbers import TITLES, UPDATES, digits

NAMES = {"traditional": "traditional", "weighted": "weighted", "approach1": "Approach 1", "approach2": "Approach 2", "exact": "exact"}
PLAIN = {"light": "#333333", "marker": "circle"}


def points(data):
    """For each rule: the places of bodies and the place of all cases, (looseness over exact's, uncovered %)."""
    found = {}
    for rule in UPDATES:
        of_bodies = {}
        for key, case in data.cases.items():
            if rule in case and case["exact"][0] > 0:
                of_bodies.setdefault(key[0], []).append((case[rule][0] / case["exact"][0], case[rule][1]))
        if of_bodies:
            middle = lambda pairs: tuple(statistics.median(values) for values in zip(*pairs))
            found[rule] = ({body: middle(pairs) for body, pairs in of_bodies.items()}, middle([pair for pairs in of_bodies.values() for pair in pairs]))
    return found


def axes(found):
    """Ticks: factors for looseness, percents for the area."""
    looseness = [place[0] for bodies, all_of in found.values() for place in [*bodies.values(), all_of]]
    most = max(place[1] for bodies, all_of in found.values() for place in [*bodies.values(), all_of])
    x = [tick for tick in (0.1, 0.2, 0.5, 1, 2, 5, 10, 20) if min(looseness) / 2.1 <= tick <= max(looseness) * 2.1]
    y = [tick for tick in (0, 0.1, 1, 2, 5, 10, 20, 40, 80) if tick <= max(most, 1) * 1.3]
    return x, y, (min(looseness) / 1.15, max(looseness) * 1.15), max(most, 1) * 1.1


def mark(shape, x, y, size, color, filled):
    fill = f'fill="{color}"' if filled else f'fill="#fff" fill-opacity="0.6" stroke="{color}" stroke-width="1.2"'
    corners = {"square": [(-1, -1), (1, -1), (1, 1), (-1, 1)], "triangle": [(0, -1.25), (1.1, 0.8), (-1.1, 0.8)], "down": [(0, 1.25), (1.1, -0.8), (-1.1, -0.8)],
               "diamond": [(0, -1.35), (1.1, 0), (0, 1.35), (-1.1, 0)]}.get(shape)
    if shape in ("cross", "plus"):
        arms = [(-1, -1, 1, 1), (-1, 1, 1, -1)] if shape == "cross" else [(-1.2, 0, 1.2, 0), (0, -1.2, 0, 1.2)]
        return "".join(f'<line x1="{x + size * a:.1f}" y1="{y + size * b:.1f}" x2="{x + size * c:.1f}" y2="{y + size * d:.1f}" stroke="{color}" '
                       f'stroke-width="{2.4 if filled else 1.3}"/>' for a, b, c, d in arms)
    if corners:
        return f'<polygon points="{" ".join(f"{x + size * a:.1f},{y + size * b:.1f}" for a, b in corners)}" {fill}/>'
    return f'<circle cx="{x:.1f}" cy="{y:.1f}" r="{size:.1f}" {fill}/>'


def svg(data):
    found = points(data)
    ticks_x, ticks_y, (low, high), top = axes(found)
    width, height, left, bottom = 640, 400, 74, 340
    place_x = lambda value: left + (width - left - 20) * math.log(value / low) / math.log(high / low)
    place_y = lambda value: bottom - (bottom - 30) * math.sqrt(value / top)
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height + 30}" font-family="sans-serif" font-size="13">',
             "<title>Uncovered area against looseness, for each rule</title>", f'<rect width="{width}" height="{height + 30}" fill="#fff"/>']
    for tick in ticks_x:
        parts.append(f'<line x1="{place_x(tick):.1f}" y1="30" x2="{place_x(tick):.1f}" y2="{bottom}" stroke="#e3e3e3"/>'
                     f'<text x="{place_x(tick):.1f}" y="{bottom + 18}" text-anchor="middle">{tick:g}</text>')
    for tick in ticks_y:
        parts.append(f'<line x1="{left}" y1="{place_y(tick):.1f}" x2="{width - 20}" y2="{place_y(tick):.1f}" stroke="#e3e3e3"/>'
                     f'<text x="{left - 8}" y="{place_y(tick) + 4:.1f}" text-anchor="end">{tick:g} %</text>')
    parts.append(f'<path d="M{left} 30V{bottom}H{width - 20}" fill="none" stroke="#333"/>'
                 f'<text x="{(left + width) / 2:.0f}" y="{bottom + 38}" text-anchor="middle">looseness over that of exact</text>'
                 f'<text transform="translate(20 {bottom / 2 + 15:.0f}) rotate(-90)" text-anchor="middle">uncovered share of the surface</text>')
    at = left + 4
    for rule, (bodies, all_of) in found.items():
        style = data.record["styles"].get(NAMES[rule], PLAIN)
        for body, (x, y) in bodies.items():
            parts.append(f"<g><title>{html.escape(f'{TITLES[rule]}, {body}: {digits(x)} times, {digits(y)} %')}</title>"
                         + mark(style["marker"], place_x(x), place_y(y), 4, style["light"], False) + "</g>")
        parts.append(f"<g><title>{html.escape(f'{TITLES[rule]}: {digits(all_of[0])} times, {digits(all_of[1])} %')}</title>"
                     + mark(style["marker"], place_x(all_of[0]), place_y(all_of[1]), 7, style["light"], True) + "</g>")
        parts.append(mark(style["marker"], at + 6, height + 8, 5, style["light"], True) + f'<text x="{at + 18}" y="{height + 13}">{NAMES[rule]}</text>')
        at += 36 + 7.4 * len(NAMES[rule])
    return "\n".join([*parts, "</svg>"]) + "\n"


MARKS = {"circle": ("*", "o"), "square": ("square*", "square"), "triangle": ("triangle*", "triangle"), "diamond": ("diamond*", "diamond"),
         "down": ("triangle*", "triangle"), "pentagon": ("pentagon*", "pentagon"), "cross": ("x", "x"), "plus": ("+", "+")}


def pgf(data):
    found = points(data)
    ticks_x, ticks_y, (low, high), top = axes(found)
    comma = ",".join
    parts = [r"% Uncovered area against looseness, for each rule. Preamble: \usepackage{pgfplots} \pgfplotsset{compat=1.16}", r"\begin{tikzpicture}",
             r"\begin{semilogxaxis}[width=12cm,height=7.5cm,grid=major,grid style={gray!20},legend pos=north east,legend style={draw=none,font=\footnotesize},",
             r"label style={font=\footnotesize},tick label style={font=\footnotesize},xlabel={looseness over that of exact},ylabel={uncovered share of the surface},",
             rf"xmin={low:.4g},xmax={high:.4g},ymin=-0.08,ymax={math.sqrt(top):.4g},xtick={{{comma(f'{tick:g}' for tick in ticks_x)}}},",
             rf"xticklabels={{{comma(f'{tick:g}' for tick in ticks_x)}}},ytick={{{comma(f'{math.sqrt(tick):.5g}' for tick in ticks_y)}}},",
             rf"yticklabels={{{comma(f'{tick:g}' + chr(92) + ',' + chr(92) + '%' for tick in ticks_y)}}}]"]
    for number, (rule, (bodies, all_of)) in enumerate(found.items()):
        style = data.record["styles"].get(NAMES[rule], PLAIN)
        full, hollow = MARKS[style["marker"]]
        turned = ",mark options={rotate=180}" if style["marker"] == "down" else ""
        place = lambda pair: f"({pair[0]:.5g},{math.sqrt(pair[1]):.5g})"
        parts.append(rf"\definecolor{{rule{number}}}{{HTML}}{{{style['light'].lstrip('#').upper()}}}")
        parts.append(rf"\addplot[only marks,rule{number},mark={full},mark size=3.5pt{turned}] coordinates {{{place(all_of)}}};")
        parts.append(rf"\addlegendentry{{{NAMES[rule]}}}")
        parts.append(rf"\addplot[only marks,forget plot,rule{number},mark={hollow},mark size=2pt{turned}] coordinates {{{' '.join(map(place, bodies.values()))}}};")
    return "\n".join([*parts, r"\end{semilogxaxis}", r"\end{tikzpicture}"]) + "\n"
