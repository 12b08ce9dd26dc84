"""From the model, which is data, through the machine that effects patch, to the core's assembled system."""

from flexarm.assembly.core import assemble, core_arm, joint_values, loops_of, point_loads, rigid_values
from flexarm.assembly.machine import Machine, machine_of

__all__ = [
    "Machine",
    "assemble",
    "core_arm",
    "joint_values",
    "loops_of",
    "machine_of",
    "point_loads",
    "rigid_values",
]
