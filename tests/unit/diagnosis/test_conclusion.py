"""What is said of a choice that explains nearly all, on choices that are made up."""

from types import SimpleNamespace

import pytest

from flexarm.diagnosis import workflow
from flexarm.diagnosis.policy import SelectionPolicy

GAP = 26.0
"""Of the nominal model, over the noise."""


@pytest.mark.parametrize(
    ("constant", "left", "far", "ends", "verdict"),
    [
        (True, 1.3, False, "", "effects"),  # a twentieth of the gap: no model is exact
        (False, 1.3, False, "", "unexplained"),  # three wrong names mimic a link that hardens
        (False, 0.4, False, "", "effects"),  # in the noise there is nothing to be mimicked
        (True, 1.3, True, "", "unexplained"),  # an encoder eccentric by 0.1 rad, told for a soft shoulder
        (True, 0.4, True, "", "effects"),  # some machine is unlike all others
        (True, 0.4, True, "at its end", "unexplained"),  # a link that hardens, told as rigid
    ],
)
def test_what_moves_is_absurd_or_at_its_end_does_not_explain(monkeypatch, constant, left, far, ends, verdict):
    null, fit = (SimpleNamespace(projected=rest, members=(), non_smooth=False) for rest in (GAP, left))
    estimator = SimpleNamespace(with_effects=lambda members: None)
    choice = SimpleNamespace(best=fit, null=null, value={}, estimator=estimator)
    monkeypatch.setattr(
        "flexarm.diagnosis.acceptance.above_noise", lambda rest, problem, non_smooth: {"tip": rest}
    )
    monkeypatch.setattr("flexarm.diagnosis.acceptance.without_constants", lambda rest, problem: rest)
    for name, said in {
        "estimates": None,
        "input_noise_errors": None,
        "constancy": [{"constant": constant}],
        "bound_sentence": ends,
        "has_implausible_size": far,
        "named_effects": ["joint stiffening"],
        "worth_keeping": True,
        "repaired": None,
    }.items():
        monkeypatch.setattr(workflow, name, lambda *_, said=said, **__: said)
    found = workflow._conclusion(choice, (), SimpleNamespace(arm=None, policy=SelectionPolicy()))
    assert (found.verdict, found.open_gap) == (verdict, verdict == "unexplained" and not ends)
    assert found.ends == ends
