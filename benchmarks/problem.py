"""The swing benchmark: a steel tube with a point mass at its tip, on a hinge with a spring, swung for 20 s.

The arm hangs at rest; its motor turns by

    q(t) = 1.2 sin(2 π 0.05 t) s(t/4),   s(x) = 10 x³ − 15 x⁴ + 6 x⁵ up to x = 1, then 1              (1)

and the result is the tip's offset from a rigid arm at that angle, normal to it. Only numpy is needed here:
both codes read this file, each in its own process.
"""

import numpy as np

# Tube of the paper; its area is the one that belongs to wall and second moment.
LENGTH, AREA, SECOND_MOMENT = 3.0, 5.82e-4, 2.37e-7  # m, m2, m4
YOUNGS_MODULUS, POISSON_RATIO, DENSITY = 210e9, 0.3, 7850.0  # Pa, -, kg/m3
SHEAR_FACTOR = 0.53
PAYLOAD, SPRING, GRAVITY = 14.1, 1e5, 9.81  # kg, N m/rad, m/s2

AMPLITUDE, FREQUENCY, RAMP, END = 1.2, 0.05, 4.0, 20.0  # rad, Hz, s, s

INSTANTS = (2.0, 5.0, 10.0, 15.0)
"""Where errors are taken [s]."""

CONVERGED = {
    "timoshenko": (-21.46624, -47.99204, 0.86707, 46.33846),
    "timoshenko without rotary inertia": (-21.46618, -47.99210, 0.86633, 46.34063),
    "euler-bernoulli": (-21.45680, -47.96946, 0.85701, 46.34499),
}
"""Offset at INSTANTS [mm], converged in space and time, within 2e-4 mm, for each theory of beams."""


def angle(t):
    """Motor angle over the ratio [rad], equation (1)."""
    x = np.clip(np.asarray(t, dtype=float) / RAMP, 0.0, 1.0)
    return AMPLITUDE * np.sin(2 * np.pi * FREQUENCY * t) * x**3 * (10 - 15 * x + 6 * x**2)


def offset(t, along, across):
    """Tip's offset from the rigid arm [mm], normal to it.

    Parameters
    ----------
    t : ndarray
        Instants [s].
    along, across : ndarray
        Tip coordinates down and towards growing angle [m].
    """
    q = angle(t)
    return 1e3 * (np.cos(q) * np.asarray(across) - np.sin(q) * np.asarray(along))


def offsets_at_instants(t, along, across):
    """Offsets [mm] at those INSTANTS that lie within the run; each must be an instant of the run."""
    t = np.asarray(t)
    rows = []
    for instant in (i for i in INSTANTS if i <= t[-1] + 1e-9):
        row = int(np.argmin(np.abs(t - instant)))
        if abs(t[row] - instant) > 1e-9:
            raise ValueError(f"{instant:g} s is no instant of the run; the nearest is {t[row]:.6g} s")
        rows.append(row)
    return offset(t[rows], np.asarray(along)[rows], np.asarray(across)[rows]).tolist()


def error(offsets, theory="timoshenko"):
    """Largest error at INSTANTS [mm] against the converged values of the same theory."""
    return float(np.max(np.abs(np.asarray(offsets) - CONVERGED[theory])))
