"""The benchmark arm in flexarm, by its public Python functions, everything recorded at every step."""

import time
from functools import cache

import numpy as np
import problem

import flexarm
from flexarm import _core, simulate  # by name: its import is no part of a run


def _section():
    return {
        "shape": "general",
        "area": problem.AREA,
        "second_moment": problem.SECOND_MOMENT,
        "torsion_constant": 2 * problem.SECOND_MOMENT,
        "shear_area": problem.SHEAR_FACTOR * problem.AREA,
    }


def beam(name, length, elements, theory="timoshenko"):
    return {
        "name": name,
        "type": "beam",
        "end": [0, 0, -length],
        "section": _section(),
        "material": {
            "youngs_modulus": problem.YOUNGS_MODULUS,
            "poisson_ratio": problem.POISSON_RATIO,
            "density": problem.DENSITY,
        },
        "theory": theory,
        "elements": elements,
    }


def _hinge(name, parent, child):
    """A hinge whose growing angle swings a hanging link towards +x."""
    at = {} if parent == "base" else {"at": "end"}
    return {"name": name, "type": "revolute", "parent": parent, "child": child, "axis": [0, -1, 0], **at}


def swinging_arm(elements, theory="timoshenko"):
    """The arm of the swing benchmark, hanging at angle zero."""
    tip = [0, 0, -problem.LENGTH]
    return flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "name": "swing",
            "gravity": [0, 0, -problem.GRAVITY],
            "joints": [_hinge("hinge", "base", "rod")],
            "links": [beam("rod", problem.LENGTH, elements, theory)],
            "payloads": [{"name": "load", "link": "rod", "position": tip, "mass": problem.PAYLOAD}],
            "points": [{"name": "tip", "link": "rod", "position": tip}],
            "effects": [{"name": "joint_compliance", "at": "hinge", "stiffness": problem.SPRING}],
        }
    )


def chain(joints, elements, length=0.3):
    """A hanging chain of short beams [m], a hinge with a spring before each; its first motor swings."""
    links = [f"link_{k}" for k in range(joints)]
    hinges = [f"hinge_{k}" for k in range(joints)]
    return flexarm.Arm.from_dict(
        {
            "format": "flexarm-arm/1",
            "name": "chain",
            "gravity": [0, 0, -problem.GRAVITY],
            "joints": [_hinge(hinges[k], links[k - 1] if k else "base", links[k]) for k in range(joints)],
            "links": [beam(link, length, elements) for link in links],
            "points": [{"name": "tip", "link": links[-1], "position": [0, 0, -length]}],
            "effects": [{"name": "joint_compliance", "at": h, "stiffness": problem.SPRING} for h in hinges],
        }
    )


@cache
def drive(joint, end, scale=1.0):
    """The swing as a spline through samples every 10 ms, whose own error is below 1e-9 rad."""
    t = np.linspace(0, end, round(end / 0.01) + 1)
    return flexarm.Drive.from_samples(t, {joint: scale * problem.angle(t)})


def timed(arm, motion, step, end, **options):
    """A run, and its CPU seconds: assembly, equilibrium, steps and results, all of `simulate`."""
    began = time.process_time()
    run = simulate(arm, motion, step=step, end=end, **options)
    return run, time.process_time() - began


def solve(case):
    """One run of the swing; `case` holds elements, steps, end and, where they are not flexarm's own choice,
    theory and dimension."""
    arm = swinging_arm(case["elements"], case.get("theory", "timoshenko"))
    options = {key: case[key] for key in ("dimension",) if key in case}
    run, seconds = timed(
        arm, drive("hinge", case["end"]), case["end"] / case["steps"], case["end"], **options
    )
    across, down = run.position[:, 0, 0], -run.position[:, 0, 2]
    return {
        "cpu": seconds,
        "offsets": problem.offsets_at_instants(run.time, down, across),
        "iterations": run.solver["iterations"] / run.solver["steps"],
    }


def version():
    """Of flexarm and its core."""
    core = _core.build_info()
    return {"flexarm": core.version, "git": core.git, "solver": core.solver, "compiler": core.compiler}
