"""Random arms whose every run obeys what mechanics says of all of them, whatever their numbers.

Checked are weight, inverse dynamics of rigid chains, invariance to a turn and a shift of the whole, balance
of energy, rates against differences, and convergence in the time step of positions and torques.
"""

from __future__ import annotations

import random
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from rigid_chain import Body, RigidChain
from scipy.spatial.transform import Rotation

from torture.campaign import Campaign
from torture.outcome import Failure
from torture.sandbox import Case, Step

MATERIALS = (
    {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850.0},
    {"youngs_modulus": 70e9, "poisson_ratio": 0.33, "density": 2700.0},
)
EXACT = 1e-9
"""Rounding that sums over an arm may leave, of the largest value."""
MOTION = 1e-6
"""Turned and shifted runs differ by the tolerance of the steps' iterations, which adds up over a run."""
ORDER, LARGEST = {False: 1.6, True: 1.2}, {False: 0.01, True: 0.03}
"""Least observed order between 2 and 1 ms, and largest error of a torque at 2 ms, of the largest torque; by
whether the arm is flexible: steps of 2 ms do not resolve the higher modes of a short beam."""
REST = 0.2
"""How long a run goes on after its motion [s]: what rings is seen there."""
NOTHING = {False: 1e-3, True: 1e-2}
"""An error this small has no order to observe: samples of the drive are 1 ms apart, and in flexible arms
modes that the step does not resolve go on ringing."""


@dataclass
class Made:
    """An arm, where its joints start, and where they go within `seconds`."""

    tables: dict[str, Any]
    start: dict[str, float]
    end: dict[str, float]
    seconds: float
    chain: RigidChain | None
    flexible: bool
    smooth: bool


def vector(rng: random.Random, size: float) -> list[float]:
    return [rng.uniform(-size, size) for _ in range(3)]


def unit(rng: random.Random) -> list[float]:
    v = np.array([rng.gauss(0, 1) for _ in range(3)])
    return (v / np.linalg.norm(v)).tolist()


def inertia(rng: random.Random, mass: float) -> list[float]:
    """Of a block with sides of centimetres to decimetres, turned at random: Ixx, Iyy, Izz, Ixy, Ixz, Iyz."""
    a, b, c = (rng.uniform(0.03, 0.3) ** 2 for _ in range(3))
    R = Rotation.from_rotvec(vector(rng, 2.0)).as_matrix()
    J = R @ np.diag([b + c, a + c, a + b]) @ R.T * mass / 12
    return [float(J[i]) for i in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))]


def beam(rng: random.Random) -> dict[str, Any]:
    diameter = rng.uniform(0.04, 0.1)
    section = rng.choice(
        (
            {"shape": "tube", "outer_diameter": diameter, "thickness": rng.uniform(2e-3, 5e-3)},
            {"shape": "round", "diameter": diameter / 2},
            {"shape": "rectangle", "width": diameter, "height": diameter * rng.uniform(0.4, 0.9)},
        )
    )
    end = (rng.uniform(0.2, 0.8) * np.array(unit(rng))).tolist()
    up = np.cross(end, unit(rng)).tolist()
    material, theory = rng.choice(MATERIALS), rng.choice(("timoshenko", "euler-bernoulli"))
    shape = {"section": section, "material": material, "theory": theory, "up": up}
    return {"type": "beam", "end": end, "elements": rng.randint(1, 3), "damping_ratio": 0.02, **shape}


def joint_effects(rng: random.Random, name: str, slides: bool) -> list[dict[str, Any]]:
    """Smooth effects of a drive train."""
    k = 10 ** (rng.uniform(5, 6) if slides else rng.uniform(4, 5.5))
    found = [{"name": "joint_compliance", "at": name, "stiffness": k, "damping": 2e-3 * k}]
    more = (
        {"name": "joint_stiffening", "at": name, "cubic_stiffness": k * 10},
        {"name": "viscous_friction", "at": name, "coefficient": rng.uniform(0, 5)},
        {"name": "cable_torque", "at": name, "stiffness": rng.uniform(0, 20), "rest_angle": 0.2},
        {"name": "motor_friction", "at": name, "viscous": 2.0},
    )
    return found + [effect for effect in more if rng.random() < 0.25]


