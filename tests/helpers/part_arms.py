"""Super-elements whose matrices have a closed form."""

from itertools import pairwise
from pathlib import Path

import numpy as np
from arms import EI, LENGTH, RHO_A, STEEL, fixed, hinge
from numpy.typing import NDArray

import flexarm

SHEAR = STEEL["youngs_modulus"] / 2.6


def plane_beam(length: float) -> tuple[NDArray, NDArray]:
    """Euler-Bernoulli stiffness and consistent mass of (w1, t1, w2, t2), t = dw/dx, per EI and per rho A."""
    L = length
    K = np.array(
        [
            [12, 6 * L, -12, 6 * L],
            [6 * L, 4 * L**2, -6 * L, 2 * L**2],
            [-12, -6 * L, 12, -6 * L],
            [6 * L, 2 * L**2, -6 * L, 4 * L**2],
        ]
    )
    M = np.array(
        [
            [156, 22 * L, 54, -13 * L],
            [22 * L, 4 * L**2, 13 * L, -3 * L**2],
            [54, 13 * L, 156, -22 * L],
            [-13 * L, -3 * L**2, -22 * L, 4 * L**2],
        ]
    )
    return K / L**3, M * L / 420


def tube_part(
    length: float = LENGTH, area: float = 5.82e-4, second_moment: float = 2.37e-7, name: str = "tube"
) -> flexarm.SuperElement:
    """A beam along z from "start" to "end" as a super-element: the exact matrices of one cubic element.

    About x a rotation is -dw/dz of the motion along y, about y it is dw/dz of the motion along x.
    """
    E, rho = STEEL["youngs_modulus"], STEEL["density"]
    K, M = np.zeros((12, 12)), np.zeros((12, 12))
    pair = np.array([[1, -1], [-1, 1]]) / length
    share = np.array([[2, 1], [1, 2]]) * length / 6
    bend, sway = plane_beam(length)
    for freedoms, stiffness, mass in (
        ([2, 8], E * area * pair, rho * area * share),
        ([5, 11], SHEAR * 2 * second_moment * pair, rho * 2 * second_moment * share),
        ([0, 4, 6, 10], E * second_moment * bend, rho * area * sway),
    ):
        K[np.ix_(freedoms, freedoms)] = stiffness
        M[np.ix_(freedoms, freedoms)] = mass
    turn = np.diag([1, -1, 1, -1])
    K[np.ix_([1, 3, 7, 9], [1, 3, 7, 9])] = E * second_moment * turn @ bend @ turn
    M[np.ix_([1, 3, 7, 9], [1, 3, 7, 9])] = rho * area * turn @ sway @ turn
    return flexarm.SuperElement(
        name=name,
        interfaces=("start", "end"),
        positions=np.array([[0, 0, 0], [0, 0, length]]),
        rotations=np.array([np.eye(3), np.eye(3)]),
        stiffness=K,
        mass=M,
        damping=np.zeros((12, 12)),
        frequency_hz=np.zeros(0),
    )


def arm_of_parts(folder: Path, segments: int = 4, **more: object) -> dict:
    """The paper's arm along z, its tube as a chain of super-elements in `folder`; the tip as point "tip"."""
    tube_part(LENGTH / segments).save(folder / "segment.nc", force=True)
    names = [f"s{k}" for k in range(segments)]
    joints = [hinge("hinge", "s0:start", **more)]
    joints += [fixed(f"weld-{after}", f"{after}:start", f"{before}:end") for before, after in pairwise(names)]
    end = f"{names[-1]}:end"
    return {
        "joints": joints,
        "links": [
            {"name": name, "type": "superelement", "file": str(folder / "segment.nc")} for name in names
        ],
        "payloads": [{"name": "load", "link": end, "position": [0, 0, 0], "mass": 14.1}],
        "points": [{"name": "tip", "link": end, "position": [0, 0, 0]}],
    }


__all__ = ["EI", "RHO_A", "arm_of_parts", "plane_beam", "tube_part"]
