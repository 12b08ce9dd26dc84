"""Where an error stands: pydantic's location as a dotted path with names, and its line in the TOML text."""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import lru_cache
from typing import Any, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from flexarm.tables.field import Path


def without_tags(location: Path, data: Any, ends_in_missing: bool) -> Path:
    """Drop what pydantic adds to a location for the chosen member of a union ("beam", "tube")."""
    path: list[str | int] = []
    for i, step in enumerate(location):
        keep = ends_in_missing and i == len(location) - 1
        if isinstance(step, int):
            data = data[step] if isinstance(data, list | tuple) and step < len(data) else None
        elif isinstance(data, dict) and step in data:
            data = data[step]
        elif isinstance(data, BaseModel) and step in type(data).model_fields:
            data = getattr(data, step)
        elif not keep:
            continue
        path.append(step)
    return tuple(path)


def dotted(path: Path, data: Any) -> str:
    """`links.rod.section.thickness` for ("links", 0, "section", "thickness")."""
    words = ""
    for step in path:
        data = _child(data, step)
        if isinstance(step, int):
            name = _child(data, "name")
            at = _child(data, "at") if path[0] == "effects" else None
            label = f"{name}.{at}" if isinstance(at, str) else name
            words += f".{label}" if isinstance(name, str) and name else f"[{step}]"
        else:
            words += f".{step}" if words else step
    return words


def _child(data: Any, step: str | int) -> Any:
    if isinstance(data, dict):
        return data.get(step)
    if isinstance(data, list | tuple) and isinstance(step, int) and step < len(data):
        return data[step]
    return getattr(data, step, None) if isinstance(data, BaseModel) and isinstance(step, str) else None


def field_at(table: type[BaseModel], location: Path) -> tuple[FieldInfo | None, list[str]]:
    """Return the field at a location, tags included, and the keys that are allowed beside it."""
    tables, field = [table], None
    allowed: list[str] = []
    for step in location:
        if isinstance(step, int):
            continue
        with_step = [t for t in tables if step in t.model_fields]
        if with_step:
            allowed = list(with_step[0].model_fields)
            field = with_step[0].model_fields[step]
            tables = _tables_in(field)
        else:
            tagged = [
                t for t in tables if any(step in get_args(f.annotation) for f in t.model_fields.values())
            ]
            field, tables = None, tagged or tables
            allowed = list(tables[0].model_fields) if tables else []
    return field, allowed


def _tables_in(field: FieldInfo) -> list[type[BaseModel]]:
    found: list[type[BaseModel]] = []
    stack = [field.annotation]
    while stack:
        annotation: Any = stack.pop(0)
        if isinstance(annotation, type) and issubclass(annotation, BaseModel):
            found.append(annotation)
        stack.extend(get_args(annotation))
    return found


_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(?:#.*)?$")
_KEY = re.compile(r"""^\s*(?:"([^"]*)"|'([^']*)'|([\w-]+))\s*[=.]""")


@dataclass(frozen=True)
class _Layout:
    """Where headers and keys of a TOML text stand."""

    below: dict[str, list[int]]
    """Header -> the lines after it, in the order of the text."""
    keys: dict[int, dict[str, int]]
    """Line where a block begins -> key -> its first line there."""


@lru_cache(maxsize=1)  # a file with many problems asks for a line of each
def _layout(text: str) -> _Layout:
    block: dict[str, int] = {}
    layout = _Layout({}, {0: block})
    for number, line in enumerate(text.splitlines()):
        if header := _HEADER.match(line):
            layout.below.setdefault(header[2].strip("\"'"), []).append(number + 1)
            block = layout.keys[number + 1] = {}
        elif key := _KEY.match(line):
            block.setdefault(key[1] or key[2] or key[3] or "", number)
    return layout


def line_in(text: str, path: Path) -> int | None:
    """Line of `text` where the value at `path` stands, or its table, or None."""
    if not path:
        return None
    layout = _layout(text)
    begin, rest = _nested_block(layout, path) or _block(layout, path)
    for key in rest[:1]:
        if (number := layout.keys[begin].get(str(key))) is not None:
            return number + 1
    return begin if begin else None


def _nested_block(layout: _Layout, path: Path) -> tuple[int, Path] | None:
    """Return the result of `_block` for a table within a table such as `[a.b]`; None without one."""
    for depth in range(len(path) - 1, 1, -1):
        found = layout.below.get(".".join(map(str, path[:depth])))
        if found:
            return found[0], path[depth:]
    return None


def _block(layout: _Layout, path: Path) -> tuple[int, Path]:
    """Return first line after the header of the path's top table, 0 without one, and the path within it."""
    nth = path[1] if len(path) > 1 and isinstance(path[1], int) else None
    found = layout.below.get(str(path[0]), [])
    if (nth or 0) < len(found):
        return found[nth or 0], path[1:] if nth is None else path[2:]
    return 0, path
