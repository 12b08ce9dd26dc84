"""The GIRAF boom: its readers, and what pulls at eight lengths and ring-downs at three say of it.

The boom's bending stiffness is not known, so it is fitted along to all pulls, as an effect would be.
"""

import numpy as np
import pytest
from tests.helpers.example_scripts import EXAMPLES, load_script
from tests.helpers.pose_fit import fitted, gap, rms

import flexarm
from flexarm import Arm, InvalidFile, Record
from flexarm.arm.effect import read_effect
from flexarm.arm.parameter import parameters
from flexarm.comparison.aligned_record import simulate_record
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.residual_analysis.free_decay import describe_free_decays, free_decays

FOLDER = EXAMPLES / "giraf_boom"
HEADER = "Boom Extension (mm),Applied Force (N),Endpoint Height (mm),Deflection (mm)\n"
STIFFNESS = "links.boom.material.youngs_modulus"
READING = 1e-3 / np.sqrt(12)
SCRIPT = load_script("giraf_boom", "make_records")
RING_DOWNS = load_script("giraf_boom", "ring_downs")


# ------------------------------------------------------------------------------------------------- the reader


def test_pulls_become_forces_downward_and_heights_places_of_the_tip(tmp_path):
    """Invented rows of two lengths: a record each, in SI."""
    (tmp_path / "static.csv").write_text(HEADER + "500,0,370,5\n500,2.5,360,15\n1000,0,350,25\n")
    SCRIPT.make_records(tmp_path, tmp_path / "out")
    record = Record.load(tmp_path / "out/static_0500")
    assert record.links["boom"].length == 0.5
    assert record.poses == ("0 N", "2.5 N")
    assert record.signals["pull"].values[:, 0].tolist() == [0.0, -2.5]
    assert record.signals["tip"].values[:, 0].tolist() == [0.37, 0.36]
    assert record.signals["tip"].noise_std == pytest.approx(READING)
    assert record.frames["floor"].xyz == (0.0, 0.0, -0.375)
    assert record.check_against(Arm.from_toml(tmp_path / "out/boom.toml")) == []
    assert Record.load(tmp_path / "out/static_1000").links["boom"].length == 1.0


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "line 1: must be 'Boom Extension"),
        (HEADER, "file: holds no readings"),
        (HEADER + "500,0,370\n", "line 2: must be 4 numbers, got '500,0,370'"),
        (HEADER + "500,0,370,5\n500,1,nan,5\n", "line 3: must be 4 numbers"),
        (HEADER + "500,0,370,6\n", "line 2: height and deflection must add up to 375 mm, got 376 mm"),
    ],
)
def test_wrong_files_are_named_with_the_place_of_the_fault(tmp_path, text, message):
    (tmp_path / "static.csv").write_text(text)
    with pytest.raises(InvalidFile, match=rf"static\.csv: {message}"):
        SCRIPT.make_records(tmp_path, tmp_path / "out")
    assert not (tmp_path / "out").exists()


def ring_down_file(folder, name="ringdown_10p5in_trial1.csv"):
    """A sensor upside down, 0.1 rad askew, with a gain of 0.9; the boom rests, then stands upright."""
    rows = ["t,accel_x,accel_y,accel_z,pitch_pos"]
    for k in range(1200):
        pitch = 0.2 if k < 100 else np.pi / 2
        along, across = 0.9 * 9.81 * np.sin(pitch - 0.1), 0.9 * 9.81 * np.cos(pitch - 0.1)
        rows.append(f"{k / 458:.9f},{-across:.12f},0.0,{-along:.12f},{pitch:.12f}")
    (folder / name).write_text("\n".join(rows) + "\n")
    return folder / name


def test_a_reading_at_rest_says_how_the_accelerometer_sits(tmp_path):
    """Gain and skew drop out: specific force is g along the boom once it stands upright."""
    record = RING_DOWNS.ring_down_record(ring_down_file(tmp_path))
    assert record.links["boom"].length == pytest.approx(10.5 * 0.0254 + 0.265)
    force = record.signals["imu"].values
    assert force[0] == pytest.approx([9.81 * np.sin(0.2), 9.81 * np.cos(0.2)])
    assert force[-1] == pytest.approx([9.81, 0.0], abs=1e-9)
    assert record.signals["pitch"].values[-1, 0] == pytest.approx(np.pi / 2)
    assert record.check_against(Arm.from_toml(FOLDER / "ringdown.toml")) == []


