"""Frames, loads, lengths and angles of a record in units of no machine are doubted beside the model, once."""

from pathlib import Path

import diagnoses
import numpy as np
import pytest
from arms import LENGTH, PAYLOAD, STEEL, TUBE, beam, crane, hinge, point
from arms import arm as arm_of
from part_arms import arm_of_parts

import flexarm
from flexarm.cli.run import run
from flexarm.record import Frame, Signal
from flexarm.record.table import CarriedPayload, DrawnLink


def doubted(record: flexarm.Record, arm: flexarm.Arm | None = None) -> dict[str, str]:
    problems = [*record.check(), *record.check_against(arm or crane())]
    found = {problem.where: problem.what for problem in problems}
    assert len(found) == len(problems)
    return found


def seen_from(frame: Frame) -> flexarm.Record:
    """A swing as a tracker in that frame sees it, and as its owner states that frame."""
    record = diagnoses.record(1)
    return record.replace(frames={"tracker": frame})


def where_it_stands(xyz=(0.0, 0.0, 0.0), scale=1.0, **sigmas: float) -> flexarm.Record:
    """The same seen by a tracker at `xyz` that is stated `scale` times as far."""
    record = seen_from(Frame(xyz=tuple(scale * x for x in xyz), **sigmas))
    tip = record.signals["tip"]
    away = tip.values - np.array(xyz)[[0, 2]]
    return record.replace(signals={**record.signals, "tip": tip.replace(values=away)})


def test_a_frame_in_millimetres_is_doubted():
    found = doubted(where_it_stands((1.2, 0.0, 0.3), scale=1e3, translation=1e-3, rotation=5e-4))
    assert list(found) == ["frames.tracker.xyz"]
    assert found["frames.tracker.xyz"].startswith("is [1200.0, 0.0, 300.0] m and puts tip 123")
    assert found["frames.tracker.xyz"].endswith("the arm reaches 6 m at most; it is in m, not in mm")


@pytest.mark.parametrize("xyz", [(0.0, 0.0, 0.0), (1.2, 0.0, 0.3), (25.0, 0.0, -3.0)])
def test_a_frame_that_stands_where_it_is_stated_is_not(xyz):
    assert doubted(where_it_stands(xyz, translation=1e-3, rotation=5e-4)) == {}


def test_a_frame_that_is_turned_is_looked_at_in_the_base():
    """Positions along all axes, turned by a right angle about z; the stated xyz is in mm, or in m."""
    record = seen_from(Frame())
    tip = record.signals["tip"]
    x, z = tip.values.T
    across = 1e-5 * np.random.default_rng(2).standard_normal(len(x)) - 4.0
    for scale, places in ((1.0, []), (1e3, ["frames.tracker.xyz"])):
        turned = np.stack([across, 7.0 - x, z - 1.0], axis=1)  # of a base at (7, -4, 1) of it
        frame = Frame(xyz=(scale * 7.0, scale * 4.0, scale * 1.0), rpy=(0.0, 0.0, np.pi / 2))
        signals = {**record.signals, "tip": tip.replace(axes=("x", "y", "z"), values=turned, channels=())}
        assert list(doubted(record.replace(signals=signals, frames={"tracker": frame}))) == places


@pytest.mark.parametrize(
    ("sigmas", "where", "what"),
    [
        ({"translation": 1.0}, "frames.tracker.translation", "is 1 m (1 sigma), the arm reaches 3 m"),
        ({"rotation": 0.5}, "frames.tracker.rotation", "is 0.5 rad (1 sigma), 28.6 degrees"),
    ],
)
def test_a_registration_that_is_none_is_doubted(sigmas, where, what):
    found = doubted(seen_from(Frame(**sigmas)))
    assert list(found) == [where]
    assert found[where].startswith(what)
    assert found[where].endswith('a frame of which nothing is known is "unknown"')


@pytest.mark.parametrize("sigmas", [{"translation": 0.3}, {"rotation": 0.1}, {"unknown": True}])
def test_a_rough_registration_is_not(sigmas):
    assert doubted(seen_from(Frame(**sigmas))) == {}


