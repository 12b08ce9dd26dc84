"""What a blind test says of a diagnosis: rates with Wilson's 95 % intervals, from reports and answers.

    (p + z^2/2n -+ z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n),   z = 1.96                              (1)

for k = p n of n cases (Wilson, 1927). An outcome holds the `answer` (cases.py), the `report` (report.json),
`seconds`, an `error` or None, and what compare prints for the held-out tip before and after the repair.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from math import isfinite, nan, pi, sqrt
from statistics import median

CONFIDENT, LARGE = 0.8, 8.0  # probability; size over noise that counts as ten times
SEEN = 1.0
"""Size over noise below which an effect leaves nothing to see: some cannot be as large as was asked."""
SEVERAL_JOINTS = ("planar", "spatial")
ROUNDED = {"encoder_quantisation"}
"""No repair gives back what was rounded away: left out of the closure."""
UNCHECKED = {"multiple"}
"""Whole numbers have no interval."""
SIZE_BINS = ((0.0, 6.0, 3), (6.0, 20.0, 10), (20.0, float("inf"), 30))


@dataclass(frozen=True)
class Outcome:
    """A case that was diagnosed; `before` and `after` are rms of the held-out tip [m]."""

    answer: dict
    report: dict
    seconds: float = 0.0
    cpu: float = 0.0
    before: float = nan
    after: float = nan
    error: str | None = None

    @property
    def group(self) -> str:
        """Of the case."""
        return self.answer["group"]

    @property
    def verdict(self) -> str | None:
        """None if there is no report."""
        return self.report.get("verdict")

    @property
    def named(self) -> list[dict]:
        """Effects, the most probable one first as the report has them."""
        return self.report.get("effects", [])

    @property
    def hidden(self) -> list[dict]:
        """What is behind it."""
        return self.answer["effects"]

    @property
    def size(self) -> float:
        """Of the smallest hidden effect over the noise."""
        return min((effect["size"] for effect in self.hidden), default=0.0)


def same(named: dict, hidden: dict) -> bool:
    """Name and place."""
    return named["name"] == hidden["name"] and named["at"] in hidden["at_any"]


def holds(named: dict, hidden: dict) -> bool:
    """Whether an effect or one of its alternatives is the hidden one."""
    return any(same(one, hidden) for one in [named, *named.get("alternatives", [])])


def right_name(outcome: Outcome) -> bool:
    """One effect, of the right name, wherever."""
    return [one["name"] for one in outcome.named] == [one["name"] for one in outcome.hidden]


def right_place(outcome: Outcome) -> bool:
    """One effect, of the right name at the right place."""
    return right_name(outcome) and all(map(same, outcome.named, outcome.hidden))


def in_set(outcome: Outcome) -> bool:
    """Every hidden effect is named or an alternative of one that is."""
    return all(any(holds(named, hidden) for named in outcome.named) for hidden in outcome.hidden)


def wrong_and_confident(outcome: Outcome) -> bool:
    """Something is named with confidence and no hidden effect is in its set.

    What has no name may hold a part that has one: there, with `unexplained`, the part is no claim.
    """
    if outcome.group == "outside" and outcome.verdict == "unexplained":
        return False
    return any(
        named["probability"] > CONFIDENT and not any(holds(named, hidden) for hidden in outcome.hidden)
        for named in outcome.named
    )


def f1(outcome: Outcome) -> float:
    """Of the set of named effects: 2 k/(named + hidden), k that are both."""
    both = sum(any(same(named, hidden) for named in outcome.named) for hidden in outcome.hidden)
    return 2 * both / (len(outcome.named) + len(outcome.hidden))


def fault_named(outcome: Outcome) -> bool:
    """A sensor's fault is said and where; outliers may be removed and listed instead."""
    said = any(same(named, hidden) for named in outcome.named for hidden in outcome.hidden)
    removed = outcome.hidden[0]["name"] == "outliers" and outcome.verdict == "adequate"
    return removed or (said and outcome.verdict in outcome.answer["verdict"])


def intervals(outcome: Outcome) -> list[tuple[str, bool]]:
    """Parameters of rightly named effects, and whether their 90 % interval holds the true one."""
    found = []
    for hidden in outcome.hidden:
        for named in outcome.named:
            if same(named, hidden):
                found += [
                    (f"{hidden['name']}.{one['name']}", _inside(one, hidden["parameters"][one["name"]]))
                    for one in named.get("parameters", [])
                    if one["name"] in hidden["parameters"] and one["name"] not in UNCHECKED
                ]
    return found


