/// @file
/// Arms of one structure, laid out for the code that steps them side by side (lanes/numbers.hpp).
#pragma once

#include <memory>
#include <vector>

#include "flexarm/assembly/equations.hpp"
#include "flexarm/integrators/rigid_joint_condensation.hpp"
#include "flexarm/lanes/numbers.hpp"
#include "flexarm/lanes/rows.hpp"
#include "flexarm/lanes/turn_numbers.hpp"
#include "flexarm/linear_solvers/dissected_inverse.hpp"

namespace flexarm::lanes {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;

/// Whether an arm can step beside others of its structure: it has beams, rigid bodies and joints in a tree.
/// @param consistent whether forces are to be those of simulation/consistent_forces.hpp
template <int D>
bool suits(const SystemIn<D>& arm, const LoadsIn<D>& loads, bool consistent);

/// Whether the force of a law follows from its deflection and rate by three numbers.
bool has_three_numbers(const assembly::PlacedLaw& law);

/// Whether two arms differ in numbers only.
template <int D>
bool same_structure(const SystemIn<D>& one, const SystemIn<D>& other);

template <int D>
class ArmNumbersIn {
 public:
  /// @param arms of one structure, which suit; fewer than lanes leave the last lanes with those of the first.
  ArmNumbersIn(const std::vector<const SystemIn<D>*>& arms, const std::vector<LoadsIn<D>>& loads, int lanes);

  const Arms& arms() const { return arms_; }
  const integrators::RigidJointCondensationIn<D>& condensation(int lane) const {
    return *condensation_[static_cast<std::size_t>(lane)];
  }

  /// Rest strains of a lane's beams whose bow grows, at t [s].
  void grow_bows(int lane, const SystemIn<D>& arm, double t);

  /// @param inverse null: there is none. @return false if it is not cut as those of the lanes before
  bool set_inverse(int lane, const linear_solvers::DissectedInverse* inverse);

  const std::vector<int>& unknowns() const { return unknowns_; }  ///< that steps solve for

  using Update = integrators::WoodburyUpdateIn<D>;
  /// What turned joints change in the inverse that was set last.
  void set_turns(int lane, const Update& update);

  /// W of turned joints and laws, whose forces are found lane by lane.
  void set_by_forces(int lane, const Eigen::MatrixXd& W);

  /// @param change of accelerations of free scalar coordinates, of multipliers and of Uᵀ x by Φ''
  /// @param W of the first two
  void set_consistent(int lane, const Eigen::MatrixXd& change, const Update& update,
                      const Eigen::MatrixXd& W);

 private:
  void lay_out(const SystemIn<D>& arm);
  void place_points(const std::vector<const SystemIn<D>*>& arms);
  void fill(int lane, const SystemIn<D>& arm, const LoadsIn<D>& loads);
  void fill_sections(int lane, const SystemIn<D>& arm);
  void set_order(std::vector<int> order);
  bool cut_as(const linear_solvers::DissectedInverse& inverse) const;
  void cut(const linear_solvers::DissectedInverse& inverse);

  int lanes_;
  std::vector<std::unique_ptr<integrators::RigidJointCondensationIn<D>>> condensation_;
  std::vector<int> beam_nodes_, body_nodes_, carriers_, section_nodes_;
  std::vector<JointPlace> joints_;
  std::vector<GearPlace> gears_;
  std::vector<LawPlace> laws_;
  std::vector<FollowerPlace> followers_;
  std::vector<JointOutput> outputs_;
  std::vector<PointPlace> points_;
  Rows beams_, bodies_, weights_, gravity_, joint_numbers_, gear_numbers_, law_numbers_, scalar_inertia_,
      follower_frames_, reach_, mass_scale_, point_offsets_, sections_, consistent_, by_forces_;

  bool is_first_ = true;  // of the inverses to be set: all others are to be cut as it is
  std::vector<int> unknowns_;
  std::vector<int> cut_order_, order_;  // of `unknowns_`, and of all
  std::vector<std::vector<int>> boundaries_;
  std::vector<Rows> inverses_, from_boundaries_;
  std::vector<InversePart> parts_;
  Rows separator_;
  TurnNumbersIn<D> turns_, consistent_turns_;
  Arms arms_{};
};

}  // namespace flexarm::lanes
