"""Claims about matrices of other programs: read rightly, or refused if stated wrongly."""

from itertools import permutations

import foreign_parts
import numpy as np
import pytest
from foreign_parts import (
    CORD2,
    CUBE,
    POINTS,
    foreign,
    freedoms_of,
    local_axes,
    matrix_input,
    user_element,
    write_cube,
    write_dmig,
    write_grids,
)
from parts import frame_mass, frame_part
from pytest import approx
from scipy.io import mmwrite
from scipy.sparse import coo_array

from flexarm import InvalidFile, InvalidParameter, SuperElement, accept_matrices
from flexarm.superelement.checks import implausible_values
from flexarm.superelement.foreign.matrix_market import read_matrix_market
from flexarm.superelement.foreign.order import read_order

FREEDOMS = freedoms_of(frame_part(n_modes=3))
ORDER = "11 7 23 101-103.0"


@pytest.fixture(scope="module")
def part() -> SuperElement:
    return frame_part(n_modes=3, damping=1e-5)


def same(found: SuperElement, part: SuperElement, rel=1e-6) -> bool:
    """The part again, its interfaces in the order of the file."""
    at = [found.interfaces.index(name) for name in part.interfaces]
    rows = np.concatenate([6 * i + np.arange(6) for i in at] + [18 + np.arange(part.n_modes)])
    assert found.positions[at] == approx(part.positions, abs=1e-9)
    for name in ("stiffness", "mass", "damping"):
        expected, values = getattr(part, name), getattr(found, name)[np.ix_(rows, rows)]
        along = np.sum(found.mass[rows[:18], 18:] * part.mass[:18, 18:], axis=0)  # modes have either sign
        sign = np.concatenate([np.ones(18), np.sign(along)])
        limit = rel * np.abs(expected).max()
        assert values * np.outer(sign, sign) == approx(expected, abs=limit, rel=rel), name
    assert found.frequency_hz == approx(part.frequency_hz, rel=rel)
    return True


def accept(tmp_path, part, *args, **kwargs):
    grids = write_grids(tmp_path / "part.bdf", part)
    return accept_matrices(*args, **{"grids": grids, "unit": "mm", "interfaces": POINTS, **kwargs})


@pytest.fixture
def market(tmp_path, part):
    return foreign_parts.market(tmp_path, part)


def test_matrix_market_with_a_stated_order(tmp_path, part, market):
    K, M, C = market
    found = accept(tmp_path, part, K, M, damping_matrix=C, order=ORDER, mass=frame_mass())
    assert same(found, part)
    rigid = np.vstack([np.tile(np.eye(6), 3).T, np.zeros((3, 6))])
    assert found.inertia_load == approx(found.mass @ rigid[:, :3])
    assert found.name == "stiffness"
    assert found.check() == []


@pytest.mark.parametrize("layout", ["coordinate", "array"])
@pytest.mark.parametrize("symmetry", ["general", "symmetric"])
def test_matrix_market_as_scipy_writes_it(tmp_path, layout, symmetry):
    matrix = np.random.default_rng(5).integers(-9, 9, (7, 7)) / 8
    matrix = matrix + matrix.T if symmetry == "symmetric" else matrix
    mmwrite(tmp_path / "a.mtx", coo_array(matrix) if layout == "coordinate" else matrix, symmetry=symmetry)
    (found,) = read_matrix_market(tmp_path / "a.mtx").matrices.values()
    assert layout in (tmp_path / "a.mtx").read_text().splitlines()[0]
    assert np.array_equal(found.matrix, matrix)


def test_interface_axes_are_those_of_the_points(tmp_path, part, market):
    found = accept(tmp_path, part, *market[:2], order=ORDER)
    for rotation, axes in zip(found.rotations, local_axes(part), strict=True):
        assert rotation == approx(axes, abs=1e-9)


def test_the_order_may_stand_in_a_file(tmp_path, part, market):
    (tmp_path / "order.txt").write_text("11.123 11.456  # foot\n7,\n23 $ ear\n101-103.0\n")
    assert same(
        accept(tmp_path, part, *market[:2], damping_matrix=market[2], order=tmp_path / "order.txt"), part
    )


def test_without_an_order_nothing_is_guessed(tmp_path, part, market):
    with pytest.raises(InvalidFile, match=r"order: the file does not say which freedom a row is; state it"):
        accept(tmp_path, part, *market[:2])


