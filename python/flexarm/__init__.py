"""Flexible robot arms by finite element multibody simulation, compared with measurements."""

from __future__ import annotations

TYPE_CHECKING = False  # typing would take longer than the rest of this module
if TYPE_CHECKING:
    from typing import Any

    from flexarm.arm import Arm as Arm
    from flexarm.arm import Sensor as Sensor
    from flexarm.calibration.policy import CalibrationPolicy as CalibrationPolicy
    from flexarm.calibration.result import Calibration as Calibration
    from flexarm.calibration.workflow import calibrate as calibrate
    from flexarm.campaigns.campaign import Campaign as Campaign
    from flexarm.campaigns.run_study import campaign as campaign
    from flexarm.comparison.compare import compare as compare
    from flexarm.comparison.comparison import Comparison as Comparison
    from flexarm.comparison.frequency_response import compare_responses as compare_responses
    from flexarm.configuration import config as config
    from flexarm.configuration import show_config as show_config
    from flexarm.diagnosis.design.plan_result import Plan as Plan
    from flexarm.diagnosis.design.planning import plan as plan
    from flexarm.diagnosis.policy import SelectionPolicy as SelectionPolicy
    from flexarm.diagnosis.result import Diagnosis as Diagnosis
    from flexarm.diagnosis.workflow import diagnose as diagnose
    from flexarm.drive import Drive as Drive
    from flexarm.drive import JointDrive as JointDrive
    from flexarm.errors import InvalidFile as InvalidFile
    from flexarm.errors import InvalidParameter as InvalidParameter
    from flexarm.errors import NotConverged as NotConverged
    from flexarm.export import export_mjcf as export_mjcf
    from flexarm.export import export_part as export_part
    from flexarm.export import export_urdf as export_urdf
    from flexarm.importing import import_record as import_record
    from flexarm.linear import LinearModel as LinearModel
    from flexarm.linear.linearise import linearise as linearise
    from flexarm.measurement.measure import measure as measure
    from flexarm.modal import Modes as Modes
    from flexarm.modal import modes as modes
    from flexarm.opening import load as load
    from flexarm.record import BaseStand as BaseStand
    from flexarm.record import CarriedPayload as CarriedPayload
    from flexarm.record import Clock as Clock
    from flexarm.record import DrawnLink as DrawnLink
    from flexarm.record import Frame as Frame
    from flexarm.record import Record as Record
    from flexarm.record import Signal as Signal
    from flexarm.reduction import InterfaceSet as InterfaceSet
    from flexarm.reduction import reduce_mesh as reduce_mesh
    from flexarm.sensitivity import Sensitivities as Sensitivities
    from flexarm.simulation.simulate import simulate as simulate
    from flexarm.simulation.simulate_all import simulate_all as simulate_all
    from flexarm.simulation.simulation import Simulation as Simulation
    from flexarm.solids import SolidMesh as SolidMesh
    from flexarm.solids import read_mesh as read_mesh
    from flexarm.statics.static import static as static
    from flexarm.statics.statics import Statics as Statics
    from flexarm.stepping import State as State
    from flexarm.stepping import Stepper as Stepper
    from flexarm.superelement import SuperElement as SuperElement
    from flexarm.superelement.foreign import accept_matrices as accept_matrices

# Public names by the module that defines them, imported when first used: `import flexarm` stays light.
# A public name must not also be the name of a module, which would take its place once imported.
_NAMES = {
    "flexarm.arm": "Arm Sensor",
    "flexarm.calibration.policy": "CalibrationPolicy",
    "flexarm.calibration.result": "Calibration",
    "flexarm.calibration.workflow": "calibrate",
    "flexarm.campaigns.campaign": "Campaign",
    "flexarm.campaigns.run_study": "campaign",
    "flexarm.comparison": "Comparison compare compare_responses",
    "flexarm.configuration": "config show_config",
    "flexarm.diagnosis.design.plan_result": "Plan",
    "flexarm.diagnosis.design.planning": "plan",
    "flexarm.diagnosis.policy": "SelectionPolicy",
    "flexarm.diagnosis.result": "Diagnosis",
    "flexarm.diagnosis.workflow": "diagnose",
    "flexarm.drive": "Drive JointDrive",
    "flexarm.errors": "InvalidFile InvalidParameter NotConverged",
    "flexarm.export": "export_mjcf export_part export_urdf",
    "flexarm.importing": "import_record",
    "flexarm.linear": "LinearModel linearise",
    "flexarm.measurement": "measure",
    "flexarm.modal": "Modes modes",
    "flexarm.opening": "load",
    "flexarm.record": "BaseStand CarriedPayload Clock DrawnLink Frame Record Signal",
    "flexarm.reduction": "InterfaceSet reduce_mesh",
    "flexarm.sensitivity": "Sensitivities",
    "flexarm.simulation": "Simulation simulate",
    "flexarm.simulation.simulate_all": "simulate_all",
    "flexarm.solids": "SolidMesh read_mesh",
    "flexarm.statics": "Statics static",
    "flexarm.stepping": "State Stepper",
    "flexarm.superelement": "SuperElement",
    "flexarm.superelement.foreign": "accept_matrices",
}
_EXPORTS = {name: module for module, names in _NAMES.items() for name in names.split()}

_MODULES = ("diagnosis", "effects")
"""Public modules."""

__all__ = sorted(_EXPORTS)


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name == "__version__":
        return import_module("flexarm.configuration").version()
    if name in _MODULES:
        return import_module(f"flexarm.{name}")
    if name in _EXPORTS:
        value = getattr(import_module(_EXPORTS[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'flexarm' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted(
        {*_EXPORTS, *_MODULES, "__version__", *(name for name in globals() if name.startswith("__"))}
    )
