"""Where an error stands: pydantic's location as a dotted path with names, and its line in the TOML text."""

from __future__ import annotations

import re
from typing import Any, get_args

from pydantic.fields import FieldInfo

from flexarm.tables.table import Path, Table


def without_tags(location: Path, data: Any, ends_in_missing: bool) -> Path:
    """Drops what pydantic adds to a location for the chosen member of a union ("beam", "tube")."""
    path: list[str | int] = []
    for i, step in enumerate(location):
        keep = ends_in_missing and i == len(location) - 1
        if isinstance(step, int):
            data = data[step] if isinstance(data, list | tuple) and step < len(data) else None
        elif isinstance(data, dict) and step in data:
            data = data[step]
        elif isinstance(data, Table) and step in type(data).model_fields:
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
    return getattr(data, step, None) if isinstance(data, Table) and isinstance(step, str) else None


def field_at(table: type[Table], location: Path) -> tuple[FieldInfo | None, list[str]]:
    """The field at a location, tags included, and the keys that are allowed beside it."""
    tables, field = [table], None
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
    return field, allowed if location else []


def _tables_in(field: FieldInfo) -> list[type[Table]]:
    found: list[type[Table]] = []
    stack = [field.annotation]
    while stack:
        annotation: Any = stack.pop(0)
        if isinstance(annotation, type) and issubclass(annotation, Table):
            found.append(annotation)
        stack.extend(get_args(annotation))
    return found


_HEADER = re.compile(r"^\s*(\[\[?)\s*([^\[\]]+?)\s*\]\]?\s*(?:#.*)?$")


def line_in(text: str, path: Path) -> int | None:
    """Line of `text` where the value at `path` stands, or its table, or None."""
    if not path:
        return None
    lines = text.splitlines()
    begin, end, rest = _nested_block(lines, path) or _block(lines, path)
    for key in rest[:1]:
        pattern = re.compile(rf"""^\s*["']?{re.escape(str(key))}["']?\s*(=|\.)""")
        for number in range(begin, end):
            if pattern.match(lines[number]):
                return number + 1
    return begin if begin else None


def _nested_block(lines: list[str], path: Path) -> tuple[int, int, Path] | None:
    """As `_block`, under the header of a table within a table such as `[a.b]`; None if there is none."""
    for depth in range(len(path) - 1, 1, -1):
        wanted = ".".join(map(str, path[:depth]))
        for number, line in enumerate(lines):
            header = _HEADER.match(line)
            if header and header[2] == wanted:
                below = range(number + 1, len(lines))
                return (
                    number + 1,
                    next((n for n in below if _HEADER.match(lines[n])), len(lines)),
                    path[depth:],
                )
    return None


def _block(lines: list[str], path: Path) -> tuple[int, int, Path]:
    """Lines after the header of the path's top table up to the next header, and the path within it."""
    wanted = str(path[0])
    nth = path[1] if len(path) > 1 and isinstance(path[1], int) else None
    begin, count = 0, -1
    for number, line in enumerate(lines):
        header = _HEADER.match(line)
        if not header:
            continue
        if begin:
            return begin, number, path[1:] if nth is None else path[2:]
        if header[2].strip("\"'") == wanted:
            count += 1
            if nth is None or count == nth:
                begin = number + 1
    if begin:
        return begin, len(lines), path[1:] if nth is None else path[2:]
    first_header = next((n for n, line in enumerate(lines) if _HEADER.match(line)), len(lines))
    return 0, first_header, path
