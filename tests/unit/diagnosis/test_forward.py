"""The search forward, on costs that are made up: single effects, sets, and what goes on from the best."""

from types import SimpleNamespace

import numpy as np
import pytest
from planted import run_of

from flexarm.budget import limited
from flexarm.diagnosis import selection as module
from flexarm.diagnosis.acceptance import Criteria
from flexarm.diagnosis.candidates import candidates
from flexarm.diagnosis.estimator import Estimator
from flexarm.diagnosis.moves import confounding, proposals, search_state
from flexarm.diagnosis.moves.search_state import SearchState
from flexarm.diagnosis.nuisance import nuisance_model
from flexarm.diagnosis.policy import SelectionPolicy
from flexarm.diagnosis.problem import Problem
from flexarm.diagnosis.screening import Probed
from flexarm.effects import CoulombFriction, LinkDamping
from flexarm.errors import NotConverged

COST = {"": 100, "a": 60, "b": 70, "c": 75, "d": 80, "cd": 40, "ab": 20, "ac": 50, "abc": 19.9, "abd": 19.9}
LINEAR = {1: ["a", "b", "c", "d"], 2: ["cd"], 3: []}
"""Sets in the order that the nominal model gives them: of pairs it knows only one that is not the best."""
ELSEWHERE: dict[str, list[str]] = {}
"""Models with another spring, by those with the one that was tried."""
NOTHING = SimpleNamespace(channels=lambda: [], records={}, policy=SelectionPolicy())
"""As much of `Problem` as is asked for: no channel."""


BARE = SimpleNamespace(members=(), places=(), cost=100.0, non_smooth=False)
CRITERIA = Criteria(NOTHING, BARE)
STATE = SearchState([], BARE, BARE, None, CRITERIA, {})


class Rows(SimpleNamespace):
    """Ten rows of a problem."""

    policy = SelectionPolicy()

    def __len__(self):
        return 10

    def expected_cost(self, non_smooth):
        return 10.0


def fit(names):
    return SimpleNamespace(members=tuple(names), cost=COST[names], name=names, non_smooth=False)


def fits_all(members, nearby=None, limit=np.inf):
    """What a estimator finds of effects that are names: a model that leaves as much as all others."""
    return SimpleNamespace(name=members[0], places=members, members=(), cost=50.0, non_smooth=False)


def names(fits):
    return [each.name for each in fits]


def made(names):
    """The same with places."""
    found = fit(names)
    found.places = found.members
    return found


@pytest.fixture
def search(monkeypatch):
    """A search whose fits are looked up, and the models from which single effects were added."""
    went_on = []

    def singles(state, best, about, found):
        if not best.members:
            return [fit(names) for names in LINEAR[1]]
        went_on.append(best.name)
        names = {"".join(sorted(best.name + each)) for each in "abcd" if each not in best.name}
        return [fit(each) for each in sorted(names & set(COST))]

    def sets(size):
        return lambda state, best, *_: [] if state.criteria.adequate(best) else list(map(fit, LINEAR[size]))

    def spring_swap(state, best, *_):
        return [fit(n) for n in ELSEWHERE.get(best.name, "")] if state.criteria.leaves_gap(best) else []

    monkeypatch.setattr(module, "FORWARD", {"singles": singles})
    monkeypatch.setattr(module, "SETS", {"pairs": sets(2), "triples": sets(3)})
    monkeypatch.setattr(module, "ELSEWHERE", {"spring_swap": spring_swap})
    monkeypatch.setattr(module, "SHAPES", {})
    monkeypatch.setattr(Criteria, "adequate", lambda *_: False)
    monkeypatch.setattr(module, "best_of", lambda about, fits, *_: (min(fits, key=lambda f: f.cost), about))
    monkeypatch.setattr(Criteria, "leaves_gap", lambda self, one: one.cost > 30)
    monkeypatch.setattr(Criteria, "accepts", lambda self, new, old: new.cost < 0.8 * old.cost)
    monkeypatch.setattr(Criteria, "reduces", lambda self, new, old: new.cost < 0.97 * old.cost)
    monkeypatch.setattr(Criteria, "explains", lambda self, one: one.cost < 10)
    monkeypatch.setattr(Criteria, "leaves_most", lambda self, one: one.cost > 90)
    monkeypatch.setattr(Criteria, "hardly_helps", lambda self, one: False)
    monkeypatch.setattr(module, "effect_count", lambda members, places: len(members))
    null = fit("")
    return SearchState(None, null, null, None, Criteria(Rows(), null), {}), went_on


