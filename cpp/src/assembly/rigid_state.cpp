/// Where the undeformed arm stands at given values of its joints: link by link along the joints.
#include "flexarm/assembly/system.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {

using namespace geometry;

State System::rigid_state(const std::vector<double>& joint_values) const {
  return closures_.empty() ? open_state(joint_values) : open_state(closed(joint_values));
}

State System::open_state(const std::vector<double>& joint_values) const {
  if (joint_values.size() != arm_.joints.size()) {
    throw InvalidParameter("one value for each of the " + std::to_string(arm_.joints.size()) +
                           " joints is needed, got " + std::to_string(joint_values.size()));
  }
  State state;
  state.frames.resize(n_nodes_);
  state.s = VectorXd::Zero(n_scalars());
  state.v = state.v_dot = state.a = VectorXd::Zero(n_velocities());
  state.multipliers = VectorXd::Zero(n_constraints_);
  state.laws.resize(laws_.size());

  std::vector<double> theta = joint_values;
  for (std::size_t k = 0; k < theta.size(); ++k) {
    const JointCoordinates& at = joint_coordinates_[k];
    if (at.phi < 0) continue;
    state.s[at.phi] = joint_values[k];
    if (const joints::Transmission* psi = transmission(static_cast<int>(k))) {
      if (drives_[k] == DriveKind::link_angle) {
        state.s[at.phi] = psi->inverse(theta[k]);
      } else {
        theta[k] = (*psi)(joint_values[k]).psi;
      }
    }
    state.s[at.psi] = state.s[at.theta] = theta[k];
  }
  for (const PlacedLaw& law : laws_) {  // stages are listed from motor to link: no deflection in any
    if (law.minus >= 0) state.s[law.minus] = state.s[law.plus];
  }

  std::vector<std::size_t> first_hinge;  // of each joint's mount
  std::size_t next = pedestal_.thetas.size();
  for (const model::Joint& joint : arm_.joints) {
    first_hinge.push_back(next);
    next += joint.mount.size();
  }

  std::vector<bool> placed(arm_.links.size(), false);
  for (bool progress = true; progress;) {
    progress = false;
    for (std::size_t k = 0; k < arm_.joints.size(); ++k) {
      const model::Joint& joint = arm_.joints[k];
      const Place child = place(joint.child);
      if (placed[child.link]) continue;
      Frame A = joint.origin;  // a pedestal stands where the base does
      if (joint.parent != "base") {
        const Place parent = place(joint.parent, joint.at_end);
        if (!placed[parent.link]) continue;
        A = state.frames[node(parent)] * axes(parent) * joint.origin;
      }
      for (std::size_t i = 0; i < joint.mount.size(); ++i) {
        state.frames[hinges_[first_hinge[k] + i].node] = A;
      }
      const Frame B = A * exp6(theta[k] * joints::motion_twist(joint.type, joint.axis));
      const LinkMesh& mesh = meshes_[child.link];
      const Frame link = B * mesh.place_in_link(child.node).inverse();
      for (int i = 0; i < mesh.n_nodes(); ++i) state.frames[mesh.first_node + i] = mesh.node_frame(link, i);
      placed[child.link] = progress = true;
    }
  }
  for (std::size_t k = 0; k < placed.size(); ++k) {
    if (!placed[k])
      throw InvalidParameter("link '" + model::name_of(arm_.links[k]) +
                             "' is not connected to the base by joints");
  }
  place_hinges_of_closures(state);
  remember(state);
  return state;
}

}  // namespace flexarm::assembly
