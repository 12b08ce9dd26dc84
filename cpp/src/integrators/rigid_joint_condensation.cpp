#include "flexarm/integrators/rigid_joint_condensation.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace flexarm::integrators {

using namespace geometry;
using Eigen::VectorXd;

template <int D>
RigidJointCondensationIn<D>::RigidJointCondensationIn(const SystemD& system, bool condense)
    : system_(system) {
  if (condense) find_followers();
  if (carriers_.empty() || followers_.empty()) {  // an arm that rests as a whole is left as it is
    condensed_.clear();
    followers_.clear();
    carriers_.resize(system.n_nodes());
    std::iota(carriers_.begin(), carriers_.end(), 0);
  }
  number_unknowns();
}

template <int D>
void RigidJointCondensationIn<D>::find_followers() {
  condensed_.assign(system_.constraints().size(), false);
  std::vector<bool> seen(system_.n_nodes(), false);
  collect_followers(joints::JointConstraintIn<D>::ground, seen);
  for (int k = 0; k < system_.n_nodes(); ++k) {
    if (seen[k]) continue;
    seen[k] = true;
    carriers_.push_back(k);
    collect_followers(k, seen);
  }
}

/// All that hangs on a carrier, the nearest first.
template <int D>
void RigidJointCondensationIn<D>::collect_followers(int carrier, std::vector<bool>& seen) {
  struct Reached {
    int node;
    FrameD X;
  };
  std::vector<Reached> reached = {{carrier, FrameD{}}};
  for (std::size_t at = 0; at < reached.size(); ++at) {
    const Reached parent = reached[at];
    for (std::size_t k = 0; k < system_.constraints().size(); ++k) {
      const auto& joint = system_.constraints()[k];
      const int a = joint.node_a(), b = joint.node_b();
      if (joint.type() != joints::JointType::fixed || (a != parent.node && b != parent.node)) continue;
      const int node = a == parent.node ? b : a;
      if (node < 0 || seen[node]) continue;
      const FrameD b_from_a = joint.frame_a() * joint.frame_b().inverse();
      const FrameD step = a == parent.node ? b_from_a : b_from_a.inverse();
      const FrameD X = parent.X * step;
      followers_.push_back({node, carrier, parent.node, static_cast<int>(k),
                            system_.first_row(static_cast<int>(k)), X, X.inverse(), step.inverse()});
      reached.push_back({node, X});
      seen[node] = condensed_[k] = true;
    }
  }
}

template <int D>
void RigidJointCondensationIn<D>::number_unknowns() {
  std::vector<bool> kept(system_.n_unknowns(), true);
  const auto drop = [&](int first, int count) { std::fill_n(kept.begin() + first, count, false); };
  for (const Follower& follower : followers_) {
    drop(n * follower.node, n);
    drop(system_.n_free() + follower.first_row, n);
  }
  rows_.assign(kept.size(), none);
  for (int k = 0; k < static_cast<int>(kept.size()); ++k) {
    if (!kept[k]) continue;
    if (k == 0 || !kept[k - 1]) pieces_.push_back({k, n_unknowns_, 0});
    ++pieces_.back().count;
    rows_[k] = n_unknowns_++;
  }
}

template <int D>
typename RigidJointCondensationIn<D>::Place RigidJointCondensationIn<D>::place_of(int node) const {
  for (const Follower& follower : followers_) {
    if (follower.node != node) continue;
    return {follower.carrier < 0 ? none : rows_[n * follower.carrier], follower.X_inverse};
  }
  return {rows_[n * node], FrameD{}};
}

template <int D>
Eigen::SparseMatrix<double> RigidJointCondensationIn<D>::reduce(const Eigen::SparseMatrix<double>& S) const {
  std::vector<Eigen::Triplet<double>> entries;
  for (const Piece& piece : pieces_) {
    for (int k = 0; k < piece.count; ++k) entries.emplace_back(piece.from + k, piece.to + k, 1.0);
  }
  for (const Follower& follower : followers_) {
    if (follower.carrier < 0) continue;
    const TwistMatrix<D> Ad = adjoint<D>(follower.X_inverse);
    for (int j = 0; j < n; ++j) {
      for (int i = 0; i < n; ++i) {
        if (std::abs(Ad(i, j)) < 1e-15) continue;  // a right angle's rounding would couple a plane to space
        entries.emplace_back(n * follower.node + i, rows_[n * follower.carrier + j], Ad(i, j));
      }
    }
  }
  Eigen::SparseMatrix<double> T(S.rows(), n_unknowns_);
  T.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SparseMatrix<double> ST = S * T, T_transposed = T.transpose();
  Eigen::SparseMatrix<double> reduced = T_transposed * ST;
  reduced.makeCompressed();
  return reduced;
}

template <int D>
void RigidJointCondensationIn<D>::condense(VectorXd& b, VectorXd& y) const {
  for (const Follower& follower : followers_) {
    if (follower.carrier < 0) continue;
    const Twist<D> f = b.template segment<n>(n * follower.node);
    b.template segment<n>(n * follower.carrier) += adjoint_transpose_product<D>(follower.X_inverse, f);
  }
  for (const Piece& piece : pieces_) y.segment(piece.to, piece.count) = b.segment(piece.from, piece.count);
}

template <int D>
void RigidJointCondensationIn<D>::expand(const VectorXd& y, VectorXd& dx) const {
  for (const Piece& piece : pieces_) dx.segment(piece.from, piece.count) = y.segment(piece.to, piece.count);
  for (const Follower& follower : followers_) {
    auto own = dx.template segment<n>(n * follower.node);
    if (follower.carrier < 0) {
      own.setZero();
    } else {
      const Twist<D> of_carrier = dx.template segment<n>(n * follower.carrier);
      own = adjoint_product<D>(follower.X_inverse, of_carrier);
    }
    dx.template segment<n>(system_.n_free() + follower.first_row).setZero();
  }
}

template <int D>
void RigidJointCondensationIn<D>::place(std::vector<FrameD>& frames) const {
  for (const Follower& follower : followers_) {
    frames[follower.node] = follower.carrier < 0 ? follower.X : frames[follower.carrier] * follower.X;
  }
}

template <int D>
void RigidJointCondensationIn<D>::recover_multipliers(StateD& state,
                                                      const assembly::LoadsIn<D>& loads) const {
  if (!any()) return;
  VectorXd r(system_.n_velocities()), phi(system_.n_constraints());
  system_.evaluate(state, loads, r, phi, condensed_);
  for (auto follower = followers_.rbegin(); follower != followers_.rend(); ++follower) {
    const auto& joint = system_.constraints()[follower->joint];
    const Twist<D> f = r.template segment<n>(n * follower->node);
    Twist<D> lambda;  // eq. (3)
    if (joint.node_b() == follower->node) {
      lambda = -adjoint_transpose_product<D>(joint.frame_b(), f);
    } else {
      lambda = adjoint_transpose_product<D>(joint.frame_a(), f);
    }
    state.multipliers.template segment<n>(follower->first_row) = lambda;
    if (follower->parent < 0) continue;
    r.template segment<n>(n * follower->parent) += adjoint_transpose_product<D>(follower->parent_inverse, f);
  }
}

template class RigidJointCondensationIn<2>;
template class RigidJointCondensationIn<3>;

}  // namespace flexarm::integrators
