#include "flexarm/assembly/beam_slide.hpp"

#include <cmath>

namespace flexarm::assembly {

using namespace geometry;

namespace {

// Steps of central differences: of ξ, and of increments in m and rad. They err by the square of them and by
// rounding over them.
constexpr double step_along = 1e-5, step_of_nodes = 1e-5;

}  // namespace

template <int D>
BeamSlideIn<D>::BeamSlideIn(std::vector<elements::BeamElementIn<D>> beam, int node_b,
                            const PointD& place_on_b)
    : beam_(std::move(beam)), node_b_(node_b), place_on_b_(place_on_b) {}

template <int D>
BeamSlideIn<D>::BeamSlideIn(const BeamSlideIn<3>& slide, const PlaneAxes& of_beam, const PlaneAxes& of_b)
  requires(D == 2)
    : node_b_(slide.node_b_), place_on_b_(of_b.part(slide.place_on_b_)) {
  for (const elements::BeamElement& element : slide.beam_) beam_.emplace_back(element, of_beam);
}

template <int D>
std::size_t BeamSlideIn<D>::touched(const Frames& frames) const {
  const PointD at = (node_b_ < 0 ? FrameD{} : frames[node_b_]) * place_on_b_;
  std::size_t e = 0;
  for (std::size_t k = 1; k < beam_.size(); ++k) {
    const FrameD& H = frames[beam_[k].node1()];
    if (H.R.col(0).dot(at - H.x) >= 0) e = k;
  }
  return e;
}

template <int D>
typename BeamSlideIn<D>::Contact BeamSlideIn<D>::contact(const Frames& frames) const {
  const auto& element = beam_[touched(frames)];
  return {&element,
          {frames[element.node1()], frames[element.node2()], node_b_ < 0 ? FrameD{} : frames[node_b_]}};
}

template <int D>
Point<D> BeamSlideIn<D>::seen(const Contact& at, double xi) const {
  const FrameD A = at.element->interpolate(at.H[0], at.H[1], xi);
  return A.R.transpose() * (at.H[2] * place_on_b_ - A.x);
}

/// Newton's method on (1), whose slope hardly differs from −L.
template <int D>
double BeamSlideIn<D>::place(const Contact& at) const {
  const double L = (at.H[1].x - at.H[0].x).norm();
  double xi = at.H[0].R.col(0).dot(at.H[2] * place_on_b_ - at.H[0].x) / L;
  for (int k = 0; k < 30; ++k) {
    const double step = seen(at, xi).x() / L;
    xi += step;
    if (std::abs(step) < 1e-15) break;
  }
  return xi;
}

template <int D>
typename BeamSlideIn<D>::Rows BeamSlideIn<D>::rows(const Contact& at) const {
  constexpr int t = turns<D>;
  const double xi = place(at);
  const FrameD A = at.element->interpolate(at.H[0], at.H[1], xi);
  const PointD p = seen(at, xi);
  Eigen::Matrix<double, D, 3 * n> P;
  for (int j = 0; j < 2 * n; ++j) {
    TwistD v1 = TwistD::Zero(), v2 = TwistD::Zero();
    (j < n ? v1 : v2)[j % n] = 1;
    const TwistD u = at.element->interpolate_velocity(at.H[0], at.H[1], v1, v2, xi);
    P.col(j) = -u.template head<D>() - turn_cross<D>(u.template tail<t>(), p);  // eq. (4)
  }
  const Rotation<D> R = A.R.transpose() * at.H[2].R;
  P.template middleCols<D>(2 * n) = R;
  P.template rightCols<t>() = -R * lever_matrix<D>(place_on_b_);
  const PointD along = (seen(at, xi + step_along) - seen(at, xi - step_along)) / (2 * step_along);
  return P.template bottomRows<D - 1>() - along.template tail<D - 1>() / along.x() * P.row(0);  // eq. (3)
}

template <int D>
typename BeamSlideIn<D>::Conditions BeamSlideIn<D>::residual(const Frames& frames) const {
  const Contact at = contact(frames);
  return seen(at, place(at)).template tail<D - 1>();
}

template <int D>
typename BeamSlideIn<D>::Rows BeamSlideIn<D>::jacobian(const Frames& frames) const {
  return rows(contact(frames));
}

template <int D>
typename BeamSlideIn<D>::Stiffness BeamSlideIn<D>::geometric_stiffness(const Frames& frames,
                                                                       const Conditions& lambda) const {
  Stiffness K;
  const Contact at = contact(frames);
  for (int j = 0; j < 3 * n; ++j) {
    Contact plus = at, minus = at;
    const TwistD h = step_of_nodes * TwistD::Unit(j % n);
    plus.H[j / n] = at.H[j / n] * exponential<D>(h);
    minus.H[j / n] = at.H[j / n] * exponential<D>(-h);
    K.col(j) = (rows(plus) - rows(minus)).transpose() * lambda / (2 * step_of_nodes);
  }
  return K;
}

template <int D>
typename BeamSlideIn<D>::Velocities BeamSlideIn<D>::part(std::size_t element,
                                                         const Eigen::VectorXd& v) const {
  Velocities found = Velocities::Zero();
  for (int k = 0; k < 3; ++k) {
    const int node = nodes(element)[k];
    if (node >= 0) found.template segment<n>(n * k) = v.segment<n>(n * node);
  }
  return found;
}

template <int D>
typename BeamSlideIn<D>::Conditions BeamSlideIn<D>::convective(const Frames& frames,
                                                               const Eigen::VectorXd& v) const {
  const Contact at = contact(frames);
  const Velocities own = part(touched(frames), v);
  const double h = step_of_nodes / std::max(own.norm(), 1e-12);
  Contact plus = at, minus = at;
  for (int k = 0; k < 3; ++k) {
    const TwistD u = h * own.template segment<n>(n * k);
    plus.H[k] = at.H[k] * exponential<D>(u);
    minus.H[k] = at.H[k] * exponential<D>(-u);
  }
  return (rows(plus) - rows(minus)) * own / (2 * h);
}

template <int D>
Point<D> BeamSlideIn<D>::force_on_b(const Frames& frames, const Conditions& lambda) const {
  const Contact at = contact(frames);
  return -(at.H[2].R * (rows(at).template middleCols<D>(2 * n).transpose() * lambda));
}

template class BeamSlideIn<2>;
template class BeamSlideIn<3>;

}  // namespace flexarm::assembly
