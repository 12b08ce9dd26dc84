"""What would spoil a computation with a mesh is found, with its numbers in the file and a remedy."""

import numpy as np
import pytest

from flexarm import InvalidFile, InvalidParameter, SolidMesh
from flexarm.solids import Block, Material, revolved, ring

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
RUBBER = Material(youngs_modulus=5e6, poisson_ratio=0.49, density=1100)


def _ring(**keywords) -> SolidMesh:
    return ring(0.1, 0.2, 0.1, size=0.05, around=24, order=1, material=STEEL, **keywords)


def _changed(mesh: SolidMesh, **values) -> SolidMesh:
    fields = {
        name: getattr(mesh, name)
        for name in ("points", "cells", "cell_groups", "point_sets", "materials", "file")
    }
    return SolidMesh(**{**fields, **values})


@pytest.mark.parametrize("order", [1, 2])
def test_a_sound_mesh_passes_and_raises_no_doubt(order):
    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=24, order=order, material=STEEL)
    assert mesh.check() is mesh
    assert mesh.warnings == ()


def test_inverted_cells_are_listed_by_their_numbers():
    mesh = _ring()
    cells = mesh.cells["hex8"].copy()
    cells[[2, 5]] = cells[[2, 5]][:, [4, 5, 6, 7, 0, 1, 2, 3]]
    numbers = {"hex8": np.arange(1001, 1001 + len(cells))}
    wrong = _changed(mesh, cells={"hex8": cells}, file="part.inp", cell_numbers=numbers)
    with pytest.raises(
        InvalidFile,
        match=r"part.inp: cells.hex8: 2 of 96 cells are inverted .*: 1003, 1006 \(the first near \[",
    ):
        wrong.check()


def test_a_cell_that_is_there_twice_would_weigh_twice():
    mesh = _ring()
    turned = mesh.cells["hex8"][[3]][:, [1, 2, 3, 0, 5, 6, 7, 4]]  # the same cell from another corner
    wrong = _changed(
        mesh, cells={"hex8": np.vstack([mesh.cells["hex8"], turned])}, cell_groups={}, materials={}
    )
    with pytest.raises(InvalidParameter, match=r"cells.hex8: 1 of 97 cells have the nodes of another: 97 \("):
        wrong.with_materials(STEEL).check()


def test_a_mesh_in_another_order_of_nodes_is_told_so():
    mesh = _ring()
    wrong = _changed(mesh, cells={"hex8": mesh.cells["hex8"][:, [4, 5, 6, 7, 0, 1, 2, 3]]})
    with pytest.raises(
        InvalidParameter,
        match=r"96 of 96 .*: 1, 2, .*, 10 and 86 more .*; as all are, their nodes are in another order",
    ):
        wrong.check()


def test_inverted_cells_with_middle_nodes_hint_at_a_curved_surface():
    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=24, order=2, material=STEEL)
    cells = mesh.cells["hex20"]
    points = mesh.points.copy()
    middle = cells[0, 8]
    points[middle] += 2 * (points[cells[0, 6]] - points[middle])  # beyond the opposite corner
    with pytest.raises(InvalidParameter, match=r"of 96 cells are inverted .*; if their middle nodes follow"):
        _changed(mesh, points=points).check()


def test_flat_cells_have_no_volume():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0]], float)
    mesh = SolidMesh(points, {"tet4": np.array([[0, 1, 2, 3], [0, 1, 4, 2]])}).with_materials(STEEL)
    with pytest.raises(
        InvalidParameter, match=r"cells.tet4: 1 of 2 cells have no volume: 2 \(the first near"
    ):
        mesh.check()


def test_a_cell_that_names_a_node_twice_is_refused():
    mesh = _ring()
    cells = mesh.cells["hex8"].copy()
    cells[3, 7] = cells[3, 6]
    with pytest.raises(
        InvalidParameter, match=r"1 of 96 cells name a node twice \(collapsed to a wedge or less\): 4"
    ):
        _changed(mesh, cells={"hex8": cells}).check()


