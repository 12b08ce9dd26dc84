"""The command `flexarm`: thin commands, one a file, that call the library."""

from __future__ import annotations

import os

from flexarm.termination import exit_on_signals, stay

TYPE_CHECKING = False
if TYPE_CHECKING:
    from collections.abc import Sequence
    from typing import NoReturn

__all__ = ["main"]


def main(arguments: Sequence[str] | None = None) -> NoReturn:
    """Entry point of the command line."""
    while (
        number := os.open(os.devnull, os.O_RDWR)
    ) < 3:  # closed standard streams: files would take their numbers
        pass
    os.close(number)
    exit_on_signals()  # before all imports that take time
    import gc
    import logging
    import sys

    from flexarm.cli import streams
    from flexarm.cli.run import run

    streams.install_tolerant_streams()
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # it tells of caches that it cannot write
    os.environ["MPLBACKEND"] = "agg"  # figures go to files, whatever a shell's profile asks of windows
    gc.set_threshold(100_000)  # what imports make stays: looking through it again and again costs 50 ms
    code = run(list(sys.argv[1:] if arguments is None else arguments))
    stay()
    gc.freeze()  # the process ends: nothing is to be found that it would not free anyway
    sys.exit(code)
