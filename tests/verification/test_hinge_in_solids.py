r"""The solid hinge with tube and load: super-elements against all freedoms of the three meshes.

The second formulation assembles the full matrices of the parts, ties interface points to their frames by

    u_i = d + r x (x_i - p)                                                                              (1)

joins frames that coincide, frees the turn of the hub about the hinge axis against the reducer's output by
that of the gear (held: the motor's shaft does not turn), adds the tube as Euler-Bernoulli elements and the
lumped bodies, and lets SciPy solve. It shares the meshes' K and M with the reduction, nothing else.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
import scipy.sparse as sp
from hinges import coarse_design
from part_arms import plane_beam
from pytest import approx
from scipy.sparse.linalg import LinearOperator, eigsh, splu

import flexarm
from flexarm import _core as typed_core
from flexarm.mockup import HingeDesign, SolidHinge, build_hinge, solid_arm
from flexarm.mockup.hinge import MESHERS

core: Any = typed_core
SEGMENTS = 8
E, NU, RHO = 210e9, 0.3, 7850.0
AREA, SECOND = 5.82e-4, 2.37e-7


def skew(r: np.ndarray) -> np.ndarray:
    return np.array([[0, -r[2], r[1]], [r[2], 0, -r[0]], [-r[1], r[0], 0]])


def rigid_body(mass: float, inertia: tuple[float, float, float]) -> np.ndarray:
    return np.diag([mass] * 3 + list(inertia))


def beam_element(length: float) -> tuple[np.ndarray, np.ndarray]:
    """K and M (12, 12) along z, freedoms of each end: x, y, z, turns about x, y, z."""
    K, M = np.zeros((12, 12)), np.zeros((12, 12))
    bend, sway = plane_beam(length)
    pair, share = np.array([[1, -1], [-1, 1]]) / length, np.array([[2, 1], [1, 2]]) * length / 6
    turn = np.diag([1, -1, 1, -1])
    for at, k, m in (
        ([2, 8], E * AREA * pair, RHO * AREA * share),
        ([5, 11], E / (2 + 2 * NU) * 2 * SECOND * pair, RHO * 2 * SECOND * share),
        ([0, 4, 6, 10], E * SECOND * bend, RHO * AREA * sway),
        ([1, 3, 7, 9], E * SECOND * turn @ bend @ turn, RHO * AREA * turn @ sway @ turn),
    ):
        K[np.ix_(at, at)], M[np.ix_(at, at)] = k, m
    return K, M


class Full:
    """All freedoms: interface frames and beam nodes first by name, then the parts' inner points."""

    def __init__(self, design: HingeDesign) -> None:
        start, rigid = design.hub.flange_radius, design.rigid
        # Frames that move as one share a name; the base is clamped.
        frame = {
            ("housing", "base"): None,
            ("housing", "motor"): "motor",
            ("housing", "seat"): "seat",
            ("reducer", "input"): "seat",
            ("reducer", "output"): "joint",
            ("hub", "input"): "joint",  # the gear holds the relative turn
            ("hub", "output"): "node-0",
        }
        names = ["motor", "seat", "joint", *(f"node-{i}" for i in range(SEGMENTS + 1))]
        self.at = {name: 6 * i for i, name in enumerate(names)}
        self.n = 6 * len(names)
        K, M = [], []
        for name, mesher in MESHERS.items():
            part = mesher(design)
            T = self._ties(name, part, frame)
            lower = core.assemble_solids(part.mesh.core())
            for found, matrix in zip((K, M), lower, strict=True):
                whole = matrix + sp.tril(matrix, -1).T
                found.append((T.T @ whole @ T).tocoo())
        bodies = sp.lil_matrix((self.n, self.n))
        springs = sp.lil_matrix((self.n, self.n))
        k, m = beam_element((3.0 - start) / SEGMENTS)
        for i in range(SEGMENTS):
            a = self.at[f"node-{i}"]
            springs[a : a + 12, a : a + 12] += k
            bodies[a : a + 12, a : a + 12] += m
        polar = rigid.ring_mass * rigid.ring_radius**2
        ring = rigid_body(rigid.ring_mass, (polar / 2, polar, polar / 2))
        rotor = rigid_body(rigid.rotor_mass, (rigid.rotor_inertia,) * 3)
        for where, body in (
            ("motor", rigid_body(rigid.motor_mass, (0, 0, 0)) + rotor),
            ("seat", ring),
            ("joint", ring),
            (f"node-{SEGMENTS}", rigid_body(14.1, (0, 0, 0))),
        ):
            a = self.at[where]
            bodies[a : a + 6, a : a + 6] += body
        self.K, self.M = self._sum([*K, springs]), self._sum([*M, bodies])
        self.factor = splu(self.K, diag_pivot_thresh=0.0, options={"SymmetricMode": True})

    def _ties(self, name: str, part: Any, frame: dict) -> sp.csr_matrix:
        """Displacements of a part's points from all freedoms, (1); its inner points get new ones."""
        points = part.mesh.points
        T = sp.lil_matrix((3 * len(points), self.n + 3 * len(points)))
        inner = np.ones(len(points), bool)
        for key, place in part.interfaces.items():
            for i in part.mesh.point_set(key):
                inner[i] = False
                where = frame[name, key]
                if where is not None:
                    a = self.at[where]
                    T[3 * i : 3 * i + 3, a : a + 3] = np.eye(3)
                    T[3 * i : 3 * i + 3, a + 3 : a + 6] = -skew(points[i] - np.array(place))  # eq. (1)
        new = self.n
        for i in np.flatnonzero(inner):
            T[3 * i : 3 * i + 3, new : new + 3] = np.eye(3)
            new += 3
        self.n = new
        return T.tocsr()[:, :new]

    def _sum(self, parts: list) -> sp.csc_matrix:
        total = sp.csc_matrix((self.n, self.n))
        for part in map(sp.coo_matrix, parts):
            total = total + sp.csc_matrix((part.data, (part.row, part.col)), shape=(self.n, self.n))
        return total

    def static(self, force: np.ndarray) -> np.ndarray:
        """Displacement and turn (6,) of the tip under a force on it."""
        load = np.zeros(self.n)
        a = self.at[f"node-{SEGMENTS}"]
        load[a : a + 3] = force
        return self.factor.solve(load)[a : a + 6]

    def frequencies(self, count: int) -> np.ndarray:
        inverse = LinearOperator(self.K.shape, self.factor.solve, dtype=float)
        squares = eigsh(self.K, count, self.M, sigma=0.0, OPinv=inverse, return_eigenvectors=False)
        return np.sort(np.sqrt(squares)) / (2 * np.pi)


