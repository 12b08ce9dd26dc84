"""Simulation-based calibration of the intervals of `flexarm calibrate`: ranks of truths in their posteriors.

    python benchmarks/calibration_ranks.py --seed 1 --draws 100 --out ranks.json

Truths are drawn from the priors that a model states, records are simulated and measured with noise, and all
truths are estimated from them. If the posteriors are right, the share of each posterior below its truth,

    r = P(u < u_true | record),                                                                        (1)

is uniform in [0, 1] [Talts2018]. Records come from the same simulator with twice the elements and an eighth
of the time step. `--out` keeps what was done: the same command goes on from there. `--picture` draws a
histogram. Ranks of one record depend on each other: intervals of pooled rates are somewhat too narrow.
"""

from __future__ import annotations

import argparse
import json
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import log, pi
from pathlib import Path
from time import process_time

import numpy as np
from blind_table import wilson

from flexarm import Arm, Clock, Drive, Record, Sensor, measure, simulate
from flexarm.arm.link import Link
from flexarm.arm.parameter import with_value
from flexarm.calibration.intervals import marginals
from flexarm.calibration.optimum import posterior_of
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.calibration.workflow import estimation_of
from flexarm.diagnosis.coarse_encoders import with_errors_of_drives
from flexarm.diagnosis.noise_model import SEED
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.sensor_zeros import with_zeros
from flexarm.effects.backlash import Backlash
from flexarm.effects.coulomb_friction import CoulombFriction
from flexarm.measurement import ClockError

EXAMPLES = Path(__file__).resolve().parents[1] / "examples"
STEP, END = 2e-3, 8.0
CLOCK, ZERO = 2e-3, 1e-3
"""1 sigma of the tracker's clock [s] and of the zero of an encoder [rad]."""
BINS = 10


def smooth_hinge() -> Arm:
    """One link on a spring: spring, damper, load and modulus are uncertain."""
    return _uncertain(
        Arm.from_toml(EXAMPLES / "one_link.toml"),
        {
            "effects.joint_compliance.hinge.stiffness": 0.3,
            "effects.joint_compliance.hinge.damping": 0.3,
            "payloads.load.mass": 0.05,
            "links.rod.material.youngs_modulus": 0.03,
        },
    )


def loose_hinge() -> Arm:
    """One link with a gap and dry friction at its hinge, both known to half of themselves."""
    arm = Arm.from_toml(EXAMPLES / "one_link.toml")
    return _uncertain(
        arm.with_effect(Backlash(at="hinge", gap=4e-4)).with_effect(CoulombFriction(at="hinge", torque=15.0)),
        {
            "effects.joint_compliance.hinge.stiffness": 0.2,
            "effects.backlash.hinge.gap": 0.5,
            "effects.coulomb_friction.hinge.torque": 0.5,
            "payloads.load.mass": 0.05,
        },
    )


def three_joints() -> Arm:
    """Three joints, springs known to a factor of e, which a tracker with 2 mm of noise shows."""
    return _uncertain(
        Arm.from_toml(EXAMPLES / "three_joints.toml").without_effect("coulomb_friction", "elbow"),
        {
            "effects.joint_compliance.shoulder.stiffness": 1.0,
            "effects.joint_compliance.elbow.stiffness": 1.0,
            "effects.joint_compliance.shoulder.damping": 0.5,
            "effects.joint_compliance.elbow.damping": 0.5,
            "payloads.load.mass": 0.1,
        },
    )


def _uncertain(arm: Arm, relative: dict[str, float]) -> Arm:
    return arm.replace(uncertainty=relative)


@dataclass(frozen=True)
class Study:
    """An arm and what its tracker errs by [m]."""

    arm: Callable[[], Arm]
    noise: float
    turns: Mapping[str, tuple[float, float]]
    """Amplitude [rad] and frequency [Hz] of each joint."""

    def draw(self, rng: np.random.Generator) -> tuple[dict[str, float], Record]:
        """Return truths by key, and a record of that arm."""
        arm = self.arm()
        truth = {}
        for key in arm.uncertainty:
            value, sigma = arm.sigma(key)
            truth[key] = float(value * np.exp(sigma / value * rng.standard_normal()))
        delay, zero = CLOCK * rng.standard_normal(), ZERO * rng.standard_normal()
        true = arm.replace(links=tuple(_finer(link) for link in arm.links))
        for key, value in truth.items():
            true = with_value(true, key, value)
        joint = arm.joints[-1].name
        seen = measure(
            simulate(true, self._drive(), step=STEP / 8),
            self._sensors(joint),
            rng,
            drive=list(self.turns),
            clocks={"plc": Clock(), "tracker": Clock(sigma=CLOCK)},
            clock_errors={"tracker": ClockError(float(delay))},
        )
        output = seen.signals["output"]
        shifted = output.replace(values=output.values + zero, zero_std=ZERO)
        truth["effects.time_delay.tracker.delay"] = float(delay)
        truth["effects.sensor_offset.output.offset"] = float(zero)
        return truth, seen.replace(signals=list({**seen.signals, "output": shifted}.values()))

    def _drive(self) -> Drive:
        time = np.linspace(0, END, 801)
        start = np.clip(time / 2, 0, 1)
        start = start**3 * (10 - 15 * start + 6 * start**2)
        turns = {
            joint: start * size * (np.sin(2 * pi * hz * time) + 0.3 * np.sin(2 * pi * 2.7 * hz * time))
            for joint, (size, hz) in self.turns.items()
        }
        return Drive.from_samples(time, turns)

    def _sensors(self, joint: str) -> list[Sensor]:
        motors = [
            Sensor(name=each, quantity="joint_angle", joint=each, rate_hz=200, noise_std=5e-6, clock="plc")
            for each in self.turns
        ]
        output = {"name": "output", "joint": joint, "side": "output", "rate_hz": 100, "noise_std": 2e-5}
        tip = {"name": "tip", "point": "tip", "rate_hz": 20, "noise_std": self.noise, "clock": "tracker"}
        return [
            *motors,
            Sensor(quantity="joint_angle", clock="plc", **output),
            Sensor(quantity="position", **tip),
        ]


