"""With what an effect is confused, and what tells it apart."""

from __future__ import annotations

from gallery.confusion import ALIKE, FAINT, Confusion, Study
from gallery.text import link, percent, rounded, share, table

LOWER = 0.01
"""By how much R^2 must fall to be set in bold."""
POOR_NAME, RICH_NAME = "tip, slow sine", "all of it, faster motion"


def confused(name: str, study: Study) -> str:
    """Whether each set-up sees the effect, and who explains most of it."""
    added = {f"+ {label}": found for label, found in study.menu.items()}
    setups = {POOR_NAME: study.poor, **added, RICH_NAME: study.rich}
    rows = [[label, *_best(name, found)] for label, found in setups.items()]
    head = ["data", "gap/noise", "left when aligned", "best rival", "R²", f"rivals ≥ {ALIKE}"]
    return (
        "## Confused with\nLength of the gap over its noise (all samples), what is left of it once clock and "
        "frame of the tracker are aligned, and the share R² of that which the best other effect could "
        f"explain with its parameters free:\n\n{table(head, rows)}"
    )


def _best(name: str, found: Confusion) -> list[str]:
    length = found.length[name]
    seen = [rounded(length) if length > 0.01 else "0", percent(found.left[name])]
    if not found.share[name]:
        return [*seen, "not seen" if length < FAINT else "aligned away", "–", "–"]
    rival, r2 = found.best(name)
    return [*seen, link(rival), share(r2), str(len(found.rivals(name)))]


def separated(name: str, study: Study) -> str:
    """Every rival in the poor set-up, and what each addition makes of it."""
    title = "## What separates it\n"
    if not study.poor.share[name]:
        return title + _what_shows_it(name, study)
    if not study.poor.rivals(name):
        rival, r2 = study.poor.best(name)
        most = f"no other effect explains more than {share(r2)} ({link(rival)})"
        return f"{title}In the poor set-up {most}. {_remaining(name, study)}"
    rows = [_after(name, rival, study) for rival in study.poor.rivals(name)]
    head = ["rival", "size it takes", POOR_NAME, *(f"+ {label}" for label in study.menu), RICH_NAME]
    return (
        f"{title}{_advice(name, study)}\n\nR² of each rival of {ALIKE} and more; its size in multiples of "
        "its typical value or of one sigma (a large multiple makes it implausible):\n\n" + table(head, rows)
    )


def _after(name: str, rival: str, study: Study) -> list[str]:
    """A rival's R^2 in all set-ups, the lowest of the additions in bold."""
    after = [found.share[name].get(rival) for found in study.menu.values()]
    least = min(r2 for r2 in after if r2 is not None)
    before = study.poor.share[name][rival]
    cells = [f"**{_cell(r2)}**" if r2 == least < before - LOWER else _cell(r2) for r2 in after]
    size = rounded(study.poor.size[name][rival])
    return [link(rival), size, share(before), *cells, _cell(study.rich.share[name].get(rival))]


def _cell(r2: float | None) -> str:
    return "–" if r2 is None else share(r2)


def _advice(name: str, study: Study) -> str:
    """The addition that lowers the best rival's R^2 most, and whom the rich set-up leaves."""
    rival, before = study.poor.best(name)
    after = {label: found.share[name][rival] for label, found in study.menu.items() if found.share[name]}
    label, r2 = min(after.items(), key=lambda item: item[1])
    rest = _remaining(name, study)
    best = f"R² of the best rival, {link(rival)}"
    if r2 > ALIKE:
        return f"No single addition does: {best}, never falls below {share(r2).removeprefix('> ')}. {rest}"
    return f"The {label} lowers {best}, from {share(before)} to {share(r2)}. {rest}"


def _remaining(name: str, study: Study) -> str:
    """Whom the rich set-up leaves."""
    rivals = study.rich.rivals(name) if study.rich.share[name] else {}
    if not rivals:
        return "The rich set-up leaves no rival."
    return f"Even the rich set-up leaves {', '.join(f'{link(r)} ({share(r2)})' for r, r2 in rivals.items())}."


def _what_shows_it(name: str, study: Study) -> str:
    """Which addition shows an effect that the poor set-up does not."""
    faint = study.poor.length[name] < FAINT
    why = (
        "At this size the slow sine does not show it at the tip."
        if faint
        else "The alignment takes it up; it counts as an effect beyond what is stated of clock and frame."
    )
    seen = {label: c.length[name] * c.left[name] for label, c in study.menu.items() if c.share[name]}
    if not seen:
        return f"{why} No single addition does." if faint else f"{why} No single addition changes that."
    label, length = max(seen.items(), key=lambda item: item[1])
    rival, r2 = study.menu[label].best(name)
    found = f"What shows it best is the {label}: {rounded(length)} times the noise"
    return f"{why} {found}, of which {link(rival)} could explain {share(r2)}."
