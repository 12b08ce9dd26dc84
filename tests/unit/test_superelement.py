"""Claims about super-element data: what they weigh, other frames, files, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest
from part_arms import tube_part
from parts import BARS, CORNERS, HEIGHT, RHO, WIDTH, frame_mass, frame_part
from pytest import approx
from scipy.spatial.transform import Rotation

from flexarm import InvalidFile, InvalidParameter, SuperElement

VARIABLES = (
    "interface_name",
    "interface_position",
    "interface_rotation",
    "stiffness",
    "mass",
    "damping",
    "frequency_hz",
    "inertia_load",
)


@pytest.fixture(scope="module")
def part() -> SuperElement:
    return frame_part(damping=1e-5)


def test_rigid_motion_carries_the_mass_and_centre_of_the_bars(part):
    """Sum of the bars; cubic and linear shape functions hold rigid motion exactly."""
    ends = [(np.array(CORNERS[a]), np.array(CORNERS[b])) for a, b in BARS]
    masses = [RHO * WIDTH * HEIGHT * np.linalg.norm(b - a) for a, b in ends]
    centre = sum(m * (a + b) / 2 for m, (a, b) in zip(masses, ends, strict=True)) / sum(masses)
    assert part.mass_total == approx(frame_mass(), rel=1e-9)
    assert part.centre == approx(centre, abs=1e-9)


def test_inertia_is_that_of_the_bars_about_their_centre(part):
    """Thin rods: m L^2/12 across, Steiner; the bars' consistent mass adds rho (Iy + Iz) L along each."""
    J = np.zeros((3, 3))
    for a, b in ((np.array(CORNERS[a]), np.array(CORNERS[b])) for a, b in BARS):
        L = np.linalg.norm(b - a)
        m, x, d = RHO * WIDTH * HEIGHT * L, (b - a) / L, (a + b) / 2 - part.centre
        J += m * L**2 / 12 * (np.eye(3) - np.outer(x, x)) + m * (d @ d * np.eye(3) - np.outer(d, d))
        J += RHO * WIDTH * HEIGHT * (WIDTH**2 + HEIGHT**2) / 12 * L * np.outer(x, x)
    assert part.inertia == approx(J, rel=1e-9, abs=1e-9)


def test_a_sound_part_raises_no_doubt(part):
    assert part.check(mass=frame_mass()) == []


def test_rounding_where_a_symmetric_part_has_zeros_is_accepted():
    """A tube couples no directions; its matrices from a factorisation do, in the fifteenth digit."""
    exact = tube_part()
    noise = np.random.default_rng(3).standard_normal(exact.mass.shape)
    mass = exact.mass + 1e-15 * exact.mass.max() * (noise + noise.T)
    assert replace(exact, mass=mass).check() == exact.check()


def test_another_frame_turns_centre_and_inertia_and_leaves_energies(part):
    R, p = Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix(), np.array([1.0, 2.0, -0.5])
    other = part.moved(R, p)
    assert other.check() == []
    assert other.centre == approx(R @ part.centre + p, abs=1e-9)
    assert other.inertia == approx(R @ part.inertia @ R.T, rel=1e-7, abs=1e-9)
    assert other.inertia_load[:3] == approx(R @ part.inertia_load[:3] @ R.T, abs=1e-9)
    values = [np.linalg.eigvalsh(e.stiffness) for e in (part, other)]
    assert values[0] == approx(values[1], rel=1e-7, abs=1e-4)


def test_a_move_and_its_inverse_give_the_part_back(part):
    R, p = Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix(), np.array([1.0, 2.0, -0.5])
    again = part.moved(R, p).moved(R.T, -R.T @ p)
    for name in ("positions", "rotations", "stiffness", "mass", "damping", "inertia_load"):
        expected = getattr(part, name)
        assert getattr(again, name) == approx(expected, abs=1e-12 * np.abs(expected).max())


def test_recovery_turns_with_the_part(part):
    """Displacements of the points, turned, are those of the turned part under the turned coordinates."""
    rng = np.random.default_rng(1)
    full = part.replace(recovery=rng.standard_normal((12, part.n_dof)))
    R = Rotation.from_rotvec([0.3, -1.2, 0.7]).as_matrix()
    q = rng.standard_normal(part.n_dof)
    turned = q.copy()
    turned[:18] = (q[:18].reshape(-1, 3) @ R.T).ravel()
    assert full.moved(R).recover(turned) == approx(full.recover(q) @ R.T, abs=1e-12)


def test_recovery_that_was_not_kept_is_said(part):
    with pytest.raises(InvalidParameter, match="holds no recovery matrix"):
        part.recover(np.zeros(part.n_dof))


