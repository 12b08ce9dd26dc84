"""Abaqus and CalculiX files as those programs, FreeCAD and Gmsh write them."""

import meshlane
import numpy as np
import pytest
from mesh_files import ABAQUS_ASSEMBLY as ASSEMBLY
from mesh_files import ABAQUS_BAR as BAR
from solid_volume import volume

from flexarm import InvalidFile, read_mesh
from flexarm.solids import Material, ring

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


@pytest.fixture
def bar(tmp_path):
    path = tmp_path / "bar.inp"
    path.write_text(BAR)
    return path


def _numbers(mesh, name):
    return list(mesh.point_numbers[mesh.point_sets[name]])


def test_every_way_of_naming_nodes_is_read(bar):
    mesh = read_mesh(bar, unit="mm")
    assert _numbers(mesh, "foot") == [1, 2, 3, 4]
    assert _numbers(mesh, "middle") == [15, 16, 17, 18]
    assert _numbers(mesh, "ends") == [1, 2, 3, 4, 25, 26]
    assert _numbers(mesh, "of_upper") == [15, 16, 17, 18, 25, 26, 27, 28]
    assert _numbers(mesh, "Nall") == [1, 2, 3, 4, 15, 16, 17, 18, 25, 26, 27, 28]
    assert _numbers(mesh, "skin") == [25, 26, 27, 28]
    assert _numbers(mesh, "nodes") == [15, 16, 17, 18]


def test_faces_of_a_surface_are_its_nodes(bar):
    """S2 of a hexahedron is the face opposite to its first four nodes, S3 that of nodes 1, 2, 5, 6."""
    mesh = read_mesh(bar, unit="mm")
    assert _numbers(mesh, "top") == [25, 26, 27, 28]
    assert _numbers(mesh, "side") == [1, 2, 15, 16, 25, 26]


def test_lengths_and_materials_are_in_si(bar):
    """MPa and t/mm3 go with mm; the first row of a table over temperature counts."""
    mesh = read_mesh(bar, unit="mm").check()
    assert volume(mesh) == pytest.approx(2e-6)
    assert mesh.materials == {"both": STEEL}
    assert mesh.core().n_points == 12


def test_groups_and_numbers_are_those_of_the_file(bar):
    mesh = read_mesh(bar, unit="mm")
    assert {name: list(group["hex8"]) for name, group in mesh.cell_groups.items()} == {
        "lower": [0],
        "upper": [1],
        "both": [0, 1],
    }
    assert list(mesh.cell_numbers["hex8"]) == [7, 9]


def test_what_is_not_read_is_said(bar):
    notes = [str(note) for note in read_mesh(bar, unit="mm").notes]
    assert "cells: 1 of type SPRINGA are not read" in notes
    assert any("points of no solid cell were left out of Nall, reference" in note for note in notes)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (" 4, 0., 10.", " 4, 0., ten", r"bar.inp: line 9, \*NODE: must be numbers, got 0., ten"),
        (
            " 3, 10., 10., 0.",
            " 5, 10., 10., 0.",
            r"line 19, \*ELEMENT: cell 7 names node 3, which is not def",
        ),
        (" 17, 18\n*element", "*element", r"line 20, \*ELEMENT: cell 7 has 6 nodes, C3D8R has 8"),
        ("*ELEMENT, TYPE=C3D8R,", "*ELEMENT,", r"line 19, \*ELEMENT: TYPE is missing"),
        (" FOOT, 25, 26", " FEET, 25, 26", r"line 36, \*NSET: there is no set 'FEET' before this line"),
        (
            " upper, S2",
            " upper, S7",
            r"line 43, \*SURFACE: face must be one of S1 to S6 of a solid, got 'S7'",
        ),
        ("*Node, nset=Nall", "*Node, system=C", r"line 4, \*NODE: SYSTEM=C is not read; give rectangular"),
        ("*STEP", "*NGEN\n1,2\n*STEP", r"line 56, \*NGEN: is not read; write the file from a preprocessor"),
        ("MATERIAL=STEEL", "MATERIAL=BRASS", r"line 55: \*SOLID SECTION: there is no \*MATERIAL 'BRASS'"),
        ("*STEP", "*INCLUDE, INPUT=more.inp\n*STEP", r"line 56, \*INCLUDE: .*more.inp is not there"),
    ],
)
def test_errors_name_line_and_keyword(bar, old, new, message):
    assert old in BAR
    bar.write_text(BAR.replace(old, new))
    with pytest.raises(InvalidFile, match=message):
        read_mesh(bar, unit="mm")


