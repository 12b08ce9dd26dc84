"""The gallery of effects, docs/effects: pages follow classes and simulations, shares are least squares."""

import sys
from functools import cache
from importlib import import_module
from pathlib import Path

import numpy as np
import pytest
from pytest import approx

from flexarm.arm.vocabulary import KNOWN_EFFECTS

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "scripts"))
MODULES = "confusion described experiments gaps pages shares text verdicts"
confusion, described, experiments, gaps, pages, shares, text, verdicts = (
    import_module(f"gallery.{name}") for name in MODULES.split()
)
ALIKE = ("joint_compliance", "payload_mass", "link_stiffness", "encoder_eccentricity")
"""Effects that coincide in a quasi-static run of the paper's set-up (contract)."""


@cache
def study():
    return confusion.study((*ALIKE, "encoder_offset", "time_delay"))


@cache
def written(name: str) -> str:
    return (ROOT / "docs" / "effects" / f"{name}.md").read_text(encoding="utf-8")


# ------------------------------------------------------------------- pages and classes


@pytest.mark.parametrize("name", KNOWN_EFFECTS)
def test_a_page_tells_what_its_class_tells(name):
    """Law, place, parameters, units, priors and sources word by word."""
    assert described.described(name) in written(name)
    for key, unit in described.fields(name).items():
        assert any(f"| `{key}{axis}` | {unit} |" in written(name) for axis in ("", ".x", ".0"))
    assert (ROOT / "docs" / "effects" / f"{name}.png").stat().st_size > 1000


def test_the_index_lists_every_effect_with_its_parameters():
    for name, place in KNOWN_EFFECTS.items():
        keys = ", ".join(f"`{key}` [{unit}]" for key, unit in described.fields(name).items())
        assert f"| {text.link(name)} | {place} | {keys or 'none'} |" in written("README")


@pytest.mark.parametrize("name", [*ALIKE, "encoder_offset", "time_delay"])
def test_numbers_on_a_page_are_those_of_the_simulation(name):
    """But for the last of their digits, which another compiler may round the other way."""
    found = study().signatures[name]
    for part in (pages.looks(found), pages.expected(found)):
        title = part.partition("\n")[0]
        section = written(name).partition(title)[2].partition("\n\n## ")[0]
        assert text.same(title + section, part)


@pytest.mark.parametrize(("name", "rival"), [(a, b) for a in ALIKE for b in ALIKE if a != b])
def test_shares_on_a_page_are_those_of_the_simulation(name, rival):
    """R^2 of a pair does not depend on the other effects of the gallery."""
    row = next(line for line in written(name).splitlines() if line.startswith(f"| {text.link(rival)} |"))
    assert text.same(row, text.table([], [verdicts._after(name, rival, study())]).splitlines()[-1])


def test_texts_that_differ_in_a_word_or_by_more_than_a_digit_are_not_the_same():
    assert text.same("gap of 1.7 mm, R² 0.951", "gap of 1.8 mm, R² 0.950")
    assert not text.same("gap of 1.7 mm", "gap of 2.1 mm")
    assert not text.same("gap of 1.7 mm", "gap of 1.7 m")


def test_docstrings_become_equations_and_links():
    law = text.law(
        r"""A law.

        .. math:: a = b, \qquad
           c = d                                          (1)

        \theta_0 of `backlash`.
        """
    )
    assert law == (
        "A law.\n\n```math\na = b, \\qquad c = d \\tag{1}\n```\n\n$\\theta_0$ of [`backlash`](backlash.md)."
    )


# ------------------------------------------------------------------------- mechanics


def test_what_coincides_quasi_statically_is_told_apart_by_more_data():
    """The contract's example: all alike from the tip in a slow sine; none in the rich set-up."""
    for name in ALIKE:
        assert set(study().poor.rivals(name)) >= set(ALIKE) - {name}
        assert not set(study().rich.rivals(name)) & set(ALIKE)


def test_torque_tells_loads_from_compliance_and_payloads_tell_encoders_from_loads():
    """A heavier payload is felt by the motor, a softer joint is not; a wrong encoder knows no payload."""
    menu = study().menu
    assert menu["motor torque"].share["payload_mass"]["joint_compliance"] < 0.9
    assert menu["motor torque"].share["link_stiffness"]["joint_compliance"] > 0.99
    assert menu["second payload"].share["encoder_eccentricity"]["joint_compliance"] < 0.9


def test_an_encoder_offset_turns_the_tip_and_a_registration_takes_it_away():
    """The model goes to the angle that is shown, beyond the true one: -L offset, and 1 % for the bending."""
    found = study().signatures["encoder_offset"]
    offset = dict((key, value) for key, value, _ in found.shown.effect.parameters())["offset"]
    run = gaps.bench(experiments.SLOW, found.model)
    gap = gaps.by_direction(run, found.shown.gaps[experiments.SLOW])
    assert gap["tangential"] == approx(-3.0 * offset, rel=0.06)
    assert study().poor.left["encoder_offset"] < 0.01


def test_a_delay_is_its_own_nuisance():
    """Of a delay of 26 ms the alignment's tangent leaves what is of second order: |a| delay/2 of |v|."""
    assert study().poor.left["time_delay"] < 0.003
    assert study().poor.share["time_delay"] == {}


# --------------------------------------------------------------------------- algebra


def test_shares_are_those_of_least_squares():
    """A second formulation: residual sums of squares with nuisances among the regressors."""
    rng = np.random.default_rng(3)
    gap, rival, nuisance = rng.normal(size=50), rng.normal(size=(50, 3)), rng.normal(size=(50, 2))

    def rss(*columns):
        regressors = np.column_stack(columns)
        return np.sum((gap - regressors @ np.linalg.lstsq(regressors, gap, rcond=None)[0]) ** 2)

    basis = shares.orthonormal(nuisance)
    span = shares.orthonormal(shares.lasting(rival * [1.0, 1e-6, 1e6], basis))
    found = shares.share_explained(shares.without(gap[:, None], basis)[:, 0], span)
    assert found == approx(1 - rss(nuisance, rival) / rss(nuisance), abs=1e-9)


def test_a_rival_that_is_a_nuisance_explains_nothing():
    rng = np.random.default_rng(4)
    nuisance = rng.normal(size=(30, 2))
    basis = shares.orthonormal(nuisance)
    assert shares.lasting(nuisance @ [[1.0], [2.0]], basis).shape == (30, 0)


def test_the_size_of_a_rival_is_the_multiple_of_its_columns():
    columns = np.random.default_rng(5).normal(size=(40, 2))
    assert shares.multiples(columns @ [3.0, -0.5], columns) == approx([3.0, -0.5])
