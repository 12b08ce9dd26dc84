/// @file
/// Which BLAS the loaded libraries call: it decides how fast CHOLMOD factors, and no compiler knows it, since
/// the system may exchange it under a finished build.
#pragma once

#include <string>

namespace flexarm::solvers {

/// For instance "OpenBLAS 0.3.21 ..."; the file of the library where it does not tell its name; "none" where
/// the build calls no BLAS.
std::string loaded_blas();

}  // namespace flexarm::solvers