def forward(search):
    return module.forward(search[0], search[0].null, SimpleNamespace(), lambda what, done: None)


def test_what_goes_on_from_the_best_single_effect_competes_with_pairs(search):
    best, _ = forward(search)
    assert best.name == "ab"


def test_a_freer_shape_competes_before_a_second_effect(search, monkeypatch):
    """Dry friction that creeps, where noise of the drive flips the one that does not."""
    monkeypatch.setitem(COST, "A", 22)
    shapes = {"shapes": lambda state, best, *_: [fit("A")] if best.name == "a" else []}
    monkeypatch.setattr(module, "SHAPES", shapes)
    assert forward(search)[0].name == "A"


@pytest.mark.parametrize("elsewhere, chosen", [(["cs"], "cs"), (["xs"], "cd"), ([], "cd")])
def test_a_pair_that_leaves_a_gap_is_tried_with_the_other_springs(search, monkeypatch, elsewhere, chosen):
    """A soft joint stood for a base that gives way, which no set with it came near; a worse one is none."""
    monkeypatch.setitem(COST, "cs", 5)
    monkeypatch.setitem(COST, "xs", 45)
    monkeypatch.delitem(COST, "ab")
    monkeypatch.setitem(ELSEWHERE, "cd", elsewhere)
    best, _ = forward(search)
    assert best.name == chosen


@pytest.mark.parametrize("seconds, chosen", [(None, "cd"), (5.0, "a")], ids=["time left", "time over"])
def test_a_set_that_time_left_unfinished_does_not_replace_a_better_model(
    search, monkeypatch, seconds, chosen
):
    """It is accepted as more plausible, though its evidence is less; only fits at rest may be so judged."""
    now = [0.0]

    def pairs(state, best, *_):
        now[0] = 10.0
        return [fit("cd")]

    monkeypatch.setattr("flexarm.budget.monotonic", lambda: now[0])
    monkeypatch.setattr(module, "SETS", {"pairs": pairs})
    monkeypatch.setitem(LINEAR, 1, ["a"])
    monkeypatch.setitem(COST, "cd", 90)
    monkeypatch.delitem(COST, "ab")
    monkeypatch.delitem(COST, "ac")
    monkeypatch.setattr(Criteria, "accepts", lambda self, new, old: new.name in ("a", "cd"))
    monkeypatch.setattr(module, "log_bayes_factor", lambda new, old, problem: old.cost - new.cost)
    with limited(seconds):
        best, _ = forward(search)
    assert best.name == chosen


def test_no_model_is_gone_on_from_twice(search):
    """Nothing beside the pair is accepted, and this is not asked again."""
    forward(search)
    assert search[1] == ["a", "ab"]


@pytest.mark.parametrize(
    "left, gone_on_from", [(40, ["a", "ab", "abd"]), (95, ["a"])], ids=["half", "little"]
)
def test_no_third_effect_is_looked_for_where_two_hardly_explain_anything(
    search, monkeypatch, left, gone_on_from
):
    """It could be accepted, as it takes a tenth of what two leave."""
    for names, cost in {"a": 97, "ac": 97, "ab": left, "abc": 0.7 * left, "abd": 0.6 * left}.items():
        monkeypatch.setitem(COST, names, cost)
    monkeypatch.setitem(LINEAR, 1, ["a"])
    monkeypatch.setitem(LINEAR, 2, [])
    monkeypatch.setattr(Criteria, "accepts", lambda self, new, old: new.cost < old.cost)
    monkeypatch.setattr(Criteria, "reduces", lambda self, new, old: new.cost < old.cost)
    forward(search)
    assert search[1] == gone_on_from


def test_no_second_effect_is_looked_for_beside_one_that_hardly_helps(search, monkeypatch):
    """Pairs compete with it all the same."""
    monkeypatch.setitem(LINEAR, 1, ["a"])
    monkeypatch.setattr(Criteria, "hardly_helps", lambda self, one: one.name == "a")
    monkeypatch.setattr(Criteria, "accepts", lambda self, new, old: new.cost < old.cost)
    best, _ = forward(search)
    assert "a" not in search[1]
    assert best.name.startswith("cd")


