"""Validation of measured records: faults of sensors, clocks, frames and drives, before any physics."""
