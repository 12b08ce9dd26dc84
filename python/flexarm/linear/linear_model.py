"""State equations with named inputs and outputs, and the files that other programs read."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from flexarm.arguments import NUMBERS, takes
from flexarm.arm import Arm
from flexarm.arrays import Floats, frozen
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.linear import matlab
from flexarm.linear.modal_form import NO_POLE
from flexarm.netcdf import Contents
from flexarm.reading import require
from flexarm.result import Result, load, model_of, provenance
from flexarm.tables.ranges import first_beyond, out_of_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from scipy.signal import StateSpace

Complex = NDArray[np.complex128]

MATRICES = {"A": ("state", "from_state"), "B": ("state", "input"), "C": ("output", "from_state")}
MATRICES |= {"D": ("output", "input")}
AT_REST = {"input_at_rest": "input", "output_at_rest": "output", "joint_values": "joint"}


@dataclass(frozen=True, eq=False, repr=False)
class LinearModel(Result):
    """Small motions about an equilibrium: x' = A x + B u, y = C x + D u. Arrays are read-only.

    u and y are deviations from `input_at_rest` and `output_at_rest`.

    Attributes
    ----------
    arm : Arm
        The model.
    A, B, C, D : ndarray
        Of states, inputs and outputs in the order of their names.
    input_names, input_units, output_names, output_units, state_names, state_units : tuple of str
        "hinge.angle", "hinge.acceleration", "hinge.torque", "tip.force.x"; a sensor's name, with its axis.
    input_at_rest : ndarray, shape (input,)
        Angles and holding torques of the equilibrium; zero for accelerations and forces.
    output_at_rest : ndarray, shape (output,)
        Readings there.
    joint_values : ndarray, shape (joint,)
        Drive angles there [rad, m for a prismatic joint].
    """

    arm: Arm
    A: Floats
    B: Floats
    C: Floats
    D: Floats
    input_names: tuple[str, ...]
    input_units: tuple[str, ...]
    output_names: tuple[str, ...]
    output_units: tuple[str, ...]
    state_names: tuple[str, ...]
    state_units: tuple[str, ...]
    input_at_rest: Floats
    output_at_rest: Floats
    joint_values: Floats

    @property
    def poles(self) -> Complex:
        """Eigenvalues of A, by size [1/s]."""
        values = np.linalg.eigvals(self.A).astype(complex) if len(self.A) else np.zeros(0, complex)
        return np.asarray(values[np.argsort(np.abs(values), kind="stable")])

    @takes(frequency_hz=NUMBERS)
    def frequency_response(self, frequency_hz: ArrayLike) -> Complex:
        """Return C (i omega - A)^-1 B + D: shape (frequency, output, input).

        Raises
        ------
        InvalidParameter
            If a frequency is out of range, or that of an undamped pole, such as 0 with an acceleration as
            input.
        """
        frequencies = np.atleast_1d(np.asarray(frequency_hz, dtype=float))
        if at := first_beyond(frequencies, "Hz"):
            what = out_of_range(float(frequencies[at]), "Hz", size=False)
            raise InvalidParameter(str(what), where="frequency_hz")
        omega = 2 * np.pi * frequencies
        one, B = np.eye(len(self.A)), self.B.astype(complex)
        try:
            found = [self.C @ np.asarray(np.linalg.solve(1j * w * one - self.A, B)) + self.D for w in omega]
        except np.linalg.LinAlgError:
            what = "holds the frequency of an undamped pole, at which no response is finite"
            raise InvalidParameter(what, where="frequency_hz") from None
        return np.array(found, dtype=complex).reshape(
            len(omega), len(self.output_names), len(self.input_names)
        )

    def static_gain(self) -> Floats:
        """Return D - C A^-1 B, the outputs under constant inputs: shape (output, input).

        Raises
        ------
        InvalidParameter
            If a pole is zero, as it is with an acceleration as input.
        """
        if np.any(np.abs(self.poles) < NO_POLE):
            raise InvalidParameter("the model has a pole at zero: under constant inputs it comes to no rest")
        return np.asarray(self.D - self.C @ np.linalg.solve(self.A, self.B))

    def to_scipy(self) -> StateSpace:
        """Return the model as scipy.signal.StateSpace."""
        from scipy.signal import StateSpace

        return StateSpace(self.A, self.B, self.C, self.D)

    def to_control(self) -> Any:
        """Return the model as control.StateSpace of python-control, with the names of its signals.

        Names there hold no dots: "tip.x" becomes "tip_x".

        Raises
        ------
        InvalidParameter
            If python-control is not installed.
        """
        try:
            import control
        except ImportError:
            raise InvalidParameter(
                "to_control needs python-control, which is not installed: pip install flexarm[control]"
            ) from None
        names = {"inputs": self.input_names, "outputs": self.output_names, "states": self.state_names}
        labels = {axis: [name.replace(".", "_") for name in texts] for axis, texts in names.items()}
        return control.ss(self.A, self.B, self.C, self.D, **labels)

    def contents(self) -> Contents:
        """Return what is stored: matrices over named states, inputs and outputs with their units."""
        named = {"state": self.state_names, "input": self.input_names, "output": self.output_names}
        units = {"state": self.state_units, "input": self.input_units, "output": self.output_units}
        return Contents(
            {
                **{name: (axes, getattr(self, name), {}) for name, axes in MATRICES.items()},
                **{f"{axis}_unit": ((axis,), list(texts), {}) for axis, texts in units.items()},
                **{name: ((axis,), getattr(self, name), {}) for name, axis in AT_REST.items()},
            },
            {**named, "from_state": self.state_names, "joint": self.joints},
            {"kind": "linear model", "equations": "x' = A x + B u, y = C x + D u", **provenance(self.arm)},
        )

    @takes()
    def save(self, path: str | Path, inputs: Iterable[Path] = ()) -> None:
        """Write the model: as a MAT file where the name ends in .mat, else as NetCDF.

        Parameters
        ----------
        path, inputs
            As of every result.

        Raises
        ------
        InvalidFile
            If the file cannot be written.
        """
        if Path(path).suffix == ".mat":
            matlab.save(self.contents(), path, [*self.arm.part_files, *inputs])
        else:
            super().save(path, inputs)

    @classmethod
    @takes()
    def load(cls, path: str | Path) -> LinearModel:
        """Read what `save` wrote, by the ending of its name.

        Raises
        ------
        InvalidFile
            If the file holds no linear model.
        """
        data = matlab.load(path) if Path(path).suffix == ".mat" else load(path, "linear model")
        arm = model_of(data, path)
        texts: dict[str, Any] = {}
        sizes = {"joint": len(arm.joints)}
        for axis in ("input", "output", "state"):
            for what, variable in (("name", axis), ("unit", f"{axis}_unit")):
                if variable not in data:
                    raise InvalidFile(path, variable, "is missing; a linear model names states and ports")
                found = tuple(str(text) for text in np.ravel(data[variable].values))
                if len(found) != sizes.setdefault(axis, len(found)):
                    raise InvalidFile(path, variable, f"must hold {sizes[axis]} texts, got {len(found)}")
                texts[f"{axis}_{what}s"] = found
        sizes["from_state"] = sizes["state"]
        axes = {**MATRICES, **{name: (axis,) for name, axis in AT_REST.items()}}
        require(path, data, axes, sizes)
        arrays: dict[str, Any] = {name: frozen(data[name].values) for name in axes}
        return cls(arm=arm, **arrays, **texts)

    def plot(self, ax: Axes | None = None, input: str | None = None, output: str | None = None) -> Axes:
        """Plot magnitude and phase of the frequency response of an input (default: first) to an output.

        Return the axes of the magnitude; those of the phase stand below. Default: all outputs of one unit
        that answer, of the first unit of which one depends on the frequency.
        """
        import matplotlib.pyplot as plt
        from matplotlib.ticker import MaxNLocator
        from mpl_toolkits.axes_grid1 import make_axes_locatable  # type: ignore[import-untyped]

        if not self.input_names:
            raise InvalidParameter("a model without inputs has no frequency response", where="inputs")
        axes = plt.subplots(gridspec_kw={"left": 0.17})[1] if ax is None else ax
        k = 0 if input is None else _position(self.input_names, input, "input")
        own = np.abs(self.poles) / (2 * np.pi)
        own = np.unique(own[own > 1e-6])
        low, high = (own[0], own[min(len(own), 10) - 1]) if len(own) else (0.1, 10.0)
        frequency = np.asarray(np.geomspace(low / 10, 2 * high, 2000))
        response = self.frequency_response(frequency)[:, :, k]
        size, phase = np.abs(response), np.rad2deg(np.unwrap(np.angle(response), axis=0))
        drawn = self._answering(size) if output is None else [_position(self.output_names, output, "output")]
        lower = make_axes_locatable(axes).append_axes("bottom", "50%", pad="10%", sharex=axes)
        unit = self.output_units[drawn[0]]
        for i in drawn:
            axes.loglog(frequency, size[:, i], label=self.output_names[i])
            lower.semilogx(frequency, phase[:, i])
        below = self.input_units[k]
        below = below if below.isalpha() else f"({below})"
        axes.set(ylabel=f"output over {self.input_names[k]}\n[{unit}/{below}]")
        axes.tick_params(labelbottom=False)
        lower.set(xlabel="frequency [Hz]", ylabel="phase [deg]")
        lower.yaxis.set_major_locator(MaxNLocator(5, steps=[1, 1.8, 3.6, 4.5, 9, 10]))  # parts of a turn
        axes.legend()
        return axes

    def _answering(self, response: Floats) -> list[int]:
        """Return outputs of one unit whose responses, shape (frequency, output), are not rounding."""
        rounding = 1e-9  # of the greatest response of the unit
        size, units = response.max(axis=0), np.array(self.output_units)
        found = [i for i, unit in enumerate(units) if size[i] > rounding * size[units == unit].max()]
        varied = [i for i in found if np.ptp(response[:, i]) > 1e-3 * size[i]]
        first = (varied or found or [0])[0]
        return [i for i in found if units[i] == units[first]] or [0]

    def summary(self) -> str:
        """Return the result in lines that a person reads."""
        shown = 8  # poles of a summary
        lines = [f"linear model of {self.arm.name}: {len(self.A)} states"]
        moving = {joint.name for joint in self.arm.moving_joints}
        told = zip(self.joints, self.joint_values, strict=True)
        at_rest = ", ".join(f"{name} = {value:g}" for name, value in told if name in moving)
        lines.append(f"about the equilibrium at {at_rest} [rad, m]" if at_rest else "about the equilibrium")
        for title, names, units, values in (
            ("input", self.input_names, self.input_units, self.input_at_rest),
            ("output", self.output_names, self.output_units, self.output_at_rest),
        ):
            lines.append(f"{title:<24}{'unit':>8}{'at rest':>18}")
            lines += [f"{n:<24}{u:>8}{v:18.8g}" for n, u, v in zip(names, units, values, strict=True)]
        lines.append(f"{'pole [1/s]':<32}{'frequency [Hz]':>18}{'damping ratio [-]':>20}")
        lines += [_told(pole) for pole in self.poles[: 2 * shown] if pole.imag >= 0][:shown]
        return "\n".join(lines)

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `flexarm linearise --json`."""
        ports = {
            "inputs": (self.input_names, self.input_units, self.input_at_rest),
            "outputs": (self.output_names, self.output_units, self.output_at_rest),
        }
        return {
            **{
                title: [{"name": n, "unit": u, "at_rest": float(v)} for n, u, v in zip(*columns, strict=True)]
                for title, columns in ports.items()
            },
            "states": list(self.state_names),
            "poles": [[float(pole.real), float(pole.imag)] for pole in self.poles],
        }

    def __repr__(self) -> str:
        return (
            f"<LinearModel of {self.arm.name!r}: {len(self.A)} states, inputs "
            f"{', '.join(self.input_names)}, outputs {', '.join(self.output_names)}>"
        )


def _position(names: tuple[str, ...], name: str, kind: str) -> int:
    if name not in names:
        raise InvalidParameter(f"there is no {kind} {name!r}; there are {', '.join(names)}")
    return names.index(name)


def _told(pole: complex) -> str:
    size = abs(pole)
    zeta = round(-pole.real / size, 6) + 0.0 if size > 0 else 0.0  # no zero below zero
    return f"{pole.real:14.6g} {pole.imag:+14.6g}i  {size / (2 * np.pi):18.6f}{zeta:20.6f}"
