"""A record as one table for other programs: a row an instant, a column a channel."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.quantities import channel_names

if TYPE_CHECKING:
    import pandas as pd

    from flexarm.record.record import Record
    from flexarm.record.signal import Signal


def columns_of(signal: Signal) -> list[str]:
    """Return the names of a signal's columns, such as `tip_x`; of a scalar its own.

    A frequency response has two columns a channel, such as `tip_x_real` and `tip_x_imaginary`.
    """
    axes = channel_names(signal.quantity, signal.axes)
    names = [f"{signal.name}_{axis}" if axis else signal.name for axis in axes]
    if signal.frequency is None:
        return names
    return [f"{name}_{part}" for name in names for part in ("real", "imaginary")]


def data_frame(record: Record) -> pd.DataFrame:
    """Return the signals side by side, empty where a signal has no sample at an instant."""
    import pandas as pd

    static, responses = record.kind == "static", record.kind == "frequency_response"
    if static:  # rows of one pose belong together: the first reading of each with the first of another signal
        frames = [_of_poses(signal) for signal in record.signals.values()]
    else:
        frames = [
            pd.DataFrame(signal.values, index=signal.stamps, columns=columns_of(signal))
            for signal in record.signals.values()
            if not responses or signal.input
        ]
    joined = pd.concat(frames, axis=1, sort=not static)
    names = ["hz"] if responses else ["time_s"]
    joined.index = joined.index.set_names(["pose", "reading"] if static else names)
    joined.attrs["units"] = {c: s.unit for s in record.signals.values() for c in columns_of(s)}
    return joined


def _of_poses(signal: Signal) -> pd.DataFrame:
    """Return readings by pose and number within it."""
    import pandas as pd

    assert signal.pose is not None
    frame = pd.DataFrame(signal.values, columns=columns_of(signal))
    number = frame.groupby(signal.pose).cumcount() + 1
    frame.index = pd.MultiIndex.from_arrays([signal.pose, number])
    return frame
