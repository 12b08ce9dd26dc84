"""Claims about where a gap is: a planted one is found in its cell, and noise in none."""

import numpy as np
import pytest
from arms import LENGTH
from planted import RATIO, run_of

import flexarm
from flexarm.errors import InvalidParameter
from flexarm.residual_analysis.localisation import localise

SIZE = 8e-4  # m, twenty times the noise of the tip


def tangential(run, size):
    """A gap of the tip along its tangent, from a function of time that gives (n,)."""

    def gap(t):
        q = run.state("drive_angle", t)
        return np.stack([np.cos(q), -np.sin(q)], axis=1) * size(t)[:, None]

    return {"tip": gap}


@pytest.fixture(scope="module")
def run():
    return run_of("one joint")


def shares_of_bands(located, signal, direction):
    """Share of the direction's squares by band."""
    cells = [c for c in located.cells if (c.signal, c.direction, c.state) == (signal, direction, "all")]
    total = sum(cell.share for cell in cells)
    return {cell.band: cell.share / total for cell in cells}


@pytest.mark.parametrize("seed", range(5))
def test_white_noise_exceeds_nowhere(run, seed):
    """False alarms have probability 1e-3 a table; five tables."""
    located = localise(run.showing({}, seed))
    assert not any(cell.exceeds for cell in located.cells)
    assert located.where == ()
    assert "nowhere" in str(located)


def test_noise_of_a_cell_is_what_white_noise_leaves_there(run):
    """rms over noise_rms averages to 1 over the bands; 60 freedoms and more each, four sigma."""
    located = localise(run.showing({}, 3))
    for cell in located.cells:
        if cell.state == "all" and cell.signal == "hinge torque":
            freedoms = cell.samples * (cell.noise_rms / 0.5) ** 2
            assert cell.ratio**2 == pytest.approx(1.0, abs=4 * np.sqrt(2 / freedoms))


@pytest.mark.parametrize("which", ["one joint", "two joints"])
def test_parts_add_up_to_the_gap_and_so_do_their_squares(which):
    run = run_of(which)
    gap = {"tip": lambda t: SIZE * np.stack([np.sin(2 * t), np.cos(15 * t)], axis=1)}
    located = localise(run.showing(gap))
    for rows in located.gaps.values():
        for direction, values in rows.directions.items():
            parts = [part.values for part in rows.parts[direction]]
            assert np.sum(parts, axis=0) == pytest.approx(values, abs=1e-9 * np.abs(values).max())
            assert np.sum(np.square(parts)) == pytest.approx(np.sum(values**2), rel=1e-9)
    assert sum(cell.share for cell in located.cells if cell.state == "all") == pytest.approx(1.0, rel=1e-9)


@pytest.mark.parametrize("which", ["one joint", "two joints"])
def test_conditions_of_a_state_share_out_the_gap(which):
    run = run_of(which)
    located = localise({"a": run.showing({}, 1), "b": run.showing({}, 2)})
    sums, counts = {}, {}
    for cell in located.cells:
        key = (cell.signal, cell.direction, cell.band, cell.state)
        sums[key] = sums.get(key, 0.0) + cell.share
        counts[key] = counts.get(key, 0) + cell.samples
    assert len({key[3] for key in sums}) > 6
    for key, share in sums.items():
        assert share == pytest.approx(sums[*key[:3], "all"], rel=1e-9)
        assert counts[key] == counts[*key[:3], "all"]


@pytest.mark.parametrize("multiple", [1, 2])
def test_a_sine_of_the_motor_angle_lies_in_its_harmonic(run, multiple):
    """Though a tracker of 10 Hz folds it: twice a motor turn is 60 periods a radian, up to 9 Hz here."""
    wave = tangential(run, lambda t: SIZE * np.sin(multiple * RATIO * run.state("drive_angle", t) + 0.4))
    located = localise(run.showing(wave))
    assert shares_of_bands(located, "tip", "tangential")[f"{multiple} per motor turn"] > 0.9
    low, high = located.cell("tip", "tangential", f"{multiple} per motor turn").band_hz
    fastest = multiple * RATIO * np.abs(run.simulation.drive_rate).max() / (2 * np.pi)
    assert low < high < fastest


def test_a_multiple_that_is_none_is_no_harmonic(run):
    wave = tangential(run, lambda t: SIZE * np.sin(1.5 * RATIO * run.state("drive_angle", t)))
    bands = shares_of_bands(localise(run.showing(wave)), "tip", "tangential")
    assert not any("per motor turn" in band for band in bands)


def test_a_vibration_at_a_mode_lies_around_it(run):
    pair = run.showing({})
    frequency = pair.modes_hz[0]
    wave = tangential(run, lambda t: SIZE * np.sin(2 * np.pi * frequency * t))
    assert shares_of_bands(localise(run.showing(wave)), "tip", "tangential")["mode 1"] > 0.9


