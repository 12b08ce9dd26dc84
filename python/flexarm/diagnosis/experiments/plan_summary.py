"""A plan as text in a terminal: sizes that are seen, effects that cannot be parted, what would part them."""

from __future__ import annotations

from typing import TYPE_CHECKING

from flexarm.diagnosis.wording import listed, number, place_words

if TYPE_CHECKING:
    from flexarm.diagnosis.experiments.plan_result import Plan, Tie

MOST_TIES = 12
"""Tied pairs that are printed; the file plan.json has all."""


def headline(plan: Plan) -> str:
    """The plan in a sentence."""
    seen = [e for e in plan.effects if e.seen]
    text = (
        f"of {len(plan.effects)} effects the experiment would show {len(seen)} at a plausible size and "
        f"tell {len(plan.alone())} of them from all others"
    )
    if not plan.ties:
        return text + "."
    words, minutes, count = plan.additions()[0] if plan.additions() else ("", 0.0, 0)
    if not count:
        return text + f"; nothing on the menu parts any of the {len(plan.ties)} tied pairs."
    return text + (
        f"; a run {words} (some {minutes:g} min) would part {count} of the {len(plan.ties)} tied pairs."
    )


def summary(plan: Plan) -> str:
    """All that matters on one screen."""
    lines = [f"plan of {plan.arm.name}: {', '.join(plan.runs)}", headline(plan), ""]
    lines += [f"assumed: {sentence}" for sentence in plan.assumed]
    lines += ["", *_effect_lines(plan), "", *_group_lines(plan)]
    return "\n".join([*lines, *_addition_lines(plan)]).replace("\n\n\n", "\n\n")


def _effect_lines(plan: Plan) -> list[str]:
    rows = [("effect", "smallest detectable", "at plausible", "ln B", "taken for, or why not seen")]
    for i, each in enumerate(plan.effects):
        rivals = [place_words(*plan.effects[j].place) for j in plan.rivals(i)]
        shown = ", ".join(rivals[:2]) + (f" and {len(rivals) - 2} more" if len(rivals) > 2 else "")
        rows.append(
            (
                place_words(*each.place),
                each.least_words,
                each.value_words,
                number(each.log_bayes_factor),
                shown if each.seen else each.hidden,
            )
        )
    widths = [max(len(row[k]) for row in rows) for k in range(5)]
    return ["  ".join(f"{cell:<{w}}" for cell, w in zip(row, widths, strict=True)).rstrip() for row in rows]


def _group_lines(plan: Plan) -> list[str]:
    if not plan.groups:
        return ["every effect that is seen can be told from every other one"]
    lines = ["cannot be told apart (expected ln Bayes factor below ln 20):"]
    for group in plan.groups:
        lines.append("  " + listed([place_words(*plan.effects[i].place) for i in group]))
    return lines


def _addition_lines(plan: Plan) -> list[str]:
    if not plan.ties:
        return []
    lines = ["", f"what may be added, and how many of {len(plan.ties)} tied pairs it parts:"]
    for words, minutes, count in plan.additions():
        lines.append(f"  {count:4d}  {words} (some {minutes:g} min)")
    lines += ["", "cheapest addition by pair:"]
    lines += [f"  {_tie_words(tie)}" for tie in plan.ties[:MOST_TIES]]
    more = len(plan.ties) - MOST_TIES
    return [*lines, f"  and {more} more pairs (plan.json of --out has all)"] if more > 0 else lines


def _tie_words(tie: Tie) -> str:
    pair, best = f"{place_words(*tie.one)} | {place_words(*tie.other)}", tie.cheapest
    if best is None:
        return f"{pair}: nothing on the menu"
    before, after = number(tie.log_bayes_factor, 2), number(best.log_bayes_factor)
    return f"{pair}: {best.addition}, ln B {before} -> {after}"
