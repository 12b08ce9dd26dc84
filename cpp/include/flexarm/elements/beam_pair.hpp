/// @file
/// Two beams side by side: the forces of beam_forces.hpp in the time of one (simd/two.hpp).
#pragma once

#include "flexarm/elements/beam.hpp"
#include "flexarm/elements/beam_forces.hpp"

namespace flexarm::elements {

template <int D>
class BeamPairIn {
 public:
  using Beam = BeamElementIn<D>;

  static bool suits(const Beam& first, const Beam& second) { return !first.grows() && !second.grows(); }

  BeamPairIn(const Beam& first, const Beam& second)
      : nodes1_{first.node1(), second.node1()},
        nodes2_{first.node2(), second.node2()},
        forces_{geometry::side_by_side(first.stiffness(), second.stiffness()),
                geometry::side_by_side(first.rest(0), second.rest(0)),
                Two(first.damping_time(), second.damping_time()),
                first.damping_time() > 0 || second.damping_time() > 0},
        M_(geometry::side_by_side(first.mass(), second.mass())) {}

  /// Adds both to the rows of their nodes: frames one a node, the others `freedoms` a node.
  [[gnu::always_inline]] void add_forces(const FrameIn<D>* frames, const double* v, const double* v_dot,
                                         double* r) const {
    const auto H1 = geometry::side_by_side<D>(frames[nodes1_[0]], frames[nodes1_[1]]);
    const auto H2 = geometry::side_by_side<D>(frames[nodes2_[0]], frames[nodes2_[1]]);
    Ends u, u_dot;
    take(v, u);
    take(v_dot, u_dot);
    add(forces_.at(H1, H2, u, u_dot, M_), r);
  }

 private:
  static constexpr int n = geometry::freedoms<D>;
  using Two = geometry::Two;
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
  BeamForces<D, Two> forces_;
  typename BeamForces<D, Two>::Mass M_;
};

}  // namespace flexarm::elements
