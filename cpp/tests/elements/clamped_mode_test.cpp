#include "flexarm/elements/clamped_mode.hpp"

#include <doctest/doctest.h>

#include <vector>

#include "numerics.hpp"

namespace flexarm::tests::clamped_mode_test {

using flexarm::elements::BeamElement;
using flexarm::elements::BeamProperties;
using flexarm::geometry::Frame;

namespace {

constexpr double L = 3.0, EI = 49770.0, rho_A = 4.5687;
constexpr double rigid = std::numeric_limits<double>::infinity();

double frequency(int n, const BeamProperties& properties) {
  std::vector<BeamElement> chain;
  for (int k = 0; k < n; ++k) {
    chain.emplace_back(k, k + 1, Frame::translation({k * L / n, 0, 0}),
                       Frame::translation({(k + 1) * L / n, 0, 0}), properties);
  }
  return flexarm::elements::first_clamped_frequency(chain);
}

const BeamProperties slender{.EA = 1.2e8,
                             .GJ = 3.8e4,
                             .EIy = EI,
                             .EIz = EI,
                             .GAy = rigid,
                             .GAz = rigid,
                             .rho_A = rho_A,
                             .rho_Iy = 0,
                             .rho_Iz = 0,
                             .rho_J = 3.7e-3};

}  // namespace

TEST_CASE("The first clamped frequency converges to 1.8751² √(EI/ρA L⁴) at order four") {
  const double root = 1.875104068711961;  // of 1 + cos λ cosh λ
  const double exact = root * root * std::sqrt(EI / (rho_A * L * L * L * L));
  const double e2 = frequency(2, slender) - exact, e4 = frequency(4, slender) - exact;
  const double e8 = frequency(8, slender) - exact;
  CHECK(e8 > 0);  // consistent masses bound it from above
  CHECK(e8 < 1e-5 * exact);
  CHECK(observed_order(e2, e4) == near(4, 0.05));
  CHECK(observed_order(e4, e8) == near(4, 0.05));
}

TEST_CASE("The lowest mode counts, in whichever plane it bends") {
  BeamProperties flat = slender;
  flat.EIy = EI / 4;
  CHECK(frequency(4, flat) == near(0.5 * frequency(4, slender), 1e-9));
  flat.EIy = EI;
  flat.EIz = EI / 4;
  CHECK(frequency(4, flat) == near(0.5 * frequency(4, slender), 1e-9));
}

}  // namespace flexarm::tests::clamped_mode_test
