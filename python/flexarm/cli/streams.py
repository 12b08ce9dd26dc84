"""Standard output and error that tolerate closed, broken and full streams and narrow encodings."""

from __future__ import annotations

import codecs
import os
import sys
from io import TextIOWrapper
from typing import TextIO

ASCII_FORMS = {"±": "+-", "µ": "u", "μ": "u", "²": "2", "³": "3", "⁴": "4", "–": "-", "−": "-", "°": "deg"}
"""Signs in summaries and units, and their ASCII form."""


class TolerantStream(TextIOWrapper):
    """A stream that drops what it cannot write, so that the command goes on and its exit code is right."""

    ignored_error: type[OSError] = BrokenPipeError
    """What is no error: standard output's reader may go away; standard error tells where nothing else can."""

    def write(self, text: str, /) -> int:
        """Write, or drop the text and all that follows."""
        try:
            return super().write(text)
        except self.ignored_error:
            mute(self)
            return len(text)

    def flush(self) -> None:
        """Flush, or drop what waits and all that follows."""
        try:
            super().flush()
        except self.ignored_error:
            mute(self)
            super().flush()


def mute(stream: TextIO) -> None:
    """Send what a stream still writes to nowhere."""
    null = os.open(os.devnull, os.O_WRONLY)
    os.dup2(null, stream.fileno())
    os.close(null)


def install_tolerant_streams() -> None:
    """Make the standard streams ones that can always be written to."""
    codecs.register_error("flexarm", _to_ascii)
    sys.stdout = _tolerant(sys.stdout, 1, BrokenPipeError)
    sys.stderr = _tolerant(sys.stderr, 2, OSError)


def _to_ascii(error: UnicodeError) -> tuple[str, int]:
    """Return characters that an encoding lacks: our own signs as one would type them, others as escapes."""
    assert isinstance(error, UnicodeEncodeError)
    signs = error.object[error.start : error.end]
    escaped = {sign: sign.encode("ascii", "backslashreplace").decode() for sign in signs}
    text = "".join(ASCII_FORMS.get(sign, escaped[sign]) for sign in signs)
    return text, error.end


def _tolerant(stream: TextIO | None, number: int, ignored_error: type[OSError]) -> TolerantStream:
    if isinstance(stream, TextIOWrapper):
        lines, through = stream.line_buffering or number == 2, stream.write_through
        made = TolerantStream(stream.detach(), stream.encoding, "flexarm", None, lines, through)
    else:
        made = TolerantStream(os.fdopen(number, "wb", closefd=False), "utf-8", "flexarm", None, True)
    made.ignored_error = ignored_error
    return made
