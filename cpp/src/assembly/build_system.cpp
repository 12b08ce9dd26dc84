/// How a System comes to be: links become nodes and elements, masses find a node, names their things. Joints:
/// build_joints.cpp.
#include <algorithm>
#include <cmath>

#include "flexarm/assembly/system.hpp"
#include "flexarm/elements/clamped_mode.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {
namespace {

using namespace geometry;

template <class Things>
std::string names_of(const Things& things) {
  std::string all;
  for (const auto& thing : things) all += (all.empty() ? "" : ", ") + thing.name;
  return all.empty() ? "none" : all;
}

template <class Things>
int index_of(const Things& things, const std::string& name, const std::string& what) {
  for (std::size_t k = 0; k < things.size(); ++k) {
    if (things[k].name == name) return static_cast<int>(k);
  }
  throw InvalidParameter("there is no " + what + " '" + name + "'; there are: " + names_of(things));
}

/// A uniform curvature κ puts the tip κ L²/2 beside the axis and turns it by κ L; what lies along the axis is
/// a stretch. In the coordinates of a beam as long as the link.
Vector6d bow_strain(const Matrix3d& R_LS, const Vector3d& end, const Vector3d& bow) {
  const Vector3d tip = R_LS.transpose() * bow;
  const double L = end.norm();
  Vector6d strain;
  strain << tip.x(), 0, 0, 0, -2 * tip.z() / L, 2 * tip.y() / L;  // w' = −θy in the x-z plane
  return strain;
}

void check_bow(const model::BeamLink& beam) {
  if (!(beam.bow_time >= 0)) {
    throw InvalidParameter("link '" + beam.name +
                           "': the time constant of its bow must not be negative, got " +
                           std::to_string(beam.bow_time) + " s");
  }
}

template <class... Values>
void require_finite(const std::string& owner, const Values&... values) {
  const auto finite = [](const auto& value) {
    if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>) {
      return std::isfinite(value);
    } else {
      return value.allFinite();
    }
  };
  if (!(finite(values) && ...)) throw InvalidParameter(owner + ": all numbers must be finite");
}

struct RequireFinite {
  void operator()(const model::BeamLink& beam) const {
    const auto& [A, Iy, Iz, J, Ay, Az] = beam.section;  // shear areas may be infinite
    const auto& [E, G, rho] = beam.material;
    require_finite("link '" + beam.name + "'", beam.end, beam.up, A, Iy, Iz, J, E, G, rho, beam.damping_ratio,
                   beam.bending_scale, beam.mass_scale, beam.bow, beam.bow_time);
  }
  void operator()(const model::RigidLink& body) const {
    require_finite("link '" + body.name + "'", body.mass, body.com, body.inertia);
  }
  void operator()(const model::SuperElementLink& part) const {
    const std::string owner = "link '" + part.name + "'";
    require_finite(owner, part.stiffness, part.mass, part.damping, part.damping_ratio);
    for (const Frame& frame : part.frames) require_finite(owner, frame.R, frame.x);
  }
};

/// Laws check their own numbers.
void require_finite(const model::Arm& arm) {
  require_finite("arm '" + arm.name + "'", arm.gravity);
  for (const model::Link& link : arm.links) std::visit(RequireFinite{}, link);
  for (const auto& p : arm.payloads)
    require_finite("payload '" + p.name + "'", p.position, p.mass, p.inertia, p.offset);
  for (const auto& p : arm.points) require_finite("point '" + p.name + "'", p.position);
  for (const auto& j : arm.joints) {
    require_finite("joint '" + j.name + "'", j.origin.R, j.origin.x, j.axis, j.drive_train.gear_ratio,
                   j.drive_train.rotor_inertia);
    for (const auto& h : j.mount)
      require_finite("mount of joint '" + j.name + "'", h.axis, h.stiffness, h.damping);
  }
  for (const auto& g : arm.gears) require_finite("gear '" + g.name + "'", g.ratio);
  for (const auto& c : arm.closures) {
    require_finite("closure '" + c.name + "'", c.a_origin.R, c.a_origin.x, c.b_origin.R, c.b_origin.x, c.axis,
                   c.second_axis);
    for (const auto& h : c.mount)
      require_finite("mount of closure '" + c.name + "'", h.axis, h.stiffness, h.damping);
  }
  if (const auto& p = arm.pedestal) {
    require_finite("pedestal", p->axis, p->amplitude, p->frequency, p->phase);
    for (const auto& h : p->hinges) require_finite("pedestal", h.axis, h.stiffness, h.damping);
  }
}

}  // namespace

