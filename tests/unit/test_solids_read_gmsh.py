"""Gmsh files as Gmsh writes them: physical groups, numbers, orders of nodes, what is refused."""

import meshlane
import numpy as np
import pytest
from mesh_files import GMSH_4
from mesh_files import GMSH_TETRAHEDRA as TWO_TETRAHEDRA
from solid_volume import volume

from flexarm import InvalidFile, InvalidParameter, read_mesh
from flexarm.solids import Material, ring

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


def test_physical_volumes_are_groups_and_all_else_sets(tmp_path):
    path = tmp_path / "two.msh"
    path.write_text(TWO_TETRAHEDRA)
    mesh = read_mesh(path)
    assert list(mesh.cells["tet4"].ravel()) == [0, 1, 2, 3, 1, 4, 2, 3]
    assert {name: list(group["tet4"]) for name, group in mesh.cell_groups.items()} == {"body": [0, 1]}
    assert {name: list(points) for name, points in mesh.point_sets.items()} == {
        "foot": [0, 1, 2],
        "point-4": [3],
    }


def test_a_cell_in_two_groups_which_version_2_writes_twice_is_one(tmp_path):
    text = TWO_TETRAHEDRA.replace('2\n2 7 "foot"', '3\n3 2 "half"\n2 7 "foot"')
    text = text.replace("$Elements\n4\n", "$Elements\n5\n").replace(
        "$EndElements", "32 4 2 2 1 2 8 3 5\n$EndElements"
    )
    path = tmp_path / "two.msh"
    path.write_text(text)
    mesh = read_mesh(path, materials=STEEL).check()
    assert list(mesh.cells["tet4"].ravel()) == [0, 1, 2, 3, 1, 4, 2, 3]
    assert list(mesh.cell_numbers["tet4"]) == [20, 31]
    assert {name: list(group["tet4"]) for name, group in mesh.cell_groups.items()} == {
        "all": [0, 1],
        "body": [0, 1],
        "half": [1],
    }


def test_version_4_gives_the_same_part(tmp_path):
    path = tmp_path / "two.msh"
    path.write_text(GMSH_4)
    mesh = read_mesh(path)
    assert list(mesh.cells["tet4"].ravel()) == [0, 1, 2, 3, 1, 4, 2, 3]
    assert list(mesh.cell_numbers["tet4"]) == [20, 31]
    assert list(mesh.cell_groups["body"]["tet4"]) == [0, 1]
    assert list(mesh.point_set("foot")) == [0, 1, 2]


def test_a_reversed_surface_is_in_its_physical_group(tmp_path):
    """Gmsh writes `Physical Surface("foot") = {-3}` as group -7 of surface 3."""
    path = tmp_path / "two.msh"
    path.write_text(GMSH_4.replace("1 1 1 1 7 0", "1 1 1 1 -7 0"))
    assert list(read_mesh(path).point_set("foot")) == [0, 1, 2]
    path.write_text(TWO_TETRAHEDRA.replace("10 2 2 7 ", "10 2 2 -7 "))
    assert list(read_mesh(path).point_set("foot")) == [0, 1, 2]


def test_a_partitioned_mesh_keeps_its_physical_groups(tmp_path):
    """Parts of entities state their number, dimension and number of the whole, partitions, box, groups."""
    partitioned = """$PartitionedEntities
2
1
9 1
1 0 1 2
7 0 3 1 2 0 0 0 0
5 2 3 1 1 0 0 0 1 1 1 1 7 0
6 3 2 2 1 2 0 0 0 1 1 1 1 1 1 5
8 3 2 1 1 0 0 0 1 1 1 1 1 1 5
$EndPartitionedEntities
$Nodes"""
    text = GMSH_4.replace("$Nodes", partitioned, 1)
    cells = text.replace("2 3 10 31", "3 3 10 31").replace("2 3 2 1\n", "2 5 2 1\n")
    path = tmp_path / "two.msh"
    path.write_text(
        cells.replace("3 2 4 2\n20 1 2 3 5\n31 2 8 3 5", "3 6 4 1\n20 1 2 3 5\n3 8 4 1\n31 2 8 3 5")
    )
    mesh = read_mesh(path)
    assert list(mesh.point_set("foot")) == [0, 1, 2]
    assert list(mesh.cell_groups["body"]["tet4"]) == [0, 1]


