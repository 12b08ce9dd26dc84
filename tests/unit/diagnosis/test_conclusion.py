"""What is said of a choice that explains nearly all, on choices that are made up."""

from types import SimpleNamespace

import pytest

from flexarm.diagnosis import workflow


@pytest.mark.parametrize(
    ("constant", "left", "verdict"),
    [
        (True, 1.3, "effects"),  # a twentieth of the gap: no model is exact
        (False, 1.3, "unexplained"),  # three wrong names mimic a link that hardens, each record its own
        (False, 0.4, "effects"),  # in the noise there is nothing to be mimicked
    ],
)
def test_what_moves_from_record_to_record_does_not_excuse_a_small_gap(monkeypatch, constant, left, verdict):
    fit = SimpleNamespace(rest=None, members=())
    choice = SimpleNamespace(best=fit, null=SimpleNamespace(rest=None), value={})
    monkeypatch.setattr(
        "flexarm.diagnosis.choosing.acceptance.above_noise", lambda rest, observed: {"tip": left}
    )
    for name, said in {
        "estimates": None,
        "constancy": [{"constant": constant}],
        "leaves_gap": False,
        "named_effects": ["joint stiffening"],
        "worth_keeping": True,
        "repaired": None,
    }.items():
        monkeypatch.setattr(workflow, name, lambda *_, said=said, **__: said)
    found = workflow._conclusion(choice, (), SimpleNamespace(arm=None), seed=0)
    assert (found.verdict, found.open_gap) == (verdict, verdict == "unexplained")
