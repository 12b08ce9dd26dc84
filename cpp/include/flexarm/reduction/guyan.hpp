/// @file
/// Static condensation to the interfaces (Guyan): the shapes of the part when one interface freedom is
/// displaced by one and the others are held,
///
///     u = B q_r on rigid interfaces,  W u = q_a on average ones,  K u = 0 elsewhere                   (1)
///     K̂ = Ψᵀ K Ψ,   M̂ = Ψᵀ M Ψ                                                                      (2)
///     Ψ R̂ = R                                                                                        (3)
///
/// A rigid motion R̂ of the interfaces moves the whole part rigidly; (3) is restored to the last digit after
/// the solution, so that mass, first moment and inertia survive (2) exactly, and K̂ R̂ = 0. Source:
/// [Guyan1965].
#pragma once

#include "flexarm/reduction/fixed_interface.hpp"

namespace flexarm::reduction {

/// Ψ (freedoms of the part, six an interface).
Eigen::MatrixXd constraint_modes(const linear_solvers::LowerTriangle& K, const FixedInterface& part,
                                 const Coordinates& coordinates, const std::vector<Interface>& interfaces,
                                 const InterfaceMaps& maps, const Support& support);

/// K̂ of (2), symmetric and with K̂ R̂ = 0 to rounding: P K̂ P, P = 1 − Q Qᵀ, Q an orthonormal basis of R̂ in
/// freedoms of equal unit (rotations times the part's size).
struct InterfaceStiffness {
  Eigen::MatrixXd matrix;
  double correction;  ///< largest change by P, in parts of the largest entry
};
InterfaceStiffness interface_stiffness(const linear_solvers::LowerTriangle& K, const Eigen::MatrixXd& Psi,
                                       const std::vector<Interface>& interfaces, const Support& support);

}  // namespace flexarm::reduction
