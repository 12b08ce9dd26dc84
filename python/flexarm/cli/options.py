"""Options that several commands share, and how their values are read."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Protocol

import typer

from flexarm.cli.run import INPUT_AT_FAULT
from flexarm.errors import InvalidFile, InvalidParameter, Problem, printable
from flexarm.json_values import plain
from flexarm.reading import OUTSIDE
from flexarm.tables.ranges import range_of

if TYPE_CHECKING:
    from flexarm.arm import Arm

Model = Annotated[Path, typer.Argument(metavar="MODEL", help="Model of the arm, a TOML file.")]
JointValues = Annotated[
    list[str] | None,
    typer.Option(
        "--joint",
        metavar="NAME=VALUE",
        help="Where a joint's drive stands, output side [rad, m if prismatic]; repeat it.",
    ),
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object and nothing else.")]
Force = Annotated[
    bool,
    typer.Option(
        "--force",
        help="Write into a directory that holds files: those of the same name are replaced, others stay.",
    ),
]
ReplaceFile = Annotated[bool, typer.Option("--force", help="Replace a file that exists.")]
Jobs = Annotated[
    int | None, typer.Option("--jobs", min=1, metavar="N", help="Number of threads; default one a core.")
]
Step = Annotated[float, typer.Option("--step", metavar="S", help="Time step of the simulations [s].")]


def _allow_outside(allowed: bool) -> bool:
    OUTSIDE.set(allowed)
    return allowed


AllowOutside = Annotated[
    bool,
    typer.Option(
        "--allow-outside",
        callback=_allow_outside,
        help="Read files that a record names outside its directory.",
    ),
]


def _some_seconds(seconds: float | None) -> float | None:
    if seconds is not None and not 0 < seconds < math.inf:
        raise InvalidFile("command line", "--max-seconds", f"must be positive, got {seconds:g} s")
    return seconds


MaxSeconds = Annotated[
    float | None,
    typer.Option(
        "--max-seconds",
        callback=_some_seconds,
        metavar="S",
        help="Time after which nothing more is tried [s]; to conclude from what was found takes longer.",
    ),
]
Out = Annotated[Path, typer.Option("--out", metavar="DIR", help="Directory for the output.")]


def load_arm(model: Path) -> Arm:
    """Return the arm in a model file; its warnings go to standard error."""
    from flexarm.arm import Arm

    arm = Arm.from_toml(model)
    warn(model, arm.warnings)
    return arm


def warn(file: Path, problems: Iterable[Problem]) -> None:
    """Print `warning: FILE: WHERE: ...` on standard error for each problem."""
    for problem in problems:
        print(printable(f"warning: {file}: {problem}"), file=sys.stderr)


def refuse(faults: Iterable[tuple[Path, Problem]]) -> None:
    """Print `error: FILE: WHERE: ...` on standard error for each fault and ends with exit code 2 if any.

    For commands whose output is whole and says that the input is at fault.
    """
    found = list(faults)
    sys.stdout.flush()
    for file, problem in found:
        print(printable(f"error: {file}: {problem}"), file=sys.stderr)
    if found:
        raise typer.Exit(INPUT_AT_FAULT)


def joint_values(arm: Arm, model: Path, given: list[str] | None) -> dict[str, float]:
    """Return the values of --joint.

    Raise InvalidFile if one is not NAME=NUMBER, names no moving joint, or names one twice.
    """
    from flexarm.arm.joint import shaft_ratio
    from flexarm.arm.sizes import LONGEST
    from flexarm.drive.doubts import beyond_travel

    values = numbers_by_joint(arm, model, given, "--joint", "NAME=VALUE")
    for name, value in values.items():
        turns = abs(value) / (2 * math.pi)
        if arm.joint(name).type == "revolute" and turns > shaft_ratio(name, arm.gears):
            what = f"{value:g} rad are {turns:.3g} turns; angles are in radians"
        elif arm.joint(name).type == "prismatic" and abs(value) > LONGEST:
            what = f"{value:g} m are further than any arm reaches; lengths are in m, not in mm"
        else:
            what = beyond_travel(arm, name, value, value)
        if what:
            warn(Path("command line"), [Problem(f"--joint {name}", what)])
    return values


def numbers_by_joint(
    arm: Arm, model: Path, given: list[str] | None, option: str, form: str
) -> dict[str, float]:
    """Return the numbers of an option of a form such as NAME=VALUE.

    Raise InvalidFile if one is not of that form, names no moving joint, or names one twice.
    """
    joints = [joint.name for joint in arm.moving_joints]
    values: dict[str, float] = {}
    for text in given or ():
        name, equals, number = text.partition("=")
        name = name.strip()
        if not equals or not _is_finite(number):
            example = f"{joints[0] if joints else 'hinge'}=0.5"
            what = f"must be {form} with a plain number in SI units, such as {example}, got {text!r}"
            raise InvalidFile("command line", option, what)
        if name not in joints:
            from flexarm.arm.consistency import missing

            raise InvalidFile(model, option, missing("moving joint", name, joints))
        if name in values:
            raise InvalidFile("command line", option, f"joint {name!r} is given twice")
        values[name] = float(number)
    return values


def _is_finite(text: str) -> bool:
    try:
        return math.isfinite(float(text))
    except ValueError:
        return False


def refuse_step(step: float) -> None:
    """Refuse a time step that is not positive, or longer than any run.

    Raise InvalidFile with the value of --step.
    """
    most = range_of("s")[1]
    if not 0 < step <= most:
        raise InvalidFile(
            "command line", "--step", f"must be positive and at most {most:g} s, got {step:g} s"
        )


@contextmanager
def blame(file: Path, record: Path | None = None) -> Iterator[None]:
    """Name the file in errors that the library raises about what it holds.

    The record is blamed instead where the error stands in a table that only records have.
    """
    try:
        yield
    except InvalidFile:
        raise
    except InvalidParameter as error:
        problem = error.problems[0]
        in_record = record is not None and problem.where.split(".")[0] in (
            "kind",
            "signals",
            "drive",
            "clocks",
            "frames",
        )
        raise InvalidFile(
            record if record and in_record else file,
            problem.where or "model",
            problem.what,
            problems=error.problems,
        ) from None


class Shown(Protocol):
    """A result for programs and for a person."""

    def to_json_dict(self) -> dict[str, Any]:
        """Return its JSON object."""

    def summary(self) -> str:
        """Return it in lines."""


def show(found: Shown, as_json: bool) -> None:
    """Print a result as one JSON object or in lines."""
    if as_json:
        print_json(found.to_json_dict())
    else:
        print(found.summary())


def print_json(value: object) -> None:
    """One JSON object on standard output; numbers that are not finite become null."""
    import json

    print(json.dumps(plain(value), indent=2, allow_nan=False))
