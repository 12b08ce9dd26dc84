"""`flexarm example`: the same files each time, whole or not there."""

import numpy as np
import pytest
from pytest import approx

import flexarm
from flexarm import _core
from flexarm.cli.run import run
from flexarm.example.files import GAP, joined


@pytest.fixture(scope="module")
def tryout(tmp_path_factory):
    directory = tmp_path_factory.mktemp("example") / "tryout"
    assert run(["example", str(directory)]) == 0
    return directory


def test_the_files_are_the_same_each_time(tryout, tmp_path):
    assert run(["example", str(tmp_path / "again")]) == 0
    files = sorted(path.relative_to(tryout) for path in tryout.rglob("*") if path.is_file())
    assert {"arm.toml", "README.md", "bracket.inp", "swing.csv", "machine.toml"} <= {str(f) for f in files}
    assert all((tryout / f).read_bytes() == (tmp_path / "again" / f).read_bytes() for f in files)


def test_what_a_user_wrote_is_not_overwritten(tryout, capsys):
    assert run(["example", str(tryout)]) == 2
    assert "holds files already" in capsys.readouterr().err
    assert run(["example", str(tryout), "--force"]) == 0


def test_the_model_lacks_what_the_machine_has(tryout):
    model, machine = (flexarm.Arm.from_toml(tryout / name) for name in ("arm.toml", "machine.toml"))
    assert model.effect("backlash", "hinge") is None
    assert machine.effect("backlash", "hinge").gap == GAP
    assert machine.link("rod").material.youngs_modulus == approx(
        1.006 * model.link("rod").material.youngs_modulus
    )


def test_moves_begin_and_end_at_rest():
    """Minimum jerk: rate and acceleration vanish at every stop; the greatest rate is 15/8 of the mean one."""
    time, angle = joined([0.0, 1.0, 0.5], 2.0)
    rate = np.gradient(angle, time)
    at_stops = rate[[0, len(time) // 2, -1]]
    assert at_stops == approx(0, abs=1e-3)
    assert rate.max() == approx(15 / 8 / 2.0, rel=1e-4)
    assert (angle[0], angle[len(time) // 2], angle[-1]) == approx((0.0, 1.0, 0.5))


def test_the_mesh_is_a_collar_of_steel(tryout):
    """Sleeve 30 to 45 mm, 60 mm long; plate 30 to 80 mm, 12 mm thick: volume pi sum (r2^2 - r1^2) h."""
    mesh = flexarm.read_mesh(tryout / "bracket.inp", unit="mm")
    exact = 7850 * np.pi * ((45**2 - 30**2) * 60 + (80**2 - 30**2) * 12) * 1e-9
    _, lower = _core.assemble_solids(mesh.core())
    along_x = np.zeros(mesh.n_dof)
    along_x[::3] = 1.0
    mass = 2 * along_x @ (lower @ along_x) - lower.diagonal()[::3].sum()
    assert mass == approx(exact, rel=1e-4)  # 20-node cells follow the circles to 5e-5 at 16 around
    radius = np.hypot(*mesh.points[mesh.point_set("BORE"), :2].T)
    assert radius == approx(0.03, rel=1e-5)
    assert mesh.points[mesh.point_set("FLANGE"), 2] == approx(0.072)
