"""A beam as a solid part: reduced and moved, beside the beam element and the full solid model.

The bar is 1 m long, 40 by 60 mm. Its interfaces follow the end faces on average, as the section of a beam
does; rigid ones would hold the sections' warping and Poisson's contraction, and stiffen it by 0.8 %.
"""

from pathlib import Path

import numpy as np
import pytest
from arms import arm, drive, swing_angle
from pytest import approx
from scipy.sparse import csc_matrix
from scipy.sparse.linalg import eigsh, splu
from solid_boxes import box

import flexarm
from flexarm import _core

LENGTH, LOAD = 1.0, 5.0
MESH = box([0.04, 0.06, LENGTH], (2, 2, 12))
FINE = box([0.04, 0.06, LENGTH], (4, 4, 24))
BEAM = {
    "name": "bar",
    "type": "beam",
    "end": [0, 0, LENGTH],
    "up": [0, 1, 0],
    "section": {"shape": "rectangle", "width": 0.04, "height": 0.06},
    "material": {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850},
    "elements": 8,
}


@pytest.fixture(scope="module")
def part() -> flexarm.SuperElement:
    """Rigid interfaces, for the full model to have the same."""
    return flexarm.reduce_mesh(MESH, {"start": "bottom", "end": "top"}, modes=8)


@pytest.fixture(scope="module")
def bar() -> flexarm.SuperElement:
    return flexarm.reduce_mesh(FINE, {"start": "bottom:average", "end": "top:average"}, modes=8)


def on_a_hinge(link: dict, child: str, end: str, position: list[float]) -> flexarm.Arm:
    return arm(
        joints=[{"name": "hinge", "type": "revolute", "parent": "base", "child": child, "axis": [0, 1, 0]}],
        links=[link],
        payloads=[{"name": "load", "link": end, "position": position, "mass": LOAD}],
        points=[{"name": "tip", "link": end, "position": position}],
    )


def arm_with(part: flexarm.SuperElement, file: Path) -> flexarm.Arm:
    part.save(file)
    link = {"name": "bar", "type": "superelement", "file": str(file)}
    return on_a_hinge(link, "bar:start", "bar:end", [0, 0, 0])


@pytest.fixture(scope="module")
def rigid_ends(part: flexarm.SuperElement, tmp_path_factory: pytest.TempPathFactory) -> flexarm.Arm:
    return arm_with(part, tmp_path_factory.mktemp("rigid") / "bar.nc")


@pytest.fixture(scope="module")
def solid_arm(bar: flexarm.SuperElement, tmp_path_factory: pytest.TempPathFactory) -> flexarm.Arm:
    return arm_with(bar, tmp_path_factory.mktemp("average") / "bar.nc")


@pytest.fixture(scope="module")
def beam_arm() -> flexarm.Arm:
    return on_a_hinge(BEAM, "bar", "bar", [0, 0, LENGTH])


def held_with_load() -> tuple[csc_matrix, csc_matrix, np.ndarray]:
    """Stiffness and mass of the full mesh, its bottom held, its top tied to one frame with the load.

    Freedoms are the inner points', then the frame's six; T carries them to all points.
    """
    K, M = (A + A.T - csc_matrix((A.diagonal(), (range(A.shape[0]),) * 2)) for A in _full_matrices())
    top, bottom = (np.asarray(MESH.point_sets[name]) for name in ("top", "bottom"))
    inner = np.setdiff1d(np.arange(MESH.n_points), np.concatenate([top, bottom]))
    free = (3 * inner[:, None] + np.arange(3)).ravel()
    rows, columns, values = list(free), list(range(len(free))), [1.0] * len(free)
    for p in top:
        x, y, z = MESH.points[p] - [0, 0, LENGTH]
        rigid = np.hstack([np.eye(3), [[0, z, -y], [-z, 0, x], [y, -x, 0]]])
        for i, j in np.argwhere(rigid):
            rows.append(3 * p + i), columns.append(len(free) + j), values.append(rigid[i, j])
    T = csc_matrix((values, (rows, columns)), shape=(3 * MESH.n_points, len(free) + 6))
    load = csc_matrix((T.shape[1], T.shape[1])).tolil()
    for k in range(3):
        load[len(free) + k, len(free) + k] = LOAD
    return (T.T @ K @ T).tocsc(), (T.T @ M @ T + load).tocsc(), np.asarray(T.T @ M @ _ones())


def _full_matrices() -> tuple[csc_matrix, csc_matrix]:
    return _core.assemble_solids(MESH.core())


def _ones() -> np.ndarray:
    """A unit acceleration of all points along x."""
    return np.tile([1.0, 0.0, 0.0], MESH.n_points)


def test_its_frequencies_are_those_of_the_full_solid(rigid_ends: flexarm.Arm) -> None:
    """Same mesh, same rigid end, no reduction: the eigenvalues bound the reduced ones from below.

    What eight modes leave out costs the first mode 5e-6.
    """
    K, M, _ = held_with_load()
    omega = np.sqrt(eigsh(K, 6, M, sigma=0, return_eigenvectors=False))
    full = np.sort(omega) / (2 * np.pi)
    found = flexarm.modes(rigid_ends, count=6, gravity=False).frequency_hz
    assert np.all(found > full * (1 - 1e-9))
    assert found[:2] == approx(full[:2], rel=1e-5)
    assert found[:4] == approx(full[:4], rel=1e-3)


def test_it_sags_as_the_full_solid_for_small_deflections(rigid_ends: flexarm.Arm) -> None:
    """Statics of Craig-Bampton are exact for loads at interfaces, and nearly so for its own weight."""
    K, _, weight = held_with_load()
    g = 1e-3  # m/s2: small enough to be linear
    acceleration = weight.copy()
    acceleration[-6] += LOAD
    full = splu(K).solve(g * acceleration)[-6]
    light = rigid_ends.replace(gravity=(g, 0.0, 0.0))
    assert flexarm.static(light).displacement[0, 0] == approx(full, rel=1e-6)


def test_it_sags_as_the_beam(solid_arm: flexarm.Arm, beam_arm: flexarm.Arm) -> None:
    for q in (0.4, 1.5):
        solid = flexarm.static(solid_arm, joints={"hinge": q})
        beam = flexarm.static(beam_arm, joints={"hinge": q})
        size = np.linalg.norm(beam.displacement[0])
        assert solid.displacement[0] == approx(beam.displacement[0], abs=2e-3 * size)
        assert solid.joint_torque[0] == approx(beam.joint_torque[0], rel=1e-4)


def test_it_vibrates_as_the_beam(solid_arm: flexarm.Arm, beam_arm: flexarm.Arm) -> None:
    solid = flexarm.modes(solid_arm, joints={"hinge": 1.0}, count=4).frequency_hz
    beam = flexarm.modes(beam_arm, joints={"hinge": 1.0}, count=4).frequency_hz
    assert solid == approx(beam, rel=1e-3)


def test_it_swings_as_the_beam(solid_arm: flexarm.Arm, beam_arm: flexarm.Arm) -> None:
    motion = drive({"hinge": swing_angle}, 4.0)
    runs = [flexarm.simulate(model, motion, step=1e-3) for model in (solid_arm, beam_arm)]
    apart = np.abs(runs[0].position - runs[1].position).max()
    sag = np.abs(flexarm.static(beam_arm, joints={"hinge": 1.2}).displacement).max()
    assert apart < 0.02 * sag
