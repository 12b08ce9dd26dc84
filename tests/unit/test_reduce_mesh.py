"""Claims about parts reduced from meshes: what is kept exactly, what converges, and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pytest import approx
from scipy.linalg import eigh
from scipy.sparse import diags
from scipy.sparse.linalg import eigsh
from scipy.spatial.transform import Rotation

from flexarm import InterfaceSet, InvalidFile, InvalidParameter, SuperElement, _core, reduce_mesh
from flexarm.cli.run import run
from flexarm.solids import Material, SolidMesh, read_mesh, ring, tube
from flexarm.superelement.mass_checks import outside

STEEL = Material(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
CORK = Material(youngs_modulus=1e9, poisson_ratio=0.0, density=500)
ENDS = {"start": "bottom", "end": "top"}


@pytest.fixture(scope="module")
def mesh() -> SolidMesh:
    return ring(0.1, 0.2, 0.1, size=0.05, around=16, order=2, material=STEEL)


@pytest.fixture(scope="module")
def part(mesh) -> SuperElement:
    return reduce_mesh(mesh, ENDS, modes=12, recovery=True, name="ring")


def test_mass_centre_and_inertia_of_the_mesh_are_kept(mesh, part):
    """Exactly: rigid motion is among the static shapes."""
    mass, first, about_origin = _core.mass_properties(mesh.core())
    c = np.asarray(first) / mass
    assert part.mass_total == approx(mass, rel=1e-10)
    assert part.centre == approx(c, abs=1e-10)
    inertia = about_origin - mass * (c @ c * np.eye(3) - np.outer(c, c))
    assert part.inertia == approx(inertia, rel=1e-9, abs=1e-9 * np.abs(inertia).max())


def test_a_reduced_part_passes_its_checks(part):
    assert part.check(mass=np.pi * (0.2**2 - 0.1**2) * 0.1 * 7850) == []


def test_interfaces_stand_in_the_middle_of_their_points(mesh, part):
    assert part.positions == approx(np.array([[0, 0, 0], [0, 0, 0.1]]), abs=1e-12)
    assert part.interfaces == ("start", "end")


def test_a_moved_mesh_gives_the_moved_part(mesh, part):
    R, p = Rotation.from_rotvec([0.3, -1.1, 0.5]).as_matrix(), np.array([0.4, -0.3, 1.0])
    other, expected = reduce_mesh(mesh.moved(R, p), ENDS, modes=12), part.moved(R, p)
    held = slice(0, 12)
    for name in ("stiffness", "mass"):
        a, b = getattr(other, name)[held, held], getattr(expected, name)[held, held]
        assert a == approx(b, abs=1e-7 * np.abs(b).max()), name
    assert other.frequency_hz == approx(expected.frequency_hz, rel=1e-7)
    assert other.centre == approx(expected.centre, abs=1e-9)


def test_millimetres_give_the_same_part(mesh, part, tmp_path):
    replace(mesh, points=1e3 * mesh.points).save(tmp_path / "ring.vtu")
    solid = read_mesh(tmp_path / "ring.vtu", unit="mm").with_materials(STEEL)
    again = reduce_mesh(solid, ENDS, modes=12)
    assert again.mass_total == approx(part.mass_total, rel=1e-6)
    assert again.stiffness[:12, :12] == approx(
        part.stiffness[:12, :12], abs=1e-6 * part.stiffness[:12, :12].max()
    )
    assert again.frequency_hz == approx(part.frequency_hz, rel=1e-6)


def full_frequencies(mesh, count):
    """Elastic frequencies of the free mesh [Hz], by SciPy's own eigensolver."""
    K, M = (X + X.T - diags(X.diagonal()) for X in _core.assemble_solids(mesh.core()))
    squares = eigsh(K, count + 6, M, sigma=-1e6, return_eigenvectors=False)
    return np.sqrt(np.sort(squares)[6:]) / (2 * np.pi)


def reduced_frequencies(part, count):
    squares = eigh(part.stiffness, part.mass, eigvals_only=True)
    return np.sqrt(squares[6 : 6 + count]) / (2 * np.pi)


@pytest.fixture(scope="module")
def short_tube() -> SolidMesh:
    """Its ends bend, twist and stretch it below the frequencies at which it ovalises."""
    return tube(0.1, 0.01, 0.6, size=(0.01, 0.1), around=12, order=2, material=STEEL)


AVERAGED = {name: f"{points}:average" for name, points in ENDS.items()}


