"""A record that states how its base stood: files, errors, simulation and diagnosis."""

import numpy as np
import pytest
from arms import TUBE, beam, hinge, point, smooth_step

import flexarm
from flexarm.arm.effect import read_effect
from flexarm.record import BaseStand, Frame, Signal

ARM = flexarm.Arm.from_dict(
    {
        "joints": [{**hinge("hinge", "rod"), "gear_ratio": 120}],
        "links": [beam("rod", [0, 0, 3.0], TUBE, damping_ratio=0.01)],
        "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
        "points": [point("tip", "rod", [0, 0, 3.0])],
        "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": 1e5, "damping": 100.0}],
        "uncertainty": {"effects.joint_compliance.hinge.stiffness": 0.3},
    }
)
TILT = (0.01, -0.03)


def tilted(angle=TILT) -> flexarm.Arm:
    return ARM.with_effect(read_effect({"name": "base_tilt", "at": "base", "angle": angle}))


def poses(angle, seed: int, name: str = "tracker", noise: float = 2e-5) -> flexarm.Record:
    """Poses of the arm on a tilted base; the frame of the tracker is known to 0.1 mm."""
    joint = np.linspace(-1.2, 1.2, 15)
    rows = np.array([f"{k}" for k in range(len(joint))])
    arm = tilted(angle)
    places = [flexarm.static(arm, {"hinge": q}).position[0] for q in joint]
    seen = np.array(places) + noise * np.random.default_rng(seed).standard_normal((len(joint), 3))
    encoder = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", side="motor", values=joint, pose=rows
    )
    tip = Signal(
        name="tip", quantity="position", point="tip", values=seen, pose=rows, noise_std=noise, frame=name
    )
    return flexarm.Record(
        signals=[encoder, tip],
        drive="hinge",
        kind="static",
        frames={name: Frame(translation=1e-4, rotation=1e-4)},
    )


def test_a_record_with_a_tilt_is_written_and_read(tmp_path):
    for stand in (BaseStand(tilt=TILT, sigma=1e-3), BaseStand(tilt=(0.0, 0.0)), None):
        record = poses(TILT, 1).replace(base=stand)
        record.save(tmp_path / "record", force=True)
        assert flexarm.Record.load(tmp_path / "record").base == stand


@pytest.mark.parametrize(
    ("table", "said"),
    [
        ("tilt = [2.0, 90.0]", "base.tilt (line 12): must turn by at most pi rad in all, got 90.02 rad"),
        ("tilt = 0.1", "base.tilt"),
        ("sigma = 1e-3", "base.tilt (line 11): is missing"),
        ("tilt = [0.0, 0.0]\nsigma = -1.0", "base.sigma (line 13): must be at least 0, got -1 rad"),
        ("tilt = [0.0, 0.0]\nangle = 1.0", "base.angle"),
    ],
)
def test_a_stand_that_cannot_be_is_an_error_that_names_it(tmp_path, table, said):
    poses(TILT, 1).save(tmp_path / "record")
    toml = tmp_path / "record" / "record.toml"
    head, signals = toml.read_text().split("[[signals]]", 1)
    toml.write_text(f"{head}[base]\n{table}\n\n[[signals]]{signals}")
    with pytest.raises(flexarm.InvalidFile) as error:
        flexarm.Record.load(tmp_path / "record")
    assert said in str(error.value)


def test_a_run_on_a_stated_tilt_is_that_of_the_effect():
    t = np.linspace(0, 2, 101)
    drive = Signal(
        name="hinge", quantity="joint_angle", joint="hinge", side="motor",
        values=0.4 * smooth_step(t / 2), time=t,
    )  # fmt: skip
    record = flexarm.Record(signals=[drive], drive="hinge", base=BaseStand(tilt=TILT))
    other = tilted((0.2, 0.2))  # gives way to what was measured
    expected = flexarm.simulate(tilted(), record.replace(base=None)).position
    assert np.array_equal(flexarm.simulate(other, record).position, expected)


def test_two_floors_stand_in_one_diagnosis():
    """Without the tilts the two records contradict one another."""
    flat, pallet = poses((0.0, 0.0), 1), poses((0.0, 0.03), 2)
    stated = {
        "flat": flat.replace(base=BaseStand(tilt=(0.0, 0.0))),
        "pallet": pallet.replace(base=BaseStand(tilt=(0.0, 0.03))),
    }
    assert flexarm.compare(ARM, stated["pallet"]).signals["tip"].rms["total"] < 1e-4
    assert flexarm.compare(ARM, pallet).signals["tip"].rms["total"] > 3e-4
    found = flexarm.diagnose(ARM, stated)
    assert found.verdict == "adequate"
    assert flexarm.diagnose(ARM, {"flat": flat, "pallet": pallet}).verdict != "adequate"


def test_an_uncertain_tilt_is_fitted_along():
    """Stated 1 mrad off, within its sigma: found, not told as an effect."""
    record = poses((0.0, 0.02), 3).replace(base=BaseStand(tilt=(0.0, 0.021), sigma=1e-3))
    found = flexarm.diagnose(ARM, {"run": record})
    assert found.verdict == "adequate"
    [base] = [nuisance for nuisance in found.nuisances if nuisance.name == "base_tilt"]
    assert base.at == "run"
    tilt = {each.name: each for each in base.parameters}
    assert tilt["angle.y"].value == pytest.approx(0.02, abs=4 * tilt["angle.y"].std)
    assert tilt["angle.y"].std < 5e-4