@pytest.fixture(scope="module")
def full() -> Full:
    return Full(coarse_design())


@pytest.fixture(scope="module")
def hinge(tmp_path_factory: pytest.TempPathFactory) -> SolidHinge:
    return build_hinge(tmp_path_factory.mktemp("parts"), coarse_design())


def weightless(hinge: SolidHinge) -> flexarm.Arm:
    arm = solid_arm(hinge)
    tube = arm.link("tube").replace(elements=SEGMENTS)
    links = tuple(tube if link.name == "tube" else link for link in arm.links)
    return arm.replace(gravity=(0.0, 0.0, 0.0), links=links)


@pytest.mark.parametrize(("axis", "newtons"), [(0, 1e-3), (1, 1e-3), (2, 1e-2)])
def test_the_tip_yields_to_a_force_as_with_all_freedoms(
    full: Full, hinge: SolidHinge, axis: int, newtons: float
) -> None:
    """Static condensation is exact: what differs is rounding, and the second order of a small bending."""
    force = newtons * np.eye(3)[axis]
    wanted = full.static(force)[:3]
    found = flexarm.static(weightless(hinge), forces={"tip": force.tolist()}).displacement[-1]
    assert found == approx(wanted, rel=1e-6, abs=1e-6 * np.abs(wanted).max())


def test_frequencies_come_from_above_and_near(full: Full, hinge: SolidHinge) -> None:
    """Rayleigh and Ritz: a reduced model has no lower frequency; two modes a part give six within 2e-5."""
    wanted = full.frequencies(6)
    found = flexarm.modes(weightless(hinge), count=6, gravity=False).frequency_hz
    gap = found / wanted - 1
    assert gap.min() > -1e-9
    assert gap.max() < 2e-5


def test_more_internal_modes_come_nearer(full: Full, hinge: SolidHinge, tmp_path: Path) -> None:
    counts = {"housing": 0, "reducer": 0, "hub": 0}
    guyan = build_hinge(tmp_path, hinge.design.replace(modes=counts))
    wanted = full.frequencies(6)
    gaps = [
        flexarm.modes(weightless(each), count=6, gravity=False).frequency_hz / wanted - 1
        for each in (guyan, hinge)
    ]
    assert np.all(gaps[1] <= gaps[0] + 1e-9)
    assert gaps[1].max() < gaps[0].max()
