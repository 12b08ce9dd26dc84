"""Mistakes that multibody codes make quietly, each turned into a check."""

import numpy as np
import pytest
from arms import G, arm, beam, compliance, drive, general, hinge, paper_arm, point, rigid, smooth_step

import flexarm

STRIP = {"shape": "rectangle", "width": 0.004, "height": 0.02}  # local z stands on the height
E = 210e9


def strip_on_a_roll_joint() -> flexarm.Arm:
    """A weightless strip along x that a joint turns about its own axis, with 0.1 kg at its tip."""
    weightless = {"youngs_modulus": E, "poisson_ratio": 0.3, "density": 0.0}
    return arm(
        joints=[hinge("roll", "strip", axis=[1, 0, 0])],
        links=[beam("strip", [1.0, 0, 0], STRIP, up=[0, 0, 1], material=weightless)],
        payloads=[{"name": "load", "link": "strip", "position": [1.0, 0, 0], "mass": 0.1}],
        points=[point("tip", "strip", [1.0, 0, 0])],
    )


@pytest.mark.parametrize(
    ("roll", "second_moment"), [(0.0, 0.004 * 0.02**3 / 12), (np.pi / 2, 0.02 * 0.004**3 / 12)]
)
def test_a_beam_turns_with_its_arm(roll, second_moment):
    """Upright the strip sags by its strong axis, on its side by its weak one: P L^3/(3 EI)."""
    found = flexarm.static(strip_on_a_roll_joint(), {"roll": roll}).displacement[0]
    sag = 0.1 * G / (3 * E * second_moment)
    assert found[1:] == pytest.approx([0, -sag], abs=3e-3 * sag)


def test_oblique_bending_of_a_turned_strip():
    """At 45 degrees the strip sags and swerves: (w_strong + w_weak)/2 and (w_weak - w_strong)/2."""
    found = flexarm.static(strip_on_a_roll_joint(), {"roll": np.pi / 4}).displacement[0]
    strong, weak = (0.1 * G / (3 * E * i) for i in (0.004 * 0.02**3 / 12, 0.02 * 0.004**3 / 12))
    assert found[2] == pytest.approx(-(strong + weak) / 2, rel=3e-3)
    assert np.abs(found[1]) == pytest.approx((weak - strong) / 2, rel=3e-3)


@pytest.mark.parametrize("axis", [[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 2, -1]])
def test_a_joint_spring_acts_about_its_joint_axis(axis):
    """A weight at r from the joint turns it by (r x m g) . e/k, to second order in that small angle."""
    stiffness, com, mass = 1e5, np.array([0.4, -0.3, 0.2]), 2.0
    sprung = arm(
        joints=[hinge("hinge", "body", axis=axis)],
        links=[rigid("body", mass, com=com)],
        effects=[compliance("hinge", stiffness)],
    )
    found = flexarm.static(sprung)
    unit = np.array(axis) / np.linalg.norm(axis)
    torque = np.cross(com, [0, 0, -mass * G]) @ unit
    assert found.link_angle == pytest.approx([torque / stiffness], abs=2e-8)
    assert found.joint_torque == pytest.approx([-torque], abs=5e-3)


def test_rotation_does_not_drift_over_many_turns():
    """Ten turns and back in 4000 steps: the tip is where it started, to what Newton's iteration leaves."""
    model = paper_arm(2, damping_ratio=0.5)
    round_trip = drive(
        {"hinge": lambda t: 20 * np.pi * (smooth_step(t / 8) - smooth_step((t - 8) / 8))}, 20.0, 4001
    )
    run = flexarm.simulate(model, round_trip, step=5e-3, alpha=-0.3, rotations=True)
    assert np.abs(run.joint_angle).max() == pytest.approx(20 * np.pi)
    assert run.position[-1] == pytest.approx(run.position[0], abs=1e-7)
    assert run.orientation[-1] == pytest.approx(run.orientation[0], abs=1e-7)
    assert np.linalg.norm(run.orientation, axis=-1) == pytest.approx(np.ones_like(run.orientation[..., 0]))


@pytest.mark.parametrize("elements", [200, 1000])
def test_default_tolerance_lies_above_the_floor_of_the_residual(elements):
    """Fine meshes are badly conditioned; statics and steps still converge, to the coarse mesh's answer."""
    coarse, fine = paper_arm(16, 1e5), paper_arm(elements, 1e5)
    expected = flexarm.static(coarse, {"hinge": 1.2}).displacement
    assert flexarm.static(fine, {"hinge": 1.2}).displacement == pytest.approx(expected, abs=1e-8)
    move = drive({"hinge": lambda t: 1.2 + 0.3 * smooth_step(t / 0.1)}, 0.1, 201)
    runs = [flexarm.simulate(model, move, step=5e-3) for model in (coarse, fine)]
    assert runs[1].solver["halvings"] == 0
    assert runs[1].position == pytest.approx(runs[0].position, abs=1e-5)


def test_the_recorder_is_not_one_step_late():
    """Every row belongs to its instant: drive and tip of a rigid arm are where they are at time[i]."""
    lever = arm(
        joints=[hinge("hinge", "lever")],
        links=[rigid("lever", 1.0, com=[0, 0, 0.5])],
        points=[point("tip", "lever", [0, 0, 2.0])],
    )
    q = lambda t: 0.5 + 0.8 * np.sin(3 * t) * smooth_step(t)  # noqa: E731
    run = flexarm.simulate(lever, drive({"hinge": q}, 1.0, 2001), step=0.01)
    assert run.time == pytest.approx(0.01 * np.arange(101), abs=1e-15)
    angle = q(run.time)
    assert run.drive_angle[:, 0] == pytest.approx(angle, abs=1e-10)
    tip = 2 * np.stack([np.sin(angle), 0 * angle, np.cos(angle)], axis=-1)
    assert run.position[:, 0] == pytest.approx(tip, abs=1e-9)
    moving = slice(20, 100)
    slope = (q(run.time + 1e-6) - q(run.time - 1e-6)) / 2e-6
    assert run.joint_rate[moving, 0] == pytest.approx(slope[moving], abs=1e-6)
    assert np.linalg.norm(run.velocity[moving, 0], axis=-1) == pytest.approx(
        2 * np.abs(slope[moving]), abs=5e-3
    )


def test_a_run_covers_its_end():
    """The last instant is the first at or after `end`, also where the step does not divide the span."""
    run = flexarm.simulate(paper_arm(1), drive({"hinge": lambda t: 0.1 * smooth_step(t)}, 1.0), step=0.03)
    assert run.time[-1] == pytest.approx(1.02)
    assert len(run.time) == 35


def test_a_mass_within_a_beam_keeps_its_place():
    """A payload between the ends has a node of its own: sag under it is P a^3/(3 EI) for any mesh."""
    second = 1e-8
    weightless = {"youngs_modulus": E, "poisson_ratio": 0.3, "density": 0.0}
    for elements in (1, 3, 4):
        bar = arm(
            joints=[hinge("hinge", "bar")],
            links=[beam("bar", [1.0, 0, 0], general(1e-3, second), material=weightless, elements=elements)],
            payloads=[{"name": "load", "link": "bar", "position": [0.37, 0, 0], "mass": 0.01}],
            points=[point("there", "bar", [0.37, 0, 0]), point("tip", "bar", [1.0, 0, 0])],
        )
        a, load = 0.37, 0.01 * G
        sag, slope = load * a**3 / (3 * E * second), load * a**2 / (2 * E * second)
        found = flexarm.static(bar).displacement[:, 2]
        assert found == pytest.approx([-sag, -sag - slope * (1 - a)], rel=1e-6)
