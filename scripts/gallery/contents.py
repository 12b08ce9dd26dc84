"""The index of the gallery."""

from __future__ import annotations

from flexarm.arm.vocabulary import KNOWN_EFFECTS
from gallery.confusion import ALIKE, FAINT, Study
from gallery.described import MADE, fields, module_text
from gallery.experiments import FAST, LIGHT, MENU, NOISE
from gallery.gaps import at_tip
from gallery.measures import directions, follows
from gallery.shares import LEFT
from gallery.signatures import Signature
from gallery.text import first_sentence, link, metres, percent, table

ALSO = 0.02
"""A curve over an earlier one of angle, rate, torque and time is told if it explains only so much less."""
INTRODUCTION = """\
# Gallery of effects
A page for each effect of the shared vocabulary: its law, what the tip does, how large that is, what it is
confused with and what tells it apart. Text and numbers come from the classes and from simulations:
`python scripts/effects_gallery.py` makes all pages, `--only NAME` one of them, `--check` compares them with
what the code would write.

**The arm** is the paper's (3 m tube, 14.1 kg, hinge with compliance, ratio 120) with reflectors at hub,
mid-span and tip. It moves in a *slow sine* through ±1.2 rad in 60 s and in a *faster motion* of 20 s with
reversals; the encoder is on the motor's side. Every gap is measured minus predicted: the machine has the
effect, the model that follows the machine's encoder has not. No noise is added; gaps are weighed by it."""


def index(study: Study) -> str:
    """The page that lists all."""
    rows = [_row(each, study) for each in study.signatures.values()]
    head = ["effect", "at", "parameters", "what it is", "tip's gap", f"rivals ≥ {ALIKE}: poor, rich"]
    pictures = [f"![R² in the {kind} set-up](confusion-{kind}.png)" for kind in ("poor", "rich")]
    return "\n\n".join([MADE, INTRODUCTION, _rules(), table(head, rows), *pictures]) + "\n"


def _rules() -> str:
    """What R^2 is, and of which data."""
    noise = f"reflectors {metres(NOISE['tip'])}, motor torque {NOISE['torque']:g} N m"
    return f"""\
**Confusion.** What a late tracker and its registration explain is projected out of gaps over their noise
({noise}), and R² is the share of the rest that another effect explains with its
parameters fitted linearly: 1 means that the data cannot tell the two apart. The *poor* set-up is the tip in
the slow sine with one payload. Additions are tried one by one: {", ".join(MENU)}.
The *rich* set-up is all sensors in the faster motion with 14.1 kg and with a weighed payload of {LIGHT:g} kg.
An effect whose gap is less than {FAINT:g} times the noise (all samples together), or of which alignment
leaves less than {percent(LEFT)}, has no R² (–)."""


def _row(signature: Signature, study: Study) -> list[str]:
    name = signature.name
    keys = ", ".join(f"`{key}` [{unit}]" for key, unit in fields(name).items()) or "none"
    counts = [str(len(c.rivals(name))) if c.share[name] else "–" for c in (study.poor, study.rich)]
    what = first_sentence(module_text(name))
    return [link(name), KNOWN_EFFECTS[name], keys, what, signature_line(signature), ", ".join(counts)]


def signature_line(signature: Signature) -> str:
    """Direction, and what the gap follows, in a few words."""
    if not at_tip(signature.shown.gaps[FAST]):
        return "not at the tip"
    main, part = max(directions(signature).items(), key=lambda item: item[1])
    curves = follows(signature)
    least = max(curves.values()) - ALSO
    state = next(name for name, r2 in curves.items() if r2 >= least)
    return f"{main} ({percent(part)}), over {state} ({percent(curves[state])})"
