#include "flexarm/build_info.hpp"

#include <doctest/doctest.h>

TEST_CASE("The licence of the build names LGPL exactly where KLU is linked") {
  const flexarm::BuildInfo info = flexarm::build_info();
  const bool klu = info.solver == "KLU";
  CHECK((info.licence.find("LGPL") != std::string::npos) == klu);
  CHECK(info.suitesparse.empty() == !klu);
  CHECK(info.licence.find("GPL-3") == std::string::npos);
}