def test_nothing_is_gone_on_from_that_takes_hardly_anything(search, monkeypatch):
    """A machine with what no effect explains: each takes a hundredth, and nothing is looked for beside it."""
    monkeypatch.setitem(COST, "a", 99)
    monkeypatch.setitem(LINEAR, 1, ["a"])
    monkeypatch.setitem(LINEAR, 2, [])
    best, _ = forward(search)
    assert (best.name, search[1]) == ("", [])


def test_a_rival_that_takes_a_place_drops_what_only_the_other_one_needed(search, monkeypatch):
    """ "ad", of which d was there for a's sake, and b in the place of a: b alone, and "ad" a rival of it."""
    monkeypatch.setitem(COST, "b", 20)
    monkeypatch.setitem(COST, "ad", 25)
    monkeypatch.setitem(COST, "bd", 19)
    monkeypatch.setattr(module, "converged", lambda best, about: (best, about))
    monkeypatch.setattr(module, "is_required", lambda members, spring: False)
    about = SimpleNamespace(fit=lambda members, nearby: made("".join(members)), problem=None)
    about.about = lambda best: about
    ahead = SimpleNamespace(behind=-3.0, predicts=True, fit=made("bd"))

    def with_alternatives(state, best, estimator, tell):
        alternatives = [[ahead]] if best.name == "ad" else []
        return SimpleNamespace(best=best, estimator=estimator, alternatives=alternatives)

    monkeypatch.setattr(module, "with_alternatives", with_alternatives)
    choice = module.swap(search[0], made("ad"), about)
    assert choice.best.name == "b"
    assert [each.name for each in search[0].tried] == ["ad"]


def test_of_two_that_are_ahead_of_each_other_none_takes_the_place_twice(search, monkeypatch):
    weighed = []
    monkeypatch.setattr(module, "converged", lambda best, about: (best, about))
    monkeypatch.setattr(module, "backward", lambda criteria, best, about: (best, about))
    about = SimpleNamespace(problem=None)
    about.about = lambda best: about

    def with_alternatives(state, best, estimator, tell):
        weighed.append(best.name)
        other = SimpleNamespace(behind=-0.1, predicts=True, fit=made("b" if best.name == "a" else "a"))
        return SimpleNamespace(best=best, estimator=estimator, alternatives=[[other]])

    monkeypatch.setattr(module, "with_alternatives", with_alternatives)
    assert module.swap(search[0], made("a"), about).best.name == "b"
    assert weighed == ["a", "b"]


@pytest.mark.parametrize("cost, chosen", [(50, "bd"), (5, "b")], ids=["gone on from", "all explained"])
def test_what_is_left_after_an_effect_was_dropped_is_gone_on_from(search, monkeypatch, cost, chosen):
    """ "a" stood in for "b" until that was there, and took the third place from "d"."""
    monkeypatch.setitem(COST, "b", cost)
    monkeypatch.setitem(COST, "bd", 9)
    forward = {"": "abc", "b": "bd"}
    monkeypatch.setattr(module, "forward", lambda state, best, about, tell: (fit(forward[best.name]), about))
    dropped = {"abc": "b", "bd": "bd"}
    monkeypatch.setattr(module, "backward", lambda criteria, best, about: (fit(dropped[best.name]), about))
    best, _ = module.forward_and_backward(search[0], None, lambda what, done: None)
    assert best.name == chosen


def test_sets_that_cannot_be_simulated_leave_their_turn_to_the_next(monkeypatch):
    """Sizes of first order may be absurd; three are fitted all the same."""
    sets = ["bow and tilt", "bow and play", "friction", "bow and mass", "tilt", "play", "mass"]
    shares = [SimpleNamespace(members=(name,), share=0.9 - k / 100) for k, name in enumerate(sets)]
    monkeypatch.setattr(proposals, "screen_sets", lambda *_: shares)
    monkeypatch.setattr(proposals, "one_variant", lambda shares, most: list(shares)[:most])
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)

    def fitted(members, nearby, limit):
        if "bow" in members[0]:
            raise NotConverged("no equilibrium")
        return fits_all(members)

    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: False)
    estimator = SimpleNamespace(trial=fitted, problem=NOTHING)
    assert names(proposals.fit_sets(estimator, STATE, BARE, 2)) == ["friction", "tilt", "play"]