def _inside(estimate: dict, true: float) -> bool:
    if estimate["name"] == "phase":
        middle = (estimate["low90"] + estimate["high90"]) / 2
        true += 2 * pi * round((middle - true) / (2 * pi))
    return estimate["low90"] <= true <= estimate["high90"]


def closure(outcome: Outcome) -> float:
    """1 - (after - floor)/(before - floor) of the held-out tip; a case without a repair closes nothing."""
    floor, before = outcome.answer["noise"], outcome.before
    if not isfinite(outcome.after) or not before > floor:
        return 0.0
    return min(1.0, 1 - (outcome.after - floor) / (before - floor))


def harmless(outcome: Outcome) -> bool:
    """The held-out gap grew by no more than 1 %; without a repair it did not grow."""
    return not isfinite(outcome.after) or outcome.after <= 1.01 * outcome.before


def wilson(k: int, n: int, z: float = 1.959964) -> tuple[float, float]:
    """(1)."""
    if n == 0:
        return 0.0, 1.0
    p = k / n
    centre, half = p + z * z / (2 * n), z * sqrt(p * (1 - p) / n + z * z / (4 * n * n))
    return max(0.0, (centre - half) / (1 + z * z / n)), min(1.0, (centre + half) / (1 + z * z / n))


@dataclass(frozen=True)
class Rate:
    """k of n cases, with what is wanted."""

    title: str
    k: int
    n: int
    goal: str = ""

    def to_dict(self) -> dict:
        """For a JSON file."""
        low, high = wilson(self.k, self.n)
        part = self.k / self.n if self.n else None
        about = {"title": self.title, "k": self.k, "n": self.n, "rate": part}
        return about | {"low95": low, "high95": high, "goal": self.goal}

    def __str__(self) -> str:
        low, high = wilson(self.k, self.n)
        counted = f"[{low:.2f}, {high:.2f}]  {self.k:3d}/{self.n:<3d}"
        return f"{self.title:62s} {self.k / self.n:5.2f}  {counted}  {self.goal}"


@dataclass(frozen=True)
class Number:
    """A value that is no rate."""

    title: str
    value: float
    goal: str = ""

    def to_dict(self) -> dict:
        """For a JSON file."""
        return dict(self.__dict__)

    def __str__(self) -> str:
        return f"{self.title:62s} {self.value:8.3g}  {self.goal}"


@dataclass(frozen=True)
class Table:
    """All that is measured, and one line a case."""

    rates: list[Rate] = field(default_factory=list)
    numbers: list[Number] = field(default_factory=list)
    coverage: dict[str, tuple[int, int]] = field(default_factory=dict)
    confusion: list[str] = field(default_factory=list)

    def to_dict(self) -> dict:
        """For a JSON file."""
        rows = {name: [one.to_dict() for one in getattr(self, name)] for name in ("rates", "numbers")}
        return rows | {"coverage": self.coverage, "confusion": self.confusion}

    def __str__(self) -> str:
        covered = [f"{name} {k}/{n}" for name, (k, n) in sorted(self.coverage.items())]
        lines = [*map(str, self.rates), "", *map(str, self.numbers), "", "intervals: " + ", ".join(covered)]
        return "\n".join([*lines, "", *self.confusion])


def tabulated(outcomes: Iterable[Outcome]) -> Table:
    """Every row for which there are cases."""
    outcomes = list(outcomes)
    of = {name: [one for one in outcomes if one.group == name] for name in {o.group for o in outcomes}}
    single = of.get("single", [])
    large = [one for one in single if one.size >= LARGE]
    joints = [one for one in large if one.answer["kind"] in SEVERAL_JOINTS]
    poor, none, outside = of.get("poor", []), of.get("none", []), of.get("outside", [])
    inside = [(name, ok) for one in outcomes for name, ok in intervals(one)]
    rows = [
        _rate("right name, single, >= 10 x floor, rich", right_name, large, ">= 0.95"),
        _rate("right name and place, two and three joints", right_place, joints, ">= 0.90"),
        _rate("truth in the set, single, >= 10 x floor, rich", in_set, large),
        *_power([*single, *of.get("power", [])]),
        _rate("truth in the set, poor", in_set, [o for o in poor if o.size >= SEEN], ">= 0.95"),
        _rate(
            "wrong and confident", wrong_and_confident, [o for o in outcomes if o.group != "fault"], "<= 0.03"
        ),
        _rate("an effect named where there is none", lambda one: bool(one.named), none, "<= 0.05"),
        _rate("said adequate where there is none", lambda one: one.verdict == "adequate", none),
        _rate(
            "outside the vocabulary: said unexplained",
            lambda one: one.verdict == "unexplained",
            outside,
            ">= 0.80",
        ),
        _rate("two effects: both named, nothing else", lambda one: f1(one) == 1.0, of.get("double", [])),
        _rate("sensor at fault: named", fault_named, of.get("fault", [])),
        _rate("true parameter in its 90 % interval", lambda pair: pair[1], inside, "0.85 to 0.95"),
        _rate("held-out not worse, none and outside", harmless, [*none, *outside], "1"),
        _rate("no error", lambda one: one.error is None, outcomes, "1"),
    ]
    return Table(
        [row for row in rows if row.n], _numbers(outcomes, of), _by_name(inside), list(map(_line, outcomes))
    )


