# SPDX-FileCopyrightText: 2026 The Morula authors
# SPDX-License-Identifier: Apache-2.0
"""A page with every name of the Python package, made of its stubs and modules: signatures and docstrings."""

import ast
import pathlib

#: What is the same for every record and says nothing new.
LEFT_OUT = {"to_dict", "__repr__", "__eq__", "__hash__", "__copy__", "__deepcopy__", "__reduce__", "__getstate__", "__setstate__"}


def signature(node: ast.FunctionDef, is_method: bool) -> str:
    """name(arguments) -> result, without self."""
    text = ast.unparse(ast.FunctionDef(node.name, node.args, [ast.Pass()], [], node.returns, lineno=0))
    text = text.partition("def ")[2].rpartition(":\n")[0]
    for long, short in (("morula.typing.", ""), ("morula._morula.", ""), ("collections.abc.", ""), ("typing.", ""), ("numpy.typing.", "")):
        text = text.replace(long, short)
    if is_method:
        text = text.replace("(self, ", "(", 1).replace("(self)", "()", 1)
    return text


def fenced(text: str) -> str:
    return f"```python\n{text}\n```\n"


def escaped(text: str) -> str:
    """Signs of markdown that docstrings do not mean, outside of `code`."""
    pieces = text.split("`")
    return "`".join(p.replace("[", "\\[").replace("<", "&lt;") if i % 2 == 0 else p for i, p in enumerate(pieces))


def described(node: ast.AST) -> str:
    """The docstring, with its arguments as a list."""
    text = ast.get_docstring(node) or ""
    lines, in_arguments = [], False
    for line in text.splitlines():
        if line.strip() == "Args:":
            in_arguments = True
            lines.append("")
        elif in_arguments and line.startswith("    "):
            name, colon, meaning = line.strip().partition(": ")
            lines.append(f"- `{name}`: {meaning}" if colon and not line.startswith("        ") else "  " + line.strip())
        else:
            in_arguments = in_arguments and not line.strip()
            lines.append(line)
    return escaped("\n".join(lines)) + "\n"


def is_property(node: ast.FunctionDef) -> bool:
    return any(isinstance(d, ast.Name) and d.id == "property" for d in node.decorator_list)


def class_text(node: ast.ClassDef, path: str) -> str:
    text = [f"## {path}{node.name}\n", described(node)]
    properties = [n for n in node.body if isinstance(n, ast.FunctionDef) and is_property(n)]
    values = [n for n in node.body if isinstance(n, (ast.Assign, ast.AnnAssign))]
    for n in values:
        name = ast.unparse(n.target if isinstance(n, ast.AnnAssign) else n.targets[0])
        if not name.startswith("_"):
            text.append(f"- `{name}`")
    for n in properties:
        kind = f": {signature(n, True).partition(' -> ')[2]}" if n.returns else ""
        meaning = escaped(" ".join((ast.get_docstring(n) or "").split()))
        text.append(f"- `{n.name}{kind}`" + (f" – {meaning}" if meaning else ""))
    text.append("")
    for n in node.body:
        if isinstance(n, ast.FunctionDef) and n not in properties and n.name not in LEFT_OUT:
            text += [fenced(signature(n, True)), described(n)]
    return "\n".join(text)


def module_text(source: str, path: str, names: set[str] | None = None) -> dict[str, str]:
    """Text by name; overloads of one name together."""
    found: dict[str, str] = {}
    for node in ast.parse(source).body:
        if not isinstance(node, (ast.ClassDef, ast.FunctionDef)) or node.name.startswith("_"):
            continue
        if names is not None and node.name not in names:
            continue
        if isinstance(node, ast.ClassDef):
            found[path + node.name] = class_text(node, path)
        else:
            text = fenced(signature(node, False)) + "\n" + described(node)
            head = "" if path + node.name in found else f"## {path}{node.name}\n\n"
            found[path + node.name] = found.get(path + node.name, "") + head + text
    return found


def public_names(source: str) -> set[str]:
    for node in ast.parse(source).body:
        if isinstance(node, ast.Assign) and ast.unparse(node.targets[0]) == "__all__" and isinstance(node.value, ast.List):
            return set(ast.literal_eval(node.value))
    return set()


def reference(root: pathlib.Path, stub: pathlib.Path) -> str:
    """The page; without stubs it says how they are made."""
    head = "# Reference of the Python package\n\nThe [package](python.md) has the names of the C++ library; its docstrings are the comments of the headers.\n\n"
    if not stub.exists():
        return head + "This site was made without the package: `cmake --build --preset release --target morula_python_stub` makes its stubs.\n"
    found = module_text(stub.read_text(encoding="utf-8"), "morula.")
    robots = stub.with_name("robot.pyi")
    if robots.exists():
        found |= module_text(robots.read_text(encoding="utf-8"), "morula.robot.")
    for file, path in (
        ("extras/page/python/pages.py", "morula."), ("extras/study/python/studies.py", "morula."), ("python/morula/batch.py", "morula.batch."),
        ("python/morula/plot.py", "morula.plot."), ("python/morula/ipctk.py", "morula.ipctk."),
    ):
        source = (root / file).read_text(encoding="utf-8")
        names = public_names(source) or {"Page", "page"}
        found |= module_text(source, path, names)
    order = sorted(found, key=lambda name: (name.count("."), name.lower()))
    return head + "\n".join(found[name] for name in order)
