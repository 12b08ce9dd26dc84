"""Areas that points of a set stand for."""

import numpy as np
import pytest
from pytest import approx
from solid_boxes import box

from flexarm.solids import SolidMesh, ring
from flexarm.solids.point_areas import _SHAPES, point_areas


@pytest.mark.parametrize("kind", ["hex8", "hex20"])
def test_areas_add_up_to_the_face(kind: str) -> None:
    mesh = box([0.3, 0.2, 0.5], (3, 2, 4), kind)
    assert point_areas(mesh, mesh.point_sets["top"]).sum() == approx(0.06, rel=1e-12)


def test_a_quadratic_square_gives_a_third_to_its_middles_and_takes_a_twelfth_at_its_corners() -> None:
    mesh = box([1, 1, 1], (1, 1, 1))
    areas = np.sort(point_areas(mesh, mesh.point_sets["top"]))
    assert areas == approx([-1 / 12] * 4 + [1 / 3] * 4, rel=1e-12)


def test_a_quadratic_triangle_gives_all_to_its_middles() -> None:
    corners = np.array([[0, 0, 0], [2, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    pairs = [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]
    points = np.vstack([corners, [(corners[a] + corners[b]) / 2 for a, b in pairs]])
    mesh = SolidMesh(points=points, cells={"tet10": np.arange(10)[None]})
    areas = point_areas(mesh, [0, 1, 2, 4, 5, 6])  # the face z = 0, of area 1
    assert areas == approx([0, 0, 0, 1 / 3, 1 / 3, 1 / 3], abs=1e-15)
    linear = SolidMesh(points=corners, cells={"tet4": np.arange(4)[None]})
    assert point_areas(linear, [2, 0, 1]) == approx([1 / 3] * 3)


@pytest.mark.parametrize("order", [1, 2])
def test_curved_faces_come_near_their_area(order: int) -> None:
    """A chord of 1/32 of a turn is shorter than its arc by (pi/32)^2/6 = 0.16 %; a parabola by 1e-6."""
    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=32, order=order)
    area = point_areas(mesh, mesh.point_sets["outer"]).sum()
    assert area == approx(2 * np.pi * 0.2 * 0.1, rel=2e-3 if order == 1 else 1e-5)


def test_points_of_an_edge_have_none() -> None:
    mesh = box([1, 1, 1], (2, 2, 2))
    edge = np.flatnonzero((mesh.points[:, 2] == 0) & (mesh.points[:, 0] == -0.5))
    assert not point_areas(mesh, edge).any()


def test_points_of_an_edge_have_none_though_they_close_a_stray_face() -> None:
    """All edges of the bottom: in a corner three of them belong to one tetrahedron's or hexahedron's face."""
    mesh = box([1, 1, 1], (2, 2, 2), "hex8")
    bottom = mesh.points[:, 2] == 0
    rim = np.flatnonzero(bottom & (np.abs(mesh.points[:, :2]) == 0.5).any(axis=1))
    inner = np.flatnonzero(bottom & (np.abs(mesh.points[:, :2]) < 0.5).all(axis=1))
    assert not point_areas(mesh, rim).any()
    whole = point_areas(mesh, np.concatenate([rim, inner]))  # with its inner point: the whole face
    assert whole.sum() == approx(1)


def test_inner_faces_do_not_count() -> None:
    mesh = box([1, 2, 3], (2, 2, 2), "hex8")
    outside = point_areas(
        mesh, np.flatnonzero((np.abs(mesh.points - [0, 0, 1.5]) == [0.5, 1, 1.5]).any(axis=1))
    )
    assert outside.sum() == approx(2 * (2 + 3 + 6))


@pytest.mark.parametrize("nodes", [3, 4, 6, 8])
def test_derivatives_of_shape_functions_match_differences(nodes: int) -> None:
    h = 1e-6
    at = np.array([0.2, 0.3])
    for axis in (0, 1):
        step = h * np.eye(2)[axis]
        difference = (_SHAPES[nodes](*(at + step))[0] - _SHAPES[nodes](*(at - step))[0]) / (2 * h)
        assert _SHAPES[nodes](*at)[1 + axis] == approx(difference, abs=1e-9)
    assert _SHAPES[nodes](*at)[0].sum() == approx(1)