def _rate(title: str, holds_for: Callable, cases: list, goal: str = "") -> Rate:
    return Rate(title, sum(bool(holds_for(one)) for one in cases), len(cases), goal)


def _power(single: list[Outcome]) -> list[Rate]:
    """Right name by size, over all sizes there are."""
    binned = [(about, [o for o in single if low <= o.size < high]) for low, high, about in SIZE_BINS]
    return [
        _rate(f"  power: right name at about {about} x floor", right_name, cases) for about, cases in binned
    ]


def _numbers(outcomes: list[Outcome], of: dict[str, list[Outcome]]) -> list[Number]:
    poor = [1 + len(one["alternatives"]) for o in of.get("poor", []) for one in o.named[:1]]
    repaired = [o for name in ("single", "poor", "double") for o in of.get(name, [])]
    closed = sorted(closure(o) for o in repaired if not ROUNDED & {hidden["name"] for hidden in o.hidden})
    seconds = [o.seconds for o in outcomes]
    numbers = []
    if poor:
        numbers.append(Number("names in the set, poor, mean", sum(poor) / len(poor), "<= 3"))
    if of.get("double"):
        values = [f1(o) for o in of["double"]]
        numbers.append(Number("two effects: F1 of the set, mean", sum(values) / len(values), ">= 0.8"))
    if closed:
        numbers.append(Number("held-out gap closed, median", median(closed), ">= 0.95"))
        numbers.append(
            Number("held-out gap closed, 10th percentile", closed[int(0.1 * len(closed))], ">= 0.7")
        )
    if seconds:
        numbers.append(Number("seconds a case, median", median(seconds), "<= 30"))
        numbers.append(Number("seconds a case, worst", max(seconds), "<= 90"))
        numbers.append(Number("CPU seconds a case, median", median(o.cpu for o in outcomes)))
        numbers.append(Number("CPU seconds a case, worst", max(o.cpu for o in outcomes)))
    return numbers


def _by_name(inside: list[tuple[str, bool]]) -> dict[str, tuple[int, int]]:
    names = {name for name, _ in inside}
    return {
        name: (sum(ok for one, ok in inside if one == name), sum(one == name for one, _ in inside))
        for name in names
    }


def _line(outcome: Outcome) -> str:
    """Truth and answer of one case."""
    hidden = "+".join(f"{one['name']}@{one['at']}" for one in outcome.hidden)
    truth = hidden or outcome.answer.get("outside") or "nothing"
    named = " + ".join(
        f"{one['name']}@{one['at']} {one['probability']:.2f}"
        + "".join(f" / {other['name']}@{other['at']}" for other in one.get("alternatives", []))
        for one in outcome.named
    )
    ok = _good(outcome)
    said = outcome.error or f"{outcome.verdict}: {named or 'nothing'}"
    about = f"{outcome.group:8s} {outcome.answer['kind']:8s} {truth} (x{outcome.size:.0f}) -> {said}"
    return f"{'ok' if ok else '--'}  {about}  [{closure(outcome):.2f}, {outcome.seconds:.0f} s]"


def _good(outcome: Outcome) -> bool:
    """What the confusion list ticks."""
    if outcome.error is not None:
        return False
    if outcome.group == "fault":
        return fault_named(outcome)
    if outcome.group in ("none", "outside"):
        return outcome.verdict in outcome.answer["verdict"]
    return in_set(outcome) if outcome.group == "poor" else f1(outcome) == 1.0
