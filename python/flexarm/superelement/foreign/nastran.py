"""Matrices as Nastran writes them: DMIG entries in bulk or punch files, and OUTPUT4 files. Read by pyyeti.

DMIG names its freedoms: point and component, 0 for a scalar point. OUTPUT4 does not. A superelement run
writes the reduced stiffness, mass and damping under names that begin with K, M and B (KAAX, MAAX, BAAX; K2GG,
M2GG); K4 is structural damping, which is not viscous and not read. Source: MSC Nastran Quick Reference Guide,
entries DMIG, EXTSEOUT and module OUTPUT4.
"""

from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.reading import reading
from flexarm.superelement.foreign.labelled import Freedom, Labelled, MatrixFile


def read_dmig(path: Path) -> MatrixFile:
    """Read the square matrices of a bulk or punch file; symmetric ones may give one triangle.

    Raises
    ------
    InvalidFile
        If the file is damaged or holds no DMIG entry.
    InvalidParameter
        If pyyeti is not installed.
    """
    bulk = _pyyeti("bulk", path)
    found = _read(path, "DMIG", lambda: bulk.rddmig(str(path), square=True, follow_includes=False))
    if not found:
        raise InvalidFile(path, "DMIG", "holds no DMIG entry")
    matrices, ignored = {}, []
    for name, frame in found.items():
        values = np.asarray(frame.to_numpy())
        if frame.columns.nlevels != 2 or values.shape[0] != values.shape[1] or values.dtype.kind == "c":
            ignored.append(name.upper())
            continue
        rows = tuple(Freedom(int(point), int(component)) for point, component in frame.index)
        if rows != tuple(Freedom(int(p), int(c)) for p, c in frame.columns):
            raise InvalidFile(path, name.upper(), "must have the same freedoms in rows and columns")
        matrices[name.upper()] = Labelled(values.astype(float), rows)
    return MatrixFile(matrices, tuple(ignored))


def read_op4(path: Path) -> MatrixFile:
    """Read the square real matrices of an OUTPUT4 file, text or binary.

    Raises
    ------
    InvalidFile
        If the file is damaged or holds no matrix.
    InvalidParameter
        If pyyeti is not installed.
    """
    op4 = _pyyeti("op4", path)
    found = _read(path, "OUTPUT4", lambda: op4.read(str(path), into="dct", sparse=False))
    matrices, ignored = {}, []
    for name, values in found.items():
        if values.ndim != 2 or values.shape[0] != values.shape[1] or values.dtype.kind == "c":
            ignored.append(name.upper())
        else:
            matrices[name.upper()] = Labelled(np.asarray(values, dtype=float), None)
    if not matrices:
        raise InvalidFile(path, "OUTPUT4", "holds no real square matrix")
    return MatrixFile(matrices, tuple(ignored))


def _pyyeti(module: str, path: Path) -> Any:
    from importlib import import_module

    try:
        return import_module(f"pyyeti.nastran.{module}")
    except ImportError:
        what = f"reading {path.name} needs pyyeti, which is not installed: pip install flexarm[nastran]"
        raise InvalidParameter(what) from None


def _read(path: Path, kind: str, reader: Any) -> Any:
    with reading(path, kind, kind), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return reader()
