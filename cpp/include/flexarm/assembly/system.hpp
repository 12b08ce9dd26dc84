/// @file
/// An arm, assembled in space: what assembly/equations.hpp needs, made from the model.
#pragma once

#include <map>

#include "flexarm/assembly/equations.hpp"

namespace flexarm::assembly {

class System : public SystemIn<3> {
 public:
  /// @throws InvalidParameter naming what does not fit.
  System(const model::Arm& arm, const std::map<std::string, DriveKind>& drives);

  const model::Arm& arm() const { return arm_; }
  int joint_index(const std::string& name) const;  ///< @throws InvalidParameter listing the joints there are
  int point_index(const std::string& name) const;

  /// The undeformed arm at these joint values (one a joint), at rest. Free joints of loops follow the others.
  /// @throws InvalidParameter if a loop cannot be closed there, or nothing tells where its joints are.
  State rigid_state(const std::vector<double>& joint_values) const;
  /// The same without closing loops.
  State open_state(const std::vector<double>& joint_values) const;

  /// Takes the conditions of closures that count in a model whose closures are nearly the same.
  /// @throws InvalidParameter if it has others
  void count_closures_as(const System& nominal);

  bool in_loop(int joint) const { return in_loop_[joint]; }  ///< or coupled by gears to one that is
  /// Joint values at which the loops were closed first.
  const std::vector<double>& assembled() const { return assembled_; }
  /// Those of `candidates`, in their order, that have to be held so that loops whose joints `held` stand
  /// still cannot move.
  std::vector<int> joints_to_hold(const std::vector<int>& held, const std::vector<int>& candidates) const;

 private:
  void mesh_links(const std::vector<std::vector<double>>& occupied);
  void place_scalars(const std::map<std::string, DriveKind>& drives);
  void place_superelements();
  void place_joints();
  std::vector<std::vector<model::Hinge>> hinge_chains() const;
  /// Puts constraints of a chain of hinges from a frame on a node; returns the node that it carries.
  int carry(const std::vector<model::Hinge>& chain, std::size_t first_hinge, int node, Frame X,
            std::vector<joints::JointConstraint>& into) const;
  void place_gears();
  void place_transmissions();
  void place_masses();
  void place_closures();
  void place_hinges_of_closures(State& state) const;
  void close_loops();
  std::vector<int> chain_to(int link) const;  // joints from a link to the base
  VectorXd loop_residual(const std::vector<double>& joint_values) const;
  MatrixXd loop_jacobian(const std::vector<double>& joint_values, const std::vector<int>& unknowns) const;
  bool axes_agree(const std::vector<double>& joint_values) const;
  struct Closed {
    std::vector<double> values;
    bool met = false;
  };
  Closed newton(std::vector<double> values, const std::vector<int>& unknowns) const;
  Closed search(const std::vector<double>& values, const std::vector<int>& unknowns) const;
  std::vector<double> closed(const std::vector<double>& joint_values) const;
  MatrixXd held_by_others(const State& state, bool all_joints) const;
  [[noreturn]] void refuse(const std::vector<double>& nearest, const std::vector<int>& unknowns) const;
  void set_damping();
  void set_bows();
  void place_state_loads();
  /// @throws InvalidParameter unless the joint has such a state.
  PlacedTable placed(const model::StateTable& table) const;
  int link_index(const std::string& name) const;
  /// @throws InvalidParameter if there is no such link or interface, or the interface is not named.
  Place place(const std::string& name, bool at_end = false) const;
  int node(const Place& place) const { return meshes_[place.link].first_node + place.node; }
  Frame axes(const Place& place) const { return meshes_[place.link].place_axes(place.node); }

  model::Arm arm_;
  LoopClosures rigid_closures_;                  // of the undeformed arm: from link to link
  std::vector<std::pair<int, int>> loop_ends_;   // links a and b of the closures, −1: the base
  std::vector<std::size_t> hinges_of_closures_;  // the first of each closure
  std::vector<bool> in_loop_;                    // one a joint
  std::vector<double> assembled_;
};

}  // namespace flexarm::assembly
