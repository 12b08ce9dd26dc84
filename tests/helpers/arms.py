"""Arms and motions that several tests share, and the fit of an order of convergence."""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import ArrayLike, NDArray

import flexarm
from flexarm.arm.sensor import Sensor

STEEL = {"youngs_modulus": 210e9, "poisson_ratio": 0.3, "density": 7850.0}
G = 9.81

# The paper's arm: a 3 m tube, its payload as a point mass, Euler-Bernoulli unless a test says otherwise.
LENGTH, PAYLOAD = 3.0, 14.1
AREA, PRINTED_AREA, SECOND_MOMENT = 5.82e-4, 5.92e-5, 2.37e-7
TUBE = {"shape": "tube", "outer_diameter": 0.06024, "thickness": 3.25e-3}
EI, RHO_A = STEEL["youngs_modulus"] * SECOND_MOMENT, STEEL["density"] * AREA


def general(area: float, second_moment: float, torsion: float | None = None, **more: object) -> dict:
    """A section given by its numbers; the torsion constant of a round one unless stated."""
    torsion = 2 * second_moment if torsion is None else torsion
    return {
        "shape": "general",
        "area": area,
        "second_moment": second_moment,
        "torsion_constant": torsion,
        **more,
    }


def hinge(name: str, child: str, parent: str = "base", **more: object) -> dict:
    """A revolute joint, about y unless stated."""
    return {"name": name, "type": "revolute", "parent": parent, "child": child, "axis": [0, 1, 0], **more}


def fixed(name: str, child: str, parent: str = "base", **more: object) -> dict:
    """A joint that does not move."""
    return {"name": name, "type": "fixed", "parent": parent, "child": child, **more}


def beam(name: str, end: ArrayLike, section: dict, **more: object) -> dict:
    """A beam of steel, without shear or rotary inertia unless stated."""
    return {
        "name": name,
        "type": "beam",
        "end": list(end),
        "section": section,
        "material": STEEL,
        "theory": "euler-bernoulli",
        **more,
    }


def rigid(name: str, mass: float, com: ArrayLike = (0, 0, 0), inertia: ArrayLike = (0, 0, 0)) -> dict:
    """A rigid body."""
    return {"name": name, "type": "rigid", "mass": mass, "com": list(com), "inertia": list(inertia)}


def point(name: str, link: str, position: ArrayLike) -> dict:
    """A place to look at."""
    return {"name": name, "link": link, "position": list(position)}


def compliance(joint: str, stiffness: float, damping: float = 0.0) -> dict:
    """Spring and damper between motor and link."""
    return {"name": "joint_compliance", "at": joint, "stiffness": stiffness, "damping": damping}


def arm(**tables: object) -> flexarm.Arm:
    """The arm of these tables."""
    return flexarm.Arm.from_dict({"format": "flexarm-arm/1", **tables})


def paper_arm(
    elements: int = 8,
    spring: float | None = None,
    area: float = AREA,
    payload: float = PAYLOAD,
    section: dict | None = None,
    **link: object,
) -> flexarm.Arm:
    """The paper's arm, upright at q = 0, on a hinge about y that may have a spring [N m/rad]."""
    section = general(area, SECOND_MOMENT) if section is None else section
    return arm(
        name="paper",
        gravity=[0, 0, -G],
        joints=[hinge("hinge", "rod")],
        links=[beam("rod", [0, 0, LENGTH], section, elements=elements, **link)],
        payloads=[{"name": "load", "link": "rod", "position": [0, 0, LENGTH], "mass": payload}],
        points=[point("tip", "rod", [0, 0, LENGTH])],
        effects=[] if spring is None else [compliance("hinge", spring)],
    )


