"""Records of frequency responses: files, errors, and the gap to the linear model."""

import json

import numpy as np
import pytest
from arms import TUBE, beam, compliance, hinge, point
from numpy.typing import NDArray
from right_files import RESPONSES

import flexarm
from flexarm.cli.run import run
from flexarm.record import Clock, Frame, Signal
from flexarm.units import ratio_factor

ANGLE, RATIO = 0.3, 120.0


def arm(stiffness: float = 1e5) -> flexarm.Arm:
    return flexarm.Arm.from_dict(
        {
            "joints": [{**hinge("hinge", "rod"), "gear_ratio": RATIO, "rotor_inertia": 1e-3}],
            "links": [beam("rod", [0, 0, 3.0], TUBE, damping_ratio=0.005)],
            "payloads": [{"name": "load", "link": "rod", "position": [0, 0, 3.0], "mass": 14.1}],
            "points": [point("tip", "rod", [0, 0, 3.0])],
            "effects": [compliance("hinge", stiffness, 150.0)],
            "sensors": [
                {"name": "imu", "quantity": "acceleration", "point": "tip", "axes": ["x"], "rate_hz": 100}
            ],
        }
    )


FREQUENCY = np.linspace(0.5, 40, 160)


def mobility(model: flexarm.Arm) -> NDArray[np.complex128]:
    """Acceleration of the tip along its x by a force along the base's x."""
    linear = flexarm.linearise(model, {"hinge": ANGLE}, inputs={"tip": "force"}, outputs=["imu"])
    return linear.frequency_response(FREQUENCY)[:, 0, 0]


@pytest.fixture
def folder(tmp_path):
    (tmp_path / "record.toml").write_text(RESPONSES)
    rng = np.random.default_rng(1)
    H = mobility(arm())
    coherence = 0.99
    sigma = np.abs(H) * np.sqrt((1 - coherence) / (2 * 8 * coherence))
    H = H + sigma * (rng.standard_normal(len(H)) + 1j * rng.standard_normal(len(H)))
    rows = [
        f"{f!r},{h.real!r},{h.imag!r},{coherence}"
        for f, h in zip(FREQUENCY.tolist(), H.tolist(), strict=True)
    ]
    (tmp_path / "frf.csv").write_text("hz,re,im,coherence\n" + "\n".join(rows) + "\n")
    return tmp_path


def test_units_of_output_per_input():
    assert ratio_factor("mm/kN", ("m",), ("N",)) == (("m", "N"), pytest.approx(1e-6))
    assert ratio_factor("m/s2/N", ("m/s2",), ("N",)) == (("m/s2", "N"), 1.0)
    assert ratio_factor("deg/(N m)", ("rad", "m"), ("N m", "N"))[0] == ("rad", "N m")
    assert ratio_factor("1", ("rad", "m"), ("rad", "m")) == (("rad", "rad"), 1.0)
    assert ratio_factor(None, ("m",), ("N m", "N")) == (("m", "N m"), 1.0)
    with pytest.raises(flexarm.InvalidParameter, match="unit 'm/V' does not fit"):
        ratio_factor("m/V", ("m",), ("N",))


def test_a_record_is_read_saved_and_read_again(folder, tmp_path):
    record = flexarm.Record.load(folder)
    imu = record.signals["imu"]
    assert (record.kind, imu.input, imu.unit, imu.averages) == ("frequency_response", "hammer", "m/s2/N", 8)
    assert imu.response.shape == (160, 1)
    assert len(record.signals["hammer"].values) == 0
    assert record.check() == []
    record.save(tmp_path / "again")
    again = flexarm.Record.load(tmp_path / "again").signals["imu"]
    for name in ("values", "frequency", "coherence"):
        assert np.array_equal(getattr(again, name), getattr(imu, name))
    assert (again.input, again.unit, again.averages) == (imu.input, imu.unit, imu.averages)


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ('input = "hammer"', 'input = "hamer"', "there is no signal 'hamer'; there are hammer"),
        ('unit = "m/s2/N"', 'unit = "m/s2/V"', "unit 'm/s2/V' does not fit; allowed is m/s2/(N)"),
        ('frequency = "hz"', 'time = "hz"', "frequency"),
        ('channels = ["re", "im"]', 'channels = ["re"]', "must be 2 for axes = ['x'], got 1"),
        (
            'axes = ["x"]\n\n',
            'axes = ["x", "y"]\n\n',
            "'hammer' is a force along 2 axes; an input is a force",
        ),
        (
            'kind = "frequency_response"',
            'kind = "motion"',
            "belongs to a record of kind 'frequency_response'",
        ),
        ('frequency = "hz"', 'frequency = "Hz"', "there is no column 'Hz'"),
    ],
)
def test_what_cannot_be_is_an_error(folder, old, new, said):
    (folder / "record.toml").write_text(RESPONSES.replace(old, new, 1))
    with pytest.raises(flexarm.InvalidFile) as error:
        flexarm.Record.load(folder)
    assert said in str(error.value)


