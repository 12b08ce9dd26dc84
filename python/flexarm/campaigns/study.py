"""A study as a TOML file: what is run, what varies, how it is sampled and what is kept of each run."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator

from flexarm.arm.sensor import Axes
from flexarm.tables import (
    FrozenDict,
    Inconsistent,
    Name,
    Number,
    Numbers,
    Table,
    Texts,
    Vector2,
    check_table,
    read_toml,
    value_in,
)
from flexarm.tables.table import Whole, one_or_more

FORMAT = "flexarm-study/1"
Kind = Literal["simulate", "static", "modes", "diagnose"]
Statistic = Literal["rms", "max", "final"]
Found = list[tuple[tuple[str | int, ...], str]]
"""Pairs of place and sentence."""


JointValues = Annotated[dict[str, Number], AfterValidator(FrozenDict)]

_SHAPES: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "normal": (("std",), ("mean",)),
    "lognormal": (("std",), ("mean",)),
    "uniform": (("low", "high"), ()),
    "loguniform": (("low", "high"), ()),
    "values": (("values",), ()),
}
"""Keys that a distribution needs, and those that it may have."""


class Sampling(Table):
    """How samples are drawn."""

    method: Literal["sobol", "latin-hypercube", "random", "grid"] = "sobol"
    """Of `scipy.stats.qmc`, scrambled Sobol points the default."""
    n: Whole | None = Field(None, description="number of samples", ge=1, le=10_000_000)
    """Number of samples; a grid has as many as its levels make."""
    seed: Whole = Field(0, description="seed of the samples", ge=0)
    """Same seed, same samples."""
    saltelli: bool = False
    """Draw two sets of n samples and those that swap one parameter, n (d + 2) runs for d parameters: total
    Sobol indices need them."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        found: Found = []
        if self.method != "grid" and self.n is None:
            found.append((("n",), "is missing; needed is the number of samples"))
        if self.method == "grid" and self.n is not None:
            found.append((("n",), "does not belong to a grid, whose levels make its samples; leave it out"))
        if self.saltelli and self.method == "grid":
            found.append((("saltelli",), "does not fit a grid; allowed are sobol, latin-hypercube, random"))
        if found:
            raise Inconsistent(*found)
        return self


class Vary(Table):
    """A parameter that varies."""

    parameter: str = Field(description='key of a parameter, such as "payloads.load.mass"', min_length=1)
    """Key of a number in the model, such as "links.rod.material.youngs_modulus", or
    "effects.NAME.PLACE.PARAMETER", also of an effect that the model has not. A vector without a component
    varies in each, independently."""
    distribution: Literal["normal", "lognormal", "uniform", "loguniform", "values"] | None = None
    """Left out: normal about the model's value, 1 sigma from its `[uncertainty]`."""
    mean: Number | None = value_in("SI", "mean", None)
    std: Number | None = value_in("SI", "standard deviation", None, gt=0)
    """Of a normal or lognormal value itself; mean defaults to the model's value."""
    low: Number | None = value_in("SI", "least value", None)
    high: Number | None = value_in("SI", "greatest value", None)
    """Ends of a uniform or loguniform distribution."""
    values: Numbers = value_in("SI", "values, equally probable", ())
    levels: Whole | None = Field(None, description="number of values in a grid", ge=1)
    """Of a grid: how many values of a continuous distribution are taken."""

    @model_validator(mode="after")
    def _check(self) -> Self:
        if found := [*self._key_problems(), *self._size_problems()]:
            raise Inconsistent(*found)
        return self

    def _key_problems(self) -> Found:
        """Return keys that the distribution lacks, or has no use for."""
        needed, optional = _SHAPES[self.distribution] if self.distribution else ((), ())
        name = (
            f"distribution {self.distribution!r}"
            if self.distribution
            else "a normal distribution from [uncertainty]"
        )
        found: Found = []
        for key in ("mean", "std", "low", "high", "values"):
            given = getattr(self, key) not in (None, ())
            if key in needed and not given:
                found.append(((key,), f"is missing; {name} needs {' and '.join(needed)}"))
            if given and key not in (*needed, *optional):
                more = "" if self.distribution else "; say which distribution it belongs to"
                found.append(((key,), f"does not belong to {name}{more}"))
        return found

    def _size_problems(self) -> Found:
        """Return values that the distribution does not allow."""
        found: Found = []
        if self.low is not None and self.high is not None and not self.low < self.high:
            found.append((("high",), f"must be greater than low = {self.low:g}, got {self.high:g}"))
        if self.distribution == "loguniform" and self.low is not None and self.low <= 0:
            found.append((("low",), f"of a loguniform distribution must be positive, got {self.low:g}"))
        if self.distribution == "lognormal" and self.mean is not None and self.mean <= 0:
            found.append((("mean",), f"of a lognormal distribution must be positive, got {self.mean:g}"))
        if self.distribution == "values" and self.levels is not None:
            found.append((("levels",), "does not belong to distribution 'values'; each of them is a level"))
        return found


