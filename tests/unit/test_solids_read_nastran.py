"""Nastran bulk data in its three formats: properties, sets, rigid elements, coordinate systems."""

import meshlane
import numpy as np
import pytest
from mesh_files import NASTRAN_BAR as BAR
from solid_volume import volume

from flexarm import InvalidFile, read_mesh
from flexarm.solids import Material, ring

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)


@pytest.fixture
def bar(tmp_path):
    path = tmp_path / "bar.bdf"
    path.write_text(BAR)
    return path


def test_the_three_formats_give_one_part(bar):
    mesh = read_mesh(bar, unit="mm").check()
    assert volume(mesh) == pytest.approx(2e-6, rel=1e-12)
    assert list(mesh.point_numbers) == [1, 2, 3, 4, 15, 16, 17, 18, 25, 26, 27, 28]
    assert list(mesh.cell_numbers["hex8"]) == [7, 9]


def test_properties_are_groups_with_their_materials(bar):
    mesh = read_mesh(bar, unit="mm")
    assert {name: list(g["hex8"]) for name, g in mesh.cell_groups.items()} == {
        "psolid-1": [0],
        "psolid-2": [1],
    }
    assert mesh.materials == {"psolid-1": STEEL, "psolid-2": STEEL}


def test_constraints_rigid_elements_and_sets_name_points(bar):
    mesh = read_mesh(bar, unit="mm")
    numbers = {name: list(mesh.point_numbers[points]) for name, points in mesh.point_sets.items()}
    assert numbers == {
        "set-5": [1, 3, 4, 16],
        "spc-11": [1, 2, 3, 4],
        "spc-12": [25, 26],
        "rbe2-31": [25, 26, 27, 28],
        "rbe3-32": [15, 16, 17, 18],
    }
    assert "cells: 1 cards CELAS2 are not read" in [str(note) for note in mesh.notes]


def test_open_ranges_mean_the_grids_there_are(bar):
    bar.write_text(BAR.replace("SPC1,11,123,1,THRU,4", "SPC1,11,123,17,THRU,99999999"))
    mesh = read_mesh(bar, unit="mm")
    assert list(mesh.point_numbers[mesh.point_set("spc-11")]) == [17, 18, 25, 26, 27, 28]


@pytest.mark.parametrize(
    ("members", "there"),
    [
        ("1,THRU,28,EXCEPT,2,15", [1, 3, 4, 16, 17, 18, 25, 26, 27, 28]),
        ("1,THRU,99999999,EXCEPT,2,THRU,18", [1, 25, 26, 27, 28]),
        ("1,THRU,4,EXCEPT,2,25,3", [1, 3, 4, 25]),  # 25 is outside the range and ends EXCEPT
        ("1,THRU,17,BY,2,EXCEPT,3,25,THRU,28,EXCEPT,26", [1, 15, 17, 25, 27, 28]),
    ],
)
def test_grids_after_except_are_not_in_the_set(bar, members, there):
    words = members.split(",")
    text = BAR.replace("SET 5 = 1, 3 THRU 4,\n        16", f"SET 5 = {' '.join(words)}")
    card = f"SPC1,11,123,{','.join(words[:6])}\n,{','.join(words[6:])}"
    bar.write_text(text.replace("SPC1,11,123,1,THRU,4", card))
    mesh = read_mesh(bar, unit="mm")
    assert list(mesh.point_numbers[mesh.point_set("set-5")]) == there
    assert list(mesh.point_numbers[mesh.point_set("spc-11")]) == there


def test_shear_modulus_stands_for_what_is_left_out(bar):
    """E = 2 G (1 + nu): G = 210000/2.6 MPa."""
    bar.write_text(
        BAR.replace("MAT1           5 210000.              .3", "MAT1           5        80769.23      .3")
    )
    material = read_mesh(bar, unit="mm").materials["psolid-1"]
    assert material.youngs_modulus == pytest.approx(210e9, rel=1e-7)


@pytest.mark.parametrize(
    ("kind", "point", "expected"),
    [
        ("CORD2R", (1.0, 2.0, 3.0), (5.0 - 2.0, 1.0, 3.0)),
        ("CORD2C", (2.0, 90.0, 3.0), (5.0 - 2.0, 0.0, 3.0)),
        ("CORD2S", (2.0, 90.0, 90.0), (5.0 - 2.0, 0.0, 0.0)),
    ],
)
def test_grids_may_stand_in_a_coordinate_system(tmp_path, kind, point, expected):
    """A system at (5, 0, 0) whose x axis is the basic y: local (x, y, z) is basic (5 - y, x, z)."""
    path = tmp_path / "cell.bdf"
    path.write_text(
        f"{kind},4,,5.,0.,0.,5.,0.,1.,\n,5.,1.,0.\n"
        f"GRID,1,4,{point[0]},{point[1]},{point[2]}\nGRID,2,,9.,0.,0.\nGRID,3,,9.,1.,0.\nGRID,4,,9.,0.,1.\n"
        "CTETRA,1,1,1,2,3,4\n"
    )
    assert read_mesh(path).points[0] == pytest.approx(np.array(expected), abs=1e-12)


@pytest.mark.parametrize("order", [1, 2])
def test_meshlane_writes_what_is_read(tmp_path, order):
    """A second program's order of the 20 nodes: bottom, upright, top; another changes the volume."""
    part = ring(0.1, 0.2, 0.1, size=0.1, order=order)
    (nodes,) = part.cells.values()
    name = "hexahedron" if order == 1 else "hexahedron20"
    rounded = np.round(part.points, 9)  # the writer has no room for exponents of two digits
    meshlane.nastran.write(tmp_path / "ring.bdf", meshlane.Mesh(rounded, [(name, nodes)]))
    mesh = read_mesh(tmp_path / "ring.bdf")
    assert (next(iter(mesh.cells.values())) == nodes).all()
    assert volume(mesh) == pytest.approx(volume(part), rel=1e-7)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "GRID           2             10.",
            "GRID           2             1o.",
            r"line 8, GRID: field 4 must be a n",
        ),
        ("GRID           2", "GRID          22", r"line 21, CHEXA: names grid 2, which is not in the file"),
        ("GRID,4,,", "GRID,4,7,", r"line 11, GRID: is in coordinate system 7, which is not in the file"),
        (
            "+A            17      18\n",
            "+A            17\n",
            r"line 21, CHEXA: cell 7 has 7 nodes; allowed are 8, or 20",
        ),
        (
            "CELAS2,40,1.,1,1",
            "CPENTA,40,1,1,2,3,15,16,17",
            r"cells: .* 1 of type wedge; allowed are 4- and 10",
        ),
        ("CELAS2,40,1.,1,1", "INCLUDE 'more.bdf'", r"line 33, INCLUDE: .*more.bdf is not there"),
        ("SPC1,11,123,1,THRU,4", "SPC1,11,123,1,TO,4", r"line 28, SPC1: must be grids or THRU, got 'TO'"),
    ],
)
def test_errors_name_line_and_card(bar, old, new, message):
    assert old in BAR
    bar.write_text(BAR.replace(old, new))
    with pytest.raises(InvalidFile, match=message):
        read_mesh(bar, unit="mm")
