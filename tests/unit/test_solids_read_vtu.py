"""VTU files: masks are sets and groups; what meshlane would lose is refused."""

import meshlane
import numpy as np
import pytest

from flexarm import InvalidFile, InvalidParameter, read_mesh
from flexarm.solids import Block, Material, revolved, ring

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
BLOCKS = [Block("disc", 0, 0.05, 0, 0.01), Block("wall", 0.04, 0.05, 0.01, 0.05)]


def test_a_saved_mesh_comes_back_as_it_was(tmp_path):
    part = revolved(BLOCKS, size=0.02)
    mesh = read_mesh(part.save(tmp_path / "part.vtu"))
    assert (mesh.points == part.points).all()
    assert (mesh.cells["hex20"] == part.cells["hex20"]).all()
    assert {k: list(v) for k, v in mesh.point_sets.items()} == {
        k: list(v) for k, v in part.point_sets.items()
    }
    assert {k: list(v["hex20"]) for k, v in mesh.cell_groups.items()} == {
        k: list(v["hex20"]) for k, v in part.cell_groups.items()
    }


def test_saving_replaces_nothing_unasked(tmp_path):
    part = ring(0.1, 0.2, 0.1, size=0.1)
    path = part.save(tmp_path / "part.vtu")
    with pytest.raises(InvalidParameter, match="exists; force = True replaces it"):
        part.save(path)
    assert part.save(path, force=True) == path
    assert [file.name for file in tmp_path.iterdir()] == ["part.vtu"]
    with pytest.raises(InvalidParameter, match=r"must end in .vtu, got 'part.stl'"):
        part.save(tmp_path / "part.stl")


def test_numbers_on_cells_are_groups_and_on_faces_sets(tmp_path):
    part = ring(0.1, 0.2, 0.1, size=0.1, around=8, order=1)
    faces = part.cells["hex8"][:2, :4]
    material = [np.array([4] * 5 + [9] * 3), np.array([6, 6])]
    written = meshlane.Mesh(
        part.points,
        [("hexahedron", part.cells["hex8"]), ("quad", faces)],
        cell_data={"MaterialIds": material, "stress": [np.zeros(8), np.zeros(2)]},
        point_data={"vtkOriginalPointIds": np.arange(part.n_points), "temperature": np.zeros(part.n_points)},
    )
    meshlane.write(tmp_path / "part.vtu", written)
    mesh = read_mesh(tmp_path / "part.vtu", materials={"MaterialIds-4": STEEL})
    assert {k: list(v["hex8"]) for k, v in mesh.cell_groups.items()} == {
        "MaterialIds-4": [0, 1, 2, 3, 4],
        "MaterialIds-9": [5, 6, 7],
    }
    assert {k: list(v) for k, v in mesh.point_sets.items()} == {"MaterialIds-6": sorted(set(faces.ravel()))}


def test_several_pieces_are_refused(tmp_path):
    path = ring(0.1, 0.2, 0.1, size=0.1).save(tmp_path / "part.vtu")
    text = path.read_text()
    piece = text[text.index("<Piece") : text.index("</Piece>") + len("</Piece>")]
    path.write_text(text.replace(piece, piece + piece))
    with pytest.raises(InvalidFile, match=r"part.vtu: UnstructuredGrid: holds 2 pieces; save it as one"):
        read_mesh(path)


def test_cells_that_would_be_lost_are_an_error(tmp_path):
    """No reader knows VTK's type 99; meshlane alone would leave those cells out."""
    path = tmp_path / "part.vtu"
    path.write_text(
        '<VTKFile type="UnstructuredGrid" version="0.1" byte_order="LittleEndian"><UnstructuredGrid>'
        '<Piece NumberOfPoints="4" NumberOfCells="2"><Points>'
        '<DataArray type="Float64" NumberOfComponents="3" format="ascii">0 0 0 1 0 0 0 1 0 0 0 1</DataArray>'
        "</Points><Cells>"
        '<DataArray type="Int64" Name="connectivity" format="ascii">0 1 2 3 0 1 2 3</DataArray>'
        '<DataArray type="Int64" Name="offsets" format="ascii">4 8</DataArray>'
        '<DataArray type="Int64" Name="types" format="ascii">10 99</DataArray></Cells></Piece>'
        "</UnstructuredGrid></VTKFile>"
    )
    with pytest.raises(InvalidFile, match=r"Cells: 1 of 2 cells are of types that cannot be read"):
        read_mesh(path)
