r"""Measured frequency responses beside those of the linear model about the loaded equilibrium.

.. math:: g = H_{measured} - H_{model},   H_{model} = C (i \omega - A)^{-1} B + D                    (1)

with joints where the record has them and their drives held, but where the input is a motor's torque. Of an
angle as input the model takes the motor's acceleration, and the response is the ratio of those of output and
angle, on its side of the gear. Sensors of the output (o) and of the input (i) have the effects of the model,

.. math:: H \to H \, \frac{s_o}{s_i} e^{-i \omega (\tau_o - \tau_i)}                                       (2)

with s the slope of a sensor's reading at rest, and tau how late its clock is. Noise is 1 sigma of real and
imaginary part, so that |g| over sqrt(2) noise counts.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arguments import takes
from flexarm.arm.joint import motor_ratio
from flexarm.arm.sensor import Sensor
from flexarm.arrays import Floats
from flexarm.comparison.alignment_parameters import SEEN_IN_FRAMES, stated_placement
from flexarm.comparison.bands import Band
from flexarm.comparison.files import SavedGap
from flexarm.comparison.free_vibration import MODES
from flexarm.errors import InvalidParameter
from flexarm.linear.linearise import linearise
from flexarm.measurement.effects_of import effects_of
from flexarm.measurement.sampling import columns
from flexarm.modal import modes
from flexarm.quantities import channel_names
from flexarm.record.compatibility import unplaced_effects

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axes import Axes

    from flexarm.arm import Arm
    from flexarm.record import Record, Signal

Complex = NDArray[np.complex128]
PORTS = {"force": "force", "motor_torque": "torque", "joint_angle": "acceleration"}
"""Kind of input of the linear model, by quantity of the record's input."""


@dataclass(frozen=True, eq=False)
class ResponseGap:
    """The gap (1) of one signal."""

    name: str
    input: str
    unit: str
    """Of the signal, the signal it is a response to, output per input in SI."""
    channels: tuple[str, ...]
    """Axes; "total" of a scalar."""
    frequency_hz: Floats
    """Of the rows with values, shape (n,)."""
    measured: Complex
    model: Complex
    """H of (1), shape (n, channels)."""
    noise: Floats
    """1 sigma of real and imaginary part; NaN where nothing is stated, shape (n, channels)."""
    bands: tuple[Band, ...] = ()
    """The part of the gap below, about and above the first mode."""

    @property
    def rms(self) -> dict[str, float]:
        """Return the rms of |g| by channel, and in total."""
        squares = np.mean(np.abs(self.measured - self.model) ** 2, axis=0)
        return {**self._by_channel(np.sqrt(squares)), "total": float(np.sqrt(squares.sum()))}

    @property
    def max(self) -> dict[str, float]:
        """Return the greatest |g| by channel, and in total."""
        size = np.abs(self.measured - self.model)
        return {**self._by_channel(size.max(axis=0)), "total": float(np.linalg.norm(size, axis=1).max())}

    @property
    def noise_rms(self) -> float | None:
        """Return the rms that noise alone would leave, in total; None if nothing is stated."""
        found = float(np.sqrt(2 * np.mean(np.sum(self.noise**2, axis=1))))
        return found if np.isfinite(found) else None

    @property
    def relative_rms(self) -> float:
        """Return the total rms over that of the measured response [-]."""
        size = float(np.sqrt(np.mean(np.sum(np.abs(self.measured) ** 2, axis=1))))
        return self.rms["total"] / size if size > 0 else float("inf")

    def table(self) -> pd.DataFrame:
        """Return columns of frequency, and of both responses by channel."""
        import pandas as pd

        columns = {"frequency [Hz]": self.frequency_hz}
        for k, channel in enumerate(self.channels):
            for side, H in (("measured", self.measured[:, k]), ("model", self.model[:, k])):
                name = side if channel == "total" else f"{side} {channel}"
                columns[f"{name} real [{self.unit}]"] = H.real
                columns[f"{name} imaginary [{self.unit}]"] = H.imag
        return pd.DataFrame(columns)

    def _by_channel(self, values: Floats) -> dict[str, float]:
        return {
            name: float(value) for name, value in zip(self.channels, values, strict=True) if name != "total"
        }

    def to_json_dict(self) -> dict[str, Any]:
        """Return its object in `flexarm compare --json`."""
        return {
            "unit": self.unit,
            "input": self.input,
            "rms": self.rms,
            "max": self.max,
            "relative_rms": self.relative_rms,
            "bands": [{"hz": [band.low, band.high], "rms": band.rms} for band in self.bands],
            "noise_rms": self.noise_rms,
            "frequency_hz": self.frequency_hz.tolist(),
            **{
                key: {"real": H.real.tolist(), "imaginary": H.imag.tolist()}
                for key, H in (("measured", self.measured), ("model", self.model))
            },
        }


