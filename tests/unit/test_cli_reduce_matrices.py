"""`flexarm reduce` of other programs' matrices and `flexarm check` of super-element files."""

import json
import sys

import numpy as np
import pytest
from parts import frame_mass, frame_part
from pytest import approx
from scipy.io import mmwrite
from scipy.sparse import coo_array

from flexarm import InvalidFile, SuperElement
from flexarm.cli.materials import read_materials
from flexarm.cli.run import run


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Stiffness, mass and points of a frame in SI units, in the directory where the command runs."""
    part = frame_part(n_modes=2)
    mmwrite(tmp_path / "K.mtx", coo_array(part.stiffness), symmetry="symmetric")
    mmwrite(tmp_path / "M.mtx", coo_array(part.mass), symmetry="symmetric")
    cards = (f"GRID,{i},,{x:.9f},{y:.9f},{z:.9f}\n" for i, (x, y, z) in enumerate(part.positions, 1))
    (tmp_path / "part.bdf").write_text("".join(cards))
    monkeypatch.chdir(tmp_path)
    return part


COMMAND = ["reduce", "K.mtx", "--mass-matrix", "M.mtx", "--grids", "part.bdf", "--order", "1, 2, 3, 9-10.0"]


def test_matrices_become_a_file_and_a_description(files, capsys):
    assert run([*COMMAND, "--interface", "foot=1", "--mass", "5.9208", "--out", "frame.nc"]) == 0
    told = capsys.readouterr()
    assert told.err == ""
    assert "super-element K: 20 degrees of freedom, 3 interfaces, 2 internal modes" in told.out
    assert f"mass     {frame_mass():.6g} kg" in told.out
    assert "interface foot at (0.1, -0.2, 0.05) m" in told.out
    assert told.out.endswith("written to frame.nc\n")
    element = SuperElement.load("frame.nc")
    assert element.interfaces == ("foot", "grid_2", "grid_3")
    assert element.stiffness == approx(files.stiffness, rel=1e-6, abs=1)
    assert len(element.provenance["stiffness_sha256"]) == 64


def test_json_is_one_object_with_mass_and_frequencies(files, capsys):
    assert run([*COMMAND, "--out", "frame.nc", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert told["file"] == "frame.nc"
    assert told["mass"] == approx(frame_mass())
    assert told["frequency_hz"] == approx(files.frequency_hz)
    assert told["rigid_body_error"] < 1e-9


def test_check_describes_a_super_element(files, capsys):
    run([*COMMAND, "--out", "frame.nc"])
    capsys.readouterr()
    assert run(["check", "frame.nc"]) == 0
    told = capsys.readouterr()
    assert "rigid motion strains it by" in told.out
    assert run(["check", "frame.nc", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert (told["kind"], told["problems"], told["warnings"]) == ("superelement", [], [])
    assert told["centre"] == approx(files.centre.tolist())


def test_check_refuses_a_file_that_is_no_super_element(tmp_path, capsys):
    (tmp_path / "part.nc").write_text("nothing")
    assert run(["check", str(tmp_path / "part.nc")]) == 2
    assert capsys.readouterr().err.startswith(
        f"error: {tmp_path / 'part.nc'}: file: cannot be read as NetCDF"
    )


def test_a_wrong_order_ends_with_exit_code_2_and_no_file(files, tmp_path, capsys):
    wrong = [word.replace("1, 2, 3", "1, 3, 2") for word in COMMAND]
    assert run([*wrong, "--out", "frame.nc"]) == 2
    last = capsys.readouterr().err.splitlines()[0]
    assert last.startswith("error: K.mtx: stiffness: rigid motion must strain nothing (K R = 0)")
    assert not list(tmp_path.glob("*.nc"))


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["K.mtx"], "error: K.mtx: --grids: is needed"),
        (COMMAND[1:6], "error: K.mtx: order: the file does not say"),
        ([*COMMAND[1:], "--mass", "6"], "error: K.mtx: mass: R^T M R weighs"),
        ([*COMMAND[1:], "--modes", "3"], "error: command line: --modes: is for meshes"),
        ([*COMMAND[1:], "--interface", "a=1,b"], "error: command line: --interface: must be NAME=POINT"),
        ([*COMMAND[1:], "--interface", "a=4"], "error: K.mtx: interface 'a': the matrix has no point 4"),
        ([*COMMAND[1:], "--interface", "a b=1"], "error: command line: --interface: 'a b': name"),
        ([*COMMAND[1:], "--interface", "1"], "error: command line: --interface: must be NAME=POINT"),
        ([*COMMAND[1:], "--unit", "inch"], "error: K.mtx: unit: 'inch' is not known for matrices"),
        (["absent.mtx", "--grids", "part.bdf"], "error: absent.mtx: file: there is no such file"),
        ([*COMMAND[1:5], "absent.bdf", *COMMAND[6:]], "error: absent.bdf: file: there is no such file"),
        (["part.inp", "--order", "1"], "error: command line: --order: is for matrices"),
    ],
)
def test_mistakes_end_with_exit_code_2_and_say_what_is_allowed(files, tmp_path, capsys, arguments, told):
    assert run(["reduce", *arguments, "--out", "frame.nc"]) == 2
    assert capsys.readouterr().err.splitlines()[-1].startswith(told)
    assert not list(tmp_path.glob("*.nc"))


def test_an_existing_file_is_refused_before_the_work(files, tmp_path, capsys):
    (tmp_path / "frame.nc").write_text("mine")
    assert run([*COMMAND, "--out", "frame.nc"]) == 2
    assert "frame.nc: output: exists already" in capsys.readouterr().err
    assert (tmp_path / "frame.nc").read_text() == "mine"
    assert run([*COMMAND, "--out", "frame.nc", "--force"]) == 0


def test_help_needs_neither_numpy_nor_a_terminal(capsys):
    """Examples of both uses stand in it."""
    import subprocess

    code = "import sys; from flexarm.cli.run import run; run(['reduce', '-h']); print('numpy' in sys.modules)"
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.endswith("False\n")
    assert "flexarm reduce hub.inp --unit mm --interface input=BORE" in told
    assert "flexarm reduce K.mtx --mass-matrix M.mtx --grids hub.bdf" in told


# --material


@pytest.mark.parametrize(
    ("text", "unit"),
    [
        ("E=210e9,nu=0.3,rho=7850", "m"),
        ("E=210e3,nu=0.3,rho=7.85e-9", "mm"),
        ("E=210GPa, nu=0.3, rho=7.85g/cm3", "mm"),
        ("E=210000N/mm2,nu=.3,rho=7850kg/m3", "m"),
        ("rho=7.85t/m3,E=210 GPa,nu=0.3", "in"),
    ],
)
def test_steel_in_several_units(text, unit):
    materials, notes = read_materials([text], unit)
    steel = materials[""]
    assert notes == []
    assert (steel.youngs_modulus, steel.poisson_ratio, steel.density) == approx((210e9, 0.3, 7850))


def test_si_beside_millimetres_is_taken_and_said():
    """7850 t/mm3 and 210e9 MPa are no solid."""
    materials, notes = read_materials(["rod:E=210e9,nu=0.3,rho=7850"], "mm")
    assert (materials["rod"].youngs_modulus, materials["rod"].density) == (210e9, 7850)
    assert "taken as Pa and kg/m3" in str(notes[0])


@pytest.mark.parametrize(
    ("texts", "told"),
    [
        (["E=210e9,nu=0.3"], "lacks rho"),
        (["E=210e9,nu=0.3,rho=7850,G=3"], "must be"),
        (["steel"], "must be"),
        (["E=210e9,nu=0.5,rho=7850"], "poisson_ratio"),
        (["E=-1,nu=0.3,rho=7850"], "youngs_modulus"),
        (["E=210psi,nu=0.3,rho=7850"], "unit 'psi'"),
        (["E=210e9,nu=0.3,rho=7.85e-9"], "no solid has"),
        (["E=1,nu=0,rho=1", "E=1,nu=0,rho=1"], "given twice"),
    ],
)
def test_materials_that_are_none_are_refused(texts, told):
    unit = "mm" if told == "no solid has" else "m"
    with pytest.raises(InvalidFile, match=rf"command line: --material: .*{told}"):
        read_materials(texts, unit)


# --picture


def test_a_picture_colours_the_faces_of_interfaces():
    """Of a ring of 24 segments, the inner face has as many coloured faces as the mesh has there."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import to_rgb

    from flexarm.solids import ring
    from flexarm.solids.shape import surface
    from flexarm.superelement.picture import COLOURS, _colours, picture

    mesh = ring(0.1, 0.2, 0.1, size=0.05, around=24, order=1)
    faces = surface(mesh)
    colours, loose = _colours(faces, {"bore": mesh.point_set("inner"), "dot": np.array([0])}, mesh.n_points)
    assert colours.count(COLOURS[0]) == 48
    assert list(loose["dot"]) == [0]
    assert not len(loose["bore"])
    frames = {"bore": (np.eye(3), np.zeros(3)), "dot": (np.eye(3), mesh.points[0])}
    figure = picture(mesh, {"bore": mesh.point_set("inner"), "dot": np.array([0])}, frames)
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    pixels = np.asarray(canvas.buffer_rgba())[..., :3] / 255
    hue = pixels @ np.linalg.pinv([to_rgb(COLOURS[0]), (1, 1, 1)])
    assert (np.abs(hue[..., 0] - 1) < 0.5).mean() > 0.002


def test_a_picture_of_an_unknown_kind_is_refused(tmp_path):
    from matplotlib.figure import Figure

    from flexarm.superelement.picture import save_picture

    with pytest.raises(InvalidFile, match=r"part\.abc: output: cannot be written"):
        save_picture(Figure(), tmp_path / "part.abc")
    assert not list(tmp_path.iterdir())
