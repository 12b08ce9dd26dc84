"""What may come out of a step, and how it is told from what it printed and how it ended."""

from __future__ import annotations

import re
import traceback
from dataclasses import dataclass, field
from typing import Any

PASSED = ("ok", "refused", "numbers")
"""Done (exit code 0), refused with an error that names file and place (2), no convergence (3)."""
FAILED = (
    "wrong result",
    "crash",
    "traceback",
    "foreign exception",
    "raw warning",
    "unclear message",
    "hang",
    "memory",
    "left files",
)
"""Everything else. A foreign exception is one that a caller of the library cannot expect or read."""


class Failure(AssertionError):
    """Raised by a step that finds a failure itself: its class, what it saw, and figures."""

    def __init__(self, kind: str, detail: str, values: dict[str, Any] | None = None) -> None:
        super().__init__(detail)
        self.kind = kind
        self.values = values or {}


@dataclass
class Outcome:
    """What came out of a step.

    Attributes
    ----------
    kind : str
        One of PASSED or FAILED.
    step : str
        What was tried.
    detail : str
        The line that tells most.
    values : dict
        Figures that a campaign gathers, such as latencies.
    """

    kind: str
    step: str = ""
    detail: str = ""
    values: dict[str, Any] = field(default_factory=dict)

    @property
    def failed(self) -> bool:
        return self.kind in FAILED


WARNING = re.compile(r"^.*\.py:\d+: \w*(Warning|Error): .*$", re.MULTILINE)
"""As Python prints a warning that nobody catches."""
ERROR = re.compile(r"error: [^:]+: .+")
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f\u0080-\u009f\u202a-\u202e\u2066-\u2069]")
"""Characters that move a terminal's cursor or turn the direction of its text; tab and newline may stand."""
STARVED = re.compile("memory: not enough|MemoryError|Unable to allocate|bad_alloc")
"""A message of what asked for more memory than a child may have: a failure, however politely said."""
LONGEST_LINE = 2000
CODES = {0: "ok", 2: "refused", 3: "numbers"}
UNREADABLE = re.compile(
    r"unsupported operand|not subscriptable|object is not|has no len|incompatible (function|constructor)|"
    r"ufunc|can't be used in|cannot unpack|concatenate|NoneType|_core\.|not supported between|"
    r"must be real number"
)
"""Messages of Python, NumPy and pybind11 that tell of the inside of a function and not of its argument."""


def of_command(code: object, out: str, err: str) -> tuple[str, str]:
    """Class and detail of a command that ended with an exit code and these texts."""
    line = err.strip().splitlines()[-1] if err.strip() else ""
    last = line[:300]
    if "Traceback (most recent call last)" in err:
        return "traceback", last
    if STARVED.search(err):
        return "memory", last
    if (found := WARNING.search(err)) is not None:
        return "raw warning", found[0][-300:]
    if code not in CODES:
        return "unclear message", f"exit code {code}: {last}"
    if code and not ERROR.match(line):
        return "unclear message", f"exit code {code} without an error's last line: {last}"
    if (found := CONTROL.search(out + err)) is not None:
        return "unclear message", f"prints the control character {found[0]!r}"
    if len(longest := max(err.splitlines(), key=len, default="")) > LONGEST_LINE:
        return "unclear message", f"a line of {len(longest)} characters: {longest[:100]}"
    return CODES[code], last


def of_exception(error: BaseException) -> tuple[str, str]:
    """Class and detail of what a call of the library raised."""
    from flexarm import InvalidParameter, NotConverged

    told = f"{type(error).__name__}: {error}"[:300].replace("\n", " ")
    if isinstance(error, Failure):
        return error.kind, str(error)[:300]
    if isinstance(error, MemoryError) or STARVED.search(told):
        return "memory", told
    if isinstance(error, InvalidParameter):
        return (
            ("unclear message", "an error without a message") if not str(error).strip() else ("refused", told)
        )
    if isinstance(error, NotConverged):
        return "numbers", told
    if (
        isinstance(error, OSError) and error.filename is not None
    ):  # a file that is not there, or is one already
        return "refused", told
    if isinstance(error, TypeError) and not UNREADABLE.search(str(error)):
        return "refused", told
    place = traceback.extract_tb(error.__traceback__)[-1]
    return "foreign exception", f"{told} ({'/'.join(place.filename.split('/')[-2:])}:{place.lineno})"