@dataclass(frozen=True, eq=False, repr=False)
class ResponseComparison(SavedGap):
    """Hold the gap between a model and a record of frequency responses."""

    arm: str
    record: str
    """Name of the model, description of the record."""
    signals: Mapping[str, ResponseGap]
    """The gap of every response."""
    modes_hz: tuple[float, ...] = ()
    """Lowest frequencies of the arm with its drives held [Hz]."""
    notes: tuple[str, ...] = ()
    """What the reader should know."""

    def to_json_dict(self) -> dict[str, Any]:
        """Return the object of `flexarm compare --json`."""
        return {
            "kind": "frequency_response",
            "signals": {name: gap.to_json_dict() for name, gap in self.signals.items()},
            "modes_hz": list(self.modes_hz),
            "notes": list(self.notes),
        }

    def summary(self) -> str:
        """Return a table of the gap and its bands as text."""
        title = f"frequency responses of {self.arm!r} and " + (
            repr(self.record) if self.record else "the record"
        )
        axes = [a for a in "xyz" if any(a in gap.rms for gap in self.signals.values())]
        columns = [*axes, "total", "of measured", "noise", "max"]
        lines = [title, "", f"{'rms':<18}{'to':<14}{'unit':<14}" + "".join(f"{c:>13}" for c in columns)]
        for gap in self.signals.values():
            cells = [gap.rms.get(name) for name in (*axes, "total")]
            cells += [gap.relative_rms, gap.noise_rms, gap.max["total"]]
            values = "".join(f"{'-' if cell is None else f'{cell:.3e}':>13}" for cell in cells)
            lines.append(f"{gap.name:<18}{gap.input:<14}{gap.unit:<14}{values}")
        lines.append("")
        for gap in self.signals.values():
            parts = [f"{band.low:.3g}-{band.high:.3g} Hz: {band.rms:.3e}" for band in gap.bands]
            lines.append(f"{gap.name:<18}{gap.unit:<14}" + "   ".join(parts))
        lines.append(f"modes of the model, drives held: {', '.join(f'{f:.4g}' for f in self.modes_hz)} Hz")
        return "\n".join([*lines, *(f"note: {note}" for note in self.notes)])

    def tables(self) -> dict[str, pd.DataFrame]:
        """Return both responses of each signal by frequency."""
        return {name: gap.table() for name, gap in self.signals.items()}

    def plot(self, ax: Axes | None = None, signal: str | None = None) -> Axes:
        """Plot the size of a measured response and the model's over frequency; default: the first signal."""
        import matplotlib.pyplot as plt

        axes = plt.subplots()[1] if ax is None else ax
        gap = self.signals[signal] if signal is not None else next(iter(self.signals.values()))
        for k, name in enumerate(gap.channels):
            label = "" if name == "total" else f" {name}"
            (line,) = axes.semilogy(gap.frequency_hz, np.abs(gap.model[:, k]), label=f"model{label}")
            axes.semilogy(
                gap.frequency_hz,
                np.abs(gap.measured[:, k]),
                ".",
                color=line.get_color(),
                label=f"measured{label}",
            )
        axes.set(xlabel="frequency [Hz]", ylabel=f"|{gap.name} / {gap.input}| [{gap.unit}]")
        axes.legend()
        return axes


@takes()
def compare_responses(arm: Arm, record: Record) -> ResponseComparison:
    """Compare frequency responses with those of the linear model.

    Parameters
    ----------
    arm : Arm
        The model.
    record : Record
        Of kind "frequency_response".

    Raises
    ------
    InvalidParameter
        If the record names what the model does not have, an output does not follow its input, its frame is
        unknown, or an effect of the model leaves nothing of an input (`saturation`, `dead_channel`).
    NotConverged
        If there is no stable equilibrium.
    """
    record.check_against(arm)
    carried = record.applied_to(arm)
    found = modes(carried, dict(record.joints), count=MODES).frequency_hz.tolist()
    gaps = {}
    for name, signal in record.signals.items():
        if signal.input and (signal.valid & (signal.stamps > 0)).any():
            _require_known(record, signal)
            gaps[name] = _gap(carried, record, signal, found)
    if not gaps:
        raise InvalidParameter("holds no value of a response at a frequency above 0", where="signals")
    notes = [f"{problem.where} {problem.what}" for problem in unplaced_effects(record, carried)]
    silent = [name for name, gap in gaps.items() if gap.noise_rms is None]
    notes += [f"no noise is stated for {', '.join(silent)}"] if silent else []
    return ResponseComparison(arm.name, record.description, gaps, tuple(found), tuple(notes))


