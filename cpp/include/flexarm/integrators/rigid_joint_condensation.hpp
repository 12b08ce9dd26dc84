/// @file
/// Condensation of rigid joints: nodes that they hold together are stepped as one.
///
/// A rigid joint demands H_b = H_a X with X = X_a X_b⁻¹ (joints/joint_constraint.hpp). Node b may then follow
/// a, its carrier, in everything that is linear in velocities,
///
///     H_b = H_a X,   v_b = Ad(X⁻¹) v_a,   and alike v̇, a and increments                              (1)
///
/// With the increments y of what does not follow, Δ = T y, a step solves
///
///     Tᵀ S T y = −Tᵀ (r, s Φ)                                                                        (2)
///
/// instead of eq. (5) of hht.hpp, without the joint's constraint and its multipliers. These are found where
/// somebody asks: with the force f that is left over on b and on all that hangs on it,
///
///     λ = −Ad(X_b)ᵀ f        (if a follows b: λ = Ad(X_a)ᵀ f)                                        (3)
///
/// What is held to the base rests. Rigid joints that close a loop stay constraints.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "flexarm/assembly/equations.hpp"

namespace flexarm::integrators {

template <int D>
class RigidJointCondensationIn {
 public:
  using SystemD = assembly::SystemIn<D>;
  using StateD = assembly::StateIn<D>;
  using FrameD = geometry::FrameIn<D>;
  using VectorXd = Eigen::VectorXd;
  static constexpr int none = -1;

  /// @param condense off: no node follows another one.
  RigidJointCondensationIn(const SystemD& system, bool condense);

  bool any() const { return !followers_.empty(); }
  int n_unknowns() const { return n_unknowns_; }                  ///< of y
  const std::vector<bool>& joints() const { return condensed_; }  ///< flags of those that (1) replaces
  const std::vector<int>& carriers() const { return carriers_; }  ///< nodes that do not follow
  int row(int unknown) const { return rows_[unknown]; }           ///< of an unknown of Δ in y, or none

  struct Follower {
    int node, carrier, parent, joint;  // the parent, at the other end of the joint, may follow itself
    int first_row;                     // of the joint's multipliers
    FrameD X, X_inverse;               // from the carrier
    FrameD parent_inverse;             // X⁻¹ from the parent
  };
  const std::vector<Follower>& followers() const { return followers_; }  ///< parents first

  /// Where the freedoms of a node are: from `row` of y on, seen from the node; none if it rests.
  struct Place {
    int row;
    FrameD to_carrier;  ///< X⁻¹
  };
  Place place_of(int node) const;

  /// Tᵀ S T.
  Eigen::SparseMatrix<double> reduce(const Eigen::SparseMatrix<double>& S) const;
  /// y := Tᵀ b; `b` is scratch afterwards.
  void condense(VectorXd& b, VectorXd& y) const;
  /// dx := T y.
  void expand(const VectorXd& y, VectorXd& dx) const;

  /// Frames of all that follow, (1).
  void place(std::vector<FrameD>& frames) const;

  /// The multipliers of (3) in this state.
  void recover_multipliers(StateD& state, const assembly::LoadsIn<D>& loads) const;

 private:
  static constexpr int n = geometry::freedoms<D>;
  /// Unknowns that keep their neighbours.
  struct Piece {
    int from, to, count;
  };

  void find_followers();
  void collect_followers(int carrier, std::vector<bool>& seen);
  void number_unknowns();

  const SystemD& system_;
  std::vector<bool> condensed_;
  std::vector<int> carriers_, rows_;
  std::vector<Follower> followers_;
  std::vector<Piece> pieces_;
  int n_unknowns_ = 0;
};

}  // namespace flexarm::integrators
