"""Solid finite elements of the core as Python sees them; their mechanics is tested in cpp/tests/solids."""

import numpy as np
import pytest
import scipy.sparse

from flexarm import _core
from flexarm.errors import InvalidParameter

STEEL = _core.SolidMaterial(youngs_modulus=210e9, poisson_ratio=0.3, density=7850)
CUBE = (
    np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]]) * 0.1
)


def cube(points: np.ndarray = CUBE) -> _core.SolidMesh:
    block = _core.CellBlock(_core.CellType.hex8, np.arange(8)[None, :], np.array([0]))
    return _core.SolidMesh(points, [block], [STEEL])


@pytest.mark.parametrize("lumped", [False, True])
def test_matrices_are_lower_triangles_in_sorted_compressed_columns(lumped: bool) -> None:
    for matrix in _core.assemble_solids(cube(), lumped=lumped):
        assert scipy.sparse.isspmatrix_csc(matrix)
        assert matrix.shape == (24, 24)
        assert matrix.indices.dtype == matrix.indptr.dtype == np.int32
        assert matrix.has_sorted_indices
        assert scipy.sparse.triu(matrix, k=1).nnz == 0


def test_mass_of_a_cube_is_its_volume_times_density() -> None:
    _, M = _core.assemble_solids(cube(), lumped=True)
    mass, first_moment, inertia = _core.mass_properties(cube())
    assert M.diagonal()[0::3].sum() == pytest.approx(7.85, rel=1e-13)
    assert mass == pytest.approx(7.85, rel=1e-13)
    assert first_moment == pytest.approx(np.full(3, 7.85 * 0.05), rel=1e-13)
    assert np.diag(inertia) == pytest.approx(np.full(3, 7.85 * 0.1**2 * 2 / 3), rel=1e-13)


def test_stretched_cube_has_its_stress_at_every_point() -> None:
    stretch = np.diag([1e-3, -0.3e-3, -0.3e-3])
    expected = np.tile([210e6, 0, 0, 0, 0, 0], (8, 1))
    assert _core.stresses(cube(), CUBE @ stretch) == pytest.approx(expected, abs=210e6 * 1e-12)
    assert _core.von_mises(cube(), CUBE @ stretch) == pytest.approx(np.full(8, 210e6), rel=1e-12)


def test_flattened_and_mirrored_cells_show_in_their_jacobians_and_are_refused() -> None:
    assert _core.smallest_jacobians(cube())[0] == pytest.approx([1.0])
    assert _core.smallest_jacobians(cube(CUBE * [1, 1, -1]))[0] == pytest.approx([-1.0])
    with pytest.raises(InvalidParameter, match=r"block 0 \(hex8\), cell 0 is inverted or flat"):
        _core.assemble_solids(cube(CUBE * [1, 1, 0]))


def test_wrong_indices_are_refused_by_block_and_cell() -> None:
    block = _core.CellBlock(_core.CellType.tet4, [[0, 1, 2, 8]], [0])
    with pytest.raises(InvalidParameter, match=r"block 0 \(tet4\), cell 0: node 8 is none of the 8 points"):
        _core.SolidMesh(CUBE, [block], [STEEL])
