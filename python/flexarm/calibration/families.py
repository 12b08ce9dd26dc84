"""Families: one effect at all places of a kind, as one hypothesis with a hierarchical prior.

Eqs. (1) to (3) are those of `diagnosis.family`; tau_0 and nu are `family_spread` and
`family_count`.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from flexarm.arm import Arm
from flexarm.arm.effect import Effect, effect_class
from flexarm.arm.joint_units import priors_in
from flexarm.arm.prior import QUANTILE, Prior
from flexarm.arm.vocabulary import KNOWN_EFFECTS
from flexarm.calibration.parameters import FreeParameter
from flexarm.calibration.policy import CalibrationPolicy
from flexarm.diagnosis.candidates import places_of, priors_in_records
from flexarm.diagnosis.family import HierarchicalPrior
from flexarm.diagnosis.nuisance import bare_key
from flexarm.diagnosis.policy import FIT
from flexarm.diagnosis.problem import Problem
from flexarm.errors import InvalidParameter


@dataclass(frozen=True)
class Family:
    """One parameter of an effect at all its places."""

    effect: str
    parameter: str
    members: tuple[FreeParameter, ...]
    """One a place."""
    places: tuple[str, ...]
    hierarchy: HierarchicalPrior
    """Prior of the members."""


def with_families(
    problem: Problem, arm: Arm, names: Sequence[str], policy: CalibrationPolicy
) -> tuple[Arm, list[Family]]:
    """Return the model with the effects of the families at all their places, and the families.

    Places where other sizes are plausible, such as at another payload or sensor, are families of their own.
    Places where the model states the parameter and its uncertainty are left to that.

    Raise InvalidParameter if there is no such effect, or it cannot act anywhere in these records.
    """
    uncertain = {bare_key(arm, key) for key in arm.uncertainty}
    families: list[Family] = []
    for kind in family_kinds(names):
        name = kind.name
        entries: dict[tuple[str, Prior], list[tuple[str, Prior, Effect]]] = {}
        for effect in _members(kind, problem, arm):
            arm = arm.with_effect(effect)
            for parameter, prior in _free(effect, problem, arm):
                if f"effects.{name}.{effect.at}.{parameter.split('.')[0]}" not in uncertain:
                    entries.setdefault((parameter, prior), []).append((parameter, prior, effect))
        if not entries:
            needs = f"; it needs {kind.requires} there, so name that family first" if kind.requires else ""
            raise InvalidParameter(
                f"{name} can act nowhere in these records, or is uncertain in the model already{needs}",
                where=f"families.{name}",
            )
        families += [_family(members, policy) for members in entries.values()]
    return arm, families


def family_kinds(names: Sequence[str]) -> list[type[Effect]]:
    """Return the effects of families, each once.

    Raise InvalidParameter if there is no such effect, or it cannot be calibrated.
    """
    return [_kind(name) for name in dict.fromkeys(names)]


def _kind(name: str) -> type[Effect]:
    try:
        kind = effect_class(name)
    except InvalidParameter as error:
        raise InvalidParameter(str(error), where="families") from None
    if not kind.competes:
        allowed = ", ".join(each for each in KNOWN_EFFECTS if effect_class(each).competes)
        what = f"{name!r} is a fault of a sensor and cannot be calibrated; allowed are {allowed}"
        raise InvalidParameter(what, where="families")
    return kind


def _members(kind: type[Effect], problem: Problem, arm: Arm) -> Iterator[Effect]:
    """Yield the effect at each place where the model accepts it, as stated there or typical."""
    for at in places_of(kind, problem, arm):
        stated = arm.effect(kind.name, at)
        required = None if kind.requires is None else arm.effect(kind.requires, at)
        if kind.requires is not None and (required is None or required.inert):
            continue
        effect = kind.typical(at, arm) if stated is None or stated.inert else stated
        try:
            arm.with_effect(effect)
        except InvalidParameter:
            continue
        yield effect


def _free(effect: Effect, problem: Problem, arm: Arm) -> Iterator[tuple[str, Prior]]:
    """Yield the parameters that these records can show, with their priors."""
    poses = all(record.kind == "static" for record in problem.records.values())
    there = {name for name, _, _ in effect.parameters()}
    priors = {**priors_in(effect, arm), **priors_in_records(type(effect), effect.at, problem)}
    for name, prior in priors.items():
        if name in there and not (poses and name in effect.in_motion):
            yield name, prior


def _family(members: Sequence[tuple[str, Prior, Effect]], policy: CalibrationPolicy) -> Family:
    parameter, prior, first = members[0]
    hierarchy = HierarchicalPrior.of(prior, policy)
    free = tuple(
        FreeParameter.of_family(
            f"effects.{effect.name}.{effect.at}.{name}",
            each,
            hierarchy.spread,
            None if effect.smooth else FIT.non_smooth_step * (each.high - each.low) / (2 * QUANTILE),
        )
        for name, each, effect in members
    )
    return Family(first.name, parameter, free, tuple(effect.at for _, _, effect in members), hierarchy)
