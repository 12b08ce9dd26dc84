"""The gap against states of the joints and time, and as rotations of the joints."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from flexarm.arm.effect import effect_class
from flexarm.errors import InvalidParameter
from flexarm.report.files import BOTTOM, legend_below, sheet
from flexarm.report.gap_figures import AFTER, LOOKS, NOISE, zero_of
from flexarm.wording import labelled_scale

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from flexarm.diagnosis.result import Diagnosis
    from flexarm.named_effects import NamedEffect
    from flexarm.residual_analysis.localisation import Localisation
    from flexarm.residual_analysis.motion_states import JointStates
    from flexarm.residual_analysis.residual_parts import SignalResidual


KINDS = ("angle", "rate", "torque")


def against_states(d: Diagnosis) -> Figure | None:
    """Return the main signal's gap against angle, rate and torque of the joints, a row each, before and
    after.
    """
    shown = shown_joints(d)
    if d.located is None or not shown:
        return None
    kinds = states_drawn(shown)
    direction = main_direction(d)
    tall = 1.6 if len(shown) == 1 else 1.25
    figure, axes = sheet(len(shown), len(kinds), tall, between=(0.3, BOTTOM), sharey=True)
    for row, states in zip(axes, shown, strict=True):
        for ax, kind in zip(row, kinds, strict=True):
            draw_against(ax, d, d.main_signal, direction, states.joint, kind)
        for ax in row[1:]:
            ax.set_ylabel("")
    title = f"{d.main_signal}, {direction}: measured − model"
    axes[0, 0].set_title(title + (", against each joint" if len(shown) > 1 else ""), loc="left")
    legend_below(figure, axes[0, 0])
    return figure


def shown_joints(d: Diagnosis) -> list[JointStates]:
    """Joints that are drawn, at most three: where an effect sits first, then whose rotation holds most."""
    rows = d.located.gaps.get(d.main_signal) if d.located is not None else None
    if d.located is None or rows is None or not rows.states:
        return []
    found = d.located.rotations
    ranked = [
        *(at for e in d.effects for at in e.places),
        *(each.joint for each in (found.joints if found else ())),
    ]
    moving = [each.joint for each in rows.states]
    order = dict.fromkeys([*(joint for joint in ranked if joint in moving), *moving])
    return [of_joint(rows.states, joint) for joint in list(order)[:3]]


def states_drawn(joints: Sequence[JointStates]) -> Sequence[str]:
    """States that joints have: no rate in poses."""
    return KINDS if any(states.moves for states in joints) else ("angle", "torque")


def main_direction(d: Diagnosis) -> str:
    """Return the direction in which the main signal's gap is greatest; it is what `against_states` draws."""
    assert d.located is not None
    return d.located.gaps[d.main_signal].largest_direction


def draw_against(ax: Axes, d: Diagnosis, signal: str, direction: str, joint: str, kind: str) -> None:
    """Draw the gap of a signal as dots against a state of a joint or time, before and after."""
    sides = located_sides(d, signal)
    rows = sides["nominal model"]
    factor, unit = labelled_scale([float(np.abs(rows.directions[direction]).max())], rows.unit)
    sigma = factor * float(np.sqrt(np.mean(rows.noise[direction] ** 2)))
    ax.axhspan(-2 * sigma, 2 * sigma, color=NOISE, lw=0, zorder=0, label="noise, 2σ")
    for name, side in sides.items():
        if direction not in side.directions:  # the frame that was found turns the measured axes out of it
            continue
        where = side.time if kind == "time" else getattr(of_joint(side.states, joint), kind)
        values = factor * side.directions[direction]
        ax.plot(where, values, ls="none", ms=2.4, mew=0, alpha=0.7, label=name, **LOOKS[name])
    ax.set_ylabel(f"{direction} [{unit}]" if direction != "total" else f"gap [{unit}]")
    states = of_joint(rows.states, joint)
    ax.set_xlabel("time [s]" if kind == "time" else states.label(kind))


def located_sides(d: Diagnosis, signal: str) -> dict[str, SignalResidual]:
    """Return the gap of a signal over all records of training, by model."""
    pairs = [("nominal model", d.located)]
    if d.updated != d.arm:
        pairs.append(("updated model", d.located_after))
    return {name: side.gaps[signal] for name, side in pairs if side is not None and signal in side.gaps}


def most_repaired(d: Diagnosis) -> str:
    """Return the signal whose squared gap, over its noise, the updated model makes smaller by most."""

    def gain(signal: str) -> float:
        squares = [float(np.sum(side.whitened**2)) for side in located_sides(d, signal).values()]
        return squares[0] - squares[-1] if len(squares) > 1 else 0.0

    signals = list(d.located.gaps) if d.located is not None else []
    best = max(signals, key=gain, default=d.main_signal)
    return best if best in signals and gain(best) > 0 else d.main_signal


