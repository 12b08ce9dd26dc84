"""The runs behind the paper's figures: a virtual measurement and the models beside it."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path
from time import perf_counter
from typing import Any

import numpy as np

from flexarm.analytic import LinearModal, NonlinearModal, OneLinkArm, rigid_tip
from flexarm.analytic import simulate as simulate_modal
from flexarm.arm import Arm
from flexarm.arrays import Floats
from flexarm.drive import Drive, JointDrive
from flexarm.mockup import Experiment, virtual_measurement
from flexarm.modal import modes
from flexarm.record import Record
from flexarm.reproduction.offset import Plane, StaticOffset
from flexarm.reproduction.variants import CONTRIBUTORS, HINGE, RUNS, Models
from flexarm.simulation import Simulation, simulate
from flexarm.threads import thread_pool

Report = Callable[[float, str], None]

MODAL_STEP = 2e-2
"""Step of equations (1) and (2) [s]: within 0.15 mm of steps ten times as short."""
LATE = 2e-2
"""Models run on for so long after the record's end [s]: stamps may be late."""


@dataclass(frozen=True)
class Study:
    """Everything that figures and claims are made of."""

    experiment: Experiment
    """What the arm was asked to do."""
    models: Models
    """The finite-element model on its solid hinge, the bench, and their variants."""
    record: Record
    """The virtual measurement."""
    encoder: JointDrive
    """The encoder's angle, smoothed by its noise."""
    runs: dict[str, Simulation]
    """Finite-element runs, see `RUNS`."""
    modal_time: Floats
    modal: dict[str, Floats]
    """Tip x, z [m] of equations (1) and (2) at `modal_time`, shape (n, 2)."""
    static: dict[str, StaticOffset]
    """Quasi-static tip offset of the model ("both"), with only its tube or its hinge elastic ("tube",
    "hinge"), and with one of its `CONTRIBUTORS` rigid ("without hub" and so on)."""
    frequency_hz: dict[str, float]
    damping_ratio: dict[str, float]
    """First mode in the plane, upright, of the model ("fe") and with the printed area ("printed")."""
    seconds: dict[str, float] = field(default_factory=dict)
    """What each run took, and each solid part from mesh to file."""

    @property
    def model(self) -> Arm:
        """The finite-element model."""
        return self.models.fe

    @property
    def plane(self) -> Plane:
        """Geometry of the swing."""
        return Plane(self.models.lumped.point("tip").position[2], self.experiment.vertical)

    @property
    def stamps(self) -> Floats:
        """Instants of the tracker on the load, as stamped [s]."""
        return self.record.signals["tip"].time

    @property
    def measured(self) -> Floats:
        """Measured tip x, z [m], shape (n, 2)."""
        return self.record.signals["tip"].values[:, [0, 2]]

    def angle(self, time: Floats) -> Floats:
        """Return the encoder's angle [rad]."""
        return self.encoder(time)

    def rigid(self, time: Floats) -> Floats:
        """Return the tip x, z [m] of the rigid arm at the encoder's angle."""
        return rigid_tip(self.plane.length, self.angle(time))

    def tip(self, run: str, time: Floats) -> Floats:
        """Return tip x, z [m] of a finite-element run; equations (1), (2) as "equation 1", "equation 2"."""
        if run in self.modal:
            from scipy.interpolate import CubicSpline

            found: Floats = CubicSpline(self.modal_time, self.modal[run])(time)
            return found
        return tip_of(self.runs[run], time)

    def tangential(self, run: str, time: Floats) -> Floats:
        """Return the tangential offset of a run from the rigid arm at the angle that drives it [m]."""
        angle = self.experiment.angle(time) if run == "sine" else self.angle(time)
        return self.plane.tangential(self.tip(run, time), angle)

    @property
    def measured_tangential(self) -> Floats:
        """Tangential offset of the measured tip from the rigid arm at the encoder's angle [m]."""
        return self.plane.tangential(self.measured, self.angle(self.stamps))