System::System(const model::Arm& arm, const std::map<std::string, DriveKind>& drives) : arm_(arm) {
  require_finite(arm_);
  std::vector<std::vector<double>> occupied(arm_.links.size());
  const auto occupy = [&](const std::string& link, const Vector3d& position) {
    const int k = link_index(link.substr(0, link.find(':')));
    if (const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k])) {
      const double L = beam->end.norm();
      occupied[k].push_back(std::clamp(beam->end.dot(position) / L, 0.0, L));
    }
  };
  for (const model::Payload& payload : arm_.payloads) occupy(payload.link, payload.position);
  for (const model::Point& point : arm_.points) {
    if (point.loaded) occupy(point.link, point.position);
  }
  for (const model::Closure& closure : arm_.closures) {
    const auto side = [&](const std::string& place, bool at_end, const Frame& origin) {
      if (place == "base" || place.find(':') != std::string::npos) return;
      const auto* beam = std::get_if<model::BeamLink>(&arm_.links[link_index(place)]);
      if (beam != nullptr) occupy(place, origin.x + (at_end ? beam->end : Vector3d::Zero().eval()));
    };
    side(closure.a, closure.a_at_end, closure.a_origin);
    side(closure.b, closure.b_at_end, closure.b_origin);
  }
  mesh_links(occupied);
  for (const auto& chain : hinge_chains()) {
    for (std::size_t k = 0; k < chain.size(); ++k) hinges_.push_back({n_nodes_++});
  }
  place_scalars(drives);
  place_joints();
  place_gears();
  place_transmissions();
  place_masses();
  place_closures();
  set_damping();  // of straight links
  set_bows();
  place_state_loads();
  pair_beams();
  for (const model::Point& point : arm_.points) {
    const Place at = place(point.link);
    points_.push_back(attach(meshes_[at.link], point.position, point.loaded, at.node));
  }
  close_loops();
}

void System::mesh_links(const std::vector<std::vector<double>>& occupied) {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    LinkMesh mesh;
    mesh.first_node = n_nodes_;
    mesh.first_element = static_cast<int>(beams_.size());
    if (const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k])) {
      if (!(beam->end.norm() > 0))
        throw InvalidParameter("link '" + beam->name + "': `end` must not be the origin");
      if (beam->elements < 1) {
        throw InvalidParameter("link '" + beam->name + "': elements must be at least 1, got " +
                               std::to_string(beam->elements));
      }
      beam->section.check();
      beam->material.check();
      mesh.R_LS = section_axes(beam->end, beam->up);
      mesh.stations = beam_stations(beam->end.norm(), beam->elements, occupied[k]);
      const auto properties = elements::BeamProperties::from(*beam);
      for (int e = 0; e + 1 < mesh.n_nodes(); ++e) {
        beams_.emplace_back(n_nodes_ + e, n_nodes_ + e + 1, mesh.node_frame(Frame{}, e),
                            mesh.node_frame(Frame{}, e + 1), properties);
      }
      reach_ += beam->end.norm();
    } else if (const auto* part = std::get_if<model::SuperElementLink>(&arm_.links[k])) {
      mesh.interfaces = part->frames;
      for (const Frame& frame : part->frames) reach_ += (frame.x - part->frames.front().x).norm();
    }
    n_nodes_ += mesh.n_nodes();
    meshes_.push_back(mesh);
  }
}

void System::place_masses() {
  weights_.resize(n_nodes_);
  for (const elements::BeamElement& beam : beams_) {
    const Vector3d along = Vector3d::UnitX() * beam.end_moment();
    weights_[beam.node1()].mass += beam.end_mass();
    weights_[beam.node1()].moment += along;
    weights_[beam.node2()].mass += beam.end_mass();
    weights_[beam.node2()].moment -= along;
  }
  for (const elements::SuperElement& part : superelements_) {
    const elements::Weight weight = part.weight();
    weights_[part.node(0)].mass += weight.mass;
    weights_[part.node(0)].moment += weight.moment;
  }
  std::map<int, elements::RigidBody> at_node;
  const auto add = [&](const Attachment& at, double mass, const Vector3d& com, const Matrix3d& inertia) {
    const Vector3d c = at.offset * com;
    at_node.try_emplace(at.node, at.node)
        .first->second.add(mass, c, at.offset.R * inertia * at.offset.R.transpose());
    weights_[at.node].mass += mass;
    weights_[at.node].moment += mass * c;
  };
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    if (const auto* body = std::get_if<model::RigidLink>(&arm_.links[k])) {
      add(attach(meshes_[k], Vector3d::Zero(), true), body->mass, body->com, body->inertia);
      reach_ += body->com.norm();
    }
  }
  for (const model::Payload& payload : arm_.payloads) {
    const Place at = place(payload.link);
    add(attach(meshes_[at.link], payload.position, true, at.node), payload.mass, payload.offset,
        payload.inertia);
  }
  for (const auto& [node, body] : at_node) bodies_.push_back(body);
  for (const elements::Weight& weight : weights_) mass_ += weight.mass;
  if (!(reach_ > 0)) reach_ = 1;
}

