"""The command `flexarm`: thin commands, one a file, that call the library."""

from flexarm.cli.run import main

__all__ = ["main"]