@pytest.mark.parametrize("points", [p for p in permutations((11, 7, 23)) if p != (11, 7, 23)])
def test_every_wrong_order_of_points_is_refused(tmp_path, part, market, points):
    with pytest.raises(InvalidFile, match=r"stiffness\.mtx: stiffness: "):
        accept(tmp_path, part, *market[:2], order=f"{' '.join(map(str, points))} 101-103.0")


@pytest.mark.parametrize("i", range(21))
def test_every_swap_of_two_freedoms_is_refused(tmp_path, part, market, i):
    """All 210 exchanges of two rows but the three among the modes, whose names do not matter."""
    for j in range(i + 1, 21):
        words = [f"{p}.{c}" for p, c in FREEDOMS]
        words[i], words[j] = words[j], words[i]
        if i >= 18:
            found = accept(tmp_path, part, *market[:2], damping_matrix=market[2], order=" ".join(words))
            assert same(found, part)
            continue
        with pytest.raises(InvalidParameter, match=r"points must come in one sequence|stiffness: |mass: "):
            accept(tmp_path, part, *market[:2], order=" ".join(words))


def test_mechanics_finds_every_exchange_but_of_rotations_about_one_axis(part):
    """Those leave R as it is, and K R = 0; an order that makes them cannot be stated."""
    for i in range(18):
        for j in range(i + 1, 21):
            rows = np.arange(21)
            rows[[i, j]] = rows[[j, i]]
            at = np.ix_(rows, rows)
            other = part.replace(stiffness=part.stiffness[at], mass=part.mass[at], inertia_load=None)
            if j < 18 and i % 6 == j % 6 and i % 6 > 2:
                assert other.check() == []
                with pytest.raises(InvalidParameter, match="points must come in one sequence"):
                    read_order(" ".join("{}.{}".format(*FREEDOMS[k]) for k in rows))
            else:
                with pytest.raises(InvalidParameter):
                    other.check()


def test_points_at_one_place_are_doubted(tmp_path, part, market):
    """Of two of them no rigid motion tells which is which."""
    found = accept(tmp_path, part, *market[:2], order=ORDER)
    twins = found.replace(positions=np.repeat(found.positions[:1], 3, axis=0))
    assert "order" in [problem.where for problem in implausible_values(twins)]


@pytest.mark.parametrize("axes", [a for a in permutations("123") if a != ("1", "2", "3")])
def test_every_wrong_order_of_axes_is_refused(tmp_path, part, market, axes):
    turned = "".join(axes) + "".join(str(int(a) + 3) for a in axes)
    words = [f"{p}.{c}" for p in (11, 7, 23) for c in turned]
    with pytest.raises(InvalidFile, match=r"stiffness\.mtx: stiffness: "):
        accept(tmp_path, part, *market[:2], order=" ".join([*words, "101-103.0"]))


def test_rotations_first_are_refused(tmp_path, part, market):
    words = [f"{p}.{c}" for p in (11, 7, 23) for c in "456123"]
    with pytest.raises(InvalidFile, match=r"stiffness\.mtx: stiffness: "):
        accept(tmp_path, part, *market[:2], order=" ".join([*words, "101-103.0"]))


def test_stiffness_and_mass_in_different_orders_are_refused(tmp_path, part, market):
    """K is right, M is not: R^T M R is the inertia of no body."""
    p = np.concatenate([np.arange(6, 12), np.arange(6), np.arange(12, 21)])
    mmwrite(tmp_path / "other.mtx", coo_array(foreign(part, part.mass)[np.ix_(p, p)]), precision=10)
    with pytest.raises(InvalidFile, match=r"stiffness\.mtx: mass: "):
        accept(tmp_path, part, market[0], tmp_path / "other.mtx", order=ORDER)


def test_metres_for_millimetres_are_refused_by_their_density(tmp_path, part, market):
    with pytest.raises(
        InvalidFile, match=r"make .* kg/m3; allowed is .* The unit is not that of the matrices"
    ):
        accept(tmp_path, part, *market[:2], order=ORDER, unit="m")


