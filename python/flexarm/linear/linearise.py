"""An arm near its loaded equilibrium as state equations with named inputs and outputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

from flexarm.arguments import COUNT, ITEMS, PAIRS, takes
from flexarm.arm import Arm
from flexarm.arm.sensor import Sensor
from flexarm.arrays import frozen
from flexarm.errors import InvalidParameter
from flexarm.linear.linear_model import LinearModel
from flexarm.linear.operating_point import OperatingPoint
from flexarm.linear.ports import Asked, Port, channel_names, ports
from flexarm.linear.ports import outputs as readable
from flexarm.linear.response import Response


@takes(inputs=PAIRS, outputs=ITEMS, modes=COUNT)
def linearise(
    arm: Arm,
    joints: Mapping[str, float] | None = None,
    *,
    inputs: Asked | None = None,
    outputs: Iterable[str | Sensor] | None = None,
    modes: int | None = None,
) -> LinearModel:
    """Linearise small motions about the equilibrium under gravity: x' = A x + B u, y = C x + D u.

    Parameters
    ----------
    arm : Arm
        The model, with its effects. Friction has no part, as in `flexarm.modes`.
    joints : dict of str to float, optional
        Drive angles of the equilibrium, output side [rad, m for a prismatic joint]; default 0.
    inputs : dict or pairs of str to str, optional
        At a joint "angle" (of the motor over the ratio), "acceleration" (of that angle, which then is a state
        like its rate), "torque" (of the motor times the ratio), "free" or "locked"; at a point "force" (three
        inputs, base axes). Joints left out are locked, but for those of closed loops that follow. Default:
        every motor's angle, or its acceleration where an output follows the angle's derivatives at once, as
        torques, rates and accelerations do.
    outputs : iterable of str or Sensor, optional
        Sensors, or names of the model's sensors, of points (their position) and of joints (the link's angle).
        Default: the model's sensors, without noise, delay or errors; without sensors all joints and points.
    modes : int, optional
        Keep only so many of the lowest modes; the others give what they would give to a constant input.

    Raises
    ------
    InvalidParameter
        If a name or kind does not exist, an output does not follow an input properly, or nothing moves.
    NotConverged
        If there is no stable equilibrium with the drives held.

    Examples
    --------
    >>> model = flexarm.linearise(arm, {"hinge": 0.5}, inputs={"hinge": "torque"})  # doctest: +SKIP
    >>> model.save("arm.mat")  # doctest: +SKIP
    """
    if modes is not None and modes < 0:
        raise InvalidParameter(f"must not be negative, got {modes}", where="modes")
    asked, locked = ports(arm, inputs, joints or {})
    sensors = readable(arm, outputs)
    if not sensors:
        raise InvalidParameter("are none: the model has neither sensors, points nor moving joints")
    point = OperatingPoint.of(arm, joints or {}, asked, locked, sensors)
    response, names, units = point.response(modes)
    chosen = _by_acceleration(response, asked, arm, sensors)
    response = response.by_acceleration(chosen)
    told = [
        replace(port, kind="acceleration" if k in chosen else "angle") if port.kind == "drive" else port
        for k, port in enumerate(asked)
    ]
    A, B, C, D = response.proper()
    drives = [told[k] for k in chosen]
    output_names, output_units = channel_names(arm, sensors)
    return LinearModel(
        arm=arm,
        A=frozen(A),
        B=frozen(B),
        C=frozen(C),
        D=frozen(D),
        input_names=tuple(port.named() for port in told),
        input_units=tuple(port.unit() for port in told),
        output_names=tuple(output_names),
        output_units=tuple(output_units),
        state_names=names + tuple(f"{port.place}.{what}" for what in ("angle", "rate") for port in drives),
        state_units=units
        + tuple(("m" if port.slides else "rad") + per for per in ("", "/s") for port in drives),
        input_at_rest=frozen(point.at_rest(told)),
        output_at_rest=point.readings.at_rest,
        joint_values=frozen(point.values),
    )


def _by_acceleration(response: Response, asked: list[Port], arm: Arm, sensors: list[Sensor]) -> list[int]:
    """Return inputs whose acceleration drives: those that ask for it, and angles without proper response.

    Raise InvalidParameter if an output follows the derivatives of an input that must not become its
    acceleration.
    """
    improper = response.improper()
    names, _ = channel_names(arm, sensors)
    chosen = []
    for k, port in enumerate(asked):
        wrong = [name for name, bad in zip(names, improper[:, k], strict=True) if bad]
        if port.kind == "acceleration" or (port.kind == "drive" and wrong):
            chosen.append(k)
        elif wrong:
            advice = (
                f'take "acceleration" as the input of {port.place!r}'
                if port.kind == "angle"
                else "give the rotor of the joint an inertia"
            )
            raise InvalidParameter(
                f"{', '.join(wrong)} would follow the rate of {port.named()}, which no state equations have; "
                f"{advice}, or leave those outputs out",
                where="outputs",
            )
    return chosen
