"""Reduced parts against a second code (ARPACK, SuperLU), beam theory and the user's interruption."""

import os
import signal

import numpy as np
import pytest
from scipy.sparse import csc_array, tril
from scipy.sparse.linalg import LinearOperator, eigsh, splu

import flexarm
from flexarm import _core
from flexarm.errors import InvalidParameter

STEEL = (210e9, 0.3, 7850.0)
RIGID, AVERAGE = _core.InterfaceKind.rigid, _core.InterfaceKind.average


def hexahedra(points, order=1):
    """Points of a grid (n_x, n_y, n_z, 3) as cells of 8 nodes, or of 20 where `order` is 2."""
    index = np.arange(points[..., 0].size).reshape(points.shape[:3])
    n = np.array(points.shape[:3])
    corner = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    edge = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
    local = [tuple(order * np.array(c)) for c in corner]
    if order == 2:
        local += [tuple(np.array(corner[a]) + corner[b]) for a, b in edge]
    cells = [
        [index[tuple(np.array(start) + c)] for c in local]
        for start in np.ndindex(*((n - 1) // order))
        for start in [order * np.array(start)]
    ]
    return np.array(cells, dtype=np.int32)


def assembled(points, cells, kind):
    block = _core.CellBlock(kind, cells, np.zeros(len(cells), dtype=np.int32))
    mesh = _core.SolidMesh(points, [block], [_core.SolidMaterial(*STEEL)])
    return _core.assemble_solids(mesh)


def interface(name, position, points, kind=RIGID):
    return _core.Interface(name, np.asarray(position, float), np.eye(3), np.asarray(points, np.int32), kind)


@pytest.fixture(scope="module")
def ring():
    """Ring of radii 0.1 and 0.2 m, 0.1 m high, of 4 x 24 x 5 hexahedra; its two faces as point sets."""
    n_r, n_t, n_z = 4, 24, 5
    r, t, z = np.linspace(0.1, 0.2, n_r + 1), 2 * np.pi * np.arange(n_t) / n_t, np.linspace(0, 0.1, n_z + 1)
    R, T, Z = np.meshgrid(r, t, z, indexing="ij")
    points = np.stack([R * np.cos(T), R * np.sin(T), Z], axis=-1).reshape(-1, 3)
    index = np.arange(R.size).reshape(R.shape)
    ahead = np.roll(index, -1, axis=1)
    low, high = slice(None, -1), slice(1, None)
    corners = [index[low, :, low], index[high, :, low], ahead[high, :, low], ahead[low, :, low]]
    corners += [index[low, :, high], index[high, :, high], ahead[high, :, high], ahead[low, :, high]]
    cells = np.stack(corners, axis=-1).reshape(-1, 8).astype(np.int32)
    K, M = assembled(points, cells, _core.CellType.hex8)
    return points, K, M, index[:, :, 0].ravel(), index[:, :, -1].ravel()


def reduced_ring(ring, kind=RIGID, **options):
    points, K, M, bottom, top = ring
    faces = [interface("bottom", (0, 0, 0), bottom), interface("top", (0, 0, 0.1), top, kind)]
    return _core.reduce_part(K, M, points, faces, **options)


def whole(lower):
    return csc_array(lower + tril(lower, -1).T)


def test_modes_of_a_ring_are_those_of_arpack(ring):
    """Nearly all come in pairs, by symmetry; ARPACK with a factor of SuperLU is the second code."""
    _, K, M, bottom, top = ring
    part = reduced_ring(ring, modes=20)
    held = np.concatenate([bottom, top])
    free = np.setdiff1d(np.arange(K.shape[0]), (3 * held[:, None] + np.arange(3)).ravel())
    K, M = whole(K)[free][:, free], whole(M)[free][:, free]
    inverse = LinearOperator(K.shape, splu(K, permc_spec="MMD_AT_PLUS_A").solve)
    values = np.sort(eigsh(K, k=21, M=M, sigma=0, OPinv=inverse, return_eigenvectors=False))
    expected = np.sqrt(values) / (2 * np.pi)
    assert part.frequency_hz == pytest.approx(expected[:20], rel=1e-9)
    assert part.quality.left_out_frequency_hz == pytest.approx(expected[20], rel=1e-2)
    assert np.sum(np.diff(part.frequency_hz) < 1e-6 * part.frequency_hz[1:]) >= 6  # pairs indeed


def test_a_ring_between_an_average_and_a_rigid_face_weighs_what_its_mesh_weighs(ring):
    points, _, M, *_ = ring
    part = reduced_ring(ring, kind=AVERAGE, modes=4)
    x = np.tile([1.0, 0, 0], len(points))
    assert part.quality.mass == pytest.approx(x @ (whole(M) @ x), rel=1e-12)
    assert part.quality.centre == pytest.approx([0, 0, 0.05], abs=1e-12)
    assert part.inertia_load[[0, 6], 0].sum() == pytest.approx(part.quality.mass, rel=1e-12)


def test_a_slender_block_reduces_to_the_stiffness_of_a_beam():
    """EA/L, 12 EI/(L³ (1 + Φ)), EI/L ... of a square bar, L/h = 20, its end faces rigid.

    Within 2 %: rigid faces keep the ends from contracting and warping, over a length of about h.
    """
    length, h, E, nu = 2.0, 0.1, STEEL[0], STEEL[1]
    grid = [np.linspace(0, length, 41), np.linspace(-h / 2, h / 2, 5), np.linspace(-h / 2, h / 2, 5)]
    points = np.stack(np.meshgrid(*grid, indexing="ij"), axis=-1)
    flat = points.reshape(-1, 3)
    cells = hexahedra(points, order=2)
    used = np.unique(cells)
    K, M = assembled(flat[used], np.searchsorted(used, cells).astype(np.int32), _core.CellType.hex20)
    ends = [np.flatnonzero(flat[used][:, 0] == x) for x in (0.0, length)]
    faces = [interface("a", (0, 0, 0), ends[0]), interface("b", (length, 0, 0), ends[1])]
    stiffness = _core.reduce_part(K, M, flat[used], faces).stiffness[6:, 6:]
    area, second = h**2, h**4 / 12
    phi = 12 * E * second / (E / (2 * (1 + nu)) * 5 / 6 * area * length**2)
    bending = E * second / (length**3 * (1 + phi))
    torsion = 0.1406 * h**4 * E / (2 * (1 + nu)) / length  # St. Venant's constant of the square
    assert stiffness[0, 0] == pytest.approx(E * area / length, rel=0.02)
    assert stiffness[1, 1] == pytest.approx(12 * bending, rel=0.02)
    assert stiffness[2, 4] == pytest.approx(6 * length * bending, rel=0.02)
    assert stiffness[5, 5] == pytest.approx((4 + phi) * length**2 * bending, rel=0.02)
    assert stiffness[3, 3] == pytest.approx(torsion, rel=0.05)


def test_recovery_and_matrices_belong_together(ring):
    _, K, M, *_ = ring
    part = reduced_ring(ring, modes=5)
    T = part.recovery
    assert part.mass == pytest.approx(T.T @ (whole(M) @ T), abs=1e-9 * np.abs(part.mass).max())
    assert part.stiffness == pytest.approx(T.T @ (whole(K) @ T), abs=1e-9 * np.abs(part.stiffness).max())


def test_the_upper_triangle_is_refused_and_split_entries_are_summed(ring):
    points, K, M, bottom, top = ring
    faces = [interface("bottom", (0, 0, 0), bottom), interface("top", (0, 0, 0.1), top)]
    with pytest.raises(InvalidParameter, match="stiffness matrix: only its lower triangle"):
        _core.reduce_part(whole(K), M, points, faces)
    coo = K.tocoo()
    halves = (np.tile(coo.data / 2, 2), (np.tile(coo.row, 2), np.tile(coo.col, 2)))
    split = _core.reduce_part(coo.__class__(halves, shape=K.shape), M, points, faces)
    once = _core.reduce_part(K, M, points, faces)
    assert split.stiffness == pytest.approx(once.stiffness, rel=1e-9)


def test_what_progress_raises_ends_the_reduction(ring):
    class StoppedError(Exception):
        pass

    def stop(phase, done):
        assert 0 <= done <= 1
        if phase == "modes":
            raise StoppedError

    with pytest.raises(StoppedError):
        reduced_ring(ring, modes=5, progress=stop)


def test_the_interrupt_key_ends_the_reduction(ring):
    """Ctrl-C is a signal; it is looked for whenever progress is told."""
    heard = []

    def press(phase, done):
        heard.append(phase)
        if phase == "interfaces":
            os.kill(os.getpid(), signal.SIGINT)

    with pytest.raises(KeyboardInterrupt):
        reduced_ring(ring, modes=5, progress=press)
    assert heard[-1] in ("interfaces", "modes")


def test_statistics_tell_which_path_ran(ring):
    part = reduced_ring(ring, modes=5)
    factor = part.statistics.factor
    assert factor.blas == flexarm.config()["BLAS"]
    assert factor.backend == "supernodal"
    assert factor.entries == min(e for e in (factor.entries_amd, factor.entries_metis) if e)
    assert part.statistics.n_inner == part.statistics.n_freedoms - 3 * 2 * 24 * 5
