"""The mesher of what revolves: volumes, positive Jacobians, shared points, sets that hold what they say."""

from math import cos, pi, sin

import numpy as np
import pytest
from pytest import approx
from solid_volume import jacobians, volume

from flexarm import InvalidParameter
from flexarm.solids import Block, BoltCircle, Material, Patch, disc, flange, revolved, ring, shaft, tube
from flexarm.solids.point_areas import point_areas
from flexarm.solids.shape import coincident, components, surface

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
HUB = [
    Block("plate", 0.0, 0.08, 0.0, 0.01),
    Block("flange", 0.08, 0.1, 0.0, 0.015),
    Block("wall", 0.05, 0.06, 0.01, 0.07),
    Block("socket", 0.02, 0.03, 0.01, 0.05),
]
HUB_VOLUME = pi * (0.08**2 * 0.01 + 0.0036 * 0.015 + 0.0011 * 0.06 + 0.0005 * 0.04)


def test_a_ring_of_straight_cells_has_the_volume_of_its_polygon():
    """n/2 sin(2 pi / n) r^2 is the area of a regular polygon of n corners; rounding only."""
    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=24, order=1)
    assert volume(mesh) == approx(12 * sin(2 * pi / 24) * (0.04 - 0.01) * 0.1, rel=1e-12)


def test_curved_cells_have_the_volume_under_their_parabolas():
    """With half an angle b of a cell, each arc is a chord 2 r sin b with a parabola of height r (1 - cos b),
    whose area is 2/3 of chord times height; the error falls with the fourth power of b."""
    exact = pi * (0.04 - 0.01) * 0.1
    error = []
    for n in (8, 16, 32):
        b = pi / n
        area = n * (sin(2 * b) / 2 + 4 / 3 * sin(b) * (1 - cos(b)))
        found = volume(ring(0.1, 0.2, 0.1, size=0.1, around=n))
        assert found == approx(area * (0.04 - 0.01) * 0.1, rel=1e-12)
        error.append(found / exact - 1)
    assert np.log2(np.abs(np.divide(error[:-1], error[1:]))) == approx(4.0, abs=0.05)


def test_a_solid_disc_has_its_polygons_volume_whatever_fills_its_core():
    mesh = disc(0.1, 0.02, size=0.01, around=32, order=1)
    assert volume(mesh) == approx(16 * sin(2 * pi / 32) * 0.05**2 * 0.02, rel=1e-12)


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize(
    "blocks", [HUB, [Block("disc", 0, 0.05, -0.01, 0)], [Block("ring", 0.1, 0.2, 0, 0.1)]], ids=len
)
@pytest.mark.parametrize("size", [0.02, 0.008])
def test_every_jacobian_is_positive(order, blocks, size):
    """The least det J of a cell is above a quarter of its mean: no cell of the core degenerates."""
    mesh = revolved(blocks, size=size, order=order)
    for kind in mesh.cells:
        found, _ = jacobians(mesh, kind)
        assert (found.min(axis=0) > 0.25 * found.mean(axis=0)).all()


def test_blocks_that_touch_are_one_part_without_cracks():
    mesh = revolved(HUB, size=0.01)
    assert components(mesh)[0] == 1
    assert len(coincident(mesh.points, 1e-6)) == 0
    assert volume(mesh) == approx(HUB_VOLUME, rel=1e-5)


def test_the_surface_is_closed():
    """Every edge of the surface belongs to two of its faces, once in each direction."""
    mesh = revolved(HUB, size=0.01, order=1)
    edges = [(face[i - 1], face[i]) for face in surface(mesh) for i in range(len(face))]
    assert len(set(edges)) == len(edges)
    assert {(b, a) for a, b in edges} == set(edges)


def test_surface_faces_look_outward():
    """The divergence theorem: the faces' volume integral of div x / 3 is the part's volume."""
    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=24, order=1)
    faces = mesh.points[np.array(surface(mesh))]
    normals = np.cross(faces[:, 2] - faces[:, 0], faces[:, 3] - faces[:, 1]) / 2
    flux = np.einsum("fi,fi->", faces.mean(axis=1), normals) / 3
    assert flux == approx(volume(mesh), rel=1e-12)


def test_groups_are_the_blocks():
    mesh = revolved(HUB, size=0.01, material=STEEL)
    assert list(mesh.cell_groups) == ["plate", "flange", "wall", "socket"]
    members = np.concatenate([group["hex20"] for group in mesh.cell_groups.values()])
    assert sorted(members) == list(range(mesh.n_cells))
    for block in HUB:
        cells = mesh.cells["hex20"][mesh.cell_groups[block.name]["hex20"]]
        corners = mesh.points[cells[:, :8]]
        radius = np.hypot(corners[..., 0], corners[..., 1])
        assert (radius.max(), radius.min() if block.inner else 0) == approx((block.outer, block.inner))
        assert (corners[..., 2].min(), corners[..., 2].max()) == approx((block.bottom, block.top))
    assert set(mesh.materials) == set(mesh.cell_groups)


@pytest.mark.parametrize("order", [1, 2])
def test_sets_of_faces_hold_all_points_there_and_no_others(order):
    mesh = tube(0.06, 0.004, 0.1, size=(0.002, 0.01), order=order)
    radius, z = np.hypot(*mesh.points[:, :2].T), mesh.points[:, 2]
    for name, there in {
        "inner": np.isclose(radius, 0.026, atol=1e-12),
        "outer": np.isclose(radius, 0.030, atol=1e-12),
        "bottom": np.isclose(z, 0.0, atol=1e-12),
        "top": np.isclose(z, 0.1, atol=1e-12),
    }.items():
        assert list(mesh.point_sets[name]) == list(np.flatnonzero(there))
        assert len(mesh.point_sets[name]) == len(mesh.point_sets[f"tube.{name}"]) > 0


