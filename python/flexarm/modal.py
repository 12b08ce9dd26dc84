"""Natural modes of an arm about its loaded equilibrium."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm import _core
from flexarm.arguments import FLAG, takes
from flexarm.arm import Arm
from flexarm.arm.joint_units import units_by_joint
from flexarm.arm.parameter import Parameter, parameters
from flexarm.arrays import Floats, frozen
from flexarm.assembly import assemble, following_joints, joint_values
from flexarm.errors import InvalidParameter
from flexarm.netcdf import Contents, Variable
from flexarm.pictures import drawn, viewed
from flexarm.reading import reading, require
from flexarm.result import Result, counts, load, model_of, provenance
from flexarm.sensitivity import Sensitivities, collected, varied
from flexarm.statics.backlash_derivative import require_backlash_derivative

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from flexarm.viewer import View


@dataclass(frozen=True, eq=False, repr=False)
class Modes(Result):
    """Modes, lowest first.

    Attributes
    ----------
    arm : Arm
        The model.
    frequency_hz, damped_frequency_hz : ndarray, shape (mode,)
        Without and with damping [Hz].
    damping_ratio : ndarray, shape (mode,)
        Share of critical damping [-].
    shape : ndarray, shape (mode, point, 6)
        Translation and rotation of the points, base axes, unit modal mass [m, rad per sqrt(kg) m].
    solver : dict
        Backend and iterations; of closed loops the joints that were `driven`.
    drive_angle : ndarray, shape (joint,), or None
        Where the drives are held, and joints of loops that follow stand [rad, m]; None in files of flexarm
        0.1.0.
    with_gravity : bool
        Gravity deforms the arm.
    sensitivities : Sensitivities or None
        Derivatives of `frequency`, (mode, parameter) [Hz per unit], where they were asked for.
    """

    arm: Arm
    frequency_hz: Floats
    damped_frequency_hz: Floats
    damping_ratio: Floats
    shape: Floats
    solver: dict[str, Any]
    drive_angle: Floats | None = None
    with_gravity: bool = True
    sensitivities: Sensitivities | None = None

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `flexarm modes --json`."""
        return {
            "frequency_hz": self.frequency_hz.tolist(),
            "damping_ratio": self.damping_ratio.tolist(),
            "damped_frequency_hz": self.damped_frequency_hz.tolist(),
            "solver": self.solver,
        }

    def contents(self) -> Contents:
        """Return the contents of the file: frequencies, damping, shapes, and their provenance."""
        number = np.arange(1, len(self.frequency_hz) + 1)
        units = units_by_joint(self.arm, self.joints, "rad")
        held: dict[str, Variable] = (
            {}
            if self.drive_angle is None
            else {"drive_angle": (("joint",), self.drive_angle, {"units": units})}
        )
        contents = Contents(
            {
                **held,
                "frequency": (("mode",), self.frequency_hz, {"units": "Hz"}),
                "damped_frequency": (("mode",), self.damped_frequency_hz, {"units": "Hz"}),
                "damping_ratio": (("mode",), self.damping_ratio, {"units": "1"}),
                "shape": (
                    ("mode", "point", "component"),
                    self.shape,
                    {"units": "m, rad", "scale": "unit modal mass"},
                ),
            },
            {"point": self.points, "joint": self.joints, "component": ["x", "y", "z", "rx", "ry", "rz"]},
            {"kind": "modes", **provenance(self.arm), **self.solver, "with_gravity": int(self.with_gravity)},
            {"mode": (("mode",), number, {})},
        )
        return contents if self.sensitivities is None else self.sensitivities.add_to(contents)

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> Modes:
        """Read what `save` wrote.

        Raises
        ------
        InvalidFile
            If the file does not hold modes.
        """
        data = load(path, "modes")
        arm = model_of(data, path)
        per_mode = {name: ("mode",) for name in ("frequency", "damped_frequency", "damping_ratio")}
        require(path, data, {**per_mode, "shape": ("mode", "point", "component")}, counts(arm))
        with reading(path, "stored modes"):
            return cls(
                arm=arm,
                frequency_hz=data["frequency"].values,
                damped_frequency_hz=data["damped_frequency"].values,
                damping_ratio=data["damping_ratio"].values,
                shape=data["shape"].values,
                solver={k: data.attrs[k] for k in ("backend", "iterations", "driven") if k in data.attrs},
                drive_angle=frozen(data["drive_angle"].values) if "drive_angle" in data else None,
                with_gravity=bool(data.attrs.get("with_gravity", True)),
                sensitivities=Sensitivities.stored(arm, data),
            )

    def plot(self, ax: Axes | None = None, mode: int | None = None) -> Axes:
        """Draw mode shapes over the equilibrium, with frequency, damping, and what moves.

        Parameters
        ----------
        ax : matplotlib Axes, optional
            Where to draw one shape; default: a figure with all of them, whose first axes are returned.
        mode : int, optional
            Which one, from 1; default: the first.
        """
        return drawn(self, ax=ax, mode=mode)

    def view(self, urdf: str | Path | None = None) -> View:
        """Show the moving mode shapes in three dimensions, slowed.

        Parameters
        ----------
        urdf : str or Path, optional
            The URDF file whose meshes rigid links are drawn with.

        Returns
        -------
        View
            One page without network; see `Arm.view`.
        """
        return viewed(self, urdf=urdf)

    def summary(self) -> str:
        """Return the result in lines that a person reads."""
        if not len(self.frequency_hz):
            return (
                f"modes of {self.arm.name}: none, as nothing with mass can vibrate: links are rigid and "
                "drives are held. Beams, super-elements and a joint_compliance can give way"
            )
        lines = [f"modes of {self.arm.name}", f"{'mode':>4}{'frequency [Hz]':>18}{'damping ratio [-]':>20}"]
        for i, (f, zeta) in enumerate(zip(self.frequency_hz, self.damping_ratio, strict=True), 1):
            lines.append(f"{i:4d}{f:18.6f}{zeta:20.6f}")
        return "\n".join(lines)

    def __repr__(self) -> str:
        found = ", ".join(f"{f:.4g}" for f in self.frequency_hz[:4])
        more = ", ..." if len(self.frequency_hz) > 4 else ""
        return f"<Modes of {self.arm.name!r}: {found}{more} Hz>"


