#include "flexarm/errors.hpp"

#include <doctest/doctest.h>

namespace flexarm::tests::errors_test {

TEST_CASE("A failed iteration carries when and how far from equilibrium it stopped") {
  try {
    throw flexarm::NotConverged("t = 0.824 s: residual 3.1e-02 N", 0.824, 12, 3.1e-2);
  } catch (const std::runtime_error& error) {
    const auto& failure = dynamic_cast<const flexarm::NotConverged&>(error);
    CHECK(failure.time == 0.824);
    CHECK(failure.iteration == 12);
    CHECK(failure.residual == 3.1e-2);
    CHECK(std::string(failure.what()) == "t = 0.824 s: residual 3.1e-02 N");
  }
}

TEST_CASE("A value that the model cannot take is an invalid argument") {
  CHECK_THROWS_AS(throw flexarm::InvalidParameter("link 'forearm': EI must be positive"),
                  std::invalid_argument);
}

}  // namespace flexarm::tests::errors_test
