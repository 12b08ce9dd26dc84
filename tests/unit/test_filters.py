"""Claims about digital filters: they are those of `scipy.signal`, which takes long to import."""

import subprocess
import sys
from textwrap import dedent

import numpy as np
import pytest

from flexarm.filters import cubic_average, recursive_filter


@pytest.mark.parametrize("poles", [[1.0, -0.97], [2.0, -3.5, 1.6]])
def test_a_recursive_filter_is_that_of_scipy(poles):
    from scipy.signal import lfilter

    values = np.random.default_rng(1).normal(size=(300, 3))
    assert recursive_filter(values, np.array(poles)) == pytest.approx(lfilter([1.0], poles, values, axis=0))
    assert recursive_filter(values[:1], np.array(poles))[0] == pytest.approx(values[0] / poles[0])
    assert recursive_filter(values[:0, 0], np.array(poles)).shape == (0,)


def test_a_recursive_filter_of_no_columns_writes_nothing():
    """LAPACK wrote one number beyond them, and a process ended soon afterwards."""
    code = """
        import numpy
        from flexarm.filters import recursive_filter
        kept = [recursive_filter(numpy.zeros((38, 0)), numpy.array([1.0, -0.9])) for _ in range(2000)]
        print({each.shape for each in kept}, [numpy.ones(2).sum() for _ in range(100)].count(2.0))
    """
    told = subprocess.run([sys.executable, "-c", dedent(code)], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["{(38,", "0)}", "100"]


@pytest.mark.parametrize("count", [21, 200])
def test_an_average_of_cubics_is_that_of_savitzky_and_golay(count):
    from scipy.signal import savgol_filter

    values = np.random.default_rng(2).normal(size=(count, 2))
    assert cubic_average(values, 21) == pytest.approx(savgol_filter(values, 21, 3, axis=0), abs=1e-12)


def test_evidence_of_a_fit_imports_no_statistics():
    code = """
        import sys, numpy
        from flexarm.diagnosis.discrepancy import TimeDiscrepancy
        TimeDiscrepancy([slice(0, 500)], 1.0, 2.0, 5.0).whitened(numpy.ones((500, 2)))
        print("scipy.signal" in sys.modules or "scipy.stats" in sys.modules)
    """
    told = subprocess.run([sys.executable, "-c", dedent(code)], capture_output=True, text=True, check=True)
    assert told.stdout.split() == ["False"]