def test_wrong_ring_downs_are_named_with_the_place_of_the_fault(tmp_path):
    with pytest.raises(InvalidFile, match=r"ringdown_long\.csv: name: must be ringdown_INCHES"):
        RING_DOWNS.length_of(tmp_path / "ringdown_long.csv")
    path = ring_down_file(tmp_path)
    lines = path.read_text().splitlines()
    for text, message in (
        ("t,x\n", "line 1: must be 't,accel_x"),
        (lines[0], "file: holds no readings"),
        ("\n".join([lines[0], "1,2,3"]), "line 2: must be 5 numbers"),
        ("\n".join(lines[:90]), "pitch_pos: must rest for 50 samples and then move"),
    ):
        path.write_text(text)
        with pytest.raises(InvalidFile, match=message):
            RING_DOWNS.ring_down_record(path)


# --------------------------------------------------------------------------------------------------- the data


@pytest.fixture(scope="module")
def folders(shared_dir, tmp_path_factory):
    """Records of all lengths, by name."""
    out = tmp_path_factory.mktemp("giraf") / "records"
    return {folder.name: folder for folder in SCRIPT.make_records(shared_dir / "data/giraf_boom", out)}


@pytest.fixture(scope="module")
def boom(folders):
    """Model, and a record for each length."""
    records = [Record.load(folder) for name, folder in folders.items() if name.startswith("static")]
    return Arm.from_toml(FOLDER / "boom.toml"), records


TILT = ({"name": "base_tilt", "at": "base"}, "effects.base_tilt.base.angle.y")
COMPLIANCE = (
    {"name": "joint_compliance", "at": "pitch", "stiffness": 2e3},
    "effects.joint_compliance.pitch.stiffness",
)
MASS = ({"name": "link_mass", "at": "boom", "scale": 1.0}, "effects.link_mass.boom.scale")

# Effects; rms over all lengths [m], of each length foretold from the other seven; parameters of the effects.
FITS = {
    "bending alone": ((), 7.35e-3, 7.60e-3, ()),
    "joint compliance": ((COMPLIANCE,), 6.97e-3, 7.12e-3, (1216.0,)),
    "base tilt": ((TILT,), 3.16e-3, 3.72e-3, (10.74e-3,)),
    "base tilt and mass": ((TILT, MASS), 2.34e-3, 2.93e-3, (8.90e-3, 1.318)),
}


def with_effects(arm, effects):
    for table, _ in effects:
        arm = arm.with_effect(read_effect(table))
    return arm, [STIFFNESS, *(key for _, key in effects)]


@pytest.mark.parametrize("name", FITS)
def test_what_effects_leave_at_a_length_that_was_left_out(boom, name):
    effects, all_rms, left_out_rms, values = FITS[name]
    arm, keys = with_effects(boom[0], effects)
    records = boom[1]
    best = fitted(arm, records, keys)
    assert rms(gap(best, records)) == pytest.approx(all_rms, rel=5e-3)
    assert [p.value for p in parameters(best, keys[1:])] == pytest.approx(values, rel=5e-3)
    left_out = []
    for k, record in enumerate(records):
        others = [*records[:k], *records[k + 1 :]]
        left_out += gap(fitted(arm, others, keys), [record])
    assert rms(left_out) == pytest.approx(left_out_rms, rel=5e-3)


def test_a_tilted_base_explains_half_of_what_a_soft_joint_leaves():
    """The tempting name is the wrong one of the two; what remains is ten readings large."""
    left = {name: fit[2] for name, fit in FITS.items()}
    assert left["base tilt"] < 0.55 * left["joint compliance"]
    assert left["base tilt and mass"] < 3.1e-3
    assert left["base tilt and mass"] > 10 * READING


