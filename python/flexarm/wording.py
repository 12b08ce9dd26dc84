"""Numbers and effects as a person reads them: SI prefixes, as many digits as are known, places by their kind.

A number is shown with the largest prefix of which it is at least 1, or 0.1 from the unit itself downwards
(without a prefix below a tenth of a nano-unit), and an estimate with the digits that its interval leaves: two
of the interval's half width.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from math import floor, isfinite, log10
from typing import TYPE_CHECKING

from flexarm.arm.vocabulary import KNOWN_EFFECTS

if TYPE_CHECKING:
    from flexarm.named_effects import Estimate


_PREFIXES = {-9: "n", -6: "µ", -3: "m", 0: "", 3: "k", 6: "M", 9: "G"}
_RAISED = str.maketrans("234", "²³⁴")
_WITHOUT_PREFIX = ("", "-", "Hz", "%")
_FREE_OF_SIZE = ("m", "rad", "s")
"""Units that begin an expression such as m/s, whose prefix stays below one.

Nobody says 3 km/s of an arm, or 3 ks.
"""


def scale(values: Iterable[float | None], unit: str) -> tuple[float, str]:
    """Return a factor and a unit in which the largest of the values reads well.

    >>> scale([3.2e-3, 6e-5], "m"), scale([1.36e5], "N m/rad")
    ((1000.0, 'mm'), (0.001, 'kN m/rad'))
    >>> scale([3e-10], "m"), scale([6.5e-15], "m")
    ((1000000000.0, 'nm'), (1.0, 'm'))
    >>> scale([1.4e6], "s"), scale([6e-4], "m2")
    ((1.0, 's'), (1.0, 'm²'))
    """
    sizes = [abs(value) for value in values if value is not None and isfinite(value)]
    largest = max(sizes, default=0.0)
    shown = "" if unit in ("-", "1") else unit.translate(_RAISED)
    first = unit.split("/")[0].split(" ")[0]
    if unit in _WITHOUT_PREFIX or first in ("1", "kg") or first[-1:].isdigit() or largest == 0:
        return 1.0, shown  # a prefix would count in a power
    least = 1.0 if largest >= 1 else 0.1
    power = min(9, 3 * floor(log10(largest / least * (1 + 1e-12)) / 3))
    if power not in _PREFIXES:  # rounding of the computer, below any prefix
        return 1.0, shown
    if first in _FREE_OF_SIZE:
        power = min(power, 0)
    return 10.0**-power, _PREFIXES[power] + shown


def labelled_scale(values: Iterable[float | None], unit: str) -> tuple[float, str]:
    """Return the same for a label, in which a dash stands for no unit.

    >>> labelled_scale([3.2e-3], "m"), labelled_scale([3.2e-3], "1")
    ((1000.0, 'mm'), (1.0, '-'))
    """
    factor, shown = scale(values, unit)
    return factor, shown or "-"


def number(value: float | None, digits: int = 3) -> str:
    """Significant digits without an exponent where that stays short; a dash for what is not known.

    >>> number(0.05678), number(1234.5), number(2.5e-9), number(None)
    ('0.0568', '1234', '2.50e-09', '–')
    """
    if value is None or not isfinite(value):
        return "–"
    if value == 0:
        return "0"
    size = floor(log10(abs(float(f"{value:.{digits - 1}e}"))))
    if not -4 <= size <= 6:
        return f"{value:.{digits - 1}e}"
    return f"{value:.{max(0, digits - 1 - size)}f}"


def with_unit(value: float | None, unit: str, digits: int = 3) -> str:
    """Return a number and its unit.

    >>> with_unit(3.21e-3, "m"), with_unit(0.97, "-")
    ('3.21 mm', '0.970')
    """
    factor, shown = scale([value], unit)
    return f"{number(None if value is None else factor * value, digits)} {shown}".rstrip()


def instant(time: float) -> str:
    """Return a stamp in seconds, to a tenth however far from zero clocks count.

    >>> instant(12.53), instant(4242.1234)
    ('12.5', '4242.1')
    """
    return f"{time:.3g}" if abs(time) < 100 else f"{time:.1f}"


def stamp(time: float) -> str:
    """Return a stamp in seconds, to a millisecond where it counts from far away, such as from 1970.

    >>> stamp(0.0123456), stamp(12.5), stamp(1.78e9 + 0.25)
    ('0.0123456', '12.5', '1780000000.25')
    """
    return f"{time:.6g}" if abs(time) < 1000 else f"{time:.3f}".rstrip("0").rstrip(".")


def interval(estimate: Estimate) -> tuple[str, str, str, str]:
    """Value, lower and upper end of the 90 % interval with the digits it leaves, and their unit."""
    factor, unit = scale([estimate.value, estimate.low90, estimate.high90], estimate.unit)
    ends = [factor * value for value in (estimate.value, estimate.low90, estimate.high90)]
    half = abs(ends[2] - ends[1]) / 2
    if not isfinite(half) or half == 0:
        return number(ends[0], 4), number(ends[1], 4), number(ends[2], 4), unit
    places = max(0, min(9, 1 - floor(log10(half))))
    value, low, high = (fixed(end, places) for end in ends)
    return value, low, high, unit


def fixed(value: float, places: int) -> str:
    """So many decimals; no zero below zero.

    >>> fixed(-0.004, 2), fixed(-1.25, 1)
    ('0.00', '-1.2')
    """
    text = f"{value:.{places}f}" if isfinite(value) else "–"
    return text.removeprefix("-") if not text.strip("-0.") else text


def signed(value: float, places: int) -> str:
    """So many decimals, with a sign.

    >>> signed(0.056, 3), signed(-1.8, 2), signed(-0.001, 2)
    ('+0.056', '-1.80', '0.00')
    """
    text = fixed(value, places)
    return f"+{text}" if value > 0 and text.strip("0.") else text


def effect_words(name: str) -> str:
    """Return the name of an effect as words."""
    return name.replace("_", " ")


SPELT_OUT = 4
"""Most places of a family that are spelt out in a sentence; its parameters name all."""


def place_words(name: str, at: str | Sequence[str]) -> str:
    """Return an effect with its place, and what kind of thing that is where the effect's name does not say
    it; or with the places of a family.

    >>> place_words("backlash", "hinge"), place_words("link_mass", "rod"), place_words("base_tilt", "base")
    ('backlash at joint hinge', 'link mass at rod', 'base tilt')
    >>> (
    ...     place_words("viscous_friction", ["a", "b"]),
    ...     place_words("joint_compliance", ("a", "b", "c", "d", "e")),
    ... )
    ('viscous friction at joints a and b', 'joint compliance at 5 joints')
    """
    kind = KNOWN_EFFECTS.get(name, "")
    if at == "base":
        return effect_words(name)
    said = " or " in kind or kind in name.split("_")
    if isinstance(at, str):
        return f"{effect_words(name)} at {at if said else f'{kind} {at}'.strip()}"
    if len(at) > SPELT_OUT:
        return f"{effect_words(name)} at {len(at)} {'places' if ' or ' in kind else f'{kind}s'}"
    return f"{effect_words(name)} at {listed(at) if said else f'{kind}s {listed(at)}'}"


def reference_words(name: str, unknown: bool = False) -> str:
    """Return what the error of a clock or frame is told against; empty for other effects.

    Of a frame whose pose is `unknown` that is a first guess.

    >>> reference_words("time_delay"), reference_words("backlash")
    (", against the drive's clock", '')
    >>> reference_words("frame_registration", unknown=True)
    ", against a first guess of its pose, which is unknown, in the base's axes"
    """
    kind = KNOWN_EFFECTS.get(name, "")
    if kind == "frame" and unknown:
        return ", against a first guess of its pose, which is unknown, in the base's axes"
    if kind == "frame":
        return ", against its stated pose, in the base's axes"
    return ", against the drive's clock" if "clock" in kind else ""


def probability(value: float) -> str:
    """Return a probability that never claims to be certain.

    >>> probability(0.9999), probability(0.5), probability(0.001)
    ('> 0.99', '0.50', '< 0.01')
    """
    return "> 0.99" if value > 0.99 else "< 0.01" if value < 0.01 else f"{value:.2f}"


def listed(words: Sequence[str], last: str = "and") -> str:
    """Words with commas, and a word before the last.

    >>> listed(["a", "b", "c"]), listed(["a", "b"], "or")
    ('a, b and c', 'a or b')
    """
    return " ".join([", ".join(words[:-1]), last, words[-1]]) if len(words) > 1 else "".join(words)


def times_noise(sizes: Mapping[str, float]) -> str:
    """Signals with sizes over their noise.

    >>> times_noise({"tip": 4.41, "hub": 0.5}), times_noise({"tip": 4.41})
    ('tip by 4.4 and hub by 0.5 times their noise', 'tip by 4.4 times its noise')
    """
    whose = "its" if len(sizes) == 1 else "their"
    return f"{listed([f'{name} by {size:.2g}' for name, size in sizes.items()])} times {whose} noise"
