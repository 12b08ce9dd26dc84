#include "flexarm/build_info.hpp"

#include "flexarm/build_config.hpp"
#include "flexarm/linear_solvers/blas_info.hpp"
#include "flexarm/linear_solvers/fill_ordering.hpp"

namespace flexarm {
namespace {

std::string cholmod_parts() {
#ifdef FLEXARM_HAS_CHOLMOD
  return std::string(linear_solvers::has_gpl_parts() ? "supernodal" : "simplicial") +
         (linear_solvers::has_metis() ? ", METIS or AMD" : ", AMD");
#else
  return "not used, Eigen orders by AMD";
#endif
}

/// KLU, BTF and CHOLMOD's simplicial part are LGPL, its supernodal part GPL-2.0+; METIS is under Apache-2.0,
/// which goes together with version 3 of the GPL only.
std::string licence() {
  const std::string parts = "BSD-3-Clause flexarm, MPL-2.0 Eigen";
  std::string lgpl;
#ifdef FLEXARM_HAS_KLU
  lgpl += "KLU/BTF";
#endif
#ifdef FLEXARM_HAS_CHOLMOD
  lgpl += lgpl.empty() ? "CHOLMOD" : "/CHOLMOD";
#endif
  if (lgpl.empty()) return "BSD-3-Clause with MPL-2.0 Eigen";
  const std::string all = parts + ", LGPL-2.1+ " + lgpl;
  if (!linear_solvers::has_gpl_parts()) return all;
  return (linear_solvers::has_metis() ? "GPL-3.0+" : "GPL-2.0+") + std::string(" as a whole: ") + all +
         ", GPL-2.0+ supernodal CHOLMOD" + (linear_solvers::has_metis() ? ", Apache-2.0 METIS" : "");
}

BuildInfo collect() {
  BuildInfo info;
  info.version = FLEXARM_VERSION;
  info.git_commit = FLEXARM_GIT;
  info.compiler = FLEXARM_COMPILER;
  info.build_type = FLEXARM_BUILD_TYPE;
  info.eigen = FLEXARM_EIGEN_VERSION;
#if defined(FLEXARM_HAS_KLU) || defined(FLEXARM_HAS_CHOLMOD)
  info.suitesparse = FLEXARM_SUITESPARSE_VERSION;
#endif
#ifdef FLEXARM_HAS_KLU
  info.solver = "KLU";
  info.ordering = "BTF, AMD on its blocks";
#else
  info.solver = "Eigen SparseLU";
  info.ordering = "COLAMD of Eigen";
#endif
  info.cholmod = cholmod_parts();
  info.blas = linear_solvers::loaded_blas();
  info.licence = licence();
  return info;
}

}  // namespace

const BuildInfo& build_info() {
  static const BuildInfo info = collect();  // looking for the BLAS takes a tenth of a millisecond
  return info;
}

}  // namespace flexarm
