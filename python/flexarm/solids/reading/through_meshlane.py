"""Files that meshlane reads, a kept-up fork of meshio; its failures become errors that name the file."""

from __future__ import annotations

from collections.abc import Callable
from contextlib import redirect_stderr
from io import StringIO
from pathlib import Path
from typing import Any
from warnings import catch_warnings, filterwarnings

import numpy as np

from flexarm.errors import InvalidFile
from flexarm.solids.reading.content import Block, Content


def read_by(reader: Callable[[Path], Content], path: Path, what: str) -> Content:
    """Read a file that should be `what` with a reader that uses meshlane.

    It may call the readers of meshlane's formats; `meshlane.read` would leave the program where it fails.
    """
    try:
        with redirect_stderr(StringIO()), catch_warnings():
            filterwarnings("ignore")  # of numbers that damage made, which are checked later
            filterwarnings(
                "error", message="string or file could not be read"
            )  # numpy, in the middle of text
            return reader(path)
    except InvalidFile:
        raise
    except Exception as error:  # a reader fails in any way on a file that is cut off or of another kind
        reason = " ".join(f"{type(error).__name__}: {error}".split())
        raise InvalidFile(path, "mesh", f"cannot be read as a {what} ({reason})") from error


def blocks_of(mesh: Any) -> list[Block]:
    """Return the blocks of a meshlane mesh, their cells numbered from 1."""
    blocks, count = [], 0
    for block in mesh.cells:
        n = len(block.data)
        nodes = np.asarray(block.data) if not block.type.startswith("poly") else np.empty((0, 1), np.int64)
        blocks.append(Block(block.type, nodes, np.arange(count + 1, count + 1 + n)))
        count += n
    return blocks