def test_millimetres_for_metres_are_refused_by_their_density(tmp_path, part):
    for name in ("stiffness", "mass"):
        mmwrite(tmp_path / f"{name}.mtx", coo_array(getattr(part, name)))
    lines = [
        f"GRID,{n},,{','.join(f'{x:.9f}' for x in part.positions[i])}\n"
        for i, n in enumerate(POINTS.values())
    ]
    (tmp_path / "part.bdf").write_text("".join(lines))
    given = {"order": ORDER, "grids": tmp_path / "part.bdf", "interfaces": POINTS}
    K, M = tmp_path / "stiffness.mtx", tmp_path / "mass.mtx"
    assert same(accept_matrices(K, M, **given).replace(damping=part.damping), part)
    with pytest.raises(InvalidFile, match="The unit is not that of the matrices"):
        accept_matrices(K, M, **given, unit="mm")


def test_positions_in_another_unit_than_the_matrices_are_refused(tmp_path, part, market):
    grids = write_grids(tmp_path / "metres.bdf", part, unit=1.0)
    with pytest.raises(InvalidFile, match=r"stiffness\.mtx: stiffness: rigid motion"):
        accept(tmp_path, part, *market[:2], order=ORDER, grids=grids)


def test_forgotten_axes_are_refused(tmp_path, part, market):
    grids = write_grids(tmp_path / "part.bdf", part)
    grids.write_text(grids.read_text().replace(",2\n", ",0\n"))
    with pytest.raises(InvalidFile, match=r"stiffness\.mtx: stiffness: rigid motion"):
        accept_matrices(*market[:2], order=ORDER, grids=grids, unit="mm", interfaces=POINTS)


def test_a_stated_mass_is_compared(tmp_path, part, market):
    with pytest.raises(InvalidFile, match=r"mass: R\^T M R weighs 5\.920\d* kg, stated are 6 kg"):
        accept(tmp_path, part, *market[:2], order=ORDER, mass=6.0)


def test_masses_in_kilograms_beside_newtons_and_millimetres_are_refused_by_the_stated_mass(
    tmp_path, part, market
):
    """mm, kg, s, N is no consistent system; density alone, off by 1000, would let it pass."""
    mmwrite(tmp_path / "kg.mtx", coo_array(1e3 * foreign(part, part.mass)), precision=10)
    with pytest.raises(InvalidFile, match=r"mass: R\^T M R weighs 5920\.8\d* kg"):
        accept(tmp_path, part, market[0], tmp_path / "kg.mtx", order=ORDER, mass=frame_mass())


def test_a_grounded_freedom_is_named(tmp_path, part):
    K = part.stiffness.copy()
    K[9, 9] += 1e4  # rotation x of hand, in the part's axes
    for name, matrix in (("stiffness", K), ("mass", part.mass)):
        mmwrite(tmp_path / f"{name}.mtx", coo_array(foreign(part, matrix)), precision=10)
    files = tmp_path / "stiffness.mtx", tmp_path / "mass.mtx"
    with pytest.raises(
        InvalidFile, match=r"forces at interface 'hand', rotation x \(0\.\d+\); allowed is 1e-05"
    ):
        accept(tmp_path, part, *files, order=ORDER)


def test_an_order_of_another_length_is_refused(tmp_path, part, market):
    with pytest.raises(InvalidFile, match="has 21 rows, the stated order 20 freedoms"):
        accept(tmp_path, part, *market[:2], order="11 7 23 101-102.0")


@pytest.mark.parametrize(
    ("order", "told"),
    [
        ("11 7 23 foot", "'foot' is none of POINT"),
        ("11 7 11.3", "freedom 11.3 is listed twice"),
        ("", "lists no freedom"),
        ("11.7", "'11.7' is none of"),
        ("103-101.0", "'103-101.0' does not count upwards"),
    ],
)
def test_a_damaged_order_is_refused(tmp_path, part, market, order, told):
    with pytest.raises(InvalidParameter, match=told):
        accept(tmp_path, part, *market[:2], order=order)


def test_a_point_without_a_place_is_refused(tmp_path, part, market):
    with pytest.raises(
        InvalidFile, match="point 12 of the matrix is not among the 3 points of the grids' file"
    ):
        accept(tmp_path, part, *market[:2], order="12 7 23 101-103.0", interfaces={})


def test_points_without_a_name_are_named_after_their_number(tmp_path, part, market):
    found = accept(tmp_path, part, *market[:2], order=ORDER, interfaces={"hand": 7})
    assert found.interfaces == ("hand", "grid_11", "grid_23")


# Nastran