def study(
    folder: Path, experiment: Experiment | None = None, seed: int = 2008, report: Report | None = None
) -> Study:
    """Make the hinge, run the experiment (default: the paper's) and all models.

    The folder of the super-elements' files must stay for as long as the study is used; `report` gets the
    share done, 0 to 1, and what is being done.
    """
    asked = experiment or Experiment()
    tell = report or (lambda done, what: None)
    seconds: dict[str, float] = {}

    def timed(name: str, done: float, what: str, make: Callable[[], Any]) -> Any:
        tell(done, what)
        began = perf_counter()
        found = make()
        seconds[name] = perf_counter() - began
        return found

    models = timed("parts", 0.0, "solid parts", lambda: Models.build(folder, partial(tell, 0.1)))
    record, _ = timed(
        "mock-up",
        0.2,
        "virtual mock-up",
        lambda: virtual_measurement(
            asked, models.bench, seed=seed, progress=lambda done: tell(0.2 + 0.3 * done, "virtual mock-up")
        ),
    )
    drive = timed("smoothing", 0.5, "encoder", lambda: Drive.from_record(record, models.fe))
    arms = models.runs()

    def run(name: str) -> Simulation:
        moved = asked.pure_sine() if name == "sine" else drive
        start = 0.55 + 0.1 * list(arms).index(name)
        end = asked.end + LATE
        found: Simulation = timed(name, start, RUNS[name], partial(simulate, arms[name], moved, end=end))
        return found

    time = np.arange(round((asked.end + LATE) / MODAL_STEP) + 1, dtype=float) * MODAL_STEP
    with thread_pool(1) as beside:  # the core works while Python integrates the equations
        simulated = beside.map(run, arms)
        modal = timed(
            "equations",
            0.52,
            "equations (1) and (2)",
            lambda: equations(models.lumped, drive.joints["hinge"], time),
        )
        runs = dict(zip(arms, simulated, strict=True))
    static = timed("statics", 0.95, "statics", lambda: offsets(models, asked))
    found = {
        key: modes(runs[key].arm, joints={"hinge": asked.vertical}, count=2) for key in ("fe", "printed")
    }
    return Study(
        asked,
        models,
        record,
        drive.joints["hinge"],
        runs,
        time,
        modal,
        static,
        {key: float(mode.frequency_hz[0]) for key, mode in found.items()},
        {key: float(mode.damping_ratio[0]) for key, mode in found.items()},
        {**seconds, **models.hinge.seconds},
    )


def tip_of(run: Simulation, time: Floats) -> Floats:
    """Return the tip x, z [m] of a run; before its start, where a late stamp may lie, the arm rests."""
    return run.at(np.maximum(time, run.time[0]), "tip")[:, [0, 2]]


def offsets(models: Models, asked: Experiment) -> dict[str, StaticOffset]:
    """Return Quasi-static offsets of the model and of those with parts made rigid."""
    arms = {"both": models.fe, "tube": models.rigid(*HINGE), "hinge": models.rigid("tube")}
    arms |= {f"without {part}": models.rigid(part) for part in CONTRIBUTORS}
    length = models.lumped.point("tip").position[2]
    return {
        key: StaticOffset.of(arm, length, asked.vertical, 1.05 * asked.amplitude) for key, arm in arms.items()
    }


def equations(arm: Arm, encoder: JointDrive, time: Floats) -> dict[str, Floats]:
    """Return the tip x, z [m] of equations (1) and (2) at the times."""
    angle = _scalar(encoder)
    one = OneLinkArm.of(arm)
    forms: dict[str, NonlinearModal | LinearModal] = {
        "equation 1": one.nonlinear(2),
        "equation 2": one.linear(2),
    }
    return {
        name: np.asarray(simulate_modal(form, one.drive(angle), time, step=MODAL_STEP).tip)
        for name, form in forms.items()
    }


def _scalar(encoder: JointDrive) -> Callable[..., float]:
    """Return the drive's angle (nu = 0) or a derivative at one time: plain numbers, for speed."""
    breaks = encoder.breaks.tolist()
    rows = [encoder.coefficients]
    for _ in range(len(encoder.coefficients) - 1):
        powers = np.arange(len(rows[-1]) - 1, 0, -1)[:, None]
        rows.append(powers * rows[-1][:-1])
    pieces = [of.T.tolist() for of in rows]

    def angle(t: float, nu: int = 0) -> float:
        inside = min(max(t, breaks[0]), breaks[-1])
        if (nu > 0 and t != inside) or nu >= len(pieces):
            return 0.0
        i = min(bisect_right(breaks, inside), len(breaks) - 1) - 1
        value, since = 0.0, inside - breaks[i]
        for coefficient in pieces[nu][i]:
            value = value * since + coefficient
        return float(value)

    return angle
