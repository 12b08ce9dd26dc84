/// How closures become constraints. One with a mount or a bearing gets hinges without mass on its side a:
///
///     link a -- mount -- pin -- link b
///
/// The pin turns about the axis of the closure, or slides along it, on the laws of its bearing. What else the
/// closure leaves free lies between pin and b: a revolute closure behind the pin of a cylindrical one.
/// Without a bearing the closure itself ties b to the mount.
#include "flexarm/assembly/system.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {

using namespace geometry;
using joints::ClosureType;

void System::place_closures() {
  struct Side {
    int link = -1, node = joints::ClosureConstraint::ground;
    Frame X;
  };
  const auto side = [&](const std::string& name, bool at_end, const Frame& origin) {
    if (name == "base") return Side{-1, pedestal_.node, origin};
    const Place at = place(name, at_end);
    const auto* beam = std::get_if<model::BeamLink>(&arm_.links[at.link]);
    if (at_end && beam == nullptr) throw InvalidParameter("only a beam has an end, '" + name + "' is none");
    const Vector3d position = origin.x + (at_end ? beam->end : Vector3d::Zero().eval());
    const Attachment on = attach(meshes_[at.link], position, true, at.node);
    return Side{at.link, on.node, on.offset * Frame::rotation(origin.R)};
  };
  std::size_t first_hinge = hinges_.size();
  for (const model::Closure& closure : arm_.closures) first_hinge -= closure.hinges().size();
  for (const model::Closure& closure : arm_.closures) {
    try {
      const Side a = side(closure.a, closure.a_at_end, closure.a_origin);
      const Side b = side(closure.b, closure.b_at_end, closure.b_origin);
      if (a.link == b.link) throw InvalidParameter("both ends are on one link, which closes no loop");
      if (closure.type == ClosureType::point_on_beam) {
        const LinkMesh* mesh = a.link < 0 ? nullptr : &meshes_[a.link];
        if (mesh == nullptr || !mesh->is_beam() || closure.a_at_end || !(closure.a_origin == Frame{}))
          throw InvalidParameter("a point slides along a whole beam: a must be one, without origin or end");
        const joints::ClosureConstraint straight{ClosureType::point_on_line, a.node, a.X,   b.node, b.X,
                                                 mesh->R_LS.col(0),          {},     reach_};
        const auto first = beams_.begin() + mesh->first_element;
        rigid_closures_.add(closure.name, straight);
        closures_.add(closure.name, straight, BeamSlide({first, first + mesh->n_nodes() - 1}, b.node, b.X.x));
        loop_ends_.emplace_back(a.link, b.link);
        hinges_of_closures_.push_back(first_hinge);
        continue;
      }
      const auto constraint = [&](ClosureType type, int node, const Frame& X) {
        return joints::ClosureConstraint{type,  node, X, b.node, b.X, closure.axis, closure.second_axis,
                                         reach_};
      };
      rigid_closures_.add(closure.name, constraint(closure.type, a.node, a.X));
      loop_ends_.emplace_back(a.link, b.link);
      const bool has_pin = !closure.bearing.empty();
      if (has_pin && !closure.pin())
        throw InvalidParameter("a bearing needs a closure that turns about its axis, or slides along it");
      const std::vector<model::Hinge> chain = closure.hinges();
      const int node = carry(chain, first_hinge, a.node, a.X, constraints_);
      closures_.add(closure.name, constraint(has_pin ? closure.pin()->rest : closure.type, node,
                                             chain.empty() ? a.X : Frame{}));
      hinges_of_closures_.push_back(first_hinge);
      first_hinge += chain.size();
      for (std::size_t k = 0; k < chain.size(); ++k)
        n_constraints_ += constraints_[constraints_.size() - 1 - k].rows();
    } catch (const InvalidParameter& mistake) {
      throw InvalidParameter("closure '" + closure.name + "': " + mistake.what());
    }
  }
  n_constraints_ += closures_.rows();
}

/// Mounts are undeflected; the pin of a bearing stands as b does about the axis, or along it.
void System::place_hinges_of_closures(State& state) const {
  for (std::size_t k = 0; k < rigid_closures_.size(); ++k) {
    const model::Closure& closure = arm_.closures[k];
    const joints::ClosureConstraint& constraint = rigid_closures_[k];
    const Frame &H_a = frame(state, constraint.node_a()), &H_b = frame(state, constraint.node_b());
    const Frame A = constraint.frame_at_a(H_a);
    const auto* hinge = hinges_.data() + hinges_of_closures_[k];
    for (std::size_t i = 0; i < closure.mount.size(); ++i) state.frames[(hinge++)->node] = A;
    if (closure.bearing.empty()) continue;
    const joints::JointType motion = closure.pin()->motion;
    state.s[hinge->theta] = motion == joints::JointType::revolute
                                ? constraint.hinge_angle(H_a, H_b)
                                : (A.R * closure.axis.normalized()).dot(constraint.place_on_b(H_b) - A.x);
    state.frames[hinge->node] = A * exp6(state.s[hinge->theta] * joints::motion_twist(motion, closure.axis));
  }
}

}  // namespace flexarm::assembly
