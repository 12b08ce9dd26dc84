"""What a campaign says: Sobol indices, quantiles, yield, trends, and the page that tells them."""

import re

import numpy as np
import pytest
from campaign_runs import MASS, SIMULATED, STATIC, study_in
from scipy.stats import sobol_indices, uniform

import flexarm
from flexarm import InvalidParameter
from flexarm.campaigns.diagnose_run import DiagnoseRun
from flexarm.campaigns.findings import findings_of
from flexarm.campaigns.indices import SeriesIndices, from_saltelli, from_samples
from flexarm.campaigns.sampling import Distribution, samples
from flexarm.campaigns.study import Sampling
from flexarm.campaigns.trends import times_of, trend
from flexarm.report.campaign import _index_bars, page

CUBE = [Distribution("uniform", (-np.pi, np.pi))] * 3
A, B = 7.0, 0.1
VARIANCE = A**2 / 8 + B * np.pi**4 / 5 + B**2 * np.pi**8 / 18 + 0.5
FIRST = np.array([(1 + B * np.pi**4 / 5) ** 2 / 2, A**2 / 8, 0.0]) / VARIANCE
TOTAL = FIRST + np.array([1, 0, 1]) * 8 * B**2 * np.pi**8 / 225 / VARIANCE
"""Of Ishigami's function: I. M. Sobol and Y. Levitan, Computer Physics Communications 117 (1999), 52-61."""


def ishigami(x):
    return np.sin(x[:, 0]) + A * np.sin(x[:, 1]) ** 2 + B * x[:, 2] ** 4 * np.sin(x[:, 0])


def test_saltellis_rows_give_the_indices_of_ishigamis_function():
    """Within 0.03 at 2048 rows, some three standard errors of the first-order estimator with Sobol points."""
    x = samples(Sampling(n=2048, seed=2, saltelli=True), CUBE, [None] * 3)
    found = from_saltelli(ishigami(x).reshape(5, -1))
    assert found.first == pytest.approx(FIRST, abs=0.03)
    assert found.total == pytest.approx(TOTAL, abs=0.03)
    assert (found.total90[:, 0] < found.total).all()


def test_few_sobol_points_give_unbiased_indices_of_a_sum():
    """Parameters are no noise of one another: one by one, indices of 64 points were 0.03 too small."""
    share = np.array([1.0, 0.9, 0.3]) ** 2 / (1 + 0.81 + 0.09)
    found = []
    for seed in range(6):
        x = samples(Sampling(n=64, seed=seed, method="sobol"), CUBE, [None] * 3)
        found.append(from_samples(x, x @ [1.0, 0.9, 0.3]).first)
    assert np.mean(found, axis=0) == pytest.approx(share, abs=0.01)


def test_a_full_grid_has_the_variances_of_its_means():
    """Interaction is no chance there; 8 levels of each."""
    levels = np.linspace(0, 1, 8)
    x = np.array([(a, b) for a in levels for b in levels])
    y = x[:, 0] + x[:, 1] + 3 * x[:, 0] * x[:, 1]
    expected = [np.var([y[x[:, k] == level].mean() for level in levels]) / np.var(y) for k in (0, 1)]
    assert from_samples(x, y).first == pytest.approx(expected, rel=1e-9)


def test_numbers_of_machines_are_no_times():
    labels = {"machine": ["101", "101", "102", "102"], "date": ["2025-01-01", "2026-01-01"] * 2}
    name, _, is_date = times_of(labels)
    assert (name, is_date) == ("date", True)


def test_the_estimators_are_those_of_scipy():
    rng = np.random.default_rng(5)
    x = samples(Sampling(n=256, seed=3, saltelli=True), CUBE, [None] * 3)
    f = ishigami(x).reshape(5, -1)
    theirs = sobol_indices(
        func={"f_A": f[:1], "f_B": f[1:2], "f_AB": f[2:][:, None]}, n=256, dists=[uniform()] * 3, rng=rng
    )
    ours = from_saltelli(f)
    assert ours.first == pytest.approx(theirs.first_order.ravel(), abs=1e-12)
    assert ours.total == pytest.approx(theirs.total_order.ravel(), abs=1e-12)


def test_rows_of_a_failed_run_are_left_out():
    x = samples(Sampling(n=512, seed=2, saltelli=True), CUBE, [None] * 3)
    f = ishigami(x).reshape(5, -1)
    damaged = f.copy()
    damaged[3, 7] = np.nan
    assert from_saltelli(damaged).total == pytest.approx(from_saltelli(np.delete(f, 7, axis=1)).total)