void System::set_damping() {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k]);
    if (beam == nullptr || beam->damping_ratio == 0) continue;
    if (!(beam->damping_ratio > 0 && beam->material.density > 0)) {
      throw InvalidParameter("link '" + beam->name +
                             "': a damping ratio must be positive and needs mass to act on, got " +
                             std::to_string(beam->damping_ratio) + " at a density of " +
                             std::to_string(beam->material.density) + " kg/m³");
    }
    const LinkMesh& mesh = meshes_[k];
    const double omega =
        elements::first_clamped_frequency(std::span(beams_).subspan(mesh.first_element, mesh.n_nodes() - 1));
    for (int e = 0; e + 1 < mesh.n_nodes(); ++e) {
      beams_[mesh.first_element + e].set_damping_time(2 * beam->damping_ratio / omega);
    }
  }
}

void System::set_bows() {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k]);
    if (beam == nullptr || beam->bow.isZero(0)) continue;
    check_bow(*beam);
    const LinkMesh& mesh = meshes_[k];
    const Vector6d strain = bow_strain(mesh.R_LS, beam->end, beam->bow);
    for (int e = mesh.first_element; e < mesh.first_element + mesh.n_nodes() - 1; ++e) {
      beams_[e].set_bow(beams_[e].length() / mesh.length() * strain, beam->bow_time);
    }
  }
}

PlacedTable System::placed(const model::StateTable& table) const {
  table.table.check();
  const JointCoordinates& at = joint_coordinates_[joint_index(table.joint)];
  if (at.theta < 0) throw InvalidParameter("joint '" + table.joint + "' does not move: it has no state");
  if (table.of == joints::Of::torque || table.of == joints::Of::across)
    throw InvalidParameter("a table at a place beside a joint is one of angle, rate or motor angle");
  return {table.table, table.of == joints::Of::motor_angle ? at.phi : at.theta, table.of == joints::Of::rate};
}

void System::place_state_loads() {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    const auto* beam = std::get_if<model::BeamLink>(&arm_.links[k]);
    if (beam == nullptr || !beam->curvature) continue;
    const LinkMesh& mesh = meshes_[k];
    const Vector3d along = mesh.R_LS.col(0), wanted = beam->curvature->direction;
    const Vector3d across = wanted - along * along.dot(wanted);
    if (!(across.norm() > 1e-6 * wanted.norm()))
      throw InvalidParameter("link '" + beam->name + "': a curvature needs a direction across the beam");
    const double L = mesh.length();
    const Vector6d strain = bow_strain(mesh.R_LS, beam->end, 0.5 * L * L * across.normalized());
    const PlacedTable table = placed(*beam->curvature);
    for (int e = mesh.first_element; e < mesh.first_element + mesh.n_nodes() - 1; ++e) {
      rest_strains_.push_back({table, static_cast<std::size_t>(e), beams_[e].length() / L * strain});
    }
  }
  for (const model::Payload& payload : arm_.payloads) {
    if (!payload.force) continue;
    const Place on = place(payload.link);
    const Attachment at = attach(meshes_[on.link], payload.position, true, on.node);
    state_forces_.push_back(
        {placed(*payload.force), at.node, at.offset * payload.offset, payload.force->direction});
  }
}

int System::joint_index(const std::string& name) const { return index_of(arm_.joints, name, "joint"); }
int System::point_index(const std::string& name) const { return index_of(arm_.points, name, "point"); }

int System::link_index(const std::string& name) const {
  for (std::size_t k = 0; k < arm_.links.size(); ++k) {
    if (model::name_of(arm_.links[k]) == name) return static_cast<int>(k);
  }
  throw InvalidParameter("there is no link '" + name + "'");
}

Place System::place(const std::string& name, bool at_end) const {
  const auto colon = name.find(':');
  const int link = link_index(name.substr(0, colon));
  const auto* part = std::get_if<model::SuperElementLink>(&arm_.links[link]);
  if (part == nullptr) {
    if (colon != std::string::npos)
      throw InvalidParameter("'" + name + "': only a super-element has interfaces");
    return {link, at_end ? meshes_[link].n_nodes() - 1 : 0};
  }
  const std::string wanted = colon == std::string::npos ? "" : name.substr(colon + 1);
  std::string known;
  for (std::size_t k = 0; k < part->interfaces.size(); ++k) {
    if (part->interfaces[k] == wanted) return {link, static_cast<int>(k)};
    known.append(known.empty() ? "" : ", ").append(part->interfaces[k]);
  }
  throw InvalidParameter("'" + name + "' must name an interface of the super-element, as in '" + part->name +
                         ":" + part->interfaces.front() + "'; there are: " + known);
}

}  // namespace flexarm::assembly
