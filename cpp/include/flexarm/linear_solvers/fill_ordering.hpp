/// @file
/// Fill-reducing ordering of a sparse symmetric pattern: METIS [Karypis1998] or AMD, whichever leaves fewer
/// entries in the factor, by CHOLMOD [Chen2008] where the build has it; Eigen's AMD otherwise. Both use
/// nothing of CHOLMOD but its LGPL parts.
#pragma once

#include <vector>

#include "flexarm/linear_solvers/lower_triangle.hpp"

namespace flexarm::linear_solvers {

struct FillOrdering {
  std::vector<int> order;    ///< order[k]: the column eliminated as k-th
  bool metis = false;        ///< by METIS, else by AMD
  double entries_amd = 0;    ///< of the factor in the ordering of AMD; 0 if unknown
  double entries_metis = 0;  ///< of the factor in that of METIS; 0 if there is none
};

FillOrdering fill_ordering(const LowerTriangle& pattern);

/// What the CHOLMOD at hand contains; both false where there is none.
bool has_metis();
bool has_gpl_parts();

}  // namespace flexarm::linear_solvers
