"""An arm that is stepped by its user, who decides from step to step what joints are told.

    state = sim.start(joints={"hinge": 0.5})
    state = sim.step(state, {"hinge": torque})

A torque and a force are held over the step. An angle is the one at the end of the step; its rate and
acceleration follow from the angles by the formulas of the time stepping itself, with alpha = -1/3, so that
they neither ring nor drift, or are given with it: {"hinge": (angle, rate, acceleration)}.
"""

from __future__ import annotations

import hashlib
from collections.abc import Collection, Mapping
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike

from flexarm import _core
from flexarm.arguments import NAMES, TEXTS, VECTORS, require, takes
from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arm.drive_effect import DriveEffect
from flexarm.arm.joint import gear_input
from flexarm.arrays import Floats
from flexarm.assembly import assemble, following_joints, joint_values, point_loads
from flexarm.errors import InvalidParameter, NotConverged
from flexarm.former_names import takes_former_names
from flexarm.measurement.state_snapshots import StateSnapshots
from flexarm.stepping.inputs import Input, Inputs
from flexarm.stepping.state import JointReading, PointReading, State
from flexarm.tables import toml_text


@takes_former_names({"told": "inputs"})
class Stepper:
    """Steps an arm for a controller of the user's own.

    Parameters
    ----------
    arm : Arm
        The model, with its effects.
    inputs : dict of str to {"motor", "output", "torque", "free"}
        The input of each joint: the motor's angle over the ratio, the link's own angle, the motor's torque
        times the ratio, or nothing. Joints left out stay where they start; those that a gear couples to a
        driven one follow it, and so do joints of closed loops.
    forces : collection of str
        Points that forces will act on; on a beam they get a node of their own.
    step : float
        Time step [s], at least 1e-9.
    alpha : float
        Of the HHT method, -1/3 to 0; 0 damps nothing, negative values damp high frequencies.

    Raises
    ------
    InvalidParameter
        If a joint or point does not exist, or step or alpha is out of range.

    Examples
    --------
    >>> sim = flexarm.Stepper(arm, {"hinge": "torque"}, step=1e-3)  # doctest: +SKIP
    >>> state = sim.start(joints={"hinge": 0.5})  # doctest: +SKIP
    >>> state = sim.step(state, {"hinge": sim.joint(state, "hinge").motor_torque})  # doctest: +SKIP
    """

    @takes(inputs=TEXTS, forces=NAMES)
    def __init__(
        self,
        arm: Arm,
        inputs: Mapping[str, str],
        *,
        forces: Collection[str] = (),
        step: float = 2e-3,
        alpha: float = -0.05,
    ) -> None:
        moved = {*inputs, *(gear_input(arm, name) for name, what in inputs.items() if what == "motor")}
        if late := [e for e in arm.effects if isinstance(e, DriveEffect) and e.at in moved and any(e.lag())]:
            raise InvalidParameter(
                f"{late[0].name} at {late[0].at!r}: the joints of a stepper follow their inputs at once; "
                "leave the effect out and give inputs that lag",
                where="arm",
            )
        self._arm = arm
        self._inputs = Inputs(arm, inputs)
        self._joints = {joint.name: i for i, joint in enumerate(arm.joints)}
        self._points = {point.name: i for i, point in enumerate(arm.points)}
        self._sensors = {sensor.name: sensor for sensor in arm.sensors}
        point_loads(arm, {name: np.zeros(3) for name in forces})
        self._forces = tuple(forces)
        self._system = assemble(arm, self._inputs.kinds(), loaded=self._forces)
        self._following = following_joints(arm, self._inputs.kinds(), ())
        self._core = _core.Stepping(self._system, float(step), float(alpha))
        self._readings = _core.Readings(self._system)
        self._key = self._hash()
        self._step = float(step)

    @property
    def arm(self) -> Arm:
        """The model."""
        return self._arm

    @property
    def time_step(self) -> float:
        """Time step [s]."""
        return self._step

    @takes()
    def start(
        self, joints: Mapping[str, float] | None = None, forces: Mapping[str, ArrayLike] | None = None
    ) -> State:
        """Return the equilibrium at rest, all joints held; those told a torque or nothing are then let go.

        The torque that held a joint is `joint(state, name).motor_torque`.

        Parameters
        ----------
        joints : dict of str to float, optional
            Where drives stand, output side [rad, m if prismatic]; default 0. Where a joint
            is told "output", its link.
        forces : dict of str to (3,), optional
            Forces in that equilibrium, base axes [N].

        Raises
        ------
        InvalidParameter
            If a joint or point does not exist.
        NotConverged
            If there is no stable equilibrium.
        """
        if led := [name for name in joints or {} if name in self._following]:
            raise InvalidParameter(
                f"follows in its loop, with {', '.join(self._following)}; tell this joint something, or "
                "leave it out",
                where=f"joints.{led[0]}",
            )
        system = assemble(self._arm, self._inputs.kinds(held=True), loaded=self._forces)
        points = self._loads({} if forces is None else forces)
        loads = _core.Loads(gravity=np.array(self._arm.gravity), points=points)
        equilibrium = _core.static_equilibrium(system, joint_values(self._arm, joints or {}), loads)
        return State(self._key, self._core.start(_core.released(system, equilibrium, self._system)))

    def step(
        self, state: State, inputs: Mapping[str, Input], forces: Mapping[str, ArrayLike] | None = None
    ) -> State:
        """Return the state one step later; the one given stays as it is.

        Parameters
        ----------
        state : State
            Where to start.
        inputs : dict of str to float
            For each joint that is told something: the torque over the step, output side [N m, N if
            prismatic], or the angle at its end [rad, m], or (angle, rate, acceleration) there.
        forces : dict of str to (3,), optional
            Forces over the step at points that may have some, base axes [N]; default none.

        Raises
        ------
        InvalidParameter
            If an input is missing, unknown or not finite, or the state belongs to another arm.
        NotConverged
            With time, iteration and residual; the message has the inputs.
        """
        points = self._loads(forces) if forces is not None else []
        moment, rows = self._moment(state), self._inputs.rows(inputs)
        try:
            return State(self._key, self._core.advance(moment, rows, points))
        except NotConverged as error:
            raise NotConverged(
                f"{error}; the inputs were {self._inputs.words(inputs)}",
                time=error.time,
                iteration=error.iteration,
                residual=error.residual,
            ) from error

    def joint(self, state: State, name: str) -> JointReading:
        """Return angles, rates and torques of a joint.

        Raises
        ------
        InvalidParameter
            If there is no such joint.
        """
        at = _index(self._joints, name, "joint")
        return JointReading(*self._readings.joint(self._moment(state).state, at))

    def point(self, state: State, name: str) -> PointReading:
        """Position, velocity, acceleration, rotation and angular rate of a point.

        Raises
        ------
        InvalidParameter
            If there is no such point.
        """
        at = _index(self._points, name, "point")
        x, v, R, omega, a = self._readings.point(self._moment(state).state, at)
        return PointReading(x, v, a, R, omega)

    def sensor(self, state: State, name: str) -> Floats:
        """Return the reading of a sensor without noise, rounding or delay: one number a channel, SI.

        Raises
        ------
        InvalidParameter
            If there is no such sensor, or it measures what no state holds, such as a voltage.
        """
        if name not in self._sensors:
            raise InvalidParameter(missing("sensor", name, self._sensors))
        instant = StateSnapshots.of(self._arm, self._system, [self._moment(state).state])
        values: Floats = instant.readings(self._sensors[name])[0]
        return values

    def _loads(self, forces: Mapping[str, ArrayLike]) -> list[_core.PointLoad]:
        require(VECTORS, "forces", forces)
        for name in forces:
            if name in self._points and name not in self._forces:
                raise InvalidParameter(
                    f"no force may act on {name!r}; name it in `forces` of the Stepper, "
                    f"which has {', '.join(self._forces) or 'none'}",
                    where="forces",
                )
        return point_loads(self._arm, forces)

    def _moment(self, state: State) -> _core.Moment:
        if not isinstance(state, State):
            raise InvalidParameter(f"must be a State, got {type(state).__name__}", where="state")
        if state.key != self._key:
            raise InvalidParameter(
                "belongs to another arm, or to one whose joints are told something else; "
                f"its key is {state.key[:12]}, needed is {self._key[:12]}",
                where="state",
            )
        return state.moment(self._system)

    def _hash(self) -> str:
        """Return the hash of the model, its parts, the inputs and the loaded points."""
        found = hashlib.sha256(toml_text(self._arm.to_dict()).encode())
        for link in self._arm.links:
            if link.type == "superelement" and Path(link.file).is_file():
                found.update(Path(link.file).read_bytes())
        found.update(repr((sorted(self._inputs.told.items()), sorted(self._forces))).encode())
        return found.hexdigest()

    def __repr__(self) -> str:
        told = ", ".join(f"{name}: {what}" for name, what in self._inputs.told.items())
        return f"<Stepper of {self._arm.name!r}: {told or 'nothing is told'}, step {self._step:g} s>"


def _index(places: Mapping[str, int], name: str, kind: str) -> int:
    if not isinstance(name, str) or name not in places:
        raise InvalidParameter(missing(kind, name, places))
    return places[name]
