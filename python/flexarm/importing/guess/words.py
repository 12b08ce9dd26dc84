"""The meaning of a column from its name, its unit and the type of its message."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from unicodedata import combining, normalize

from flexarm.units import factor_to

WORD = re.compile(r"[A-Z]+(?![a-z])|[A-Z]?[a-z]+|\d+")
COUNTED = "counts"
"""Unit of an encoder that counts."""
COUNTS = (
    "count",
    "counts",
    "cnt",
    "cnts",
    "inc",
    "incs",
    "incr",
    "increments",
    "ink",
    "inkr",
    "ticks",
    "pulses",
)
"""Words of it."""
STAMPS = (
    "t",
    "time",
    "timestamp",
    "stamp",
    "sec",
    "secs",
    "seconds",
    "tstamp",
    "clock",
    "zeit",
    "zeitstempel",
)
AXES = "xyzw"
SURVEYED = {
    **dict.fromkeys(("east", "easting", "ost", "rechtswert"), "x"),
    **dict.fromkeys(("north", "northing", "nord", "hochwert"), "y"),
    **dict.fromkeys(("height", "elevation", "hohe", "hoehe"), "z"),
}
"""Words of axes, as total stations have them."""
ROTATIONS = {
    ("a", "b", "c"): "ZYX",
    ("w", "p", "r"): "xyz",
    ("roll", "pitch", "yaw"): "xyz",
    ("rx", "ry", "rz"): "vector",
}
"""Last words of three columns beside x, y, z of a robot's hand, and what they are as `rotation` of a map."""
SHARES = ("%", "‰")
"""Units of columns that are shares of a rated value."""
SPELT = {"dps": "deg/s", "radps": "rad/s", "mps2": "m/s2", "mss": "m/s2"}
"""Ends of names, as loggers spell units that a name cannot hold."""
SENSED = {"a": "acceleration", "g": "angular_rate", "w": "angular_rate", "q": "orientation", "f": "force"}
"""Letters before an axis in words of two, and what they measure."""

Rule = tuple[str, tuple[str, ...], tuple[str, ...]]
RULES: tuple[Rule, ...] = (
    (
        "joint_command",
        ("ref", "cmd", "des", "goal", "soll"),
        ("refer", "command", "desired", "setpoint", "target"),
    ),
    ("motor_voltage", (), ("volt", "spannung")),
    ("motor_torque", ("tau", "trq"), ("torque", "effort", "moment")),
    ("current", ("iq", "amp", "amps"), ("current", "strom")),
    ("acceleration", ("acc",), ("accel",)),
    ("angular_rate", (), ("gyro", "angularveloc")),
    ("joint_rate", ("vel", "qd", "dq"), ("veloc", "speed", "rate", "drehzahl", "geschw")),
    ("orientation", ("quat", "quaternion", "qx", "qy", "qz", "qw"), ("orientation", "rotation")),
    ("force", ("fx", "fy", "fz"), ("force",)),
    ("strain", (), ("strain",)),
    ("deflection", (), ("deflection",)),
    ("joint_angle", ("q", "pos", "phi", "enc"), ("angle", "encoder", "theta", "joint", "position", "winkel")),
)
"""Quantity, words that are it, and parts of words that are; the first that fits counts."""
OF_UNIT = {
    "rad": "joint_angle",
    "rad/s": "joint_rate",
    "N m": "motor_torque",
    "N": "force",
    "V": "motor_voltage",
    "m/s2": "acceleration",
}
"""Quantities of columns whose names say nothing and whose units do."""
NO_READINGS = ("err", "error", "diff", "residual", "dev", "deviation")
"""Words of columns that were computed from others."""
VECTORS = ("position", "orientation", "acceleration", "angular_rate", "force")
"""Quantities whose columns are axes of one signal."""


@dataclass(frozen=True)
class Meaning:
    """What a column seems to be."""

    quantity: str
    """Of a record, or `current`, or "" where nothing is known."""
    axis: str
    """One of x, y, z, w; empty for a scalar."""
    stem: str
    """The name without axis and unit, the same for the columns of one vector."""
    unit: str
    """Unit that the name or the file gives; empty if none."""
    why: str
    """The reason, for a person."""
    rotation: str = ""
    """What three columns of an orientation are, as a map's `rotation` says it."""


def words_of(name: str) -> list[str]:
    """Return the words of a name in lower case, without accents.

    >>> words_of("act_posMot[2]"), words_of("Zähler Hüfte")
    (['act', 'pos', 'mot', '2'], ['zahler', 'hufte'])
    """
    plain = "".join(letter for letter in normalize("NFD", name) if not combining(letter))
    return [word.lower() for word in WORD.findall(plain)]