def test_free_frequencies_lie_above_those_of_the_mesh_and_come_down_with_modes(short_tube):
    """Average interfaces constrain nothing, so that Rayleigh's principle bounds by the free mesh itself."""
    full = full_frequencies(short_tube, 6)
    errors = []
    for modes in (4, 12, 40):
        found = reduced_frequencies(reduce_mesh(short_tube, AVERAGED, modes=modes), 6)
        errors.append(found / full - 1)
        assert (errors[-1] > -1e-8).all()
    assert (errors[1] <= errors[0] + 1e-10).all()
    assert (errors[2] <= errors[1] + 1e-10).all()
    assert errors[2].max() < 5e-3


def test_the_stated_error_of_free_frequencies_covers_the_true_one(short_tube):
    """With rigid ends, where the mesh itself is one with rigid ends: many more modes stand in for it."""
    part = reduce_mesh(short_tube, ENDS, modes=16)
    true = reduced_frequencies(part, 4) / reduced_frequencies(reduce_mesh(short_tube, ENDS, modes=200), 4) - 1
    stated = np.asarray(part.quality["free_frequency_error"])[:4]
    assert true.max() > 1e-4
    assert (stated >= 0.5 * true).all()
    assert (stated <= 5 * true + 1e-6).all()


def test_modes_up_to_a_frequency_are_all_there(mesh):
    part = reduce_mesh(mesh, ENDS, max_frequency=12_000)
    more = reduce_mesh(mesh, ENDS, modes=part.n_modes + 3)
    assert (part.frequency_hz <= 12_000).all()
    assert more.frequency_hz[part.n_modes] > 12_000
    assert part.frequency_hz == approx(more.frequency_hz[: part.n_modes], rel=1e-6)


def test_a_long_tube_is_a_beam():
    """Tube of 40 diameters, ends rigid: EA/L, 12 EI/L^3/(1 + Phi), GJ/L of Timoshenko, shear factor 0.53.

    Held ends cannot contract; that stiffens about one diameter, so that 1 % is allowed.
    """
    d, t, L = 0.05, 0.004, 2.0
    mesh = tube(d, t, L, size=(t, 0.05), around=16, order=2, material=STEEL)
    K = reduce_mesh(mesh, ENDS, modes=0).stiffness
    E, G = 210e9, 210e9 / 2.6
    A, Iyy = np.pi / 4 * (d**2 - (d - 2 * t) ** 2), np.pi / 64 * (d**4 - (d - 2 * t) ** 4)
    shear = 12 * E * Iyy / (0.53 * G * A * L**2)
    assert K[8, 8] == approx(E * A / L, rel=1e-2)
    assert K[6, 6] == approx(12 * E * Iyy / L**3 / (1 + shear), rel=1e-2)
    assert K[10, 10] == approx((4 + shear) / (1 + shear) * E * Iyy / L, rel=1e-2)
    assert K[11, 11] == approx(G * 2 * Iyy / L, rel=1e-2)


def test_a_slender_part_held_at_one_end_raises_no_doubt():
    """Its centre is sqrt(3) radii of gyration from the only interface."""
    mesh = tube(0.05, 0.004, 1.0, size=(0.004, 0.1), around=8, order=1, material=STEEL)
    finger = reduce_mesh(mesh, {"root": "bottom"}, modes=2)
    assert finger.check() == []
    mass = finger.mass.copy()
    lever = np.array([[0, -1, 0], [1, 0, 0], [0, 0, 0.0]])  # c x for a centre 1 m up
    mass[:6, :6] = np.block([[np.eye(3), -lever], [lever, 0.01 * np.eye(3) - lever @ lever]])
    (doubt,) = outside(replace(finger, mass=mass))
    assert "z = 1 m, farther from the box of the interfaces than twice the radius of gyration" in doubt.what


def test_stress_of_a_pulled_bar_is_uniform():
    """Without lateral contraction sigma = E u/L, everywhere; recovery and stress hold it to rounding."""
    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=16, order=1, material=CORK)
    part = reduce_mesh(mesh, ENDS, modes=2, recovery=True)
    q = np.zeros(part.n_dof)
    q[8] = 1e-4
    displaced = part.recover(q)
    assert displaced[:, 2] == approx(1e-4 * mesh.points[:, 2] / 0.1, abs=1e-12)
    assert part.von_mises(mesh, q) == approx(1e9 * 1e-3, rel=1e-6)


def test_rigid_motion_is_recovered_without_stress(mesh, part):
    from flexarm.superelement.rigid_motion import rigid_motions

    t, w = np.array([1e-3, -2e-3, 5e-4]), np.array([2e-4, 1e-4, -3e-4])
    q = rigid_motions(part.positions, part.n_modes) @ np.concatenate([t, w])
    assert part.recover(q) == approx(t + np.cross(w, mesh.points), abs=1e-12)
    pulled = np.zeros(part.n_dof)
    pulled[8] = 1e-3
    assert part.von_mises(mesh, q).max() < 1e-8 * part.von_mises(mesh, pulled).max()


