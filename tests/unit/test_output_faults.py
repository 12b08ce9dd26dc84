"""Claims about output where the disk is full, two runs meet, a run is killed, or an input is in the way."""

import fcntl
import gc
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from campaign_runs import STATIC, study_in

from flexarm import output
from flexarm.errors import InvalidFile
from flexarm.output import output_directory, output_file, write_file

PROGRAM = "from flexarm.cli import main; main()"
SMALL = f"import resource, signal, sys; sys.dont_write_bytecode = True; \
signal.signal(signal.SIGXFSZ, signal.SIG_IGN); \
resource.setrlimit(resource.RLIMIT_FSIZE, (1000, 1000)); {PROGRAM}"
"""No file may grow over 1000 bytes, as on a full disk; nor may Python leave a cut-off .pyc file behind."""


@pytest.fixture
def place(tmp_path: Path, model_file: Path, record_dir: Path) -> Path:
    """A directory with the model arm.toml, the record run, and the motion swing.csv."""
    rows = "".join(f"{0.1 * k:g},{0.001 * k * k:g}\n" for k in range(11))
    (tmp_path / "swing.csv").write_text(f"time_s,hinge\n{rows}")
    told = (record_dir / "record.toml").read_text()
    (record_dir / "record.toml").write_text(told.replace("[joints]\nwrist = 0.3\n", ""))
    return tmp_path


def flexarm(place: Path, *words: str, program: str = PROGRAM) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "-c", program, *words], cwd=place, capture_output=True, text=True, check=False
    )


def contents(place: Path) -> dict[str, bytes]:
    return {str(path.relative_to(place)): path.read_bytes() for path in place.rglob("*") if path.is_file()}


SIMULATE = ("simulate", "arm.toml", "--drive", "swing.csv", "--out", "out")


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (SIMULATE, "out/simulation.nc"),
        (("plan", "arm.toml", "--drive", "swing.csv", "--out", "out"), "out/smallest-sizes.png"),
        (("linearise", "arm.toml", "--out", "arm.mat"), "arm.mat"),
        (("linearise", "arm.toml", "--out", "arm.nc"), "arm.nc"),
        (("example", "out"), "out/arm.toml"),
    ],
)
def test_a_full_disk_is_an_error_that_names_the_file_and_leaves_nothing(
    place: Path, words: tuple[str, ...], file: str
) -> None:
    before = contents(place)
    done = flexarm(place, *words, program=SMALL)
    assert done.returncode == 2, done.stderr
    assert done.stderr.splitlines()[-1] == f"error: {file}: output: cannot be written: File too large"
    assert "Traceback" not in done.stderr
    assert contents(place) == before


@pytest.mark.parametrize(
    ("most", "file"),
    [
        (1000, r"study\.json"),
        (3000, r"results\.parts/\S+"),
        (12_000, r"results\.nc"),
        (30_000, r"summary\.html"),
    ],
)
def test_a_campaign_on_a_full_disk_says_what_is_kept_and_goes_on(
    tmp_path: Path, most: int, file: str
) -> None:
    place = study_in(tmp_path, STATIC).parent
    before = contents(place)
    words = ("campaign", "study.toml", "--jobs", "1", "--out", "out")
    done = flexarm(place, *words, program=SMALL.replace("1000", str(most)))
    assert done.returncode == 2, done.stderr
    told = rf"error: out/{file}: output: cannot be written: File too large"
    if most == 1000:  # nothing is done yet
        assert re.fullmatch(told, done.stderr.splitlines()[-1])
        assert contents(place) == before
        assert not (place / "out").exists()
        return
    told += r"; \d+ of 50 runs are kept in out; --resume goes on"
    assert re.fullmatch(told, done.stderr.splitlines()[-1])
    done = flexarm(place, *words, "--resume")
    assert done.returncode == 0, done.stderr
    assert sorted(contents(place / "out")) == ["results.nc", "study.json", "summary.html"]


def test_a_file_that_hdf5_cannot_write_is_an_error_at_its_end(tmp_path: Path) -> None:
    """In a process of its own, for HDF5 alone would end it as it leaves."""
    code = """
from pathlib import Path
import numpy as np
from flexarm.netcdf import growing_hdf5
try:
    with growing_hdf5(Path("a.nc")) as file:
        for i in range(10):
            file.create_dataset(f"x{i}", data=np.arange(1000.0))
except OSError as error:
    print(error.strerror)
"""
    done = flexarm(tmp_path, program=SMALL.replace(PROGRAM, "") + code)
    assert (done.returncode, done.stdout, done.stderr) == (0, "File too large\n", "")


def test_of_two_runs_into_one_place_the_second_is_refused(place: Path) -> None:
    with output_directory(place / "out") as directory:
        write_file(directory / "first.txt", "first")
        done = flexarm(place, *SIMULATE)
        assert (done.returncode, done.stdout) == (2, "")
        assert "error: out: output: another run is writing it" in done.stderr
    assert [path.name for path in (place / "out").iterdir()] == ["first.txt"]