def test_dmig_names_its_freedoms_whatever_their_order(tmp_path, part):
    file = write_dmig(tmp_path / "part.pch", part)
    assert same(accept(tmp_path, part, file, mass=frame_mass()), part, rel=1e-5)


def test_dmig_takes_no_stated_order(tmp_path, part):
    file = write_dmig(tmp_path / "part.pch", part)
    with pytest.raises(InvalidFile, match="order: the file names its freedoms"):
        accept(tmp_path, part, file, order=ORDER)


def test_structural_damping_is_left_unread_and_said(tmp_path, part):
    file = write_dmig(tmp_path / "part.pch", part, names=("KAAX", "MAAX", "K4AAX"))
    found = accept(tmp_path, part, file)
    assert found.provenance["ignored"] == "K4AAX"
    assert not found.damping.any()


def test_several_candidates_ask_for_a_name(tmp_path, part):
    file = write_dmig(tmp_path / "part.pch", part, names=("KAAX", "MAAX", "K2GG"))
    with pytest.raises(
        InvalidFile, match="stiffness: must be told, several of KAAX, MAAX, K2GG begin with K"
    ):
        accept(tmp_path, part, file)
    assert accept(tmp_path, part, f"{file}:KAAX").mass_total == approx(frame_mass(), rel=1e-5)


def short(value, digits):
    """Nastran's real number without its E: 1.234+10."""
    mantissa, exponent = f"{value:.{digits}E}".split("E")
    return f"{mantissa}{int(exponent):+d}"


def dmig_text(name, values, form):
    """DMIG entries by hand: free fields, small fields with Nastran's short exponents, or large fields."""
    lines = [
        {"free": f"DMIG,{name},0,6,2,0,,,21", "small": f"DMIG    {name:8}0       6       2       0"}.get(
            form, ""
        )
    ]
    if form == "large":
        lines = [f"DMIG    {name:8}       0       6       2       0"]
    for j, (cp, cc) in enumerate(FREEDOMS):
        rows = [(FREEDOMS[i], values[i, j]) for i in range(j, 21) if abs(values[i, j]) > 1e-9]
        if form == "large":
            lines.append(f"DMIG*   {name:16}{cp:16d}{cc:16d}".replace(f"{name:16}", f"{name:<16}"))
            lines += [f"*       {p:16d}{c:16d}{v:16.9E}" for (p, c), v in rows]
        for (p, c), v in rows if form == "free" else ():
            lines.append(f"DMIG,{name},{cp},{cc},,{p},{c},{v:.9E}")
        for (p, c), v in rows if form == "small" else ():
            text = next(t for t in (short(v, digits) for digits in (3, 2)) if len(t) <= 8)
            lines.append(f"DMIG    {name:8}{cp:<8d}{cc:<8d}{'':8}{p:<8d}{c:<8d}{text:8}")
    return "\n".join(lines) + "\n"


@pytest.mark.parametrize(("form", "tolerance"), [("free", None), ("large", None), ("small", 1e-2)])
def test_dmig_in_all_field_formats(tmp_path, part, form, tolerance):
    """Small fields hold three or four digits, so that the tolerance must be stated."""
    text = "".join(
        dmig_text(n, foreign(part, getattr(part, m)), form)
        for n, m in (("KAAX", "stiffness"), ("MAAX", "mass"))
    )
    (tmp_path / "k.pch").write_text(text)
    found = accept(tmp_path, part, tmp_path / "k.pch", tolerance=tolerance)
    assert found.mass_total == approx(frame_mass(), rel=tolerance or 1e-6)
    assert found.frequency_hz == approx(part.frequency_hz, rel=tolerance or 1e-6)


def test_few_digits_are_refused_unless_their_tolerance_is_stated(tmp_path, part):
    text = "".join(
        dmig_text(n, foreign(part, getattr(part, m)), "small") for n, m in (("K", "stiffness"), ("M", "mass"))
    )
    (tmp_path / "k.pch").write_text(text)
    with pytest.raises(InvalidFile, match=r"k\.pch: stiffness: rigid motion must strain nothing"):
        accept(tmp_path, part, tmp_path / "k.pch")


@pytest.mark.parametrize("binary", [True, False])
def test_op4_with_a_stated_order(tmp_path, part, binary):
    from pyyeti.nastran import op4

    values = [foreign(part, getattr(part, n)) for n in ("stiffness", "mass", "damping")]
    op4.write(str(tmp_path / "part.op4"), ["kaax", "maax", "baax"], values, binary=binary)
    found = accept(tmp_path, part, tmp_path / "part.op4", order=ORDER, mass=frame_mass())
    assert same(found, part)


