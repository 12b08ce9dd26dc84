"""Claims about frequency responses that import maps read."""

import h5py
import numpy as np
import pytest
from scipy.io import savemat

import flexarm
from flexarm import InvalidFile, Record

MAP = """
format = "flexarm-map/1"
kind = "frequency_response"
joints = { hinge = 0.4 }
[[signals]]
name = "hammer"
quantity = "force"
point = "tip"
axes = ["z"]
[[signals]]
name = "imu"
source = "SOURCE"
frequency = "f"
input = "hammer"
quantity = "acceleration"
point = "tip"
axes = ["x", "z"]
unit = "mm/s2/N"
KEYS
"""
FREQUENCY = np.linspace(1, 20, 12)
H = np.stack([1 / (1 + 0.3j * FREQUENCY), -2j / FREQUENCY], axis=1).copy(order="F")  # mm/s2/N, columns whole


def imported(folder, keys, source="frf.csv", text=MAP):
    (folder / "frf.map.toml").write_text(text.replace("KEYS", keys).replace("SOURCE", source))
    return flexarm.import_record(folder / "frf.map.toml")


def write(folder, columns):
    rows = [",".join(f"{v:.12g}" for v in row) for row in zip(*columns.values(), strict=True)]
    (folder / "frf.csv").write_text(",".join(columns) + "\n" + "\n".join(rows) + "\n")


@pytest.mark.parametrize(
    ("columns", "keys"),
    [
        (lambda: {"a": H[:, 0].real, "b": H[:, 0].imag, "c": H[:, 1].real, "d": H[:, 1].imag}, ""),
        (
            lambda: {"a": abs(H[:, 0]), "b": np.angle(H[:, 0]), "c": abs(H[:, 1]), "d": np.angle(H[:, 1])},
            'response = "magnitude-phase"',
        ),
        (
            lambda: {
                "a": 20 * np.log10(abs(H[:, 0])),
                "b": np.angle(H[:, 0], deg=True),
                "c": 20 * np.log10(abs(H[:, 1])),
                "d": np.angle(H[:, 1], deg=True),
            },
            'response = "decibel-phase"\nphase_unit = "deg"',
        ),
    ],
    ids=["parts", "magnitude", "decibels"],
)
def test_responses_come_as_parts_in_si(tmp_path, columns, keys):
    write(tmp_path, {"f": 2 * np.pi * FREQUENCY, **columns(), "coh": np.full(12, 0.9)})
    more = 'columns = ["a", "b", "c", "d"]\nfrequency_unit = "rad/s"\ncoherence = "coh"\naverages = 8\n'
    record = imported(tmp_path, more + keys)
    imu = record.signals["imu"]
    np.testing.assert_allclose(imu.response, 1e-3 * H, rtol=1e-9)
    np.testing.assert_allclose(imu.frequency, FREQUENCY, rtol=1e-9)
    assert (imu.unit, imu.input, imu.averages) == ("m/s2/N", "hammer", 8)
    assert imu.coherence.tolist() == [0.9] * 12
    record.save(tmp_path / "record")
    again = Record.load(tmp_path / "record")
    np.testing.assert_allclose(again.signals["imu"].response, imu.response)
    assert again.signals["hammer"].axes == ("z",)


@pytest.mark.parametrize("form", ["v5", "v7.3", "hdf5"])
def test_complex_numbers_are_read(tmp_path, form):
    arrays = {"f": FREQUENCY, "Hx": H[:, 0], "Hz": H[:, 1]}
    if form == "v5":
        savemat(tmp_path / "frf.mat", arrays)
    elif form == "hdf5":
        with h5py.File(tmp_path / "frf.mat", "w") as file:
            file.update(arrays)
    else:  # MATLAB's own compound of a complex number, behind its block of 512 bytes
        kind = np.dtype([("real", float), ("imag", float)])
        with h5py.File(tmp_path / "frf.mat", "w", userblock_size=512) as file:
            for name, values in arrays.items():
                file[name] = values.view(kind) if np.iscomplexobj(values) else values
        with (tmp_path / "frf.mat").open("r+b") as file:
            file.write(b"MATLAB 7.3 MAT-file")
    record = imported(tmp_path, 'columns = ["Hx", "Hz"]\nresponse = "complex"\nscale = -1', "frf.mat")
    np.testing.assert_allclose(record.signals["imu"].response, -1e-3 * H, rtol=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "told"),
    [
        ('columns = ["a", "b", "c", "d"]', 'columns = ["a", "b"]', "columns (line 19): must be 4 for axes"),
        ('input = "hammer"', 'input = "drum"', "there is no signal 'drum'"),
        ('unit = "mm/s2/N"', 'unit = "mm/s2"', "signals.imu.unit"),
        (
            'frequency = "f"',
            "",
            "signals.imu.frequency (line 10): is missing; needed is the column of frequencies",
        ),
        (
            'frequency = "f"',
            'frequency = "f"\ntime = 1',
            "does not belong to a record of kind 'frequency_response'",
        ),
        (
            'kind = "frequency_response"',
            'kind = "motion"',
            "belongs to a record of kind 'frequency_response'",
        ),
        ('frequency = "f"', 'frequency = "a"', "line 3: frequencies must be at least 0 and rise"),
        ('axes = ["z"]', 'axes = ["z"]\nsource = "frf.csv"\ncolumns = 1', "of an input nothing is read"),
        (
            'columns = ["a", "b", "c", "d"]',
            'columns = ["a", "b"]\nresponse = "complex"',
            "the columns hold real numbers",
        ),
        ('input = "hammer"', 'input = "hammer"\nbefore_gear = true', "before_gear"),
    ],
)
def test_what_does_not_fit_is_told_with_its_place(tmp_path, old, new, told):
    write(
        tmp_path, {"f": FREQUENCY, "a": H[:, 0].real, "b": H[:, 0].imag, "c": H[:, 1].real, "d": H[:, 1].imag}
    )
    text = MAP.replace("KEYS", 'columns = ["a", "b", "c", "d"]')
    assert old in text
    with pytest.raises(InvalidFile) as caught:
        imported(tmp_path, "", text=text.replace(old, new, 1))
    assert any(told in line for line in caught.value.lines()), caught.value.lines()
