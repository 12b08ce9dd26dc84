"""Cases whose missing effect acts at a payload, a link or the base: with it the model meets the answer.

`floor_nominal` is the tip's rms with the true effect and everything else nominal, as the independent
simulator that made the data has it. A rigid-rod chain and flexarm's elements differ by 2e-5 m at most.
"""

import json

import pytest

from flexarm import Arm, Record, compare
from flexarm.effects import effect_class

BASE_DAMPING = 1e-3
"""Damping of a compliant base in the data, in parts of its stiffness [s]; answers do not repeat it."""


@pytest.mark.parametrize(
    ("case", "effect"),
    [
        ("case_08", "base_compliance"),
        ("case_09", "payload_mass"),
        ("case_11", "link_length"),
        ("case_18", "link_stiffness"),
    ],
)
def test_the_true_effect_leaves_what_the_answer_says(shared_dir, case, effect):
    """Within 5e-6 m of the total rms, before the repair and after it; clocks and frames are aligned."""
    folder = shared_dir / "cases" / case
    answer = json.loads((shared_dir / "cases/answers" / f"{case}.json").read_text())
    (stated,) = answer["effects"]
    assert stated["name"] == effect
    values = {parameter["name"]: parameter["value"] for parameter in stated["parameters"]}
    if effect == "base_compliance":
        values["damping"] = BASE_DAMPING * values["stiffness"]
    nominal, record = Arm.from_toml(folder / "model.toml"), Record.load(folder / "held_out")
    repaired = nominal.with_effect(effect_class(effect)(at=stated["at"], **values))
    for arm, key in ((nominal, "before"), (repaired, "floor_nominal")):
        rms = compare(arm, record).signals["tip"].rms["total"]
        assert rms == pytest.approx(answer["held_out"][key]["total"], abs=5e-6)
