"""Flexible robot arms by finite element multibody simulation, beside what was measured on them."""

from __future__ import annotations

TYPE_CHECKING = False  # typing would take longer than the rest of this module
if TYPE_CHECKING:
    from typing import Any

    from flexarm.arm import Arm
    from flexarm.calibration.policy import CalibrationPolicy
    from flexarm.calibration.result import Calibration
    from flexarm.calibration.workflow import calibrate
    from flexarm.campaigns.campaign import Campaign, campaign
    from flexarm.comparison.compare import compare
    from flexarm.comparison.comparison import Comparison
    from flexarm.comparison.frequency_response import compare_responses
    from flexarm.configuration import config, show_config
    from flexarm.diagnosis.design.plan_result import Plan
    from flexarm.diagnosis.design.planning import plan
    from flexarm.diagnosis.policy import SelectionPolicy
    from flexarm.diagnosis.result import Diagnosis
    from flexarm.diagnosis.workflow import diagnose
    from flexarm.drive import Drive, JointDrive
    from flexarm.errors import InvalidFile, InvalidParameter, NotConverged
    from flexarm.export import export_mjcf, export_part, export_urdf
    from flexarm.importing import import_record
    from flexarm.linear import LinearModel
    from flexarm.linear.linearise import linearise
    from flexarm.measurement.measure import measure
    from flexarm.modal import Modes, modes
    from flexarm.record import Record, Signal
    from flexarm.reduction import InterfaceSet, reduce_mesh
    from flexarm.sensitivity import Sensitivities
    from flexarm.simulation.simulate import simulate
    from flexarm.simulation.simulate_all import simulate_all
    from flexarm.simulation.simulation import Simulation
    from flexarm.solids import SolidMesh, read_mesh
    from flexarm.statics.static import static
    from flexarm.statics.statics import Statics
    from flexarm.stepping import State, Stepper
    from flexarm.superelement import SuperElement
    from flexarm.superelement.foreign import accept_matrices

# Public name and the module that defines it, imported when first used: `import flexarm` stays light.
# A public name must not also be the name of a module, which would take its place once imported.
_EXPORTS = {
    "Arm": "flexarm.arm",
    "Calibration": "flexarm.calibration.result",
    "CalibrationPolicy": "flexarm.calibration.policy",
    "Campaign": "flexarm.campaigns.campaign",
    "Comparison": "flexarm.comparison",
    "Diagnosis": "flexarm.diagnosis.result",
    "Drive": "flexarm.drive",
    "InterfaceSet": "flexarm.reduction",
    "InvalidFile": "flexarm.errors",
    "InvalidParameter": "flexarm.errors",
    "JointDrive": "flexarm.drive",
    "LinearModel": "flexarm.linear",
    "Modes": "flexarm.modal",
    "NotConverged": "flexarm.errors",
    "Plan": "flexarm.diagnosis.design.plan_result",
    "Record": "flexarm.record",
    "SelectionPolicy": "flexarm.diagnosis.policy",
    "Sensitivities": "flexarm.sensitivity",
    "Signal": "flexarm.record",
    "Simulation": "flexarm.simulation",
    "SolidMesh": "flexarm.solids",
    "State": "flexarm.stepping",
    "Statics": "flexarm.statics",
    "Stepper": "flexarm.stepping",
    "SuperElement": "flexarm.superelement",
    "accept_matrices": "flexarm.superelement.foreign",
    "calibrate": "flexarm.calibration.workflow",
    "campaign": "flexarm.campaigns.campaign",
    "compare": "flexarm.comparison",
    "compare_responses": "flexarm.comparison",
    "config": "flexarm.configuration",
    "diagnose": "flexarm.diagnosis.workflow",
    "export_mjcf": "flexarm.export",
    "export_part": "flexarm.export",
    "export_urdf": "flexarm.export",
    "import_record": "flexarm.importing",
    "linearise": "flexarm.linear",
    "measure": "flexarm.measurement",
    "modes": "flexarm.modal",
    "plan": "flexarm.diagnosis.design.planning",
    "read_mesh": "flexarm.solids",
    "reduce_mesh": "flexarm.reduction",
    "show_config": "flexarm.configuration",
    "simulate": "flexarm.simulation",
    "simulate_all": "flexarm.simulation.simulate_all",
    "static": "flexarm.statics",
}

__all__ = [
    "Arm",
    "Calibration",
    "CalibrationPolicy",
    "Campaign",
    "Comparison",
    "Diagnosis",
    "Drive",
    "InterfaceSet",
    "InvalidFile",
    "InvalidParameter",
    "JointDrive",
    "LinearModel",
    "Modes",
    "NotConverged",
    "Plan",
    "Record",
    "SelectionPolicy",
    "Sensitivities",
    "Signal",
    "Simulation",
    "SolidMesh",
    "State",
    "Statics",
    "Stepper",
    "SuperElement",
    "accept_matrices",
    "calibrate",
    "campaign",
    "compare",
    "compare_responses",
    "config",
    "diagnose",
    "export_mjcf",
    "export_part",
    "export_urdf",
    "import_record",
    "linearise",
    "measure",
    "modes",
    "plan",
    "read_mesh",
    "reduce_mesh",
    "show_config",
    "simulate",
    "simulate_all",
    "static",
]


def __getattr__(name: str) -> Any:
    from importlib import import_module

    if name == "__version__":
        return import_module("flexarm.configuration").version()
    if name in _EXPORTS:
        value = getattr(import_module(_EXPORTS[name]), name)
        globals()[name] = value
        return value
    raise AttributeError(f"module 'flexarm' has no attribute '{name}'")


def __dir__() -> list[str]:
    return sorted({*globals(), *_EXPORTS, "__version__"})
