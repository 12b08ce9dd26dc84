"""benchmarks/blind.py makes a case, asks for a diagnosis and keeps both."""

import json
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

import flexarm

BENCHMARKS = Path(__file__).resolve().parents[2] / "benchmarks"


@pytest.fixture
def blind(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    monkeypatch.setattr(sys, "argv", ["blind.py"])
    import blind

    return blind


def test_an_outcome_is_kept_and_reused(blind, monkeypatch, tmp_path):
    """The second time nothing is diagnosed; without --reuse it is, on the case that was made before."""
    asked = []

    def diagnose(arm, records, hold_out, **options):
        asked.append((arm, sorted(records), hold_out))
        return SimpleNamespace(updated=arm, to_json_dict=lambda: {"verdict": "adequate", "effects": []})

    monkeypatch.setattr(flexarm, "diagnose", diagnose, raising=False)
    spec = blind.Spec("none", "hinged", (), (), 0.0, 31)
    first = blind.diagnosed(spec, tmp_path, reuse=True)
    assert blind.diagnosed(spec, tmp_path, reuse=True) == first
    assert len(asked) == 1
    blind.diagnosed(spec, tmp_path, reuse=False)
    assert asked[0][1] == ["train_a", "train_b"]
    assert asked[1][2].signals["tip"].values.shape == asked[0][2].signals["tip"].values.shape
    assert first.before == first.after > 0
    assert "said adequate where there is none" in str(blind.tabulated([first]))


def test_a_diagnosis_that_fails_is_an_outcome(blind, monkeypatch, tmp_path):
    def diagnose(*_, **__):
        raise RuntimeError("no convergence")

    monkeypatch.setattr(flexarm, "diagnose", diagnose, raising=False)
    found = blind.diagnosed(blind.Spec("none", "hinged", (), (), 0.0, 31), tmp_path, reuse=False)
    assert found.error == "RuntimeError: no convergence"
    assert json.loads((tmp_path / "none-hinged-0-31" / "outcome.json").read_text())["error"] == found.error


def test_an_unknown_group_is_refused(blind, monkeypatch, capsys):
    monkeypatch.setattr(sys, "argv", ["blind.py", "--out", "x", "--groups", "single,triple"])
    with pytest.raises(SystemExit):
        blind.arguments()
    assert "no group 'triple'; there are single, power, poor" in capsys.readouterr().err
