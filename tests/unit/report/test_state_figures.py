"""Claims about the gap against what the arm did: what is drawn is the gap, at the joint that turns."""

from dataclasses import replace

import diagnoses
import numpy as np
import pytest
from planted import run_of
from pytest import approx

from flexarm.arm.effect import effect_class
from flexarm.named_effects import NamedEffect
from flexarm.report.diagnosis import _figures
from flexarm.report.files import style
from flexarm.report.state_figures import (
    against_states,
    located_sides,
    most_repaired,
    rotations,
    shown_joints,
)
from flexarm.residual_analysis.localisation import localise


@pytest.fixture(scope="module")
def bent_elbow():
    """Two joints, of which the elbow's angle is off by 2e-4 rad per unit sine of its own motion."""
    run = run_of("two joints")

    def gap(t):
        q, p = run.state("drive_angle", t), run.state("drive_angle", t, 1)
        turn = 2e-4 * np.sin(3 * p)
        return 1.2 * turn[:, None] * np.stack([np.cos(q + p), -np.sin(q + p)], axis=1)

    model = run.simulation.arm
    located = localise(run.showing({"tip": gap}))
    return diagnoses.of_effects(arm=model, updated=model, located=located, located_after=None)


def test_dots_are_the_gap_against_the_torque_that_acted():
    d = diagnoses.of_effects()
    with style():
        figure = against_states(d)
    last = figure.axes[2]
    assert last.get_xlabel() == "torque of hinge [N m]"
    rows = d.located.gaps["tip"]
    nominal, updated = last.get_lines()
    assert nominal.get_xdata() == approx(rows.states[0].torque)
    assert nominal.get_ydata() == approx(1e3 * rows.directions["tangential"])
    assert updated.get_ydata() == approx(1e3 * d.located_after.gaps["tip"].directions["tangential"])


def test_a_model_without_the_direction_is_left_out_of_the_picture():
    """A frame turned out of the plane of the measured axes, as two exchanged columns turn it."""
    d = diagnoses.of_effects()
    after = d.located_after
    tip = after.gaps["tip"]
    lost = replace(tip, directions={k: v for k, v in tip.directions.items() if k != "tangential"})
    turned = replace(after, gaps={**after.gaps, "tip": lost})
    with style():
        figure = against_states(replace(d, located_after=turned))
        assert len(figure.axes[2].get_lines()) == 1


def test_several_joints_are_shown_with_the_rotation_of_each(bent_elbow):
    with style():
        figure = rotations(bent_elbow)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert labels[:3] == [
        f"{kind} of elbow [{unit}]" for kind, unit in (("angle", "rad"), ("rate", "rad/s"), ("torque", "N m"))
    ]
    found = bent_elbow.located.rotations.joints[0]
    assert found.joint == "elbow"
    [line] = figure.axes[0].get_lines()
    ratio = line.get_ydata() / found.angle
    assert ratio == approx(ratio[0])
    assert figure.axes[0].get_ylabel() == "elbow [mrad]"


def test_the_joint_that_turns_is_the_one_that_is_drawn(bent_elbow):
    with style():
        figure = against_states(bent_elbow)
    assert figure.axes[0].get_xlabel() == "angle of elbow [rad]"


def test_every_joint_is_drawn_under_a_title_that_says_so(bent_elbow):
    with style():
        figure = against_states(bent_elbow)
    labels = [ax.get_xlabel() for ax in figure.axes]
    assert [label.split(" [")[0] for label in labels] == [
        f"{kind} of {joint}" for joint in ("elbow", "shoulder") for kind in ("angle", "rate", "torque")
    ]
    direction = figure.axes[0].get_ylabel().split(" [")[0]
    title = figure.axes[0].get_title(loc="left")
    assert title == f"tip, {direction}: measured − model, against each joint"
    [caption] = [text for name, _, text, _ in _figures(bent_elbow) if name == "states"]
    assert f"tip, {direction}" in caption
    assert "of elbow and shoulder, a row each" in caption


def test_where_an_effect_is_named_its_joint_comes_first(bent_elbow):
    named = NamedEffect("coulomb_friction", "shoulder", 0.9)
    d = replace(bent_elbow, effects=(named,))
    assert [states.joint for states in shown_joints(d)] == ["shoulder", "elbow"]


def test_one_joint_needs_no_figure_of_rotations():
    assert rotations(diagnoses.of_effects()) is None


def test_nothing_is_drawn_where_nothing_was_located():
    assert against_states(diagnoses.lean()) is None
    assert rotations(diagnoses.unusable()) is None


def test_a_model_that_stays_is_drawn_once():
    d = diagnoses.of_effects()
    assert list(located_sides(d, "tip")) == ["nominal model", "updated model"]
    same = diagnoses.of_effects(updated=d.arm, located_after=d.located)
    assert list(located_sides(same, "tip")) == ["nominal model"]


def test_an_effect_is_shown_in_the_signal_that_it_repairs():
    """Friction of a motor moves no tip, but its torque."""
    run = run_of("one joint")

    def friction(t):
        return 30 * np.sign(run.state("drive_rate", t))

    before, after = (localise(run.showing(gap)) for gap in ({"hinge torque": friction}, {}))
    d = diagnoses.of_effects(located=before, located_after=after)
    assert most_repaired(d) == "hinge torque"


@pytest.mark.parametrize(
    ("effect", "state"),
    [
        ("backlash", "torque"),
        ("coulomb_friction", "rate"),
        ("encoder_eccentricity", "angle"),
        ("clock_drift", "time"),
    ],
)
def test_an_effect_is_drawn_against_what_its_law_speaks_of(effect, state):
    assert effect_class(effect).varies_with == state


def test_poses_have_no_rate_in_figure_and_caption():
    [(text, figure)] = [
        (text, figure) for name, _, text, figure in _figures(diagnoses.of_poses()) if name == "states"
    ]
    assert not [ax for ax in figure.axes if ax.get_xlabel().startswith("rate")]
    assert "against angle and torque of elbow and shoulder" in text
