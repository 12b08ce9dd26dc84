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

  /// The undeformed arm at these joint values (one a joint), at rest.
  State rigid_state(const std::vector<double>& joint_values) const;

 private:
  void mesh_links(const std::vector<std::vector<double>>& occupied);
  void place_scalars(const std::map<std::string, DriveKind>& drives);
  void place_superelements();
  void place_joints();
  std::vector<const std::vector<model::Hinge>*> hinge_chains() const;
  void place_gears();
  void place_transmissions();
  void place_masses();
  void set_damping();
  void set_bows();
  int link_index(const std::string& name) const;
  /// @throws InvalidParameter if there is no such link or interface, or the interface is not named.
  Place place(const std::string& name, bool at_end = false) const;
  int node(const Place& place) const { return meshes_[place.link].first_node + place.node; }
  Frame axes(const Place& place) const { return meshes_[place.link].place_axes(place.node); }

  model::Arm arm_;
};

}  // namespace flexarm::assembly
