"""Diagnoses made by hand around real comparisons: what a page and a file are made from.

The bench is a tube on a hinge with a spring; the nominal model has a rigid hinge, the updated one the spring.
"""

from __future__ import annotations

from functools import cache

import numpy as np
from arms import crane, smooth_step, tracker
from planted import two_joints

import flexarm
from flexarm.arm.sensor import Sensor
from flexarm.comparison.aligned_record import simulate_record
from flexarm.diagnosis.result import Diagnosis
from flexarm.effects.joint_compliance import JointCompliance
from flexarm.measurement import ClockError, Registration
from flexarm.named_effects import Alternative, Estimate, NamedEffect, Nuisance, Refined, Rejected, Stage
from flexarm.record import Clock, Frame, Signal
from flexarm.residual_analysis.localisation import Localisation, localise

STIFFNESS, TRACKER = 1.4e5, 5e-5


def nominal() -> flexarm.Arm:
    """A tube with a load on a rigid hinge."""
    known = {"links.rod.material.youngs_modulus": 0.01, "points.tip.position_m": 5e-4}
    return crane(uncertainty=known)


def with_spring(stiffness: float = STIFFNESS) -> flexarm.Arm:
    """The same with a spring in the hinge."""
    return nominal().with_effect(JointCompliance(at="hinge", stiffness=stiffness, damping=280.0))


SENSORS = [
    Sensor(
        name="hinge",
        quantity="joint_angle",
        joint="hinge",
        rate_hz=100,
        noise_std=1.5e-6,
        clock="controller",
    ),
    tracker("tip", noise=TRACKER),
]


@cache
def record(seed: int, rate: float = 0.15, step: float = 0.01) -> flexarm.Record:
    """A swing of 12 s as a late, displaced tracker sees it; steps of 10 ms err by 0.4 of its noise."""
    t = np.arange(0, 12, 0.01)
    angle = 0.7 * np.sin(2 * np.pi * rate * t) * smooth_step(t / 3)
    run = flexarm.simulate(with_spring(), flexarm.Drive.from_samples(t, {"hinge": angle}), step=step)
    return flexarm.measure(
        run,
        SENSORS,
        np.random.default_rng(seed),
        drive=["hinge"],
        clocks={"controller": Clock(), "tracker": Clock(sigma=2e-3)},
        frames={"tracker": Frame(translation=1e-3, rotation=5e-4)},
        clock_errors={"tracker": ClockError(delay=1e-3)},
        registrations={"tracker": Registration(translation=np.array([3e-4, 0.0, -5e-4]))},
        description=f"swing at {rate} Hz",
    )


@cache
def comparisons() -> tuple[dict[str, flexarm.Comparison], dict[str, flexarm.Comparison]]:
    """Two records of training and one held out, beside the nominal and the updated model."""
    records = {"slow": record(1), "fast": record(2, 0.25), "other": record(3, 0.2)}
    return tuple(
        {name: flexarm.compare(each, measured, step=0.01) for name, measured in records.items()}
        for each in (nominal(), with_spring())
    )


@cache
def located() -> tuple[Localisation, Localisation]:
    """Where the gap of training is, with the nominal and the updated model."""
    records = {"slow": record(1), "fast": record(2, 0.25)}
    return tuple(
        localise({name: simulate_record(each, measured, step=0.01) for name, measured in records.items()})
        for each in (nominal(), with_spring())
    )


def estimate(name: str, value: float, unit: str, std: float | None = None) -> Estimate:
    """A parameter with the interval of a normal distribution."""
    sigma = 0.01 * abs(value) if std is None else std
    return Estimate(name, value, sigma, value - 1.645 * sigma, value + 1.645 * sigma, unit)


