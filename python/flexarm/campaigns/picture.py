"""Picture of one result of a campaign: how a number, or a series, spreads over the runs."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.consistency import missing
from flexarm.campaigns.findings import INSTANTS, LEVELS
from flexarm.errors import InvalidParameter

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


def draw(data: xr.Dataset, name: str | None, ax: Axes | None) -> Axes:
    """Return what `Campaign.plot` describes."""
    import matplotlib.pyplot as plt

    kept = [str(each) for each, variable in data.data_vars.items() if variable.dims[:1] == ("sample",)]
    kept = [each for each in kept if data[each].dtype.kind == "f"]
    first = next((each for each in kept if "measure" in data[each].attrs), None)
    chosen = first if name is None else name
    if chosen not in kept:
        raise InvalidParameter(missing("result", str(chosen), kept), where="name")
    variable = data[chosen][data["status"].values == "ok"]
    axes = plt.subplots()[1] if ax is None else ax
    label = f"{chosen} [{variable.attrs.get('units') or '-'}]"
    if variable.attrs.get("measure") == "series":
        _draw_bands(axes, variable)
        axes.set(xlabel="time [s]", ylabel=label, title="median, and 90 % of the runs")
    else:
        _draw_histograms(axes, variable)
        axes.set(xlabel=label, ylabel="runs")
    if variable.ndim > (2 if variable.attrs.get("measure") == "series" else 1):
        axes.legend()
    return axes


def _channels(variable: xr.DataArray, axis: int) -> list[str]:
    """Return the names along the last axis; one without a name if there is none."""
    return [str(each) for each in variable[variable.dims[axis]].values] if variable.ndim > axis else [""]


def _draw_histograms(axes: Axes, variable: xr.DataArray) -> None:
    columns = variable.values.reshape(variable.sizes["sample"], -1)
    bins = min(40, max(8, len(columns) // 20))
    for column, channel in zip(columns.T, _channels(variable, 1), strict=True):
        axes.hist(column[np.isfinite(column)], bins=bins, alpha=0.6, label=channel)


def _draw_bands(axes: Axes, variable: xr.DataArray) -> None:
    """Draw the median of each channel, and what holds 90 % of the runs."""
    time = str(variable.dims[1])
    thinned = variable.isel({time: slice(None, None, max(1, variable.sizes[time] // INSTANTS))})
    low, _, median, _, high = np.nanquantile(thinned.values, LEVELS, axis=0).reshape(  # drives end apart
        len(LEVELS), thinned.sizes[time], -1
    )
    for k, channel in enumerate(_channels(variable, 2)):
        (line,) = axes.plot(thinned[time], median[:, k], label=channel)
        axes.fill_between(thinned[time], low[:, k], high[:, k], color=line.get_color(), alpha=0.25, lw=0)