@pytest.mark.parametrize("n_modes", [0, 3])
def test_a_file_gives_back_what_was_saved(tmp_path, n_modes):
    part = frame_part(n_modes).replace(
        recovery=np.arange(3.0 * (18 + n_modes)).reshape(3, -1),
        quality={"trustworthy_hz": 12.5, "effective_mass": np.eye(2)},
        provenance={"mesh_sha256": "abc"},
    )
    part.save(tmp_path / "part.nc")
    again = SuperElement.load(tmp_path / "part.nc")
    assert (again.name, again.interfaces) == ("frame", ("foot", "hand", "ear"))
    for name in (
        "positions",
        "rotations",
        "stiffness",
        "mass",
        "damping",
        "frequency_hz",
        "inertia_load",
        "recovery",
    ):
        assert np.array_equal(getattr(again, name), getattr(part, name)), name
    assert again.quality == {"trustworthy_hz": 12.5, "effective_mass": [[1.0, 0.0], [0.0, 1.0]]}
    assert again.provenance["mesh_sha256"] == "abc"
    assert again.provenance["flexarm_version"]


def test_the_file_holds_variables_and_dimensions_as_documented(part, tmp_path):
    import h5netcdf

    part.save(tmp_path / "part.nc")
    with h5netcdf.File(tmp_path / "part.nc") as file:
        assert file.attrs["format"] == "flexarm-superelement/1"
        assert set(VARIABLES) == set(file.variables)
        assert file.variables["stiffness"].dimensions == ("dof", "dof")
        assert file.variables["interface_rotation"].shape == (3, 3, 3)
        assert file.variables["inertia_load"].shape == (22, 3)


def test_an_existing_file_is_kept_unless_forced(part, tmp_path):
    path = tmp_path / "part.nc"
    path.write_bytes(b"precious")
    with pytest.raises(
        InvalidFile, match=r"part\.nc: output: exists already; allowed is a new file, or --force"
    ):
        part.save(path)
    assert path.read_bytes() == b"precious"
    part.save(path, force=True)
    assert SuperElement.load(path).interfaces == part.interfaces


def write(path, part, drop=(), attrs=None, **changes):
    """A file as another program would write it: the contract's variables only, by h5py."""
    import h5py

    text = h5py.string_dtype()
    values = {
        "interface_name": np.array(part.interfaces, dtype=text),
        "interface_position": part.positions,
        "interface_rotation": part.rotations,
        "stiffness": part.stiffness,
        "mass": part.mass,
        "damping": part.damping,
        "frequency_hz": part.frequency_hz,
        "inertia_load": part.inertia_load,
    }
    with h5py.File(path, "w") as file:
        for name, value in {**values, **changes}.items():
            if name not in drop:
                file[name] = value
        for i, name in enumerate(file):  # dimension scales make it a NetCDF that any reader opens
            for axis in range(file[name].ndim):
                scale = f"d{i}_{axis}"
                file[scale] = np.zeros(file[name].shape[axis])
                file[scale].make_scale("This is a netCDF dimension but not a netCDF variable.")
                file[name].dims[axis].attach_scale(file[scale])
        file.attrs.update({"format": "flexarm-superelement/1"} if attrs is None else attrs)
    return path


def test_the_contracts_variables_alone_are_enough(part, tmp_path):
    again = SuperElement.load(write(tmp_path / "foreign.nc", part))
    assert again.name == "foreign"
    assert np.array_equal(again.stiffness, part.stiffness)


def test_single_precision_is_read(part, tmp_path):
    single = {
        name: getattr(part, name).astype("f4") for name in ("stiffness", "mass", "damping", "inertia_load")
    }
    again = SuperElement.load(write(tmp_path / "single.nc", part, **single))
    assert again.stiffness == approx(part.stiffness, rel=1e-6, abs=1)


def test_fixed_length_names_are_read(part, tmp_path):
    names = np.array([b"foot", b"hand", b"ear"])
    again = SuperElement.load(write(tmp_path / "bytes.nc", part, interface_name=names))
    assert again.interfaces == ("foot", "hand", "ear")


@pytest.mark.filterwarnings("ignore:Duplicate dimension")
def test_classic_netcdf_is_read(part, tmp_path):
    from flexarm.superelement.netcdf import contents

    data = contents(part).dataset()
    data.to_netcdf(tmp_path / "classic.nc", engine="scipy", format="NETCDF3_64BIT")
    again = SuperElement.load(tmp_path / "classic.nc")
    assert again.interfaces == part.interfaces
    assert np.array_equal(again.mass, part.mass)


def test_a_missing_inertia_load_is_computed(part, tmp_path):
    again = SuperElement.load(write(tmp_path / "part.nc", part, drop=["inertia_load"]))
    assert again.inertia_load == approx(part.inertia_load)


def test_an_inertia_load_of_the_other_sign_is_doubted(part, tmp_path):
    again = SuperElement.load(write(tmp_path / "part.nc", part, inertia_load=-part.inertia_load))
    assert [doubt.where for doubt in again.check()] == ["inertia_load"]


@pytest.mark.parametrize("name", [name for name in VARIABLES if name != "inertia_load"])
def test_a_missing_variable_is_named(part, tmp_path, name):
    with pytest.raises(InvalidFile, match=rf"part\.nc: {name}: is missing"):
        SuperElement.load(write(tmp_path / "part.nc", part, drop=[name]))


def changed(values, at, value):
    values = np.array(values)
    values[at] = value
    return values


