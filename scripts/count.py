"""Count what makes code hard to carry on: files, lines, constants, effect names, import circles, helpers.

    python scripts/count.py            # a table in Markdown
    python scripts/count.py --names    # also where each constant and effect name stands
    python scripts/count.py --check    # fail if modules import one another

Counted by the syntax tree of `python/flexarm`. A numeric constant is a module's name in capitals whose value
is a number or numbers. An effect name is a word of a string in the code that is a name of the vocabulary. A
one-use helper is a private function that its module calls once. Circles are of modules that import one
another, at the top or inside functions; imports for type checkers alone are left out.
"""

from __future__ import annotations

import argparse
import ast
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1] / "python"
CORE = ("diagnosis", "validation", "residual_analysis", "report")
"""Packages of the diagnosis; the others are the rest."""


class Module:
    """A file of the package and its syntax tree."""

    def __init__(self, path: Path) -> None:
        parts = path.relative_to(ROOT).with_suffix("").parts
        self.name = ".".join(parts[:-1] if parts[-1] == "__init__" else parts)
        self.lines = path.read_text().splitlines()
        self.tree = ast.parse("\n".join(self.lines))

    @property
    def package(self) -> str:
        """Return the first folder below flexarm, or "" for a file that lies in none."""
        parts = self.name.split(".")
        return parts[1] if len(parts) > 1 else ""

    def constants(self) -> Iterator[str]:
        """Yield names in capitals that are given numbers in the body of the module."""
        for node in self.tree.body:
            targets = node.targets if isinstance(node, ast.Assign) else []
            targets = [node.target] if isinstance(node, ast.AnnAssign) and node.value else targets
            names = [n.id for target in targets for n in ast.walk(target) if isinstance(n, ast.Name)]
            if any(name.lstrip("_").isupper() for name in names) and _numeric(node.value):
                yield from names

    def effect_names(self, vocabulary: frozenset[str]) -> Iterator[str]:
        """Yield words of strings, docstrings left out, that name an effect."""
        texts = {id(node.value) for node in ast.walk(self.tree) if isinstance(node, ast.Expr)}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in texts:
                yield from (word for word in node.value.replace(".", " ").split() if word in vocabulary)

    def imports(self) -> Iterator[tuple[str, bool]]:
        """Yield modules that are imported when the program runs, and True where inside a function."""
        for node, deferred in _run_time(self.tree, deferred=False):
            if isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    yield f"{node.module}.{alias.name}", deferred
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    yield alias.name, deferred

    def functions(self) -> list[ast.FunctionDef]:
        """Return all functions and methods."""
        return [node for node in ast.walk(self.tree) if isinstance(node, ast.FunctionDef)]

    def one_use_helpers(self) -> list[str]:
        """Return private functions that the module names once outside their definition."""
        names = [
            node.id if isinstance(node, ast.Name) else node.attr
            for node in ast.walk(self.tree)
            if isinstance(node, ast.Name | ast.Attribute)
        ]
        private = [f.name for f in self.functions() if f.name.startswith("_") and not f.name.endswith("__")]
        return [name for name in private if names.count(name) == 1]


def _numeric(node: ast.expr | None) -> bool:
    """Return True for an expression that has numbers and neither strings nor names of other things."""
    if node is None:
        return False
    kinds = [type(n.value) for n in ast.walk(node) if isinstance(n, ast.Constant)]
    plain = (ast.Constant, ast.Tuple, ast.UnaryOp, ast.BinOp, ast.Call, ast.operator, ast.unaryop)
    names = (ast.Name, ast.Attribute, ast.Load)
    whole = all(isinstance(n, plain + names) for n in ast.walk(node))
    return whole and bool(kinds) and all(kind in (int, float) for kind in kinds)


def _run_time(node: ast.AST, deferred: bool) -> Iterator[tuple[ast.AST, bool]]:
    """Yield nodes outside `if TYPE_CHECKING`, and True for those inside functions."""
    for child in ast.iter_child_nodes(node):
        if isinstance(child, ast.If) and "TYPE_CHECKING" in ast.dump(child.test):
            continue
        inside = deferred or isinstance(child, ast.FunctionDef | ast.Lambda)
        yield child, inside
        yield from _run_time(child, inside)


def circles(modules: dict[str, Module]) -> list[list[str]]:
    """Return groups of modules that import one another, by Tarjan's strongly connected components."""
    graph = {
        name: {_known(target, modules) for target, _ in module.imports()} - {None, name}
        for name, module in modules.items()
    }
    index: dict[str, int] = {}
    low: dict[str, int] = {}
    stack: list[str] = []
    found: list[list[str]] = []

    def visit(name: str) -> None:
        index[name] = low[name] = len(index)
        stack.append(name)
        for other in graph[name]:
            if other not in index:
                visit(other)
            if other in stack:
                low[name] = min(low[name], low[other])
        if low[name] == index[name]:
            group = stack[stack.index(name) :]
            del stack[stack.index(name) :]
            if len(group) > 1:
                found.append(sorted(group))

    sys.setrecursionlimit(10_000)
    for name in graph:
        if name not in index:
            visit(name)
    return found


def _known(target: str, modules: dict[str, Module]) -> str | None:
    """Return the module that an import is of: the name itself, or what stands before its last dot."""
    if target in modules:
        return target
    parent = target.rpartition(".")[0]
    return parent if parent in modules else None


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--names", action="store_true", help="list constants and effect names")
    parser.add_argument("--check", action="store_true", help="fail if modules import one another")
    given = parser.parse_args()
    modules = {m.name: m for m in map(Module, sorted(ROOT.rglob("*.py")))}
    found = circles(modules)
    if given.check:
        raise SystemExit("\n".join(f"circle: {', '.join(group)}" for group in found) or 0)
    effects = modules["flexarm.arm.vocabulary"].tree
    words = [n.value for n in ast.walk(effects) if isinstance(n, ast.Constant) and isinstance(n.value, str)]
    vocabulary = frozenset(word for text in words for word in text.split() if "_" in word) | {"backlash"}
    print(
        "| package | files | lines | numeric constants | effect names | one-use helpers | deferred imports |"
    )
    print("|---|---|---|---|---|---|---|")
    core = [m for m in modules.values() if m.package in CORE]
    groups = {p: [m for m in core if m.package == p] for p in CORE}
    for label, group in {**groups, "**these four**": core, "whole package": list(modules.values())}.items():
        functions = sum(len(m.functions()) for m in group)
        helpers = sum(len(m.one_use_helpers()) for m in group)
        cells = [
            len(group),
            sum(len(m.lines) for m in group),
            sum(len(list(m.constants())) for m in group),
            sum(len(list(m.effect_names(vocabulary))) for m in group),
            f"{100 * helpers / max(functions, 1):.0f} %",
            sum(deferred for m in group for _, deferred in m.imports()),
        ]
        print(f"| {label} | " + " | ".join(map(str, cells)) + " |")
    print(f"\nCircles of imports: {len(found)}" + "".join(f"\n* {len(group)} modules" for group in found))
    if given.names:
        for module in core:
            names = [*module.constants(), *module.effect_names(vocabulary)]
            if names:
                print(f"\n{module.name}: " + ", ".join(names))
        for group in found:
            print("\n" + ", ".join(group))


if __name__ == "__main__":
    main()
