"""Units, clocks, frames and noise of proposed signals, by the model's motion."""

from __future__ import annotations

from collections.abc import Sequence
from math import log, pi
from pathlib import Path
from typing import Any

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.joint import motor_ratio
from flexarm.drive.doubts import slides
from flexarm.importing.guess.motion import ALIKE_SPEEDS, Agreement, Track, agreement, rigid_track, white_noise
from flexarm.importing.guess.proposal import (
    FARTHEST_SLIDE,
    TURNS,
    Option,
    Proposal,
    drives_of,
    in_output,
    plain_name,
    words_of,
)
from flexarm.quantities import QUANTITIES
from flexarm.units import factor_to


def settle_units(proposals: Sequence[Proposal], arm: Arm) -> None:
    """Give units: by name; of coordinates by size; of angles by the model's motion, family by family."""
    for proposal in proposals:
        unit = proposal.first.meaning.unit
        turned = "rotation" in proposal.keys
        units = ("rad",) if turned else QUANTITIES[proposal.quantity].units
        fits = unit and any(factor_to(si, unit) is not None for si in units)
        if fits and (turned or proposal.quantity != "orientation"):
            proposal.keys["unit"], proposal.why["unit"] = unit, "the log says it"
        elif unit and units and not (proposal.counts or proposal.unknown.get("unit")):
            proposal.unknown["scale"] = f"{units[0]} per {unit}, in which the log is"
            proposal.out = True
        elif turned:
            _settle_rotation(proposal)
        elif proposal.quantity == "position":
            far = float(np.nanmax([np.nanmax(np.abs(column.values)) for column in proposal.columns]))
            proposal.keys["unit"] = "mm" if far > 50 else "m"
            proposal.why["unit"] = f"coordinates up to {far:.4g}"
        elif proposal.quantity == "acceleration":
            size = float(np.nanmedian(np.linalg.norm([c.values for c in proposal.columns], axis=0)))
            near_g = 0.5 < size < 2
            proposal.keys["unit"] = "g" if near_g else "m/s2"
            proposal.why["unit"] = f"its size is {size:.3g} for most of the time"
            if not (near_g or 5 < size < 20):
                proposal.unknown["unit"] = f"{size:.3g} is neither 1 g nor 9.81 m/s2"
    families: dict[tuple[Any, str, str, bool], list[Proposal]] = {}
    for proposal in proposals:
        angle = proposal.quantity in ("joint_angle", "joint_command", "joint_rate")
        if angle and not proposal.out and not proposal.counts:
            kind = (proposal.first.kind, proposal.quantity, str(proposal.keys.get("side")))
            families.setdefault((*kind, slides(arm, proposal.place[1])), []).append(proposal)
    points = [p for p in proposals if p.quantity == "position" and not p.out and p.moves()]
    seen = sorted((p for p in points if len(p.track().time) > 8), key=lambda p: -p.track().size)
    for family in families.values():
        _settle_family(family, seen, arm)


def _settle_rotation(proposal: Proposal) -> None:
    """Give the unit of three angles by their size; in degrees they are angles more often than a vector."""
    size = [column.values for column in proposal.columns]
    far = float(np.nanmax(np.abs(size)))
    proposal.keys["unit"] = "deg" if far > 2 * pi else "rad"
    proposal.why["unit"] = f"values up to {far:.4g}"
    if proposal.keys["unit"] == "rad":
        proposal.unknown["unit"] = "small angles may be in deg"
    elif proposal.keys["rotation"] == "vector":
        proposal.keys["rotation"] = "xyz"
        proposal.unknown["rotation"] = "an order of angles, as taken, or an axis times an angle"


def _settle_family(family: Sequence[Proposal], seen: Sequence[Proposal], arm: Arm) -> None:
    """Choose unit and side of the gear for angles of one kind, or ways of joints that slide."""
    # Units are told apart where one makes the model's motion twice as near to the measured size as another.
    alike = log(2.0)
    rate = family[0].quantity == "joint_rate"
    stated = family[0].keys.get("unit")
    along = slides(arm, family[0].place[1])
    own, per = ("m", "mm") if along else ("rad", "deg"), "/s" if rate else ""
    units = [stated] if stated else [unit + per for unit in own]
    geared = family[0].keys.get("side") != "output" and family[0].quantity != "joint_command"
    geared = geared and any(abs(motor_ratio(arm, p.place[1])) != 1 for p in family)
    options: list[Option] = [
        (unit, gear) for unit in units for gear in ((False, True) if geared else (False,))
    ]
    if seen and not rate and len(options) > 1:
        found = sorted((_misfit(family, seen[0], arm, option), option) for option in options)
        best, chosen = found[0]
        size = seen[0].track().size
        told = (
            f"{seen[0].place[1]} of the model then moves by {best[1] * size:.3g} m rms, measured {size:.3g} m"
        )
        rivals = tuple(option for misfit, option in found[1:] if misfit[0] - best[0] <= alike)
        _say(family, chosen, told, f"{words_of(rivals[0])} fits almost as well" if rivals else "")
        for proposal in family:
            proposal.rivals = rivals
        return
    widest = [_widest(family, arm, option) for option in options]
    limit = (FARTHEST_SLIDE if along else pi * TURNS) * (10 if rate else 1)
    chosen = next((o for o, w in zip(options, widest, strict=True) if w <= limit), options[0])
    told = f"as {words_of(chosen)} values reach {_widest(family, arm, chosen):.3g} {own[0]}{per}"
    others = [o for o, w in zip(options, widest, strict=True) if w <= limit and o != chosen]
    _say(
        family, chosen, told, f"no measured point tells; {words_of(others[0])} is possible" if others else ""
    )


