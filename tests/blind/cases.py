"""Cases of the blind test: a model, three records and what is hidden behind them.

`make_case("planar", "backlash", "elbow", 10.0, seed)` hides a gap in the elbow of the planar arm that leaves
ten times the noise. What the answer holds as `parameters` are the effect's own, as flexarm spells them.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from bench import RUNS, Bench, model_of, record_of
from hidden_effects import HIDDEN, Parameters, before, other_places
from lab_arms import LAB_ARMS, E
from sensing import Truth
from sizes import MASS, MODULUS, PLACE, Ruler, off_nominal, sized
from unnamed_effects import FAULTS, OUTSIDE, fault_signal, with_fault
from virtual_lab import Lab

import flexarm
from flexarm import Record


@dataclass(frozen=True)
class Behind:
    """A hidden effect: name, place, all places that say the same, parameters, size over the noise."""

    name: str
    at: str
    at_any: list[str]
    parameters: Parameters
    size: float


@dataclass(frozen=True)
class Answer:
    """What is true of a case.

    Attributes
    ----------
    verdict : tuple of str
        All that are right.
    noise : float
        In the tip of the held-out record, the root of the summed squares of all axes [m].
    asked : float
        The size that was asked for.
    outside : str
        What no name covers.
    true_values : dict
        Of what the model states with an uncertainty, by flexarm's keys.
    """

    id: str
    group: str
    kind: str
    verdict: tuple[str, ...]
    effects: list[Behind]
    noise: float
    asked: float = 0.0
    outside: str = ""
    true_values: dict[str, float] = field(default_factory=dict)

    def to_dict(self) -> dict:
        """For a JSON file."""
        effects = [effect.__dict__ for effect in self.effects]
        return {**self.__dict__, "effects": effects, "verdict": list(self.verdict)}

    @classmethod
    def from_dict(cls, data: dict) -> Answer:
        """From a JSON file."""
        effects = [Behind(**effect) for effect in data["effects"]]
        return cls(**{**data, "effects": effects, "verdict": tuple(data["verdict"])})


@dataclass(frozen=True)
class Case:
    """A model, records for fitting and for checking, and the answer."""

    model: flexarm.Arm
    train_a: Record
    train_b: Record
    held_out: Record
    answer: Answer

    def save(self, directory: Path) -> None:
        """Writes model, records and answer; the answer last, so that what has one is whole."""
        directory.mkdir(parents=True, exist_ok=True)
        self.model.to_toml(directory / "model.toml")
        for run in RUNS:
            getattr(self, run).save(directory / run, force=True)
        (directory / "answer.json").write_text(json.dumps(self.answer.to_dict(), indent=1) + "\n")

    @classmethod
    def load(cls, directory: Path) -> Case:
        """Reads what `save` wrote."""
        answer = Answer.from_dict(json.loads((directory / "answer.json").read_text()))
        records = [Record.load(directory / run) for run in RUNS]
        return cls(flexarm.Arm.from_toml(directory / "model.toml"), *records, answer)


def make_case(
    kind: str,
    effect: str | Sequence[str],
    place: str | Sequence[str],
    size: float,
    seed: int,
    rich: bool = True,
) -> Case:
    """A case of an arm with one effect or with several.

    Parameters
    ----------
    kind : str
        "hinged", "planar" or "spatial".
    effect, place : str or sequence of str
        Names of the vocabulary and their places; no effect: an empty sequence; a name of
        `unnamed_effects` for what is outside the vocabulary or a sensor at fault.
    size : float
        What each leaves over the noise, with nuisances fitted; of the last one, over the others.
    rich : bool
        All reflectors, torques and two loads; otherwise the tip in slow sines.
    """
    names = [effect] if isinstance(effect, str) else list(effect)
    at = [place] if isinstance(place, str) else list(place)
    rng = np.random.default_rng([seed, len(kind), *(ord(letter) for letter in "".join(names + at))])
    if names and names[0] in FAULTS:
        return _faulty(kind, names[0], rng, seed)
    truth, bench = Truth(LAB_ARMS[kind], LAB_ARMS[kind].robot), Bench.drawn(LAB_ARMS[kind], rich, rng)
    for name, where in zip(names, at, strict=True):
        truth = before(name, where, truth) if name in HIDDEN else truth
    model, behind = model_of(truth, bench), []
    bare = truth
    truth, true_values = with_nuisances(truth, bench, names, at, rng)
    for name, where in zip(names, at, strict=True):
        hide, own = (HIDDEN[name].hide if name in HIDDEN else OUTSIDE[name]), int(rng.integers(2**31))
        bounds = (HIDDEN[name].least, HIDDEN[name].most) if name in HIDDEN else ()
        p, reached = sized(Ruler(bare, bench), hide, where, size, own, *bounds)
        truth, parameters = hide(truth, where, p, np.random.default_rng(own))
        bare = hide(bare, where, p, np.random.default_rng(own))[0]
        same = other_places(name, where, bench.points) if name in HIDDEN else [where]
        behind.append(Behind(name, where, same, parameters, reached))
    verdict = "effects" if names else "adequate"
    group = ("single" if len(names) == 1 else "double" if names else "none") if rich else "poor"
    if names and names[0] in OUTSIDE:
        group, verdict = "outside", "unexplained"
    title = "-".join([kind, group, *names, *at, f"{size:g}", str(seed)])
    behind = behind if group != "outside" else []
    answer = Answer(title, group, kind, (verdict,), behind, 0.0, size, true_values=true_values)
    if group == "outside":
        answer = replace(answer, outside=names[0])
    return _recorded(truth, bench, model, answer, rng)


def _recorded(
    truth: Truth, bench: Bench, model: flexarm.Arm, answer: Answer, rng: np.random.Generator
) -> Case:
    records, noise = {}, 0.0
    for run in RUNS:
        records[run], noise = record_of(truth, bench, run, rng)
    return Case(model, *records.values(), replace(answer, noise=noise))


def _faulty(kind: str, fault: str, rng: np.random.Generator, seed: int) -> Case:
    """A case whose arm is as modelled and one of whose signals is at fault, in all records."""
    truth = Truth(LAB_ARMS[kind], LAB_ARMS[kind].robot)
    bench = Bench.drawn(truth.arm, True, rng)
    signal, own = fault_signal(fault, truth), int(rng.integers(2**31))
    behind = Behind(fault, signal, [signal], {}, 0.0)
    # What is removed and said leaves a model that explains the rest.
    verdict = ("adequate", "effects") if fault == "outliers" else ("unusable", "effects")
    answer = Answer(f"{kind}-fault-{fault}-{signal}-{seed}", "fault", kind, verdict, [behind], 0.0)
    model, truth = model_of(truth, bench), with_nuisances(truth, bench, [], [], rng)[0]
    case = _recorded(truth, bench, model, answer, rng)
    faulty = {run: with_fault(getattr(case, run), fault, signal, np.random.default_rng(own)) for run in RUNS}
    return replace(case, **faulty)


def with_nuisances(
    truth: Truth, bench: Bench, names: Sequence[str], at: Sequence[str], rng: np.random.Generator
) -> tuple[Truth, dict[str, float]]:
    """The truth with clock, frame, nominal values and reflectors off as likely as stated, below 1.8 sigma.

    Also what the nominal values are in truth, by flexarm's keys. A modulus, a load or a reflector that an
    effect is about is exact: the effect's parameter is a total.
    """

    def off(sigma: float, count: int = 3) -> np.ndarray:
        return sigma * np.clip(rng.standard_normal(count), -1.8, 1.8)

    lab, arm = Lab(), truth.arm
    plane, turning = (np.array([1, 0, 1]), np.array([0, 1, 0])) if arm.planar else (np.ones(3), np.ones(3))
    about = {
        "translation": tuple(off(lab.translation) * plane),
        "rotation": tuple(off(lab.rotation) * turning),
    }
    sensors = truth.sensors.with_tracker(delay=float(off(lab.clock, 1)[0]), **about)
    exact = set(zip(names, at, strict=True))
    values = {}
    for point in bench.points:
        way = off(PLACE) * plane * (("reflector_offset", point) not in exact)
        sensors = sensors.with_moved(point, tuple(way))
        reflector = arm.reflectors[point]
        length = arm.tubes[reflector.link].length if reflector.link in arm.tubes else 0.0
        place = np.add(reflector.offset, way) + np.array([0, 0, reflector.fraction * length])
        values |= {f"points.{point}.position.{axis}": float(x) for axis, x in zip("xyz", place, strict=True)}
    moduli = {name: float(off(MODULUS, 1)[0]) * (("link_stiffness", name) not in exact) for name in arm.tubes}
    mass = float(off(MASS, 1)[0]) * (("payload_mass", "load") not in exact)
    values |= {f"links.{name}.material.youngs_modulus": E * (1 + part) for name, part in moduli.items()}
    values["payloads.load.mass"] = arm.tubes[arm.joints[-1].link_name].load.mass * (1 + mass)
    return off_nominal(replace(truth, sensors=sensors), moduli, mass), values
