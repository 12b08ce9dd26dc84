"""An arm near its loaded equilibrium as state equations with named inputs and outputs."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats, frozen
from flexarm.assembly import assemble, joint_values
from flexarm.errors import InvalidParameter
from flexarm.linear.linear_model import LinearModel
from flexarm.linear.modal_form import Mechanics, ModalForm, modal_form
from flexarm.linear.outputs import Derivatives, derivatives
from flexarm.linear.ports import Asked, Port, channel_names, motor_of, outputs, ports
from flexarm.linear.response import Response
from flexarm.linear.tangent import Tangent, tangent

if TYPE_CHECKING:
    from collections.abc import Sequence


def linearise(
    arm: Arm,
    joints: Mapping[str, float] | None = None,
    *,
    inputs: Asked | None = None,
    outputs: Iterable[str | Sensor] | None = None,
    modes: int | None = None,
) -> LinearModel:
    """State equations x' = A x + B u, y = C x + D u of small motions about the equilibrium under gravity.

    Parameters
    ----------
    arm : Arm
        The model, with its effects. Friction has no part, as in `flexarm.modes`.
    joints : dict of str to float, optional
        Drive angles of the equilibrium, output side [rad, m for a prismatic joint]; default 0.
    inputs : dict or pairs of str to str, optional
        At a joint "angle" (of the motor over the ratio), "acceleration" (of that angle, which then is a state
        like its rate), "torque" (of the motor times the ratio), "free" or "locked"; at a point "force" (three
        inputs, base axes). Joints left out are locked. Default: every motor's angle, or its acceleration
        where an output follows the angle's derivatives at once, as torques, rates and accelerations do.
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
    asked, locked = ports(arm, inputs)
    sensors = _sensors(arm, outputs)
    near = _Near.of(arm, joints or {}, asked, locked, sensors)
    response, names, units = near.response(modes)
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
        input_at_rest=frozen(near.at_rest(told)),
        output_at_rest=near.readings.at_rest,
        joint_values=frozen(near.values),
    )


def _sensors(arm: Arm, asked: Iterable[str | Sensor] | None) -> list[Sensor]:
    found = outputs(arm, asked)
    if not found:
        raise InvalidParameter("are none: the model has neither sensors, points nor moving joints")
    return found


