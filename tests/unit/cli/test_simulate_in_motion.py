"""`flexarm simulate --moving, --rate, --joint`: runs that begin in motion, from the command line."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from arms import G, arm, rigid
from pytest import approx
from scipy.special import ellipj

import flexarm
from flexarm.cli.run import run

LENGTH, RATE = 0.7, 5.0
HINGE = {"name": "q", "type": "revolute", "parent": "car", "child": "bob", "axis": [0, -1, 0]}
SLIDE = {"name": "x", "type": "prismatic", "parent": "base", "child": "car", "axis": [1, 0, 0]}


@pytest.fixture(autouse=True)
def trolley(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> flexarm.Arm:
    """A pendulum on a car, and drives that hold the car, move it steadily, and move nothing."""
    monkeypatch.chdir(tmp_path)
    model = arm(joints=[SLIDE, HINGE], links=[rigid("car", 2.0), rigid("bob", 1.0, (0, 0, -LENGTH))])
    model.to_toml("trolley.toml")
    for name, header, rows in (("held", "x", ["0", "0"]), ("steady", "x", ["0", "1.6"])):
        text = "".join(f"{t},{x}\n" for t, x in zip((0, 2), rows, strict=True))
        Path(f"{name}.csv").write_text(f"time_s,{header}\n{text}")
    Path("free.csv").write_text("time_s\n0\n2\n")
    return model


def simulated(*arguments: str) -> flexarm.Simulation:
    assert (
        run(["simulate", "trolley.toml", "--step", "0.002", "--alpha", "0", "--out", "out", *arguments]) == 0
    )
    return flexarm.Simulation.load("out/simulation.nc")


@pytest.mark.parametrize("drive", ["held", "steady"])
def test_a_pendulum_thrown_from_a_car_swings_as_an_elliptic_function(drive):
    """sin(q/2) = k sn(w t, k), k = rate/(2 w); on a car of constant speed as on one at rest."""
    found = simulated("--drive", f"{drive}.csv", "--rate", f"q={RATE}")
    w = np.sqrt(G / LENGTH)
    k = RATE / (2 * w)
    exact = 2 * np.arcsin(k * ellipj(w * found.time, k**2)[0])
    assert found.joint_angle[:, 1] == approx(exact, abs=1e-4)


def test_a_pendulum_let_go_at_an_angle_swings_back(capsys):
    """Begun at rest at an amplitude of 0.1, with a period of 2 pi sqrt(l/g) (1 + 0.1^2/16)."""
    found = simulated("--drive", "held.csv", "--joint", "q=0.1", "--rate", "q=0")
    period = 2 * np.pi * np.sqrt(LENGTH / G) * (1 + 0.1**2 / 16)
    assert found.joint_angle[0, 1] == approx(0.1, abs=1e-12)
    assert np.interp(period / 4, found.time, found.joint_angle[:, 1]) == approx(0.0, abs=1e-5)
    assert capsys.readouterr().err == ""


def test_a_joint_that_is_told_where_to_stand_stands_there():
    found = simulated("--drive", "held.csv", "--joint", "q=0.3")
    assert found.joint_angle[:, 1] == approx(0.3, abs=1e-12)
    assert flexarm.Record.load("out").joints == {"q": 0.3}


def test_a_car_that_begins_in_motion_has_no_jerk_at_its_start():
    """Of 0.8 m/s from the start; begun at rest the first accelerations are those of a jump."""
    rates = [
        simulated("--drive", "steady.csv", *words, "--force").joint_rate[0, 0]
        for words in ((), ("--moving",))
    ]
    assert rates == approx([0.0, 0.8], abs=1e-9)
    assert flexarm.Record.load("out").initial == "moving"


def test_where_nothing_is_driven_times_alone_will_do():
    """Nothing pushes along the slide: the momentum stays."""
    found = simulated("--drive", "free.csv", "--rate", "q=1", "--rate", "x=0")
    momentum = 3.0 * found.joint_rate[:, 0] + LENGTH * found.joint_rate[:, 1] * np.cos(
        found.joint_angle[:, 1]
    )
    assert momentum == approx(np.full(len(found.time), LENGTH), abs=1e-5)


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("held.csv", "--rate", "x=1"), "--rate: the drive moves 'x' from its first row on; allowed are"),
        (("held.csv", "--joint", "x=1"), "--joint: the drive moves 'x'"),
        (
            ("held.csv", "--rate", "q"),
            "--rate: must be NAME=RATE with a plain number in SI units, such as x=0.5, got 'q'",
        ),
        (("held.csv", "--rate", "r=1"), "--rate: there is no moving joint 'r'"),
        (("free.csv",), "free.csv: header: drives no joint"),
    ],
)
def test_what_cannot_begin_so_is_refused(words, said, capsys):
    assert run(["simulate", "trolley.toml", "--out", "out", "--drive", *words]) == 2
    assert said in capsys.readouterr().err
    assert not Path("out").exists()


def test_a_record_says_itself_how_it_begins(capsys):
    simulated("--drive", "held.csv")
    assert run(["simulate", "trolley.toml", "--out", "again", "--drive", "out", "--moving"]) == 2
    assert "is a record, which says itself" in capsys.readouterr().err
