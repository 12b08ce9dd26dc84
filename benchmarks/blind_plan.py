"""Which cases a blind test is made of: groups, arms, effects, places and sizes, from a seed.

single   one effect in rich data that leaves 10 times the noise; every effect in turn, arm and place by chance
power    the same at 3 and at 30 times the noise
poor     one effect, the tip alone in slow sines, 6 and 20 times the noise
double   two effects of different names, 15 times each
none     nothing hidden; nominal values are off within their uncertainty
outside  what no name of the vocabulary covers, 20 times the noise
fault    a sensor at fault, and nothing else
"""

from dataclasses import dataclass
from itertools import cycle, islice

import numpy as np

SIZES = {"single": (10.0,), "power": (3.0, 30.0), "poor": (6.0, 20.0), "double": (15.0,), "outside": (20.0,)}
COUNTS = {"single": 60, "power": 40, "poor": 24, "double": 30, "none": 24, "outside": 20, "fault": 10}
"""Cases of each group unless asked for otherwise."""
KINDS = ("hinged", "planar", "spatial")


@dataclass(frozen=True)
class Spec:
    """What `cases.make_case` takes."""

    group: str
    kind: str
    effects: tuple[str, ...]
    places: tuple[str, ...]
    size: float
    seed: int

    @property
    def name(self) -> str:
        """Of its directory."""
        return "-".join(
            [self.group, self.kind, *self.effects, *self.places, f"{self.size:g}", str(self.seed)]
        )

    def made(self):
        """The case."""
        from cases import make_case

        about = (self.kind, self.effects, self.places, self.size, self.seed)
        return make_case(*about, rich=self.group != "poor")


def planned(group: str, count: int, seed: int) -> list[Spec]:
    """The cases of a group."""
    rng = np.random.default_rng([seed, *map(ord, group)])
    chosen = {
        "double": _double,
        "none": _none,
        "outside": _outside,
        "fault": _fault,
    }.get(group, _single)
    sizes = cycle(SIZES.get(group, (0.0,)))
    specs = []
    for number, (kind, effects, places) in enumerate(islice(chosen(rng, group), count)):
        specs.append(Spec(group, kind, effects, places, next(sizes), 1000 * seed + number))
    return specs


def _place(kind, effect, rng):
    from hidden_effects import places
    from lab_arms import LAB_ARMS

    return str(rng.choice(places(effect, LAB_ARMS[kind])))


def _single(rng, group):
    """Every effect in turn, in another order each time."""
    from hidden_effects import HIDDEN

    names = [name for name, hidden in HIDDEN.items() if group != "poor" or hidden.poor]
    while True:
        for name in rng.permutation(names):
            kind = str(rng.choice(KINDS))
            yield kind, (str(name),), (_place(kind, str(name), rng),)


def _double(rng, group):
    """Pairs at the same or at different places; a joint's compliance comes first, what needs it after it."""
    from hidden_effects import HIDDEN

    while True:
        pair = sorted(
            map(str, rng.choice(list(HIDDEN), 2, replace=False)), key=lambda n: n != "joint_compliance"
        )
        kinds = {HIDDEN[name].place for name in pair}
        if {"base", "soft base"} <= kinds or kinds <= {"encoder", "tracker", "point", "torque"}:
            continue  # the one stands on the other, or nothing of the two is the arm's
        kind = str(rng.choice(KINDS))
        yield kind, tuple(pair), tuple(_place(kind, name, rng) for name in pair)


def _none(rng, group):
    while True:
        yield str(rng.choice(KINDS)), (), ()


def _outside(rng, group):
    from unnamed_effects import OUTSIDE, SEVERAL_JOINTS

    for name in cycle(OUTSIDE):
        yield str(rng.choice(KINDS[1:] if name in SEVERAL_JOINTS else KINDS)), (name,), ("base",)


def _fault(rng, group):
    from unnamed_effects import FAULTS

    for name in cycle(FAULTS):
        yield str(rng.choice(KINDS)), (name,), ("base",)
