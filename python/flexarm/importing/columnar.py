"""Parquet and Feather: tables in columns, by Arrow."""

from __future__ import annotations

from typing import Any

import numpy as np

from flexarm.importing.delimited_text import plain_array
from flexarm.importing.source import Array, Group, Source, Unreadable, needed


class ColumnarFile(Source):
    """A Parquet or Feather file; a column of lists of one length is a matrix."""

    def _is_parquet(self) -> bool:
        with self.path.open("rb") as file:
            return file.read(4) == b"PAR1"

    def names(self, topic: str | None) -> list[str]:
        """Return the names of the columns."""
        if topic is not None:
            raise Unreadable("topic", f"a table has no topics, got {topic!r}")
        if self._is_parquet():
            return list(needed("pyarrow.parquet", self.path).read_schema(self.path).names)
        return list(needed("pyarrow.feather", self.path).read_table(self.path, memory_map=True).column_names)

    def groups(self) -> list[Group]:
        """Return the only table."""
        return [Group(None, tuple(self.names(None)))]

    def array(self, topic: str | None, index: int) -> Array:
        """Return a column; of lists the matrix with one row an entry."""
        module = needed("pyarrow.parquet" if self._is_parquet() else "pyarrow.feather", self.path)
        name = self.names(topic)[index]
        column: Any = module.read_table(self.path, columns=[name])[name]
        found = plain_array(column)
        if found.dtype == object and len(found) and isinstance(found[0], np.ndarray | list):
            return np.stack(found.tolist(), axis=1)
        return found