def of_effects(**changes: object) -> Diagnosis:
    """The spring was found, with all that such a diagnosis may say."""
    before, after = comparisons()
    named = NamedEffect(
        "joint_compliance",
        "hinge",
        0.93,
        (estimate("stiffness", STIFFNESS, "N m/rad"), estimate("damping", 280.0, "N m s/rad")),
        (Alternative("link_stiffness", "rod", 0.07),),
        "The gap follows the torque of the hinge, and the first mode falls with it.",
    )
    fields: dict[str, object] = {
        "verdict": "effects",
        "arm": nominal(),
        "updated": with_spring(),
        "effects": (named,),
        "nuisances": (
            Nuisance("time_delay", "tracker", (estimate("delay", 1e-3, "s"),)),
            Nuisance(
                "frame_registration",
                "tracker",
                (estimate("rotation.y", 2e-4, "rad"), Estimate.normal("rotation.x", 0.0, 5e-4, "rad")),
                ("rotation.x",),
            ),
        ),
        "refined": (Refined("links.rod.material.youngs_modulus", 2.08e11, 1e9, 2.1e11, "Pa"),),
        "rejected": (
            Rejected("base_compliance", "base", -812.4, "its optimum lies outside of what is plausible"),
            Rejected("payload_mass", "load", -35_000.0, "explains a third of the gap"),
        ),
        "where": (
            {
                "signal": "tip",
                "direction": "tangential",
                "when": "torque negative",
                "band_hz": [0.0, 1.2],
                "rms": 5.4e-3,
                "noise_rms": TRACKER,
            },
        ),
        "before": before,
        "after": after,
        "training": ("slow", "fast"),
        "held_out": ("other",),
        "hold_out_kind": "interpolation",
        "main_signal": "tip",
        "located": located()[0],
        "located_after": located()[1],
        "stages": tuple(
            Stage(label, {name: each.signals["tip"].rms["total"] for name, each in side.items()})
            for label, side in (("nominal", before), ("joint_compliance at hinge", after))
        ),
        "constancy": (
            {
                "effect": "joint_compliance",
                "at": "hinge",
                "parameter": "stiffness",
                "unit": "N m/rad",
                "values": {"slow": (1.39e5, 2e3), "fast": (1.41e5, 1e3)},
                "q": 0.8,
                "p_value": 0.37,
                "constant": True,
                "moves_with": "",
            },
        ),
        "remarks": ("The rotation of the tracker about x is not determined by these data.",),
        "next_experiment": "A second payload of 5 kg would part spring and tube by 140 (ln Bayes factor).",
        "provenance": {"version": "1.0", "git": "abc", "inputs_sha256": {}, "seed": 0, "seconds": 12.0},
    }
    return Diagnosis(**{**fields, **changes})  # type: ignore[arg-type]


def lean(**changes: object) -> Diagnosis:
    """The spring found in one record, with few figures."""
    before, after = comparisons()
    one = {"before": {"other": before["other"]}, "after": {"other": after["other"]}, "training": ("other",)}
    few: dict[str, object] = {"held_out": (), "stages": (), "constancy": (), "rejected": (), "located": None}
    return of_effects(**{**one, **few, **changes})


def adequate() -> Diagnosis:
    """Nothing is missing: the model with the spring against itself, a modulus refined."""
    _, after = comparisons()
    return of_effects(
        verdict="adequate",
        arm=with_spring(),
        effects=(),
        rejected=(),
        where=(),
        before=after,
        located=located()[1],
        stages=(),
        constancy=(),
        next_experiment="",
    )


def unexplained() -> Diagnosis:
    """A rest that nothing explains, and a partial name."""
    return of_effects(
        verdict="unexplained",
        remainder="What remains oscillates at 0.7 Hz with 2.1 mm rms, whatever the arm does.",
        rejected=(),
    )


def unusable() -> Diagnosis:
    """A tip of the wrong sign; nothing was compared."""
    fault = NamedEffect("sign_error", "tip", 0.99, (), (), "Channel tip_x_m runs against the motion.")
    return Diagnosis(
        "unusable", nominal(), nominal(), (fault,), training=("slow",), provenance={"seed": 3, "seconds": 0.4}
    )


ALL = {"effects": of_effects, "adequate": adequate, "unexplained": unexplained, "unusable": unusable}
"""A diagnosis of each verdict."""


@cache
def of_poses() -> Diagnosis:
    """A spring in the elbow, found in poses that were measured twice each."""
    rng, count = np.random.default_rng(4), 30
    model = two_joints()
    updated = model.with_effect(JointCompliance(at="elbow", stiffness=1e5))
    poses = np.array([f"p{i}" for i in range(count)])
    drives = [
        Signal(
            name=joint,
            quantity="joint_angle",
            joint=joint,
            side="motor",
            pose=poses,
            values=rng.uniform(-1, 1, count),
        )
        for joint in ("shoulder", "elbow")
    ]
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        axes=("x", "z"),
        pose=np.tile(poses, 2),
        values=np.zeros((2 * count, 2)),
        noise_std=TRACKER,
    )
    empty = flexarm.Record(signals=[*drives, tip], drive=("shoulder", "elbow"), kind="static")
    true = simulate_record(updated, empty, align=False)
    seen = true.simulated.predicted(tip, true.aligned.placement) + TRACKER * rng.standard_normal(
        (2 * count, 2)
    )
    measured = empty.replace(signals=[*drives, tip.replace(values=seen)])
    named = NamedEffect("joint_compliance", "elbow", 0.98, (estimate("stiffness", 1e5, "N m/rad"),))
    return Diagnosis(
        "effects",
        model,
        updated,
        (named,),
        before={"poses": flexarm.compare(model, measured)},
        after={"poses": flexarm.compare(updated, measured)},
        training=("poses",),
        main_signal="tip",
        located=localise({"poses": simulate_record(model, measured)}),
        located_after=localise({"poses": simulate_record(updated, measured)}),
    )
