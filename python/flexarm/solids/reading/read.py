"""One call for every kind of mesh file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from pathlib import Path

import numpy as np

from flexarm.arguments import MATERIAL, NUMBER, takes
from flexarm.errors import InvalidFile
from flexarm.material import Material
from flexarm.reading import regular_file
from flexarm.solids.mesh import SolidMesh
from flexarm.solids.reading.content import Content
from flexarm.solids.reading.part import part_in
from flexarm.solids.reading.units import check_unit

#: Ending of a file's name -> what it is, and the module with `content(path)` that reads it.
FORMATS = {
    ".inp": ("Abaqus or CalculiX input", "abaqus"),
    ".msh": ("Gmsh mesh", "gmsh"),
    ".vtu": ("VTK unstructured grid", "vtu"),
    ".bdf": ("Nastran bulk data", "nastran"),
    ".nas": ("Nastran bulk data", "nastran"),
    ".fem": ("Nastran bulk data (OptiStruct)", "nastran"),
    ".dat": ("Nastran bulk data", "nastran"),
}


@takes(materials=MATERIAL, merge=NUMBER)
def read_mesh(
    path: str | Path,
    unit: str = "m",
    materials: Mapping[str, Material] | Material | None = None,
    *,
    merge: float = 0.0,
) -> SolidMesh:
    """Read a part from the mesh file of another program.

    Parameters
    ----------
    path : path
        Abaqus or CalculiX `.inp`, Gmsh `.msh` (2.2, 4.1), VTK `.vtu`, Nastran bulk data `.bdf`, `.nas`,
        `.fem`, `.dat`.
    unit : str
        Unit of length of the file: "m", "mm", "cm", "in", .. It is never guessed. With "mm" the materials in
        the file are taken to be in MPa and t/mm3, with "m" in Pa and kg/m3.
    materials : mapping or Material, optional
        Group -> material, in SI, in place of those in the file; or one material for all cells that have none.
    merge : float
        Make points closer than this one [m].

    Returns
    -------
    mesh : SolidMesh
        In m; not yet checked: call `check()`, read `warnings`.

    Raises
    ------
    InvalidFile
        If the file is not what it should be, holds cells that flexarm has no element for, or a material
        without what is needed; the message says where.

    Examples
    --------
    >>> import flexarm
    >>> from flexarm.solids import Material
    >>> steel = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
    >>> part = flexarm.read_mesh("hub.inp", unit="mm", materials=steel).check()  # doctest: +SKIP
    """
    check_unit(unit)
    file = regular_file(path)
    given = materials if isinstance(materials, Mapping) else {}
    with np.errstate(over="ignore", invalid="ignore"):  # numbers out of range are refused as such
        mesh = part_in(_reader(file)(file), str(path), unit, given)
    if isinstance(materials, Material):
        mesh = mesh.with_materials(materials)
    return mesh.merged(merge) if merge else mesh


def _reader(file: Path) -> Callable[[Path], Content]:
    known = FORMATS.get(file.suffix.lower())
    if known is None:
        what = (
            f"files ending in {file.suffix!r} are not read; allowed are {', '.join(FORMATS)} "
            "(`meshlane convert` writes .vtu from many others)"
        )
        raise InvalidFile(file, "path", what)
    module = import_module(f"flexarm.solids.reading.{known[1]}")
    content: Callable[[Path], Content] = module.content
    return content