def _finer(link: Link) -> Link:
    return link.replace(elements=2 * link.elements) if link.type == "beam" else link


STUDIES = {
    "smooth hinge": Study(smooth_hinge, 1e-4, {"hinge": (0.7, 0.15)}),
    "loose hinge": Study(loose_hinge, 1e-4, {"hinge": (0.7, 0.15)}),
    "three joints": Study(
        three_joints, 2e-3, {"waist": (0.5, 0.1), "shoulder": (0.5, 0.13), "elbow": (0.6, 0.17)}
    ),
}


def ranks(study: Study, seed: int) -> dict[str, float]:
    """Return r of (1) by parameter."""
    truth, record = study.draw(np.random.default_rng(seed))
    records = {"record": record}
    arm = with_zeros(study.arm(), records, SelectionPolicy())
    problem, _, _ = with_errors_of_drives(Problem(arm, records, step=STEP), SEED)
    posterior = posterior_of(estimation_of(problem, (), CalibrationPolicy()), lambda what: None)
    found = {}
    for free, marginal in zip(posterior.estimation.parameters, marginals(posterior), strict=True):
        if free.key in truth:
            u = log(truth[free.key]) if free.scale == "log" else truth[free.key]
            found[free.key] = marginal.share(u)
    return found


def draw_all(seed: int, draws: int, studies: Iterable[str], path: Path | None) -> dict[str, dict[str, float]]:
    """Return ranks by "study: number", those in the file among them; write each at once."""
    done = json.loads(path.read_text()) if path is not None and path.exists() else {}
    for k in range(draws):
        for name in studies:
            key = f"{name}: {1000 * seed + k}"
            if key not in done:
                done[key] = ranks(STUDIES[name], 1000 * seed + k)
                if path is not None:
                    path.write_text(json.dumps(done, indent=1))
    return done


def inside(values: Sequence[float]) -> str:
    """Return how many truths lie in their 90 % intervals, with Wilson's 95 % interval."""
    count = sum(0.05 < value < 0.95 for value in values)
    rate, low, high = (100 * each for each in (count / len(values), *wilson(count, len(values))))
    return f"{count} of {len(values)} | {rate:.0f} % | {low:.0f} to {high:.0f} %"


def rows(found: Mapping[str, Mapping[str, float]]) -> Iterator[str]:
    """Yield a table in Markdown: truths in their intervals, and p of uniform ranks (Kolmogorov, Smirnov)."""
    from scipy.stats import kstest

    yield "| arm, parameter | truths in their intervals | | Wilson 95 % | mean rank | p, uniform |"
    yield "|---|---|---|---|---|---|"
    pooled: dict[tuple[str, str], list[float]] = {}
    for draw, values in found.items():
        for key, value in values.items():
            for name in (f"{draw.split(':')[0]}, all", f"{draw.split(':')[0]}, `{key}`"):
                pooled.setdefault((draw.split(":")[0], name), []).append(value)
    for (_, name), values in sorted(pooled.items()):
        p = kstest(values, "uniform").pvalue
        yield f"| {name} | {inside(values)} | {np.mean(values):.2f} | {p:.2g} |"
    yield f"| all | {inside([r for values in found.values() for r in values.values()])} | | |"


def picture(found: Mapping[str, Mapping[str, float]], path: Path) -> None:
    """Draw a histogram of ranks for each arm, with the band that holds 90 % of uniform ones in each bin."""
    import matplotlib.pyplot as plt
    from scipy.stats import binom

    from flexarm.report.files import style

    names = list(dict.fromkeys(key.split(":")[0] for key in found))
    with style():
        figure, axes = plt.subplots(
            1, len(names), figsize=(3.2 * len(names), 2.8), layout="constrained", squeeze=False
        )
        for ax, name in zip(axes[0], names, strict=True):
            values = [r for key, each in found.items() if key.split(":")[0] == name for r in each.values()]
            ax.axhspan(*binom.interval(0.9, len(values), 1 / BINS), color="0.85", label="90 % of uniform")
            ax.hist(values, bins=BINS, range=(0, 1), histtype="step", color="C0")
            ax.set(title=f"{name}, {len(values)} truths", xlabel="rank r [-]", ylabel="truths a bin [1]")
        axes[0, 0].legend(loc="lower center")
        figure.savefig(path, dpi=110)


def main() -> None:
    """Draw, estimate, and print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--draws", type=int, default=20)
    parser.add_argument("--studies", nargs="*", default=list(STUDIES), choices=list(STUDIES))
    parser.add_argument("--out", type=Path)
    parser.add_argument("--picture", type=Path)
    told = parser.parse_args()
    found = draw_all(told.seed, told.draws, told.studies, told.out)
    print(*rows(found), sep="\n")
    print(f"\n{process_time():.0f} s of CPU")
    if told.picture is not None:
        picture(found, told.picture)


if __name__ == "__main__":
    main()
