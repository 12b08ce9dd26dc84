"""Causes that no effect of the vocabulary has, with the curve and the words that tell each of them."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, sin, tanh

import numpy as np
from hidden_pendulum import STIFFNESS, Cause, Floats


@dataclass(frozen=True)
class Hidden:
    """A cause and what it is.

    Attributes
    ----------
    cause : Cause
        What records hide.
    kind, quantity, of : str
        How a missing law tells it.
    curve : callable or None
        The quantity over its state; after the instant, of a change.
    instant : float or None
        When it changes [s].
    """

    cause: Cause
    kind: str
    quantity: str = ""
    of: str = ""
    curve: Callable[[Floats], Floats] | None = None
    instant: float | None = None


def _spring(windup: Callable[[Floats], Floats]) -> Callable[[float, float], float]:
    """Return the torque of a deflection whose spring gives way by a windup w(T): d = T/k - w(T)."""
    torque = np.linspace(-4e3, 4e3, 16001)
    deflection = torque / STIFFNESS - windup(torque)
    return lambda t, d: float(np.interp(d, deflection, torque))


def _lost(of: str, curve: Callable[[float], float]) -> Hidden:
    """Return a torque that is lost as a function of the angle or the rate."""
    if of == "angle":
        cause = Cause(lost=lambda t, angle, rate, z: curve(angle))
    else:
        cause = Cause(lost=lambda t, angle, rate, z: curve(rate))
    return Hidden(cause, "law", "torque", of, np.vectorize(curve))


def _gives_way(windup: Callable[[Floats], Floats]) -> Hidden:
    return Hidden(Cause(spring=_spring(windup)), "law", "windup", "torque", windup)


def softening(size: float = 1.0) -> Hidden:
    """A spring that gives way with the fifth power of the torque."""
    return _gives_way(lambda torque: -2e-4 * size * (torque / 800) ** 5)


def loose(size: float = 1.0) -> Hidden:
    """A coupling that turns by a third of a milliradian around zero torque."""
    return _gives_way(lambda torque: -3e-4 * size * np.tanh(torque / 80))


def rubbing(size: float = 1.0) -> Hidden:
    """A bearing that drives the link near one angle."""
    return _lost("angle", lambda angle: -60 * size * exp(-(((angle - 0.2) / 0.12) ** 2)))


def cogging(size: float = 1.0) -> Hidden:
    """A torque of the sixth order of the angle."""
    return _lost("angle", lambda angle: 40 * size * sin(6 * angle + 0.4))


def bumper(size: float = 1.0) -> Hidden:
    """Rubber that the link meets near the end of its range."""
    return _lost("angle", lambda angle: 25 * size * exp(min(angle - 0.3, 1.2) / 0.2))


def saturating(size: float = 1.0) -> Hidden:
    """A drag that saturates with the rate."""
    return _lost("rate", lambda rate: 60 * size * tanh(rate / 0.15))


def stribeck(size: float = 1.0) -> Hidden:
    """A friction that falls with the rate."""
    return _lost("rate", lambda rate: size * tanh(rate / 0.03) * (30 + 40 * exp(-((rate / 0.2) ** 2))))


def softer_after(instant: float, part: float = 0.25) -> Hidden:
    """A spring that loses a part of its stiffness at an instant: 1/k grows."""
    k = STIFFNESS
    return Hidden(
        Cause(spring=lambda t, d: k * d * (1 - part if t > instant else 1.0)),
        "change",
        "windup",
        "torque",
        lambda torque: -torque / k * (1 / (1 - part) - 1),
        instant,
    )


def dragging_after(instant: float, size: float = 1.0) -> Hidden:
    """A drag that begins at an instant."""
    curve = np.vectorize(lambda rate: 60 * size * tanh(rate / 0.15))
    return Hidden(
        Cause(lost=lambda t, angle, rate, z: 60 * size * tanh(rate / 0.15) * (t > instant)),
        "change",
        "torque",
        "rate",
        curve,
        instant,
    )


def presliding(size: float = 1.0) -> Hidden:
    """A torque that turns round in a tenth of a radian: no law of a state or a sense of motion."""
    return Hidden(Cause(lost=lambda t, angle, rate, z: 60 * size * z, width=0.1), "none")


def cable(size: float = 1.0) -> Hidden:
    """A cable that drags against the motion, more so where it is bent."""
    return Hidden(
        Cause(lost=lambda t, angle, rate, z: size * tanh(rate / 0.03) * (30 + 60 * max(angle, 0.0))),
        "law with memory",
        "torque",
        "angle",
    )


def warming(size: float = 1.0) -> Hidden:
    """A windup that creeps with time."""
    return Hidden(Cause(windup=lambda t, *_: 1.5e-3 * size * (1 - exp(-t / 8))), "time")


def gusts(rng: np.random.Generator, size: float = 1.0) -> Hidden:
    """A torque that follows no state: waves of 0.1 to 0.8 Hz with random phases."""
    waves = [(6.28 * rng.uniform(0.1, 0.8), rng.uniform(0, 6.28)) for _ in range(8)]
    return Hidden(
        Cause(lost=lambda t, *_: 20 * size * sum(sin(rate * t + phase) for rate, phase in waves)), "none"
    )


NOTHING = Hidden(Cause(), "")
