"""Result of a run: the motion of an arm, its torques, forces and energies."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from flexarm.arguments import NUMBERS, takes
from flexarm.arm import Arm
from flexarm.arm.consistency import missing
from flexarm.arm.joint_units import units_by_joint
from flexarm.arrays import Floats
from flexarm.errors import InvalidParameter
from flexarm.measurement.sampling import sample
from flexarm.pictures import viewed
from flexarm.result import Result
from flexarm.sensitivity import Sensitivities
from flexarm.simulation.energies import Energies

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.netcdf import Contents
    from flexarm.record import Record
    from flexarm.viewer import View


@dataclass(frozen=True, eq=False, repr=False)
class Simulation(Result):
    """A run. Arrays are read-only; the first axis is the instant.

    Attributes
    ----------
    arm : Arm
        The model.
    time : ndarray, shape (n,)
        Instants [s].
    position, velocity : ndarray, shape (n, point, 3)
        Of the points, base axes [m], [m/s].
    joint_angle, joint_rate : ndarray, shape (n, joint)
        Angle theta of each link about its joint [rad, m if prismatic] and its rate.
    drive_angle, drive_rate : ndarray, shape (n, joint)
        Angle phi of each motor over the ratio, and its rate.
    joint_torque, motor_torque : ndarray, shape (n, joint)
        Torque on the child about +axis, and of the motor with rotor inertia and friction; output side [N m].
    kinetic, elastic, gravity, damped, work : ndarray, shape (n,)
        Energies, and what damping took and drives gave since the start [J]. Without `energies=True` the first
        look at one of them makes the run a second time.
    orientation, angular_rate : ndarray, shape (n, point, 4) and (n, point, 3), or None
        Quaternion x, y, z, w and rate in body axes [rad/s]; with `rotations=True`.
    section_forces : ndarray, shape (n, link, 2, 6), or None
        (N, Vy, Vz, T, My, Mz) at both ends of each link, section axes [N, N m]; with `forces=True`.
    base_wrench : ndarray, shape (n, 6), or None
        Force and moment on the base about its origin, base axes [N, N m]; with `forces=True`.
    joint_command, motor_voltage : ndarray, shape (n, joint), or None
        What controllers, and drives that lag, were asked for [rad] and the voltages controllers set [V], NaN
        where there is none; of runs along a command, and `joint_command` also of runs with a `drive_lag`.
    sensitivities : Sensitivities or None
        Derivatives of the arrays by parameters of the model; of runs with `sensitivities=`.
    solver : dict
        Backend, step, alpha, dimension (2 where the motion lies in a plane), counts of steps, iterations and
        factorisations, seconds.
    """

    arm: Arm
    time: Floats
    position: Floats
    velocity: Floats
    joint_angle: Floats
    joint_rate: Floats
    drive_angle: Floats
    drive_rate: Floats
    joint_torque: Floats
    motor_torque: Floats
    energy_record: Energies | Callable[[], Energies]
    orientation: Floats | None = None
    angular_rate: Floats | None = None
    section_forces: Floats | None = None
    base_wrench: Floats | None = None
    joint_command: Floats | None = None
    motor_voltage: Floats | None = None
    sensitivities: Sensitivities | None = None
    solver: dict[str, Any] = field(default_factory=dict)

    @cached_property
    def energies(self) -> Energies:
        """All energies of the run."""
        return self.energy_record() if callable(self.energy_record) else self.energy_record

    def __getstate__(self) -> dict[str, Any]:
        """Return what pickles and copies keep: energies as numbers, computed now where they were not."""
        return {**self.__dict__, "energy_record": self.energies}

    @property
    def kinetic(self) -> Floats:
        """Kinetic energy [J], shape (n,)."""
        return self.energies.kinetic

    @property
    def elastic(self) -> Floats:
        """Elastic energy of links and joints [J], shape (n,)."""
        return self.energies.elastic

    @property
    def gravity(self) -> Floats:
        """Potential energy of gravity [J], shape (n,)."""
        return self.energies.gravity

    @property
    def damped(self) -> Floats:
        """Energy that damping and friction took since the start [J], shape (n,)."""
        return self.energies.damped

    @property
    def work(self) -> Floats:
        """Work of drives and loads since the start [J], shape (n,)."""
        return self.energies.work

    @property
    def acceleration(self) -> Floats | None:
        """Specific force at the points in body axes [m/s2], (n, point, 3), as an IMU has it: +g up at rest.

        From the derivative of a cubic spline through the velocities; None without `rotations=True`.
        """
        if self.orientation is None:
            return None
        from scipy.interpolate import CubicSpline
        from scipy.spatial.transform import Rotation

        rate = CubicSpline(self.time, self.velocity)(self.time, 1)
        specific = rate - np.asarray(self.arm.gravity)
        turn = Rotation.from_quat(self.orientation.reshape(-1, 4))
        return np.asarray(turn.inv().apply(specific.reshape(-1, 3))).reshape(specific.shape)

    @takes(times=NUMBERS)
    def at(self, times: ArrayLike, point: str) -> Floats:
        """Return positions of a point [m] at any times [s], shape (m, 3), by cubic Hermite interpolation.

        Before the run the arm rests where it starts; after its end nothing is known, and NaN stands there.

        Raises
        ------
        InvalidParameter
            If there is no such point.
        """
        if point not in self.points:
            raise InvalidParameter(f"there is no point {point!r}; there are {', '.join(self.points)}")
        i = self.points.index(point)
        when = np.atleast_1d(np.asarray(times, dtype=float))
        return sample(self.time, self.position[:, i], when, self.velocity[:, i])

    def contents(self) -> Contents:
        """Return the stored content: all arrays with units, and their provenance."""
        from flexarm.simulation.netcdf import contents

        return contents(self)

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> Simulation:
        """Read a run that `save` wrote.

        Raises
        ------
        InvalidFile
            If the file is not a stored run.
        """
        from flexarm.simulation.netcdf import stored

        return cls(**stored(path))

    @takes()
    def plot(self, point: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw the coordinates of a point against time.

        Parameters
        ----------
        point : str, optional
            Its name; default: the one that moves most. Without points joint angles are drawn.
        ax : matplotlib Axes, optional
            Where to draw.

        Raises
        ------
        InvalidParameter
            If there is no such point.
        """
        import matplotlib.pyplot as plt

        if point is not None and point not in self.points:
            raise InvalidParameter(missing("point", str(point), self.points), where="point")
        axes = plt.subplots()[1] if ax is None else ax
        if self.points:
            most = int(np.argmax(np.linalg.norm(np.ptp(self.position, axis=0), axis=1)))
            name = self.points[most] if point is None else point
            i = self.points.index(name)
            for k, axis in enumerate("xyz"):
                axes.plot(self.time, self.position[:, i, k], label=f"{name} {axis}")
            axes.set(xlabel="time [s]", ylabel="position [m]")
        else:
            axes.plot(self.time, self.joint_angle, label=list(self.joints))
            axes.set(
                xlabel="time [s]", ylabel=f"joint angle [{units_by_joint(self.arm, self.joints, 'rad')}]"
            )
        axes.legend()
        return axes

    def view(self, record: Record | None = None, scale: float = 1.0, urdf: str | Path | None = None) -> View:
        """Show the run in three dimensions, at true speed, with a slider.

        Parameters
        ----------
        record : Record, optional
            Its measured points are shown beside the predicted ones, clocks and frames aligned.
        scale : float
            Displacements from the rigid arm at the same drive angles are shown times it.
        urdf : str or Path, optional
            The URDF file whose meshes rigid links are drawn with.

        Returns
        -------
        View
            One page without network; see `Arm.view`.
        """
        return viewed(self, record=record, scale=scale, urdf=urdf)

    def __repr__(self) -> str:
        span = f"{self.time[0]:g} to {self.time[-1]:g} s" if len(self.time) else "no instants"
        return (
            f"<Simulation of {self.arm.name!r}: {span}, {len(self.time)} instants, "
            f"points {', '.join(self.points) or 'none'}>"
        )
