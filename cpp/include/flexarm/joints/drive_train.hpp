/// @file
/// What stands between a motor and the link it moves.
///
///     motor  ── φ ──[ transmission ]── ψ ──[ stage 1 ]── … ──[ stage n ]── θ ──  link
///
/// φ is the motor's angle over the gear ratio (output-referred), ψ what the teeth make of it, θ the angle of
/// the link; all count every turn and are never wrapped. Without a transmission ψ = φ. Each stage holds laws
/// in parallel that act on the deflection across it; stages are in series with a massless coordinate between
/// two of them; without stages θ = ψ. Motor laws act on φ, bearing laws on θ, against the housing. The rotor
/// adds the inertia  ratio² J  to φ. On a prismatic joint read m for rad and N for N m.
#pragma once

#include <optional>
#include <vector>

#include "flexarm/joints/joint_law.hpp"
#include "flexarm/joints/transmission.hpp"

namespace flexarm::joints {

struct DriveTrain {
  using Parallel = std::vector<JointLaw>;

  double gear_ratio = 1;     ///< motor angle over link angle [-]
  double rotor_inertia = 0;  ///< J, at the motor's shaft [kg m²]
  /// From φ to ψ; its `multiple` counts turns of the motor here, at this ratio or at that of the gear whose
  /// output this joint is. An ideal one may be there too, so that models to be compared have one structure.
  std::optional<Transmission> transmission;
  std::vector<Parallel> stages;  ///< in series from motor to link
  Parallel motor;                ///< on φ
  Parallel bearing;              ///< on θ

  /// Rotor inertia seen from the output, ratio² J.
  double reflected_inertia() const { return gear_ratio * gear_ratio * rotor_inertia; }
};

}  // namespace flexarm::joints
