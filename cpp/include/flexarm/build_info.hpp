/// @file
/// Versions, backends and licence of this build of the core.
#pragma once
#include <string>

namespace flexarm {

struct BuildInfo {
  std::string version, git_commit;  ///< the commit is empty where it is unknown or asked at run time
  std::string compiler, build_type;
  std::string eigen, suitesparse;  ///< versions; suitesparse is empty where it is not used
  std::string solver, ordering;    ///< of the matrix of a step
  std::string cholmod;             ///< its factorisation and orderings of solid parts, or what replaces it
  std::string blas;                ///< as loaded now; NumPy has its own
  std::string licence;             ///< of the core with the libraries it links
};

const BuildInfo& build_info();

}  // namespace flexarm
