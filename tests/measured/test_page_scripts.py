"""The scripts that make pages of measured data: alike in what they ask for and in how they refuse."""

import subprocess
import sys

import pytest
from tests.helpers.example_scripts import EXAMPLES

SCRIPTS = ("asen_flexible_arm", "dlr_justin", "giraf_boom", "hilti_trailblazer", "kuka_kr300")
pytestmark = pytest.mark.parametrize("example", SCRIPTS)


def run(example, *words):
    line = [sys.executable, EXAMPLES / example / "make_page.py", *words]
    return subprocess.run([str(word) for word in line], capture_output=True, text=True, check=False)


def test_data_that_are_not_there_are_named_and_nothing_is_left(example, tmp_path):
    found = run(example, tmp_path / "nowhere", tmp_path / "out")
    assert found.returncode == 2
    assert "nowhere: DATA_DIR: is not a directory; it must hold" in found.stderr
    (tmp_path / "empty").mkdir()
    found = run(example, tmp_path / "empty", tmp_path / "out")
    assert found.returncode == 2
    assert found.stderr.startswith("error: ")
    assert "empty/" in found.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["empty"]


def test_a_folder_that_holds_files_is_not_written_into(example, tmp_path):
    (tmp_path / "out").mkdir()
    (tmp_path / "out/notes.txt").write_text("mine")
    found = run(example, tmp_path, tmp_path / "out")
    assert found.returncode == 2
    assert "out: output: holds files already; allowed is a new or empty directory, or --force" in found.stderr
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["notes.txt"]


def test_all_of_them_have_the_same_options(example, tmp_path):
    said = run(example, "--help").stdout
    assert all(word in said for word in ("DATA_DIR", "OUT_DIR", "--jobs", "--force"))
    found = run(example, tmp_path, tmp_path / "out", "--jobs", "none")
    assert found.returncode == 2
    assert "argument --jobs: must be a whole number from 1 on, got 'none'" in found.stderr
