#include "flexarm/model/section.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <string>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::section_test {

using namespace flexarm::model;
using flexarm::tests::near;
using std::numbers::pi;

TEST_CASE("A steel tube of 60.24 mm and 3.25 mm wall has the second moment of the paper") {
  const Section s = tube_section(60.24e-3, 3.25e-3);
  CHECK(s.second_moment_y == near(2.37e-7, 1e-3));  // printed with three digits
  CHECK(s.area == near(5.82e-4, 1e-3));
  CHECK(s.second_moment_z == s.second_moment_y);
  CHECK(s.torsion_constant == near(2 * s.second_moment_y));
  CHECK(s.shear_area_y == near(0.53 * s.area));
}

TEST_CASE("A tube without a hole is a round bar") {
  const Section tube = tube_section(0.05, 0.025), bar = round_section(0.05);
  CHECK(tube.area == near(bar.area));
  CHECK(tube.second_moment_y == near(bar.second_moment_y));
  CHECK(tube.torsion_constant == near(bar.torsion_constant));
  CHECK(bar.area == near(pi * 0.05 * 0.05 / 4));
  CHECK(bar.shear_area_z == near(0.886 * bar.area));
}

TEST_CASE("A wide rectangle bends easily in its thin direction") {
  const Section s = rectangle_section(0.04, 0.01);  // 40 mm along y, 10 mm along z
  CHECK(s.area == near(4e-4));
  CHECK(s.second_moment_y == near(0.04 * 1e-6 / 12));
  CHECK(s.second_moment_z == near(0.01 * 64e-6 / 12));
  CHECK(s.shear_area_y == near(4e-4 * 5 / 6));
}

TEST_CASE("Torsion constants of rectangles are those of Saint-Venant's table") {
  // Timoshenko and Goodier, section 109: J = k b h³ with b the longer side; four digits printed.
  struct Row {
    double ratio, k;
  };
  for (const Row& row : {Row{1.0, 0.1406}, {1.5, 0.196}, {2.0, 0.229}, {3.0, 0.263}, {10.0, 0.312}}) {
    const double h = 0.01, b = row.ratio * h;
    CAPTURE(row.ratio);
    CHECK(rectangle_section(b, h).torsion_constant == near(row.k * b * h * h * h, 3e-3));
    CHECK(rectangle_section(h, b).torsion_constant == near(rectangle_section(b, h).torsion_constant));
  }
  CHECK(rectangle_section(1.0, 1e-4).torsion_constant == near(1e-12 / 3, 1e-4));  // a thin strip
}

TEST_CASE("Impossible sections are refused by name") {
  CHECK_THROWS_WITH_AS(tube_section(0.06, 0.04),
                       "tube thickness must be at most half the outer diameter 0.060000 m, got 0.040000 m",
                       flexarm::InvalidParameter);
  CHECK_THROWS_AS(tube_section(-0.06, 0.003), flexarm::InvalidParameter);
  CHECK_THROWS_AS(tube_section(0.06, 0), flexarm::InvalidParameter);
  CHECK_THROWS_AS(round_section(0), flexarm::InvalidParameter);
  CHECK_THROWS_AS(rectangle_section(0.1, std::nan("")), flexarm::InvalidParameter);
  Section s = round_section(0.1);
  s.torsion_constant = -1;
  CHECK_THROWS_WITH_AS(s.check(), doctest::Contains("torsion_constant must be positive"),
                       flexarm::InvalidParameter);
  CHECK_THROWS_AS((Material{210e9, 0, 7850}.check()), flexarm::InvalidParameter);
  CHECK_THROWS_AS((Material{210e9, 80e9, -1}.check()), flexarm::InvalidParameter);
  CHECK_NOTHROW((Material{210e9, 80e9, 0}.check()));  // a massless beam is a spring
}

}  // namespace flexarm::tests::section_test
