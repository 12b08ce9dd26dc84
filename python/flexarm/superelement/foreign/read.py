"""The format of a matrix file, and the choice of stiffness, mass and damping."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from flexarm.errors import InvalidFile
from flexarm.reading import reading, regular_file
from flexarm.superelement.foreign.abaqus import read_abaqus, read_storage
from flexarm.superelement.foreign.labelled import Labelled, MatrixFile
from flexarm.superelement.foreign.matrix_market import BANNER, read_matrix_market
from flexarm.superelement.foreign.nastran import read_dmig, read_op4

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

    Raises
    ------
    InvalidFile
        If it is none of the formats, or damaged.
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

    Raises
    ------
    InvalidFile
        If a file has no matrix for its role, or several.
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
        raise InvalidFile(
            file, role, f"holds no mass matrix (it holds {names}); name its file: --mass-matrix FILE"
        )
    few = "none" if not found else "several"
    raise InvalidFile(file, role, f"must be told, {few} of {names} begin with {_INITIAL[role]}: FILE:NAME")