def test_each_fit_of_the_search_is_told(search, monkeypatch):
    """A search of minutes tells which of its proposals it fits."""
    shares = [SimpleNamespace(members=(name,), share=0.9) for name in ("tilt", "bow")]
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: False)
    estimator, told = SimpleNamespace(trial=fits_all, problem=NOTHING), []

    def singles(state, best, about, found):
        return proposals.fitted(estimator, shares, best, state.criteria, tell=state.tell)

    monkeypatch.setattr(module, "FORWARD", {"singles": singles})
    module.forward(search[0], search[0].null, estimator, lambda what, done: told.append(what))
    wanted = ["looking for effect 1, proposal 1 of 2", "looking for effect 1, proposal 2 of 2"]
    assert told[:3] == ["looking for effect 1", *wanted]


def test_sets_that_promise_hardly_anything_are_not_fitted(monkeypatch):
    shares = [SimpleNamespace(members=(name,), share=share) for name, share in (("tilt", 0.2), ("bow", 0.02))]
    monkeypatch.setattr(proposals, "screen_sets", lambda *_: shares)
    monkeypatch.setattr(proposals, "one_variant", lambda shares, most: list(shares)[:most])
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: False)
    estimator = SimpleNamespace(trial=fits_all, problem=NOTHING)
    assert names(proposals.fit_sets(estimator, STATE, BARE, 2)) == ["tilt"]


def test_sets_that_explain_what_is_slow_are_fitted_where_all_leave_a_gap(monkeypatch):
    """Two effects that shift how an arm rings explain nothing of that to first order."""
    seen = {True: ["bow and softness", "tilt and softness"], False: ["two springs"]}
    found = lambda *given: [  # noqa: E731
        SimpleNamespace(members=(name,), share=0.9) for name in seen[given[-1] is not None and len(given) > 4]
    ]
    monkeypatch.setattr(proposals, "screen_sets", found)
    monkeypatch.setattr(proposals, "one_variant", lambda shares, most: list(shares)[:most])
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)
    estimator = SimpleNamespace(trial=fits_all, problem=NOTHING)
    for gap, fits in ((False, ["two springs"]), (True, ["two springs", *seen[True]])):
        monkeypatch.setattr(Criteria, "leaves_gap", lambda *_, gap=gap: gap)
        assert names(proposals.fit_sets(estimator, STATE, BARE, 2)) == fits


@pytest.mark.parametrize("gap, tried", [(True, 15), (False, 6)], ids=["all leave a gap", "one leaves none"])
def test_more_single_effects_are_fitted_where_all_leave_a_gap(monkeypatch, gap, tried):
    """To first order a heavy load further out looks like much else, and comes seventh.

    Of four that are slow one is among the first six, and is not fitted twice: six, three, and six.
    """
    shares = [SimpleNamespace(members=(str(k),), places=(str(k),), share=0.9 - k / 100) for k in range(20)]
    slow = [shares[k] for k in (3, 14, 15, 16)]
    monkeypatch.setattr(proposals, "screen", lambda *_, seen=None: slow if seen is not None else shares)
    monkeypatch.setattr(proposals, "slow_part", lambda problem: len)
    monkeypatch.setattr(proposals, "one_variant", lambda shares, most: list(shares)[:most])
    monkeypatch.setattr(proposals, "rescreened_at_size", lambda estimator, shares, best: shares)
    monkeypatch.setattr(Criteria, "adequate", lambda *_: True)
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: gap)
    estimator = SimpleNamespace(trial=fits_all, problem=NOTHING)
    found = names(proposals.fit_singles(estimator, [None] * 20, BARE, CRITERIA))
    assert len(found) == len(set(found)) == tried


def test_what_promises_less_than_would_be_worth_a_name_is_not_fitted_even_then(monkeypatch):
    shares = [SimpleNamespace(members=(str(k),), places=(str(k),), share=0.5**k) for k in range(20)]
    monkeypatch.setattr(proposals, "screen", lambda *_, seen=None: [] if seen else shares)
    monkeypatch.setattr(proposals, "one_variant", lambda shares, most: list(shares)[:most])
    monkeypatch.setattr(proposals, "rescreened_at_size", lambda estimator, shares, best: shares)
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: True)
    estimator = SimpleNamespace(trial=fits_all, problem=NOTHING)
    found = names(proposals.fit_singles(estimator, [None] * 20, BARE, CRITERIA))
    assert found == [str(k) for k in range(7)]  # of the second rank one: the next promises 0.8 %


