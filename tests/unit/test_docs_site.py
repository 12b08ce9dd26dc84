"""Claims about the documentation site: it builds without a warning, its search finds, its figures load."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from browser import needs_chromium, visit

pytest.importorskip("sphinx")
pytest.importorskip("myst_nb")
pytest.importorskip("pydata_sphinx_theme")
import flexarm

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[2] / "docs"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """The site, built with warnings as errors."""
    out = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-b", "html", "-W", "--keep-going", "-q", "-d", out / "trees"]
    unexecuted = ["-D", "execute_notebooks=0"]  # the notebooks have tests of their own
    done = subprocess.run([*command, *unexecuted, DOCS, out / "html"], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr[-3000:]
    return out / "html"


def test_every_public_name_and_command_has_its_place(site):
    for name in (*flexarm.__all__, *flexarm.diagnosis.__all__):
        assert f'id="flexarm.{name}"' in (site / "reference" / "python" / f"{name}.html").read_text() or (
            f".{name}" in (site / "reference" / "python" / f"{name}.html").read_text()
        ), name
    commands = (site / "reference" / "commands.html").read_text()
    from flexarm.cli.app import COMMANDS

    assert all(f'id="{name}"' in commands for name in COMMANDS)


def test_every_figure_and_page_that_is_named_is_there(site):
    for page in set(site.rglob("*.html")) - set((site / "_static").rglob("*")):  # there lie templates
        for target in re.findall(r'(?:src|href)="([^"#?]+)', page.read_text(encoding="utf-8")):
            if ":" not in target and not target.startswith("//"):
                assert (page.parent / target).exists(), f"{page}: {target}"


@needs_chromium
def test_the_search_finds_backlash(site, tmp_path):
    seen = {}

    async def look(page):
        wait = (
            "new Promise(done => { let n = 0; const tick = () => {"
            "const found = document.querySelectorAll('#search-results a[href*=\"effects/backlash\"]').length;"
            "if (found || ++n > 100) done(found); else setTimeout(tick, 100); }; tick(); })"
        )
        seen["hits"] = await page.run(wait)

    (tmp_path / "profile").mkdir()
    visit(site / "search.html", tmp_path / "profile", look, "?q=backlash", ready="true")
    assert seen["hits"] > 0