@pytest.mark.parametrize("method", ["sobol", "latin-hypercube", "random"])
def test_plain_samples_give_first_order_indices_and_no_total_ones(method):
    """Lines between 12 knots lose below 1 % of the variance of a sine; 0.05 are two standard errors."""
    x = samples(Sampling(method=method, n=2048, seed=8), CUBE, [None] * 3)
    found = from_samples(x, ishigami(x))
    assert found.first == pytest.approx(FIRST, abs=0.05)
    assert np.isnan(found.total).all()


def test_a_parameter_without_influence_has_no_index_on_average():
    """The correction takes away what chance gives: without it the mean would be 3/99, of three functions."""
    rng = np.random.default_rng(1)
    found = [from_samples(rng.random((100, 1)), rng.normal(size=100)).first[0] for _ in range(60)]
    assert np.mean(found) == pytest.approx(0.0, abs=0.02)


def test_a_series_of_two_parameters_parts_into_what_each_makes():
    """y = 2 a sin t + b cos t with variances 1: 4/5 and 1/5 of the variance, in pieces as whole."""
    x = samples(Sampling(n=1024, seed=4), [Distribution("normal", (0.0, 1.0))] * 2, [None] * 2)
    t = np.linspace(0, 2 * np.pi, 60, endpoint=False)
    y = 2 * x[:, :1] * np.sin(t) + x[:, 1:] * np.cos(t)
    whole, pieces = SeriesIndices(x), SeriesIndices(x)
    whole.add(y)
    for first in range(0, 60, 17):
        pieces.add(y[:, first : first + 17])
    assert whole.first == pytest.approx([0.8, 0.2], abs=0.03)
    assert pieces.first == pytest.approx(whole.first, abs=1e-12)
    assert whole.variance / 60 == pytest.approx(2.5, rel=0.02)


def test_a_resample_may_lack_a_value():
    """Of 60 samples one has the third value: it is in 63 % of the resamples."""
    x = np.r_[np.zeros(30), np.ones(29), 2.0][:, None]
    found = from_samples(x, x[:, 0] + np.random.default_rng(2).normal(size=60))
    assert 0.02 < found.first90[0, 1] - found.first90[0, 0] < 0.5


def test_few_samples_say_nothing():
    assert from_samples(np.zeros((20, 1)), np.arange(20.0)) is None


def test_a_planted_trend_is_found_beside_constants_of_the_machines():
    rng = np.random.default_rng(3)
    dates = ["2024-01-15", "2024-07-15", "2025-01-15", "2025-07-15"]
    labels = {"machine": [f"m{k}" for k in range(20) for _ in dates], "date": dates * 20}
    name, time, is_date = times_of(labels)
    assert (name, is_date) == ("date", True)
    assert time[:4] == pytest.approx([0, 0.498, 1.002, 1.498], abs=1e-3)
    level = np.repeat(rng.normal(1e-3, 3e-4, 20), 4)
    grows = level + 1e-4 * time + rng.normal(0, 2e-5, 80)
    found = trend("gap", "rad", time, grows, labels["machine"])
    assert found.slope == pytest.approx(1e-4, abs=4 * found.std)
    assert found.score > 10
    assert abs(trend("gap", "rad", time, level + rng.normal(0, 2e-5, 80), labels["machine"]).score) < 3


def test_estimates_that_are_missing_are_left_out_of_a_trend():
    time, value = np.array([0.0, 1, 0, 1, 0, 1]), np.array([1.0, 2, 3, 4, np.nan, 9])
    found = trend("gap", "rad", time, value, ["a", "a", "b", "b", "c", "c"])
    assert found.slope == pytest.approx(1.0)
    assert len(found.value) == 5


def findings(folder, text):
    done = flexarm.campaign(study_in(folder, text), folder / "out", n_jobs=1)
    keys = [each["key"] for each in done.record["parameters"]]
    with done.dataset as data:
        return done, findings_of(data.load(), keys, [], done.record["study"]["sampling"]["seed"]), data


def test_quantiles_and_yield_are_those_of_the_rows(tmp_path):
    done, found, data = findings(tmp_path, SIMULATED.replace("n = 16", "n = 64"))
    (share,) = found.yields
    assert share.share == pytest.approx(float((data["tip_position_max"] <= 1e-3).mean()))
    assert share.low90 < share.share < share.high90
    deviation = data["tip_position"] - data["tip_position_nominal"]
    for band in found.bands:
        values = deviation.sel(axis=band.name[-1]).values
        assert band.quantiles == pytest.approx(
            np.quantile(values, [0.05, 0.25, 0.5, 0.75, 0.95], axis=0), abs=1e-15
        )
    assert [band.name for band in found.bands] == ["tip_position x", "tip_position z"]  # the arm is planar
    most = next(each for each in found.targets if each.name == "tip_position_max")
    assert most.quantiles[2] == pytest.approx(float(data["tip_position_max"].median()))
    assert done.directory.joinpath("summary.html").stat().st_size > 50_000