def test_distorted_cells_are_a_warning():
    points = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0.3, 0.3, 0.01]], float)
    mesh = SolidMesh(points, {"tet4": np.array([[0, 1, 2, 3]])}).with_materials(STEEL).check()
    assert any("1 of 1 cells are badly distorted" in str(problem) for problem in mesh.warnings)


def _two_rings() -> SolidMesh:
    """Two rings on top of each other, each with points of its own on the faces where they meet."""
    return _ring().joined(_ring().moved(translation=[0, 0, 0.1]))


def test_points_written_twice_are_found_and_merged():
    mesh = _two_rings()
    with pytest.raises(
        InvalidParameter, match=r"points: 72 pairs of nodes lie in one place .* merge = "
    ) as found:
        mesh.check()
    assert "falls into 2 pieces that share no node: 216 nodes around" in str(found.value.problems[1])
    merged = mesh.merged(1e-6).check()
    assert merged.n_points == 2 * 216 - 72
    assert len(merged.point_set("bottom")) == 2 * 72
    whole = revolved(
        [Block("a", 0.1, 0.2, 0, 0.1), Block("b", 0.1, 0.2, 0.1, 0.2)], size=0.05, around=24, order=1
    )
    assert merged.n_points == whole.n_points


def test_the_advised_tolerance_merges_what_was_found():
    mesh = _two_rings()
    with pytest.raises(InvalidParameter) as found:
        mesh.check()
    advised = float(str(found.value).split("merge = ")[1].split()[0])
    assert mesh.merged(advised).check().n_cells == mesh.n_cells


def test_loose_parts_are_listed_largest_first():
    small = ring(0.01, 0.02, 0.01, size=0.01, around=8, order=1, material=STEEL)
    mesh = small.joined(_ring().moved(translation=[1, 0, 0]))
    with pytest.raises(
        InvalidParameter,
        match=r"falls into 2 pieces that share no node: 216 nodes around node .*; 32 nodes around",
    ):
        mesh.check()


def test_unused_points_are_named():
    mesh = _ring()
    with pytest.raises(
        InvalidParameter, match=r"points: 1 nodes belong to no cell: node 217 at \[5, 5, 5\] m"
    ):
        _changed(mesh, points=np.vstack([mesh.points, [5, 5, 5]])).check()


def test_a_missing_set_lists_those_there_are():
    mesh = _ring()
    with pytest.raises(
        InvalidParameter,
        match=r"point set 'Botom': does not exist; there are inner, .* \(did you mean 'bottom'",
    ):
        mesh.point_set("Botom")
    with pytest.raises(
        InvalidParameter, match=r"point set 'none': is empty; an interface needs at least one point"
    ):
        mesh.with_point_set("none", []).point_set("none")


def test_points_in_a_box_are_those_within_its_sides():
    """The upper half of a ring: its top, and nothing of its bottom."""
    mesh, inf = _ring(), np.inf
    assert list(mesh.points_in_box([-inf, -inf, 0.09], [inf, inf, inf])) == list(mesh.point_sets["top"])
    corner = mesh.points_in_box([0.19, -0.01, -0.01], [0.21, 0.01, 0.01])
    assert mesh.points[corner] == pytest.approx(np.array([[0.2, 0.0, 0.0]]))


def test_cells_without_material_are_counted_by_group():
    blocks = [Block("a", 0.1, 0.2, 0, 0.1, STEEL), Block("b", 0.1, 0.2, 0.1, 0.2)]
    mesh = revolved(blocks, size=0.1, around=8, order=1)
    with pytest.raises(
        InvalidParameter, match=r"materials: 8 of 16 cells have no material \(in groups b\); give one"
    ):
        mesh.check()
    filled = mesh.with_materials(RUBBER).check()
    assert filled.materials == {"a": STEEL, "rest": RUBBER}
    materials, indices = filled.material_indices()
    assert [materials[i] for i in indices["hex8"]] == [STEEL] * 8 + [RUBBER] * 8