def carrying(mass: float | None = None, **more) -> flexarm.Record:
    return diagnoses.record(1).replace(payloads={"load": CarriedPayload(mass=mass, **more)})


@pytest.mark.parametrize("grams", [1000.0, 5000.0, 14100.0])
def test_a_load_in_grams_is_doubted(grams):
    found = doubted(carrying(grams))
    assert list(found) == ["payloads.load.mass"]
    assert found["payloads.load.mass"].startswith(f"is {grams:g} kg, ")


@pytest.mark.parametrize("mass", [0.0, 0.02, 5.0, 10 * PAYLOAD, 400.0])
def test_a_load_that_is_light_or_heavy_is_not(mass):
    """From none, or a reflector alone, to thirty times the tube."""
    assert doubted(carrying(mass)) == {}


def test_a_load_on_an_arm_that_weighs_nothing_is_not():
    """A laboratory's ruler of 90 g that carries 2 kg, as its model does not."""
    ruler = beam("rod", [0, 0, LENGTH], {"shape": "rectangle", "width": 1e-3, "height": 4e-3}, up=[0, 1, 0])
    light = arm_of(
        joints=[hinge("hinge", "rod")],
        links=[ruler],
        points=[point("tip", "rod", [0, 0, LENGTH])],
        payloads=[{"name": "load", "link": "rod", "position": [0, 0, LENGTH], "mass": 0.0}],
        gravity=[0, 0, 0],
    )
    assert light.links[0].material.density == STEEL["density"]
    assert doubted(carrying(2.0), light) == {}


@pytest.mark.parametrize(
    ("more", "where"),
    [
        ({"position": (0.0, 0.0, 3000.0)}, "payloads.load.position"),
        ({"inertia": (2e5, 2e5, 1e5)}, "payloads.load.inertia"),
    ],
)
def test_a_load_that_is_placed_or_turned_in_millimetres_is_doubted(more, where):
    assert list(doubted(carrying(**more))) == [where]


def test_a_doubt_that_the_model_has_is_not_repeated():
    heavy = crane(payloads=[{"name": "load", "link": "rod", "position": [0, 0, LENGTH], "mass": 14100.0}])
    assert [problem.where for problem in heavy.warnings] == ["payloads.load.mass"]
    assert doubted(carrying(14000.0), heavy) == {}


def test_loads_of_poses_in_grams_are_doubted():
    pose = np.array([f"p{k}" for k in range(6)])
    drive = Signal(name="hinge", quantity="joint_angle", joint="hinge", values=np.arange(6) / 6, pose=pose)
    for factor, places in ((1.0, []), (1e3, ["signals.load"])):
        load = Signal(
            name="load",
            quantity="payload_mass",
            payload="load",
            values=factor * np.array([0, 2, 5, 0, 2, 5]),
            pose=pose,
        )
        record = flexarm.Record(signals=[drive, load], drive=("hinge",), kind="static")
        assert list(doubted(record)) == places


def lifted() -> flexarm.Arm:
    """A mast that slides 30 m, and an arm on it that a motor turns by a gear."""
    tables = crane().to_dict()
    joints = [
        {"name": "lift", "type": "prismatic", "parent": "base", "child": "mast", "axis": [0, 0, 1]},
        hinge("hinge", "rod", "mast"),
        hinge("shaft", "rotor"),
    ]
    links = [*tables["links"], beam("mast", [0, 0, 0.5], TUBE)]
    links.append({"name": "rotor", "type": "rigid", "mass": 1.0, "com": [0, 0, 0], "inertia": [0.01] * 3})
    gears = [{"name": "reducer", "input": "shaft", "output": "hinge", "ratio": 120}]
    own = {key: tables[key] for key in ("payloads", "points", "gravity")}
    return arm_of(joints=joints, links=links, gears=gears, **own)


