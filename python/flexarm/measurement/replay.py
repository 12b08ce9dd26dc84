"""A simulated run written as the record that drove it: the same signals at the same stamps, without noise."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from flexarm.measurement.frames import Registration
from flexarm.measurement.predict import predict
from flexarm.measurement.sampling import CannotMeasure

if TYPE_CHECKING:
    from flexarm.record import Record


def replay(simulation: Any, record: Record) -> Record:
    """The record that the simulation predicts, with the signals of a measured one.

    Parameters
    ----------
    simulation : Simulation
        A run along the record's drives.
    record : Record
        Says which signals at which stamps, with which clocks and frames.

    Returns
    -------
    Record
        Values predicted, drives as they were; signals that the simulation does not hold are left out.
    """
    found = {}
    for name, signal in record.signals.items():
        if name in record.drive:
            found[name] = signal
            continue
        frame = record.frame_of(signal)
        try:
            values = predict(simulation, signal, registration=Registration(origin=frame.xyz, rpy=frame.rpy))
        except CannotMeasure:
            continue
        found[name] = signal.replace(values=values)
    return record.replace(signals=found)