def _require_known(record: Record, signal: Signal) -> None:
    """Raise InvalidParameter if a response is seen in an unknown frame, or by clocks of unknown offset."""
    frame = record.frames.get(signal.frame)
    if frame is not None and frame.unknown and signal.quantity in SEEN_IN_FRAMES:
        raise InvalidParameter(
            f"is unknown, and the response {signal.name!r} is seen in it; state how it stands to the base",
            where=f"frames.{signal.frame}",
        )
    clocks = {signal.clock, record.signals[signal.input].clock}
    unknown = [name for name in clocks if len(clocks) > 1 and record.clocks[name].unknown]
    if unknown:
        raise InvalidParameter(
            f"is unknown, and the response {signal.name!r} and its input are on two clocks; state its offset",
            where=f"clocks.{unknown[0]}",
        )


def _gap(arm: Arm, record: Record, signal: Signal, modes_hz: list[float]) -> ResponseGap:
    """Return the gap of one response."""
    assert signal.frequency is not None
    rows = signal.valid & (signal.frequency > 0)
    frequency, measured = signal.frequency[rows], signal.response[rows]
    model = _response(arm, record, signal, frequency)
    squares = np.sum(np.abs(measured - model) ** 2, axis=1)
    edges = (
        [0.0, *(e for e in (0.5 * modes_hz[0], 2 * modes_hz[0]) if e < frequency[-1])] if modes_hz else [0.0]
    )
    ends = [*edges[1:], float(frequency[-1])]
    bands = []
    for low, high in zip(edges, ends, strict=True):
        inside = (frequency > low) & (frequency <= high)
        if inside.any():
            bands.append(Band(low, high, float(np.sqrt(squares[inside].sum() / len(squares)))))
    names = channel_names(signal.quantity, signal.axes)
    channels = ("total",) if names == ("",) else tuple(names)
    noise = signal.response_noise[rows]
    return ResponseGap(
        signal.name, signal.input, signal.unit, channels, frequency, measured, model, noise, tuple(bands)
    )


def _response(arm: Arm, record: Record, signal: Signal, frequency: Floats) -> Complex:
    """Return H of the model, shape (n, channels)."""
    to = record.signals[signal.input]
    place = str(to.point if to.quantity == "force" else to.joint)
    by_angle = [_sensor(to)] if to.quantity == "joint_angle" else []
    outputs = [_sensor(signal), *by_angle]
    model = linearise(arm, dict(record.joints), inputs={place: PORTS[to.quantity]}, outputs=outputs)
    column = "xyz".index(to.axes[0]) if to.quantity == "force" else 0
    H, rest = model.frequency_response(frequency)[:, :, column], model.output_at_rest
    stands = float(model.input_at_rest[column])
    if by_angle:
        H, rest, stands = H[:, :-1] / H[:, -1:], rest[:-1], float(rest[-1])
    elif to.quantity == "motor_torque" and to.side != "output":
        ratio = motor_ratio(arm, place)  # of the torque at the shaft
        H, stands = H * ratio, stands / ratio
    if signal.quantity == "position":
        frame = effects_of(arm, signal).registration(stated_placement(record).frame(signal))
        turned, axes = frame.error_rotation.T @ frame.frame_axes, columns(signal.axes)
        H, rest = frame.scale * (H @ turned)[:, axes], frame.positions(rest[None], axes=axes)[0]
    of_input = _slopes(arm, to, np.array([stands]))
    if not of_input.all():
        what = f"reads the same about rest, {stands:.4g}: an effect of the model hides the motion"
        raise InvalidParameter(what, where=f"signals.{to.name}")
    slopes = _slopes(arm, signal, rest) / of_input
    late = _delay(arm, record, signal) - _delay(arm, record, to)
    return np.asarray(H * slopes * np.exp(-2j * np.pi * frequency[:, None] * late))  # eq. (2)


def _slopes(arm: Arm, signal: Signal, rest: Floats) -> Floats:
    """Return s of (2) by channel, of a sensor that reads `rest` without effects."""
    step = 1e-6 * np.maximum(1.0, np.abs(rest))
    seen = effects_of(arm, signal)
    high, low = seen.reading(np.array([rest + step, rest - step]), rounded=False)
    return np.asarray((high - low) / (2 * step))


def _delay(arm: Arm, record: Record, signal: Signal) -> float:
    """Return tau of (2) [s]."""
    return effects_of(arm, signal).clock(stated_placement(record).clock(signal), 0.0).delay


def _sensor(signal: Signal) -> Sensor:
    """Return what reads a signal of the linear model; positions along the base's axes."""
    if signal.quantity == "orientation":
        what = "is an orientation, of which the linear model tells no response; take angular_rate"
        raise InvalidParameter(what, where=f"signals.{signal.name}.quantity")
    table: dict[str, Any] = {
        "name": signal.name,
        "quantity": signal.quantity,
        "rate_hz": 1.0,
        "axes": list(signal.axes) if signal.quantity != "position" else ["x", "y", "z"],
        **{key: getattr(signal, key) for key in ("joint", "point", "link", "side", "position", "fibre")},
    }
    return Sensor.model_validate({key: value for key, value in table.items() if value not in (None, [])})
