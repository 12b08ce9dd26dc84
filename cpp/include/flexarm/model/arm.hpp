/// @file
/// What an arm is: a tree of links on joints, closures of loops between them, payloads and points of
/// interest. Plain data in SI units.
///
/// Every link has a frame. At joint values zero it coincides with the frame of the joint that carries it,
/// which sits at `origin` from the parent link's frame (or from the frame at the far end of a beam, parallel
/// to it). A revolute joint turns about its axis, a prismatic one slides along it. "base" is the frame of the
/// ground. Joints meet a super-element at its interfaces, whose frames then take the place of the link's:
/// "hub:output" is interface "output" of link "hub".
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "flexarm/geometry/se3.hpp"
#include "flexarm/joints/closure_constraint.hpp"
#include "flexarm/joints/drive_train.hpp"
#include "flexarm/joints/joint_constraint.hpp"
#include "flexarm/model/section.hpp"

namespace flexarm::model {

using Eigen::Matrix3d;
using Eigen::Vector3d;

enum class BeamTheory {
  timoshenko,       ///< shear and rotary inertia
  euler_bernoulli,  ///< neither; the section keeps its inertia against twist
};

/// What a table of a joint's state gives, in a direction.
struct StateTable {
  std::string joint;
  joints::Of of = joints::Of::angle;  ///< angle θ, its rate, or motor_angle φ
  joints::ChangingTable table;
  Vector3d direction = Vector3d::Zero();

  bool operator==(const StateTable&) const = default;
};

/// A straight beam from the link's origin to `end`.
struct BeamLink {
  std::string name;
  Vector3d end;                    ///< far end in the link's frame [m]
  Vector3d up = Vector3d::Zero();  ///< section z is its part normal to the beam; zero: any
  Section section;
  Material material;
  BeamTheory theory = BeamTheory::timoshenko;
  int elements = 4;
  double damping_ratio = 0;         ///< of the link alone, clamped, in its first mode [-]
  double bending_scale = 1;         ///< on EI, both planes [-]
  double mass_scale = 1;            ///< on ρA and ρI [-]
  Vector3d bow = Vector3d::Zero();  ///< unloaded tip from `end`, uniform curvature, link axes [m]
  double bow_time = 0;  ///< it grows as 1 − exp(−t/bow_time) from the start of a run [s]; 0: is there
  /// Curvature without stress [1/m]; the tip bends towards the part of the direction across, link axes.
  std::optional<StateTable> curvature = {};
};

/// A rigid body.
struct RigidLink {
  std::string name;
  double mass = 0;                      ///< [kg]
  Vector3d com = Vector3d::Zero();      ///< centre of mass in the link's frame [m]
  Matrix3d inertia = Matrix3d::Zero();  ///< about the centre of mass, in the link's axes [kg m²]
};

/// A part reduced to its interfaces and some internal modes. Freedoms: of each interface three translations
/// and three rotations in the link's axes, then the modes.
struct SuperElementLink {
  std::string name;
  std::vector<std::string> interfaces;  ///< their names
  std::vector<geometry::Frame> frames;  ///< their places in the link's frame
  Eigen::MatrixXd stiffness, mass;      ///< SI
  Eigen::MatrixXd damping;              ///< SI; no entries: none
  double damping_ratio = 0;             ///< if positive, instead of `damping`; see SuperElement [-]
};

using Link = std::variant<BeamLink, RigidLink, SuperElementLink>;

inline const std::string& name_of(const Link& link) {
  return std::visit([](const auto& l) -> const std::string& { return l.name; }, link);
}

/// A concentrated mass with its own inertia, fixed to the section at its projection on the beam's axis, or to
/// an interface of a super-element.
struct Payload {
  std::string name, link;
  Vector3d position = Vector3d::Zero();  ///< in the link's frame, or the interface's [m]
  double mass = 0;                       ///< [kg]
  Matrix3d inertia = Matrix3d::Zero();   ///< about its own centre, in the link's axes [kg m²]
  Vector3d offset = Vector3d::Zero();    ///< of the centre from `position`, turning with the section [m]
  std::optional<StateTable> force = {};  ///< at the centre, along a direction in the base's axes [N]
};

/// A place to look at, or to push at.
struct Point {
  std::string name, link;
  Vector3d position = Vector3d::Zero();  ///< in the link's frame [m]
  bool loaded = false;                   ///< carries point loads: gets a node of its own
};

/// A hinge that nothing drives, without mass: on a spring and a damper, or on laws or a table instead. A
/// prismatic one gives along its axis.
struct Hinge {
  Vector3d axis = Vector3d::UnitZ();
  double stiffness = 0, damping = 0;  ///< [N m/rad], [N m s/rad]; [N/m], [N s/m]
  joints::JointType type = joints::JointType::revolute;
  joints::DriveTrain::Parallel laws = {};
  std::optional<StateTable> follows = {};  ///< angle about the axis [rad], on a nearly rigid spring
};

struct Joint {
  std::string name;
  joints::JointType type = joints::JointType::revolute;
  std::string parent = "base", child;
  bool at_end = false;  ///< origin counts from the far end of the parent beam
  geometry::Frame origin;
  Vector3d axis = Vector3d::UnitZ();
  joints::DriveTrain drive_train;
  std::vector<Hinge> mount = {};  ///< between parent and joint, one behind the other; axes in its frame
};

/// θ_input = ratio φ_output, φ = θ where the output's drive train is rigid.
struct Gear {
  std::string name, input, output;
  double ratio = 1;
};

/// A base that turns on hinges through its origin, one behind the other; without mass. A moment
/// A sin(2π f t + p) about an axis can shake it, at the times t of a run; it has no part in statics.
struct Pedestal {
  std::vector<Hinge> hinges;
  Vector3d axis = Vector3d::UnitZ();               ///< of the moment
  double amplitude = 0, frequency = 0, phase = 0;  ///< A [N m], f [Hz], p [rad]

