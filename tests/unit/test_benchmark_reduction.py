"""The benchmark of reductions compares codes that solve the same problem: what its table rests on."""

from pathlib import Path

import pytest
from pytest import approx

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"


@pytest.fixture
def benchmarks(monkeypatch):
    monkeypatch.syspath_prepend(str(BENCHMARKS))


def test_flexarm_and_scipy_reduce_the_ring_alike(benchmarks, tmp_path):
    """A sparse LU with ARPACK is a second formulation; frequencies are squares of eigenvalues within 1e-7."""
    import agreement
    import reduce_flexarm
    import reduce_scipy
    import ring

    ring.write("3k", tmp_path / "part.npz")
    frequency, K, M = reduce_scipy.reduce(ring.Part(tmp_path / "part.npz"), skilled=True)
    part = ring.mesh("3k")
    reduced = reduce_flexarm.reduce(part, *reduce_flexarm.assemble(part, threads=1))
    assert reduced.frequency_hz == approx(frequency, rel=1e-7)
    assert agreement.difference(reduced.stiffness, K) < 1e-9
    assert agreement.difference(reduced.mass, M) < 1e-9
