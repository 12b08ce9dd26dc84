"""The paper's 133 s with a hinge of solid parts: three rings as super-elements, beside the same arm of beams.

    base - ring - ring - hinge with spring - ring - tube of four segments - payload

The rings (ring.py, their axes along the hinge's) are reduced to both faces and some inner modes; in the arm
of beams each is one beam of the same section. One process a run: python arm_of_parts.py '{"modes": 20}',
without modes the arm of beams.
"""

import json
import math
import sys
import tempfile
from pathlib import Path

import numpy as np
import problem
import reduce_flexarm
import ring
from solve_flexarm import beam, drive, timed

import flexarm

QUARTER = math.pi / 2
RINGS = ("housing", "reducer", "hub")
END, STEPS, SEGMENTS = 133.0, 66500, 4


def super_elements(folder, modes, size="10k"):
    """The ring's file, named by three links."""
    part = ring.mesh(size)
    reduced = reduce_flexarm.reduce(part, *reduce_flexarm.assemble(part, 1), modes)
    element = flexarm.SuperElement(
        name="ring",
        interfaces=tuple(ring.FACES),
        positions=np.array(list(ring.FACES.values())),
        rotations=np.array([np.eye(3)] * len(ring.FACES)),
        stiffness=reduced.stiffness,
        mass=reduced.mass,
        damping=np.zeros_like(reduced.mass),
        frequency_hz=reduced.frequency_hz,
        inertia_load=reduced.inertia_load,
    )
    file = Path(folder) / "ring.nc"
    element.save(file)
    return [{"name": name, "type": "superelement", "file": str(file)} for name in RINGS]


def beams():
    """Each ring as one beam."""
    tube = {"shape": "tube", "outer_diameter": 2 * ring.OUTER, "thickness": ring.OUTER - ring.INNER}
    shared = {
        "type": "beam",
        "end": [0, 0, ring.HEIGHT],
        "section": tube,
        "material": ring.STEEL,
        "elements": 1,
    }
    return [{"name": name, **shared} for name in RINGS]


def joint(name, parent, child, of_parts, kind="fixed", **more):
    """A joint from the far face of a ring (or the base) to the near face of the next (or the rod)."""
    if of_parts:
        parent = f"{parent}:top" if parent in RINGS else parent
        child = f"{child}:bottom" if child in RINGS else child
    elif parent in RINGS:
        more["at"] = "end"
    return {"name": name, "type": kind, "parent": parent, "child": child, **more}


def arm(rings):
    """The arm as a model; it hangs along -z, the rings' axes lie along -y."""
    of_parts = rings[0]["type"] == "superelement"
    tip = [0, 0, -problem.LENGTH]
    over, back = {"rpy": [QUARTER, 0, 0]}, {"rpy": [-QUARTER, 0, 0]}
    return flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "name": "solid-hinge",
            "gravity": [0, 0, -problem.GRAVITY],
            "links": [*rings, beam("rod", problem.LENGTH, SEGMENTS)],
            "joints": [
                joint("clamp", "base", "housing", of_parts, origin=over),
                joint("bolts", "housing", "reducer", of_parts),
                joint("hinge", "reducer", "hub", of_parts, "revolute", axis=[0, 0, 1]),
                joint("flange", "hub", "rod", of_parts, origin=back),
            ],
            "payloads": [{"name": "load", "link": "rod", "position": tip, "mass": problem.PAYLOAD}],
            "points": [{"name": "tip", "link": "rod", "position": tip}],
            "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": problem.SPRING}],
        }
    )


def run(order):
    """CPU seconds of the run, the tip at the end of the swing's reference instants, iterations a step."""
    with tempfile.TemporaryDirectory() as folder:
        rings = super_elements(folder, order["modes"]) if "modes" in order else beams()
        model = arm(rings)
        result, seconds = timed(model, drive("hinge", END), END / STEPS, END)
    across, down = result.position[:, 0, 0], -result.position[:, 0, 2]
    return {
        "cpu": seconds,
        "offsets": problem.offsets_at_instants(result.time, down, across),
        "iterations": result.solver["iterations"] / result.solver["steps"],
        "version": flexarm.__version__,
    }


if __name__ == "__main__":
    print(json.dumps(run(json.loads(sys.argv[1]))))
