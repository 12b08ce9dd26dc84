"""docs/superelements.md: its commands run, its table of variables is that of the files."""

import json
import re
import shlex
from pathlib import Path

import numpy as np
import pytest
from foreign_parts import (
    foreign,
    market,
    matrix_input,
    user_element,
    write_cube,
    write_dmig,
    write_grids,
)
from parts import frame_part

from flexarm import SuperElement
from flexarm.cli.run import run
from flexarm.superelement.netcdf import contents
from flexarm.superelement.shape import VARIABLES

TEXT = (Path(__file__).parents[2] / "docs" / "superelements.md").read_text(encoding="utf-8")
COMMANDS = re.findall(r"flexarm reduce (?:[^`\n]|\\\|)+", TEXT)


@pytest.fixture
def samples(tmp_path, monkeypatch):
    """Files of the names that the page uses."""
    from pyyeti.nastran import op4

    from flexarm.solids import flange

    part = frame_part(n_modes=4)
    bare = frame_part(n_modes=0)
    write_grids(tmp_path / "part.bdf", part)
    market(tmp_path, part, ("K", "M"))
    (tmp_path / "order.txt").write_text("11 7 23\n101-104.0\n")
    write_dmig(tmp_path / "part.pch", part)
    values = [foreign(part, matrix) for matrix in (part.stiffness, part.mass)]
    op4.write(str(tmp_path / "part.op4"), ["kaax", "maax"], values)
    (tmp_path / "sub.mtx").write_text(user_element(bare))
    for name, matrix in (("stif", bare.stiffness), ("mass", bare.mass)):
        (tmp_path / f"{name}.mtx").write_text(matrix_input(bare, matrix))
    write_cube(tmp_path)
    hub = flange(60, 160, 30, bolts=6, bolt_circle=130, pad=25, size=30)
    hub.save(tmp_path / "hub.vtu")
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("command", COMMANDS)
def test_commands_of_the_page_run(samples, command, capsys):
    words = shlex.split(command)
    assert run(words[1:]) == 0, capsys.readouterr().err
    assert SuperElement.load(words[words.index("--out") + 1]).check() == []


def test_the_model_of_the_page_hangs_the_rod_where_the_interfaces_put_it(samples, capsys):
    """The bore's centre is at half of the hub's 30 mm, its top 15 mm above: so the tip is at 1.515 m."""
    assert run(shlex.split(COMMANDS[0])[1:]) == 0
    Path("arm.toml").write_text(re.search(r"```toml\n(.*?)```", TEXT, re.DOTALL).group(1))
    for command in ("check arm.toml", "modes arm.toml --joint hinge=1.2", "static arm.toml --json"):
        capsys.readouterr()
        assert run(command.split()) == 0
    tip = json.loads(capsys.readouterr().out)["points"]["tip"]["position"]
    assert tip == pytest.approx([0, 0, 1.515], abs=1e-5)  # upright, less some micrometres of its weight


def test_the_page_shows_every_format():
    assert len(COMMANDS) == 8


def test_variables_of_the_page_are_those_of_the_file():
    rows = re.findall(r"^\| `(\w+)` \| \(([^)]*)\) \|", TEXT.split("## The file")[1], re.MULTILINE)
    part = frame_part().replace(recovery=np.zeros((3, 22)))
    written = {name: dimensions for name, (dimensions, _, _) in contents(part).variables.items()}
    assert [name for name, _ in rows] == list(written)
    lengths = {"3": ("axis", "interface_axis")}
    for name, told in rows:
        for word, dimension in zip(told.split(", "), written[name], strict=True):
            assert dimension in lengths.get(word, (word,)), name
    assert {variable for variable, _, _ in VARIABLES.values()} <= {name for name, _ in rows}