def test_a_slow_gap_is_quasi_static(run):
    slow = tangential(run, lambda t: SIZE * np.cos(run.state("drive_angle", t)))
    assert shares_of_bands(localise(run.showing(slow)), "tip", "tangential")["quasi-static"] > 0.9


def test_a_radial_gap_is_radial(run):
    def gap(t):
        q = run.state("drive_angle", t)
        return SIZE * np.stack([np.sin(q), np.cos(q)], axis=1)

    first = localise(run.showing({"tip": gap})).where[0]
    assert (first["signal"], first["direction"]) == ("tip", "radial")
    assert first["rms"] == pytest.approx(SIZE, rel=0.05)


def test_a_step_with_the_torque_is_said_to_be_at_its_reversal(run):
    located = localise(run.showing(tangential(run, lambda t: SIZE * np.sign(run.state("joint_torque", t)))))
    first = located.where[0]
    assert (first["signal"], first["direction"], first["when"]) == ("tip", "tangential", "torque reversal")
    assert set(first) == {"signal", "direction", "when", "band_hz", "rms", "noise_rms"}
    assert located.dependence["tip"].best == "sign of torque"
    assert located.rotations.joints[0].hint == "backlash"


def test_a_step_with_the_motion_is_said_to_be_at_its_reversal(run):
    located = localise(run.showing(tangential(run, lambda t: SIZE * np.sign(run.state("drive_rate", t)))))
    assert located.where[0]["when"] == "motion reversal"
    assert located.rotations.joints[0].hint == "friction or hysteresis"


def test_a_gap_in_proportion_to_the_torque_follows_it_as_compliance_would(run):
    """The equivalent rotation is the gap over the lever: T/k at k = 3e5 N m/rad."""
    located = localise(run.showing(tangential(run, lambda t: -LENGTH * run.state("joint_torque", t) / 3e5)))
    assert located.dependence["tip"].best == "torque"
    joint = located.rotations.joints[0]
    assert (joint.dependence.best, joint.hint) == ("torque", "compliance")
    torque = run.state("joint_torque", located.rotations.time)
    slope = float(joint.angle @ torque / (torque @ torque))
    assert slope == pytest.approx(-1 / 3e5, rel=0.03)


def test_a_gap_near_one_angle_is_said_to_be_there(run):
    top = float(run.simulation.drive_angle.max())
    near = tangential(run, lambda t: SIZE * np.exp(-(((run.state("drive_angle", t) - top) / 0.15) ** 2)))
    when = localise(run.showing(near)).where[0]["when"]
    assert when.startswith("near +")
    assert float(when.split()[1]) == pytest.approx(top, abs=0.3)


def test_a_drift_follows_time(run):
    located = localise(run.showing(tangential(run, lambda t: SIZE * t / t.max())))
    assert located.dependence["tip"].best == "time"


def test_records_together_show_an_offset_that_changed_between_them(run):
    offset = {"tip": lambda t: np.broadcast_to([SIZE, 0.0], (len(t), 2))}
    moved = {"tip": lambda t: np.broadcast_to([-SIZE, 0.0], (len(t), 2))}
    located = localise({"a": run.showing(offset, 1), "b": run.showing(moved, 2)})
    assert located.gaps["tip"].labels == ("a", "b")
    assert located.dependence["tip"].best in {"the record", "time"}  # time counts by record


def test_a_cell_that_is_not_there_is_an_error_that_tells_what_is(run):
    located = localise(run.showing({}))
    with pytest.raises(InvalidParameter, match=r"'tip', 'radial', 'mode 9'.*signals are hinge torque, tip"):
        located.cell("tip", "radial", "mode 9")


def test_nothing_to_look_at_is_an_error():
    with pytest.raises(InvalidParameter, match="at least one record"):
        localise({})


def test_signals_without_stated_noise_are_weighed_by_their_scatter(run):
    pair = run.showing({})
    signals = [
        signal.replace(noise_std=None) if signal.name == "tip" else signal
        for signal in pair.record.signals.values()
    ]
    bare = run.__class__(run.simulation, pair.record.replace(signals=signals)).showing({}, None)
    located = localise(bare)
    assert any("no noise is stated for tip" in note for note in located.notes)
    assert located.gaps["tip"].noise["tangential"][0] == pytest.approx(4e-5, rel=0.15)


def test_bands_are_those_of_the_modes_that_the_sensors_see(run):
    """A tracker in the plane of a swing does not see the mode across it, which has no motion there."""
    seen, all_modes = run.showing({}).modes_hz, flexarm.modes(run.simulation.arm, count=6)
    across = np.abs(all_modes.shape[:, 0, 1]) > np.abs(all_modes.shape[:, 0, 0])
    assert across.any()
    apart = np.abs(np.subtract.outer(seen, all_modes.frequency_hz[across])).min()
    assert apart > 0.1
