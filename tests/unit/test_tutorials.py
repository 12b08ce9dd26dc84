"""docs/tutorials: each page is followed from top to bottom in an empty directory, as a reader would."""

import doctest
import re
import shlex
from pathlib import Path

import pytest

from flexarm.cli.run import run

pytestmark = pytest.mark.slow

DOCS = Path(__file__).parents[2] / "docs"
PAGES = sorted((DOCS / "tutorials").glob("*.md"))
BLOCK = re.compile(r"^```(\w*)\n(.*?)^```", re.DOTALL | re.MULTILINE)
FILE = re.compile(r"# file: (\S+)\n")


def follow(text: str, page: str) -> None:
    """Save files, type commands, run programs; what is printed must be what the page shows."""
    names: dict[str, object] = {}
    for language, block in BLOCK.findall(text):
        if language == "toml":
            Path(FILE.match(block)[1]).write_text(block, encoding="utf-8")
        elif language == "python":
            exec(compile(block, page, "exec"), names)
        elif language == "pycon":
            case = doctest.DocTestParser().get_doctest(block, names, page, page, 0)
            told: list[str] = []
            result = doctest.DocTestRunner().run(case, out=told.append, clear_globs=False)
            names.update(case.globs)
            assert result.failed == 0, "".join(told)
        elif language == "":
            for line in block.splitlines():
                program, *arguments = shlex.split(line)
                assert program == "flexarm"
                assert run(arguments) == 0, line
        else:
            raise AssertionError(f"{page}: a block of {language!r} is not run")


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_the_page_runs_as_printed(page, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    follow(page.read_text(encoding="utf-8"), page.name)


def test_every_tutorial_is_in_the_list():
    listed = re.findall(r"^tutorials/(\w+)$", (DOCS / "tutorials.md").read_text(encoding="utf-8"), re.M)
    assert sorted(listed) == [page.stem for page in PAGES]


def test_a_page_that_prints_something_else_fails():
    with pytest.raises(AssertionError, match=r"Got:\s+2"):
        follow("```pycon\n>>> 1 + 1\n3\n\n```\n", "wrong.md")


def test_the_parallelogram_of_the_page_is_the_example():
    page = (DOCS / "tutorials" / "a_balanced_arm.md").read_text(encoding="utf-8")
    example = (DOCS.parent / "examples" / "parallelogram.toml").read_text(encoding="utf-8")
    assert f"```toml\n# file: parallelogram.toml\n{example}```\n" in page


def test_the_cranes_of_the_page_are_the_examples():
    page = (DOCS / "tutorials" / "a_crane.md").read_text(encoding="utf-8")
    for name in ("crane.toml", "telescopic_crane.toml"):
        example = (DOCS.parent / "examples" / name).read_text(encoding="utf-8")
        assert f"```toml\n# file: {name}\n{example}```\n" in page
    assert len((DOCS.parent / "examples" / "crane.toml").read_text(encoding="utf-8").splitlines()) == 20
