r"""End stops of a joint with cushions, as of a hydraulic cylinder.

.. math:: T \leftarrow T - \sigma \left(k \max(d, 0) + c \, g(u) \max(\sigma \dot\theta, 0)\right), \qquad
   d = \sigma (\theta - \theta_e), \quad u = 1 + d/w                                                  (1)
.. math:: g(u) = 0 \; (u \le 0), \quad 3 u^2 - 2 u^3 \; (0 < u < 1), \quad 1 \; (u \ge 1)             (2)

\theta_e [rad] is the nearer end, \sigma = 1 at the upper and -1 at the lower one, and d how far the link is
beyond it. On the last way w before an end the oil is throttled, while the link moves towards it: a check
valve opens on the way back. At the end the piston meets its head, a spring k. Without damping the ends are
bare stops. A mass m that enters a cushion with a rate v reaches the end with v - c w/(2 m).
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Self

from pydantic import model_validator

from flexarm.arm.closure import PINNED
from flexarm.arm.effect import Derivative, Effect, Search, Trial
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import Prior, Priors, Values
from flexarm.tables import Inconsistent, Number, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


class EndCushion(Effect):
    """End stops with cushions at the output bearing.

    `low` and `high` are the two ends theta_e, `stiffness` is k, `length` w and `damping` c of (1).
    """

    name = "end_cushion"
    stated_only = True
    priors_along = True
    torque_at = "output"
    at_closures = PINNED
    smooth = False
    low: Number = value_in("rad", "lower end")
    high: Number = value_in("rad", "upper end")
    stiffness: Number = value_in("N m/rad", "stiffness beyond the ends", gt=0)
    length: Number = value_in("rad", "way before an end on which the cushion acts", 0.02, gt=0)
    damping: Number = value_in("N m s/rad", "damping of the cushion at the end", 0.0, ge=0)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if not self.high > self.low:
            what = f"must lie above low = {self.low:g}, got {self.high:g}"
            raise Inconsistent((("high",), what))
        if self.length > 0.5 * (self.high - self.low):
            way = self.high - self.low
            what = f"must be at most half the way between the ends, {way:g}, got {self.length:g}"
            raise Inconsistent((("length",), what))
        return self

    def patch(self, machine: Machine) -> None:
        """Add stops and cushions at the output bearing, eqs. (1), (2)."""
        from flexarm import _core

        machine.drive_trains[self.at].bearing.append(
            _core.EndCushion(
                low=self.low,
                high=self.high,
                stiffness=self.stiffness,
                length=self.length,
                damping=self.damping,
            )
        )

    def derivative(self, parameter: str) -> Derivative:
        """Return "smooth": the torque is continuous in all of them."""
        return "smooth"

    def trials(self, search: Search) -> Iterator[Trial]:
        """Yield ends as the drawing has them: a cushion wears or is screwed to another throttle."""
        yield Trial(fixed={name: value for name, value, _ in self.parameters() if name != "damping"})

    def probes(
        self, stated: Effect | None, free: Sequence[str], null: Values, priors: Priors
    ) -> Iterator[Self]:
        """Yield a cushion that throttles half as much; none where the model states bare stops."""
        if null["damping"]:
            yield self.with_parameters({"damping": 0.5 * null["damping"]})

    def stated_priors(self, arm: Arm) -> dict[str, Prior]:
        """Return the prior about the damping that the model states: its screw and wear change it tenfold."""
        c, unit = self.damping, priors_in(self, arm)["damping"].unit
        wear = "engineering judgement: cushions are set by a screw and lose by wear"
        return {"damping": Prior(c / 10, 10 * c, c, "log", unit, wear)} if c else {}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """From ends near half a turn, heads of steel, and cushions that stop a link within their length."""
        ends = "engineering judgement: joints of arms turn by a quarter to a whole turn to either side"
        heads = "engineering judgement: stops of steel or rubber give by 1 mrad to 0.1 rad at rated torque"
        way = "catalogues: cushions of cylinders are 10 to 40 mm long"
        loss = "engineering judgement: a link that enters at 0.1 to 1 rad/s stops within the cushion"
        return {
            "low": Prior(-4.0, -0.5, -1.0, "linear", "rad", ends),
            "high": Prior(0.5, 4.0, 1.0, "linear", "rad", ends),
            "stiffness": Prior(1e3, 1e7, 1e5, "log", "N m/rad", heads),
            "length": Prior(5e-3, 0.2, 0.04, "log", "rad", way),
            "damping": Prior(10.0, 1e5, 1e3, "log", "N m s/rad", loss),
        }
