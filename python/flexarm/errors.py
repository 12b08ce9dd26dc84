"""Errors of three kinds: a parameter, a file, the numbers.

`InvalidParameter` is a value that the physics or the format does not allow, `InvalidFile` the same with
the file and the place in it, `NotConverged` a computation that found no equilibrium. The command line
turns the first two into exit code 2 and the last into exit code 3.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from functools import partial
from pathlib import Path

LONGEST = 200
"""Characters of a word or quotation in a message: longer ones are not read, and may be a whole file."""

_QUOTED = re.compile(rf"'[^']{{{LONGEST},}}'|\S{{{LONGEST},}}")


def printable(text: str) -> str:
    """Return text without control or direction characters, long words and quotations cut.

    Files hold anything, such as sequences that clear a screen or marks that turn the order of letters.
    """
    shown = "".join(c if c.isprintable() or c == "\n" else c.encode("unicode_escape").decode() for c in text)
    return _QUOTED.sub(lambda match: f"{match[0][: LONGEST // 2]}...{match[0][-10:]}", shown)


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong."""

    where: str
    """Dotted path with names for indices (`links.rod.section.thickness`), or `line 12, column 3`."""
    what: str
    """What is wrong, the value, what is allowed."""
    line: int | None = None
    """Line of the file, where it is known and `where` does not say it."""

    def __str__(self) -> str:
        place = self.where
        if self.line is not None:
            place = f"{place} (line {self.line})" if place else f"line {self.line}"
        return printable(f"{place}: {self.what}" if place else self.what).replace("\n", "\\n")


class InvalidParameter(ValueError):
    """A value that is not allowed; the message names object, requirement, value and unit.

    Parameters
    ----------
    message : str
        What is wrong, the value, what is allowed.
    where : str
        The place of the value, such as `links.rod.elements`; empty if the message says it.
    problems : tuple of Problem
        Everything that was found wrong, `message` being the first of it.
    """

    def __init__(self, message: str, *, where: str = "", problems: tuple[Problem, ...] = ()) -> None:
        self.where = where
        self.problems = problems or (Problem(where, message),)
        super().__init__(printable(f"{where}: {message}" if where else message))


class InvalidFile(InvalidParameter):
    """A file that cannot be read as what it should be.

    The message reads `FILE: WHERE: what is wrong, the value, what is allowed`.

    Attributes
    ----------
    file : str
        The file as the user named it.
    where : str
        Place of the first problem.
    problems : tuple of Problem
        All problems found, in the order of the file's format.
    """

    def __init__(
        self,
        file: str | Path,
        where: str,
        what: str,
        *,
        line: int | None = None,
        problems: tuple[Problem, ...] = (),
    ) -> None:
        first = Problem(where, what, line)
        super().__init__(f"{file}: {first}", problems=problems or (first,))
        self.file = str(file)
        self.where = where

    def __reduce__(self) -> tuple[object, ...]:
        """Return the constructor and its arguments, since the message alone does not make this error."""
        first = self.problems[0]
        keywords = {"line": first.line, "problems": self.problems}
        return partial(type(self), **keywords), (self.file, self.where, first.what)  # type: ignore[arg-type]

    def lines(self) -> list[str]:
        """Return every problem as `FILE: WHERE: what`."""
        return [printable(f"{self.file}: {problem}") for problem in self.problems]


class NotConverged(RuntimeError):
    """A computation that found no solution; carries where it stood, ready to print or plot.

    Parameters
    ----------
    message : str
        Step, residual and its limit, or why there is no solution.
    time : float, optional
        Time [s] of the failing step; None in statics.
    iteration : int, optional
        Iterations done.
    residual : float, optional
        Norm of the residual [N or N m].
    """

    def __init__(
        self,
        message: str,
        *,
        time: float | None = None,
        iteration: int | None = None,
        residual: float | None = None,
    ) -> None:
        super().__init__(message)
        self.time = time
        self.iteration = iteration
        self.residual = residual
