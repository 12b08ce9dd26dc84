#include "flexarm/assembly/mesh.hpp"

#include <algorithm>
#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::assembly {
namespace {

// Relative to the length: nodes and places closer than this are one.
constexpr double same_place = 1e-9;
// A mass this close to an end or to another mass sits on the node there; its arm is kept, only the sliver of
// beam between is rigid.
constexpr double sliver = 1e-3;

}  // namespace

Matrix3d section_axes(const Vector3d& end, const Vector3d& up) {
  const Vector3d x = end.normalized();
  Vector3d z = up;
  if (z.isZero()) {
    Vector3d::Index smallest;
    x.cwiseAbs().minCoeff(&smallest);
    z = Vector3d::Unit(smallest);
  }
  z -= x * x.dot(z);
  if (z.norm() < 1e-6 * std::max(up.norm(), 1.0)) {
    throw InvalidParameter("`up` must not run along the beam's axis");
  }
  z.normalize();
  Matrix3d R;
  R << x, z.cross(x), z;
  return R;
}

std::vector<double> beam_stations(double length, int elements, std::vector<double> occupied) {
  std::vector<double> stations(elements + 1);
  for (int k = 0; k <= elements; ++k) stations[k] = length * k / elements;
  stations.back() = length;  // not length * (n/n), which may differ in the last bit
  std::sort(occupied.begin(), occupied.end());
  std::vector<double> taken = {0.0, length};
  for (double place : occupied) {
    const auto close = [&](double other) { return std::abs(other - place) <= sliver * length; };
    if (std::any_of(taken.begin(), taken.end(), close)) continue;
    const auto nearest = std::min_element(stations.begin(), stations.end(), [&](double p, double q) {
      return std::abs(p - place) < std::abs(q - place);
    });
    const bool free = std::find(taken.begin(), taken.end(), *nearest) == taken.end();
    if (free) {
      *nearest = place;
    } else {
      stations.insert(std::upper_bound(stations.begin(), stations.end(), place), place);
    }
    taken.push_back(place);
  }
  return stations;
}

Attachment attach(const LinkMesh& mesh, const Vector3d& position, bool on_node, int interface) {
  if (!mesh.is_beam()) {
    return {.node = mesh.first_node + interface,
            .offset = mesh.place_axes(interface) * Frame::translation(position)};
  }
  const double length = mesh.length();
  const double along = std::clamp(mesh.R_LS.col(0).dot(position), 0.0, length);
  const auto& s = mesh.stations;
  const auto nearest = std::min_element(
      s.begin(), s.end(), [&](double p, double q) { return std::abs(p - along) < std::abs(q - along); });
  const int k = static_cast<int>(nearest - s.begin());
  const auto offset_from = [&](double station) {
    return mesh.place_axes(0) * Frame::translation(position - mesh.R_LS.col(0) * station);
  };
  if (on_node || std::abs(s[k] - along) <= same_place * length) {
    return {.node = mesh.first_node + k, .offset = offset_from(s[k])};
  }
  const int after = static_cast<int>(std::upper_bound(s.begin(), s.end(), along) - s.begin());
  const int e = after - 1;
  return {.node = mesh.first_node + e,
          .element = mesh.first_element + e,
          .xi = (along - s[e]) / (s[after] - s[e]),
          .offset = offset_from(along)};
}

}  // namespace flexarm::assembly