@dataclass(frozen=True, eq=False)
class _Near:
    """An arm at its equilibrium, what drives it and what is read."""

    arm: Arm
    asked: list[Port]
    values: list[float]
    holding: Floats
    rows: list[tuple[int, int]]
    driven: list[str]
    tangent: Tangent
    readings: Derivatives
    forces: Floats

    @classmethod
    def of(
        cls,
        arm: Arm,
        joints: Mapping[str, float],
        asked: list[Port],
        locked: set[str],
        sensors: Sequence[Sensor],
    ) -> _Near:
        loaded = [port.place for port in asked if port.kind == "force"]
        held = assemble(arm, loaded=loaded)
        values = joint_values(arm, joints)
        at = _core.static_equilibrium(held, values, _core.Loads(gravity=np.array(arm.gravity)))
        system = assemble(
            arm, {joint.name: _core.DriveKind.torque for joint in arm.moving_joints}, loaded=loaded
        )
        equilibrium = _core.released(held, at, system)
        index = {joint.name: i for i, joint in enumerate(arm.joints)}
        rows = _core.joint_coordinates(system)
        driven = [motor_of(arm, port.place)[0] for port in asked if port.kind in _DRIVES]
        if len(set(driven)) < len(driven):
            raise InvalidParameter("two inputs drive the same motor through gears", where="inputs")
        driven += sorted(locked - set(driven))
        near = tangent(system, equilibrium, [rows[index[name]][1] for name in driven])
        read = derivatives(arm, system, equilibrium.state, near, sensors)
        return cls(
            arm=arm,
            asked=asked,
            values=values,
            holding=np.asarray(_core.motor_torques(held, at.state, False)),
            rows=rows,
            driven=driven,
            tangent=near,
            readings=read,
            forces=_force_columns(arm, system, equilibrium.state, near, asked),
        )

    def response(self, modes: int | None) -> tuple[Response, tuple[str, ...], tuple[str, ...]]:
        """State equations with derivatives of angles, and names and units of the states."""
        t, drives, pushes = self.tangent, self._drives(), self._pushes()
        MCK = (t.K, t.C, t.M)
        F = np.stack([-t.N.T @ X @ t.G @ drives for X in MCK])
        F[0] += pushes[: t.N.shape[1]]
        form = modal_form(Mechanics(t.N.T @ t.M @ t.N, t.N.T @ t.C @ t.N, t.N.T @ t.K @ t.N, F), modes)
        C, D, size = self._outputs(form, drives)
        if not len(form.A) and not drives.any():
            raise InvalidParameter(
                "move nothing: every joint is locked and no link is flexible", where="inputs"
            )
        return Response(form.A, form.B, C, D, size), form.states, form.units

    def at_rest(self, told: list[Port]) -> list[float]:
        """Inputs of the equilibrium."""
        index = {joint.name: i for i, joint in enumerate(self.arm.joints)}
        constant = {"angle": np.array(self.values), "torque": self.holding}
        return [float(constant[p.kind][index[p.place]]) if p.kind in constant else 0.0 for p in told]

    def _drives(self) -> Floats:
        """Angles w of the driven motors by the inputs."""
        found = np.zeros((len(self.driven), len(self.asked)))
        for k, port in enumerate(self.asked):
            if port.kind in _DRIVES:
                name, factor = motor_of(self.arm, port.place)
                found[self.driven.index(name), k] = factor
        return found

    def _pushes(self) -> Floats:
        """Generalised forces along the columns of S by the inputs."""
        index = {joint.name: i for i, joint in enumerate(self.arm.joints)}
        found = self.forces.copy()
        for k, port in enumerate(self.asked):
            if port.kind == "torque":
                found[:, k] += self.tangent.motions[self.rows[index[port.place]][1]]
        return found

    def _torques(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Torques of all joints' motors by S' amplitudes, their two derivatives, and the inputs."""
        t, n = self.tangent, len(self.arm.joints)
        index = {joint.name: i for i, joint in enumerate(self.arm.joints)}
        by = [np.zeros((n, t.motions.shape[1])) for _ in range(3)]
        by_inputs = np.zeros((n, len(self.asked)))
        for k, name in enumerate(self.driven):  # eq. (4) of tangent.py
            for found, X in zip(by, (t.K, t.C, t.M), strict=True):
                found[index[name]] = t.G[:, k] @ X @ t.motions
            by_inputs[index[name]] -= self._pushes()[t.N.shape[1] + k]
        for k, port in enumerate(self.asked):
            if port.kind == "torque":
                by_inputs[index[port.place], k] += 1
        return by[0], by[1], by[2], by_inputs

    def _outputs(self, form: ModalForm, drives: Floats) -> tuple[Floats, Floats, Floats]:
        """C, D of the inputs and their derivatives, and the size of the summands of D."""
        read, z = self.readings, self.tangent.N.shape[1]
        *torques, by_inputs = self._torques()
        direct = (read.position, read.velocity, read.acceleration)
        by = [own + read.torque @ torque for own, torque in zip(direct, torques, strict=True)]
        C, D = np.zeros((len(read.at_rest), len(form.A))), np.zeros((3, len(read.at_rest), len(self.asked)))
        signal, size = form.z, np.zeros_like(D)
        for k, h in enumerate(by):  # positions, velocities, accelerations
            C += h[:, :z] @ signal.X
            D += h[:, :z] @ signal.U
            D[k] += h[:, z:] @ drives
            size += np.abs(h[:, :z]) @ signal.size
            size[k] += np.abs(h[:, z:]) @ np.abs(drives)
            if k < 2:
                signal = signal.rate(form.A, form.B)
        D[0] += by[0][:, :z] @ form.residual + read.torque @ by_inputs
        return C, D, size


_DRIVES = ("drive", "angle", "acceleration")


def _force_columns(
    arm: Arm, system: _core.System, state: _core.State, near: Tangent, asked: list[Port]
) -> Floats:
    """Work of a unit force at a point along every column of S: the point's velocity in base axes."""
    S, still = near.motions, np.zeros(len(near.M))
    found = np.zeros((S.shape[1], len(asked)))
    points = [point.name for point in arm.points]
    for name in {port.place for port in asked if port.kind == "force"}:
        p = points.index(name)
        velocity = [
            _core.point_reading(system, _core.displaced(system, state, still, column, still), p)[1]
            for column in S.T
        ]
        for k, port in enumerate(asked):
            if port.kind == "force" and port.place == name:
                found[:, k] = [v[port.axis] for v in velocity]
    return found


def _by_acceleration(response: Response, asked: list[Port], arm: Arm, sensors: list[Sensor]) -> list[int]:
    """Inputs whose acceleration drives: those that ask for it, and angles that no proper response has.

    Raises
    ------
    InvalidParameter
        If an output follows the derivatives of an input that must not become its acceleration.
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
