/// @file
/// A run together with the derivatives of all its recorded columns with respect to parameters.
///
/// The state's derivatives come from sensitivity.hpp. An output y(x; p) is then differentiated along them as
/// variation.hpp says, so that every column a Recorder knows has its derivative, and a parameter that an
/// output depends on directly (the place of a point) counts too.
#pragma once

#include "flexarm/simulation/sensitivity.hpp"
#include "flexarm/simulation/transient.hpp"

namespace flexarm::simulation {

struct DifferentiatedRun {
  Transient run;
  std::vector<Transient> derivatives;  ///< one a parameter: d(column)/dp; no energies
};

/// As simulate(); `initial` is the derivative of the equilibrium's state.
/// @throws NotConverged, InvalidParameter
DifferentiatedRun simulate(const System& system, const Equilibrium& equilibrium,
                           const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                           std::vector<Variation> variations, StateDerivative initial,
                           const Progress& progress = {});

}  // namespace flexarm::simulation
