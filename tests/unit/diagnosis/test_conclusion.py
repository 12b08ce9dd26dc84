"""What is said of a choice that explains nearly all, on choices that are made up."""

from types import SimpleNamespace

import pytest

from flexarm.diagnosis import workflow


@pytest.mark.parametrize(
    ("constant", "left", "ends", "verdict"),
    [
        (True, 1.3, "", "effects"),  # a twentieth of the gap: no model is exact
        (False, 1.3, "", "unexplained"),  # three wrong names mimic a link that hardens, each record its own
        (False, 0.4, "", "effects"),  # in the noise there is nothing to be mimicked
        (True, 0.4, "at its end", "unexplained"),  # a link that hardens, told as rigid
    ],
)
def test_what_moves_or_is_at_its_end_does_not_explain(monkeypatch, constant, left, ends, verdict):
    fit = SimpleNamespace(rest=None, members=(), has_corners=False)
    choice = SimpleNamespace(best=fit, null=fit, value={})
    monkeypatch.setattr(
        "flexarm.diagnosis.choosing.acceptance.above_noise", lambda rest, observed, corners: {"tip": left}
    )
    for name, said in {
        "estimates": None,
        "constancy": [{"constant": constant}],
        "leaves_gap": False,
        "ends_sentence": ends,
        "named_effects": ["joint stiffening"],
        "worth_keeping": True,
        "repaired": None,
    }.items():
        monkeypatch.setattr(workflow, name, lambda *_, said=said, **__: said)
    found = workflow._conclusion(choice, (), SimpleNamespace(arm=None), seed=0)
    assert (found.verdict, found.open_gap) == (verdict, verdict == "unexplained" and not ends)
    assert found.ends == ends
