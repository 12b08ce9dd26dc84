"""Static records of machines that are known: poses at random, what stands in them seen with noise."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

import flexarm
from flexarm.comparison.aligned_record import simulate_record
from flexarm.record import Frame, Record, Signal

NOISE = 5e-5


def posed(
    machine: flexarm.Arm,
    angles: NDArray[np.float64],
    seed: int = 0,
    axes: tuple[str, ...] = ("x", "z"),
    frame: Frame | None = None,
    loads: ArrayLike | None = None,
    seen: dict[str, dict[str, object]] | None = None,
) -> Record:
    """A record of a machine's poses.

    Parameters
    ----------
    machine : Arm
        What stands there.
    angles : ndarray, shape (poses, joints)
        Of its moving joints [rad].
    seed : int
        Of the noise.
    axes : tuple of str
        Along which its tip is seen.
    frame : Frame, optional
        Of what sees it; default: the base's own.
    loads : array_like, shape (poses,), optional
        What its load weighs in each pose [kg].
    seen : dict of str to dict, optional
        Other signals by name: quantity, place and noise.
    """
    names = np.array([f"p{k}" for k in range(len(angles))])
    joints = [joint.name for joint in machine.moving_joints]
    signals = [
        Signal(name=joint, quantity="joint_angle", joint=joint, side="motor", pose=names, values=column)
        for joint, column in zip(joints, np.asarray(angles).T, strict=True)
    ]
    if loads is not None:
        weighed = np.asarray(loads, dtype=float)
        signals.append(
            Signal(name="mass", quantity="payload_mass", payload="load", pose=names, values=weighed)
        )
    tip = {"quantity": "position", "point": "tip", "axes": axes, "noise_std": NOISE}
    tip |= {"frame": "tracker"} if frame is not None else {}
    for name, of in {"tip": tip, **(seen or {})}.items():
        channels = len(of.get("axes", "1"))
        signals.append(Signal(name=name, pose=names, values=np.zeros((len(names), channels)), **of))
    frames = {} if frame is None else {"tracker": frame}
    record = Record(kind="static", drive=tuple(joints), signals=signals, frames=frames)
    return _measured(machine, record, np.random.default_rng(seed))


def _measured(machine: flexarm.Arm, record: Record, rng: np.random.Generator) -> Record:
    pair = simulate_record(machine, record, align=False)
    signals = dict(record.signals)
    for name, signal in pair.simulated.evidence.items():
        true = pair.simulated.predicted(signal, pair.aligned.placement)
        noise = (signal.noise_std or 0.0) * rng.standard_normal(true.shape)
        signals[name] = signal.replace(values=true + noise)
    return record.replace(signals=signals)


def poses(joints: int, count: int, seed: int, span: float = 1.2) -> NDArray[np.float64]:
    """Angles of as many joints at random [rad], shape (count, joints)."""
    return np.random.default_rng(seed).uniform(-span, span, (count, joints))


def moved(record: Record, rpy: ArrayLike, xyz: ArrayLike) -> Record:
    """The record with its tip seen along three axes from a tracker that stands there."""
    turn = Rotation.from_euler("xyz", rpy).as_matrix()
    tip = record.signals["tip"]
    return changed(record, "tip", (tip.values - np.asarray(xyz)) @ turn)


def changed(record: Record, name: str, values: NDArray[np.float64], **more: object) -> Record:
    """The record with other readings of a signal."""
    signal = record.signals[name].replace(values=values, **more)
    return record.replace(signals={**record.signals, name: signal})


def spoilt(record: Record, row: int, axis: int, factor: float = 1.0, by: float = 0.0) -> Record:
    """The record with one number of its tip multiplied, or off by some [m]."""
    values = record.signals["tip"].values.copy()
    values[row, axis] = factor * values[row, axis] + by
    return changed(record, "tip", values)