def made(rng: random.Random, kind: str) -> Made:
    """A random arm: "rigid" (a chain, no springs), "sprung" (a tree) or "flexible" (beams as well)."""
    joints, links, effects, payloads, points, bodies = [], [], [], [], [], []
    for i in range(rng.randint(1, 5)):
        before = len(links) - 1 if kind == "rigid" or rng.random() < 0.8 else rng.randrange(-1, len(links))
        slides = rng.random() < 0.2
        fixed = kind != "rigid" and i > 0 and rng.random() < 0.15
        joint: dict[str, Any] = {
            "name": f"joint{i}",
            "type": "fixed" if fixed else "prismatic" if slides else "revolute",
            "parent": links[before]["name"] if before >= 0 else "base",
            "child": f"link{i}",
            "origin": {"xyz": vector(rng, 0.4), "rpy": [0, 0, 0] if kind == "rigid" else vector(rng, 1.5)},
        }
        if before >= 0 and links[before]["type"] == "beam":
            joint |= {"at": "end", "origin": {"xyz": vector(rng, 0.05), "rpy": vector(rng, 1.5)}}
        if not fixed:
            joint["axis"] = unit(rng)
            if kind != "rigid":
                effects += joint_effects(rng, joint["name"], slides) if rng.random() < 0.7 else []
                joint |= {"gear_ratio": rng.choice((1, -50, 120)), "rotor_inertia": rng.choice((0, 1e-4))}
        mass = rng.uniform(0.3, 8)
        link = {"type": "rigid", "mass": mass, "com": vector(rng, 0.2), "inertia": inertia(rng, mass)}
        if kind == "flexible" and (i == 0 or rng.random() < 0.6):
            link = beam(rng)
        place = link.get("end", vector(rng, 0.3))
        joints.append(joint)
        links.append({"name": f"link{i}", **link})
        points.append({"name": f"point{i}", "link": f"link{i}", "position": place})
        if kind == "rigid":
            bodies.append(Body(tuple(joint["axis"]), tuple(joint["origin"]["xyz"]), mass, tuple(link["com"]),
                               tuple(link["inertia"]), slides))  # fmt: skip
        elif rng.random() < 0.6:
            load = {"name": f"load{i}", "link": f"link{i}", "position": place, "mass": rng.uniform(0.1, 4)}
            payloads.append(load | {"inertia": inertia(rng, load["mass"])})
    gravity = [0.0, 0.0, -9.81] if rng.random() < 0.7 else (9.81 * np.array(unit(rng))).tolist()
    tables = {
        "format": "flexarm-arm/1",
        "gravity": gravity,
        "joints": joints,
        "links": links,
        "points": points,
    }
    tables |= {"payloads": payloads, "effects": effects}
    moving = [joint for joint in joints if joint["type"] != "fixed"]
    size = {joint["name"]: 0.1 if joint["type"] == "prismatic" else 1.0 for joint in moving}
    start = {name: most * rng.uniform(-1, 1) for name, most in size.items()}
    end = {name: start[name] + most * rng.uniform(-0.7, 0.7) for name, most in size.items()}
    chain = RigidChain(bodies, gravity) if kind == "rigid" else None
    seconds = 0.004 * rng.randint(125, 250)
    return Made(tables, start, end, seconds, chain, kind == "flexible", rng.random() < 0.5)