def test_wedges_are_counted_and_refused(tmp_path):
    path = tmp_path / "wedge.inp"
    path.write_text(
        "*NODE\n" + "".join(f"{i}, {i}, 0, 0\n" for i in range(1, 7)) + "*ELEMENT, TYPE=C3D6\n1,1,2,3,4,5,6\n"
    )
    with pytest.raises(InvalidFile, match=r"no element for: 1 of type wedge; allowed are 4- and 10-node tet"):
        read_mesh(path)


def test_a_file_without_solids_says_what_it_holds(bar):
    bar.write_text(BAR.replace("C3D8R", "S8").replace("C3D8I", "S8"))
    with pytest.raises(
        InvalidFile, match=r"there are no solid cells \(.*of type polygon\); needed are 4- and"
    ):
        read_mesh(bar)


def test_an_incomplete_material_is_left_out_and_the_check_says_why(bar):
    bar.write_text(BAR.replace("*DENSITY\n7.85E-9\n", ""))
    mesh = read_mesh(bar, unit="mm")
    assert mesh.materials == {}
    with pytest.raises(
        InvalidFile, match=r"2 of 2 cells have no material .* line 49, \*MATERIAL Steel: has no dens"
    ):
        mesh.check()
    assert read_mesh(bar, unit="mm", materials=STEEL).check().materials == {"all": STEEL}
    assert read_mesh(bar, unit="mm", materials={"upper": STEEL, "lower": STEEL}).check().n_cells == 2


def test_other_units_of_length_do_not_tell_those_of_materials(bar):
    mesh = read_mesh(bar, unit="in")
    assert mesh.box[1, 2] == pytest.approx(20 * 0.0254)
    assert "in units that lengths in 'in' do not tell" in str(mesh.notes[-1])
    assert mesh.materials == {}


def test_included_files_are_read(bar):
    head, tail = BAR.split("*ELEMENT, TYPE=C3D8R", 1)
    (bar.parent / "nodes.inp").write_text(head)
    bar.write_text("*INCLUDE, INPUT=nodes.inp\n*ELEMENT, TYPE=C3D8R" + tail)
    assert volume(read_mesh(bar, unit="mm").check()) == pytest.approx(2e-6)


def test_instances_are_placed_and_their_sets_kept_apart(tmp_path):
    """lever-2 stands at x = 5, turned by 90 degrees about z: (1, 0, 0) of the part goes to (5, 1, 0)."""
    path = tmp_path / "levers.inp"
    path.write_text(ASSEMBLY)
    mesh = read_mesh(path)
    second = mesh.points[mesh.cells["tet4"][1]]
    assert second == pytest.approx(np.array([[5, 0, 0], [5, 1, 0], [4, 0, 0], [5, 0, 1]]), abs=1e-12)
    assert mesh.points[mesh.point_set("tip")] == pytest.approx(np.array([[5, 0, 1]]), abs=1e-12)
    assert list(mesh.point_set("feet")) == [0, *mesh.point_set("lever-2.base")]
    assert mesh.materials == {"lever-1.all": STEEL, "lever-2.all": STEEL}
    with pytest.raises(InvalidFile, match="falls into 2 pieces that share no node: 4 nodes around node 1 at"):
        mesh.check()


def test_one_instance_keeps_the_names_of_its_part(tmp_path):
    first, rest = ASSEMBLY.split("*Instance, name=lever-2", 1)
    path = tmp_path / "lever.inp"
    path.write_text(first + "*End Assembly" + rest.split("*End Assembly")[1])
    mesh = read_mesh(path).check()
    assert list(mesh.cell_groups) == list(mesh.materials) == ["all"]
    assert list(mesh.point_set("base")) == [0, 1, 2]


