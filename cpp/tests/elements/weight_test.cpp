#include "flexarm/elements/weight.hpp"

#include <doctest/doctest.h>

#include "numerics.hpp"

namespace flexarm::tests::weight_test {

using flexarm::elements::Weight;
using namespace flexarm::geometry;

TEST_CASE("Weight is the negative gradient of its potential, and its stiffness the next derivative") {
  Random random(1);
  for (int n = 0; n < 5; ++n) {
    const Weight weight{random(0.1, 5), random.vector(3)};
    const Frame H = exp6(random.twist(2, 2));
    const Vector3d g = random.vector(3, 9.81);
    const auto potential = [&](const VectorXd& d) -> VectorXd {
      return VectorXd::Constant(1, weight.potential(H * exp6(d), g));
    };
    const auto force = [&](const VectorXd& d) -> VectorXd { return weight.force((H * exp6(d)).R, g); };
    CHECK(relative_error(-weight.force(H.R, g).transpose(), differences(potential, 6)) < 1e-10);
    CHECK(relative_error(-weight.stiffness(H.R, g), differences(force, 6)) < 1e-10);
  }
}

}  // namespace flexarm::tests::weight_test
