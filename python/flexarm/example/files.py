"""The files of the example, made anew each time: the same ones for everybody.

The machine that the records show is the model with what a real one has as well: a stiffness that is not the
nominal one, a gap in the reducer, a tracker whose clock is late and whose frame is turned. It is simulated
with a finer mesh and shorter steps than the model will be.
"""

from __future__ import annotations

from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexarm.example.bracket import bracket
from flexarm.example.motion import joined
from flexarm.output import write_file

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record
    from flexarm.record.table import CarriedPayload

GAP = 3e-4
"""The backlash that the machine has and the model lacks [rad]."""
LIGHT = 5.0
"""Payload mass in the record `fast` [kg]."""
STOPS = {
    "slow": (3.0, (-0.5, 0.6, 0.1, -0.2, 0.3, -0.1, 0.1)),
    "fast": (2.4, (-0.3, 0.4, -0.1, 0.2, -0.4, 0.2, 0.0)),
    "other_day": (2.8, (0.4, -0.5, 0.2, -0.1, 0.1, -0.3, 0.3)),
}
"""Seconds from stop to stop, and the angles of the stops [rad]."""


def write(directory: Path) -> None:
    """Write model, records, motion, mesh and the files that describe them into an existing directory."""
    arm = _model(directory)
    hidden = machine(arm)
    hidden.to_toml(directory / "machine.toml")
    for seed, (name, (seconds, stops)) in enumerate(STOPS.items(), 1):
        virtual_record(hidden, seconds, stops, seed, LIGHT if name == "fast" else None).save(directory / name)
    write_file(directory / "swing.csv", _swing())
    write_file(directory / "bracket.inp", bracket())
    write_file(directory / "README.md", _shipped("about.md"))


def _shipped(name: str) -> str:
    return (files("flexarm.example") / name).read_text(encoding="utf-8")


def _model(directory: Path) -> Arm:
    """Return the model as it is shipped, with comments."""
    from flexarm.arm import Arm

    path = directory / "arm.toml"
    write_file(path, _shipped("arm.toml"))
    return Arm.from_toml(path)


def machine(arm: Arm) -> Arm:
    """Return the machine that the records show."""
    from flexarm.arm.link import Beam
    from flexarm.effects import Backlash

    modulus = 1.006  # Young's modulus of the machine over the nominal one
    rod = arm.link("rod")
    assert isinstance(rod, Beam)
    steel = rod.material.replace(youngs_modulus=modulus * rod.material.youngs_modulus)
    real = arm.replace(
        name="virtual machine", links=(rod.replace(elements=8, material=steel),), uncertainty={}
    )
    return real.with_effect(Backlash(at="hinge", gap=GAP))


def virtual_record(
    machine: Arm, seconds: float, stops: tuple[float, ...], seed: int, mass: float | None = None
) -> Record:
    """Return the readings of the machine's sensors of moves from stop to stop [rad] in so many seconds each.

    `mass` is that of the load in this run [kg], by default the machine's.
    """
    from flexarm.drive import Drive
    from flexarm.measurement.clocks import ClockError
    from flexarm.measurement.frames import Registration
    from flexarm.measurement.measure import measure
    from flexarm.record import Clock, Frame, Record
    from flexarm.simulation import simulate

    step = 5e-4  # of the machine's simulation [s]
    payloads = _carried(mass)
    loaded = Record(signals={}, payloads=payloads).applied_to(machine)
    time, angle = joined(stops, seconds)
    run = simulate(loaded, Drive.from_samples(time, {"hinge": angle}), step=step)
    seen = measure(
        run,
        machine.sensors,
        np.random.default_rng(seed),
        drive=("hinge",),
        payloads=payloads,
        clocks={"controller": Clock(), "tracker": Clock(sigma=2e-3)},
        frames={"tracker": Frame(translation=1e-3, rotation=5e-4)},
        clock_errors={"tracker": ClockError(delay=1.3e-3)},
        registrations={"tracker": Registration(translation=(6e-4, 0.0, -4e-4), rotation=(0.0, 3e-4, 0.0))},
    )
    return seen.replace(description="virtual: simulated by flexarm example, not measured")


def _carried(mass: float | None) -> Mapping[str, CarriedPayload]:
    from flexarm.record.table import CarriedPayload

    return {} if mass is None else {"load": CarriedPayload(mass=mass)}


def _swing() -> str:
    """Return the planned motion: upright, to 1.2 rad, and to rest."""
    time, angle = joined((0.0, 1.2), 6.0)
    rows = [f"{t:.1f},{q:.6f}" for t, q in zip(time[::25], angle[::25], strict=True)]
    head = "# From upright to 1.2 rad: the motor's angle over the ratio [rad].\ntime_s,hinge\n"
    return head + "\n".join(rows) + "\n"
