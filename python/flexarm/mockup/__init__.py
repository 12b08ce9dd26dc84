"""The virtual mock-up: a simulated bench whose outcome is a record, and the models that are compared with it.

The authors' data are not public. What is called a virtual measurement here comes from `mockup.toml`, a model
richer than `model.toml`, and from sensors with noise, rate and delay. In these two the hinge is a spring;
`build_hinge` makes it from solid parts, and `solid_arm` and `bench_arm` put it under the tube.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

from flexarm.mockup.arms import PARAMETER_SETS, mock_up, model
from flexarm.mockup.arms import bench_arm as bench_arm
from flexarm.mockup.arms import solid_arm as solid_arm
from flexarm.mockup.experiment import Experiment, virtual_measurement

if TYPE_CHECKING:
    from flexarm.mockup.design import HingeDesign as HingeDesign
    from flexarm.mockup.design import bench_design as bench_design
    from flexarm.mockup.hinge import SolidHinge as SolidHinge
    from flexarm.mockup.hinge import build_hinge as build_hinge

_SOLID = {
    "HingeDesign": "design",
    "SolidHinge": "hinge",
    "bench_arm": "arms",
    "bench_design": "design",
    "build_hinge": "hinge",
    "solid_arm": "arms",
}
"""Names that are looked up when they are asked for: they need meshes and the reduction."""

__all__ = ["PARAMETER_SETS", "Experiment", "mock_up", "model", "virtual_measurement", *_SOLID]


def __getattr__(name: str) -> Any:
    if name not in _SOLID:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"flexarm.mockup.{_SOLID[name]}"), name)
