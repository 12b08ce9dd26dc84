"""A TOML text with other values: comments, order and layout of what stays are kept."""

from __future__ import annotations

import tomllib
from collections.abc import Callable, Mapping, MutableMapping
from typing import Any

from flexarm.tables.toml import at_top, inline, table_of, toml_text


def edited_toml(text: str, data: Mapping[str, Any]) -> str:
    """Return a TOML text that holds `data`, with the comments of `text`.

    Tables of a list are the same if their names are, or name and `at` where names repeat. Where tables come
    in another order, the text is written anew, without comments.
    """
    import tomlkit
    from tomlkit.exceptions import TOMLKitError

    plain = toml_text(data)
    values = tomllib.loads(plain)
    try:
        document = tomlkit.parse(text)
        _put(document, values, at_top)
        found = tomlkit.dumps(document)
        same = tomllib.loads(found) == values
    except (TOMLKitError, tomllib.TOMLDecodeError):
        return plain
    return found if same else plain


def _put(table: MutableMapping[str, Any], data: Mapping[str, Any], item_of: Callable[[Any], Any]) -> None:
    for key in [key for key in table if key not in data]:
        del table[key]
    for key, value in data.items():
        old = table.get(key)
        if isinstance(old, MutableMapping) and isinstance(value, Mapping):
            _put(old, value, inline)
        elif _are_tables(old) and _are_tables(value):
            _put_tables(old, value)
        elif old is None or old != value:
            table[key] = item_of(value)


def _put_tables(tables: Any, items: list[Mapping[str, Any]]) -> None:
    keys = _identifying(items)
    wanted = {_identity(item, keys) for item in items}
    for k in reversed(range(len(tables))):
        if _identity(tables[k], keys) not in wanted:
            del tables[k]
    there = {_identity(table, keys): table for table in tables}
    for item in items:
        if (table := there.get(_identity(item, keys))) is not None:
            _put(table, item, inline)
        else:
            tables.append(table_of(item))


def _identifying(items: list[Mapping[str, Any]]) -> tuple[str, ...]:
    """Return the keys that tell tables apart: the name, of effects also the place."""
    names = [item.get("name") for item in items]
    return ("name",) if len(set(names)) == len(names) else ("name", "at")


def _are_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(item, Mapping) for item in value)


def _identity(item: Mapping[str, Any], keys: tuple[str, ...]) -> tuple[Any, ...]:
    return tuple(item.get(key) for key in keys)
