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


@pytest.fixture(scope="module")
def reports(tmp_path_factory: pytest.TempPathFactory) -> dict[str, str]:
    """What the harness prints of each campaign's sample."""
    words = ["--sample", "--out", str(tmp_path_factory.mktemp("torture"))]
    folder = Path(__file__).parents[1]
    run = subprocess.run(
        [sys.executable, "-m", "torture", *words], cwd=folder, capture_output=True, text=True
    )
    assert run.returncode in (0, 1), run.stderr
    blocks = re.split(r"^(?=\w+: \d+ cases in)", run.stdout, flags=re.MULTILINE)
    return {block.partition(":")[0]: block for block in blocks}


@pytest.mark.parametrize("campaign", list(CAMPAIGNS), ids=list(CAMPAIGNS.values()))
def test_it_holds_that(campaign: str, reports: dict[str, str]) -> None:
    """A failing case is run alone, and shown, by the command below it."""
    first, *failures = reports[campaign].strip().splitlines()
    assert not failures, "\n".join([first, *failures])
