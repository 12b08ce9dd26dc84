"""The goals of speed, and how the measured numbers stand to them: `| work | goal | measured | met |`."""

from collections.abc import Callable
from dataclasses import dataclass
from statistics import median


@dataclass(frozen=True)
class Goal:
    """A number to reach.

    Attributes
    ----------
    work : str
        What is measured.
    limit : float
        The goal, in `unit`.
    unit : str
        "s", "ms" or "x" (a ratio).
    measured : function
        From the results of all parts, by name, to the number in `unit`; KeyError where a part is missing.
    at_least : bool
        Whether more is better.
    """

    work: str
    limit: float
    unit: str
    measured: Callable[[dict], float]
    at_least: bool = False

    def line(self, results):
        """Its row, or None where it was not measured."""
        try:
            value = self.measured(results)
        except KeyError:
            return None
        met = value >= self.limit if self.at_least else value <= self.limit
        bound = "at least" if self.at_least else "at most"
        unit = "times" if self.unit == "x" else self.unit
        verdict = "yes" if met else "**no**"
        return f"| {self.work} | {bound} {self.limit:g} {unit} | {value:.3g} {unit} | {verdict} |"


def _over_flexarm(limit, code="exudyn-2d"):
    """CPU time of another code over flexarm's at an error [mm]."""

    def ratio(results):
        codes = next(entry["codes"] for entry in results["swing"]["table"] if entry["limit"] == limit)
        return codes[code]["solver over flexarm"]["median"]

    return ratio


def _long_run(segments, code="flexarm"):
    """CPU seconds of 133 s."""

    def seconds(results):
        codes = next(entry["codes"] for entry in results["133s"] if entry["segments"] == segments)
        return codes[code]["solver"]["median"]

    return seconds


def _parts(name):
    """CPU seconds of 133 s with a hinge of solid parts."""
    return lambda results: median(results["parts"][name]["cpu"])


def _over_linear(family):
    """How far the largest of a family is from linear growth."""
    return lambda results: results["scaling"][family]["over linear"]


def _identification(damping):
    """Milliseconds of a run of 60 s."""
    return lambda results: 1e3 * median(results["identification"][damping]["cpu"])


def _derivatives(results):
    """Seconds of that run with its derivatives."""
    return median(results["sensitivities"]["sensitivities"])


def _derivatives_over_plain(results):
    return _derivatives(results) / median(results["sensitivities"]["plain"])


def _gain_of_a_thread(results):
    threads = results["sensitivities"]["threads"]
    return threads["one"] / threads["two"]


def _added_by_python(results):
    """Milliseconds of a call over those in the core."""
    seen = results["overhead"]
    return 1e3 * median(whole - core for whole, core in zip(seen["whole"], seen["core"], strict=True))


def _shell(results):
    return median(results["overhead"]["shell"])


GOALS = (
    Goal("swing at 0.1 mm, planar EXUDYN over flexarm", 8, "x", _over_flexarm(0.1), at_least=True),
    Goal("swing at 0.01 mm, planar EXUDYN over flexarm", 8, "x", _over_flexarm(0.01), at_least=True),
    Goal("133 s at 2 ms, 4 segments", 0.05, "s", _long_run(4)),
    Goal("133 s at 2 ms, 20 segments", 0.20, "s", _long_run(20)),
    Goal("133 s at 2 ms, 4 segments, forced through space", 0.20, "s", _long_run(4, "flexarm, in space")),
    Goal("133 s at 2 ms, three super-elements and 4 segments", 0.20, "s", _parts("no inner modes")),
    Goal("the same, 20 inner modes in each", 0.20, "s", _parts("20 inner modes")),
    Goal("60 s for identification, tip within 1e-5 m", 30, "ms", _identification("damped in tube and hub")),
    Goal("the same, hardly damped: in the tube alone", 30, "ms", _identification("damped in the tube alone")),
    Goal("derivatives of the first by 20 parameters, over the plain run", 8, "x", _derivatives_over_plain),
    Goal("derivatives of the first by 20 parameters", 0.3, "s", _derivatives),
    Goal("two threads over one", 1.7, "x", _gain_of_a_thread, at_least=True),
    Goal("a call from an arm to arrays, over the core's time", 10, "ms", _added_by_python),
    Goal("`flexarm simulate` of 20 s from the shell, process", 0.6, "s", _shell),
    Goal("1000 segments, cost a step over linear", 1.5, "x", _over_linear("segments")),
    Goal("100 joints, cost a step over linear", 1.5, "x", _over_linear("joints")),
)


def lines(results):
    """The table as Markdown, of what was measured."""
    yield "| work | goal | measured | met |"
    yield "|---|---|---|---|"
    yield from filter(None, (goal.line(results) for goal in GOALS))
