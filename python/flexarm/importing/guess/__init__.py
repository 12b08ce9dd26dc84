"""A proposal of an import map from the logs and the model, with a reason for each line."""

from flexarm.importing.guess.workflow import guess_map

__all__ = ["guess_map"]