MALFORMED = {
    "wrong shape": lambda p: {"mass": p.mass[:-1]},
    "not square": lambda p: {"stiffness": p.stiffness[:, :-1]},
    "one mode too many": lambda p: {"frequency_hz": np.append(p.frequency_hz, 1.0)},
    "a flat position": lambda p: {"interface_position": p.positions.ravel()},
    "not symmetric": lambda p: {"stiffness": changed(p.stiffness, (2, 3), 1e5)},
    "not a number": lambda p: {"mass": changed(p.mass, (4, 4), np.nan)},
    "infinite": lambda p: {"damping": changed(p.damping, (4, 4), np.inf)},
    "text": lambda p: {"frequency_hz": np.array([b"a"] * p.n_modes)},
    "complex": lambda p: {"damping": p.damping.astype(complex)},
    "a name twice": lambda p: {"interface_name": np.array([b"foot", b"foot", b"ear"])},
    "no name": lambda p: {"interface_name": np.array([b"foot", b"", b"ear"])},
    "numbers for names": lambda p: {"interface_name": np.arange(3)},
    "not orthonormal": lambda p: {"interface_rotation": 1.01 * p.rotations},
    "left-handed": lambda p: {"interface_rotation": -p.rotations},
    "a negative mass": lambda p: {"mass": -p.mass},
    "a negative frequency": lambda p: {"frequency_hz": -p.frequency_hz},
    "a negative damping": lambda p: {"damping": -p.damping},
    "a grounded freedom": lambda p: {"stiffness": p.stiffness + changed(np.zeros((22, 22)), (7, 7), 1e6)},
    "positions of another part": lambda p: {"interface_position": p.positions[[1, 0, 2]]},
}


BLAMED = {"one mode too many": "stiffness", "positions of another part": "stiffness"}
"""Where another variable is blamed than the one that was changed: the two contradict each other."""


@pytest.mark.parametrize("case", MALFORMED)
def test_malformed_files_are_refused_with_the_variable(part, tmp_path, case):
    changes = MALFORMED[case](part)
    with pytest.raises(InvalidFile, match=r"part\.nc: [a-z_]+: ") as caught:
        SuperElement.load(write(tmp_path / "part.nc", part, **changes))
    blamed = [problem.where for problem in caught.value.problems]
    assert BLAMED.get(case, next(iter(changes))) in blamed


def test_a_grounded_freedom_is_named_and_no_other(part):
    spring = changed(np.zeros((22, 22)), (7, 7), 1e5)
    with pytest.raises(
        InvalidParameter, match=r"meets forces at interface 'hand', translation y \(0\.\d+\); allowed"
    ):
        part.replace(stiffness=part.stiffness + spring).check()


@pytest.mark.parametrize("attrs", [{}, {"format": "flexarm-superelement/2"}])
def test_another_format_is_refused(part, tmp_path, attrs):
    with pytest.raises(InvalidFile, match=r"format: the attribute must be 'flexarm-superelement/1', got"):
        SuperElement.load(write(tmp_path / "part.nc", part, attrs=attrs))


@pytest.mark.parametrize(
    "content", [b"", b"CDF\x01", b"CDF\x01\0\0\0\7garbage", b"\x89HDF\r\n\x1a\n", b"x = 1\n"]
)
def test_damaged_files_are_refused(tmp_path, content):
    path = tmp_path / "part.nc"
    path.write_bytes(content)
    with pytest.raises(InvalidFile, match=r"part\.nc: (file: cannot be read as NetCDF|format)"):
        SuperElement.load(path)


def test_a_truncated_file_is_refused(part, tmp_path):
    path = tmp_path / "part.nc"
    part.save(path)
    path.write_bytes(path.read_bytes()[:4000])
    with pytest.raises(InvalidFile, match=r"part\.nc: file: cannot be read as NetCDF"):
        SuperElement.load(path)


def test_an_absent_file_is_named(tmp_path):
    with pytest.raises(InvalidFile, match=r"absent\.nc: file: there is no such file"):
        SuperElement.load(tmp_path / "absent.nc")


def test_masses_lumped_in_a_point_are_doubted_for_their_density():
    """10 kg with a radius of gyration of 1 mm: nothing is so dense, and a model may say it all the same."""
    M = np.diag([10.0] * 3 + [1e-5] * 3)
    point = SuperElement("point", ("hub",), np.zeros((1, 3)), [np.eye(3)], 0 * M, M, 0 * M, [])
    assert [doubt.where for doubt in point.check()] == ["mass"]


def test_a_mechanism_is_refused_and_named(part):
    """Without resistance of hand to turning about an axis there is a seventh zero eigenvalue."""
    turn = np.zeros(part.n_dof)
    turn[9:12] = (0.6, 0.0, 0.8)
    K = part.stiffness - np.outer(part.stiffness @ turn, turn @ part.stiffness) / (
        turn @ part.stiffness @ turn
    )
    with pytest.raises(InvalidParameter, match="must resist all but the six rigid motions, got 1 more"):
        part.replace(stiffness=K).check()
