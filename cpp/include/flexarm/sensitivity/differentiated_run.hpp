/// @file
/// A run together with the derivatives of all its recorded columns with respect to parameters.
///
/// The state's derivatives come from sensitivity.hpp, those of the columns from derivative_recorder.hpp:
/// every column a Recorder knows has its derivative, and a parameter that an output depends on directly (the
/// place of a point) counts too.
#pragma once

#include "flexarm/sensitivity/sensitivity.hpp"
#include "flexarm/simulation/transient.hpp"

namespace flexarm::sensitivity {

using assembly::System;
using simulation::Equilibrium;
using simulation::PiecewisePolynomial;
using simulation::Progress;
using simulation::StateDerivative;
using simulation::Transient;
using simulation::TransientOptions;
using simulation::Variation;

struct DifferentiatedRun {
  Transient run;
  /// d(column)/dp; no energies. Each row of a column is one row a parameter here, those of one row behind one
  /// another.
  Transient derivatives;
};

/// As simulate(); `initial` is the derivative of the equilibrium's state.
/// @throws NotConverged, InvalidParameter
DifferentiatedRun simulate(const System& system, const Equilibrium& equilibrium,
                           const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                           std::vector<Variation> variations, StateDerivative initial,
                           const Progress& progress = {});

}  // namespace flexarm::sensitivity