def test_a_record_of_responses_is_called_that(folder, capsys):
    arm().to_toml(folder / "arm.toml")
    assert run(["check", str(folder)]) == 0
    said = capsys.readouterr().out
    assert "signal hammer: force at tip [N], the input of responses" in said
    assert "poses" not in said
    view = ["view", str(folder), "--model", str(folder / "arm.toml"), "--out", str(folder / "page.html")]
    assert run(view) == 2
    refused = capsys.readouterr().err
    assert refused.startswith(f"error: {folder}: kind: holds frequency responses; only motions are shown")
    assert run(["diagnose", str(folder / "arm.toml"), str(folder), "--out", str(folder / "why")]) == 2
    assert capsys.readouterr().err.startswith(f"error: {folder}: kind: is a frequency response")


def test_bands_without_frequencies_are_not_told(folder):
    whole = flexarm.compare_responses(arm(), flexarm.Record.load(folder))
    assert len(whole.signals["imu"].bands) == 3
    text = (folder / "frf.csv").read_text().splitlines()
    first = 1 + int(np.searchsorted(FREQUENCY, 0.6 * whole.modes_hz[0]))
    (folder / "frf.csv").write_text("\n".join([text[0], *text[first:]]) + "\n")
    cut = flexarm.compare_responses(arm(), flexarm.Record.load(folder))
    assert len(cut.signals["imu"].bands) == 2


def test_frequencies_must_rise(folder):
    text = (folder / "frf.csv").read_text().splitlines()
    (folder / "frf.csv").write_text("\n".join([*text[:3], text[2], *text[3:]]) + "\n")
    with pytest.raises(
        flexarm.InvalidFile, match="line 4, column hz: frequencies must be at least 0 and rise"
    ):
        flexarm.Record.load(folder)


def test_a_right_model_leaves_noise_and_a_soft_joint_a_gap(folder):
    record = flexarm.Record.load(folder)
    gap = flexarm.compare_responses(arm(), record).signals["imu"]
    squares = np.abs(gap.measured - gap.model) ** 2 / (2 * gap.noise**2)
    assert np.mean(squares) == pytest.approx(1.0, abs=0.25)  # 3 sigma of 160 rows
    soft = flexarm.compare_responses(arm(0.5e5), record).signals["imu"]
    assert soft.rms["total"] > 10 * gap.rms["total"]
    assert np.sum([band.rms**2 for band in soft.bands]) == pytest.approx(soft.rms["total"] ** 2)


@pytest.mark.parametrize(
    ("quantity", "side", "port", "factor"),
    [
        ("motor_torque", "output", "torque", 1.0),
        ("motor_torque", "motor", "torque", RATIO),
        ("joint_angle", "motor", "angle", 1.0),
    ],
)
def test_joints_are_inputs_by_torque_and_angle(quantity, side, port, factor):
    """Positions in a turned frame, of which two axes are measured."""
    model = arm()
    linear = flexarm.linearise(model, {"hinge": ANGLE}, inputs={"hinge": port}, outputs=["tip"])
    H = factor * linear.frequency_response(FREQUENCY)[:, :, 0]
    seen = np.stack([H[:, 2], -H[:, 0]], axis=1)  # rpy = (0, pi/2, 0): z of the base is -x of the frame
    frame = Frame(rpy=(0.0, -np.pi / 2, 0.0))
    drive = Signal(
        name="drive",
        quantity=quantity,
        joint="hinge",
        side=side,
        values=np.empty((0, 1)),
        frequency=np.empty(0),
    )
    parts = np.stack([seen[:, 0].real, seen[:, 0].imag, seen[:, 1].real, seen[:, 1].imag], axis=1)
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        frame="turned",
        values=parts,
        frequency=FREQUENCY,
        input="drive",
    )
    record = flexarm.Record(
        signals=[drive, tip], kind="frequency_response", joints={"hinge": ANGLE}, frames={"turned": frame}
    )
    found = flexarm.compare_responses(model, record)
    assert found.signals["tip"].relative_rms < 1e-6
    assert any("no noise is stated for tip" in note for note in found.notes)
    assert found.plot().get_xlabel() == "frequency [Hz]"
    table = found.signals["tip"].table()
    assert table.columns[1] == f"measured x real [{found.signals['tip'].unit}]"
    columns = table.to_numpy()
    assert columns[:, 1:5] == pytest.approx(columns[:, [3, 4, 1, 2]], rel=1e-4)  # measured and model