@pytest.mark.parametrize("most, first", [(0.4, "far"), (0.6, "near")], ids=["little promised", "enough"])
def test_laws_are_looked_at_again_at_the_ends_of_what_is_plausible(monkeypatch, most, first):
    """A damping ten times the nominal one explains hardly anything to first order, and half at its end."""
    near = [SimpleNamespace(members=("near",), places=("near",), share=most)]
    far = [SimpleNamespace(members=("far",), places=("far",), share=0.5)]
    monkeypatch.setattr(proposals, "screen", lambda *_: near)
    monkeypatch.setattr(proposals, "one_variant", lambda shares, most: list(shares))
    monkeypatch.setattr(proposals, "rescreened_at_size", lambda estimator, shares, best: shares or far)
    monkeypatch.setattr(Criteria, "adequate", lambda *_: True)
    monkeypatch.setattr(Criteria, "explains", lambda *_: False)
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: False)
    estimator = SimpleNamespace(trial=fits_all, problem=NOTHING)
    assert names(proposals.fit_singles(estimator, [], BARE, CRITERIA))[0] == first
    after = proposals.fit_singles(estimator, [], BARE, CRITERIA, found=[fit("a")])
    assert names(after) == ["near"]  # what is left is noise, of which nothing explains half


def test_the_ends_are_those_of_laws_of_one_parameter_that_are_not_there(monkeypatch):
    """Vectors, waves and springs are sized by several; what is fitted already has its own size."""
    problem = Problem(run_of("two joints").simulation.arm, {"run": run_of("two joints").record}, step=4e-3)
    estimator = Estimator.nominal(problem, nuisance_model(problem))
    probed = [Probed(each, np.empty((0, 0))) for each in candidates(problem, estimator.nuisance.arm)]
    found, best = [], SimpleNamespace(members=(), places=(), spots={("link_mass", "fore")})
    monkeypatch.setattr(proposals, "screen", lambda *_, **__: [])
    monkeypatch.setattr(proposals, "rescreened_at_size", lambda _, shares, best: found.extend(shares) or [])
    proposals.fit_singles(estimator, probed, best, Criteria(problem, best))
    values = {(m.name, m.at): [] for (m,) in (share.members for share in found)}
    for (m,) in (share.members for share in found):
        values[m.name, m.at].append(m.effect.parameters()[0][1])
    assert ("link_mass", "fore") not in values
    assert not {"payload_offset", "transmission_error", "joint_compliance"} & {name for name, _ in values}
    prior = LinkDamping(at="upper", damping_ratio=0.02).priors(problem.arm)["damping_ratio"]
    assert values["link_damping", "upper"] == [prior.low, prior.high]


def test_where_only_an_unknown_is_strained_only_what_takes_over_is_fitted(monkeypatch):
    monkeypatch.setattr(Criteria, "adequate", lambda *_: True)
    monkeypatch.setattr(SearchState, "candidates", lambda *_: [])
    monkeypatch.setattr(proposals, "fit_singles", lambda *_: [made("ac")])
    assert proposals.singles(STATE, made("a"), None, [made("ab")]) == []
    assert names(proposals.singles(STATE, made("a"), None, [])) == ["ac"]


def test_no_sets_are_tried_where_only_an_unknown_is_strained(search, monkeypatch):
    """A late clock beside a stiffness that explains all else: one step on, not all pairs."""
    monkeypatch.setattr(Criteria, "adequate", lambda self, one: one.name == "a")
    best, _ = forward(search)
    assert best.name == "ab"
    assert [each.name for each in search[0].tried].count("cd") == 0


