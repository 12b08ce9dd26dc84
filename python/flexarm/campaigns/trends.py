"""Change of what diagnoses found over the dates of a fleet.

Of a parameter's estimates y_gt of machines g at times t, with a constant of each machine,

    y_gt = a_g + b t + e,  b = sum (t - t_g)(y - y_g) / sum (t - t_g)^2                                   (1)

where t_g and y_g are the means of a machine. The standard error of b is that of clusters, the machines, so
estimates of one machine may be correlated,

    var b = G/(G - 1) sum_g (sum_t (t - t_g) e)^2 / (sum (t - t_g)^2)^2.                                  (2)

Source: M. Arellano, "Computing robust standard errors for within-groups estimators", Oxford Bulletin of
Economics and Statistics 49 (1987), 431-434.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from datetime import date

import numpy as np

from flexarm.arrays import Floats


@dataclass(frozen=True)
class Trend:
    """How one number changes."""

    name: str
    unit: str
    slope: float
    std: float
    """Change a year and its standard error; of times that are no dates, a unit of them."""
    mean: float
    """Mean of all estimates."""
    time: Floats
    value: Floats
    """Estimates and their times, since the first, in years, shape (n,)."""
    group: tuple[str, ...]
    """Machine of each."""

    @property
    def score(self) -> float:
        """Slope in standard errors."""
        return self.slope / self.std if self.std > 0 else 0.0


def times_of(labels: Mapping[str, Sequence[str]]) -> tuple[str, Floats, bool] | None:
    """Return the label that is a time, its values since the first, and True for dates, in years; or None."""
    year = 365.25  # days of a year
    for parse, dates in ((_day, True), (float, False)):  # numbers may be names of machines
        for name, texts in labels.items():
            try:
                days = np.array([parse(text) for text in texts], dtype=float)
            except ValueError:
                continue
            if len(set(days)) > 1:
                return name, (days - days.min()) / (year if dates else 1.0), dates
    return None


def _day(text: str) -> float:
    """Return the day of an ISO date, YYYY-MM-DD, YYYY-MM or YYYYMMDD."""
    return float(date.fromisoformat(f"{text}-01" if len(text) == 7 else text).toordinal())


def trend(name: str, unit: str, time: Floats, value: Floats, group: Sequence[str]) -> Trend | None:
    """Return the trend (1) of the values that are there; None with fewer than two groups of two times."""
    known = np.isfinite(value)
    t, y = time[known].copy(), value[known].copy()
    groups = np.array(group)[known]
    kept = tuple(map(str, groups))
    raw_time, raw_value = t.copy(), y.copy()
    clusters = [groups == each for each in dict.fromkeys(kept)]
    moving = [rows for rows in clusters if len(set(t[rows])) > 1]
    if len(moving) < 2:
        return None
    for rows in clusters:
        t[rows] -= t[rows].mean()
        y[rows] -= y[rows].mean()
    inertia = float(t @ t)
    slope = float(t @ y) / inertia  # eq. (1)
    scores = np.array([float(t[rows] @ (y[rows] - slope * t[rows])) for rows in moving])
    count = len(moving)
    std = float(np.sqrt(count / (count - 1) * np.sum(scores**2))) / inertia  # eq. (2)
    return Trend(name, unit, slope, std, float(raw_value.mean()), raw_time, raw_value, kept)
