#include "flexarm/build_info.hpp"

#include "flexarm/build_config.hpp"

namespace flexarm {

BuildInfo build_info() {
  BuildInfo info;
  info.version = FLEXARM_VERSION;
  info.git = FLEXARM_GIT;
  info.compiler = FLEXARM_COMPILER;
  info.build_type = FLEXARM_BUILD_TYPE;
  info.eigen = FLEXARM_EIGEN_VERSION;
  info.suitesparse = FLEXARM_SUITESPARSE_VERSION;
  info.blas = "none, Eigen's own kernels";
#ifdef FLEXARM_HAS_KLU
  info.solver = "KLU";
  info.ordering = "BTF, AMD on its blocks";
  info.licence = "BSD-3-Clause, with LGPL-2.1+ KLU/AMD/COLAMD/BTF";
#else
  info.solver = "Eigen SparseLU";
  info.ordering = "COLAMD of Eigen";
  info.licence = "BSD-3-Clause with MPL-2.0 Eigen";
#endif
#ifdef FLEXARM_HAS_CHOLMOD
  info.cholmod_found = true;
#endif
  return info;
}

}  // namespace flexarm
