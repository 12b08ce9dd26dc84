"""What is fitted along, and how well it is known beforehand."""

from types import SimpleNamespace

import numpy as np
import pytest
from arms import crane

from flexarm.diagnosis.nuisance import UNKNOWN_DELAY, UNKNOWN_POSE, known_loads, nominal, nuisance_model
from flexarm.record import Record, Signal
from flexarm.record.table import CarriedPayload, Clock, Frame

KNOWN = {"clocks": {"controller": Clock(), "tracker": Clock(sigma=2e-3)},
         "frames": {"tracker": Frame(translation=1e-3, rotation=5e-4)}}  # fmt: skip
ROUGHLY = {"clocks": {"controller": Clock(), "tracker": Clock(sigma=1e-2)},
           "frames": {"tracker": Frame(translation=5e-4, rotation=2e-3)}}  # fmt: skip
UNKNOWN = {"clocks": {"controller": Clock(), "tracker": Clock(unknown=True)},
           "frames": {"tracker": Frame(unknown=True)}}  # fmt: skip
TIME = np.arange(0.0, 1.0, 0.1)


def record(**stated):
    """A run of a crane, of which the tip is seen on a clock and in a frame of its own."""
    stated = {**KNOWN, **stated}
    encoder = {"quantity": "joint_angle", "joint": "hinge", "side": "motor", "clock": "controller"}
    tracker = {"quantity": "position", "point": "tip", "clock": "tracker", "frame": "tracker"}
    signals = [
        Signal(name="q", time=TIME, values=TIME, noise_std=1e-6, **encoder),
        Signal(name="tip", time=TIME, values=np.zeros((len(TIME), 3)), noise_std=1e-4, **tracker),
    ]
    return Record(signals=signals, drive=("q",), **stated)


@pytest.mark.parametrize(
    "loads, uncertain",
    [
        ([{"mass": 5.0}, {"mass": 6.0}], []),
        ([{"mass": 5.0}, {}], ["payloads.load.mass"]),
        ([{"inertia": (0.1, 0.1, 0.1)}], ["payloads.load.mass"]),
        ([], ["payloads.load.mass"]),
    ],
    ids=["by all", "by one", "turned alone", "no record"],
)
@pytest.mark.parametrize("key", ["payloads.load.mass", "payloads.load.mass_kg"])
def test_a_mass_is_known_where_every_record_weighed_it(loads, uncertain, key):
    """A record that states an inertia and no mass says nothing of the mass."""
    arm = crane(uncertainty={key: 0.05})
    records = {f"{k}": record(payloads={"load": CarriedPayload(**load)}) for k, load in enumerate(loads)}
    assert [each.key for each in nominal(arm, records)] == uncertain
    assert known_loads(arm, records) == ([] if uncertain else ["load"])


@pytest.mark.parametrize(
    "stated, delay, translation, rotation",
    [
        ([KNOWN, ROUGHLY], 2e-3, 5e-4, 5e-4),
        ([KNOWN, UNKNOWN], 2e-3, 1e-3, 5e-4),
        ([UNKNOWN, UNKNOWN], UNKNOWN_DELAY, UNKNOWN_POSE["translation"], UNKNOWN_POSE["rotation"]),
    ],
    ids=["all", "one", "none"],
)
@pytest.mark.parametrize("turned", [False, True], ids=["in order", "turned round"])
def test_a_clock_and_a_frame_are_known_as_well_as_one_record_knows_them(
    stated, delay, translation, rotation, turned
):
    """Whichever record comes first: they are one clock and one frame."""
    records = {f"{k}": record(**each) for k, each in enumerate(reversed(stated) if turned else stated)}
    rows = [SimpleNamespace(record=name, signal="tip") for name in records]
    found = nuisance_model(
        SimpleNamespace(arm=crane(), records=records, rows=rows, initial_conditions=(), tilts=())
    )
    assert {each.key.split(".")[3]: each.sigma for each in found.parameters} == {
        "delay": delay,
        "translation": translation,
        "rotation": rotation,
    }


@pytest.mark.parametrize(
    "key, sigma, step, kept",
    [
        ("links.rod.material.youngs_modulus", 1.0, -8e11, -0.8 * 210e9),
        ("links.rod.material.youngs_modulus", 1.0, 8e11, 8e11),
        ("payloads.load.mass_kg", 20.0, -30.0, -0.8 * 14.1),
        ("payloads.load.inertia_kgm2", 1.0, -0.5, 0.0),
        ("points.tip.position_m", 5.0, -4.0, -4.0),
    ],
)
def test_what_is_hardly_known_stays_where_the_model_allows_it(key, sigma, step, kept):
    """A modulus to 100 %, as one that nobody knows, is never negative; a place may be on either side."""
    *_, last = nominal(crane(uncertainty={key: sigma}), {})
    assert last.limited(step) == pytest.approx(kept)
