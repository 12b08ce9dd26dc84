/// @file
/// What a gear or a reducer makes of the angle φ of its input, and the constraint that holds it to that:
///
///     ψ(φ) = φ/scale + A sin(m φ + β) − w(φ)                                                        (1)
///     Φ = ψ(s_in) − s_out = 0                                                                       (2)
///
/// The sine is a transmission error that returns m times a radian of φ, i.e. m/n times a turn of a motor
/// whose angle is n φ; w is a windup that a table gives. The multiplier λ of (2) is the torque that the
/// output receives; by virtual work the input feels ψ'(φ) λ. An ideal gear is the case A = 0. Units: A, β in
/// rad; SI.
#pragma once

#include <cmath>
#include <string>

#include "flexarm/errors.hpp"
#include "flexarm/joints/laws/monotone_cubic.hpp"

namespace flexarm::joints {

struct Transmission {
  double scale = 1;           ///< true ratio over nominal ratio; of a gear, its ratio [-]
  double amplitude = 0;       ///< A
  double multiple = 0;        ///< m [1/rad]
  double phase = 0;           ///< β
  MonotoneCubic windup = {};  ///< w

  bool operator==(const Transmission&) const = default;

  struct Value {
    double psi, first, second;  ///< ψ, ψ', ψ''
  };

  Value operator()(double phi) const {
    const double sine = amplitude * std::sin(multiple * phi + phase);
    const double cosine = amplitude * std::cos(multiple * phi + phase);
    const auto w = windup(phi);
    return {phi / scale + sine - w.y, 1 / scale + multiple * cosine - w.first,
            -multiple * multiple * sine - w.second};  // eq. (1)
  }

  /// φ where ψ(φ) is `psi`, by Newton's method inside the bracket that sine and table give.
  double inverse(double psi) const {
    const auto [least, most] = windup.range();
    const double reach = std::abs(scale) * (std::abs(amplitude) + std::max(std::abs(least), std::abs(most)));
    double low = scale * psi - reach, high = scale * psi + reach, phi = scale * psi;
    for (int k = 0; k < 100; ++k) {
      const Value at = (*this)(phi);
      const double step = (psi - at.psi) / at.first;
      (step > 0 ? low : high) = phi;
      const double next = phi + step < low || phi + step > high ? 0.5 * (low + high) : phi + step;
      if (std::abs(next - phi) <= 1e-15 * (std::abs(next) + reach)) return next;
      phi = next;
    }
    return phi;
  }

  /// The same with a multiple that counts turns of an input `ratio` times as fast.
  Transmission geared(double ratio) const { return {scale, amplitude, multiple * ratio, phase, windup}; }

  /// @throws InvalidParameter where (1) could not be followed backwards.
  void check() const {
    if (!std::isfinite(scale) || scale == 0) {
      throw InvalidParameter("scale of a gear ratio must not be zero, got " + std::to_string(scale));
    }
    const auto [least, most] = windup.slopes();
    const double steepest = std::max(std::abs(least), std::abs(most));
    const double swing = std::abs(scale * amplitude * multiple);
    if (swing < 1 && swing + std::abs(scale) * steepest >= 1) {
      throw InvalidParameter("windup that changes by " + std::to_string(steepest) +
                             " rad per radian of the motor's angle would turn the output back; with a "
                             "transmission error it must stay below 1");
    }
    if (!(swing < 1 && std::isfinite(phase))) {
      throw InvalidParameter("transmission error: an amplitude of " + std::to_string(amplitude) + " rad at " +
                             std::to_string(multiple) +
                             " per radian of the output would turn the output back while the motor goes on; "
                             "amplitude x multiple x gear ratio must stay below 1");
    }
  }
};

/// Equation (2) between two scalar coordinates.
struct GearConstraint {
  int input, output;
  Transmission transmission;

  bool operator==(const GearConstraint&) const = default;
};

}  // namespace flexarm::joints