STIFFNESS, DAMPING, INERTIA = 2e4, 30.0, 3.4
LATE = 4e-3


def two_inertias(*effects: dict) -> flexarm.Arm:
    """A rigid link behind a soft reducer that turns backwards, without gravity."""
    rod = {"name": "rod", "type": "rigid", "mass": 1.0, "com": [0, 0, 0], "inertia": [2.0, INERTIA, 2.0]}
    return flexarm.Arm.from_dict(
        {
            "gravity": [0, 0, 0],
            "joints": [{**hinge("hinge", "rod"), "gear_ratio": -RATIO, "rotor_inertia": 1e-3}],
            "links": [rod],
            "points": [point("tip", "rod", [0, 0, 1.0])],
            "effects": [compliance("hinge", STIFFNESS, DAMPING), *effects],
        }
    )


def response_to_angle(model: flexarm.Arm, of: str, clock: str = "", **place: object) -> NDArray:
    """Response to the angle of the hinge that the model tells."""
    drive = Signal(
        name="drive",
        quantity="joint_angle",
        joint="hinge",
        side=of,
        values=np.empty((0, 1)),
        frequency=np.empty(0),
    )
    ones = np.tile([1.0, 0.0], (len(FREQUENCY), 1))
    out = Signal(name="out", values=ones, frequency=FREQUENCY, input="drive", clock=clock, **place)
    clocks = {"": Clock(), "late": Clock(offset=LATE), "lost": Clock(unknown=True)}
    record = flexarm.Record(signals=[drive, out], kind="frequency_response", clocks=clocks)
    return flexarm.compare_responses(model, record).signals["out"].model[:, 0]


GYRO = {"quantity": "angular_rate", "point": "tip", "axes": ("y",)}
LINK = {"quantity": "joint_angle", "joint": "hinge", "side": "output"}
S = 2j * np.pi * FREQUENCY
FOLLOWS = (STIFFNESS + DAMPING * S) / (INERTIA * S**2 + STIFFNESS + DAMPING * S)
"""The link's angle over the motor's."""


def test_an_angle_is_an_input_on_either_side_of_the_gear():
    """Of the link's own angle the gyroscope reads the rate, however soft the reducer is."""
    model = two_inertias()
    assert response_to_angle(model, "output", **GYRO) == pytest.approx(S, rel=1e-9)
    assert response_to_angle(model, "motor", **GYRO) == pytest.approx(S * FOLLOWS, rel=1e-9)


@pytest.mark.parametrize(
    ("name", "at", "keys", "factor"),
    [
        ("encoder_scale", "out", {"scale": 1.02}, 1.02),
        ("encoder_scale", "drive", {"scale": 1.02}, 1 / 1.02),
        ("encoder_eccentricity", "out", {"amplitude": 0.05, "phase": 0.4}, 1 + 0.05 * np.cos(0.4)),
        ("sign_error", "out", {}, -1.0),
        ("unit_error", "out", {"factor": 1e3}, 1e3),
        ("time_delay", "out", {"delay": LATE}, np.exp(-S * LATE)),
        ("time_delay", "drive", {"delay": LATE}, np.exp(S * LATE)),
    ],
)
def test_effects_of_sensors_act_on_responses(name, at, keys, factor):
    """As on a motion: the response of two sinusoids that both sensors show."""
    model = two_inertias({"name": name, "at": at, **keys})
    assert response_to_angle(model, "motor", **LINK) == pytest.approx(FOLLOWS * factor, rel=1e-6)


