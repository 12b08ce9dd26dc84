#include "flexarm/sensitivity/point_slopes.hpp"

namespace flexarm::sensitivity {

using namespace geometry;
using namespace simulation;

namespace {

/// Step of differences by the strain of an element, in parts of its length and rad.
constexpr double strain_step = 1e-5;

/// Rows of one point in a recorded column: one row for each of its numbers, one column a parameter.
Eigen::Map<Slopes> rows_of(Transient::Matrix& columns, Eigen::Index k, Eigen::Index first, Eigen::Index count,
                           Eigen::Index n_parameters) {
  return {columns.col(k).data() + first * n_parameters, count, n_parameters};
}

/// E with the arrow a of R's axes at E a in the base's.
template <int D>
Eigen::Matrix<double, 3, D> to_space(const InSpace<D>& space, const Rotation<D>& R) {
  Eigen::Matrix<double, 3, D> E;
  for (int i = 0; i < D; ++i) E.col(i) = space.arrow(R.col(i));
  return E;
}

/// Derivative of a section's velocity with respect to the strain of its element, at fixed velocities of the
/// ends.
template <int D>
TwistMatrix<D> velocity_by_strain(const elements::BeamElementIn<D>& beam, const Twist<D>& d,
                                  const Twist<D>& v1, const Twist<D>& v2, double xi) {
  TwistMatrix<D> slope;
  for (int i = 0; i < freedoms<D>; ++i) {
    const double step = strain_step * (i < D ? beam.length() : 1.0);
    const auto velocity = [&](double change) {
      const Twist<D> there = d + change * Twist<D>::Unit(i);
      return beam.interpolate_velocity({}, exponential<D>(there), v1, v2, xi);
    };
    slope.col(i) = (velocity(step) - velocity(-step)) / (2 * step);
  }
  return slope;
}

}  // namespace

template <int D>
PointSlopesIn<D>::PointSlopesIn(const SystemIn<D>& system, const InSpace<D>& space,
                                const std::vector<VariedInSpace<D>>& varied)
    : system_(system), space_(space), varied_(varied) {
  for (int i = 0; i < static_cast<int>(system.points().size()); ++i) {
    for (std::size_t p = 0; p < varied.size(); ++p) {
      if (moves(i, varied[p])) moving_.push_back({i, static_cast<Eigen::Index>(p), &varied[p]});
    }
  }
}

/// True if the point's place on its link differs between the two models.
template <int D>
bool PointSlopesIn<D>::moves(int point, const VariedInSpace<D>& varied) const {
  const SystemIn<D>&plus = *varied.variation.plus, &minus = *varied.variation.minus;
  const auto &up = plus.points()[point], &down = minus.points()[point];
  if (!(up == down)) return true;
  if (up.element >= 0 && !plus.beams()[up.element].same_shape(minus.beams()[down.element])) return true;
  const auto origin = [&](const InSpace<D>& space) { return space.place(point, Point<D>::Zero()); };
  const auto axes = [&](const InSpace<D>& space) {
    return space.orientation(point, Rotation<D>::Identity());
  };
  return origin(varied.plus) != origin(varied.minus) || axes(varied.plus) != axes(varied.minus);
}

/// ξ and dv of the point's frame, equation (2).
template <int D>
void PointSlopesIn<D>::follow(int point, const StateIn<D>& state, const StateDerivative& derivative) {
  const auto& at = system_.points()[point];
  const TwistMatrix<D> to_point = adjoint<D>(at.offset.inverse());
  if (at.element < 0) {
    xi_.noalias() = to_point.lazyProduct(derivative.position.template middleRows<n>(n * at.node));
    dv_.noalias() = to_point.lazyProduct(derivative.velocity.template middleRows<n>(n * at.node));
    return;
  }
  const auto& beam = system_.beams()[at.element];
  const int n1 = n * beam.node1(), n2 = n * beam.node2();
  const FrameIn<D> H = relative<D>(state.frames[beam.node1()], state.frames[beam.node2()]);
  const Twist<D> d = logarithm<D>(H), none = Twist<D>::Zero();
  TwistMatrix<D> of_first, of_second;
  for (int i = 0; i < n; ++i) {
    const Twist<D> unit = Twist<D>::Unit(i);
    of_first.col(i) = to_point * beam.interpolate_velocity({}, H, unit, none, at.xi);
    of_second.col(i) = to_point * beam.interpolate_velocity({}, H, none, unit, at.xi);
  }
  const TwistMatrix<D> by_strain = to_point * velocity_by_strain<D>(beam, d, state.v.template segment<n>(n1),
                                                                    state.v.template segment<n>(n2), at.xi);
  const auto xi1 = derivative.position.template middleRows<n>(n1);
  const auto xi2 = derivative.position.template middleRows<n>(n2);
  xi_.noalias() = of_first.lazyProduct(xi1);
  xi_.noalias() += of_second.lazyProduct(xi2);
  dd_.noalias() = right_tangent_inverse<D>(d).lazyProduct(xi2);
  dd_.noalias() -= left_tangent_inverse<D>(d).lazyProduct(xi1);
  dv_.noalias() = of_first.lazyProduct(derivative.velocity.template middleRows<n>(n1));
  dv_.noalias() += of_second.lazyProduct(derivative.velocity.template middleRows<n>(n2));
  dv_.noalias() += by_strain.lazyProduct(dd_);
}

template <int D>
void PointSlopesIn<D>::record(Eigen::Index k, const TransientOptions& options, const StateIn<D>& state,
                              const StateDerivative& derivative, Transient& out) {
  constexpr int spins = turns<D>;
  const Eigen::Index m = derivative.size();
  xi_.resize(n, m);
  dv_.resize(n, m);
  dd_.resize(n, m);
  for (int i = 0; i < static_cast<int>(system_.points().size()); ++i) {
    follow(i, state, derivative);
    const Rotation<D> R = system_.point_frame(state, i).R;
    if (options.record_points) {
      const Point<D> u = system_.point_velocity(state, i).template head<D>();
      const Eigen::Matrix<double, 3, D> E = to_space<D>(space_, R);
      du_ = dv_.template topRows<D>();
      du_.noalias() -= lever_matrix<D>(u).lazyProduct(xi_.template bottomRows<spins>());
      rows_of(out.position, k, 3 * i, 3, m).noalias() = E.lazyProduct(xi_.template topRows<D>());  // eq. (1)
      rows_of(out.velocity, k, 3 * i, 3, m).noalias() = E.lazyProduct(du_);
    }
    if (!options.record_rotations) continue;
    const Eigen::Quaterniond q = Eigen::Quaterniond(space_.orientation(i, R)).normalized();
    auto orientation = rows_of(out.orientation, k, 4 * i, 4, m),
         rate = rows_of(out.angular_rate, k, 3 * i, 3, m);
    for (Eigen::Index p = 0; p < m; ++p) {
      const Vector3d turned = space_.spin_at_point(i, xi_.col(p).template tail<spins>());
      const Eigen::Quaterniond half(0, 0.5 * turned.x(), 0.5 * turned.y(), 0.5 * turned.z());
      orientation.col(p) = (q * half).coeffs();  // eq. (3)
      rate.col(p) = space_.spin_at_point(i, dv_.col(p).template tail<spins>());
    }
  }
  for (const Moving& moving : moving_) add(moving, k, options, state, out);
}

/// Adds the difference of a parameter's two models in the same state.
template <int D>
void PointSlopesIn<D>::add(const Moving& moving, Eigen::Index k, const TransientOptions& options,
                           const StateIn<D>& state, Transient& out) const {
  const auto [i, column, varied] = moving;
  const auto m = static_cast<Eigen::Index>(varied_.size());
  const double per_spread = 1 / varied->variation.spread();
  const auto add_one = [&](const SystemIn<D>& system, const InSpace<D>& space, double sign) {
    const FrameIn<D> H = system.point_frame(state, i);
    const Twist<D> v = system.point_velocity(state, i);
    if (options.record_points) {
      rows_of(out.position, k, 3 * i, 3, m).col(column) += sign * per_spread * space.place(i, H.x);
      rows_of(out.velocity, k, 3 * i, 3, m).col(column) +=
          sign * per_spread * space.arrow(H.R * v.template head<D>());
    }
    if (!options.record_rotations) return;
    const Matrix3d R = space_.orientation(i, system_.point_frame(state, i).R);
    Eigen::Quaterniond q = Eigen::Quaterniond(space.orientation(i, H.R)).normalized();
    if (q.dot(Eigen::Quaterniond(R)) < 0) q.coeffs() *= -1;  // a quaternion and its opposite are one rotation
    rows_of(out.orientation, k, 4 * i, 4, m).col(column) += sign * per_spread * q.coeffs();
    rows_of(out.angular_rate, k, 3 * i, 3, m).col(column) +=
        sign * per_spread * space.spin_at_point(i, v.template tail<turns<D>>());
  };
  add_one(*varied->variation.plus, varied->plus, 1);
  add_one(*varied->variation.minus, varied->minus, -1);
}

template class PointSlopesIn<2>;
template class PointSlopesIn<3>;

}  // namespace flexarm::sensitivity