def test_of_two_threads_that_write_one_file_the_second_is_refused(tmp_path: Path) -> None:
    with output_file(tmp_path / "a.nc") as partial:
        with pytest.raises(InvalidFile, match=r"a\.nc: output: another run is writing it"):
            write_file(tmp_path / "a.nc", b"second")
        partial.write_bytes(b"first")
    assert (tmp_path / "a.nc").read_bytes() == b"first"


def test_a_file_that_is_written_meanwhile_is_left_alone(tmp_path: Path) -> None:
    target = tmp_path / "a.mat"
    with pytest.raises(InvalidFile, match="exists already"), output_file(target, force=False) as partial:
        partial.write_bytes(b"ours")
        target.write_bytes(b"theirs")
    assert contents(tmp_path) == {"a.mat": b"theirs"}


@pytest.mark.parametrize("command", ["linearise", "reduce"])
def test_of_two_runs_into_one_file_the_second_is_refused_before_its_work(place: Path, command: str) -> None:
    with output_file(place / "out.nc") as partial:
        done = flexarm(place, command, "arm.toml", "--out", "out.nc")
        assert (done.returncode, done.stdout) == (2, "")
        assert "error: out.nc: output: another run is writing it" in done.stderr
        partial.write_bytes(b"first")
    assert (place / "out.nc").read_bytes() == b"first"


def test_a_directory_that_is_filled_meanwhile_is_left_alone(tmp_path: Path) -> None:
    target = tmp_path / "out"
    with (
        pytest.raises(InvalidFile, match="holds files already"),
        output_directory(target) as directory,
    ):
        write_file(directory / "a.txt", "ours")
        target.mkdir()
        (target / "a.txt").write_text("theirs")
    assert contents(tmp_path) == {"out/a.txt": b"theirs"}


@pytest.mark.parametrize(
    ("words", "file"),
    [
        (("simulate", "arm.toml", "--drive", "run", "--out", "run", "--force"), "run/record.toml"),
        (("simulate", "arm.toml", "--drive", "drive.csv", "--out", ".", "--force"), "drive.csv"),
        (("linearise", "arm.mat", "--out", "arm.mat", "--force"), "arm.mat"),
        (("linearise", "arm.toml", "--out", "soft.mat", "--force"), "soft.mat"),
        (("linearise", "arm.toml", "--out", "hard.mat", "--force"), "hard.mat"),
        (("diagnose", "updated.toml", "run", "--out", ".", "--force"), "updated.toml"),
        (("reduce", "hub.inp", "--interface", "a=A", "--out", "hub.inp", "--force"), "hub.inp"),
    ],
)
def test_no_output_replaces_what_the_command_reads(place: Path, words: tuple[str, ...], file: str) -> None:
    for name in ("arm.mat", "updated.toml"):
        (place / name).write_bytes((place / "arm.toml").read_bytes())
    (place / "drive.csv").write_bytes((place / "swing.csv").read_bytes())
    (place / "hub.inp").write_text("*NODE\n")
    (place / "soft.mat").symlink_to("arm.toml")
    (place / "hard.mat").hardlink_to(place / "arm.toml")
    before = contents(place)
    done = flexarm(place, *words)
    assert done.returncode == 2
    assert f"error: {file}: output: would replace" in done.stderr
    assert contents(place) == before


def test_a_record_is_not_saved_over_itself(record_dir: Path) -> None:
    from flexarm.record import Record

    before = contents(record_dir)
    with pytest.raises(InvalidFile, match="would replace"):
        Record.load(record_dir).save(record_dir, force=True)
    assert contents(record_dir) == before


