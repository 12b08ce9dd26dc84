"""A CSV file is read block by block: where a block ends changes neither numbers nor messages."""

import re
import time

import numpy as np
import pytest

from flexarm import _core
from flexarm.errors import InvalidFile
from flexarm.record import columns
from flexarm.record.columns import CsvFile

HEADER = "# made by hand\n\ntime_s,name,angle,torque\n"


def rows(count=200):
    """Lines with drop-outs, comments and empty lines among them, and the columns they hold."""
    rng = np.random.default_rng(5)
    values = rng.normal(size=(count, 2))
    values[rng.random(values.shape) < 0.2] = np.nan
    times = np.arange(count) * 1e-3
    lines = []
    for t, (a, b) in zip(times, values, strict=True):
        lines.append(
            f"{float(t)!r},x,{'' if np.isnan(a) else repr(float(a))},{'' if np.isnan(b) else repr(float(b))}"
        )
        lines += ["  # a comment, with a comma", "", "   "][: rng.integers(0, 4)]
    return lines, np.column_stack([times, values])


@pytest.mark.parametrize("block", [1, 7, 100, 1 << 20])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
def test_columns_do_not_depend_on_the_length_of_a_block(tmp_path, monkeypatch, block, end):
    lines, expected = rows()
    path = tmp_path / "run.csv"
    path.write_bytes((HEADER + "\n".join(lines)).replace("\n", end).encode())
    monkeypatch.setattr(columns, "BLOCK", block)
    assert _core.number_rows("\n".join(lines), 4, [0, 2, 3]) is not None  # no cell needs a closer look
    found = CsvFile(path).numbers(["time_s", "angle", "torque"])
    np.testing.assert_array_equal(found, expected)


def test_the_core_reads_what_rows_hold_one_by_one(tmp_path):
    """A cell in quotes is read by Python, and with it the whole file."""
    cells = [
        "1",
        " +2.5e-3 ",
        "-0.",
        ".5",
        "5.",
        "1E5",
        "",
        " ",
        "NaN",
        "+nan",
        "0.1",
        "5e-324",
        "1.7976931348623157e308",
    ]
    cells += [
        repr(float(x)) for x in np.random.default_rng(7).normal(size=200) * 10.0 ** np.arange(-100, 100)
    ]
    fast, slow = tmp_path / "fast.csv", tmp_path / "slow.csv"
    fast.write_text("time_s,angle\n" + "".join(f"{k},{cell}\n" for k, cell in enumerate(cells)))
    slow.write_text("time_s,angle\n" + "".join(f'"{k}",{cell}\n' for k, cell in enumerate(cells)))
    np.testing.assert_array_equal(CsvFile(fast).numbers(["angle"]), CsvFile(slow).numbers(["angle"]))


@pytest.mark.parametrize(
    "row, what",
    [
        ("0.5,x,1.0", "has 3 cells, the header has 4"),
        ("0.5,x,1.0,2.0,", "has 5 cells"),
        ("0.5,x,1.0,1_000", "column torque.*got '1_000'"),
        ("0.5,x,1.0,2.0 # late", "column torque.*got '2.0 # late'"),
        ("0.5,x,inf,2.0", "column angle.*an infinite number"),
    ],
)
def test_a_wrong_row_far_down_is_told_with_its_line(tmp_path, monkeypatch, row, what):
    lines, _ = rows()
    lines.insert(150, row)
    path = tmp_path / "run.csv"
    path.write_text(HEADER + "\n".join(lines))
    monkeypatch.setattr(columns, "BLOCK", 100)
    with pytest.raises(InvalidFile, match=f"line {3 + 151}[,:].*{what}"):
        CsvFile(path).numbers(["time_s", "angle", "torque"])


def test_a_byte_that_is_no_text_far_down_is_told_with_its_line(tmp_path):
    path = tmp_path / "run.csv"
    path.write_bytes(b"time_s,angle\n" + b"0,1\n" * 100_000 + b"\xff,1\n")
    with pytest.raises(
        InvalidFile, match=r"line 100002: not a text in UTF-8: byte 0xff.*; `flexarm import` reads"
    ):
        CsvFile(path).numbers(["time_s"])


def test_quoted_cells_are_numbers_too(tmp_path):
    path = tmp_path / "run.csv"
    path.write_text('time_s,"angle"\n"0",1\n1,"2.5"\n')
    assert CsvFile(path).numbers(["angle"]).tolist() == [[1], [2.5]]


@pytest.mark.parametrize("mark", [";", "\t", "|"])
def test_another_separator_is_told(tmp_path, mark):
    path = tmp_path / "run.csv"
    path.write_text(HEADER.replace(",", mark).replace("# made by hand\n", "") + f"0,5{mark}x{mark}1{mark}2\n")
    with pytest.raises(InvalidFile, match=re.escape(f"header: cells are separated by {mark!r}")):
        CsvFile(path)


def test_many_columns_are_compared_once(tmp_path):
    """Comparing each of 30 000 names with all others takes seconds."""
    names = [f"c{i}" for i in range(30_000)]
    path = tmp_path / "wide.csv"
    path.write_text(",".join(names) + "\n" + ",".join(["1"] * len(names)) + "\n")
    began = time.process_time()
    assert CsvFile(path).numbers(["c0", "c29999"]).tolist() == [[1, 1]]
    path.write_text(path.read_text().replace("c29999", "c0"))
    with pytest.raises(InvalidFile, match="column 'c0' stands there twice"):
        CsvFile(path)
    assert time.process_time() - began < 1.0