def test_damping_is_that_of_the_first_free_mode(mesh):
    """2 zeta omega = phi^T C phi for unit modal mass, and omega-proportional above."""
    part = reduce_mesh(mesh, ENDS, modes=6, damping_ratio=0.02)
    squares, shapes = eigh(part.stiffness, part.mass)
    omega = np.sqrt(squares[6:])
    modal = np.diag(shapes.T @ part.damping @ shapes)[6:]
    assert modal / (2 * omega) == approx(0.02 * omega / omega[0], rel=1e-6)


def test_inertia_load_is_mass_times_translation(part):
    assert part.inertia_load[:12] == approx(part.mass[:12, :12] @ np.tile(np.eye(6), 2).T[:, :3], abs=1e-9)


def test_an_interface_may_stand_elsewhere_with_other_axes(mesh):
    R = Rotation.from_euler("x", 90, degrees=True).as_matrix()
    hub = InterfaceSet("bottom", position=[0.0, 0.0, -0.05], rotation=R)
    part = reduce_mesh(mesh, {"hub": hub, "rim": "outer:average"}, modes=0)
    assert part.positions[0] == approx([0, 0, -0.05])
    assert part.rotations[0] == approx(R)
    assert part.check() == []


def test_one_interface_leaves_a_rigid_body_and_its_modes(mesh):
    rigid = reduce_mesh(mesh, {"hub": "inner"}, modes=0)
    assert rigid.n_dof == 6
    assert rigid.check() == []
    assert reduce_mesh(mesh, {"hub": "inner"}, modes=3).check() == []
    with pytest.raises(InvalidParameter, match="damping_ratio: needs an elastic mode"):
        reduce_mesh(mesh, {"hub": "inner"}, modes=0, damping_ratio=0.01)


def test_the_file_tells_where_the_part_comes_from(part, tmp_path):
    part.save(tmp_path / "ring.nc")
    again = SuperElement.load(tmp_path / "ring.nc")
    assert len(again.provenance["mesh_sha256"]) == 64
    assert "METIS" in again.provenance["backend"] or "AMD" in again.provenance["backend"]
    assert again.provenance["modes_wanted"] == "12"
    assert again.quality["trusted_frequency_hz"] == approx(float(part.quality["trusted_frequency_hz"]))
    assert again.recover(np.ones(again.n_dof)) == approx(part.recover(np.ones(part.n_dof)))


@pytest.mark.parametrize(
    ("change", "told"),
    [
        ({"interfaces": {}}, "interfaces: there must be at least one interface"),
        ({"interfaces": {"a": "nowhere"}}, "point set 'nowhere'"),
        (
            {"interfaces": {"a": InterfaceSet("top", kind="glued")}},
            "interface 'a': must be one of rigid, average",
        ),
        (
            {"interfaces": {"a": "top", "b": "outer"}},
            # the upper outer edge: 16 cells of 20 nodes have 32 points there
            r"interface 'b': shares 32 points with 'a' \(node \d+, \d+, \d+, \d+, \d+, \.\.\); a point may",
        ),
        ({"modes": -1}, "modes: must be a whole number"),
        ({"modes": 3, "max_frequency": 10.0}, "modes: give modes or max_frequency, not both"),
        ({"max_frequency": -1.0}, "max_frequency: must be positive"),
        ({"damping_ratio": 1.5}, "damping_ratio: must be in"),
        ({"mass": 50.0}, "weighs 7[0-9.]+ kg, stated are 50 kg"),
    ],
)
def test_mistakes_are_told(mesh, change, told):
    with pytest.raises(InvalidParameter, match=told):
        reduce_mesh(**{"mesh": mesh, "interfaces": ENDS, **change})


def test_progress_may_end_the_work(mesh):
    heard = []

    def stop(phase, done):
        heard.append(phase)
        if phase == "factor":
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        reduce_mesh(mesh, ENDS, progress=stop)
    assert heard[:2] == ["mesh", "assembly"]


# The command line