def trajectory(made: Made, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Angles, rates and accelerations of the drives, (n, joint).

    Polynomials from rest to rest; the smooth one is flat to the third derivative at its ends, the other
    one, a minimum-jerk move, to the second.
    """
    x, T = np.clip(t / made.seconds, 0, 1)[:, None], made.seconds
    start = np.array(list(made.start.values()))
    path = np.array(list(made.end.values())) - start
    s, rate, change = (
        (
            x**4 * (35 - 84 * x + 70 * x**2 - 20 * x**3),
            140 * (x - x**2) ** 3,
            420 * (x - x**2) ** 2 * (1 - 2 * x),
        )
        if made.smooth
        else (x**3 * (10 - 15 * x + 6 * x**2), 30 * (x - x**2) ** 2, 60 * (x - x**2) * (1 - 2 * x))
    )
    return start + path * s, path * rate / T, path * change / T**2


def run(
    made: Made, step: float, alpha: float = -0.05, tables: dict[str, Any] | None = None, **more: Any
) -> Any:
    """A run of the motion and of a rest after it; all steps that are tried divide its parts."""
    import flexarm

    t = 1e-3 * np.arange(round((made.seconds + REST) * 1e3) + 1)
    drive = flexarm.Drive.from_samples(t, dict(zip(made.start, trajectory(made, t)[0].T, strict=True)))
    return flexarm.simulate(
        flexarm.Arm.from_dict(tables or made.tables), drive, step=step, alpha=alpha, **more
    )


def close(what: str, found: Any, expected: Any, share: float, least: float = 0.0) -> None:
    """Fails if two arrays differ by more than a share of the largest value."""
    found, expected = np.asarray(found, float), np.asarray(expected, float)
    error = float(np.abs(found - expected).max(initial=0.0))
    size = max(float(np.abs(expected).max(initial=0.0)), least)
    if not error <= share * size:
        raise Failure(
            "wrong result", f"{what} differs by {error:.3g}, {error / max(size, 1e-300):.2g} of the largest"
        )


def weight(made: Made) -> None:
    """What lies on the base is the weight; torques that hold a rigid chain are those of inverse dynamics."""
    import flexarm
    from flexarm.arm.weight import weight_statement

    arm = flexarm.Arm.from_dict(made.tables)
    held = flexarm.static(arm, made.start)
    expected = weight_statement(arm).whole.mass * np.array(arm.gravity)
    close("the base's force", held.base_wrench[:3], expected, EXACT)
    if made.chain is not None:
        q = list(made.start.values())
        torque, wrench = made.chain.inverse_dynamics(q, np.zeros(len(q)), np.zeros(len(q)))
        close("the holding torque", held.joint_torque, torque, EXACT, 1e-3)
        close("the base's wrench", held.base_wrench, wrench, EXACT)


def turned(made: Made, R: np.ndarray, p: np.ndarray) -> dict[str, Any]:
    """The whole turned and shifted: gravity, and the joints on the base."""
    joints = []
    for joint in made.tables["joints"]:
        if joint["parent"] == "base":
            xyz, rpy = joint["origin"]["xyz"], joint["origin"]["rpy"]
            turn = R @ Rotation.from_euler("xyz", rpy).as_matrix()
            origin = {
                "xyz": (R @ xyz + p).tolist(),
                "rpy": Rotation.from_matrix(turn).as_euler("xyz").tolist(),
            }
            joint = joint | {"origin": origin}
        joints.append(joint)
    return made.tables | {"gravity": (R @ made.tables["gravity"]).tolist(), "joints": joints}


def invariance(made: Made, seed: int) -> None:
    """A turn and a shift of the whole turn and shift all places, and leave angles, torques and modes."""
    import flexarm

    rng = random.Random(seed)
    R, p = Rotation.from_rotvec(vector(rng, 2)).as_matrix(), np.array(vector(rng, 3))
    other = turned(made, R, p)
    one, two = (flexarm.static(flexarm.Arm.from_dict(tables), made.start) for tables in (made.tables, other))
    close("a turned place at rest", two.position, one.position @ R.T + p, EXACT, 1.0)
    close("a turned arm's torque at rest", two.joint_torque, one.joint_torque, 1e-8, 1e-2)
    if made.flexible:
        shapes = [flexarm.modes(flexarm.Arm.from_dict(tables), made.start) for tables in (made.tables, other)]
        close("a turned arm's frequency", shapes[1].frequency_hz, shapes[0].frequency_hz, 1e-7)
    first, second = run(made, 4e-3), run(made, 4e-3, tables=other)
    close("a turned place in motion", second.position, first.position @ R.T + p, MOTION, 1.0)
    close("a turned arm's torque in motion", second.joint_torque, first.joint_torque, 1e-3, 1e-2)


def energy(made: Made) -> dict[str, float]:
    """Kinetic, elastic and gravity's energy grow by the work of drives less what is lost, at second order."""
    errors = []
    for step in (2e-3, 1e-3):
        found = run(made, step, alpha=0.0, energies=True)
        total = found.kinetic + found.elastic + found.gravity + found.damped - found.work
        exchanged = max(np.ptp(found.kinetic), np.ptp(found.gravity), np.ptp(found.work))
        errors.append(float(np.abs(total - total[0]).max() / exchanged))
    if errors[1] > max(errors[0] / 2 ** ORDER[False], 1e-4):
        raise Failure(
            "wrong result", f"energy from nowhere: {errors[0]:.2g} at 2 ms, {errors[1]:.2g} at 1 ms"
        )
    return {"energy": errors[1]}


def rates(made: Made) -> None:
    """Velocities are the differences of places, and quaternions have length one."""
    found = run(made, 1e-3, rotations=True)
    h = found.time[1] - found.time[0]
    slope = (found.position[2:] - found.position[:-2]) / (2 * h)
    close("a velocity", found.velocity[1:-1], slope, 5e-3, 1e-2)
    close("a quaternion's length", np.linalg.norm(found.orientation, axis=-1), 1.0, EXACT)


def convergence(made: Made, alpha: float) -> dict[str, float]:
    """Positions and torques converge at second order; at 2 ms torques are within a hundredth."""
    runs = {ms: run(made, ms * 1e-3, alpha) for ms in (4, 2, 1)}
    if made.chain is not None:
        exact = [
            made.chain.inverse_dynamics(*rows)[0]
            for rows in zip(*trajectory(made, runs[1].time), strict=True)
        ]
        torque = np.array(exact)
        place = None
    else:
        finest = run(made, 0.25e-3, alpha)
        torque, place = finest.joint_torque[::4], finest.position[::4]
    values: dict[str, float] = {}
    faults = []
    for name, reference in (("torque", torque), ("position", place)):
        if reference is None:
            continue
        found = {}
        for ms in (4, 2, 1):
            field = getattr(runs[ms], "joint_torque" if name == "torque" else name)
            found[ms] = float(
                np.abs(field - resampled(reference, len(field))).max() / np.abs(reference).max()
            )
        values[f"{name} at alpha {alpha:g}"] = found[2]
        if found[1] > max(found[2] / 2 ** ORDER[made.flexible], NOTHING[made.flexible]):
            told = ", ".join(f"{found[ms]:.2g} at {ms} ms" for ms in (4, 2, 1))
            faults.append(f"the {name} does not converge: {told}")
        if name == "torque" and found[2] > LARGEST[made.flexible]:
            faults.append(f"a torque errs by {found[2]:.2g} at 2 ms")
    if faults:
        raise Failure("wrong result", f"alpha {alpha:g}: {'; '.join(faults)}", values)
    return values


def resampled(values: np.ndarray, n: int) -> np.ndarray:
    """Every other one, or every fourth, so that n are left."""
    every = (len(values) - 1) // (n - 1)
    return values[::every]


KINDS = ("rigid", "sprung", "flexible")


def case(number: int, rng: random.Random, seeds: Path) -> Case:
    kind = KINDS[number % len(KINDS)]
    arm, seed = made(rng, kind), rng.randrange(1 << 30)
    checks = {
        "weight": lambda: weight(arm),
        "invariance": lambda: invariance(arm, seed),
        "energy": lambda: energy(arm),
        "rates": lambda: rates(arm),
        "convergence at alpha 0": lambda: convergence(arm, 0.0),
        "convergence at alpha -0.05": lambda: convergence(arm, -0.05),
    }
    steps = tuple(Step(name, check, cpu=120) for name, check in checks.items())
    label = f"{kind} arm of {len(arm.tables['links'])} links"
    return Case(label, steps, {"arm.toml": tomlkit.dumps(arm.tables).encode()}, wall=600)


CAMPAIGN = Campaign("arms", "random arms", case, 2000, 12)