@pytest.mark.parametrize(
    ("joints", "where"),
    [
        ({"hinge": 30.0}, ["joints.hinge"]),
        ({"lift": 300.0}, ["joints.lift"]),
        ({"shaft": 3000.0}, ["joints.shaft"]),
        ({"hinge": -3.0, "lift": 30.0, "shaft": 150.0}, []),
    ],
)
def test_joints_that_stand_in_degrees_or_millimetres_are_doubted(joints, where):
    tip = diagnoses.record(1).signals["tip"].replace(frame="base", clock="")
    high = tip.replace(values=tip.values + np.array([0.0, joints.get("lift", 0.0)]))
    record = flexarm.Record(signals=[high], joints=joints)
    found = {each: what for each, what in doubted(record, lifted()).items() if each != "drive"}
    assert list(found) == where
    told = {"joints.hinge": "is 30 rad, 4.8 turns; write", "joints.shaft": "is 3000 rad, 477.5 turns; write"}
    assert all(found[each].startswith(told.get(each, "is 300 m")) for each in where)


def test_a_mast_that_slid_far_is_within_its_reach():
    """Positions 30 m up are no millimetres where the drive of the mast says so."""
    record = diagnoses.record(1)
    time, tip = record.signals["hinge"].time, record.signals["tip"]
    lift = Signal(
        name="lift", quantity="joint_angle", joint="lift", time=time, values=80 + 0 * time, unit="m"
    )
    high = tip.replace(values=tip.values + np.array([0.0, 80.0]))
    signals = {**record.signals, "lift": lift.replace(clock="controller"), "tip": high}
    both = record.replace(signals=signals, drive=("hinge", "lift"))
    assert not any("millimetres" in what for what in doubted(both, lifted()).values())


def test_an_arm_of_solid_parts_reaches_as_far_as_they_do(tmp_path: Path):
    """3 m of super-elements on a plinth of 0.1 m: metres are no millimetres, and hundreds of them are."""
    parts = arm_of_parts(tmp_path, origin={"xyz": [0, 0, 0.1]})
    arm, record = arm_of(**parts), diagnoses.record(1)
    assert doubted(record, arm) == {}
    tip = record.signals["tip"]
    wrong = record.replace(signals={**record.signals, "tip": tip.replace(values=200 * tip.values)})
    assert 'if the file holds millimetres, say unit = "mm"' in doubted(wrong, arm)["signals.tip"]


def test_a_boom_drawn_out_to_kilometres_is_doubted():
    record = diagnoses.record(1)
    for length, where in ((3000.0, ["links.rod.length"]), (12.0, [])):
        assert list(doubted(record.replace(links={"rod": DrawnLink(length=length)}))) == where


@pytest.mark.parametrize("command", ["check", "compare", "diagnose"])
def test_commands_show_each_doubt_once(command, tmp_path: Path, capsys):
    crane().to_toml(tmp_path / "arm.toml")
    record = where_it_stands((1.2, 0.0, 0.3), scale=1e3, translation=1.0)
    with_load = record.replace(payloads={"load": CarriedPayload(mass=5000.0)})
    short = {
        name: s.replace(time=s.time[s.time < 2], values=s.values[s.time < 2])
        for name, s in record.signals.items()
    }
    with_load.replace(signals=short).save(tmp_path / "run")
    out = ["--out", str(tmp_path / "out")] if command == "diagnose" else []
    run([command, str(tmp_path / "arm.toml"), str(tmp_path / "run"), *out])
    warned = [line for line in capsys.readouterr().err.splitlines() if line.startswith("warning: ")]
    for where in ("frames.tracker.xyz", "frames.tracker.translation", "payloads.load.mass"):
        assert sum(f"{tmp_path / 'run'}: {where}: " in line for line in warned) == 1


def test_no_case_is_doubted(shared_dir: Path):
    for model in shared_dir.glob("cases/case_*/model.toml"):
        arm = flexarm.Arm.from_toml(model)
        for path in model.parent.glob("*/record.toml"):
            assert doubted(flexarm.Record.load(path.parent), arm) == {}, path
