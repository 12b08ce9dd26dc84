"""Models of a reproduction: the arm on its solid hinge, the bench, variants with parts rigid or softer."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from flexarm.arm import Arm
from flexarm.arm.link import Beam
from flexarm.effects import CoulombFriction, JointCompliance, ViscousFriction
from flexarm.mockup import (
    HingeDesign,
    SolidHinge,
    bench_arm,
    bench_design,
    build_hinge,
    mock_up,
    model,
    solid_arm,
)
from flexarm.threads import at_once

RIGID = 1e-4
"""Factor on the compliance of a part that is made rigid: a ten-thousandth of its deflection is left."""
HINGE = ("housing", "reducer", "hub")
CONTRIBUTORS = (*HINGE, "tube")
"""Parts that bend."""
RUNS = {
    "fe": "finite elements, driven by the encoder",
    "sine": "finite elements, driven by the pure sine",
    "friction": "finite elements with the bearing's friction",
    "printed": "finite elements, section area as printed",
}
"""Finite-element runs of a study and their descriptions."""


@dataclass(frozen=True)
class Models:
    """The hinge from solids and the arms that stand on it."""

    hinge: SolidHinge
    """Of the finite-element model."""
    bench_hinge: SolidHinge
    """Of the virtual mock-up."""
    scratch: Path
    """Where files of variants go."""

    @classmethod
    def build(cls, folder: Path, tell: Callable[[str], None]) -> Models:
        """Mesh and reduce both hinges into `folder`."""
        tell("solid parts of two hinges")
        designs = {"hinge": HingeDesign.from_toml(), "bench": bench_design()}
        hinge, bench = at_once(lambda name: build_hinge(folder / name, designs[name]), designs, 2)
        return cls(hinge, bench, folder)

    @cached_property
    def fe(self) -> Arm:
        """The finite-element model."""
        return solid_arm(self.hinge)

    @cached_property
    def bench(self) -> Arm:
        """The virtual mock-up."""
        return bench_arm(self.bench_hinge, mock_up())

    @cached_property
    def lumped(self) -> Arm:
        """One beam of 3 m on a spring as stiff as the solid hinge, as equations (1) and (2) have it."""
        stiffness = self.hinge.stiffness
        spring = JointCompliance(
            at="hinge", stiffness=stiffness, damping=stiffness * self.hinge.design.damping_time.reducer
        )
        return model().with_effect(spring)

    def runs(self) -> dict[str, Arm]:
        """Return the model of each run in `RUNS`."""
        rubbing = model()
        for effect in mock_up().effects:
            if isinstance(effect, CoulombFriction | ViscousFriction):
                rubbing = rubbing.with_effect(effect)
        return {
            "fe": self.fe,
            "sine": self.fe,
            "friction": bench_arm(self.hinge, rubbing),
            "printed": solid_arm(self.hinge, model("printed")),
        }

    def scaled(self, factors: Mapping[str, float]) -> Arm:
        """Return the model with the compliance of some of its `CONTRIBUTORS` multiplied."""
        tag = "-".join(f"{name}x{factor:.6g}" for name, factor in factors.items())
        of_hinge = {name: factor for name, factor in factors.items() if name in HINGE}
        hinge = self.hinge.with_compliance(of_hinge, self.scratch / tag) if of_hinge else self.hinge
        return with_modulus(solid_arm(hinge), 1 / factors.get("tube", 1.0))

    def rigid(self, *parts: str) -> Arm:
        """Return the model with some of its `CONTRIBUTORS` rigid."""
        return self.scaled(dict.fromkeys(parts, RIGID))


def with_modulus(arm: Arm, scale: float) -> Arm:
    """Return the model with Young's modulus of its tube times a factor."""
    tube = tube_of(arm)
    steel = tube.material.replace(youngs_modulus=scale * tube.material.youngs_modulus)
    changed = tube.replace(material=steel)
    return arm.replace(links=tuple(changed if link.name == "tube" else link for link in arm.links))


def tube_of(arm: Arm) -> Beam:
    """Return the tube of the model."""
    tube = arm.link("tube")
    assert isinstance(tube, Beam)
    return tube