def test_an_effect_is_looked_for_beside_a_spring_elsewhere_that_leaves_as_little(search, monkeypatch):
    """Friction of a shoulder beside the soft shoulder, where a base that gives way came first."""
    base, shoulder, elbow = (("base_compliance", "base"), ("joint_compliance", "shoulder"), ("x", "elbow"))
    best, twin, far = (
        SimpleNamespace(places=places, cost=cost)
        for places, cost in (((base, elbow), 20.0), ((shoulder, elbow), 21.0), ((shoulder, base), 90.0))
    )
    rubs = SimpleNamespace(candidate=SimpleNamespace(effect=CoulombFriction, at="shoulder"))
    other = SimpleNamespace(candidate=SimpleNamespace(effect=CoulombFriction, at="elbow"))
    found = search[0]
    found.tried = [far, twin]
    monkeypatch.setattr(Criteria, "leaves_gap", lambda *_: True)
    monkeypatch.setattr(
        proposals, "newly_soft_joints", lambda fit: {at for name, at in fit.places if "joint" in name}
    )
    monkeypatch.setattr(found, "with_new_springs", lambda fit, about: [rubs, other])
    asked = []
    monkeypatch.setattr(
        proposals, "fit_singles", lambda about, laws, fit, criteria: asked.append((laws, fit)) or []
    )
    assert proposals.twin_spring(found, best, None, []) == []
    assert asked == [([rubs], twin)]


def test_candidates_are_probed_once_about_effects_that_are_not_all(search, monkeypatch):
    """About the same effects as they are taken further, too: what others move beside them is the same."""
    found, asked = search[0], []
    found.probed, beside = ["nominal"], SearchState.candidates
    monkeypatch.setattr(found, "with_new_springs", lambda fit, about: ["awake"])
    monkeypatch.setattr(Criteria, "adequate", lambda self, one: one.cost < 30)
    monkeypatch.setattr(search_state, "rescreened", lambda *given: asked.append(given) or ["near"])
    assert beside(found, fit(""), "about") == ["awake"]
    assert beside(found, made("ab"), "about") == ["awake"]  # which explains all
    gap = made("cd")
    assert beside(found, gap, "about") == beside(found, made("cd"), "further") == ["near"]
    assert asked == [("about", ["nominal"], gap)]


def test_sizes_of_what_takes_over_unknowns_count_from_stated_values(search, monkeypatch):
    """There the unknowns go back to; candidates probed about a fit count from where that has them."""
    found, asked = search[0], []
    found.probed = ["stated"]
    monkeypatch.setattr(SearchState, "candidates", lambda *_: ["fitted"])
    monkeypatch.setattr(
        confounding, "confounded_fits", lambda about, probed, fit, near: asked.append(probed) or []
    )
    monkeypatch.setattr(proposals, "fit_singles", lambda about, probed, *_: asked.append(probed) or [])
    for move in (confounding.confounding, proposals.singles):
        move(found, made("ab"), None, [])
    assert asked == [["stated"], ["fitted"]]


def test_an_effect_is_held_against_the_model_without_it(search, monkeypatch):
    """And a spring that another one stands on against that without effects."""
    found = search[0]
    monkeypatch.setattr(module, "without", lambda others, *_: SimpleNamespace(gain=sum(map(len, others))))
    monkeypatch.setattr(module, "is_required", lambda others, member: member == "spring")
    monkeypatch.setattr(
        module, "log_bayes_factor", lambda best, fewer, *_: "null" if fewer is found.null else fewer.gain
    )
    monkeypatch.setattr(module, "alternatives_of", lambda *_: {})
    monkeypatch.setattr(module, "explained_share", lambda *_: 1.0)
    monkeypatch.setattr(SearchState, "candidates", lambda *_: [])
    best = SimpleNamespace(members=("spring", "law", "tilt"), projected=None)
    assert module.with_alternatives(found, best, None).needed == ["null", 10, 9]
    alone = SimpleNamespace(members=("tilt",), projected=None)
    assert module.with_alternatives(found, alone, None).needed == ["null"]


@pytest.mark.parametrize("error", ["allow_for_input_noise", "allow_for_discretisation_error"])
def test_errors_of_a_model_are_allowed_for_where_they_may_be_all_that_is_left(search, monkeypatch, error):
    found, asked = search[0], []
    monkeypatch.setattr(Rows, "expected_cost", lambda *_: 20.0)  # with input noise as large as the rows' own
    for each in ("allow_for_input_noise", "allow_for_discretisation_error"):
        monkeypatch.setattr(module, each, lambda *_: None)
    monkeypatch.setattr(module, error, lambda problem, arm: asked.append(arm))
    about = SimpleNamespace(with_effects=lambda members: "".join(members))
    for cost in (70.0, 400.0):  # 3.5 and 20 times what a right model leaves
        one = SimpleNamespace(members=("a",), cost=cost, places=(), name="a", non_smooth=False)
        module.best_proposed(found, about, [one], found.null)
    assert asked == ["a"]