def test_a_missing_reader_says_how_to_install_it(tmp_path, part, monkeypatch):
    import importlib

    file = write_dmig(tmp_path / "part.pch", part)
    real = importlib.import_module

    def absent(name, *args):
        if name.startswith("pyyeti"):
            raise ImportError(name)
        return real(name, *args)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(InvalidParameter, match=r"part\.pch needs pyyeti.*pip install flexarm\[nastran\]"):
        accept(tmp_path, part, file)


@pytest.mark.parametrize("name", ["part.pch", "part.op4", "part.mtx", "part.sti", "part.txt"])
@pytest.mark.parametrize(
    "content", [b"", b"nonsense\n", b"\x00\xff\x80" * 50, b"DMIG,K,0\n", b"%%MatrixMarket\n1\n"]
)
def test_damaged_matrices_are_refused(tmp_path, part, name, content):
    (tmp_path / name).write_bytes(content)
    (tmp_path / "part.dof").write_text("1.1\n")
    with pytest.raises(InvalidFile, match=rf"{name}: "):
        accept(tmp_path, part, tmp_path / name, order=None if name in ("part.sti", "part.pch") else ORDER)


# Abaqus and CalculiX


@pytest.mark.parametrize("per_freedom", [False, True])
def test_user_elements_of_abaqus_and_calculix(tmp_path, per_freedom):
    part = frame_part(n_modes=0)
    (tmp_path / "sub.mtx").write_text(user_element(part, per_freedom))
    found = accept(tmp_path, part, tmp_path / "sub.mtx", mass=frame_mass())
    assert same(found, part)


def test_tables_after_the_matrices_are_left_alone(tmp_path):
    part = frame_part(n_modes=0)
    (tmp_path / "sub.mtx").write_text(
        user_element(part) + "** SUBSTRUCTURE RECOVERY VECTORS\n1.0, 2.0, 3.0,\n"
    )
    assert same(accept(tmp_path, part, tmp_path / "sub.mtx"), part)


def test_a_user_element_without_mass_asks_for_it(tmp_path):
    part = frame_part(n_modes=0)
    (tmp_path / "sub.mtx").write_text(user_element(part).split("*MATRIX,TYPE=MASS")[0])
    with pytest.raises(InvalidFile, match=r"mass: holds no mass matrix .* --mass-matrix FILE"):
        accept(tmp_path, part, tmp_path / "sub.mtx")


def test_a_user_element_cut_short_is_refused(tmp_path):
    part = frame_part(n_modes=0)
    (tmp_path / "sub.mtx").write_text(user_element(part)[:-30])
    with pytest.raises(InvalidFile, match=r"mass: 18 freedoms need 171 numbers in a triangle, got 170"):
        accept(tmp_path, part, tmp_path / "sub.mtx")


@pytest.mark.parametrize("separator", [", ", "  "])
def test_matrix_input_of_abaqus_and_calculix(tmp_path, separator):
    part = frame_part(n_modes=0)
    for name in ("stiffness", "mass"):
        text = matrix_input(part, getattr(part, name), separator)
        (tmp_path / f"{name}.mtx").write_text(text)
    found = accept(tmp_path, part, tmp_path / "stiffness.mtx", tmp_path / "mass.mtx")
    assert same(found, part)


def test_stored_matrices_of_calculix_tied_to_interfaces(tmp_path):
    """A cube of springs with three freedoms a corner: its faces, tied, make two interfaces."""
    K = write_cube(tmp_path)
    ends = {"left": [1, 2, 3, 4], "right": [5, 6, 7, 8]}
    part = accept_matrices(
        tmp_path / "cube.sti", grids=tmp_path / "cube.inp", unit="mm", interfaces=ends, mass=2.7
    )
    assert part.positions == approx(np.array([[0, 0.05, 0.05], [0.1, 0.05, 0.05]]))
    assert part.centre == approx([0.05, 0.05, 0.05])
    along = np.diag([1.0, 0, 0])
    stretch = CUBE @ along / 100  # the right face moves 1 mm along x
    assert part.stiffness[6, 6] == approx(1e3 * stretch.ravel() @ K @ stretch.ravel())
    with pytest.raises(
        InvalidFile, match=r"point 8 has the components 1, 2, 3 only, an interface needs all six"
    ):
        accept_matrices(
            tmp_path / "cube.sti", grids=tmp_path / "cube.inp", unit="mm", interfaces={"l": range(1, 8)}
        )


