#include "flexarm/assembly/beam_slide.hpp"

#include <cmath>

namespace flexarm::assembly {

using namespace geometry;

namespace {

// Steps of central differences: of ξ, and of increments in m and rad. They err by the square of them and by
// rounding over them.
constexpr double step_along = 1e-5, step_of_nodes = 1e-5;

}  // namespace

BeamSlide::BeamSlide(std::vector<elements::BeamElementIn<3>> beam, int node_b, const Vector3d& place_on_b)
    : beam_(std::move(beam)), node_b_(node_b), place_on_b_(place_on_b) {}

std::size_t BeamSlide::touched(const Frames& frames) const {
  const Vector3d at = (node_b_ < 0 ? Frame{} : frames[node_b_]) * place_on_b_;
  std::size_t e = 0;
  for (std::size_t k = 1; k < beam_.size(); ++k) {
    const Frame& H = frames[beam_[k].node1()];
    if (H.R.col(0).dot(at - H.x) >= 0) e = k;
  }
  return e;
}

BeamSlide::Contact BeamSlide::contact(const Frames& frames) const {
  const auto& element = beam_[touched(frames)];
  return {&element,
          {frames[element.node1()], frames[element.node2()], node_b_ < 0 ? Frame{} : frames[node_b_]}};
}

Vector3d BeamSlide::seen(const Contact& at, double xi) const {
  const Frame A = at.element->interpolate(at.H[0], at.H[1], xi);
  return A.R.transpose() * (at.H[2] * place_on_b_ - A.x);
}

/// Newton's method on (1), whose slope hardly differs from −L.
double BeamSlide::place(const Contact& at) const {
  const double L = (at.H[1].x - at.H[0].x).norm();
  double xi = at.H[0].R.col(0).dot(at.H[2] * place_on_b_ - at.H[0].x) / L;
  for (int k = 0; k < 30; ++k) {
    const double step = seen(at, xi).x() / L;
    xi += step;
    if (std::abs(step) < 1e-15) break;
  }
  return xi;
}

BeamSlide::Rows BeamSlide::rows(const Contact& at) const {
  const double xi = place(at);
  const Frame A = at.element->interpolate(at.H[0], at.H[1], xi);
  const Vector3d p = seen(at, xi);
  Eigen::Matrix<double, 3, 18> P;
  for (int j = 0; j < 12; ++j) {
    const Vector6d v1 = j < 6 ? Vector6d(Vector6d::Unit(j)) : Vector6d(Vector6d::Zero());
    const Vector6d v2 = j < 6 ? Vector6d(Vector6d::Zero()) : Vector6d(Vector6d::Unit(j - 6));
    const Vector6d u = at.element->interpolate_velocity(at.H[0], at.H[1], v1, v2, xi);
    P.col(j) = -u.head<3>() - u.tail<3>().cross(p);  // eq. (4)
  }
  const Matrix3d R = A.R.transpose() * at.H[2].R;
  P.middleCols<3>(12) = R;
  P.rightCols<3>() = -R * skew(place_on_b_);
  const Vector3d along = (seen(at, xi + step_along) - seen(at, xi - step_along)) / (2 * step_along);
  return P.bottomRows<2>() - along.tail<2>() / along.x() * P.row(0);  // eq. (3)
}

Eigen::Vector2d BeamSlide::gap(const Frames& frames) const {
  const Contact at = contact(frames);
  return seen(at, place(at)).tail<2>();
}

BeamSlide::Rows BeamSlide::jacobian(const Frames& frames) const { return rows(contact(frames)); }

BeamSlide::Stiffness BeamSlide::geometric_stiffness(const Frames& frames,
                                                    const Eigen::Vector2d& lambda) const {
  Stiffness K;
  const Contact at = contact(frames);
  for (int j = 0; j < 18; ++j) {
    Contact plus = at, minus = at;
    const Vector6d h = step_of_nodes * Vector6d::Unit(j % 6);
    plus.H[j / 6] = at.H[j / 6] * exp6(h);
    minus.H[j / 6] = at.H[j / 6] * exp6(-h);
    K.col(j) = (rows(plus) - rows(minus)).transpose() * lambda / (2 * step_of_nodes);
  }
  return K;
}

Eigen::Matrix<double, 18, 1> BeamSlide::part(std::size_t element, const Eigen::VectorXd& v) const {
  Eigen::Matrix<double, 18, 1> found = Eigen::Matrix<double, 18, 1>::Zero();
  for (int k = 0; k < 3; ++k) {
    const int node = nodes(element)[k];
    if (node >= 0) found.segment<6>(6 * k) = v.segment<6>(6 * node);
  }
  return found;
}

Eigen::Vector2d BeamSlide::convective(const Frames& frames, const Eigen::VectorXd& v) const {
  const Contact at = contact(frames);
  const Eigen::Matrix<double, 18, 1> own = part(touched(frames), v);
  const double h = step_of_nodes / std::max(own.norm(), 1e-12);
  Contact plus = at, minus = at;
  for (int k = 0; k < 3; ++k) {
    const Vector6d u = h * own.segment<6>(6 * k);
    plus.H[k] = at.H[k] * exp6(u);
    minus.H[k] = at.H[k] * exp6(-u);
  }
  return (rows(plus) - rows(minus)) * own / (2 * h);
}

Vector3d BeamSlide::force_on_b(const Frames& frames, const Eigen::Vector2d& lambda) const {
  const Contact at = contact(frames);
  return -(at.H[2].R * (rows(at).middleCols<3>(12).transpose() * lambda));
}

}  // namespace flexarm::assembly
