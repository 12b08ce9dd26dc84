"""Matrix Market files (.mtx): real matrices, symmetric or general, without names of freedoms.

Source: R. F. Boisvert, R. Pozo, K. A. Remington, The Matrix Market exchange formats, NISTIR 5935, 1996.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flexarm.errors import InvalidFile
from flexarm.superelement.foreign.labelled import Labelled, MatrixFile

BANNER = "%%MatrixMarket"


def read_matrix_market(path: Path) -> MatrixFile:
    """The one matrix of a Matrix Market file.

    Raises
    ------
    InvalidFile
        If the file is damaged, or its matrix not real and square.
    """
    from scipy.io import mmread
    from scipy.sparse import issparse

    try:
        matrix = mmread(path)
    except (ValueError, OverflowError, OSError) as error:
        raise InvalidFile(path, "file", f"cannot be read as Matrix Market: {error}") from None
    dense = matrix.toarray() if issparse(matrix) else np.asarray(matrix)
    if dense.dtype.kind not in "fiu" or dense.ndim != 2 or dense.shape[0] != dense.shape[1]:
        raise InvalidFile(path, "matrix", f"must be real and square, got {dense.dtype} {dense.shape}")
    return MatrixFile({"": Labelled(dense.astype(float), None)})
