"""What a campaign says, from its file of results: distributions, bands, indices, yield, trends of a fleet.

The file is read in pieces, so memory does not grow with the number of samples.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from flexarm.arrays import Floats
from flexarm.campaigns.indices import LEAST, Indices, SeriesIndices, from_saltelli, from_samples
from flexarm.campaigns.trends import Trend, times_of, trend

if TYPE_CHECKING:
    import xarray as xr

LEVELS = (0.05, 0.25, 0.5, 0.75, 0.95)
"""Quantiles that are told."""
INSTANTS = 400
"""Of a band that is drawn."""
PIECE = 2**26
"""Bytes of a piece that is read at once."""


@dataclass(frozen=True)
class Target:
    """A number of every run."""

    name: str
    text: str
    unit: str
    """Its name, what it is, its unit."""
    values: Floats
    """Of the runs that did not fail, shape (n,)."""
    quantiles: Floats
    """At `LEVELS`, shape (5,)."""
    nominal: float | None
    """Of the nominal run; statistics of deviations have none."""
    indices: Indices | None
    """Of the parameters, in their order."""


@dataclass(frozen=True)
class Band:
    """Quantiles of a series over the runs of one case."""

    name: str
    text: str
    unit: str
    """Its name with channel and case, what it is, its unit."""
    time: Floats
    """Instants [s], shape (m,)."""
    quantiles: Floats
    """Of the deviation from the nominal run, at `LEVELS`, shape (5, m)."""


@dataclass(frozen=True)
class Cost:
    """How far each parameter alone moves a series."""

    name: str
    unit: str
    rms: float
    """Standard deviation over the runs, rms over the instants, of all channels together."""
    first: Floats
    """Part of its square that each parameter explains alone, shape (d,)."""
    chance: float
    """Part below which it may be chance."""

    @property
    def each(self) -> Floats:
        """Standard deviation that each parameter makes by itself."""
        return self.rms * np.sqrt(np.maximum(self.first, 0.0))


@dataclass(frozen=True)
class Yield:
    """Share of runs within a tolerance; a failed run is not."""

    name: str
    unit: str
    tolerance: float
    """Greatest deviation that is allowed."""
    share: float
    low90: float
    high90: float
    """Of all runs, with the interval of Wilson for independent runs."""


@dataclass(frozen=True)
class Findings:
    """What a campaign says."""

    run: str
    count: int
    failed: int
    """Runs, and those that failed."""
    reasons: tuple[tuple[str, int], ...]
    """Why, the most frequent first."""
    parameters: tuple[tuple[str, str], ...]
    """Keys and units."""
    targets: tuple[Target, ...] = ()
    bands: tuple[Band, ...] = ()
    costs: tuple[Cost, ...] = ()
    yields: tuple[Yield, ...] = ()
    """Of runs of a model."""
    named: tuple[tuple[str, int, float], ...] = ()
    """Of diagnoses: effect and place, how many named it, mean probability there."""
    verdicts: tuple[tuple[str, int], ...] = ()
    """Of diagnoses."""
    trends: tuple[Trend, ...] = ()
    """The surest first."""
    time: str = ""
    """Unit of the trends' time: "year", or the label's name."""
    more_targets: int = 0
    """Targets that are left out."""


def findings_of(data: xr.Dataset, keys: Sequence[str], labels: Sequence[str], seed: int = 0) -> Findings:
    """Return what results say, given keys of what varied, labels of cases and the seed of the bootstrap."""
    most_targets = 12  # numbers that are told one by one
    ok = data["status"].values == "ok"
    reasons = Counter(str(reason) for reason in data["reason"].values[~ok])
    about = (
        str(data.attrs["run"]),
        len(ok),
        int((~ok).sum()),
        tuple(reasons.most_common(10)),
        tuple((key, str(data[key].attrs.get("units", ""))) for key in keys),
    )
    if data.attrs["run"] == "diagnose":
        times = times_of({label: [str(text) for text in data[label].values] for label in labels})
        time = "" if times is None else "year" if times[2] else times[0]
        found = _trends(data, labels, times, ok) if times else ()
        counted = Counter(str(verdict) for verdict in data["verdict"].values[ok])
        verdicts = tuple(counted.most_common())
        return Findings(*about, named=_named(data), verdicts=verdicts, trends=found, time=time)
    targets = list(_targets(data, keys, ok, seed))
    return Findings(
        *about,
        targets=tuple(targets[:most_targets]),
        bands=tuple(_bands(data, ok, labels)),
        costs=tuple(_costs(data, keys, ok)),
        yields=tuple(_yields(data, ok)),
        more_targets=max(0, len(targets) - most_targets),
    )


def _measured(data: xr.Dataset, *measures: str) -> Iterator[str]:
    for name, variable in data.data_vars.items():
        if variable.attrs.get("measure") in measures:
            yield str(name)


def _targets(data: xr.Dataset, keys: Sequence[str], ok: Any, seed: int) -> Iterator[Target]:
    """Yield every number that a run has: statistics, and each component of what is no series."""
    x = np.stack([data[key].values for key in keys], axis=1) if keys else np.zeros((len(ok), 0))
    swapped = "block" in data.coords
    for name in _measured(data, "rms", "max", "final", "value"):
        variable = data[name]
        whole = variable.values.reshape(len(ok), -1)
        nominal = _nominal(data, name)
        suffixes = [""]
        if whole.shape[1] > 1:
            dim = str(variable.dims[1])
            suffixes = [f" {each}" for each in data[dim].values]
        for k, suffix in enumerate(suffixes):
            values = whole[:, k]
            there = ok & np.isfinite(values)
            if not there.any():
                continue
            if swapped:
                rows = np.where(there, values, np.nan).reshape(_cases(data), len(keys) + 2, -1)
                known = np.isfinite(rows[:, :2]).sum(
                    axis=(1, 2), keepdims=True
                )  # none where a whole case failed
                rows = rows - np.nansum(rows[:, :2], axis=(1, 2), keepdims=True) / np.maximum(known, 1)
                indices = from_saltelli(np.concatenate(list(rows), axis=1), seed)
            else:  # about the mean of each case: how cases differ is no parameter's part
                off = np.where(there, values, np.nan)
                for case in _case_rows(data):
                    off[case] -= np.nanmean(off[case]) if there[case].any() else 0.0
                indices = from_samples(x[there], off[there], seed)
            yield Target(
                name + suffix,
                str(variable.attrs["long_name"]) + suffix,
                str(variable.attrs["units"]),
                values[there],
                np.quantile(values[there], LEVELS),
                None if nominal is None else float(nominal[0].reshape(-1)[k]),
                indices,
            )


def _cases(data: xr.Dataset) -> int:
    return int(data.attrs["cases"])


def _nominal(data: xr.Dataset, name: str) -> Floats | None:
    """Return the nominal values of a variable, one for each case, or None."""
    found = f"{name}_nominal"
    if found not in data:
        return None
    values = np.asarray(data[found].values)
    return values if "case" in data[found].dims else values[None]


def _case_rows(data: xr.Dataset) -> list[slice]:
    """Return the samples of each case."""
    count, cases = data.sizes["sample"], _cases(data)
    return [slice(k * count // cases, (k + 1) * count // cases) for k in range(cases)]


def _bands(data: xr.Dataset, ok: Any, labels: Sequence[str]) -> Iterator[Band]:
    """Yield the quantiles of the deviation of every channel of a series that leaves its nominal run."""
    for name in _measured(data, "series"):
        variable, nominal = data[name], _nominal(data, name)
        if nominal is None:
            continue
        time_name = str(variable.dims[1])
        channels = [""] if variable.ndim == 2 else [f" {each}" for each in data[str(variable.dims[2])].values]
        for case, rows in enumerate(_case_rows(data)):
            good = ok[rows]
            if not good.any():
                continue
            every = max(1, variable.shape[1] // INSTANTS)
            instants = np.arange(0, variable.shape[1], every)
            quantiles = np.full((len(channels), len(LEVELS), len(instants)), np.nan)
            step = max(1, PIECE // (8 * len(good) * len(channels)))
            for first in range(0, len(instants), step):
                chosen = instants[first : first + step]
                values = np.asarray(variable[rows, chosen].values)[good]
                off = (values - nominal[case][chosen]).reshape(len(values), len(chosen), len(channels))
                with np.errstate(invalid="ignore"):
                    found = np.quantile(off, LEVELS, axis=0)
                quantiles[:, :, first : first + step] = found.transpose(2, 0, 1)
            where = "".join(f", {data[label].values[rows.start]}" for label in labels)
            for k, channel in enumerate(channels):
                if not np.nan_to_num(quantiles[k]).any():  # such as across the plane of a planar arm
                    continue
                yield Band(
                    f"{name}{channel}{where}",
                    f"{variable.attrs['long_name']}{channel}{where}",
                    str(variable.attrs["units"]),
                    np.asarray(data[time_name].values[instants]),
                    quantiles[k],
                )


def _costs(data: xr.Dataset, keys: Sequence[str], ok: Any) -> Iterator[Cost]:
    """Yield what each parameter makes of every series, over independent rows of the samples alone."""
    x = np.stack([data[key].values for key in keys], axis=1)
    if "block" in data.coords:
        ok = ok & np.isin(data["block"].values, ("A", "B"))
    for name in _measured(data, "series"):
        variable, shares, squares, chance = data[name], [], [], 0.0
        for rows in _case_rows(data):
            good = ok[rows]
            if good.sum() < LEAST:
                continue
            gathered, instants = SeriesIndices(x[rows][good]), 0
            step = max(1, PIECE // (8 * len(good) * int(np.prod(variable.shape[2:], dtype=int))))
            for first in range(0, variable.shape[1], step):
                values = np.asarray(variable[rows, first : first + step].values)[good]
                known = np.isfinite(values).reshape(*values.shape[:2], -1).all(axis=(0, 2))
                gathered.add(values[:, known].reshape(len(values), -1))
                instants += int(known.sum())
            shares.append(gathered.first)
            chance = max(chance, gathered.chance)
            squares.append(gathered.variance / max(instants, 1))
        if shares and sum(squares) > 0:
            explained = np.average(shares, axis=0, weights=squares)
            yield Cost(
                name, str(variable.attrs["units"]), float(np.sqrt(np.mean(squares))), explained, chance
            )


def _yields(data: xr.Dataset, ok: Any) -> Iterator[Yield]:
    for name in data.data_vars:
        variable = data[str(name)]
        if "tolerance" not in variable.attrs:
            continue
        tolerance = float(variable.attrs["tolerance"])
        within = ok & (_greatest(data, str(name)) <= tolerance)
        n, share = len(ok), float(within.mean())
        z2 = 1.645**2
        centre = (share + z2 / (2 * n)) / (1 + z2 / n)
        half = np.sqrt(z2 * (share * (1 - share) / n + z2 / (4 * n**2))) / (1 + z2 / n)
        unit = str(variable.attrs["units"])
        yield Yield(str(name), unit, tolerance, share, max(0.0, centre - half), min(1.0, centre + half))


def _greatest(data: xr.Dataset, name: str) -> Floats:
    """Return the greatest length of the deviation from the nominal run, by sample."""
    variable, nominal = data[name], _nominal(data, name)
    found = np.full(data.sizes["sample"], np.nan)
    width = 8 * max(1, int(np.prod(variable.shape[1:], dtype=int)))
    step = max(1, PIECE // width)
    for case, rows in enumerate(_case_rows(data)):
        for first in range(rows.start, rows.stop, step):
            some = slice(first, min(first + step, rows.stop))
            off = np.asarray(variable[some].values)
            off = off if nominal is None else off - nominal[case]
            if "axis" in variable.dims or f"{name}_axis" in variable.dims:
                off = np.linalg.norm(off, axis=-1)
            off = np.abs(off).reshape(len(off), -1)
            known = np.isfinite(off).any(axis=1)
            found[some][known] = np.nanmax(off[known], axis=1)
    return found


# ------------------------------------------------------------------------------------------- diagnoses


def _named(data: xr.Dataset) -> tuple[tuple[str, int, float], ...]:
    found = []
    for name in _measured(data, "found"):
        if name.endswith(".probability"):
            values = data[name].values
            there = np.isfinite(values)
            place = name.removeprefix("effects.").removesuffix(".probability")
            found.append((place, int(there.sum()), float(values[there].mean())))
    return tuple(sorted(found, key=lambda each: -each[1]))


def _trends(
    data: xr.Dataset, labels: Sequence[str], times: tuple[str, Floats, bool], ok: Any
) -> tuple[Trend, ...]:
    """Return the trends of all parameters that diagnoses found, the surest first."""
    label, time, _ = times
    others = [name for name in labels if name != label]
    group = [" ".join(map(str, each)) for each in zip(*(data[name].values for name in others), strict=True)]
    group = group or [""] * len(ok)
    found = []
    for name in _measured(data, "found"):
        if name.startswith(("effects.", "refined.")) and not name.endswith((".std", ".probability")):
            values = np.where(ok, data[name].values, np.nan)
            each = trend(name, str(data[name].attrs["units"]), time, values, group)
            found += [each] if each is not None else []
    return tuple(sorted(found, key=lambda each: -abs(each.score)))