def rotations(d: Diagnosis) -> Figure | None:
    """Return the nominal model's gap as rotations of the joints, each against its angle, rate and torque.

    None for a single joint, whose rotation is the tangential gap, and where no position was measured.
    """
    found = d.located.rotations if d.located is not None else None
    if found is None or len(found.joints) < 2:
        return None
    shown = list(zip(found.joints, found.states, strict=True))[:3]
    kinds = states_drawn([states for _, states in shown])
    alike = len({each.unit for each, _ in shown}) == 1  # or some slide and some turn
    shared = True if alike else "row"
    figure, axes = sheet(len(shown), len(kinds), 1.1, between=(0.3, BOTTOM), legend=False, sharey=shared)
    for row, (rotation, states) in zip(axes, shown, strict=True):
        beside = [each for each, _ in shown if each.unit == rotation.unit]
        factor, unit = labelled_scale([float(np.abs(each.angle).max()) for each in beside], rotation.unit)
        for kind, ax in zip(kinds, row, strict=True):
            look = LOOKS["nominal model"]
            ax.plot(getattr(states, kind), factor * rotation.angle, ls="none", ms=2.2, mew=0, **look)
            ax.set_xlabel(states.label(kind))
        row[0].set_ylabel(f"{rotation.joint} [{unit}]")
    return figure


def turned_most(located: Localisation, rows: SignalResidual) -> JointStates:
    """States of the joint whose rotation holds most of the gap, else of the first that moves."""
    ranked = [each.joint for each in located.rotations.joints] if located.rotations is not None else []
    moving = [each.joint for each in rows.states]
    return of_joint(rows.states, next((joint for joint in ranked if joint in moving), moving[0]))


def of_joint(states: Sequence[JointStates], joint: str) -> JointStates:
    """Return the states of a joint."""
    return next(each for each in states if each.joint == joint)


def draw_of_effect(ax: Axes, d: Diagnosis, effect: NamedEffect) -> None:
    """Draw the gap that an effect explains, against the state of its joint that its law speaks of."""
    assert d.located is not None
    signal = most_repaired(d)
    rows = d.located.gaps[signal]
    joints = [each.joint for each in rows.states]
    most = turned_most(d.located, rows).joint
    joint = next((at for at in effect.places if at in joints and len(effect.places) == 1), most)
    draw_against(ax, d, signal, rows.largest_direction, joint, effect_class(effect.name).varies_with)
    ax.set_title(f"{signal}: measured − model")


def gap_figure(located: Localisation, signal: str | None = None) -> Figure:
    """Return the gap of a signal along one direction against the states of a joint and time.

    The default signal holds most of the squared gap, over the noise; the direction has the greatest gap; the
    joint's rotation holds most of the gap, or it is the first that moves. Raise InvalidParameter if there is
    no such signal.
    """
    import matplotlib.pyplot as plt

    if not located.gaps:
        raise InvalidParameter("holds no gap to draw", where="located")
    name = signal or max(located.gaps, key=lambda name: float(np.sum(located.gaps[name].whitened ** 2)))
    if name not in located.gaps:
        raise InvalidParameter(f"there is no signal {name!r}; there are {', '.join(located.gaps)}")
    rows, direction = located.gaps[name], located.gaps[name].largest_direction
    joint = turned_most(located, rows)
    kinds, records = states_drawn([joint]), rows.labels[:4] if joint.moves else ()
    figure = plt.figure(figsize=(9.5, 2.6 * (1 + len(records))), layout="constrained")
    grid = figure.add_gridspec(1 + len(records), 6)
    width = 6 // len(kinds)
    first = [figure.add_subplot(grid[0, width * k : width * (k + 1)]) for k in range(len(kinds))]
    below = [figure.add_subplot(grid[1 + k, :]) for k in range(len(records))]
    factor, unit = labelled_scale([float(np.abs(rows.directions[direction]).max())], rows.unit)
    values = factor * rows.directions[direction]
    for ax, kind in zip(first, kinds, strict=True):
        ax.plot(getattr(joint, kind), values, ".", ms=2.5, color=AFTER, label="gap")
        ax.set_xlabel(f"{kind} of {joint.joint} [{joint.units[kind]}]", fontsize="small")
    for k, (ax, record) in enumerate(zip(below, records, strict=True)):
        inside = rows.record == k
        zero = zero_of(rows.time[inside])
        ax.plot(rows.time[inside] - zero, values[inside], lw=0.8, color=AFTER, label="gap")
        of = f" of {record}" if len(rows.labels) > 1 else ""
        ax.set_xlabel(f"time{of}{f' after {zero:.0f} s' if zero else ''} [s]", fontsize="small")
    sigma = factor * float(np.sqrt(np.mean(rows.noise[direction] ** 2)))
    for ax in (*first, *below):
        ax.axhspan(-2 * sigma, 2 * sigma, color=NOISE, lw=0, label="noise, 2σ", zorder=0)
        if ax.get_xlim()[0] < 0 < ax.get_xlim()[1]:
            ax.axvline(0.0, color="0.85", lw=0.6, zorder=0)
        ax.tick_params(labelsize="small")
    for ax in (first[0], *below):
        ax.set_ylabel(f"gap [{unit}]", fontsize="small")
    first[0].legend(loc="best", fontsize="x-small")
    figure.suptitle(f"{name}, {direction}: measured - model", fontsize="medium")
    return figure
