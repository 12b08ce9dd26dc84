"""`flexarm reproduce`: every file is there and whole, and the paper's claims come out of the data."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from pytest import approx

from flexarm import Arm, InvalidFile, Record, SuperElement, compare, static
from flexarm.reproduction import reproduce

pytestmark = pytest.mark.slow

FIGURES = ("04", "06", "07", "08", "09", "10")
Columns = dict[str, np.ndarray]


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One reproduction for all tests of this file."""
    directory = tmp_path_factory.mktemp("reproduce") / "results"
    reproduce(directory)
    return directory


@pytest.fixture(scope="module")
def summary(out: Path) -> dict[str, Any]:
    content: dict[str, Any] = json.loads((out / "summary.json").read_text(encoding="utf-8"))
    return content


def columns(out: Path, number: str) -> Columns:
    with (out / f"figure-{number}.csv").open(encoding="utf-8") as file:
        header, *rows = list(csv.reader(file))
    values = np.array([[float(cell) if cell else np.nan for cell in row] for row in rows])
    return {name: values[:, i] for i, name in enumerate(header)}


@pytest.mark.parametrize("number", FIGURES)
def test_figure_is_there_as_picture_drawing_and_data(out: Path, summary: dict[str, Any], number: str) -> None:
    assert (out / f"figure-{number}.png").read_bytes().startswith(b"\x89PNG")
    assert (out / f"figure-{number}.pdf").read_bytes().startswith(b"%PDF")
    entry = summary["figures"][number]
    assert entry["csv"] == f"figure-{number}.csv"
    found = columns(out, number)
    assert list(found) == list(entry["columns"])
    for name, values in found.items():
        assert np.isfinite(values).any(), name
        assert np.ptp(values[np.isfinite(values)]) > 0 or number == "06", name


@pytest.mark.parametrize("number", FIGURES)
def test_figure_holds_more_than_white_paper(out: Path, number: str) -> None:
    from matplotlib.image import imread

    pixels = imread(out / f"figure-{number}.png")[..., :3]
    assert pixels.shape[1] >= 1200
    assert 0.01 < np.mean(pixels.min(axis=2) < 0.9) < 0.5


def test_input_shaft_turns_by_120_times_the_sine(out: Path) -> None:
    """Figure 4: ±144 rad over 133 s, two periods."""
    found = columns(out, "04")
    time, shaft = found["time_s"], found["input_shaft_rad"]
    assert (time[0], time[-1]) == approx((0, 133))
    assert (shaft.max(), shaft.min()) == approx((144, -144), rel=1e-5)
    assert shaft == approx(144 * np.sin(2 * np.pi * time / 66.5), abs=1e-6)


def test_measured_columns_hold_the_trackers_samples_and_nothing_between_them(out: Path) -> None:
    record = Record.load(out / "virtual-measurement")
    tip = record.signals["tip"]
    found = columns(out, "07")
    seen = np.isfinite(found["measured_x_m"])
    assert found["time_s"][seen] == approx(tip.time, abs=1e-6)
    assert found["measured_x_m"][seen] == approx(tip.values[:, 0], abs=1e-8)
    assert found["measured_z_m"][seen] == approx(tip.values[:, 2], abs=1e-8)
    assert np.isfinite(found["model_x_m"]).all()
    assert np.isfinite(found["rigid_z_m"]).all()


def test_figures_agree_with_one_another(out: Path) -> None:
    """Figure 9 is the difference of figure 7's curves, figure 8 a part of figure 7."""
    seven, eight, nine = (columns(out, number) for number in ("07", "08", "09"))
    assert nine["model_z_m"] == approx(seven["model_z_m"] - seven["rigid_z_m"], abs=3e-8)
    measured = seven["measured_x_m"] - seven["rigid_x_m"]
    assert nine["measured_x_m"] == approx(measured, abs=3e-8, nan_ok=True)
    part = np.isin(seven["time_s"], eight["time_s"])
    assert part.sum() == len(eight["time_s"]) > 100
    assert eight["model_z_m"] == approx(seven["model_z_m"][part], abs=3e-8)


def test_tangential_error_is_that_of_the_two_coordinates(out: Path) -> None:
    """Figures 9 and 10: e_t = e_x cos θ - e_z sin θ at the rigid arm's own angle."""
    seven, nine, ten = (columns(out, number) for number in ("07", "09", "10"))
    angle = np.arctan2(seven["rigid_x_m"], seven["rigid_z_m"])
    wanted = nine["model_x_m"] * np.cos(angle) - nine["model_z_m"] * np.sin(angle)
    assert ten["encoder_m"] == approx(wanted, abs=1e-7)


def test_all_claims_hold_by_their_own_numbers(summary: dict[str, Any]) -> None:
    claims = summary["claims"]
    assert [claim["id"] for claim in claims] == [1, 2, 3, 4, 5, 6]
    for claim in claims:
        assert {"id", "statement", "value", "unit", "threshold", "holds"} <= set(claim)
        met = claim["value"] <= claim["threshold"]
        assert met if claim["needs"] == "at most" else claim["value"] >= claim["threshold"], claim
        assert claim["holds"], claim["statement"]


