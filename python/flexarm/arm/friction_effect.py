r"""Dry friction with a shape: it sticks or creeps, and may fall with the rate.

.. math:: T_f = T_c \, s \left(1 + \delta e^{-(v/v_s)^2}\right)                                        (1)
.. math:: s = z, \; \dot z = (1 - z \operatorname{sgn} v)\, v/w, \quad \text{or} \quad
   s = \tanh(v/v_c)                                                                                   (2)

v [rad/s] is the rate, T_c [N m] the torque of fast sliding. Friction that sticks follows Dahl's law of the
pre-sliding width w [rad]; friction that creeps is a sign of the rate, regularised over v_c [rad/s]. Slow
sliding takes (1 + \delta) T_c (Stribeck's drop [Armstrong1994]_). Where friction sticks the drop acts on
sgn v instead of z, so that (1) is Dahl's law of (1 + \delta) T_c and a function of the rate.

Shape is no effect of its own: a law of another shape is still that law. A search therefore names friction
of the usual shape, and frees w, v_c, or \delta and v_s, where it leaves a gap.

References
----------
.. [Armstrong1994] B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis tools
   and compensation methods for the control of machines with friction", Automatica 30(7), 1994.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, ClassVar

import numpy as np

from flexarm.arm.effect import Effect
from flexarm.arm.prior import Prior
from flexarm.tables import Number, value_in

if TYPE_CHECKING:
    from flexarm import _core

STICK_WIDTH = 2e-5
"""w of (1) where none is stated [rad]."""
KNOTS = np.array([0.1, 0.25, 0.5, 0.75, 1.0, 1.25, 1.5, 1.75, 2.0, 2.5, 3.0, 4.0])
"""Rates over v_c and v_s at the knots of tables of (1)."""


class FrictionEffect(Effect):
    """Dry friction; a subclass has the torque T_c of (1) and puts the laws where they act.

    `width` is w and `creep_rate` v_c of (2), `drop` delta and `stribeck_rate` v_s of (1).
    """

    smooth = False
    one_signed = True
    varies_with = "rate"
    shape: ClassVar[tuple[str, ...]] = ("width", "creep_rate", "drop", "stribeck_rate")
    width: Number = value_in("rad", "pre-sliding width where it sticks", STICK_WIDTH, gt=0)
    creep_rate: Number = value_in("rad/s", "rate over which it builds up; 0: it sticks", 0.0, ge=0)
    drop: Number = value_in("-", "part by which slow sliding takes more than fast", 0.0, ge=0)
    stribeck_rate: Number = value_in("rad/s", "rate over which that part fades", 3e-2, gt=0)

    def parameters(self) -> list[tuple[str, float, str]]:
        """Sizes, then the shape where it is not the usual one."""
        found = super().parameters()
        shaped = self._shaped()
        sizes = [each for each in found if each[0] not in self.shape]
        return sizes + [each for each in found if each[0] in shaped]

    @property
    def is_shaped(self) -> bool:
        """Return True if its shape is not the usual one."""
        return bool(self._shaped())

    def _shaped(self) -> tuple[str, ...]:
        """Return the names of parameters that make the shape another one than the usual."""
        sticks = ("width",) if self.width != STICK_WIDTH else ()
        start = ("creep_rate",) if self.creep_rate else sticks
        return (*start, "drop", "stribeck_rate") if self.drop else start

    def shapes(self) -> Iterator[Mapping[str, float]]:
        """Yield friction of wide pre-sliding, such that creeps, and such that falls with the rate."""
        if not self.creep_rate:
            yield from ({"width": width} for width in (3e-4, 3e-3))
            yield from ({"creep_rate": rate} for rate in (1e-2, 1e-1))
        yield from ({"drop": 0.3, "stribeck_rate": rate} for rate in (1e-2, 1e-1))

    def shape_priors(self) -> dict[str, Prior]:
        """Return what is plausible of the shape, where it is not the usual one."""
        width = "engineering judgement: joints creep by 1e-5 to 5e-3 rad before they slip"
        starting = "Armstrong-Helouvry et al., Automatica 30(7), 1994: starting takes up to twice sliding"
        rate = "the same: 1e-5 to 0.1 m/s, at radii of some 0.1 m"
        priors = {
            "width": Prior(2e-6, 5e-3, 1e-4, "log", "rad", width),
            "creep_rate": Prior(1e-4, 0.5, 1e-2, "log", "rad/s", "engineering judgement: as stribeck_rate"),
            "drop": Prior(0.02, 1.5, 0.2, "log", "-", starting),
            "stribeck_rate": Prior(1e-3, 1.0, 3e-2, "log", "rad/s", rate),
        }
        return {name: priors[name] for name in self._shaped()}

    def laws(self, torque: float) -> list[_core.DahlFriction | _core.TabulatedTorque]:
        """Return the laws that lose the torque of (1), of a T_c [N m]."""
        from flexarm import _core

        sticks = [] if self.creep_rate else [_core.DahlFriction((1.0 + self.drop) * torque, self.width)]
        table = self.table(torque)
        if table is None:
            return [*sticks]
        return [*sticks, _core.TabulatedTorque(_core.Of.rate, _core.ChangingTable(table))]

    def table(self, torque: float) -> _core.MonotoneCubic | None:
        """Return the part of (1) [N m] that is a function of the rate [rad/s]; None where nothing is."""
        from flexarm import _core

        scales = [
            each
            for each, acts in ((self.creep_rate, self.creep_rate), (self.stribeck_rate, self.drop))
            if acts
        ]
        if not scales:
            return None
        rate = np.unique(np.concatenate([scale * KNOTS for scale in scales]))
        slow = self.drop * np.exp(-((rate / self.stribeck_rate) ** 2))
        creeps = np.tanh(rate / self.creep_rate) * (1.0 + slow) if self.creep_rate else slow - self.drop
        lost = torque * creeps  # eqs. (1), (2)
        return _core.MonotoneCubic([*-rate[::-1], 0.0, *rate], [*-lost[::-1], 0.0, *lost])
