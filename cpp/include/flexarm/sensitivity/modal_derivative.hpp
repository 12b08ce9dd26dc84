/// @file
/// Derivatives of natural frequencies with respect to parameters.
///
/// For a mode (K − ω² M) x + Φ_qᵀ μ = 0, Φ_q x = 0 with xᵀ M x = 1 of an arm about its equilibrium,
///
///     dω²/dp = xᵀ (dK − ω² dM) x + 2 μᵀ dΦ_q x                                                      (1)
///
/// where dK, dM and dΦ_q are total: the equilibrium, and with it the geometric stiffness, moves with the
/// parameter. Modes of one frequency (within 1e-6) have as derivatives the eigenvalues of (1) as a form on
/// their space, in rising order. Source: [Fox1968].
#pragma once

#include "flexarm/sensitivity/sensitivity.hpp"

namespace flexarm::sensitivity {

using assembly::System;
using Eigen::MatrixXd;
using simulation::Equilibrium;
using simulation::Variation;

/// df/dp of the `count` lowest modes: (mode, parameter) [Hz per unit].
/// @throws NotConverged, InvalidParameter
MatrixXd frequency_derivatives(const System& system, const Equilibrium& equilibrium, int count,
                               const std::vector<Variation>& variations);

}  // namespace flexarm::sensitivity