@pytest.mark.parametrize("text", [TWO_TETRAHEDRA, GMSH_4], ids=["2.2", "4.1"])
def test_a_cell_that_names_a_missing_node_is_refused(tmp_path, text):
    """The reader alone would take the last node for it, without a word."""
    path = tmp_path / "two.msh"
    path.write_text(text.replace("2 8 3 5", "2 7 3 5"))
    with pytest.raises(InvalidFile, match=r"cells: cell 31 names a node that is not in the file"):
        read_mesh(path)


def test_messages_use_the_numbers_of_the_file(tmp_path):
    path = tmp_path / "two.msh"
    path.write_text(TWO_TETRAHEDRA)
    assert list(read_mesh(path).cell_numbers["tet4"]) == [20, 31]


@pytest.mark.parametrize("text", [TWO_TETRAHEDRA, GMSH_4], ids=["2.2", "4.1"])
def test_points_keep_their_numbers(tmp_path, text):
    path = tmp_path / "two.msh"
    path.write_text(text)
    assert list(read_mesh(path).point_numbers) == [1, 2, 3, 5, 8]


def test_cells_in_no_physical_group_are_read_beside_others(tmp_path):
    """As Gmsh's "Save all elements" writes them."""
    path = tmp_path / "two.msh"
    path.write_text(GMSH_4.replace("1 1 1 1 7 0", "1 1 1 0 0"))
    mesh = read_mesh(path)
    assert list(mesh.cells["tet4"].ravel()) == [0, 1, 2, 3, 1, 4, 2, 3]
    assert list(mesh.cell_groups) == ["body"]
    assert not mesh.point_sets


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ("1 5 1 8", "1 4 1 8", r"\$Nodes: declares 4 entries, its blocks hold 5"),
        ("2 3 10 31", "2 2 10 31", r"\$Elements: declares 2 entries, its blocks hold 3"),
        ("3 2 0 5", "3 2 1 5", r"\$Nodes: holds parametric coordinates; save without"),
        ("3 2 4 2", "3 2 99 2", r"\$Elements: holds cells of the unknown type 99"),
        ("4.1 0 8", "4.0 0 8", r"\$MeshFormat: must be version 2.2 or 4.1, got 4.0"),
        ("4.1 0 8", "4 0 8", r"\$MeshFormat: must be version 2.2 or 4.1, got 4;"),
    ],
)
def test_a_section_at_fault_is_named(tmp_path, old, new, told):
    path = tmp_path / "two.msh"
    path.write_text(GMSH_4.replace(old, new))
    with pytest.raises(InvalidFile, match=told):
        read_mesh(path)


def test_points_that_no_cell_uses_are_left_out(tmp_path):
    path = tmp_path / "two.msh"
    path.write_text(TWO_TETRAHEDRA)
    assert read_mesh(path).n_points == 5


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("kind", ["gmsh", "gmsh22"])
@pytest.mark.parametrize("binary", [True, False], ids=["binary", "text"])
def test_hexahedra_come_back_as_they_were_written(tmp_path, order, kind, binary):
    """Both versions, binary and text; a wrong order of middle nodes would change the volume."""
    part = ring(0.1, 0.2, 0.1, size=0.1, order=order)
    name = "hexahedron" if order == 1 else "hexahedron20"
    nodes = next(iter(part.cells.values()))
    written = meshlane.Mesh(
        part.points * 1000,
        [(name, nodes)],
        cell_data={"gmsh:physical": [np.full(len(nodes), 3)], "gmsh:geometrical": [np.ones(len(nodes), int)]},
        field_data={"ring": np.array([3, 3])},
        point_data={"gmsh:dim_tags": np.tile([3, 1], (part.n_points, 1))} if kind == "gmsh" else {},
    )
    meshlane.write(tmp_path / "ring.msh", written, file_format=kind, binary=binary)
    mesh = read_mesh(tmp_path / "ring.msh", unit="mm")
    assert (mesh.cells[next(iter(part.cells))] == nodes).all()
    assert np.abs(mesh.points - part.points).max() < 1e-15
    assert volume(mesh) == pytest.approx(volume(part), rel=1e-12)
    assert list(mesh.cell_groups) == ["ring"]


