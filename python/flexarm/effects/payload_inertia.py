r"""Inertia of a payload about its own centre.

.. math:: J \leftarrow \text{diag}(J_x, J_y, J_z)                                                    (1)

in the axes of the link, or of the interface at `link:interface` [kg m2]; one number stands for all three. A
model often has a point mass instead; its first frequency is then too high, by Rayleigh's quotient with the
angle \alpha of the mode at the payload

.. math:: \frac{\omega^2}{\omega_0^2} = \frac{1}{1 + J \alpha^2 / m^*}                               (2)

where m^* is the modal mass without J.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import BeforeValidator, model_validator

from flexarm.arm.effect import Effect
from flexarm.arm.inertia import impossible, inertia_matrix
from flexarm.arm.prior import Prior
from flexarm.tables import Inconsistent, Number, Vector3, to_python, value_in

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.assembly.machine import Machine


def _one_or_three(value: Any) -> Any:
    value = to_python(value)
    numbers = tuple(value) if isinstance(value, list | tuple) else (value,)
    right = all(isinstance(number, int | float) and not isinstance(number, bool) for number in numbers)
    if len(numbers) not in (1, 3) or not right:
        raise ValueError(f"must be one number or [Ixx, Iyy, Izz] [kg m2], got {value!r}")
    return numbers if len(numbers) == 3 else float(numbers[0])


class PayloadInertia(Effect):
    """Another inertia of a payload.

    Moments are in the axes that the payload's position is in; left out: the nominal ones.
    """

    name = "payload_inertia"
    in_motion = ("inertia",)
    inertia: Annotated[Number | Vector3 | None, BeforeValidator(_one_or_three)] = value_in(
        "kg m2", "inertia of the payload about its centre, one number or [Ixx, Iyy, Izz]", None
    )

    @model_validator(mode="after")
    def _check(self) -> Self:
        if self.inertia is not None and (why := impossible(self._moments())):
            raise Inconsistent((("inertia",), why))
        return self

    def _moments(self) -> Vector3:
        assert self.inertia is not None
        return self.inertia if isinstance(self.inertia, tuple) else (self.inertia,) * 3

    def patch(self, machine: Machine) -> None:
        """Another inertia, eq. (1)."""
        if self.inertia is not None:
            machine.payloads[self.at].inertia = inertia_matrix(self._moments())  # eq. (1)

    def null(self, arm: Arm) -> dict[str, float]:
        """Return the mean of the nominal moments."""
        moments = arm.payload(self.at).inertia[:3]
        return {name: sum(moments) / 3 for name, _, _ in self.parameters()}

    def priors(self, arm: Arm) -> dict[str, Prior]:
        """Of a body as heavy as the payload, with a radius of gyration of 2 to 40 cm."""
        mass = arm.payload(self.at).mass or 1.0
        source = "engineering judgement: radius of gyration from 2 cm (a steel disc) to 40 cm (a long tool)"
        prior = Prior(mass * 0.02**2, mass * 0.4**2, mass * 0.1**2, "log", "kg m2", source)
        names = [f"inertia.{axis}" for axis in "xyz"] if isinstance(self.inertia, tuple) else ["inertia"]
        return dict.fromkeys(names, prior)
