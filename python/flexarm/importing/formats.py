"""The format of a log, and its reader."""

from __future__ import annotations

from collections.abc import Sequence
from importlib import import_module
from pathlib import Path

from flexarm.errors import InvalidFile
from flexarm.foreign_files import log_kind
from flexarm.importing.map_file import Dialect
from flexarm.importing.source import Request, Source
from flexarm.importing.trial import try_apart
from flexarm.reading import regular_file

READERS = {
    "bag": "bag.Bag",
    "MCAP": "bag.Bag",
    "SQLite": "bag.Bag",
    "MATLAB": "matlab.MatFile",
    "HDF5": "hdf5.Hdf5File",
    "NetCDF": "hdf5.NetcdfFile",
    "Parquet": "columnar.ColumnarFile",
    "Feather": "columnar.ColumnarFile",
    "Excel": "spreadsheet.Spreadsheet",
    "spreadsheet": "spreadsheet.Spreadsheet",
    "TDMS": "tdms.TdmsLog",
    "MDF": "mdf.MdfLog",
    "C3D": "c3d.C3dFile",
    "GSI": "gsi.GsiFile",
}
"""Word of the kind of a file -> its reader."""


def opened(path: Path, dialect: Dialect, requests: Sequence[Request] = ()) -> Source:
    """Return a log, of which `requests` will be asked for.

    Raise InvalidFile if nothing is there, it is no log, or its bytes end a reader's process.
    """
    reader = reader_of(path)
    if reader.tried_apart:
        try_apart(reader, path, dialect, requests)
    return reader(path, dialect, requests)


def reader_of(path: Path) -> type[Source]:
    """Return the class that reads a log.

    Raise InvalidFile if nothing is there, or it is no log.
    """
    kind = log_kind(path)
    if kind is None:
        if path.is_dir():
            raise InvalidFile(path, "file", "is a directory, and no ROS 2 bag: it has no metadata.yaml")
        with regular_file(path).open("rb") as file:
            start = file.read(64)
        name = "optitrack.OptiTrack" if b"Format Version" in start else "delimited_text.DelimitedText"
    else:
        words = kind.replace(",", "").split()
        name = next(READERS[word] for word in words if word in READERS)
    module, _, label = name.partition(".")
    found: type[Source] = getattr(import_module(f"flexarm.importing.{module}"), label)
    return found
