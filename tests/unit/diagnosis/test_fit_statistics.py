"""Statistics of the fit: residuals of the right model, correlations, motions, effects that nothing shows."""

import diagnoses
import pytest

import flexarm
from flexarm.fit_statistics import FitStatistics
from flexarm.report.diagnosis import page, sketch
from flexarm.report.report_file import report_dict

pytestmark = pytest.mark.slow

RECORDS = {"slow": diagnoses.record(1, step=2e-3), "fast": diagnoses.record(2, 0.25, step=2e-3)}


@pytest.fixture(scope="module")
def found():
    """The diagnosis of an arm on a spring with a model that has none."""
    return flexarm.diagnose(diagnoses.nominal(), RECORDS, n_jobs=1)


def test_the_right_model_leaves_white_noise(found):
    """Of 192 rows and more chi^2/n is within four deviations of 1, the autocorrelation of 0."""
    assert {(c.record, c.signal) for c in found.statistics.channels} == {("slow", "tip"), ("fast", "tip")}
    for each in found.statistics.channels:
        assert each.chi_square == pytest.approx(1.0, abs=4 * (2 / each.rows) ** 0.5)
        assert each.autocorrelation == pytest.approx(0.0, abs=4 / each.rows**0.5)
        assert each.discrepancy < 0.5
    assert [c.axis for c in found.statistics.channels if c.record == "slow"] == ["x", "z"]


def test_motions_are_those_of_the_record(found):
    """A swing of 0.7 rad at 0.25 Hz; its rms rate is at most that of the whole swing."""
    (fast,) = (each for each in found.statistics.motions if each.record == "fast")
    assert (fast.joint, fast.unit) == ("hinge", "rad")
    assert (fast.lowest, fast.highest) == pytest.approx((-0.7, 0.7), abs=0.02)
    assert 0.6 < fast.rms_rate < 0.7 * 2 * 3.1416 * 0.25 / 2**0.5


def test_correlations_are_those_of_different_parameters_the_strongest_first(found):
    values = [abs(each.value) for each in found.statistics.correlations]
    assert values == sorted(values, reverse=True)
    assert 0.5 < values[0] <= 1.0 + 1e-9
    assert all(each.parameters[0] != each.parameters[1] for each in found.statistics.correlations)


def test_priors_are_those_of_the_named_effect_where_it_sits(found):
    """Of a spring its stiffness and its damping; in between lie 95 % of machines."""
    (effect,) = found.effects
    told = {each.parameter: each for each in found.statistics.priors}
    assert {(each.effect, each.at) for each in told.values()} == {(effect.name, effect.at)}
    stated = flexarm.effects.JointCompliance.typical("hinge", diagnoses.nominal()).priors(diagnoses.nominal())
    assert told["stiffness"].low == stated["stiffness"].low
    assert told["stiffness"].low < told["stiffness"].typical < told["stiffness"].high
    assert told["stiffness"].unit == "N m/rad"


def test_the_arm_is_drawn_where_the_records_move_it(found):
    """Both records swing about zero, where the rod of the arm lies along x."""
    figure = sketch(found)
    assert figure.axes[0].get_xlabel() == "x [m]"
    assert sketch(diagnoses.ALL["unusable"]()) is None


def test_a_tracker_alone_shows_no_friction_of_a_motor(found):
    assert "motor_friction" in found.statistics.unseen
    assert "joint_compliance" not in found.statistics.unseen


def test_the_page_tells_them_and_files_keep_them(found, tmp_path):
    text = page(found, [], report_dict(found))
    for told in ("χ²/n", "−0.7", "could not have shown", "motor friction", "most plausible"):
        assert told in text, told
    found.save(tmp_path / "out")
    assert flexarm.Diagnosis.load(tmp_path / "out").statistics == found.statistics


def test_a_diagnosis_of_contradicting_data_has_none():
    assert diagnoses.ALL["unusable"]().statistics == FitStatistics()
    assert "χ²/n" not in page(diagnoses.ALL["unusable"](), [], report_dict(diagnoses.ALL["unusable"]()))
