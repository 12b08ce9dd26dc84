/// @file
/// Two beams side by side: internal and inertia forces of beam.hpp, (1) to (4), in the time of one
/// (geometry/two.hpp). Their bows must not grow.
#pragma once

#include "flexarm/elements/beam.hpp"

namespace flexarm::elements {

template <int D>
class BeamPairIn {
 public:
  using Beam = BeamElementIn<D>;

  static bool suits(const Beam& first, const Beam& second) { return !first.grows() && !second.grows(); }

  BeamPairIn(const Beam& first, const Beam& second)
      : nodes1_{first.node1(), second.node1()},
        nodes2_{first.node2(), second.node2()},
        K_(geometry::side_by_side(first.stiffness(), second.stiffness())),
        rest_(geometry::side_by_side(first.rest(0), second.rest(0))),
        eta_(first.damping_time(), second.damping_time()),
        damped_(first.damping_time() > 0 || second.damping_time() > 0),
        M_(geometry::side_by_side(first.mass(), second.mass())) {}

  /// Adds both to the rows of their nodes: frames one a node, the others `freedoms` a node.
  [[gnu::always_inline]] void add_forces(const FrameIn<D>* frames, const double* v, const double* v_dot,
                                         double* r) const {
    const auto H1 = geometry::side_by_side<D>(frames[nodes1_[0]], frames[nodes1_[1]]);
    const auto H2 = geometry::side_by_side<D>(frames[nodes2_[0]], frames[nodes2_[1]]);
    Ends u, u_dot;
    take(v, u);
    take(v_dot, u_dot);
    const TwistD d = geometry::logarithm<D>(geometry::relative<D>(H1, H2));
    const geometry::InverseTangentIn<D, Two> tangent(d);
    TwistD stress = K_.cwiseProduct(d - rest_);  // eq. (1)
    if (damped_) {
      stress += eta_ * K_.cwiseProduct(tangent.strain_rate(u.template head<n>(), u.template tail<n>()));
    }
    const auto internal = tangent.transpose_times(stress);  // eq. (3)
    const Ends p = Uncoupled<D>::product(M_, u);
    Ends f = Uncoupled<D>::product(M_, u_dot);  // eq. (4)
    f.template head<n>() -=
        internal.left + geometry::ad_transpose<D, Two>(u.template head<n>(), p.template head<n>());
    f.template tail<n>() +=
        internal.right - geometry::ad_transpose<D, Two>(u.template tail<n>(), p.template tail<n>());
    add(f, r);
  }

 private:
  static constexpr int n = geometry::freedoms<D>;
  using Two = geometry::Two;
  using TwistD = geometry::Twist<D, Two>;
  using Ends = Eigen::Matrix<Two, 2 * n, 1>;

  void take(const double* all, Ends& ends) const {
    for (int k = 0; k < n; ++k) {
      ends[k] = Two(all[n * nodes1_[0] + k], all[n * nodes1_[1] + k]);
      ends[n + k] = Two(all[n * nodes2_[0] + k], all[n * nodes2_[1] + k]);
    }
  }

  void add(const Ends& f, double* r) const {
    for (int lane = 0; lane < 2; ++lane) {
      for (int k = 0; k < n; ++k) r[n * nodes1_[lane] + k] += f[k][lane];
      for (int k = 0; k < n; ++k) r[n * nodes2_[lane] + k] += f[n + k][lane];
    }
  }

  std::array<int, 2> nodes1_, nodes2_;
  TwistD K_, rest_;
  Two eta_;
  bool damped_;
  Eigen::Matrix<Two, 2 * n, 2 * n> M_;
};

}  // namespace flexarm::elements