def test_two_materials_for_one_cell_or_for_no_group_are_refused():
    mesh = _ring()
    doubly = _changed(mesh, cell_groups={**mesh.cell_groups, "half": {"hex8": np.arange(48)}})
    with pytest.raises(
        InvalidParameter, match=r"some of its cells are also in 'ring', which has another material"
    ):
        doubly.with_materials({"half": RUBBER}).check()
    assert doubly.with_materials({"half": STEEL}).check().n_cells == 96
    with pytest.raises(
        InvalidParameter, match=r"material of 'rung': there is no such group .* mean 'ring'\?"
    ):
        mesh.with_materials({"rung": STEEL}).check()


@pytest.mark.parametrize(("scale", "doubt"), [(1000.0, "mean unit = 'mm'"), (1e-4, "mean unit = 'm'")])
def test_a_size_that_no_part_has_is_doubted(scale, doubt):
    mesh = _ring()
    large = _changed(mesh, points=mesh.points * scale)
    assert any(doubt in str(problem) for problem in large.warnings)


def test_materials_in_other_units_are_doubted():
    mesh = _ring().with_materials(
        {"ring": Material(youngs_modulus=210e3, poisson_ratio=0.3, density=7.85e-9)}
    )
    told = " ".join(map(str, mesh.warnings))
    assert "E is 210000 Pa, softer than rubber" in told and "density is 7.85e-09 kg/m3" in told


def test_what_is_no_mesh_is_refused_at_once():
    points = np.zeros((4, 3))
    with pytest.raises(InvalidParameter, match=r"points: must have the shape \(n, 3\), got \(4, 2\)"):
        SolidMesh(points[:, :2], {"tet4": [[0, 1, 2, 3]]})
    with pytest.raises(
        InvalidParameter, match=r"cells: unknown type 'wedge6'; allowed are tet4, tet10, hex8, hex20"
    ):
        SolidMesh(points, {"wedge6": [[0, 1, 2, 3, 0, 1]]})
    with pytest.raises(InvalidParameter, match=r"cells.tet4: refers to index 4; there are 4, counted from 0"):
        SolidMesh(points, {"tet4": [[0, 1, 2, 4]]})
    with pytest.raises(InvalidParameter, match=r"cells: there are no solid cells; needed are 4- and 10-node"):
        SolidMesh(points, {}).check()


def test_arrays_are_copies_that_nobody_writes_to():
    points = np.eye(4)[:, :3]
    mesh = SolidMesh(points, {"tet4": np.array([[3, 0, 1, 2]])})
    points[0] = 7.0
    assert mesh.points[0, 0] == 1.0
    for array in (mesh.points, mesh.cells["tet4"], mesh.point_numbers):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1


def test_moving_turns_and_shifts_all_points():
    turn = np.array([[0.0, -1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    mesh = _ring()
    moved = mesh.moved(turn, [1.0, 2.0, 3.0]).check()
    x, y, z = mesh.points.T
    assert moved.points == pytest.approx(np.column_stack([1 - y, 2 + x, 3 + z]))
    with pytest.raises(InvalidParameter, match="that does not mirror"):
        mesh.moved(np.diag([1.0, 1.0, -1.0]))
    with pytest.raises(InvalidParameter, match="rotation: must be a 3 x 3 rotation matrix"):
        mesh.moved(2 * np.eye(3))


def test_the_description_names_size_groups_and_sets():
    text = _ring().describe()
    assert "216 points, 648 degrees of freedom, 96 hex8" in text
    assert "size  0.4 x 0.4 x 0.1 m" in text
    assert "group ring: 96 cells, E = 2.1e+11 Pa, nu = 0.3, rho = 7850 kg/m3" in text
    assert "set   bottom: 72 points" in text
