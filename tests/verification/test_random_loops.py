"""Random closed loops, flat and spatial, cut at each of their pins: the same motion wherever they are cut."""

from __future__ import annotations

import numpy as np
import pytest

import flexarm

END = 0.4


class Loop:
    """A loop of bars between pins, of which the last bar is the ground.

    Seven hinges with any axes, or four that are parallel, leave one freedom.
    """

    def __init__(self, seed: int, pins: int) -> None:
        rng = np.random.default_rng(seed)
        flat = pins == 4
        turn = 2 * np.pi * (np.arange(pins) + rng.uniform(-0.2, 0.2, pins)) / pins
        self.places = np.stack([np.cos(turn), 0 * turn, np.sin(turn)], axis=1) + rng.uniform(-0.1, 0.1, 3)
        self.places[:, 1] = 0 if flat else rng.uniform(-0.4, 0.4, pins)
        axes = rng.normal(size=(pins, 3))
        self.axes = np.tile([0.0, -1.0, 0.0], (pins, 1)) if flat else axes
        self.mass, self.inertia = rng.uniform(1, 4, pins), rng.uniform(0.05, 0.1, (pins, 3))

    def cut(self, at: int) -> flexarm.Arm:
        """Return the arm in which the pin `at` is a closure; all its joints begin at zero."""
        count = len(self.places)
        ground = count - 1
        origin, joints = {ground: np.zeros(3)}, []

        def name(bar: int) -> str:
            return "base" if bar == ground else f"bar{bar}"

        def hinged(pin: int, parent: int, child: int) -> None:
            xyz = self.places[pin] - origin[parent]
            origin[child] = self.places[pin]
            joints.append(
                {
                    "name": f"pin{pin}",
                    "type": "revolute",
                    "parent": name(parent),
                    "child": name(child),
                    "origin": {"xyz": xyz.tolist()},
                    "axis": self.axes[pin].tolist(),
                }
            )

        for pin in range(at):
            hinged(pin, (pin - 1) % count, pin)
        for pin in range(ground, at, -1):
            hinged(pin, pin, pin - 1)
        before = (at - 1) % count
        middle = {bar: 0.5 * (self.places[bar] + self.places[bar + 1]) - origin[bar] for bar in range(ground)}
        closure = {"name": "cut", "type": "revolute", "axis": self.axes[at].tolist()}
        for side, bar in (("a", before), ("b", at)):
            closure |= {side: name(bar), f"{side}_origin": {"xyz": (self.places[at] - origin[bar]).tolist()}}
        links = [
            {
                "name": name(bar),
                "type": "rigid",
                "mass": self.mass[bar],
                "com": middle[bar].tolist(),
                "inertia": self.inertia[bar].tolist(),
            }
            for bar in range(ground)
        ]
        points = [
            {"name": name(bar), "link": name(bar), "position": middle[bar].tolist()} for bar in range(ground)
        ]
        return flexarm.Arm.from_dict(
            {
                "name": f"cut at {at}",
                "links": links,
                "joints": joints,
                "closures": [closure],
                "points": points,
            }
        )


def fall(arm: flexarm.Arm) -> np.ndarray:
    """Places of the bars while the loop falls from rest; the joint that is let go carries no torque."""
    free = arm.joints[0].name
    drive = flexarm.Drive.from_samples([0, END], {free: [0, 0]}, side="torque")
    return flexarm.simulate(arm, drive, step=1e-3).position


@pytest.mark.parametrize(
    ("pins", "seed"), [*((4, seed) for seed in range(4)), *((7, seed) for seed in range(2, 6))]
)
def test_a_random_loop_falls_alike_wherever_it_is_cut(pins, seed):
    """By half a metre within 0.4 s; accelerations are iterated to 1e-5 of those that the reach gives."""
    loop = Loop(seed, pins)
    first, *others = (fall(loop.cut(at)) for at in range(pins))
    assert np.ptp(first, axis=0).max() > 0.2
    for other in others:
        assert np.abs(other - first).max() < 3e-6
