"""Standard output and error, be they closed, broken, full, or of an encoding that lacks our signs."""

from __future__ import annotations

import codecs
import os
import sys
from io import TextIOWrapper
from typing import TextIO

SIGNS = {"±": "+-", "µ": "u", "²": "2", "³": "3", "⁴": "4", "–": "-", "−": "-", "°": "deg"}
"""Signs in summaries and units, and their ASCII form."""


class Patient(TextIOWrapper):
    """A stream that drops what it cannot write, so that the command goes on and its exit code is right."""

    forgiven: type[OSError] = BrokenPipeError
    """What is no error: standard output's reader may go away; standard error tells where nothing else can."""

    def write(self, text: str, /) -> int:
        """Write, or drop the text and all that follows."""
        try:
            return super().write(text)
        except self.forgiven:
            self._mute()
            return len(text)

    def flush(self) -> None:
        """Flush, or drop what waits and all that follows."""
        try:
            super().flush()
        except self.forgiven:
            self._mute()

    def _mute(self) -> None:
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, self.fileno())
        os.close(null)
        super().flush()


def prepare() -> None:
    """Make the standard streams ones that can always be written to."""
    codecs.register_error("flexarm", _plain)
    sys.stdout = _patient(sys.stdout, 1, BrokenPipeError)
    sys.stderr = _patient(sys.stderr, 2, OSError)


def _plain(error: UnicodeError) -> tuple[str, int]:
    """Return characters that an encoding lacks: our own signs as one would type them, others as escapes."""
    assert isinstance(error, UnicodeEncodeError)
    signs = error.object[error.start : error.end]
    text = "".join(SIGNS.get(sign) or sign.encode("ascii", "backslashreplace").decode() for sign in signs)
    return text, error.end


def _patient(stream: TextIO | None, number: int, forgiven: type[OSError]) -> Patient:
    if isinstance(stream, TextIOWrapper):
        lines, through = stream.line_buffering or number == 2, stream.write_through
        made = Patient(stream.detach(), stream.encoding, "flexarm", None, lines, through)
    else:
        made = Patient(os.fdopen(number, "wb", closefd=False), "utf-8", "flexarm", None, True)
    made.forgiven = forgiven
    return made
