"""The gap of one signal: measured minus predicted, by direction and by band, with its noise.

    rms_d = sqrt(mean r_d^2),   total = sqrt(sum over measured channels of rms^2)                    (1)
    noise^2 = sum over measured channels of noise_std^2 + jitter_std^2 mean |rate|^2                 (2)

A perfect model has a total of about (2). Rows that an effect `outliers` of the model explains are removed,
and gross outliers that the alignment left out (`flexarm.measurement.outliers`).

With one moving joint, about the axis a through o, the directions of a position are, at the rigid position p
of the point for the drive's angle,

    radial   = (p - o) without its part along a, normed                                              (3)
    tangential = a x radial = d p/dq, normed,        normal = a                                      (4)

With several moving joints, or a sliding one, the base's x, y, z. A direction counts as measured if the
measured axes span it to within `span`.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from flexarm.arm.kinematics import chain_to, joint_frame, link_pose
from flexarm.arrays import Floats
from flexarm.comparison.bands import Band, band_edges, band_split
from flexarm.comparison.simulated_record import Placement, SimulatedRecord
from flexarm.measurement.frames import Registration
from flexarm.measurement.sampling import columns, sample
from flexarm.record import Signal

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.axis import Axis


@dataclass(frozen=True, eq=False)
class SignalGap:
    """Hold the residual of one signal and its measures."""

    name: str
    quantity: str
    unit: str
    """The signal; the unit is that of the residual."""
    time: Floats
    """Instants in the simulation's time [s], or numbers of poses, shape (n,)."""
    parts: Mapping[str, Floats | None]
    """Residual along each direction; None where it was not measured. Scalars have "total" only, shape
    (n,)."""
    rms: Mapping[str, float | None]
    max: Mapping[str, float | None]
    """Of the parts, and of all measured channels together ("total": eq. (1), greatest length)."""
    bands: tuple[Band, ...]
    """Of the total."""
    noise_rms: float | None
    """Eq. (2); None where no noise is stated."""
    is_drive: bool = False
    """True if the signal drives the simulation: its gap says nothing about the model."""
    removed: int = 0
    """Number of rows that an effect `outliers` of the model explains."""
    gross: tuple[int, ...] = ()
    """Other rows that are outliers and count in nothing, from 0."""
    poses: tuple[str, ...] = ()
    """Pose of each row; empty of a motion."""
    measured: Mapping[str, Floats] = field(default_factory=dict)
    model: Mapping[str, Floats] = field(default_factory=dict)
    """Readings of the rows by channel, in the frame and unit of the signal; empty if unknown."""
    reading_unit: str = ""

    def line(self, direction: str) -> tuple[Floats, Floats]:
        """Return instants and residual along a direction as a line that breaks (NaN) where rows are left out.

        Of poses, and where less than five usual intervals are missing, these are `time` and the part.
        """
        part = self.parts[direction]
        assert part is not None
        between = np.diff(self.time)
        if self.poses or not len(between):
            return self.time, part
        missing = np.flatnonzero(between > 5 * np.median(between)) + 1
        return np.insert(self.time, missing, np.nan), np.insert(part, missing, np.nan)

    def table(self) -> pd.DataFrame:
        """Return columns of time [s] or pose, of the residual by direction, and of readings by channel."""
        import pandas as pd

        gaps = {f"{name} [{self.unit}]": part for name, part in self.parts.items() if part is not None}
        along = {"pose": self.poses} if self.poses else {"time_s": self.time}
        readings = {
            f"{whose}{name and f' {name}'} [{self.reading_unit}]": values
            for whose, found in (("measured", self.measured), ("model", self.model))
            for name, values in found.items()
        }
        return pd.DataFrame({**along, **gaps, **readings})

    def label_poses(self, axis: Axis) -> None:
        """Name at most ten poses along an axis of their numbers; a motion has none."""
        if self.poses:
            named = list(dict(zip(self.time.tolist(), self.poses, strict=True)).items())
            axis.set_ticks(*zip(*named[:: -(-len(named) // 10)], strict=True))

    def to_json_dict(self) -> dict[str, Any]:
        """Return the signal's object of `compare --json`."""
        return {
            "unit": self.unit,
            "rms": dict(self.rms),
            "max": dict(self.max),
            "bands": [{"hz": [band.low, band.high], "rms": band.rms} for band in self.bands],
            "noise_rms": self.noise_rms,
        }

    def __repr__(self) -> str:
        noise = "" if self.noise_rms is None else f", noise {self.noise_rms:.3g}"
        rms = "none" if self.rms["total"] is None else f"{self.rms['total']:.3g}"
        what = f"{len(self.time)} x {self.quantity} [{self.unit}]"
        return f"<SignalGap {self.name!r}: {what}, rms {rms}{noise}>"


def signal_gap(
    simulated: SimulatedRecord,
    signal: Signal,
    placement: Placement,
    joint: str | None,
    modes_hz: Sequence[float],
    edges: Sequence[float] | None = None,
    gross: NDArray[np.bool_] | None = None,
) -> SignalGap:
    """Compute the gap of a signal, given clocks and frames.

    `joint` is the one joint that moves; None: several. `modes_hz` set the bands, or `edges` [Hz] inside the
    range do. Rows in `gross`, bool of shape (n,), are left out as outliers.
    """
    instants, residual = simulated.instants(signal, placement), simulated.residual(signal, placement)
    out = simulated.outliers(signal, residual)
    left = np.zeros(len(residual), dtype=bool) if gross is None else gross & ~out
    keep = np.isfinite(residual).all(axis=1) & ~out & ~left
    instants, residual = instants[keep], residual[keep]
    parts = _parts(simulated, signal, placement, joint, instants, residual)
    measures = {**parts, "total": np.linalg.norm(residual, axis=1)}
    bands: list[Band] = []
    if simulated.record.kind == "motion":
        bands = band_split(instants, residual, band_edges(instants, modes_hz, edges))
    names = "xyzw" if signal.quantity == "orientation" else signal.axes or ("",)
    measured, model = (
        dict(zip(names, values[keep].T, strict=True))
        for values in (signal.values, simulated.predicted(signal, placement))
    )
    return SignalGap(
        signal.name,
        signal.quantity,
        "rad" if signal.quantity == "orientation" else signal.unit,
        instants,
        parts,
        {name: _rms(part) for name, part in measures.items()},
        {name: _max(part) for name, part in measures.items()},
        tuple(bands),
        _noise(simulated, signal, placement) if signal.noise_std is not None else None,
        signal.name in simulated.record.drive,
        int(out.sum()),
        tuple(map(int, np.flatnonzero(left))),
        () if signal.pose is None else tuple(map(str, signal.pose[keep])),
        measured,
        model,
        signal.unit,
    )


def _noise(simulated: SimulatedRecord, signal: Signal, placement: Placement) -> float:
    """Return the noise of the total, eq. (2)."""
    jitter_step = 1e-4  # half the difference of time for the rate in (2) [s]
    square = float(np.sum(simulated.noise(signal) ** 2))
    if signal.jitter_std > 0 and simulated.record.kind == "motion":
        clock, clocks = placement.clock(signal), placement.clocks
        ahead, behind = (
            simulated.residual(
                signal,
                replace(
                    placement, clocks={**clocks, signal.clock: replace(clock, delay=clock.delay + shift)}
                ),
                hold=True,
            )
            for shift in (-jitter_step, jitter_step)
        )
        rate = (behind - ahead) / (2 * jitter_step)
        square += signal.jitter_std**2 * float(np.nanmean(np.sum(rate**2, axis=1)))
    return float(np.sqrt(square))


def _parts(
    simulated: SimulatedRecord,
    signal: Signal,
    placement: Placement,
    joint: str | None,
    instants: Floats,
    residual: Floats,
) -> dict[str, Floats | None]:
    """Return the residual along directions of the arm that a position spans, else along its own axes."""
    if signal.quantity == "position":
        directions = directions_of(simulated, signal, joint, instants)
        parts = project(residual, signal.axes, simulated.frame(signal, placement), directions)
        if any(part is not None for part in parts.values()):
            return parts
        return {f"sensor {axis}": residual[:, k] for k, axis in enumerate(signal.axes)}
    if signal.quantity == "orientation" or (signal.spec.channels is None and signal.axes):
        axes = signal.axes or ("x", "y", "z")
        return {axis: residual[:, axes.index(axis)] if axis in axes else None for axis in "xyz"}
    return {"total": residual[:, 0]}


def directions_of(
    simulated: SimulatedRecord, signal: Signal, joint: str | None, instants: Floats
) -> dict[str, Floats]:
    """Return unit vectors along which a position's gap is shown: those of the joint, else x, y, z."""
    directions = None
    if joint is not None and signal.point is not None:
        angles = drive_angles(simulated, instants)
        directions = joint_directions(simulated.simulation.arm, joint, signal.point, angles)
    return directions or base_directions(len(instants))


def drive_angles(simulated: SimulatedRecord, instants: Floats) -> dict[str, Floats]:
    """Return drive angles of all joints at the instants."""
    run = simulated.simulation
    values = sample(run.time, np.asarray(run.drive_angle), instants, np.asarray(run.drive_rate))
    return {name: values[:, j] for j, name in enumerate(run.joints)}


def _rms(part: Floats | None) -> float | None:
    return None if part is None or not len(part) else float(np.sqrt(np.mean(part**2)))


def _max(part: Floats | None) -> float | None:
    return None if part is None or not len(part) else float(np.abs(part).max())


def base_directions(count: int) -> dict[str, Floats]:
    """Return x, y, z of the base at `count` instants, each of shape (count, 3)."""
    return {axis: np.broadcast_to(np.eye(3)[i], (count, 3)) for i, axis in enumerate("xyz")}


def joint_directions(
    arm: Any, joint: str, point: str, values: Mapping[str, Floats]
) -> dict[str, Floats] | None:
    """Return tangential, radial and normal (3)-(4) at the point's rigid positions, each of shape (n, 3).

    `values` are drive angles [rad] of the joint, shape (n,), and of joints that stand. None if the joint
    slides, does not carry the point, or the point lies on its axis.
    """
    moving = arm.joint(joint)
    place = arm.point(point)
    if moving.type != "revolute" or moving not in chain_to(arm, place.link):
        return None
    frame = joint_frame(arm, moving, link_pose(arm, moving.parent, values))
    axis = frame.R @ (np.asarray(moving.axis, dtype=float) / np.linalg.norm(moving.axis))
    lever = link_pose(arm, place.link, values).of_point(np.asarray(place.position)) - frame.x
    radial = lever - np.sum(lever * axis, axis=1, keepdims=True) * axis  # eq. (3)
    length = np.linalg.norm(radial, axis=1, keepdims=True)
    if length.min(initial=np.inf) < 1e-9:
        return None
    radial = radial / length
    normal = np.broadcast_to(axis, radial.shape)
    return {"tangential": np.cross(normal, radial), "radial": radial, "normal": normal}  # eq. (4)


def project(
    residual: Floats, axes: Sequence[str] | None, frame: Registration, directions: Mapping[str, Floats]
) -> dict[str, Floats | None]:
    """Project a measured residual, (n, axes) in a frame's axes, on unit vectors, (n, 3), given in the base.

    `axes` names those that were measured; None: all. A direction that they do not span gives None.
    """
    span = 0.02  # greatest part of a direction outside of the measured axes: about one degree
    measured = (frame.error_rotation.T @ frame.frame_axes)[:, columns(axes)]
    found: dict[str, Floats | None] = {}
    for name, unit in directions.items():
        parts = unit @ measured
        outside = np.sqrt(np.maximum(1 - np.sum(parts**2, axis=1), 0.0))
        found[name] = np.sum(parts * residual, axis=1) if outside.max(initial=0.0) < span else None
    return found
