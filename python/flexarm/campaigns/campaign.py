"""The results of a campaign: read, told in lines, drawn."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from flexarm.arguments import takes
from flexarm.campaigns.store import RESULTS
from flexarm.errors import InvalidFile
from flexarm.pictures import Shown
from flexarm.reading import check_hdf5, reading

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

STUDY, SUMMARY = "study.json", "summary.html"
FORMAT = "flexarm-campaign/1"


@dataclass(frozen=True)
class Campaign(Shown):
    """A campaign that is done.

    Attributes
    ----------
    directory : Path
        Where its files lie.
    record : dict
        What `study.json` holds: what ran, versions, hashes, failures.
    """

    directory: Path
    record: dict[str, Any]

    def __repr__(self) -> str:
        return f"<Campaign in {str(self.directory)!r}: {self.summary().splitlines()[0]}>"

    @property
    def dataset(self) -> xr.Dataset:
        """Return the results, which stay in their file until they are asked for."""
        import xarray as xr

        path = self.directory / RESULTS
        check_hdf5(path)
        with reading(path, "NetCDF"):
            return xr.open_dataset(path, engine="h5netcdf")

    @classmethod
    @takes()
    def load(cls, directory: str | Path) -> Campaign:
        """Return the campaign in a directory.

        Raises
        ------
        InvalidFile
            If there is none, or it is not finished.
        """
        folder = Path(directory)
        record = read_record(folder / STUDY)
        if not (folder / RESULTS).is_file():
            what = "is not there: the campaign is not finished; --resume goes on"
            raise InvalidFile(folder, "results.nc", what)
        if record.get("state") != "finished":
            raise InvalidFile(folder / STUDY, "state", "must be 'finished'; --resume goes on")
        found = cls(folder, record)
        with reading(folder / STUDY, "what a campaign wrote"):
            found.summary()  # of the counts in the record
        return found

    @property
    def files(self) -> tuple[str, ...]:
        """Names of its files."""
        return tuple(name for name in (STUDY, RESULTS, SUMMARY) if (self.directory / name).is_file())

    @takes()
    def plot(self, name: str | None = None, ax: Axes | None = None) -> Axes:
        """Draw how a result spreads over the runs that did not fail.

        A number is drawn as a histogram, a series as its median and the band that holds 90 % of the runs.

        Parameters
        ----------
        name : str, optional
            A variable of `dataset`; default: the first that was asked for.
        ax : matplotlib Axes, optional
            Where to draw.

        Raises
        ------
        InvalidParameter
            If there is no such result.
        """
        from flexarm.campaigns.picture import draw

        with self.dataset as data:
            return draw(data, name, ax)

    def summary(self) -> str:
        """Return what ran and what was found, in lines."""
        runs, counts = self.record["runs"], self.record["reasons"]
        lines = [
            f"{runs['ok'] + runs['failed']} runs, {runs['ok']} ok, {runs['failed']} failed: "
            f"{self.record['run_seconds']:.1f} s of computing"
        ]
        lines += [f"  {count} x {reason}" for reason, count in list(counts.items())[:5]]
        lines += [f"  {sentence}" for sentence in self.record.get("findings", ())]
        return "\n".join(lines)


def read_record(file: Path) -> dict[str, Any]:
    """Return what `study.json` holds."""
    if not file.is_file():
        raise InvalidFile(file, "file", "there is no such file; a campaign leaves it")
    with reading(file, "what a campaign wrote"):
        found = json.loads(file.read_text(encoding="utf-8"))
    if not isinstance(found, dict) or found.get("format") != FORMAT:
        raise InvalidFile(file, "format", f"must be {FORMAT!r}")
    return found
