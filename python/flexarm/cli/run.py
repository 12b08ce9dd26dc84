"""Runs a command and turns whatever happens into an exit code and one line on standard error.

0: done. 2: the input is at fault. 3: the numbers are at fault. 130: Ctrl-C, 143: SIGTERM, either of which is
told, and leaves nothing behind but whole output; see `flexarm.termination`. Never a traceback for a user's
mistake.
"""

from __future__ import annotations

import os
import sys

from flexarm.cli.streams import mute
from flexarm.errors import InvalidFile, InvalidParameter, NotConverged, printable
from flexarm.termination import farewell

INPUT_AT_FAULT, NUMBERS_AT_FAULT, INTERRUPTED = 2, 3, 130


def run(arguments: list[str]) -> int:
    """Run one command, given as on the command line; none shows the help. Return the exit code."""
    os.environ.setdefault("PYDANTIC_DISABLE_PLUGINS", "true")  # looking for plugins costs 15 ms
    # Our dense matrices are small: threads that wait for one another cost more than they save.
    os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
    try:
        from flexarm.cli.app import app_for
        from flexarm.output import written

        written.clear()

        app = app_for(arguments)
        code = app(args=arguments or ["--help"], prog_name="flexarm", standalone_mode=False)
        sys.stdout.flush()
        if code == INTERRUPTED:  # what typer makes of Ctrl-C
            return _interrupted()
        return code if isinstance(code, int) else 0
    except KeyboardInterrupt:
        return _interrupted()
    except BrokenPipeError:  # the reader of our output went away, as `flexarm ... | head` does
        mute(sys.stdout)  # what is left in its buffer, so that leaving does not fail again
        return 0
    except Exception as error:
        return _report(error)


def _interrupted() -> int:
    """Say that a command was stopped, where a caller of `run` handles Ctrl-C by an exception."""
    print(farewell("interrupted"), file=sys.stderr)
    return INTERRUPTED


def _report(error: Exception) -> int:
    """Print the error; anything that is not the user's or the numbers' fault is a bug and is raised."""
    if type(error).__name__ == "Abort":
        return _interrupted()
    if isinstance(error, InvalidFile):
        lines, code = error.lines(), INPUT_AT_FAULT
    elif isinstance(error, InvalidParameter):
        lines, code = [str(error)], INPUT_AT_FAULT
    elif isinstance(error, NotConverged):
        lines, code = [_told(error)], NUMBERS_AT_FAULT
    elif hasattr(error, "format_message"):  # an option that does not exist, an argument that is missing
        lines, code = [f"command line: {' '.join(error.format_message().split())}"], INPUT_AT_FAULT
    elif isinstance(error, MemoryError):
        lines, code = (
            ["memory: not enough of it; take fewer elements, a longer --step or a shorter run"],
            INPUT_AT_FAULT,
        )
    elif isinstance(error, OSError) and error.filename is not None:
        lines, code = [f"{error.filename}: file: {error.strerror}"], INPUT_AT_FAULT
    elif isinstance(error, OSError):  # without a file's name: standard output, full or closed
        mute(sys.stdout)  # what is left in its buffer, so that leaving does not fail again
        lines, code = [f"standard output: cannot be written: {error.strerror}"], INPUT_AT_FAULT
    else:
        raise error
    sys.stdout.flush()
    for line in lines:
        print(f"error: {printable(line)}", file=sys.stderr)
    return code


def _told(error: NotConverged) -> str:
    """Return the message with time, iteration and residual, where they are known."""
    facts = [
        f"{name} = {value:.6g}{unit}"
        for name, value, unit in (
            ("time", error.time, " s"),
            ("iteration", error.iteration, ""),
            ("residual", error.residual, ""),
        )
        if value is not None
    ]
    return f"{error}" + (f" ({', '.join(facts)})" if facts else "")
