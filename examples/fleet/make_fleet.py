"""A virtual fleet: machines of one kind, measured on several dates while their reducers wear.

    python examples/fleet/make_fleet.py OUT_DIR [--machines 50] [--seed 1]

OUT_DIR gets the model that all machines were built after, arm.toml, the study fleet.toml, and the records
MACHINE/DATE/slow and MACHINE/DATE/fast, with another load in the second. Each machine has a modulus and a
backlash of its own, both constant but for wear: the backlash grows by WEAR a year, a little more here and
less there. truth.csv says what each machine had on each date; the study does not read it.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from shutil import copy

import numpy as np

from flexarm import Arm
from flexarm.arm.parameter import with_value
from flexarm.effects import Backlash
from flexarm.example import files
from flexarm.output import output_directory

DATES = ("2024-01-15", "2024-07-15", "2025-01-15", "2025-07-15", "2026-01-15", "2026-07-15")
GAP, WEAR = (2.0e-4, 3e-5), (1.0e-4, 2e-5)
"""Mean and standard deviation of the backlash at first [rad], and of its growth [rad/year]."""
MODULUS = 0.01
"""Standard deviation of the modulus over the nominal one."""
STOPS = {"slow": (3.0, (-0.5, 0.6, -0.2, 0.3)), "fast": (2.4, (-0.3, 0.4, -0.4, 0.2))}
"""Seconds from stop to stop, and the angles of the stops [rad]."""


def make(out: Path, machines: int, dates: tuple[str, ...] = DATES, seed: int = 1) -> None:
    """Write model, study and records into a directory that is there."""
    rng = np.random.default_rng(seed)
    (out / "arm.toml").write_text((Path(files.__file__).parent / "arm.toml").read_text())
    copy(Path(__file__).parent / "fleet.toml", out / "fleet.toml")
    nominal = Arm.from_toml(out / "arm.toml")
    lines = ["machine,date,gap_rad,modulus_scale"]
    for m in range(1, machines + 1):
        gap, wear, scale = rng.normal(*GAP), rng.normal(*WEAR), rng.normal(1.0, MODULUS)
        for k, date in enumerate(dates):
            now = max(2e-5, gap) + max(0.0, wear) * k / 2
            machine = _machine(nominal, now, scale)
            for name, (seconds, stops) in STOPS.items():
                record = files.virtual_record(
                    machine, seconds, stops, int(rng.integers(2**31)), files.LIGHT if name == "fast" else None
                )
                place = out / f"m{m:02d}" / date / name
                place.parent.mkdir(parents=True, exist_ok=True)
                record.save(place)
            lines.append(f"m{m:02d},{date},{now:.4e},{scale:.5f}")
    (out / "truth.csv").write_text("\n".join([*lines, ""]))


def _machine(nominal: Arm, gap: float, scale: float) -> Arm:
    """Return a machine, with a finer mesh than the model's."""
    rod = nominal.link("rod")
    arm = nominal.replace(name="machine", links=(rod.replace(elements=8),), uncertainty={})
    key = "links.rod.material.youngs_modulus"
    return with_value(arm, key, scale * rod.material.youngs_modulus).with_effect(
        Backlash(at="hinge", gap=gap)
    )


def main() -> None:
    """Make the fleet that the command line asks for."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("out", type=Path, metavar="OUT_DIR", help="a new or empty directory")
    parser.add_argument("--machines", type=int, default=50)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args()
    with output_directory(options.out) as folder:
        make(folder, options.machines, seed=options.seed)


if __name__ == "__main__":
    main()
