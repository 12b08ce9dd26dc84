"""`flexarm reduce --grids`: matrices that another program reduced."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from flexarm.cli.interfaces import read_interfaces
from flexarm.cli.options import blame
from flexarm.errors import InvalidFile

if TYPE_CHECKING:
    from flexarm.superelement import SuperElement

MATRIX_SUFFIXES = (".mtx", ".op4", ".pch", ".dmig", ".sti", ".mas")


def refuse_for_matrices(
    file: Path,
    grids: Path | None,
    modes: int | None,
    max_frequency: float | None,
    material: list[str] | None,
    picture: Path | None,
    damping_ratio: float,
    recovery: bool,
) -> None:
    """Refuse options that are for meshes only, and matrices whose points nobody states."""
    if grids is None:
        what = "is needed: a matrix holds no coordinates; name the bulk data or input deck with its points"
        raise InvalidFile(file, "--grids", what)
    given = {
        "--modes": modes is not None,
        "--max-frequency": max_frequency is not None,
        "--material": bool(material),
        "--picture": picture is not None,
        "--damping-ratio": damping_ratio != 0,
        "--recovery": recovery,
    }
    for option in (option for option, there in given.items() if there):
        raise InvalidFile(
            "command line", option, "is for meshes; with --grids the matrices are reduced already"
        )


def accepted(
    file: Path,
    grids: Path | None,
    interface: list[str] | None,
    order: str | None,
    mass_matrix: str | None,
    damping_matrix: str | None,
    unit: str,
    mass: float | None,
    tolerance: float | None,
) -> SuperElement:
    """Return the matrices as a super-element."""
    from flexarm.superelement.foreign import accept_matrices

    assert grids is not None
    form = "NAME=POINT or NAME=POINT,POINT,... with --grids"
    named: dict[str, list[int]] = {}
    for name, points in read_interfaces(interface, form).items():
        try:
            named[name] = [int(point) for point in points.removesuffix(":rigid").split(",")]
        except ValueError:
            raise InvalidFile("command line", "--interface", f"must be {form}, got {name}={points}") from None
    with blame(file):
        return accept_matrices(
            file,
            mass_matrix,
            grids=grids,
            order=order,
            damping_matrix=damping_matrix,
            interfaces=named,
            unit=unit,
            mass=mass,
            tolerance=tolerance,
        )
