"""A TOML text with other values: what stays the same stands as it was written, in its order, with comments.

Only the difference of two sets of tables is written, so that a key which holds its default stays as the user
wrote it, or left it out. The text is cut at its headers and each block edited by itself, as tomlkit would
bring tables of one list together.
"""

from __future__ import annotations

import re
import tomllib
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from dataclasses import dataclass, field
from typing import Any

from flexarm.tables.toml import inline, table_of

_TOKEN = re.compile(
    r'"""(?:\\.|[^\\])*?"""' + r"|'''.*?'''" + r'|"(?:\\.|[^"\\\n])*"' + r"|'[^'\n]*'|#[^\n]*|[\[{\]}\n]",
    re.DOTALL,
)
"""Texts and comments, in which brackets are none; brackets; ends of lines."""


@dataclass(eq=False)
class _Block:
    """A table below its header, and those below deeper headers."""

    header: str = ""
    content: Any = None
    """Its keys; None where only deeper headers name the table."""
    tail: str = ""
    """Blank lines and comments at its end, which are about what follows."""
    below: dict[str, Any] = field(default_factory=dict)
    """Blocks, or lists of them, by key."""

    @property
    def text(self) -> str:
        return self.header + (self.content.as_string() if self.content else "") + self.tail

    def within(self) -> Iterator[_Block]:
        """Yield the block and all below it."""
        yield self
        for deeper in self.below.values():
            for block in deeper if isinstance(deeper, list) else [deeper]:
                yield from block.within()


def edited_toml(text: str, before: Mapping[str, Any], after: Mapping[str, Any]) -> str:
    """Return a TOML text into which the difference of two sets of tables is written.

    Tables of a list are the same if their names are, or name and `at` where names repeat. Raise ValueError if
    it is no TOML, or has no place for a change.
    """
    from tomlkit.exceptions import TOMLKitError

    try:
        blocks = _cut(text if text.endswith("\n") else text + "\n")
        _Edit(blocks).put(blocks[0], before, after)
    except TOMLKitError as error:
        raise ValueError(str(error)) from None
    return "".join(block.text for block in blocks)


def _cut(text: str) -> list[_Block]:
    """Return the blocks of a text in their order; the first has no header and leads to all others."""
    import tomlkit

    starts, depth, line = [0], 0, 0
    for token in _TOKEN.finditer(text):
        if token[0] == "\n":
            line = token.end()
        elif token[0] in ("[", "{"):
            if depth == 0 and not text[line : token.start()].strip():
                starts.append(line)
            depth += 1
        elif token[0] in ("]", "}"):
            depth -= 1
    blocks: list[_Block] = []
    for begin, end in zip(starts, [*starts[1:], len(text)], strict=True):
        lines = text[begin:end].splitlines(keepends=True)
        first = last = 1 if blocks else 0
        for k, one in enumerate(lines[first:], first + 1):
            last = k if one.strip() and not one.lstrip().startswith("#") else last
        head, body, tail = ("".join(part) for part in (lines[:first], lines[first:last], lines[last:]))
        blocks.append(_Block(head, tomlkit.parse(body), tail))
        if head:
            _hang(blocks[0], tomllib.loads(head.strip()), blocks[-1])
    return blocks


def _hang(root: _Block, header: Mapping[str, Any], block: _Block) -> None:
    """Hang a block below those through which its header, read as TOML, leads."""
    at, [(key, inner)] = root, header.items()
    while isinstance(inner, Mapping) and inner:
        found = at.below.setdefault(key, _Block())
        at = found[-1] if isinstance(found, list) else found
        [(key, inner)] = inner.items()
    if isinstance(inner, list):
        at.below.setdefault(key, []).append(block)
    else:
        at.below[key] = block


@dataclass(eq=False)
class _Edit:
    """Changes of the blocks of one text."""

    blocks: list[_Block]

    def put(self, table: Any, before: Mapping[str, Any], after: Mapping[str, Any]) -> None:
        """Write the difference of two tables into a block or an inline table."""
        below, keys = (table.below, table.content) if isinstance(table, _Block) else ({}, table)
        for key in (key for key in dict.fromkeys((*before, *after)) if before.get(key) != after.get(key)):
            old: Any = before.get(key)
            new: Any = after.get(key)
            there: Any = below[key] if key in below else None if keys is None else keys.get(key)
            if isinstance(there, _Block | MutableMapping) and isinstance(new, Mapping):
                self.put(there, old or {}, new)
            elif _are_tables(there) and _are_tables(new):
                self._put_list(key, there, old or [], new)
            elif key in below and new is None:
                self._remove(there if isinstance(there, list) else [there])
            elif key in below or keys is None:
                raise ValueError(f"the text has no place for {key!r}")
            elif new is None:
                keys.pop(key, None)
            elif table is self.blocks[0] and there is None and (isinstance(new, Mapping) or _are_tables(new)):
                self._append(f"[{key}]", [new]) if isinstance(new, Mapping) else self._append(
                    f"[[{key}]]", new
                )
            else:
                keys[key] = inline(new)

    def _put_list(self, key: str, there: Any, old: Sequence[Any], new: Sequence[Any]) -> None:
        """Write the difference of two lists of tables."""
        names = [item.get("name") for item in new]
        keys = ("name",) if len(set(names)) == len(names) else ("name", "at")  # of effects at several places

        def identity(item: Any) -> tuple[Any, ...]:
            return tuple((item.content if isinstance(item, _Block) else item).get(key) for key in keys)

        before, stand = ({identity(item): item for item in items} for items in (old, there))
        wanted = [identity(item) for item in new]
        gone = [k for k, item in enumerate(there) if identity(item) not in wanted]
        added = [item for item in new if identity(item) not in stand and before.get(identity(item)) != item]
        for name, item in zip(wanted, new, strict=True):
            if name in stand:
                self.put(stand[name], before.get(name, {}), item)
        if isinstance(there[0], _Block):
            self._append(f"[[{key}]]", added, after=list(there[-1].within())[-1])
            self._remove([there[k] for k in gone])
        else:
            there.extend(map(inline, added))
            for k in reversed(gone):
                del there[k]

    def _append(self, header: str, tables: Sequence[Mapping[str, Any]], after: _Block | None = None) -> None:
        """Put new blocks behind another one, by default the last; remarks at its end stay behind them."""
        at = self.blocks.index(after or self.blocks[-1])
        for table in tables:
            last = self.blocks[at]
            new = _Block(header + "\n", table_of(table), last.tail)
            last.tail, at = "\n", at + 1
            self.blocks.insert(at, new)

    def _remove(self, blocks: Sequence[_Block]) -> None:
        """Empty blocks and those below them; remarks at their ends are about what follows."""
        for block in (inner for outer in blocks for inner in outer.within()):
            block.header, block.content = "", {}


def _are_tables(value: Any) -> bool:
    return isinstance(value, list) and bool(value) and all(isinstance(v, Mapping | _Block) for v in value)