def test_a_weight_explains_all_of_a_sag(tmp_path):
    """The sag is linear in the one mass that varies, so its index is 1."""
    _, found, _ = findings(tmp_path, STATIC)
    sag = next(each for each in found.targets if each.name == "tip_displacement z")
    assert sag.indices.first[0] == pytest.approx(1.0, abs=1e-6)
    assert sag.nominal == pytest.approx(sag.quantiles[2], rel=0.2)


@pytest.mark.parametrize("saltelli", [False, True])
def test_bars_of_indices_sit_at_their_names(tmp_path, saltelli):
    _, found, _ = findings(
        tmp_path, STATIC.replace("n = 50", "n = 64\nsaltelli = true") if saltelli else STATIC
    )
    targets = [each for each in found.targets if each.indices is not None][:1]
    [axes] = _index_bars(found, targets).axes
    middles = [bar.get_y() + bar.get_height() / 2 for bar in axes.patches]
    assert np.mean(middles) == pytest.approx(np.mean(axes.get_yticks()))
    assert len(axes.patches) == (2 if saltelli else 1) * len(axes.get_yticks())


def test_the_page_is_whole_and_fetches_nothing(tmp_path):
    done, found, _ = findings(tmp_path, SIMULATED.replace("n = 16", "n = 64\nsaltelli = true"))
    html = (tmp_path / "out" / "summary.html").read_text()
    assert html == page(found, done.record)
    assert re.findall(r'(?:src|href)="(?!data:)', html) == []
    assert html.count("data:image/png;base64,") == 3
    told = flexarm.Campaign.load(tmp_path / "out").summary()
    assert " costs most: " in told
    assert "  tip_position_max: median " in told
    assert "nominal</th>" not in html  # all statistics are of the deviation from the nominal run
    for words in (
        MASS,
        "Yield",
        "Which parameter matters",
        "total",
        "Along the run",
        "costs most",
        "256 runs, none of which failed",
    ):
        assert words in html


FLEET = """
format = "flexarm-study/1"
run = "diagnose"
model = "arm.toml"
records = ["{machine}/{date}/slow"]
"""


def test_the_page_of_a_fleet_tells_which_effect_grows(tmp_path, monkeypatch):
    """Twelve diagnoses: the gap of each machine grows by 1e-4 rad a year, its mass does not; one fails."""
    dates = ("2024-01-15", "2025-01-15", "2026-01-15")
    for k in range(4):
        for date in dates:
            (tmp_path / f"m{k}" / date / "slow").mkdir(parents=True)
    rng = np.random.default_rng(7)

    def outcome(self, arm, case):
        machine, year = divmod(case, 3)
        if case == 5:
            raise InvalidParameter("there is no signal", where="drive")
        gap = 2e-4 + 2e-5 * machine + 1e-4 * year + 1e-6 * rng.normal()
        mass = 2.0 + 0.01 * rng.normal()
        found = {"effects.backlash.hinge.gap": (gap, "rad"), "effects.backlash.hinge.gap.std": (1e-6, "rad")}
        refined = {"refined.payloads.load.mass": (mass, "kg"), "refined.payloads.load.mass.std": (0.01, "kg")}
        return {"verdict": "effects", "effects.backlash.hinge.probability": (0.9, "-"), **found, **refined}

    monkeypatch.setattr(DiagnoseRun, "outcome", outcome)
    done = flexarm.campaign(study_in(tmp_path, FLEET), tmp_path / "out", n_jobs=1)
    data = done.dataset
    assert data["machine"].values.tolist() == [f"m{k}" for k in range(4) for _ in dates]
    assert data["effects.backlash.hinge.gap"].attrs["units"] == "rad"
    assert np.isnan(data["effects.backlash.hinge.gap"].values[5])
    found = findings_of(data, [], ["machine", "date"])
    assert found.trends[0].name == "effects.backlash.hinge.gap"
    assert found.trends[0].slope == pytest.approx(1e-4, rel=0.05)
    assert found.named == (("backlash.hinge", 11, pytest.approx(0.9)),)
    html = (tmp_path / "out" / "summary.html").read_text()
    assert "effects.backlash.hinge.gap grows by" in html
    assert "11 of 12" in html
    assert "drive: there is no signal" in html


def test_the_page_tells_why_runs_failed(tmp_path):
    done, _, _ = findings(tmp_path, STATIC.replace("low = 1.0", "low = -1.0"))
    html = (tmp_path / "out" / "summary.html").read_text()
    assert f"50 runs, of which {done.record['runs']['failed']} failed." in html
    assert "payloads.load.mass: must be at least 0" in html