class Keep(Table):
    """A result that is kept of each run."""

    quantity: str = Field(description='what is kept, such as "position"', min_length=1)
    """Of a simulation: a quantity that sensors measure (docs/formats.md). Of an equilibrium: position,
    displacement, joint_torque or link_angle. Of modes: frequency_hz or damping_ratio."""
    name: Name | None = None
    """Of the variable in the results; default PLACE_QUANTITY."""
    joint: Name | None = None
    point: Name | None = None
    link: Name | None = None
    side: Literal["motor", "output"] | None = None
    axes: Axes = ()
    position: Number | None = value_in("m", "place along the link", None)
    fibre: Vector2 | None = value_in("m", "fibre [y, z] in the section", None)
    """As of a sensor."""
    rate_hz: Number | None = value_in("Hz", "samples a second", None, gt=0)
    """Samples a second of a simulation that are kept."""
    statistics: Annotated[tuple[Statistic, ...], BeforeValidator(one_or_more)] = ()
    """Of the length of the deviation from the nominal run, at every step; of a scalar "final" has a sign."""
    tolerance: Number | None = value_in("SI", "greatest deviation that is allowed", None, gt=0)
    """Greatest deviation from the nominal run that is allowed, for the yield."""

    @property
    def place(self) -> str:
        """Name of the joint, point or link."""
        return self.joint or self.point or self.link or ""

    @property
    def variable(self) -> str:
        """Name of the variable in the results."""
        return self.name or "_".join(filter(None, (self.place, self.quantity)))


_BELONGS: dict[str, tuple[str, ...]] = {
    "drive": ("simulate",),
    "records": ("diagnose",),
    "hold_out": ("diagnose",),
    "joints": ("static", "modes"),
    "count": ("modes",),
    "step": ("simulate", "diagnose"),
    "alpha": ("simulate", "diagnose"),
    "max_seconds": ("diagnose",),
    "keep": ("simulate", "static", "modes"),
}
"""Keys and the runs that have them."""


class Study(Table):
    """A study."""

    format: Literal["flexarm-study/1"] = "flexarm-study/1"
    run: Kind = Field(description="simulate, static, modes or diagnose")
    """What each sample is: "simulate", "static", "modes", "diagnose"."""
    model: str = Field(description="file of the model", min_length=1)
    """The model's file, from where the study lies, as are all files."""
    drive: Texts = ()
    """Of simulations: CSV files or records."""
    records: Texts = ()
    hold_out: str | None = None
    """Of diagnoses. A word in braces stands for any one folder, in records, hold_out and drive."""
    joints: JointValues = FrozenDict()
    """Drive angles of static and modes, output side [rad, m for a prismatic joint]."""
    count: Whole = Field(6, description="number of modes", ge=1)
    step: Number = value_in("s", "time step", 2e-3, gt=0)
    alpha: Number = value_in("-", "alpha of the HHT method", -0.05, ge=-1 / 3, le=0)
    """Time step [s] and alpha of HHT."""
    max_seconds: Number | None = value_in("s", "time of one diagnosis", None, gt=0)
    """Time that one diagnosis may take [s]."""
    sampling: Sampling | None = None
    vary: tuple[Vary, ...] = ()
    keep: tuple[Keep, ...] = ()

    @model_validator(mode="after")
    def _check(self) -> Self:
        if found := [*self._run_problems(), *self._vary_problems(), *self._keep_problems()]:
            raise Inconsistent(*found)
        return self

    def _run_problems(self) -> Found:
        """Return keys that the kind of run lacks, or has no use for."""
        found: Found = [
            ((key,), f"does not belong to run = {self.run!r}; it belongs to {' and '.join(runs)}")
            for key, runs in _BELONGS.items()
            if key in self.model_fields_set and self.run not in runs
        ]
        needed = {"simulate": "drive", "diagnose": "records"}.get(self.run)
        if needed and not getattr(self, needed):
            found.append(((needed,), f"is missing; run = {self.run!r} needs it"))
        if self.run in ("simulate", "static") and not self.keep:
            found.append((("keep",), f"is missing; run = {self.run!r} needs at least one [[keep]]"))
        return found

    def _vary_problems(self) -> Found:
        found: Found = []
        if not self.vary and self.run != "diagnose":
            found.append((("vary",), f"is missing; run = {self.run!r} needs at least one [[vary]]"))
        if self.vary and self.sampling is None:
            found.append((("sampling",), "is missing; [[vary]] needs a method, and n unless that is a grid"))
        if self.sampling is not None and not self.vary:
            found.append((("sampling",), "has nothing to sample; add [[vary]], or leave it out"))
        grid = self.sampling is not None and self.sampling.method == "grid"
        for i, vary in enumerate(self.vary):
            if grid and vary.levels is None and vary.distribution != "values":
                found.append((("vary", i, "levels"), "is missing; a grid needs the number of values"))
            if not grid and vary.levels is not None:
                what = "belongs to a grid alone; leave it out, or say method = 'grid'"
                found.append((("vary", i, "levels"), what))
        return found

    def _keep_problems(self) -> Found:
        found: Found = []
        names: set[str] = set()
        for i, keep in enumerate(self.keep):
            if keep.variable in names:
                what = f"{keep.variable!r} is kept twice; give one of them a name of its own"
                found.append((("keep", i, "name"), what))
            names.add(keep.variable)
            if self.run != "simulate":
                found += [
                    (("keep", i, key), f"belongs to run = 'simulate', not to {self.run!r}")
                    for key in ("rate_hz", "statistics", "side", "position", "fibre")
                    if getattr(keep, key) not in (None, ())
                ]
            elif keep.rate_hz is None and not keep.statistics:
                what = 'is missing; give samples a second, or statistics = ["rms", "max", "final"]'
                found.append((("keep", i, "rate_hz"), what))
            elif keep.tolerance is not None and keep.rate_hz is None and "max" not in keep.statistics:
                what = 'a tolerance is checked against the greatest deviation; add "max"'
                found.append((("keep", i, "statistics"), what))
        return found


def read_study(file: Path) -> tuple[Study, dict[str, Any], str]:
    """Return a study, the tables of its file as they stand, and its text.

    Raise InvalidFile with the place and value of every problem.
    """
    data, text = read_toml(file, FORMAT)
    return check_table(Study, data, file, text), data, text
