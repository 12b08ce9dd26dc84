"""The examples of docs/meshes.md run, and its tables name what the readers know."""

import re
from pathlib import Path

import numpy as np
import pytest

from flexarm import _core
from flexarm.solids import Block, Material, revolved
from flexarm.solids.reading.read import FORMATS

TEXT = (Path(__file__).parents[2] / "docs" / "meshes.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(r"```python\n(.*?)```", TEXT, re.DOTALL)

LIGHT = Material(youngs_modulus=1e9, poisson_ratio=0.0, density=1.0)
BRACKET = """*NODE
1, 0, 0, 0
2, 40, 0, 0
3, 0, 40, 0
4, 0, 0, 40
*ELEMENT, TYPE=C3D4, ELSET=body
1, 1, 2, 3, 4
"""


@pytest.fixture
def page(tmp_path, monkeypatch):
    """The names that the examples leave behind, run in order beside a bracket.inp."""
    (tmp_path / "bracket.inp").write_text(BRACKET)
    monkeypatch.chdir(tmp_path)
    names: dict = {}
    for example in EXAMPLES:
        exec(example, names)
    return names


def test_the_examples_run(page, capsys):
    assert len(EXAMPLES) == 3
    assert list(page["part"].point_set("foot")) == [0, 1, 2]


def test_the_hub_of_the_page_is_one_part_with_its_sets(page):
    hub = page["hub"]
    radius = np.hypot(*hub.points[hub.point_set("bearing"), :2].T)
    z = hub.points[hub.point_set("tube"), 2]
    assert radius == pytest.approx(0.09)
    assert (z.min(), z.max()) == pytest.approx((0.04, 0.08))
    assert {f"bolts-{k}" for k in range(1, 9)} <= set(hub.point_sets)
    assert set(hub.materials) == {"plate", "rim", "socket"}


def test_every_ending_is_on_the_page():
    assert [ending for ending in FORMATS if f"`{ending}`" not in TEXT and ending not in TEXT] == []


def test_the_quoted_error_of_curved_cells_holds():
    """5e-5 at 16 cells around; the mass is what the mass matrix gives for a motion of 1 along x."""
    part = revolved([Block("ring", 0.1, 0.2, 0, 0.1)], size=0.1, around=16, material=LIGHT)
    _, lower = _core.assemble_solids(part.core())
    along_x = np.zeros(part.n_dof)
    along_x[::3] = 1.0
    mass = 2 * along_x @ (lower @ along_x) - lower.diagonal()[::3].sum()
    assert mass / (np.pi * 0.003) - 1 == pytest.approx(-5e-5, rel=0.05)