@pytest.mark.parametrize(
    "effects",
    [
        ({"name": "dead_channel", "at": "drive"},),
        (
            {"name": "encoder_offset", "at": "drive", "offset": 0.3},
            {"name": "saturation", "at": "drive", "limit": 0.2},
        ),
    ],
)
def test_an_input_that_does_not_move_is_refused(effects):
    """The model's response was infinite: its output over an input that stands."""
    with pytest.raises(flexarm.InvalidParameter, match=r"signals\.drive: reads the same about rest"):
        response_to_angle(two_inertias(*effects), "motor", **LINK)


def test_a_saturation_beyond_rest_leaves_a_response():
    model = two_inertias({"name": "saturation", "at": "drive", "limit": 0.2})
    assert response_to_angle(model, "motor", **LINK) == pytest.approx(FOLLOWS, rel=1e-9)


def test_a_response_on_a_late_clock_lags():
    model = two_inertias()
    late = response_to_angle(model, "motor", clock="late", **LINK)
    assert late == pytest.approx(FOLLOWS * np.exp(-S * LATE), rel=1e-9)
    with pytest.raises(flexarm.InvalidParameter, match=r"clocks\.lost: is unknown, and the response 'out'"):
        response_to_angle(model, "motor", clock="lost", **LINK)


def test_the_command_prints_a_table_and_an_object(folder, tmp_path, capsys):
    model = tmp_path / "arm.toml"
    arm().to_toml(model)
    assert run(["compare", str(model), str(folder)]) == 0
    assert "frequency responses of" in capsys.readouterr().out
    assert run(["compare", str(model), str(folder), "--json"]) == 0
    gap = json.loads(capsys.readouterr().out)["signals"]["imu"]
    assert (gap["unit"], gap["input"]) == ("m/s2/N", "hammer")
    assert len(gap["model"]["real"]) == len(FREQUENCY)
    assert run(["check", str(model), str(folder)]) == 0
    assert run(["check", str(folder)]) == 0
    out = tmp_path / "out"
    assert run(["diagnose", str(model), str(folder), "--out", str(out)]) == 2
    assert "is a frequency response" in capsys.readouterr().err
    assert not out.exists()


def test_a_diagnosis_refuses_it_and_says_what_takes_it(folder):
    record = flexarm.Record.load(folder)
    with pytest.raises(
        flexarm.InvalidParameter, match="is a frequency response, which `compare` puts beside"
    ):
        flexarm.diagnose(arm(), {"frf": record})
    with pytest.raises(flexarm.InvalidParameter, match="compare_responses takes it"):
        flexarm.compare(arm(), record)
    with pytest.raises(flexarm.InvalidParameter, match="a frequency response does not move the arm"):
        flexarm.simulate(arm(), record)


def test_frequencies_have_a_range(folder):
    with pytest.raises(
        flexarm.InvalidParameter, match=r"frequency_hz: must be at most 1e\+09 Hz, got 1e\+308"
    ):
        flexarm.linearise(arm()).frequency_response([1.0, 1e308])
    text = (folder / "frf.csv").read_text().splitlines()
    (folder / "frf.csv").write_text("\n".join([*text[:-1], f"1e308,{text[-1].partition(',')[2]}"]) + "\n")
    with pytest.raises(
        flexarm.InvalidFile, match=r"line 161, column hz: must lie within \+-1e\+09, got 1e\+308"
    ):
        flexarm.Record.load(folder)


def test_a_response_in_an_unknown_frame_is_refused(folder):
    record = flexarm.Record.load(folder)
    imu = record.signals["imu"]
    tip = imu.replace(quantity="position", unit="m/N", frame="tracker")
    seen = record.replace(signals={**record.signals, "imu": tip}, frames={"tracker": Frame(unknown=True)})
    with pytest.raises(flexarm.InvalidParameter, match=r"frames\.tracker: is unknown, and"):
        flexarm.compare_responses(arm(), seen)


def test_a_response_needs_its_input_and_a_frequency_above_zero(folder):
    record = flexarm.Record.load(folder)
    imu = record.signals["imu"]
    with pytest.raises(flexarm.InvalidParameter, match=r"signals\.imu\.input: there is no signal 'hammer'"):
        record.replace(signals={"imu": imu})
    still = imu.replace(frequency=[0.0], values=[[1.0, 0.0]], coherence=[0.99])
    with pytest.raises(flexarm.InvalidParameter, match="at a frequency above 0"):
        flexarm.compare_responses(arm(), record.replace(signals={**record.signals, "imu": still}))
