/// @file
/// Mass of a part and its moments about the origin,
///
///     m = ∫ ρ dV,   S = ∫ ρ x dV,   I = ∫ ρ (|x|² 1 − x xᵀ) dV                                          (1)
///
/// by the rule of the mass matrix. The shape functions hold every rigid motion R, so (1) is what Rᵀ M R of
/// the consistent mass contains, to rounding, also in curved cells.
#pragma once

#include <Eigen/Core>

#include "flexarm/solids/mesh.hpp"

namespace flexarm::solids {

struct MassProperties {
  double mass = 0;                                         // [kg]
  Eigen::Vector3d first_moment = Eigen::Vector3d::Zero();  // [kg m]
  Eigen::Matrix3d inertia = Eigen::Matrix3d::Zero();       // about the origin [kg m²]
};

/// @throws InvalidParameter that names the cell if one is inverted or flat.
MassProperties mass_properties(const SolidMesh& mesh);

}  // namespace flexarm::solids