def test_a_pipe_is_no_place_for_a_file(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.nc")
    with pytest.raises(InvalidFile, match="is a device or pipe"):
        write_file(tmp_path / "pipe.nc", "text")
    assert (tmp_path / "pipe.nc").is_fifo()


def test_nothing_is_replaced_where_one_file_cannot_be(tmp_path: Path) -> None:
    (tmp_path / "a.txt").write_text("old")
    (tmp_path / "b.txt").mkdir()
    with (
        pytest.raises(InvalidFile, match=r"b\.txt: output: is a directory in the way"),
        output_directory(tmp_path, force=True) as directory,
    ):
        write_file(directory / "a.txt", "new")
        write_file(directory / "b.txt", "new")
    assert contents(tmp_path) == {"a.txt": b"old"}


def test_a_model_written_with_other_files_names_them_from_its_final_place(tmp_path: Path) -> None:
    from flexarm.arm.part_files import seen_from

    with output_directory(tmp_path / "out") as directory:
        parts = [str(directory / "hub.nc"), str(tmp_path / "foot.nc")]
        links = [{"type": "superelement", "file": file} for file in parts]
        seen = seen_from({"links": links}, directory)["links"]
    assert [link["file"] for link in seen] == ["hub.nc", "../foot.nc"]


@pytest.mark.parametrize("target", ["run.nc", "run", "there"])
def test_the_next_run_clears_what_a_killed_one_left(tmp_path: Path, target: str) -> None:
    (tmp_path / "there").mkdir()
    writer = "output_file" if target == "run.nc" else "output_directory"
    code = f"import os, flexarm.output as o\nwith o.{writer}({target!r}): os.kill(os.getpid(), 9)"
    subprocess.run([sys.executable, "-c", code], cwd=tmp_path, check=False)
    assert list(tmp_path.rglob("*.partial"))
    if target == "run.nc":
        write_file(tmp_path / target, b"whole")
    else:
        with output_directory(tmp_path / target) as directory:
            write_file(directory / "a.txt", "whole")
    assert not list(tmp_path.rglob("*.partial"))


def test_without_locks_whoever_made_the_hidden_directory_has_the_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def none(lock: int, how: int) -> None:
        raise OSError(37, "No locks available")

    monkeypatch.setattr(fcntl, "flock", none)
    with output_file(tmp_path / "a.nc") as partial:
        with pytest.raises(InvalidFile, match="another run is writing it"):
            write_file(tmp_path / "a.nc", b"second")
        partial.write_bytes(b"first")
    assert contents(tmp_path) == {"a.nc": b"first"}


def interrupted_at(line: int, work: object) -> bool:
    """Whether Ctrl-C came: before the line of that number among all that flexarm.output executes."""
    left = line

    def trace(frame: object, event: str, argument: object) -> object:
        nonlocal left
        if frame.f_code.co_filename not in (output.__file__, sys.modules["contextlib"].__file__):  # type: ignore[attr-defined]
            return None
        if event == "line":
            left -= 1
            if left == 0:
                signal.raise_signal(signal.SIGINT)
        return trace

    old, handler = sys.gettrace(), signal.signal(signal.SIGINT, signal.default_int_handler)
    sys.settrace(trace)  # type: ignore[arg-type]
    try:
        work()  # type: ignore[operator]
    except KeyboardInterrupt:
        return True
    finally:
        sys.settrace(old)
        signal.signal(signal.SIGINT, handler)
    return False


@pytest.mark.parametrize("force", [False, True])
def test_ctrl_c_before_any_line_leaves_all_or_nothing(tmp_path: Path, force: bool) -> None:
    def write() -> None:
        with output_directory(place, force) as directory:
            write_file(directory / "a.txt", "new")
            write_file(directory / "b.txt", "new")

    line, came = 0, True
    while came:
        line += 1
        around = tmp_path / f"{line}"
        around.mkdir()
        place = around / "deep" / "out"
        if force:
            place.mkdir(parents=True)
            (place / "a.txt").write_text("old")
        before = contents(around)
        came = interrupted_at(line, write)
        gc.collect(0)  # ends the blocks whose end was not reached, as leaving the program does
        after = {"deep/out/a.txt": b"new", "deep/out/b.txt": b"new"}
        assert contents(around) in (before, after), line  # and nothing hidden
    assert line > 100


@pytest.mark.slow
def test_runs_killed_or_interrupted_at_random_leave_all_or_nothing(place: Path) -> None:
    """Seeded; what a killed run leaves hidden is gone after the next one."""
    chance = random.Random(26)
    for number in [signal.SIGKILL, signal.SIGINT, signal.SIGTERM] * 4:
        process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM, *SIMULATE],
            cwd=place,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        until = time.monotonic() + 30
        while process.poll() is None and not (place / ".out.partial").exists() and time.monotonic() < until:
            time.sleep(0.001)
        time.sleep(chance.uniform(0.0, 0.1))
        process.send_signal(number)
        process.wait(30)
        if number == signal.SIGKILL:  # the next run is one of the library
            with output_directory(place / "out", force=True):
                pass
        assert not list(place.rglob("*.partial"))
        names = {path.name for path in (place / "out").glob("*")}
        assert names in (set(), {"drive.csv", "record.toml", "simulation.nc", "tracker.csv"})
        shutil.rmtree(place / "out", ignore_errors=True)


TERMINATED_IN_CLAIM = """
import os, signal
from flexarm import output, termination
take = output._Claim.take
output._Claim.take = lambda claim: (take(claim), os.kill(os.getpid(), signal.SIGTERM))
termination.exit_on_signals()
with output.output_directory("out"):
    raise AssertionError("a terminated run went on")
"""


def test_a_signal_while_a_place_is_claimed_leaves_nothing(tmp_path: Path) -> None:
    """It is held back until the place is claimed, and ends the process at once thereafter."""
    ended = subprocess.run([sys.executable, "-c", TERMINATED_IN_CLAIM], cwd=tmp_path, capture_output=True)
    assert ended.returncode == 143, ended.stderr
    assert not list(tmp_path.iterdir())
