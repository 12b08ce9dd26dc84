"""Records from logs of other programs: an import map says where each signal stands and how it is meant."""

from flexarm.importing.workflow import import_record

__all__ = ["import_record"]
