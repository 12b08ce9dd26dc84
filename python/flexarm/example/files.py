"""The files of the example, made anew each time: the same ones for everybody.

The machine that the records show is the model with what a real one has as well: a stiffness that is not the
nominal one, a gap in the reducer, a tracker whose clock is late and whose frame is turned. It is simulated
with a finer mesh and shorter steps than the model will be.
"""

from __future__ import annotations

from collections.abc import Sequence
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arrays import Floats, Ints
from flexarm.output import write_file
from flexarm.solids import Block, Patch, SolidMesh, revolved

if TYPE_CHECKING:
    from flexarm.arm import Arm
    from flexarm.record import Record

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
    from flexarm.arm import Arm

    path = directory / "arm.toml"
    write_file(path, _shipped("arm.toml"))
    arm = Arm.from_toml(path)
    hidden = machine(arm)
    hidden.to_toml(directory / "machine.toml")
    for seed, (name, (seconds, stops)) in enumerate(STOPS.items(), 1):
        virtual_record(hidden, seconds, stops, seed, LIGHT if name == "fast" else None).save(directory / name)
    time, angle = joined((0.0, 1.2), 6.0)
    rows = [f"{t:.1f},{q:.6f}" for t, q in zip(time[::25], angle[::25], strict=True)]
    head = "# From upright to 1.2 rad: the motor's angle over the ratio [rad].\ntime_s,hinge\n"
    write_file(directory / "swing.csv", head + "\n".join(rows) + "\n")
    write_file(directory / "bracket.inp", bracket())
    write_file(directory / "README.md", _shipped("about.md"))


def _shipped(name: str) -> str:
    return (files("flexarm.example") / name).read_text(encoding="utf-8")


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
    from flexarm.record import CarriedPayload, Clock, Frame, Record
    from flexarm.simulation import simulate

    step = 5e-4  # of the machine's simulation [s]
    payloads = {} if mass is None else {"load": CarriedPayload(mass=mass)}
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


def joined(stops: Sequence[float], seconds: float) -> tuple[Floats, Floats]:
    """Return time [s] and angle [rad] of minimum-jerk moves from stop to stop [Flash1985], a sample every 4
    ms.

    `stops` are two or more angles [rad], `seconds` the time from one to the next; the last stop is included.

    >>> time, angle = joined([0.0, 1.0], 2.0)
    >>> float(angle[0]), round(float(angle[250]), 6), float(angle[-1])
    (0.0, 0.5, 1.0)
    """
    interval = 4e-3  # between samples [s]
    moves = len(stops) - 1
    time = np.linspace(0.0, seconds * moves, round(seconds * moves / interval) + 1)
    move = np.minimum((time / seconds).astype(int), moves - 1)
    s = np.clip(time / seconds - move, 0.0, 1.0)
    angle: Floats = np.take(stops, move) + np.diff(stops)[move] * s**3 * (10 - 15 * s + 6 * s**2)
    return time, angle


MILLIMETRE = 1e-3
MATERIAL = """*MATERIAL, NAME=STEEL
*ELASTIC
210000., 0.3
*DENSITY
7.85E-9
*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL"""


def bracket() -> str:
    """Return the file's text: sets BORE (bearing seat) and FLANGE (face that carries), steel, N mm s t."""
    size = MILLIMETRE
    mesh = revolved(
        [
            Block("sleeve", 30 * size, 45 * size, 0.0, 60 * size),
            Block("plate", 30 * size, 80 * size, 60 * size, 72 * size),
        ],
        patches=[
            Patch("BORE", 30 * size, 30 * size, 0.0, 40 * size),
            Patch("FLANGE", 60 * size, 80 * size, 72 * size, 72 * size),
        ],
        size=15 * size,
    )
    rows = [f"{i}, {x:.6g}, {y:.6g}, {z:.6g}" for i, (x, y, z) in enumerate(mesh.points / MILLIMETRE, 1)]
    return "\n".join(["*HEADING", "collar, mm", "*NODE", *rows, *_cells(mesh), *_sets(mesh), MATERIAL, ""])


def _cells(mesh: SolidMesh) -> list[str]:
    """Return hexahedra of 20 nodes, whose order in Abaqus is that of VTK."""
    rows = []
    for i, nodes in enumerate(mesh.cells["hex20"], 1):
        rows.append(_listed(np.array([i, *(nodes[:15] + 1)], dtype=np.int32)) + ",")
        rows.append(_listed(nodes[15:] + 1))
    return ["*ELEMENT, TYPE=C3D20, ELSET=BODY", *rows]


def _sets(mesh: SolidMesh) -> list[str]:
    a_line = 16  # numbers a line of the file
    rows = []
    for name in ("BORE", "FLANGE"):
        nodes = mesh.point_sets[name] + 1
        rows.append(f"*NSET, NSET={name}")
        rows += [_listed(nodes[k : k + a_line]) for k in range(0, len(nodes), a_line)]
    return rows


def _listed(numbers: Ints) -> str:
    return ", ".join(str(number) for number in numbers)
