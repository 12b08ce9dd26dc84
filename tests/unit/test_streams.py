"""Claims about standard streams that are closed, broken, full, or of another encoding."""

import os
import subprocess
import sys
from pathlib import Path
from time import monotonic, sleep

import pytest

from flexarm.cli import progress
from flexarm.cli.run import run

FLEXARM = f"'{sys.executable}' -c 'from flexarm.cli import main; main()'"


def shell(words: str, place: Path, **variables: str) -> subprocess.CompletedProcess[str]:
    """Runs `flexarm WORDS` in bash, redirections and all."""
    return subprocess.run(
        ["bash", "-c", f"set -o pipefail; {FLEXARM} {words}"],
        cwd=place,
        env={**os.environ, **variables},
        capture_output=True,
        text=True,
        check=False,
    )


@pytest.fixture
def place(tmp_path: Path, model_file: Path) -> Path:
    """A directory with a model, one that is wrong, and a motion."""
    (tmp_path / "bad.toml").write_text(model_file.read_text().replace("gear_ratio", "ratio"))
    (tmp_path / "swing.csv").write_text("time_s,hinge\n0,0\n0.1,0.001\n0.2,0.002\n0.3,0.002\n")
    return tmp_path


@pytest.mark.parametrize("closed", [">&-", "2>&-", "<&- >&- 2>&-", "| true", "2>/dev/full", "2> >(true)"])
@pytest.mark.parametrize(("file", "code"), [("arm.toml", 0), ("bad.toml", 2)])
def test_the_exit_code_is_right_wherever_the_streams_lead(
    place: Path, closed: str, file: str, code: int
) -> None:
    done = shell(f"check {file} {closed}", place)
    assert done.returncode == code
    assert "Traceback" not in done.stderr
    assert all(line.startswith(("error: ", "warning: ")) for line in done.stderr.splitlines())


def test_errors_reach_standard_error_where_nobody_reads_the_output(place: Path) -> None:
    done = shell("check bad.toml --json | true", place)
    assert done.returncode == 2
    assert "error: bad.toml" in done.stderr


def test_closed_streams_do_not_lend_their_numbers_to_files(place: Path) -> None:
    assert shell("simulate arm.toml --drive swing.csv --out open", place).returncode == 0
    assert shell("simulate arm.toml --drive swing.csv --out closed <&- >&- 2>&-", place).returncode == 0
    for file in (place / "open").glob("[!s]*"):  # simulation.nc tells when it was made
        assert (place / "closed" / file.name).read_bytes() == file.read_bytes()


@pytest.mark.parametrize("command", ["check", "static", "modes", "plan --drive swing.csv"])
def test_an_encoding_without_our_signs_is_no_error(place: Path, command: str) -> None:
    text = (
        (place / "arm.toml").read_text().replace('"load"', '"läd"').replace("payloads.load", "payloads.läd")
    )
    (place / "arm.toml").write_text(text)
    name, _, options = command.partition(" ")
    done = shell(f"{name} arm.toml {options}", place, PYTHONIOENCODING="ascii")
    assert (done.returncode, "Traceback" in done.stderr) == (0, False), done.stderr
    assert done.stdout.isascii()
    assert "\\xb" not in done.stdout  # µ and ± are typed as u and +-


def test_a_name_that_is_no_text_is_told(place: Path) -> None:
    done = shell("check $'no\\xff.toml'", place)
    assert (done.returncode, done.stderr) == (2, "error: no\\udcff.toml: file: there is no such file\n")


@pytest.mark.parametrize("backend", ["none", "nonsense"])
def test_figures_need_no_backend_and_no_cache_directory(place: Path, backend: str) -> None:
    nowhere = {"XDG_CONFIG_HOME": "/proc/none", "XDG_CACHE_HOME": "/proc/none", "HOME": "/proc/none"}
    words = f"plan arm.toml --drive swing.csv --out {backend}"
    done = shell(words, place, MPLBACKEND=backend, **nowhere)
    assert done.returncode == 0, done.stderr
    assert all(line.startswith("warning: ") for line in done.stderr.splitlines()), done.stderr


def test_progress_without_a_terminal_is_a_line_at_most_every_ten_seconds(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    now = 0.0
    monkeypatch.setattr(progress, "monotonic", lambda: now)
    tell = progress.lines()
    for k in range(100):
        now = 0.25 * k
        tell(k / 100, "simulation")
    told = capsys.readouterr()
    assert told.out == ""
    assert told.err.splitlines() == ["simulation: 40 %, 10 s", "simulation: 80 %, 20 s"]


def test_a_silent_state_is_shown_again_until_the_work_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(progress, "AGAIN", 0.01)
    shown: list[tuple[float, str]] = []
    with progress.repeated(lambda done, what: shown.append((done, what))) as tell:
        tell(0.5, "screening")
        began = monotonic()
        while len(shown) < 3 and monotonic() < began + 5:
            sleep(0.01)
    known = len(shown)
    sleep(0.05)
    assert shown[:3] == [(0.5, "screening")] * 3
    assert len(shown) == known


def test_a_comparison_that_takes_long_shows_the_time_that_has_passed(
    place: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    assert (
        run(
            [
                "simulate",
                str(place / "arm.toml"),
                "--drive",
                str(place / "swing.csv"),
                "--out",
                str(place / "run"),
            ]
        )
        == 0
    )
    monkeypatch.setattr(progress, "SECONDS", 0.0)
    assert run(["compare", str(place / "arm.toml"), str(place / "run")]) == 0
    assert "comparing, 0 s" in capsys.readouterr().err.splitlines()
