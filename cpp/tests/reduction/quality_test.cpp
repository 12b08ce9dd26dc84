#include "flexarm/reduction/quality.hpp"

#include <doctest/doctest.h>

#include "reduction/parts.hpp"

namespace flexarm::tests::quality_test {

using flexarm::reduction::ReductionQuality;

namespace {

constexpr auto rigid = InterfaceKind::rigid, average = InterfaceKind::average;
const std::vector<std::pair<InterfaceKind, InterfaceKind>> kinds = {
    {rigid, rigid}, {rigid, average}, {average, average}};

}  // namespace

TEST_CASE("The estimate of free frequencies' errors is close to the true error, for any number of modes") {
  const Part part;
  for (const auto& [first, second] : kinds) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const VectorXd exact = hertz(FullModel(part, interfaces).free_spectrum());
    for (const int modes : {0, 3, 8, 20}) {
      CAPTURE(modes);
      const ReductionQuality quality = part.reduce(interfaces, modes).quality;
      for (Eigen::Index k = 0; k < quality.free_frequency_hz.size(); ++k) {
        const double found = quality.free_frequency_hz[k], estimate = quality.free_frequency_error[k];
        const double error = found / exact[6 + k] - 1;
        if (found > quality.trusted_frequency_hz || error < 1e-9)
          continue;  // below: the residuals of the modes
        CAPTURE(found);
        CHECK(estimate > 0.9 * error);
        CHECK(estimate < 2.5 * error);
      }
    }
  }
}

TEST_CASE("A free mode close to the first one left out spoils no estimate of the others") {
  // The bound for what such a mode loses grows without limit; among 40 counts some bring one close.
  const Part part(12, 2, 2);
  const std::vector<Interface> interfaces = part.ends(rigid, rigid);
  const double exact = hertz(FullModel(part, interfaces).free_spectrum())[6];
  double closest = 0;
  for (int modes = 5; modes <= 45; ++modes) {
    CAPTURE(modes);
    const auto reduced = part.reduce(interfaces, modes);
    const ReductionQuality& quality = reduced.quality;
    const VectorXd free = hertz(free_spectrum(reduced)) / quality.left_out_frequency_hz;
    closest = std::max(closest, (free.array() < 1).select(free.array(), 0).maxCoeff());
    const double error = quality.free_frequency_hz[0] / exact - 1;
    CHECK(quality.free_frequency_error[0] > 0.9 * error);
    CHECK(quality.free_frequency_error[0] < 2.5 * error);
  }
  CHECK(closest > 0.99);
}

TEST_CASE("Below the trusted frequency free frequencies are within one percent and a little") {
  const Part part;
  for (const auto& [first, second] : kinds) {
    const std::vector<Interface> interfaces = part.ends(first, second);
    const VectorXd exact = hertz(FullModel(part, interfaces).free_spectrum());
    for (const int modes : {0, 2, 4, 8, 16, 30}) {
      CAPTURE(modes);
      const ReductionQuality quality = part.reduce(interfaces, modes).quality;
      for (Eigen::Index k = 0; k < quality.free_frequency_hz.size(); ++k) {
        if (quality.free_frequency_hz[k] > quality.trusted_frequency_hz) break;
        CHECK(quality.free_frequency_hz[k] / exact[6 + k] - 1 < 0.012);
      }
    }
  }
}

TEST_CASE("Effective masses of all modes add up to what can move") {
  const Part part(2, 2, 1);
  for (const auto& [first, second] : kinds) {
    const ReductionQuality quality = part.reduce(part.ends(first, second), 1000).quality;
    const VectorXd sum = quality.effective_mass.colwise().sum();
    CHECK(relative_error(sum, quality.movable_mass) < 1e-10);
    CHECK((quality.movable_mass.head(3).array() < quality.mass).all());
    CHECK((quality.movable_mass.tail(3).array() < quality.inertia.diagonal().array()).all());
  }
}

TEST_CASE("A bar held at both ends: effective masses of longitudinal modes are 8 m/(k π)², k odd") {
  // A slender bar without lateral contraction of its faces: fine enough along x to be a continuum.
  const Part part(60, 1, 1);
  const ReductionQuality quality = part.reduce(part.ends(rigid, rigid), 30).quality;
  Eigen::Index first = 0;
  const double largest_share = quality.effective_mass.col(0).maxCoeff(&first) / quality.mass;
  CHECK(largest_share ==
        near(8 / std::pow(std::numbers::pi, 2), 0.02));  // the ends hold back their contraction
}

TEST_CASE("More modes leave less mass out") {
  const Part part;
  double before = 0;
  for (const int modes : {1, 4, 10, 30}) {
    const ReductionQuality quality = part.reduce(part.ends(rigid, average), modes).quality;
    const VectorXd share =
        quality.effective_mass.colwise().sum().transpose().cwiseQuotient(quality.movable_mass);
    CHECK(share.minCoeff() >= 0);
    CHECK(share.maxCoeff() <= 1 + 1e-9);
    CHECK(share.sum() > before);
    before = share.sum();
  }
}

}  // namespace flexarm::tests::quality_test