  double moment(double t) const { return amplitude * std::sin(2 * std::numbers::pi * frequency * t + phase); }
};

/// Closes a loop: a condition between a place on link a and one on link b, either of which may be "base". A
/// place sits on a beam's section at its projection on the axis, as a payload does.
struct Closure {
  std::string name;
  joints::ClosureType type = joints::ClosureType::revolute;
  std::string a, b;
  bool a_at_end = false, b_at_end = false;  ///< origin counts from the far end of the beam
  geometry::Frame a_origin, b_origin;
  Vector3d axis = Vector3d::UnitZ();          ///< in the frame at a
  Vector3d second_axis = Vector3d::UnitX();   ///< of a universal closure, in the frame at b
  std::vector<Hinge> mount = {};              ///< between link a and the frame at a, axes in that frame
  joints::DriveTrain::Parallel bearing = {};  ///< on the turn of b about the axis, or its way along it

  /// How the pin of a bearing moves in a, and how b then sits on the pin; none where no axis is singled out.
  struct Pin {
    joints::JointType motion;
    joints::ClosureType rest;
  };
  std::optional<Pin> pin() const {
    using joints::ClosureType, joints::JointType;
    switch (type) {
      case ClosureType::revolute:
        return Pin{JointType::revolute, ClosureType::fixed};
      case ClosureType::prismatic:
        return Pin{JointType::prismatic, ClosureType::fixed};
      case ClosureType::cylindrical:
        return Pin{JointType::prismatic, ClosureType::revolute};
      case ClosureType::point_on_line:
        return Pin{JointType::prismatic, ClosureType::spherical};
      default:
        return {};
    }
  }

  /// The mount, and behind it the pin of a bearing.
  std::vector<Hinge> hinges() const {
    std::vector<Hinge> chain = mount;
    if (!bearing.empty() && pin()) chain.push_back({.axis = axis, .type = pin()->motion, .laws = bearing});
    return chain;
  }
};

struct Arm {
  std::string name;
  Vector3d gravity{0, 0, -9.81};  ///< [m/s²]
  std::vector<Link> links;
  std::vector<Joint> joints;
  std::vector<Payload> payloads;
  std::vector<Point> points;
  std::vector<Gear> gears;
  std::optional<Pedestal> pedestal;  ///< without one the base stands still
  std::vector<Closure> closures = {};
  std::map<std::string, double> assembly = {};  ///< joint values at which loops are closed first
};

}  // namespace flexarm::model