def test_claims_follow_from_the_published_data(out: Path, summary: dict[str, Any]) -> None:
    """Claims 1, 2 and 4 once more, from the CSV files alone."""
    claims = {claim["id"]: claim for claim in summary["claims"]}
    seven, ten = columns(out, "07"), columns(out, "10")
    seen = np.isfinite(seven["measured_x_m"])

    def gap(name: str) -> float:
        off = [seven[f"measured_{k}_m"][seen] - seven[f"{name}_{k}_m"][seen] for k in "xz"]
        return float(np.sqrt(np.mean(off[0] ** 2 + off[1] ** 2)))

    assert claims[1]["value"] == approx(gap("rigid") / gap("model"), rel=1e-3)
    assert 0.01 < gap("rigid") < 0.1
    assert gap("model") < 1e-3
    tangential = np.sqrt(np.mean(ten["measured_m"][seen] ** 2))
    assert claims[2]["value"] == approx(tangential**2 / gap("rigid") ** 2, abs=1e-4)
    # Second differences over half a period of the first mode leave oscillations and little of the carrier.
    equal = np.arange(40, 130, 0.2)
    shaking = {
        name: np.std(np.diff(np.interp(equal, ten["time_s"], ten[name]), 2))
        for name in ("sine_m", "encoder_m")
    }
    assert shaking["sine_m"] < 0.15 * shaking["encoder_m"]


def test_split_is_open_by_the_data_and_adds_up_in_the_model(summary: dict[str, Any]) -> None:
    """Compliances in series: the two shares are the whole, but for their interaction under gravity."""
    split = summary["claims"][4]["numbers"]
    assert split["hinge_share"] + split["tube_share"] == approx(1, abs=0.01)
    # 3 rad on k: M g sin(1.2 rad) L/k with M g = 14.1 kg and half the rod's weight times 9.81.
    stiffness = split["hinge_stiffness_Nm_per_rad"]
    assert split["hinge_max_m"] == approx(3 * 616.6 * np.sin(1.2) / stiffness, rel=0.02)
    assert split["correlation"] > 0.9999
    assert split["hinge_share_std"] > 0.3
    assert split["only_hinge_rms_m"] < 2 * split["both_rms_m"]


def test_parts_made_rigid_one_at_a_time_share_the_error(summary: dict[str, Any]) -> None:
    """Housing, reducer and hub together are the hinge, with the tube the whole; the reducer leads."""
    split = summary["claims"][4]["numbers"]
    of_hinge = [split[f"{part}_part"] for part in ("housing", "reducer", "hub")]
    assert sum(of_hinge) == approx(split["hinge_share"], abs=0.01)
    assert sum(of_hinge) + split["tube_part"] == approx(1, abs=0.01)
    assert 0 < of_hinge[0] < of_hinge[2] < of_hinge[1]


def test_hinge_is_made_from_mesh_to_file_and_as_stiff_as_said(out: Path, summary: dict[str, Any]) -> None:
    """The model beside the figures holds the three super-elements; its tip is where the CSV has it."""
    arm = Arm.from_toml(out / "model.toml")
    parts = summary["parameters"]["hinge_parts"]
    for name in ("housing", "reducer", "hub"):
        part = SuperElement.load(out / "hinge" / f"{name}.nc")
        assert part.mass_total == approx(parts[name]["mass_kg"])
        assert part.n_modes == parts[name]["modes"] == 6
    assert 0.9e5 < summary["parameters"]["hinge_stiffness_Nm_per_rad"] < 1.1e5
    bench = summary["parameters"]["bench_hinge_stiffness_Nm_per_rad"]
    assert bench == approx(summary["parameters"]["hinge_stiffness_Nm_per_rad"], rel=0.02)
    assert arm.gears[0].ratio == 120
    shape = columns(out, "06")
    angle = np.arctan2(shape["rigid_x_m"][-1], shape["rigid_z_m"][-1])
    resting = static(arm, joints={"hinge": float(angle)}).position[-1]
    assert [shape["model_x_m"][-1], shape["model_z_m"][-1]] == approx(resting[[0, 2]], abs=5e-3)


def test_misprint_is_told_with_numbers_of_its_own(out: Path, summary: dict[str, Any]) -> None:
    misprint = summary["misprint"]
    assert misprint["printed_rod_kg"] == approx(1.39, abs=0.01)
    assert misprint["printed_tip_error_max_m"] < 0.8 * misprint["consistent_tip_error_max_m"]
    assert misprint["printed_first_mode_hz"] > 1.05 * misprint["consistent_first_mode_hz"]
    assert summary["parameters"]["parameter_set"] == "consistent"
    assert "contradicts" in (out / "index.html").read_text(encoding="utf-8")


def test_page_shows_every_figure_and_says_what_is_virtual(out: Path, summary: dict[str, Any]) -> None:
    text = (out / "index.html").read_text(encoding="utf-8")
    for number in FIGURES:
        assert f'src="figure-{number}.png"' in text
    for claim in summary["claims"]:
        assert f"<td>{claim['id']}</td>" in text
    assert "authors' data are not public" in text.replace("&#39;", "'")
    assert "{{" not in text
    assert "nan" not in text.lower().replace("dominant", "")


def test_record_beside_the_figures_can_be_compared_with_the_model(out: Path) -> None:
    """Aligned, the gap at the hub is noise, that at the tip what friction leaves."""
    found = compare(Arm.from_toml(out / "model.toml"), Record.load(out / "virtual-measurement"))
    hub, tip = found.signals["hub"], found.signals["tip"]
    assert hub.rms["total"] == approx(np.sqrt(3) * 5e-5, rel=0.1)
    assert 1e-4 < tip.rms["total"] < 1e-3  # type: ignore[operator]


def test_output_that_holds_files_is_refused(out: Path) -> None:
    with pytest.raises(InvalidFile, match="holds files already"):
        reproduce(out)


def test_interruption_leaves_nothing(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def stop(*_: Any, **__: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("flexarm.reproduction.study.Models.build", stop)
    with pytest.raises(KeyboardInterrupt):
        reproduce(tmp_path / "results")
    assert list(tmp_path.iterdir()) == []