def test_middle_points_of_arcs_lie_on_their_circles():
    mesh = ring(0.1, 0.2, 0.1, size=0.1, around=12)
    for name, radius in (("inner", 0.1), ("outer", 0.2)):
        found = np.hypot(*mesh.points[mesh.point_sets[name], :2].T)
        assert found == approx(radius, abs=1e-15)
        assert len(found) == 12 * 2 * 2 + 12  # two circles of 24 points, 12 in the middle of upright edges


def test_a_patch_begins_and_ends_where_it_says():
    seat = Patch("seat", 0.05, 0.05, 0.012, 0.023)
    mesh = shaft([(0.1, 0.04)], size=0.01, patches=[seat])
    z = mesh.points[mesh.point_set("seat"), 2]
    assert (z.min(), z.max()) == approx((0.012, 0.023))
    assert np.hypot(*mesh.points[mesh.point_set("seat"), :2].T) == approx(0.05)


def test_bolt_pads_are_alike_and_evenly_spaced():
    mesh = flange(0.03, 0.1, 0.01, bolts=6, bolt_circle=0.08, pad=0.016, size=0.008)
    pads = [mesh.points[mesh.point_set(f"bolts-{k}")] for k in range(1, 7)]
    for k, pad in enumerate(pads):
        turn = np.exp(-2j * pi * k / 6) * (pad[:, 0] + 1j * pad[:, 1])
        assert np.abs(turn).min() == approx(0.072)
        assert np.abs(turn).max() == approx(0.088)
        assert np.angle(turn).max() * 0.08 <= 0.008 * (1 + 1e-9)
        assert np.angle(turn).mean() == approx(0.0, abs=1e-12)
        assert len(pad) == len(pads[0])
        assert pad[:, 2] == approx(0.01)
    assert sorted(np.concatenate([mesh.point_sets[f"bolts-{k}"] for k in range(1, 7)])) == list(
        mesh.point_sets["bolts"]
    )


@pytest.mark.parametrize("order", [1, 2])
@pytest.mark.parametrize("phase", [0.0, 0.02, pi / 48])
def test_bolt_pads_are_made_of_the_faces_nearest_to_their_sides(order, phase):
    """Half a pad is 0.127 rad, a cell 0.131: one on either side, or that around the bolt."""
    bolts = BoltCircle("bolts", radius=0.055, count=8, diameter=0.014, height=0.0, phase=phase)
    mesh = ring(0.03, 0.09, 0.012, size=0.012, order=order, around=48, patches=[bolts])
    pad = mesh.points[mesh.point_set("bolts-1")]
    sides = np.arctan2(pad[:, 1], pad[:, 0]) * 24 / pi
    assert (sides.min(), sides.max()) == approx((0, 1) if phase == pi / 48 else (-1, 1))
    assert bool(mesh.notes) == (phase == pi / 48)  # one cell wide, 7.2 of 14 mm
    # of cells with straight edges, sin(step) / step of the sector
    step = pi / 24
    sector = (0.062**2 - 0.048**2) / 2 * np.ptp(sides) * (np.sin(step) if order == 1 else step)
    assert point_areas(mesh, mesh.point_set("bolts-1")).sum() == approx(sector, rel=1e-4)


@pytest.mark.parametrize(
    ("wrong", "message"),
    [
        (lambda: ring(0.2, 0.1, 0.1, size=0.05), r"inner = 0.2, outer = 0.1 m"),
        (lambda: ring(0.1, 0.1, 0.1, size=0.05), r"has no volume"),
        (lambda: ring(0.1, 0.2, 0.1, size=0.0), r"size: must be positive"),
        (lambda: ring(0.1, 0.2, 0.1, size=0.05, order=3), r"order: must be 1 \(hex8\) or 2"),
        (lambda: disc(0.1, 0.1, size=0.05, around=30), r"around: .* multiple of 4"),
        (lambda: tube(0.06, 0.04, 0.1, size=0.01), r"thickness: .* half the outer diameter"),
        (lambda: revolved([], size=0.01), r"at least one block"),
        (lambda: revolved([HUB[0], Block("a", 0, 0.02, 0, 0.02)], size=0.01), r"'plate' and 'a' overlap"),
        (lambda: revolved([HUB[0], HUB[0]], size=0.01), r"given twice: plate"),
        (
            lambda: ring(0.1, 0.2, 0.1, size=0.05, patches=[Patch("seat", 0.3, 0.3, 0, 1)]),
            r"patch 'seat': there is no material",
        ),
        (
            lambda: ring(0.1, 0.2, 0.1, size=0.05, patches=[BoltCircle("b", 0.15, 4, 0.001, 0.1)]),
            r"bolt circle 'b': the pad at 0 degrees holds 3 points, not an area",
        ),
        (
            lambda: ring(0.1, 0.2, 0.1, size=0.05, patches=[BoltCircle("b", 0.15, 4, 0.02, 0.3)]),
            r"bolt circle 'b': .* a face that is there",
        ),
    ],
)
def test_what_cannot_be_meshed_is_said(wrong, message):
    with pytest.raises(InvalidParameter, match=message):
        wrong()
