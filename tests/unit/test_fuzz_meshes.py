"""Whatever a mesh file holds, reading and checking it gives a mesh or an `InvalidFile`, nothing else."""

from pathlib import Path

import pytest
from fuzzing import Changes, edited, edits, fuzzed
from hypothesis import given
from mesh_files import ABAQUS_ASSEMBLY, ABAQUS_BAR, GMSH_4, GMSH_TETRAHEDRA, NASTRAN_BAR

from flexarm.errors import InvalidFile
from flexarm.solids import Material, read_mesh, ring

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
PIECES = [
    *(
        "",
        "0",
        "-1",
        "1e999",
        "nan",
        "inf",
        "x",
        ",",
        ",,",
        "\n",
        "*",
        "**",
        "$",
        "+",
        "=",
        '"',
        "<",
        "/>",
        "  ",
    ),
    *(
        "99999999999999999999",
        "999999999",
        "THRU",
        "generate",
        "*END PART\n",
        "*INSTANCE\n",
        "*ELEMENT\n",
        ".",
    ),
    *("\x00", "é", "²", "*NSET, GENERATE\n", "GRID", "CHEXA,", "$Nodes\n", "$EndElements\n", "<Piece>", "8"),
]
SPOILED = edits(PIECES)


@pytest.fixture(scope="module")
def vtu(tmp_path_factory: pytest.TempPathFactory) -> str:
    """A ring as text."""
    import meshlane

    part = ring(0.1, 0.2, 0.1, size=0.1, around=8, order=1)
    path = tmp_path_factory.mktemp("vtu") / "ring.vtu"
    mesh = meshlane.Mesh(
        part.points, [("hexahedron", part.cells["hex8"])], point_data={"top": part.points[:, 2] > 0}
    )
    mesh.point_data = {"top": mesh.point_data["top"].astype("int32")}
    meshlane.vtu.write(str(path), mesh, binary=False)
    return path.read_text()


def _read_or_refused(path: Path, text: str, changes: Changes) -> None:
    path.write_bytes(edited(text, changes))
    try:
        mesh = read_mesh(path, unit="mm", materials=STEEL, merge=1e-7)
        assert mesh.describe()
        mesh.check()
        assert mesh.warnings is not None
    except InvalidFile as error:
        assert str(error).startswith(f"{path.parent}")
        assert all(problem.where and problem.what for problem in error.problems)


@pytest.mark.parametrize(
    ("ending", "text"),
    [
        (".inp", ABAQUS_BAR),
        (".inp", ABAQUS_ASSEMBLY),
        (".bdf", NASTRAN_BAR),
        (".msh", GMSH_TETRAHEDRA),
        (".msh", GMSH_4),
    ],
    ids=["abaqus", "assembly", "nastran", "gmsh 2", "gmsh 4"],
)
@fuzzed(150)
@given(changes=SPOILED)
def test_a_spoiled_mesh_is_read_or_refused(tmp_path: Path, ending: str, text: str, changes: Changes) -> None:
    _read_or_refused(tmp_path / f"part{ending}", text, changes)


@fuzzed(150)
@given(changes=SPOILED)
def test_a_spoiled_vtu_is_read_or_refused(tmp_path: Path, vtu: str, changes: Changes) -> None:
    _read_or_refused(tmp_path / "part.vtu", vtu, changes)