def test_with_a_load_at_the_tip_a_soft_joint_foretells_each_length_twice_as_well(boom):
    """The load is known to its order only, and fitted along: without it the soft joint leaves 7 mm."""
    arm, keys = with_effects(Arm.from_toml(FOLDER / "boom_with_hand.toml"), [COMPLIANCE])
    keys.append("payloads.hand.mass")
    records = boom[1]
    best = fitted(arm, records, keys)
    assert rms(gap(best, records)) == pytest.approx(1.6e-3, abs=0.05e-3)
    assert best.payload("hand").mass == pytest.approx(0.14, abs=0.02)
    left_out = []
    for k, record in enumerate(records):
        others = [*records[:k], *records[k + 1 :]]
        left_out += gap(fitted(arm, others, keys), [record])
    assert rms(left_out) == pytest.approx(1.78e-3, abs=0.05e-3)
    assert rms(left_out) < 0.5 * FITS["base tilt"][2]


def diagnosed_without_the_longest(folders, model):
    """As a user would: seven lengths, the longest held out."""
    records = {name: Record.load(folder) for name, folder in folders.items() if name.startswith("static")}
    held = records.pop("static_2013")
    return flexarm.diagnose(Arm.from_toml(FOLDER / model), records, hold_out=held, n_jobs=1)


def test_a_diagnosis_with_a_load_at_the_tip_names_the_joint(folders):
    """What is left is above the reading, so that it is not certain; the longest boom is foretold to 2 mm."""
    found = diagnosed_without_the_longest(folders, "boom_with_hand.toml")
    assert found.verdict == "unexplained"
    (soft,) = found.effects
    assert (soft.name, soft.at) == ("joint_compliance", "pitch")
    assert 0.5 < soft.probability < SelectionPolicy.most_certain
    assert "base_compliance" in {other.name for other in soft.alternatives}
    gap = found.gap(found.held_out)
    assert 5 * READING < gap.after_rms < 2.0e-3
    assert gap.after_rms < 0.3 * gap.before_rms


def test_a_diagnosis_without_the_load_foretells_the_longest_boom(folders):
    """A soft joint, and a bow or a tilt that no data tell apart; what is left is above the reading."""
    found = diagnosed_without_the_longest(folders, "boom.toml")
    assert found.verdict == "unexplained"
    named = {(effect.name, effect.at): effect for effect in found.effects}
    assert all(effect.probability < SelectionPolicy.most_certain for effect in found.effects)
    bow = named["link_bow", "boom"]
    assert "base_tilt" in {other.name for other in bow.alternatives}
    assert ("joint_compliance", "pitch") in named
    gap = found.gap(found.held_out)
    assert gap.after_rms < min(0.3 * gap.before_rms, 3.1e-3)
    assert gap.after_rms > READING


# The greatest swing and the mean of those below half of it: amplitude [m/s2], frequency [Hz], damping ratio.
ENDS = {
    "ringdown_0551": ((2.94, 3.34, 0.056), (0.54, 3.81, 0.026)),
    "ringdown_1065": ((1.60, 1.90, 0.055), (0.45, 2.19, 0.027)),
    "ringdown_1639": ((5.83, 1.12, 0.068), (1.32, 1.26, 0.047)),
}


def test_ring_downs_are_slower_and_more_damped_the_larger_they_are(folders):
    """At every length, by far more than the errors of it; no linear law does that."""
    arm = Arm.from_toml(FOLDER / "ringdown.toml")
    pairs = {name: simulate_record(arm, Record.load(folders[name])) for name in ENDS}
    found = free_decays(pairs)
    assert [each.record for each in found] == list(ENDS)
    for each in found:
        for piece, (amplitude, frequency, damping) in zip(each.ends, ENDS[each.record], strict=True):
            assert piece.amplitude == pytest.approx(amplitude, rel=0.1)
            assert piece.frequency_hz == pytest.approx(frequency, rel=0.02)
            assert piece.damping_ratio == pytest.approx(damping, abs=0.005)
        assert each.frequency_moves
        assert each.damping_moves
    assert "frequency and damping move with the amplitude" in describe_free_decays(found)
