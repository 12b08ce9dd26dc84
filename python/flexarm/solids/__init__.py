"""Parts as meshes of solid cells: read from files, made here, checked.

`read_mesh` reads Abaqus and CalculiX (.inp), Gmsh (.msh), VTU and Nastran bulk data; `revolved`, `ring`,
`tube`, `disc`, `shaft` and `flange` make parts that revolve. All give a `SolidMesh`.
"""

from flexarm.material import Material
from flexarm.solids.cell_types import CELL_TYPES, CellType
from flexarm.solids.mesh import SolidMesh
from flexarm.solids.reading import read_mesh
from flexarm.solids.revolve import Block, BoltCircle, Patch, disc, flange, revolved, ring, shaft, tube

__all__ = [
    "CELL_TYPES",
    "Block",
    "BoltCircle",
    "CellType",
    "Material",
    "Patch",
    "SolidMesh",
    "disc",
    "flange",
    "read_mesh",
    "revolved",
    "ring",
    "shaft",
    "tube",
]
