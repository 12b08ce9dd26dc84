"""Super-elements in the files of other programs, chosen by the ending of the name."""

from __future__ import annotations

from pathlib import Path

from flexarm.arguments import PATH, TEXT, Kind, takes
from flexarm.errors import InvalidFile
from flexarm.superelement import SuperElement

NASTRAN = (".bdf", ".dat", ".nas")
ENDINGS = (".mat", *NASTRAN, ".inp")
"""Simscape, Nastran, Abaqus."""
PART = Kind("a SuperElement, such as SuperElement.load gives", lambda value: isinstance(value, SuperElement))


@takes(element=PART, out=PATH, unit=TEXT)
def export_part(element: SuperElement, out: str | Path, unit: str = "m") -> list[Path]:
    """Write a super-element for Simscape (.mat), Nastran (.bdf, .dat, .nas) or Abaqus (.inp).

    Parameters
    ----------
    element : SuperElement
        The part.
    out : str or Path
        The file; Abaqus's matrices stand in files beside it.
    unit : {"m", "mm"}
        m: m, kg, s, N. mm: mm, t, s, N, MPa. Simscape takes m.

    Returns
    -------
    list of Path
        The files.

    Raises
    ------
    InvalidFile, InvalidParameter
        If the ending or the unit is not known, or a file cannot be written.
    """
    path = Path(out)
    ending = path.suffix.lower()
    if ending not in ENDINGS:
        what = f"must end in {', '.join(ENDINGS)} (Simscape, Nastran, Abaqus), got {path.name!r}"
        raise InvalidFile(path, "output", what)
    if ending == ".mat":
        if unit != "m":
            raise InvalidFile(path, "unit", f"must be m for Simscape, got {unit!r}")
        from flexarm.export.simscape import write_simscape

        return write_simscape(element, path)
    if ending in NASTRAN:
        from flexarm.export.nastran import write_nastran

        return write_nastran(element, path, unit)
    from flexarm.export.abaqus import write_abaqus

    return write_abaqus(element, path, unit)
