"""Every command line that a page of help or of the documentation prints is one that the commands take."""

import os
import re
import shlex
from pathlib import Path

import pytest
import typer

from flexarm.cli.app import COMMANDS, app_for
from flexarm.cli.run import run

ROOT = Path(__file__).parents[3]
PROGRAM = typer.main.get_command(app_for([]))


def examples(text):
    """Lines that begin with the command, continued ones joined, without what stands beside them.

    In help that is parted by two blanks or more.
    """
    joined = re.sub(r"\s*\\\n\s*", " ", text)
    found = re.findall(r"^ *(?:\$ )?flexarm (.*)$", joined, re.MULTILINE)
    return [shlex.split(re.split(r" {2,}|\|", line.strip())[0], comments=True) for line in found]


def in_blocks(path):
    """The command lines of a page: in fenced blocks and in indented ones."""
    text = path.read_text(encoding="utf-8")
    blocks = re.findall(r"^```(\w*)\n(.*?)^```", text, re.DOTALL | re.MULTILINE)
    prose = re.sub(r"^```.*?^```", "", text, flags=re.DOTALL | re.MULTILINE)
    typed = [block for language, block in blocks if language in ("", "bash", "sh", "console")]
    return examples("\n".join([*typed, *re.findall(r"^ {4}flexarm .*$", prose, re.MULTILINE)]))


PAGES = [page for page in (ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))) if in_blocks(page)]


def parse(arguments):
    """Parse a command line without running it; what stands for files of the reader need not be there."""
    words = [word for word in arguments if word not in ("...", "…")]
    name, *rest = words
    command = PROGRAM.commands[name]
    whole = len(words) == len(arguments)
    with command.make_context(name, rest, resilient_parsing=not whole):
        pass


def help_of(name):
    context = typer.Context(PROGRAM, info_name="flexarm")
    command = PROGRAM.commands[name] if name else PROGRAM
    return command.get_help(
        typer.Context(command, info_name=f"flexarm {name}".strip(), parent=context if name else None)
    )


@pytest.mark.parametrize("name", ["", *COMMANDS])
def test_examples_of_help_are_command_lines(name):
    found = examples(help_of(name))
    assert any(arguments[0] == name for arguments in found) or not name
    for arguments in found:
        parse(arguments)


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(ROOT)))
def test_command_lines_of_a_page_are_command_lines(page):
    for arguments in in_blocks(page):
        parse(arguments)


def test_a_line_that_no_command_takes_is_seen():
    [line] = examples("    flexarm check arm.toml --wight      what does it weigh")
    with pytest.raises(Exception, match="No such option: --wight"):
        parse(line)


CHEAP = ("check", "static", "modes", "linearise", "simulate", "compare")


@pytest.fixture(scope="module")
def tryout(tmp_path_factory):
    """The files of `flexarm example` under the names that help uses."""
    folder = tmp_path_factory.mktemp("help")
    assert run(["example", str(folder)]) == 0
    (folder / "slow").rename(folder / "measured")
    return folder


@pytest.mark.parametrize("name", CHEAP)
def test_examples_of_help_run_on_the_files_of_the_example(name, tryout, monkeypatch, capsys):
    """Those whose files and joints the example has."""
    monkeypatch.chdir(tryout)
    done = 0
    for command, *rest in examples(help_of(name)):
        words = [word for word in rest if re.search(r"\.(toml|csv)$", word) or word == "measured"]
        if command != name or not words or "shoulder=0.3" in rest or not all(map(os.path.exists, words)):
            continue
        assert run([command, *rest]) == 0, (command, *rest, capsys.readouterr().err)
        done += 1
    assert done


@pytest.mark.parametrize("name", COMMANDS)
def test_arguments_are_shown_by_their_names_without_types_of_python(name):
    assert not re.findall(r"<\w+(?:\[\w+\])?>", help_of(name))