def crane(**more: object) -> flexarm.Arm:
    """The paper's arm as one would measure it: a tube, damped by 2 %, its load, a rigid hinge with a gear."""
    tables = {
        "name": "crane",
        "gravity": [0, 0, -G],
        "joints": [hinge("hinge", "rod", gear_ratio=120)],
        "links": [beam("rod", [0, 0, LENGTH], TUBE, elements=2, damping_ratio=0.02)],
        "payloads": [{"name": "load", "link": "rod", "position": [0, 0, LENGTH], "mass": PAYLOAD}],
        "points": [point("tip", "rod", [0, 0, LENGTH])],
    }
    return arm(**{**tables, **more})


def rod_arm(sensors: Sequence[dict | Sensor], damping_ratio: float = 0.0, **more: object) -> flexarm.Arm:
    """A tube of 3 m on a hinge with a gear, its tip a point, and sensors."""
    tables = {
        "joints": [hinge("hinge", "rod", gear_ratio=120)],
        "links": [beam("rod", [0, 0, LENGTH], TUBE, damping_ratio=damping_ratio)],
        "points": [point("tip", "rod", [0, 0, LENGTH])],
        "sensors": sensors,
    }
    return arm(**{**tables, **more})


def waist_and_elbow(tip: dict, **more: object) -> flexarm.Arm:
    """A post that turns and a rod on it, an encoder of each, and a tracker of the `tip` in its own frame."""
    tip = {"name": "tip", "quantity": "position", "point": "tip", "frame": "tracker", "rate_hz": 20, **tip}
    joints = ("waist", "elbow")
    return arm(
        joints=[hinge("waist", "post", axis=[0, 0, 1]), hinge("elbow", "rod", parent="post", at="end")],
        links=[beam("post", [0, 0, 1.0], TUBE), beam("rod", [1.5, 0, 0.0], TUBE, up=[0, 0, 1])],
        points=[point("tip", "rod", [1.5, 0, 0])],
        sensors=[
            *({"name": name, "quantity": "joint_angle", "joint": name, "rate_hz": 50} for name in joints),
            tip,
        ],
        **more,
    )


def tracker(seen: str = "tip", rate_hz: float = 10, noise: float = 5e-5) -> Sensor:
    """A laser tracker of a point in the plane of motion, with a clock and a frame of its own."""
    return Sensor(
        name=seen,
        quantity="position",
        point=seen,
        axes=("x", "z"),
        rate_hz=rate_hz,
        noise_std=noise,
        clock="tracker",
        frame="tracker",
    )


def smooth_step(x: NDArray[np.float64]) -> NDArray[np.float64]:
    """s(x) = 10 x^3 - 15 x^4 + 6 x^5 from 0 to 1, flat to the second derivative at both ends."""
    x = np.clip(x, 0.0, 1.0)
    return x**3 * (10 - 15 * x + 6 * x**2)


def swing_angle(t: NDArray[np.float64]) -> NDArray[np.float64]:
    """q(t) = 1.2 sin(2 pi 0.05 t) s(t/4) of the swing benchmark [rad]."""
    return 1.2 * np.sin(2 * np.pi * 0.05 * t) * smooth_step(t / 4)


def there_and_back(period: float) -> flexarm.Drive:
    """Minimum-jerk moves between -1.2 and 1.2 rad: quasi-static if the period is long."""
    t = np.linspace(0.0, period, 401)
    s = 1 - np.abs(2 * t / period - 1)
    return flexarm.Drive.from_samples(t, {"hinge": -1.2 + 2.4 * smooth_step(s)})


def drive(joints: dict[str, Callable], end: float, samples: int = 2001, side: str = "motor") -> flexarm.Drive:
    """Drive along functions of time up to `end` [s]; the spline errs by less than 1e-11 rad here."""
    t = np.linspace(0, end, samples)
    return flexarm.Drive.from_samples(t, {name: f(t) for name, f in joints.items()}, side=side)


def observed_order(h: ArrayLike, error: ArrayLike) -> float:
    """Slope of log(error) over log(h), by least squares."""
    return float(np.polyfit(np.log(np.asarray(h, float)), np.log(np.abs(np.asarray(error, float))), 1)[0])
