"""A report shows the gap of every signal that the repair changes, each in its unit."""

from dataclasses import replace

import diagnoses
import pytest
from planted import two_joints
from posed import changed, posed, poses

import flexarm
from flexarm.report.diagnosis import page
from flexarm.report.sentences import changed_signals, gap_tables

NOISE = 0.5


def with_torque(before_rms: float, after_rms: float) -> flexarm.Diagnosis:
    """The diagnosis of a spring whose records hold a torque too, with these gaps [N m]."""

    def beside(side, rms):
        found = {}
        for record, comparison in side.items():
            tip = comparison.signals["tip"]
            total = {"total": rms}
            torque = replace(
                tip, name="torque", quantity="motor_torque", unit="N m", rms=total, max=total, noise_rms=NOISE
            )
            found[record] = replace(comparison, signals={**comparison.signals, "torque": torque})
        return found

    before, after = diagnoses.comparisons()
    return diagnoses.of_effects(before=beside(before, before_rms), after=beside(after, after_rms))


@pytest.mark.parametrize(
    ("before", "after", "shown"),
    [
        (12.0, 0.6, True),
        (0.6, 12.0, True),  # that it grows must be seen
        (0.5, 0.5, False),
        (0.53, 0.5, False),  # less than half of the noise
        (12.0, 11.5, False),  # less than a tenth
    ],
)
def test_a_signal_is_shown_if_the_repair_changes_it_noticeably(before, after, shown):
    assert changed_signals(with_torque(before, after)) == (["torque"] if shown else [])


def test_tables_begin_with_the_main_signal_and_have_units_of_their_own():
    tip, torque = gap_tables(with_torque(12.0, 0.6))
    assert (tip.signal, tip.unit, torque.signal, torque.unit) == ("tip", "mm", "torque", "N m")
    assert [name for name, _ in torque.rows] == ["slow", "fast", "other"]
    assert torque.rows[0][1] == ("12.0", "0.600", "0.500", "12.0", "0.600")


def test_summary_and_page_show_them_and_the_file_keeps_the_main_signal():
    d = with_torque(12.0, 0.6)
    lines = d.summary().splitlines()
    head = next(k for k, line in enumerate(lines) if line.startswith("gap of torque [N m]"))
    assert lines[head + 3].split() == ["other", "(held", "out)", "12.0", "0.600", "0.500", "12.0", "0.600"]
    html = page(d, [], d.to_json_dict())
    assert html.index("gap of tip [mm]") < html.index("gap of torque [N m]") < html.index("A perfect model")
    told = d.to_json_dict()["gap"]
    assert (told["signal"], told["unit"]) == ("tip", "m")


def test_where_only_a_torque_changes_the_verdict_tells_it():
    """A torque that reads 15 N m too much leaves the tip as it is."""

    def record(count, seed):
        torque = {"quantity": "motor_torque", "joint": "shoulder", "side": "output", "noise_std": NOISE}
        seen = posed(two_joints(), poses(2, count, seed), seed, seen={"torque": torque})
        return changed(seen, "torque", seen.signals["torque"].values + 15.0)

    d = flexarm.diagnose(two_joints(), {"yard": record(20, 1)}, record(12, 2), n_jobs=1)
    assert [(effect.name, effect.at) for effect in d.effects] == [("sensor_offset", "torque")]
    text = " ".join(d.summary().split())
    assert (
        "the gap of 'tip' is 58.8 µm rms; sensor noise is 70.7 µm. That of 'torque' shrinks from 15.0 N m"
        in text
    )
    assert "gap of torque [N m]" in text
