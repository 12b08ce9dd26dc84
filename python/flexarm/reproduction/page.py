"""`index.html`: method, figures, claims and assumptions."""

from __future__ import annotations

from typing import Any

from markupsafe import Markup

from flexarm.configuration import config
from flexarm.report.files import filled
from flexarm.reproduction.deformed_figure import ARM_SCALE, HINGE_SCALE
from flexarm.reproduction.oscillation import start_time
from flexarm.reproduction.study import Study
from flexarm.reproduction.tables import deformed_instant, zoom_window

CAPTIONS = {
    "04": "Angle of the reducer's input shaft: the sine of ±1.2 rad times the ratio 120.",
    "06": "Deformed mock-up at t = {instant:.1f} s, the instant of the greatest measured offset: the solid "
    "parts and the tube in colours of displacement, drawn {arm:g} times as large (hinge: {hinge:g} times); "
    "equilibrium at the encoder's angle. Right: the three tip positions, true scale, as they move.",
    "07": "Vertical and horizontal tip position: rigid arm at the encoder's angle, finite-element model "
    "driven by the encoder, virtual measurement.",
    "08": "The vertical position enlarged, {first:.1f} to {last:.1f} s. Model and measurement vibrate "
    "together; the rigid curve is some centimetres away. Below: the distance from the rigid curve. After the "
    "turn of the motion at {turn:.1f} s the bearing of the virtual mock-up sticks, which the model does not "
    "know.",
    "09": "Vertical and horizontal error of the rigid position: virtual measurement and finite-element "
    "model.",
    "10": "Tangential error: virtual measurement, model driven by the encoder signal, model driven by the "
    "pure sine. The pure sine starts and stops with a jump of speed: it rings there and nowhere else.",
}
"""Captions of the figures."""


def page(study: Study, summary: dict[str, Any], seconds: dict[str, float]) -> str:
    """Return the page as HTML; images stand next to it."""
    first, last = zoom_window(study)
    facts = {
        "instant": deformed_instant(study),
        "first": first,
        "last": last,
        "turn": study.experiment.period / 4,
        "arm": ARM_SCALE,
        "hinge": HINGE_SCALE,
    }
    versions = config()
    return filled(
        "page.html.j2",
        {"mm": _mm, "number": _number, "power": _power},
        summary=summary,
        claims=summary["claims"],
        parameters=summary["parameters"],
        models=summary["models"],
        misprint=summary["misprint"],
        split=summary["claims"][4]["numbers"],
        captions={number: text.format(**facts) for number, text in CAPTIONS.items()},
        start_ends=start_time(study),
        seconds=seconds,
        versions={name: versions[name] for name in ("flexarm", "git", "step factorisation", "platform")},
    )


def _mm(metres: float, digits: int = 2) -> str:
    return f"{1e3 * metres:.{digits}f} mm"


def _number(value: float) -> str:
    """Write three digits, or as many as tell a share from 1."""
    return f"{value:.5f}" if 0.999 < value < 1 else f"{value:.3g}"


def _power(value: float, digits: int = 3) -> Markup:
    """Return the mantissa times a power of ten."""
    mantissa, exponent = f"{value:.{digits - 1}e}".split("e")
    return Markup("{} · 10<sup>{}</sup>").format(mantissa, str(int(exponent)).replace("-", "−"))
