"""Files that meshlane reads, a kept-up fork of meshio; its failures become errors that name the file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.errors import InvalidFile
from flexarm.solids.reading.content import Block


def read_by(
    reader: Callable[[str], Any], path: Path, what: str, remedies: Mapping[str, str] | None = None
) -> Any:
    """The mesh that a reader of meshlane makes of a file.

    Parameters
    ----------
    reader : callable
        Such as `meshlane.gmsh.read`; `meshlane.read` would leave the program where it fails.
    path : path
        The file.
    what : str
        What it should be.
    remedies : mapping, optional
        Part of a message of the reader -> what the user can do.
    """
    said = StringIO()
    try:
        with redirect_stderr(said):
            return reader(str(path))
    except Exception as error:  # a reader fails in any way on a file that is cut off or of another kind
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        remedy = next((f"; {told}" for part, told in (remedies or {}).items() if part in reason), "")
        raise InvalidFile(path, "", f"cannot be read as a {what} ({reason}){remedy}") from error


def blocks_of(mesh: Any) -> list[Block]:
    """The blocks of a meshlane mesh, their cells numbered from 1."""
    blocks, count = [], 0
    for block in mesh.cells:
        n = len(block.data)
        nodes = np.asarray(block.data) if not block.type.startswith("poly") else np.empty((0, 1), np.int64)
        blocks.append(Block(block.type, nodes, np.arange(count + 1, count + 1 + n)))
        count += n
    return blocks
