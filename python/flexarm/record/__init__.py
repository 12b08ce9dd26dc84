"""Records, measured or virtual: a directory with `record.toml` and CSV files as frozen objects."""

from flexarm.record.record import Record
from flexarm.record.signal import Signal
from flexarm.record.table import BaseStand, CarriedPayload, Clock, DrawnLink, Frame

__all__ = ["BaseStand", "CarriedPayload", "Clock", "DrawnLink", "Frame", "Record", "Signal"]
