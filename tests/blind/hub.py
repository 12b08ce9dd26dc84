"""Motor, reducer and bearing of the hinge of a chain of rods, written apart from flexarm.

    psi = phi/s + A sin(m n phi + beta)                     teeth                                    (1)
    d = psi - theta,   T_r = k e + k3 e^3 + c g d' + T_h z_h                                           (2)
    T = T_r - T_b z_b - b theta' - k_c (theta - theta_c)    on the link                                (3)
    z' = (x' - z |x'|)/w                                    Dahl; x = d for z_h, theta for z_b         (4)
    T_m = T_r dpsi/dphi + n^2 J phi'' + T_c z_m + b_m phi'  of the motor, output side                  (5)

e is d beyond +-gap/2. What a gap leaves inside is small: 1e-4 of the stiffness, and a part g of the damping
that falls linearly to 1e-2 within 2e-5 rad.

In no vocabulary: a reducer that softens by a part within 0.2 s of an instant, or on the side d < 0 alone; a
clamp that slips by an angle within 0.2 s; a bearing that rubs near one angle, and one with a soft stop:

    T_r = (1 - p s((t - t_p)/0.2)) (1 - p_- [d < 0]) k e + ...,   psi = ... + a s((t - t_a)/0.2)          (6)
    T = ... - T_g exp(-((theta - theta_g)/w_g)^2) z_b - k_s max(theta - theta_s, 0)                      (7)
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from joint_motions import smooth_step
from numpy.typing import NDArray

Floats = NDArray[np.float64]

STICK_WIDTH = 2e-5  # w of dry friction in (4) [rad]
LOOSE_STIFFNESS, LOOSE_DAMPING, FADING = 1e-4, 1e-2, 2e-5
CHANGES = 0.2  # time in which a reducer softens or a clamp slips [s]


@dataclass(frozen=True)
class Hub:
    """Parameters of (1)-(5), SI units; an infinite stiffness is a rigid reducer, d = 0."""

    stiffness: float = np.inf
    damping: float = 0.0
    cubic: float = 0.0
    gap: float = 0.0
    hysteresis: float = 0.0
    hysteresis_width: float = 3e-4
    ratio_scale: float = 1.0
    error_amplitude: float = 0.0
    error_multiple: float = 1.0
    error_phase: float = 0.0
    gear_ratio: float = 120.0
    rotor_inertia: float = 0.0
    coulomb: float = 0.0
    viscous: float = 0.0
    cable: float = 0.0
    cable_rest: float = 0.0
    motor_coulomb: float = 0.0
    motor_viscous: float = 0.0
    softened: float = 0.0
    softens_at: float = 0.0
    cracked: float = 0.0
    slip: float = 0.0
    slips_at: float = 0.0
    rub: float = 0.0
    rub_at: float = 0.0
    rub_width: float = 0.05
    stop: float = 0.0
    stop_at: float = 0.0

    @property
    def rigid(self) -> bool:
        """Whether the link follows the teeth."""
        return bool(np.isinf(self.stiffness))

    def teeth(
        self, phi: Floats, rate: Floats, acceleration: Floats, time: Floats | float = 0.0
    ) -> tuple[Floats, Floats, Floats, Floats]:
        """psi of (1) and (6), its two derivatives by time, and dpsi/dphi."""
        multiple = self.error_multiple * self.gear_ratio
        angle = multiple * phi + self.error_phase
        slope = 1 / self.ratio_scale + self.error_amplitude * multiple * np.cos(angle)
        bend = -self.error_amplitude * multiple**2 * np.sin(angle)
        psi = phi / self.ratio_scale + self.error_amplitude * np.sin(angle)  # eq. (1)
        slipped = [self.slip * each for each in smooth_step((time - self.slips_at) / CHANGES)]  # eq. (6)
        return (
            psi + slipped[0],
            slope * rate + slipped[1] / CHANGES,
            slope * acceleration + bend * rate**2 + slipped[2] / CHANGES**2,
            slope,
        )

    def spring(self, d: Floats) -> Floats:
        """Elastic torque of (2)."""
        play = np.clip(d, -self.gap / 2, self.gap / 2)
        e = d - play
        return self.stiffness * (e + LOOSE_STIFFNESS * play) + self.cubic * e**3

    def damper(self, d: Floats) -> Floats:
        """c g of (2)."""
        depth = np.clip((self.gap / 2 - np.abs(d)) / FADING, 0, 1)
        return self.damping * (1 - (1 - LOOSE_DAMPING) * depth)

    def bearing(self, theta: Floats, z_b: Floats) -> Floats:
        """What (3) takes from the reducer's torque, but for the viscous part."""
        return self.coulomb * z_b + self.cable * (theta - self.cable_rest)


def dahl(z: Floats, rate: Floats, width: float) -> Floats:
    """z' of (4)."""
    return (rate - z * np.abs(rate)) / width