@takes(gravity=FLAG)
def modes(
    arm: Arm,
    joints: Mapping[str, float] | None = None,
    count: int = 6,
    gravity: bool = True,
    *,
    sensitivities: Iterable[str] = (),
) -> Modes:
    """Compute the modes about the equilibrium with the joints' drives held.

    Parameters
    ----------
    arm : Arm
        The model, with its effects.
    joints : dict of str to float, optional
        Drive angles, output side [rad, m for a prismatic joint]; default 0.
    count : int
        How many; fewer come where the model has fewer.
    gravity : bool
        With gravity, which deforms the arm and changes its stiffness.
    sensitivities : iterable of str
        Keys of parameters by which the undamped frequencies are differentiated, as in `simulate`:
        `sensitivities["frequency"]`, Hz over the parameter's unit. Modes of one frequency count together:
        their derivatives rise.

    Raises
    ------
    InvalidParameter
        If a joint does not exist or count is below 1.
    NotConverged
        If there is no stable equilibrium.
    """
    if count < 1:
        raise InvalidParameter(f"must be at least 1, got {count}", where="count")
    system = assemble(arm, driven=tuple(joints or ()))
    g = np.array(arm.gravity) if gravity else np.zeros(3)
    values, loads = joint_values(arm, joints or {}), _core.Loads(gravity=g)

    def at_rest(of: _core.System) -> _core.Equilibrium:
        return _core.static_equilibrium(of, values, loads)

    equilibrium = at_rest(system)
    follow, at = following_joints(arm, (), joints or {}), _core.joint_angles(system, equilibrium.state)
    angles = [at[i] if joint.name in follow else values[i] for i, joint in enumerate(arm.joints)]
    found = _core.modes(system, equilibrium, count)
    shape = np.array(found.shapes).T.reshape(len(found.frequency_hz), len(arm.points), 6)
    return Modes(
        arm=arm,
        frequency_hz=frozen(found.frequency_hz),
        damped_frequency_hz=frozen(found.damped_frequency_hz),
        damping_ratio=frozen(found.damping_ratio),
        shape=frozen(shape),
        solver={
            "backend": _core.build_info().solver,
            "iterations": found.iterations,
            **({"driven": " ".join(joints or ())} if arm.closures else {}),
        },
        drive_angle=frozen(angles),
        with_gravity=gravity,
        sensitivities=_derivatives(
            arm, parameters(arm, sensitivities), tuple(joints or ()), system, equilibrium, count, at_rest
        ),
    )


def _derivatives(
    arm: Arm,
    wanted: tuple[Parameter, ...],
    driven: tuple[str, ...],
    system: _core.System,
    equilibrium: _core.Equilibrium,
    count: int,
    at_rest: Callable[[_core.System], _core.Equilibrium],
) -> Sensitivities | None:
    if not wanted:
        return None
    beside, places = varied(arm, wanted, lambda other: assemble(other, driven=driven), driven=driven)
    named = [wanted[place] for place in places]
    if any(parameter.one_sided for parameter in named):
        moving = _core.static_derivative(system, equilibrium, beside)
        require_backlash_derivative(arm, named, beside, system, equilibrium, moving, at_rest, stiff=True)
    slopes = np.asarray(_core.frequency_derivatives(system, equilibrium, count, beside))
    return collected(wanted, places, {"frequency": slopes})
