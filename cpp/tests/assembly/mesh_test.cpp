#include "flexarm/assembly/mesh.hpp"

#include <doctest/doctest.h>

#include "flexarm/errors.hpp"
#include "numerics.hpp"

namespace flexarm::tests::mesh_test {

using namespace flexarm::assembly;

TEST_CASE("Section axes are right-handed, x along the beam, z towards `up`") {
  Random random(1);
  for (int n = 0; n < 10; ++n) {
    const Vector3d end = random.vector(3), up = random.vector(3);
    const Matrix3d R = section_axes(end, up);
    CHECK(error(R.transpose() * R, Matrix3d::Identity()) < 1e-14);
    CHECK(R.determinant() == near(1));
    CHECK(error(R.col(0), end.normalized()) < 1e-15);
    CHECK(R.col(2).dot(up) > 0);
    CHECK(std::abs(R.col(1).dot(up)) < 1e-14);
  }
  CHECK(error(section_axes({2, 0, 0}, {0, 0, 1}), Matrix3d::Identity()) < 1e-15);
  CHECK(section_axes({1, 2, 3}, Vector3d::Zero()).determinant() == near(1));
  CHECK_THROWS_AS(section_axes({1, 2, 3}, {2, 4, 6}), flexarm::InvalidParameter);
}

TEST_CASE("Nodes stand at equal distances, and the nearest moves to a mass") {
  using Stations = std::vector<double>;
  CHECK(beam_stations(4, 4, {}) == Stations{0, 1, 2, 3, 4});
  CHECK(beam_stations(4, 4, {1.8}) == Stations{0, 1, 1.8, 3, 4});
  CHECK(beam_stations(4, 4, {4.0}) == Stations{0, 1, 2, 3, 4});
  CHECK(beam_stations(4, 4, {3.9999}) == Stations{0, 1, 2, 3, 4});  // a sliver from the end: on the end
  CHECK(beam_stations(4, 4, {1.8, 2.2}) == Stations{0, 1, 1.8, 2.2, 3, 4});
}

TEST_CASE("Every mass has a node of its own, and nodes rise, wherever the masses are") {
  Random random(2);
  for (int run = 0; run < 200; ++run) {
    std::vector<double> places;
    const int n_places = 1 + run % 6;
    for (int k = 0; k < n_places; ++k) places.push_back(random(0, 3));
    const auto s = beam_stations(3, 1 + run % 4, places);
    CHECK(s.front() == 0);
    CHECK(s.back() == 3);
    for (std::size_t k = 1; k < s.size(); ++k) CHECK(s[k] - s[k - 1] > 1e-3);
    for (double place : places) {
      double nearest = 3;
      for (double station : s) nearest = std::min(nearest, std::abs(station - place));
      CHECK(nearest <= 3e-3 + 1e-12);  // a sliver of 1e-3 of the length
    }
  }
}

TEST_CASE("A place on a beam is found again from its node or element") {
  LinkMesh mesh;
  mesh.first_node = 5;
  mesh.first_element = 3;
  mesh.stations = {0, 1, 2, 3};
  mesh.R_LS = section_axes({0, 3, 0}, {1, 0, 0});
  Random random(3);
  for (bool on_node : {true, false}) {
    for (int n = 0; n < 20; ++n) {
      const Vector3d position(random(-0.1, 0.1), random(0, 3), random(-0.1, 0.1));
      const Attachment at = attach(mesh, position, on_node);
      const Frame section =
          at.element < 0 ? mesh.node_frame(Frame{}, at.node - 5)
                         : mesh.node_frame(Frame{}, at.element - 3) * Frame::translation({at.xi, 0, 0});
      const Frame found = section * at.offset;
      CHECK(error(found.x, position) < 1e-14);
      CHECK(error(found.R, Matrix3d::Identity()) < 1e-15);  // in link axes
      CHECK((at.element < 0) == on_node);
    }
  }
  const Attachment end = attach(mesh, {0, 3, 0}, false);
  CHECK(end.element == -1);
  CHECK(end.node == 8);
}

TEST_CASE("A place on a rigid link sits on its only node") {
  LinkMesh mesh;
  mesh.first_node = 2;
  const Attachment at = attach(mesh, {1, 2, 3}, false);
  CHECK(at.node == 2);
  CHECK(at.element == -1);
  CHECK(error(at.offset.x, Vector3d(1, 2, 3)) == 0);
}

}  // namespace flexarm::tests::mesh_test