def test_sets_of_a_part_stay_beside_those_of_its_assembly(tmp_path):
    """Set-1 and Set-2 are the names that Abaqus gives, in the part and again in the assembly."""
    text = """*PART, NAME=rod
*NODE
1, 0, 0, 0
2, 1, 0, 0
3, 0, 1, 0
4, 0, 0, 1
5, 0, 0, -1
*ELEMENT, TYPE=C3D4
1, 1, 2, 3, 4
2, 1, 3, 2, 5
*NSET, NSET=Foot
5
*ELSET, ELSET=Set-1
1
*ELSET, ELSET=Set-2
2
*SURFACE, NAME=skin
Set-1, S1
*SOLID SECTION, ELSET=Set-1, MATERIAL=steel
*SOLID SECTION, ELSET=SET-2, MATERIAL=foam
*END PART
*ASSEMBLY, NAME=all
*INSTANCE, NAME=Rod-1, PART=rod
*END INSTANCE
*ELSET, ELSET=set-1, INSTANCE=Rod-1
2
*NSET, NSET=Foot, INSTANCE=Rod-1
4
*END ASSEMBLY
*MATERIAL, NAME=steel
*DENSITY
7850.
*ELASTIC
2.1e11, 0.3
*MATERIAL, NAME=foam
*DENSITY
100.
*ELASTIC
7e7, 0.3
"""
    path = tmp_path / "rod.inp"
    path.write_text(text)
    mesh = read_mesh(path).check()
    assert {name: list(group["tet4"]) for name, group in mesh.cell_groups.items()} == {
        "Rod-1.Set-1": [0],
        "Set-2": [1],
        "set-1": [1],
    }
    assert {name: material.density for name, material in mesh.materials.items()} == {
        "Rod-1.Set-1": 7850,
        "Set-2": 100,
    }
    assert {name: _numbers(mesh, name) for name in mesh.point_sets} == {
        "Foot": [4],
        "Rod-1.Foot": [5],
        "skin": [1, 2, 3],
    }


def test_a_range_far_beyond_the_nodes_means_those_there_are(bar):
    bar.write_text(BAR.replace(" 15, 18, 1", " 15, 99999999"))
    assert _numbers(read_mesh(bar, unit="mm"), "middle") == [15, 16, 17, 18, 25, 26, 27, 28]


def test_a_comma_at_the_end_of_the_file_ends_it(bar):
    bar.write_text(BAR + "*NSET, NSET=more,")
    assert read_mesh(bar, unit="mm").n_cells == 2


def test_the_placing_of_an_instance_must_be_whole(tmp_path):
    path = tmp_path / "levers.inp"
    path.write_text(ASSEMBLY.replace("5., 0., 0., 5., 0., 1., 90.", "5., 0., 0., 5., 0., 0., 90."))
    with pytest.raises(
        InvalidFile, match=r"\*INSTANCE: must be two points of the axis that differ, and an angle"
    ):
        read_mesh(path)


@pytest.mark.parametrize("order", [1, 2])
def test_meshlane_reads_the_same_mesh(tmp_path, order):
    """A second reader, on a file of its own writing."""
    part = ring(0.1, 0.2, 0.1, size=0.1, order=order)
    (nodes,) = part.cells.values()
    name = "hexahedron" if order == 1 else "hexahedron20"
    written = meshlane.Mesh(part.points, [(name, nodes)], point_sets={"top": part.point_sets["top"]})
    meshlane.write(tmp_path / "ring.inp", written)
    mine, theirs = read_mesh(tmp_path / "ring.inp"), meshlane.abaqus.read(str(tmp_path / "ring.inp"))
    assert np.abs(mine.points - theirs.points).max() == 0
    assert (next(iter(mine.cells.values())) == theirs.cells[0].data).all()
    assert list(mine.point_sets["top"]) == list(theirs.point_sets["top"])
    assert volume(mine) == pytest.approx(volume(part), rel=1e-12)


def test_a_bar_element_without_nodes_is_no_index_error(bar):
    bar.write_text(BAR + "*ELEMENT, TYPE=T3D2, ELSET=bars\n , 28\n")
    assert read_mesh(bar, unit="mm").n_points > 0
