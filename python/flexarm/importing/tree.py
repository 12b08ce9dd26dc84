"""Logs that are trees of arrays: a column is a path, from the topic or from the root."""

from __future__ import annotations

from abc import abstractmethod
from collections.abc import Sequence
from pathlib import Path

from flexarm.arm.consistency import missing
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import Array, Group, Request, Source, Unreadable


class Tree(Source):
    """A file whose arrays lie in groups or structs.

    `separator` stands between the parts of a path.
    """

    separator = "."

    def __init__(self, path: Path, dialect: Dialect, requests: Sequence[Request]) -> None:
        super().__init__(path, dialect, requests)
        self._arrays: dict[str, Array] = {}
        self.shapes = self.leaves()

    @abstractmethod
    def leaves(self) -> dict[str, tuple[int, ...]]:
        """Return path -> shape of all arrays of numbers."""

    def leaf(self, path: str) -> Array:
        """Return an array: what `leaves` kept of it, unless a format reads each when it is asked for."""
        return self._arrays[path]

    def names(self, topic: str | None) -> list[str]:
        """Return paths from the topic, "" if it is an array itself, and then all from the root."""
        paths = list(self.shapes)
        if topic is None:
            return paths
        topic = topic.strip(self.separator)
        start = topic + self.separator
        below = [path.removeprefix(start) for path in paths if path.startswith(start)]
        below = ["", *below] if topic in paths else below
        if not below:
            raise Unreadable("topic", missing("variable or group", topic, paths))
        return [*below, *(path for path in paths if path not in below)]

    def array(self, topic: str | None, index: int) -> Array:
        """Return an array by its place in `names`."""
        return self.leaf(self.path_of(topic, self.names(topic)[index]))

    def length(self, matrix: Array) -> int | None:
        """Return the longer side of a matrix: a tree may hold it either way."""
        return max(matrix.shape, default=1)

    def path_of(self, topic: str | None, name: str) -> str:
        """Return the path from the root."""
        start = "" if topic is None else topic.strip(self.separator)
        full = f"{start}{self.separator}{name}" if start and name else start or name
        return full if full in self.shapes else name

    def find(self, topic: str | None, column: str | int, key: str) -> tuple[int, int | None]:
        """Return the place of a path; numbers count rows of the topic's own matrix, else paths below it."""
        names = self.names(topic)
        if isinstance(column, int) and names and names[0] == "":
            return 0, column - 1 if len(self.shapes[self.path_of(topic, "")]) > 1 or column > 1 else None
        if isinstance(column, str):
            column = column.strip(self.separator)
        return super().find(topic, column, key)

    def groups(self) -> list[Group]:
        """Return arrays by the struct or group that they lie in; rows of matrices one by one."""
        found: dict[str, list[str]] = {}
        for path, shape in self.shapes.items():
            parent, _, name = path.rpartition(self.separator)
            rows = [1] if len(shape) < 2 else [] if len(shape) > 2 else range(1, min(shape) + 1)
            names = [
                f"{name}[{row}]" if len(shape) == 2 else name for row in rows if max(shape, default=0) > 1
            ]
            found.setdefault(parent, []).extend(names)
        return [Group(topic or None, tuple(names)) for topic, names in found.items() if names]