# Points and their axes


def test_positions_and_axes_agree_with_pyyeti(tmp_path):
    """Another reader of the same bulk data: pyyeti's uset holds positions and axes of the grids."""
    from pyyeti.nastran import bulk

    from flexarm.superelement.foreign.grids import read_grids

    text = (
        CORD2
        + "CORD2S         3       2      1.     20.      3.      5.     90.     40.\n"
        + "             3.    200.      7.\n"
        + "GRID           1       3     10.     35.     50.       3\n"
        + "GRID           2       2     20.     75.    -15.       1\n"
        + "GRID*                  3               1    1.25000000+1       -3.0D+1\n"
        + "*                    4.5               2\n"
        + "GRID,4,,1.,2.,3.,3\n"
        + "CORD1R         9       1       2       3\n"
        + "GRID           5       9      1.      2.      3.       9\n"
    )
    (tmp_path / "part.bdf").write_text(text)
    (tmp_path / "known.bdf").write_text(text.split("CORD1R")[0])
    grids = read_grids(tmp_path / "part.bdf")
    uset = bulk.bulk2uset(str(tmp_path / "known.bdf"))[0]
    for number in (1, 2, 3, 4):
        rows = uset.loc[number]
        assert grids[number].position == approx(rows.iloc[0, 1:4].to_numpy(float), abs=1e-6)
    A, B, C = (grids[i].position for i in (1, 2, 3))
    z = (B - A) / np.linalg.norm(B - A)
    y = np.cross(z, C - A) / np.linalg.norm(np.cross(z, C - A))
    assert grids[5].axes == approx(np.column_stack([np.cross(y, z), y, z]), abs=1e-9)
    assert grids[5].position == approx(A + grids[5].axes @ [1, 2, 3])


def test_axes_of_curvilinear_systems_point_where_the_coordinates_grow(tmp_path):
    """Differences of positions over small steps of r, theta, phi or z."""
    from flexarm.superelement.foreign.grids import read_grids

    system = CORD2 + "CORD2S,3,1,1.,2.,3.,5.,9.,4.,\n,3.,20.,7.\n"
    for cs, start in ((2, [10.0, 35.0, -4.0]), (3, [10.0, 35.0, 50.0])):
        steps = [start, *(np.add(start, 1e-4 * e) for e in np.eye(3))]
        cards = "".join(
            f"GRID,{i},{cs},{x:.6f},{y:.6f},{z:.6f},{cs}\n" for i, (x, y, z) in enumerate(steps, 1)
        )
        (tmp_path / "part.bdf").write_text(system + cards)
        grids = read_grids(tmp_path / "part.bdf")
        for k in range(3):
            moved = grids[k + 2].position - grids[1].position
            assert grids[1].axes[:, k] == approx(moved / np.linalg.norm(moved), abs=2e-5)


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("GRID,1,7,0.,0.,0.\n", "line 1, GRID: is in coordinate system 7, which is not in the file"),
        (
            "CORD2R,1,1,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,1,0.,0.,0.\n",
            "coordinate system 1 is defined by itself",
        ),
        ("CORD2R,1,0,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\nGRID,1,1,0.,0.,0.\n", "its three points lie on one line"),
        ("GRID,one,,0.,0.,0.\n", "line 1, GRID: field 2 must be a whole number, got 'one'"),
        ("GRID,1,,0.,x,0.\n", "line 1, GRID: field 5 must be a number, got 'x'"),
        ("SPOINT,1\n", "holds no GRID entry"),
        ("*NODE\n1, 2, x, 3\n", r"line 2, \*NODE: must be numbers, got 2, x, 3"),
        ("*NODE\n1, 2, 3, 3\n*TRANSFORM, NSET=A\n", "turned freedoms are not read"),
    ],
)
def test_damaged_grids_are_refused(tmp_path, text, told):
    from flexarm.superelement.foreign.grids import read_grids

    (tmp_path / "part.bdf").write_text(text)
    with pytest.raises(InvalidFile, match=told):
        read_grids(tmp_path / "part.bdf")
