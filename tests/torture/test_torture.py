"""A few cases of each campaign end as they should: done, refused at a place, or not converged."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="limits and process files are Linux's")
CAMPAIGNS = {
    "planted": "failures that are planted are recognised",
    "models": "malformed models are refused at their place",
    "records": "malformed records are refused at their place",
    "files": "damaged files of all kinds are read or refused",
    "calls": "wrong calls get an error of their own",
    "options": "wrong options are refused by their name",
    "limits": "small files cannot take memory or time",
    "arms": "random arms obey mechanics",
    "kills": "a kill tears nothing, and the next run clears up",
    "interrupts": "an interrupt ends a command at once and leaves nothing",
    "surroundings": "commands miss room, streams and terminals without a traceback",
}


FOLDER = Path(__file__).parents[1]
UNTRIED = """
import sys
from pathlib import Path
import flexarm
from flexarm.cli.app import COMMANDS
from torture.campaigns import calls, files, options
tried = {call.name for call in calls.right(Path(sys.argv[1]))}
tried |= {reader.label for reader in files.READERS.values()}
classes = {name for name in flexarm.__all__ if isinstance(getattr(flexarm, name), type)}
errors = {name for name in classes if issubclass(getattr(flexarm, name), Exception)}
loads = {f"{name}.load" for name in classes if hasattr(getattr(flexarm, name), "load")} - {"Arm.load"}
left = {*flexarm.__all__} - errors - {name.partition(".")[0] for name in tried}
print(*sorted(left | (loads - tried) | ({*COMMANDS} - {*options.OPTIONS})))
"""
"""Prints public names, readers and commands of which no campaign has a case."""


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("torture")


@pytest.fixture(scope="module")
def reports(out: Path) -> dict[str, str]:
    """What the harness prints of each campaign's sample."""
    words = ["--sample", "--out", str(out)]
    run = subprocess.run(
        [sys.executable, "-m", "torture", *words], cwd=FOLDER, capture_output=True, text=True
    )
    assert run.returncode in (0, 1), run.stderr
    blocks = re.split(r"^(?=\w+: \d+ cases in)", run.stdout, flags=re.MULTILINE)
    return {block.partition(":")[0]: block for block in blocks}


@pytest.mark.parametrize("campaign", list(CAMPAIGNS), ids=list(CAMPAIGNS.values()))
def test_it_holds_that(campaign: str, reports: dict[str, str]) -> None:
    """A failing case is run alone, and shown, by the command below it."""
    first, *failures = reports[campaign].strip().splitlines()
    assert not failures, "\n".join([first, *failures])


def test_each_public_name_reader_and_command_is_tried(out: Path, reports: dict[str, str]) -> None:
    """The harness has made its seeds by now."""
    words = [sys.executable, "-c", UNTRIED, str(out / "seeds")]
    found = subprocess.run(words, cwd=FOLDER, capture_output=True, text=True, check=True)
    assert found.stdout.split() == []
