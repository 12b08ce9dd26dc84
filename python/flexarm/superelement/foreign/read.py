"""The format of a matrix file, and the choice of stiffness, mass and damping.

Nastran writes DMIG entries in bulk or punch files, and OUTPUT4 files, both read by pyyeti. DMIG names its
freedoms: point and component, 0 for a scalar point. OUTPUT4 does not. A superelement run writes the reduced
stiffness, mass and damping under names that begin with K, M and B (KAAX, MAAX, BAAX; K2GG, M2GG); K4 is
structural damping, which is not viscous and not read. Source: MSC Nastran Quick Reference Guide, entries
DMIG, EXTSEOUT and module OUTPUT4.
"""

from __future__ import annotations

import importlib
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.reading import reading, regular_file
from flexarm.superelement.foreign.abaqus import read_abaqus, read_storage
from flexarm.superelement.foreign.labelled import Freedom, Labelled, MatrixFile
from flexarm.superelement.foreign.matrix_market import BANNER, read_matrix_market

MATRIX_SUFFIXES = (".mtx", ".op4", ".pch", ".dmig", ".sti", ".mas")
"""Names of files that are taken for matrices; DMIG may stand in any bulk data file besides."""

_INITIAL = {"stiffness": "K", "mass": "M", "damping": "B"}
_OTHER_KINDS = ("K4",)  # structural damping


@dataclass(frozen=True, eq=False)
class Chosen:
    """The matrices of a part, and the names of those that were left unread."""

    stiffness: Labelled
    mass: Labelled
    damping: Labelled | None
    ignored: tuple[str, ...]


def read_matrix_file(path: Path) -> MatrixFile:
    """Return all matrices of a file.

    Raise InvalidFile if it is none of the formats, or damaged.
    """
    regular_file(path)
    suffix = path.suffix.lower()
    with reading(path, "matrices"):
        if suffix == ".op4":
            return read_op4(path)
        if suffix in (".sti", ".mas"):
            return read_storage(path)
        if suffix == ".mtx":
            with path.open("rb") as file:
                market = file.read(len(BANNER)) == BANNER.encode()
            return read_matrix_market(path) if market else read_abaqus(path)
        return read_dmig(path)


def choose(stiffness: str | Path, mass: str | Path | None, damping: str | Path | None) -> Chosen:
    """Choose stiffness, mass and damping from one file or several, each FILE or FILE:NAME.

    Raise InvalidFile if a file has no matrix for its role, or several.
    """
    file, name = _split(stiffness)
    held = read_matrix_file(file)
    K = _pick(file, held, "stiffness", name)
    if mass is None and (file.suffix.lower() == ".sti" and file.with_suffix(".mas").is_file()):
        mass = file.with_suffix(".mas")
    M, rest = (
        (_found(mass, "mass"), ()) if mass is not None else (_pick(file, held, "mass", ""), held.ignored)
    )
    C = None
    if damping is not None:
        C = _found(damping, "damping")
    elif _candidates(held, "damping"):
        C = _pick(file, held, "damping", "")
    others = tuple(n for n in held.matrices if n.startswith(_OTHER_KINDS))
    return Chosen(K, M, C, (*rest, *others))


def _found(source: str | Path, role: str) -> Labelled:
    file, name = _split(source)
    held = read_matrix_file(file)
    if len(held.matrices) == 1 and not name:  # the file was named for this role
        return next(iter(held.matrices.values()))
    return _pick(file, held, role, name)


def _split(source: str | Path) -> tuple[Path, str]:
    """Split FILE:NAME."""
    text = str(source)
    if Path(text).exists() or ":" not in text:
        return Path(text), ""
    file, _, name = text.rpartition(":")
    return (Path(file), name.upper()) if Path(file).exists() else (Path(text), "")


def _candidates(held: MatrixFile, role: str) -> list[str]:
    if role in held.matrices:
        return [role]
    initial = _INITIAL[role]
    return [n for n in held.matrices if n.startswith(initial) and not n.startswith(_OTHER_KINDS)]


def _pick(file: Path, held: MatrixFile, role: str, name: str) -> Labelled:
    names = ", ".join(n or "one without a name" for n in held.matrices)
    if name:
        if name not in held.matrices:
            raise InvalidFile(file, role, f"there is no matrix {name}; there are {names}")
        return held.matrices[name]
    if list(held.matrices) == [""] and role == "stiffness":
        return held.matrices[""]
    found = _candidates(held, role)
    if len(found) == 1:
        return held.matrices[found[0]]
    if role == "mass" and not found:
        what = f"holds no mass matrix (it holds {names}); name its file: --mass-matrix FILE"
        raise InvalidFile(file, role, what)
    few = "none" if not found else "several"
    raise InvalidFile(file, role, f"must be told, {few} of {names} begin with {_INITIAL[role]}: FILE:NAME")


def read_dmig(path: Path) -> MatrixFile:
    """Read the square matrices of a bulk or punch file; symmetric ones may give one triangle.

    Raise InvalidFile if the file is damaged or holds no DMIG entry, and InvalidParameter if pyyeti is not
    installed.
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

    Raise InvalidFile if the file is damaged or holds no matrix, and InvalidParameter if pyyeti is not
    installed.
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
    try:
        return importlib.import_module(f"pyyeti.nastran.{module}")
    except ImportError:
        what = f"reading {path.name} needs pyyeti, which is not installed: pip install flexarm[nastran]"
        raise InvalidParameter(what) from None


def _read(path: Path, kind: str, reader: Any) -> Any:
    with reading(path, kind, kind), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return reader()