def test_a_name_of_two_groups_is_refused(tmp_path):
    path = tmp_path / "two.msh"
    path.write_text(TWO_TETRAHEDRA.replace('"foot"', '"body"'))
    with pytest.raises(
        InvalidFile, match=r"two.msh: \$PhysicalNames: 'body' is the name of surface 7, volume 1"
    ):
        read_mesh(path)


def test_other_solids_are_named_with_what_is_allowed(tmp_path):
    path = tmp_path / "prism.msh"
    meshlane.write(
        path,
        meshlane.Mesh(np.eye(6)[:, :3] * 1.0, [("wedge", [[0, 1, 2, 3, 4, 5]])]),
        file_format="gmsh22",
        binary=False,
    )
    with pytest.raises(InvalidFile, match=r"1 of type wedge; allowed are 4- and 10-node tetrahedra, 8- and"):
        read_mesh(path)


def test_27_node_hexahedra_are_read_as_20_node_ones(tmp_path):
    part = ring(0.1, 0.2, 0.1, size=0.1)
    nodes = part.cells["hex20"]
    inner = part.n_points + np.arange(7 * len(nodes)).reshape(-1, 7)
    points = np.vstack([part.points, np.zeros((inner.size, 3))])
    full = meshlane.Mesh(points, [("hexahedron27", np.hstack([nodes, inner]))])
    meshlane.write(tmp_path / "full.msh", full, file_format="gmsh22", binary=False)
    mesh = read_mesh(tmp_path / "full.msh")
    assert (mesh.cells["hex20"] == nodes).all()
    assert mesh.n_points == part.n_points
    assert "hexahedra of 27 nodes are read as 20-node ones" in str(mesh.notes[0])


@pytest.mark.parametrize("text", ["", "$MeshFormat\n", "solid cube\n", TWO_TETRAHEDRA[:200]])
def test_a_file_of_another_kind_or_cut_off_is_an_error_that_names_it(tmp_path, text):
    path = tmp_path / "broken.msh"
    path.write_text(text)
    with pytest.raises(InvalidFile, match=r"broken.msh: .*cannot be read as a Gmsh mesh"):
        read_mesh(path)


def test_an_unknown_unit_or_ending_or_file_is_said(tmp_path):
    with pytest.raises(InvalidParameter, match=r"unit: must be a unit of length, one of m, mm, .* got 'kg'"):
        read_mesh(tmp_path / "two.msh", unit="kg")
    with pytest.raises(InvalidFile, match=r"there is no such file"):
        read_mesh(tmp_path / "two.msh")
    (tmp_path / "part.step").write_text("")
    with pytest.raises(InvalidFile, match=r"files ending in '.step' are not read; allowed are .*.msh"):
        read_mesh(tmp_path / "part.step")


def test_another_format_called_msh_is_told_what_was_expected(tmp_path):
    path = tmp_path / "beam.msh"
    path.write_text("*NODE\n1, 0., 0., 0.\n")
    with pytest.raises(InvalidFile, match=r"cannot be read as a Gmsh mesh .* begins with \$MeshFormat"):
        read_mesh(path)
