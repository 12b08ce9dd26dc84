"""Super-elements in closed loops: a coupler as a solid part beside the same coupler as a beam."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from arms import STEEL, general
from part_arms import tube_part
from pytest import approx

import flexarm

CRANK, COUPLER, ROCKER = 0.4, 1.1, 0.8


def upright(name: str, length: float, mass: float) -> dict:
    across = mass * length**2 / 12
    body = {"name": name, "type": "rigid", "mass": mass, "com": [0, 0, length / 2]}
    return {**body, "inertia": [across, across, 1e-3 * across]}


def hinge(name: str, parent: str, child: str, xyz: tuple[float, ...] = (0, 0, 0)) -> dict:
    ends = {"parent": parent, "child": child, "origin": {"xyz": list(xyz)}}
    return {"name": name, "type": "revolute", "axis": [0, 1, 0], **ends}


def four_bar(part: Path | None) -> flexarm.Arm:
    """A four-bar of bars along z at zero, its coupler the part of a file, or a beam."""
    section = general(5.82e-4, 2.37e-7)
    shape = {"type": "beam", "end": [0, 0, COUPLER], "section": section, "theory": "euler-bernoulli"}
    start, end, far = "coupler", "coupler", [0, 0, COUPLER]
    if part is not None:
        start, end, far = "coupler:start", "coupler:end", [0, 0, 0]
        shape = {"type": "superelement", "file": str(part)}
    else:
        shape |= {"material": STEEL, "elements": 4}
    closure = {"name": "C", "type": "revolute", "axis": [0, 1, 0], "a": end, "a_origin": {"xyz": far}}
    return flexarm.Arm.from_dict(
        {
            "links": [
                upright("crank", CRANK, 2.0),
                {"name": "coupler", **shape},
                upright("rocker", ROCKER, 4.0),
            ],
            "joints": [
                hinge("A", "base", "crank"),
                hinge("B", "crank", start, (0, 0, CRANK)),
                hinge("D", "base", "rocker", (1.0, 0, 0)),
            ],
            "closures": [{**closure, "b": "rocker", "b_origin": {"xyz": [0, 0, ROCKER]}}],
            "payloads": [{"name": "load", "link": end, "position": far, "mass": 5.0}],
            "points": [{"name": "eye", "link": end, "position": far}],
            "assembly": {"A": 0.5, "B": 0.6, "D": -0.2},
        }
    )


def test_a_part_closes_a_loop_as_the_beam_it_is_made_of(tmp_path):
    """At rest exactly, in motion within a micrometre: one cubic element has less bending."""
    tube_part(COUPLER).save(tmp_path / "coupler.nc")
    arms = four_bar(None), four_bar(tmp_path / "coupler.nc")
    as_beam, as_part = (flexarm.static(arm, {"A": 0.5}) for arm in arms)
    assert as_part.position == approx(as_beam.position, abs=1e-9)
    assert as_part.joint_torque[0] == approx(as_beam.joint_torque[0], rel=1e-6)
    time = np.linspace(0, 1, 51)
    turn = flexarm.Drive.from_samples(time, {"A": 0.5 + 0.5 * time**2 * (3 - 2 * time)})
    beam, part = (flexarm.simulate(arm, turn, step=2e-3) for arm in arms)
    assert part.position == approx(beam.position, abs=1e-6)