def _say(family: Sequence[Proposal], option: Option, why: str, unknown: str) -> None:
    for proposal in family:
        stated = "unit" in proposal.keys
        proposal.keys["unit"] = option[0]
        if option[1]:
            proposal.keys["before_gear"] = True
        proposal.why["before_gear" if stated and option[1] else "unit"] = (
            f"the log says it; {why}" if stated and not option[1] else why
        )
        if unknown:
            proposal.unknown["unit"] = unknown


def _widest(family: Sequence[Proposal], arm: Arm, option: Option) -> float:
    return max(float(np.abs(in_output(p, arm, option).values).max(initial=0.0)) for p in family)


def _misfit(family: Sequence[Proposal], seen: Proposal, arm: Arm, option: Option) -> tuple[float, float]:
    """Return |log| of the size of the model's motion over the measured one, and that ratio."""
    joints = {p.place[1]: in_output(p, arm, option) for p in family}
    ratio = agreement_of(seen, arm, joints, sizes_only=True).ratio
    return abs(log(max(ratio, 1e-9))), ratio


def agreement_of(seen: Proposal, arm: Arm, joints: dict[str, Track], sizes_only: bool = False) -> Agreement:
    """Return how a measured point goes with the rigid arm along joints."""
    axes = ["xyz".index(axis) for axis in seen.keys.get("axes", "xyz")]
    predicted = rigid_track(arm, seen.place[1], joints, axes)
    measured = seen.track()
    if sizes_only:
        return Agreement(0.0, 0.0, predicted.size / measured.size if measured.size else 0.0)
    return agreement(measured, predicted)


def settle_motion(proposals: Sequence[Proposal], arm: Arm) -> dict[str, str]:
    """Say how points go with the model, and return the frames that are not the base's with the reason."""
    joints = {p.place[1]: in_output(p, arm) for p in drives_of(proposals)}
    frames: dict[str, str] = {}
    for seen in (p for p in proposals if p.quantity in ("position", "orientation") and not p.out):
        name, told = plain_name(Path(seen.first.file).stem), "nothing tells where it stands"
        if seen.quantity == "position" and joints and len(seen.track().time) > 8:
            found = agreement_of(seen, arm, joints)
            late = _late(seen, drives_of(proposals), found)
            told_lag = f"{found.lag:.3g} s, each from its first stamp" if late is None else f"{late:.3g} s"
            reason = f"speeds correlate with the model's by {found.correlation:.2f} at a lag of {told_lag}"
            if seen.first.time.poses:
                reason = f"distances of its poses correlate with the model's by {found.correlation:.2f}"
            seen.why["point"] = "; ".join(filter(None, (seen.why.get("point"), reason)))
            finest = 3 * float(np.median(np.diff(seen.track().time)))  # below it clocks may be one [s]
            if late is not None and found.correlation > ALIKE_SPEEDS and abs(late) > finest:
                for each in (
                    p for p in proposals if p.place == seen.place and p.first.kind == seen.first.kind
                ):
                    each.own_clock = True
                    each.why["clock"] = f"its stamps are {late:.3g} s late against the joints'"
            if found.correlation < 0.5:
                seen.unknown["point"] = (
                    "the model's point does not move like it: joints, signs or point may be wrong"
                )
            away = _from_base(seen, arm, joints, found.lag)
            told = f"it is {away:.3g} m off the model's point in the base's axes"
            if away < 0.1 * seen.track().size:
                seen.keys["frame"], seen.why["frame"] = "base", told
                seen.unknown["frame"] = "how well it is registered; exactly is taken"
                continue
        seen.keys["frame"] = name
        frames.setdefault(name, told)
    return frames


def _late(seen: Proposal, drives: Sequence[Proposal], found: Agreement) -> float | None:
    """Return how late the stamps of a point are against those of the joints [s]; None in another file."""
    if any(drive.first.file != seen.first.file for drive in drives):
        return None
    return found.lag + seen.first.time.start - drives[0].first.time.start


def _from_base(seen: Proposal, arm: Arm, joints: dict[str, Track], lag: float) -> float:
    axes = ["xyz".index(axis) for axis in seen.keys.get("axes", "xyz")]
    predicted, measured = rigid_track(arm, seen.place[1], joints, axes), seen.track()
    at = measured.time - lag
    inside = (at >= predicted.time[0]) & (at <= predicted.time[-1])
    away = measured.values[inside] - predicted.at(at[inside])
    return float(np.sqrt(np.mean(np.sum(away**2, axis=1)))) if inside.any() else float("inf")


def settle_noise(proposals: Sequence[Proposal], arm: Arm) -> None:
    """Propose the noise that values show."""
    for proposal in proposals:
        if proposal.quantity == "joint_command" or (proposal.counts and proposal.out):
            continue
        if proposal.place == ("joint", ""):
            continue  # which may be before the gear or not
        if proposal.first.time.poses:
            rows = proposal.first.time.seconds
            if proposal.place[0] != "joint" and len(np.unique(rows)) == len(rows):
                proposal.unknown["noise_std"] = "1 sigma of a reading; rows that repeat a pose would tell it"
            continue
        sizes = [white_noise(column.values) for column in proposal.columns]
        sigma = float(np.max(sizes)) * proposal.factor()
        sigma /= abs(motor_ratio(arm, proposal.place[1])) if "before_gear" in proposal.keys else 1.0
        if sigma > 0:
            proposal.keys["noise_std"] = float(f"{sigma:.2g}")
            proposal.why["noise_std"] = "at most: third differences of neighbours"
        else:
            proposal.unknown["noise_std"] = "neighbours do not scatter"
