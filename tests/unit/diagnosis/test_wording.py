"""Claims about numbers and effects as a person reads them."""

import doctest
from math import inf

import pytest

from flexarm import wording
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.named_effects import Estimate
from flexarm.wording import interval, number, place_words, scale, with_unit


def test_examples_hold():
    assert doctest.testmod(wording).failed == 0


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.012345, "m", "12.3 mm"),
        (6.76e-5, "m", "67.6 µm"),
        (1234.5, "m", "1234 m"),  # no arm is a kilometre long
        (5.8e-4, "rad", "0.580 mrad"),
        (0.35, "rad", "0.350 rad"),
        (9.564e9, "N m/rad3", "9.56 GN m/rad³"),
        (2.1e11, "Pa", "210 GPa"),
        (14.1, "kg", "14.1 kg"),
        (0.0005, "kg", "0.000500 kg"),  # a prefix on kg would be read as one on g
        (1.02, "-", "1.02"),
        (5e-4, "1/m", "0.000500 1/m"),  # no metre is milli
        (2e-5, "s/s", "20.0 µs/s"),
        (-1e-3, "s", "-1.00 ms"),
        (0.0, "m", "0 m"),
        (inf, "m", "– m"),
    ],
)
def test_values_are_shown_with_the_prefix_that_suits_them(value, unit, text):
    assert with_unit(value, unit) == text


@pytest.mark.parametrize("value", [9.995, 0.9996, 99.96, 999.4, 1e-4, 0.001])
def test_three_digits_are_three_digits_where_rounding_carries(value):
    text = number(value)
    assert float(text) == float(f"{value:.2e}")
    assert len(text.replace(".", "").lstrip("0")) == 3


def test_values_of_a_table_share_one_unit():
    factor, unit = scale([7.92e-3, 6.76e-5, None], "m")
    assert unit == "mm"
    assert number(factor * 6.76e-5) == "0.0676"


@pytest.mark.parametrize(
    ("value", "half", "shown"),
    [
        (5.8e-4, 2e-5, ("0.580", "0.560", "0.600", "mrad")),
        (1.4e5, 3e4, ("140", "110", "170", "kN m/rad")),
        (0.3, 0.0, ("0.3000", "0.3000", "0.3000", "rad")),
    ],
)
def test_an_interval_says_how_many_digits_count(value, half, shown):
    unit = "rad" if value < 1 else "N m/rad"
    assert interval(Estimate("x", value, half, value - half, value + half, unit)) == shown


def test_an_open_interval_has_no_end():
    _, low, high, _ = interval(Estimate("x", 1e5, inf, 5e4, inf, "N m/rad"))
    assert high == "–"
    assert low != "–"


def test_every_effect_of_the_vocabulary_has_words():
    for name in KNOWN_EFFECTS:
        words = place_words(name, "thing")
        assert "_" not in words
        assert words.endswith("thing")
        assert len(set(words.split())) == len(words.split())  # "joint compliance at joint ..." says it twice