@pytest.fixture
def file(mesh, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    mesh_mm = replace(mesh, points=1e3 * mesh.points)
    mesh_mm.save("ring.vtu")
    return "ring.vtu"


COMMAND = ["reduce", "ring.vtu", "--unit", "mm", "--material", "E=210GPa,nu=0.3,rho=7850kg/m3"]
INTERFACES = ["--interface", "start=bottom", "--interface", "end=top:average"]


def test_a_mesh_file_becomes_a_super_element(file, capsys):
    assert run([*COMMAND, *INTERFACES, "--modes", "5", "--out", "ring.nc", "--picture", "ring.png"]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "super-element ring: 17 degrees of freedom, 2 interfaces, 5 internal modes" in told.out
    assert "interface end at (0, 0, 0.1) m, average" in told.out
    assert "trustworthy up to" in told.out
    assert SuperElement.load("ring.nc").provenance["mesh_file"] == "ring.vtu"
    assert Path("ring.png").read_bytes().startswith(b"\x89PNG")


def test_a_mesh_in_millimetres_read_as_metres_is_refused_and_unit_mm_named(file, tmp_path, capsys):
    """A ring of 400 mm would weigh a billion times what it does; a stated mass vouches for it."""
    command = ["reduce", "ring.vtu", *COMMAND[4:], *INTERFACES, "--modes", "0", "--out", "ring.nc"]
    assert run(command) == 2
    told = capsys.readouterr().err
    assert told.startswith("error: ring.vtu: unit: the part is 400 m across and weighs ")
    assert "Say --unit mm" in told
    assert not list(tmp_path.glob("*.nc"))
    weight = told.partition("weighs ")[2].split()[0]
    assert run([*command, "--mass", weight]) == 0
    assert "did you mean unit = 'mm'?" in capsys.readouterr().err


def test_json_tells_modes_quality_and_seconds(file, capsys):
    assert run([*COMMAND, *INTERFACES, "--modes", "5", "--out", "ring.nc", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert len(told["frequency_hz"]) == len(told["quality"]["effective_mass"]) == 5
    assert told["quality"]["statistics"]["seconds_assembly"] > 0


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        ([*COMMAND], "error: command line: --interface: is needed, NAME=SET; the mesh has the sets inner"),
        ([*COMMAND, "--interface", "a=botom"], "error: ring.vtu: point set 'botom'"),
        ([*COMMAND[:4], *INTERFACES], "error: ring.vtu: "),
        ([*COMMAND, *INTERFACES, "--modes", "-2"], "error: ring.vtu: modes: must be a whole number"),
        ([*COMMAND, *INTERFACES, "--mass", "1"], "error: ring.vtu: mass: R^T M R weighs"),
        (["reduce", "absent.inp", *INTERFACES], "error: absent.inp: "),
    ],
)
def test_mistakes_end_with_exit_code_2_and_no_file(file, tmp_path, capsys, arguments, told):
    assert run([*arguments, "--out", "ring.nc"]) == 2
    assert capsys.readouterr().err.splitlines()[-1].startswith(told)
    assert not list(tmp_path.glob("*.nc"))


def test_the_file_named_in_an_error_of_an_invalid_material(file, capsys):
    with pytest.raises(InvalidFile):
        reduce_mesh("ring.vtu", ENDS, unit="mm")


@pytest.mark.parametrize("modes", [2.5, -1, 100_000])
def test_an_impossible_number_of_modes_is_refused(mesh, modes):
    with pytest.raises(InvalidParameter, match=r"modes: must be a whole number, 0 to 1000"):
        reduce_mesh(mesh, ENDS, modes=modes)


def test_an_unknown_tie_is_told_from_an_unknown_set(mesh):
    with pytest.raises(InvalidParameter, match="must be SET, SET:rigid or SET:average, got 'top:avg'"):
        reduce_mesh(mesh, {"end": "top:avg"}, modes=0)


def test_points_may_be_indices_or_a_mask(mesh):
    chosen = mesh.points[:, 2] == mesh.points[:, 2].min()
    by_mask = reduce_mesh(mesh, {"a": InterfaceSet(chosen)}, modes=0)
    by_index = reduce_mesh(mesh, {"a": np.flatnonzero(chosen)}, modes=0)
    assert np.array_equal(by_mask.mass, by_index.mass)


@pytest.mark.parametrize("points", [[10**6, 1, 2], [0.5, 1.0, 2.0], [], [[0, 1, 2]]])
def test_points_that_are_none_are_refused(mesh, points):
    with pytest.raises(InvalidParameter, match="must be the name of a set, indices 0 to"):
        reduce_mesh(mesh, {"a": InterfaceSet(points)}, modes=0)


@pytest.mark.parametrize("wrong", [{"position": [0, 0]}, {"rotation": np.eye(2)}])
def test_frames_of_the_wrong_shape_are_refused(mesh, wrong):
    with pytest.raises(InvalidParameter, match=r"interface 'a': \w+ must have the shape"):
        reduce_mesh(mesh, {"a": InterfaceSet("bottom", **wrong)}, modes=0)
