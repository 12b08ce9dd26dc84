"""What a class tells of its effect without a simulation: law, place and parameters."""

from __future__ import annotations

import sys

from flexarm.arm.effect import effect_class
from gallery.experiments import paper_arm
from gallery.signatures import NEEDED, model_for, start_of
from gallery.text import law, link, setting, table

MADE = "<!-- Made by `python scripts/effects_gallery.py`; change the class or the script, not this page. -->"


def module_text(name: str) -> str:
    """Docstring of an effect's module."""
    return sys.modules[effect_class(name).__module__].__doc__ or ""


def described(name: str) -> str:
    """The part of a page that needs no simulation: law, place and parameters."""
    return "\n\n".join([MADE, f"# `{name}`", law(module_text(name)), _place(name), _parameters(name)])


def _place(name: str) -> str:
    kind = effect_class(name)
    file = f"../../python/{kind.__module__.replace('.', '/')}.py"
    needs = f" It needs {link(NEEDED[name])}." if name in NEEDED else ""
    return f"Acts at a {kind.place}. Class [`{kind.__name__}`]({file}).{needs}"


def _parameters(name: str) -> str:
    """Parameters with units, plausible values for the paper's arm, and whether a derivative exists."""
    model = model_for(name, paper_arm())
    effect, kind = start_of(name, model), effect_class(name)
    priors = effect.priors(model)
    for start in effect.shapes():
        priors |= effect.with_parameters(start).priors(model)
    if not priors:
        return "## Parameters\nIt has none."
    rows = []
    for key, prior in priors.items():
        field = kind.model_fields[key.partition(".")[0]]
        rows.append(
            [
                f"`{key}`",
                f"{prior.unit}",
                field.description or "",
                f"{setting(prior.low)} to {setting(prior.high)}",
                setting(prior.typical),
                prior.scale,
                effect.derivative(key),
            ]
        )
    head = ["parameter", "unit", "meaning", "95 % of machines", "typical", "scale", "derivative"]
    by_source: dict[str, list[str]] = {}
    for key, prior in priors.items():
        by_source.setdefault(prior.source, []).append(f"`{key}`")
    sources = "\n".join(f"* {', '.join(keys)}: {source}." for source, keys in by_source.items())
    return f"## Parameters\n{table(head, rows)}\n\nWhere these values come from:\n{sources}"


def fields(name: str) -> dict[str, str]:
    """Parameters of an effect, vectors whole, with units."""
    model = model_for(name, paper_arm())
    priors = start_of(name, model).priors(model)
    return {key.partition(".")[0]: prior.unit for key, prior in priors.items()}