def unit_in(name: str, said: str = "") -> str:
    """Return the unit of a column, by the file or by the end of its name."""
    name = re.sub(r"\[\d+\]$", "", name)
    brackets = re.findall(r"[\[(]([^\])]+)[\])]\s*$", name)
    per = re.search(r"_([A-Za-z]+)_per_([A-Za-z]+2?)$", name)
    tail = f"{per[1]}/{per[2]}" if per else name.rpartition("_")[2]
    tail = "N m" if tail == "nm" else SPELT.get(tail, tail)
    ends = [part.rpartition(" in ")[2] for part in brackets]
    for given in (said, *brackets, *ends, tail):
        text: str = given.strip().replace("rads/s", "rad/s").replace("Nm", "N m").replace("degrees", "deg")
        if text.lower() in COUNTS:
            return COUNTED
        if factor_to("A", text) is not None or text in SHARES:
            return text
        # One letter at the end of a name is a unit only where something stands before it.
        if (
            text
            and text != name
            and any(factor_to(si, text) is not None for si in (*OF_UNIT, "m", "s", "Pa"))
        ):
            return text
    return ""


def _sensed(words: Sequence[str]) -> tuple[str, str, str]:
    """Return the word of a name that is an axis of a sensor, such as `ax`, with its quantity and axis.

    `ax1` is an axis of a robot.
    """
    pairs = ((w, SENSED.get(w[0], ""), w[1]) for w in words if len(w) == 2 and w[1] in AXES)
    numbered = any(word.isdigit() for word in words)
    return next((p for p in pairs if p[1] and not (numbered and p[0][0] in "agw")), ("", "", ""))


def meaning_of(name: str, said_unit: str = "", kind: str = "") -> Meaning:
    """Return what a column seems to be."""
    unit = unit_in(name, said_unit)
    plain, _, tail = name.rpartition("_")
    words = words_of(plain if tail in SPELT else name)
    words = [w for w in words if w != unit.lower() and not (unit == COUNTED and w in COUNTS)]
    pair, sensed, of_pair = _sensed(words)
    surveyed = next((w for w in words if w in SURVEYED), "")
    axis = next((w for w in reversed(words) if w in AXES), "") or of_pair or SURVEYED.get(surveyed, "")
    stem = " ".join(w for w in words if w not in (axis, pair, surveyed))
    joined = "".join(words)
    found, why = "", ""
    if any(word in NO_READINGS for word in words):
        return Meaning("", "", stem, unit, "")
    for quantity, whole, parts in RULES:
        hit = next((w for w in words if w in whole), "") or next((p for p in parts if p in joined), "")
        if hit and not (quantity == "joint_angle" and axis):
            found, why = quantity, f"{hit!r} in the name"
            break
    if sensed and axis == of_pair and (not found or found == "joint_angle"):
        found, why = sensed, f"{pair!r} in the name"
    if not found and re.fullmatch(r"q\d+", joined):
        found, why = "joint_angle", "the name"
    si = next((si for si in (*OF_UNIT, "m") if unit and factor_to(si, unit) is not None), "")
    pressure = bool(unit) and factor_to("Pa", unit) is not None
    if axis and axis != "w" and (not found or found == "joint_angle") and si in ("", "m") and not pressure:
        found, why = "position", f"coordinate {axis} of a point"
    if not found and unit == COUNTED:
        found, why = "joint_angle", f"its unit {unit}"
    if not found and si in OF_UNIT:
        found, why = OF_UNIT[si], f"its unit {unit}"
    if found == "angular_rate" and not axis:
        found = "joint_rate"
    if "JointState" in kind and not axis:
        field = name.partition("[")[0]
        known = {"position": "joint_angle", "velocity": "joint_rate", "effort": "motor_torque"}
        found, why = known.get(field, ""), f"{field} of a JointState"
    return Meaning(found, axis, stem, unit, why)


def is_stamp(name: str) -> bool:
    """Return True if a name says that a column holds stamps."""
    return any(word in STAMPS for word in words_of(name)[:2]) or is_header_stamp(name)


def is_header_stamp(name: str) -> bool:
    """Return True for the stamp in the header of a ROS message: of the measurement, not of its arrival.

    >>> is_header_stamp("field.header.stamp"), is_header_stamp("%time")
    (True, False)
    """
    return words_of(name)[-2:] == ["header", "stamp"]


def matched(name: str, known: Sequence[str]) -> str:
    """Return the longest of known names that stands in a name, a letter as a word of it; empty if none does.

    >>> matched("position[left_shoulder]", ["shoulder", "left_shoulder"])
    'left_shoulder'
    """
    words = words_of(name)
    plain = "".join(words)
    texts = {each: "".join(words_of(each)) for each in known}
    found = [each for each, text in texts.items() if text and text in (plain if len(text) > 1 else words)]
    return max(found, key=len, default="")
