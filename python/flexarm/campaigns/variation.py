"""What varies in a study, resolved in its model: numbers, their distributions, and the arm of a sample."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

from flexarm.arm import Arm
from flexarm.arm.effect import effect_class, read_effect
from flexarm.arm.parameter import Parameter, Path, numbers_at, put_all, stated_sigma
from flexarm.campaigns.sampling import Distribution
from flexarm.campaigns.study import Found, Study, Vary
from flexarm.errors import InvalidParameter
from flexarm.tables.check import problems_of
from flexarm.tables.field import COMPONENTS, Nested


@dataclass(frozen=True)
class Variation:
    """Numbers of a model that vary."""

    base: Arm
    """The model, with the effects of which parameters vary and that it has not."""
    added: frozenset[tuple[str, str]]
    """Names and places of these effects."""
    parameters: tuple[Parameter, ...]
    paths: tuple[Path, ...]
    distributions: tuple[Distribution, ...]
    levels: tuple[int | None, ...]
    """Of each number that varies."""

    @property
    def keys(self) -> tuple[str, ...]:
        """Names of the numbers."""
        return tuple(parameter.key for parameter in self.parameters)

    def nominal(self, parameter: Parameter) -> float | None:
        """Return the value in the nominal model; None if it has no such effect, or it is infinite."""
        words = parameter.key.split(".", 3)
        added = words[0] == "effects" and (words[1], words[2]) in self.added
        return None if added or abs(parameter.value) == float("inf") else parameter.value

    def arm(self, values: Sequence[float]) -> Arm:
        """Return the arm of one sample.

        Raise InvalidParameter if a value is not allowed, such as a negative mass.
        """
        arm, tables = self.base, dict[tuple[object, ...], list[tuple[str, Path, float]]]()
        for key, path, value in zip(self.keys, self.paths, values, strict=True):
            place = path.table, path.index, *path.fields[:-1]
            tables.setdefault(place, []).append((key, path, float(value)))
        for changes in tables.values():  # a table's numbers at once: they may be allowed together only
            try:
                arm = put_all(arm, [(path, value) for _, path, value in changes])
            except InvalidParameter as error:
                where = ", ".join(key for key, _, _ in changes)
                raise InvalidParameter(error.problems[0].what, where=where) from None
        return arm


def variation_of(study: Study, arm: Arm) -> tuple[Variation, Found]:
    """Return what varies, and what is wrong with it."""
    base, found = _with_missing_effects(study, arm)
    taken: dict[str, tuple[Parameter, Path, Distribution, int | None]] = {}
    for i, vary in enumerate(study.vary if not found else ()):
        try:
            for parameter, path in numbers_at(base, vary.parameter):
                if parameter.key in taken:
                    found.append((("vary", i, "parameter"), f"{parameter.key} varies twice"))
                shape = _distribution(arm, vary, parameter)
                taken[parameter.key] = parameter, path, shape, vary.levels
        except _Wrong as wrong:
            found.append((("vary", i, wrong.key), wrong.what))
        except InvalidParameter as error:
            found.append((("vary", i, "parameter"), error.problems[0].what))
    columns = list(zip(*taken.values(), strict=True)) or [()] * 4
    there = {(effect.name, effect.at) for effect in arm.effects}
    added = frozenset((effect.name, effect.at) for effect in base.effects) - there
    return Variation(base, added, *columns), found


class _Wrong(Exception):
    """A key of a [[vary]] and what is wrong with it."""

    def __init__(self, key: str, what: str) -> None:
        super().__init__(what)
        self.key, self.what = key, what


def _distribution(arm: Arm, vary: Vary, parameter: Parameter) -> Distribution:
    """Return the distribution of one number.

    Raise _Wrong if the model does not say what the study leaves out.
    """
    if vary.distribution in ("uniform", "loguniform"):
        assert vary.low is not None and vary.high is not None
        return Distribution(vary.distribution, (vary.low, vary.high))
    if vary.distribution == "values":
        return Distribution("values", vary.values)
    mean, std = vary.mean, vary.std
    if std is None:
        std = stated_sigma(arm, parameter.key)
        if not std:
            stated = ", ".join(arm.uncertainty) or "nothing"
            what = (
                f"is missing; the model states no uncertainty of {parameter.key}, but of {stated}. "
                "Allowed are normal, lognormal, uniform, loguniform, values"
            )
            raise _Wrong("distribution", what)
    if mean is None:
        mean = parameter.value
        if _missing_effect(arm, vary) or abs(mean) == float("inf"):
            raise _Wrong("mean", f"is missing; the model has no value of {parameter.key} to take for it")
    if vary.distribution == "lognormal" and mean <= 0:
        raise _Wrong("mean", f"of a lognormal distribution must be positive, got {mean:g} from the model")
    return Distribution(vary.distribution or "normal", (mean, std))


def _missing_effect(arm: Arm, vary: Vary) -> tuple[str, str, str] | None:
    """Return name, place and parameter where a key is of an effect that the model has not."""
    words = vary.parameter.split(".", 3)
    if len(words) < 4 or words[0] != "effects" or arm.effect(words[1], words[2]) is not None:
        return None
    return words[1], words[2], words[3]


def _with_missing_effects(study: Study, arm: Arm) -> tuple[Arm, Found]:
    """Return the model with the effects of which only the study speaks, at the medians of their values."""
    asked: dict[tuple[str, str], list[tuple[int, str, Vary]]] = {}
    for i, vary in enumerate(study.vary):
        if (effect := _missing_effect(arm, vary)) is not None:
            asked.setdefault(effect[:2], []).append((i, effect[2], vary))
    found: Found = []
    for (name, at), entries in asked.items():
        try:
            values = dict(_median_values(name, entries))
            arm = arm.with_effect(read_effect({"name": name, "at": at, **values}))
        except _Wrong as wrong:
            found.append((("vary", entries[0][0], wrong.key), wrong.what))
        except ValueError as error:
            what = _first_problem(error)
            found.append((("vary", entries[0][0], "parameter"), f"{name} at {at}: {what}"))
    return arm, found


def _first_problem(error: ValueError) -> str:
    """Return what is wrong with an effect in one sentence."""
    if isinstance(error, Nested):
        path, what = problems_of(error.table, error.error, error.data)[0]
        return f"{'.'.join(map(str, path))} {what}"
    return str(error.problems[0].what) if isinstance(error, InvalidParameter) else str(error)


def _median_values(name: str, entries: Sequence[tuple[int, str, Vary]]) -> Iterator[tuple[str, Any]]:
    """Yield the fields of an effect at the medians of their distributions, vectors as lists."""
    vectors: dict[str, list[float]] = {}
    for _, parameter, vary in entries:
        if vary.distribution is None or (vary.mean is None and vary.std is not None):
            key = "distribution" if vary.distribution is None else "mean"
            raise _Wrong(key, f"is missing; the model has no {vary.parameter} that could say it")
        numbers = vary.values or tuple(v for v in (vary.mean, vary.std, vary.low, vary.high) if v is not None)
        median = Distribution(vary.distribution, numbers).median
        field, _, component = parameter.partition(".")
        fields = effect_class(name).model_fields
        default = fields[field].default if field in fields else None
        length = len(default) if isinstance(default, tuple) else 3
        if component in COMPONENTS[:3] and field in fields:
            vectors.setdefault(field, [0.0] * length)[COMPONENTS.index(component)] = median
        elif isinstance(default, tuple):
            vectors[field] = [median] * length
        else:
            yield field, median
    yield from vectors.items()
