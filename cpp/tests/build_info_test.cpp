#include "flexarm/build_info.hpp"

#include <doctest/doctest.h>

#include "flexarm/linear_solvers/fill_ordering.hpp"

namespace flexarm::tests::build_info_test {

namespace {

bool names(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

}  // namespace

TEST_CASE("The licence of the build names LGPL exactly where SuiteSparse is linked") {
  const flexarm::BuildInfo info = flexarm::build_info();
  const bool klu = info.solver == "KLU", cholmod = !names(info.cholmod, "not used");
  CHECK(names(info.licence, "LGPL") == (klu || cholmod));
  CHECK(names(info.licence, "CHOLMOD") == cholmod);
  CHECK(info.suitesparse.empty() == !(klu || cholmod));
}

TEST_CASE("The build is GPL as a whole exactly where CHOLMOD brings its supernodal part") {
  const flexarm::BuildInfo info = flexarm::build_info();
  CHECK((info.licence.rfind("GPL-", 0) == 0) == flexarm::linear_solvers::has_gpl_parts());
  CHECK(names(info.cholmod, "supernodal") == flexarm::linear_solvers::has_gpl_parts());
  CHECK(names(info.cholmod, "METIS") == flexarm::linear_solvers::has_metis());
}

TEST_CASE("The BLAS is the one that CHOLMOD calls") {
  const flexarm::BuildInfo info = flexarm::build_info();
  CHECK(names(info.blas, "none") == names(info.cholmod, "not used"));
  CHECK(!info.blas.empty());
}

}  // namespace flexarm::tests::build_info_test
