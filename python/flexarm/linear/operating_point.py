"""An arm at its equilibrium: its inputs, its motion and its readings."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from flexarm import _core
from flexarm.arm import Arm
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats
from flexarm.assembly import assemble, following_joints, joint_values
from flexarm.errors import InvalidParameter
from flexarm.linear.modal_form import Mechanics, ModalForm, modal_form
from flexarm.linear.outputs import Derivatives, derivatives
from flexarm.linear.ports import Port, motor_of
from flexarm.linear.response import Response
from flexarm.linear.tangent import Tangent, tangent


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """An arm at its equilibrium, with its inputs and readings."""

    arm: Arm
    asked: list[Port]
    values: list[float]
    """Drive angles of all joints; of those of loops that follow, the angles of their links."""
    holding: Floats
    """Torques that hold them, shape (joint,)."""
    rows: list[tuple[int, int]]
    """Rows of theta and phi of every joint among the coordinates."""
    driven: list[str]
    """Joints whose motors are held, in the order of the columns of G; those of inputs come first."""
    tangent: Tangent
    readings: Derivatives
    forces: Floats
    """Generalised forces of unit forces at points, shape (columns of N and G, inputs)."""

    @classmethod
    def of(
        cls,
        arm: Arm,
        joints: Mapping[str, float],
        asked: list[Port],
        locked: set[str],
        sensors: Sequence[Sensor],
    ) -> OperatingPoint:
        """Return the arm at rest under its weight, drives held; `locked` joints are held and no input."""
        loaded = [port.place for port in asked if port.kind == "force"]
        stand = {*joints, *locked, *(port.place for port in asked if port.kind != "force")}
        held = assemble(arm, loaded=loaded, driven=stand)
        values = joint_values(arm, joints)
        at = _core.static_equilibrium(held, values, _core.Loads(gravity=np.array(arm.gravity)))
        follow, found = following_joints(arm, (), stand), _core.joint_angles(held, at.state)
        values = [found[i] if joint.name in follow else values[i] for i, joint in enumerate(arm.joints)]
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
        motion = tangent(system, equilibrium, [rows[index[name]][1] for name in driven])
        read = derivatives(arm, system, equilibrium.state, motion, sensors)
        return cls(
            arm=arm,
            asked=asked,
            values=values,
            holding=np.asarray(_core.motor_torques(held, at.state, False)),
            rows=rows,
            driven=driven,
            tangent=motion,
            readings=read,
            forces=_force_columns(arm, system, equilibrium.state, motion, asked),
        )

    def response(self, modes: int | None) -> tuple[Response, tuple[str, ...], tuple[str, ...]]:
        """Return state equations with derivatives of angles, and names and units of the states."""
        t, drives, pushes = self.tangent, self._drives(), self._pushes()
        F = np.stack([-t.N.T @ X @ t.G @ drives for X in (t.K, t.C, t.M)])
        F[0] += pushes[: t.N.shape[1]]
        M, C, K = (t.N.T @ X @ t.N for X in (t.M, t.C, t.K))
        form = modal_form(Mechanics(M, C, K, F), modes)
        C, D, size = self._outputs(form, drives)
        if not len(form.A) and not drives.any() and not form.residual.any():
            raise InvalidParameter(
                "move nothing: every joint is locked and no link is flexible", where="inputs"
            )
        return Response(form.A, form.B, C, D, size), form.states, form.units

    def at_rest(self, told: list[Port]) -> list[float]:
        """Return the inputs of the equilibrium."""
        motors = [motor_of(self.arm, joint.name) for joint in self.arm.joints]
        torques = [factor * self.holding[self._index[name]] for name, factor in motors]
        constant = {"angle": np.array(self.values), "torque": np.array(torques)}
        return [float(constant[p.kind][self._index[p.place]]) if p.kind in constant else 0.0 for p in told]

    @cached_property
    def _index(self) -> dict[str, int]:
        return {joint.name: i for i, joint in enumerate(self.arm.joints)}

    def _drives(self) -> Floats:
        """Return the angles w of the driven motors by the inputs."""
        found = np.zeros((len(self.driven), len(self.asked)))
        for k, port in enumerate(self.asked):
            if port.kind in _DRIVES:
                name, factor = motor_of(self.arm, port.place)
                found[self.driven.index(name), k] = factor
        return found

    def _pushes(self) -> Floats:
        """Return the generalised forces along the columns of S by the inputs."""
        found = self.forces.copy()
        for k, port in enumerate(self.asked):
            if port.kind == "torque":
                found[:, k] += self.tangent.motions[self.rows[self._index[port.place]][1]]
        return found

    def _torques(self) -> tuple[Floats, Floats, Floats, Floats]:
        """Return torques of all joints' motors by S' amplitudes, their two derivatives, and the inputs."""
        t, n = self.tangent, len(self.arm.joints)
        index = self._index
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
        """Return C, D of the inputs and their derivatives, and the size of the summands of D."""
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
    arm: Arm, system: _core.System, state: _core.State, motion: Tangent, asked: list[Port]
) -> Floats:
    """Return the work of a unit force at a point along every column of S: the point's velocity."""
    S, still = motion.motions, np.zeros(len(motion.M))
    found = np.zeros((S.shape[1], len(asked)))
    points, readings = [point.name for point in arm.points], _core.Readings(system)
    for name in {port.place for port in asked if port.kind == "force"}:
        p = points.index(name)
        velocity = [
            readings.point(_core.displaced(system, state, still, column, still), p)[1] for column in S.T
        ]
        for k, port in enumerate(asked):
            if port.kind == "force" and port.place == name:
                found[:, k] = [v[port.axis] for v in velocity]
    return found
