#include "flexarm/simulation/recorder.hpp"

#include "flexarm/simulation/energy.hpp"
#include "flexarm/simulation/reactions.hpp"

namespace flexarm::simulation {
namespace {

void resize(Eigen::Index n, std::initializer_list<std::pair<Eigen::MatrixXd*, Eigen::Index>> columns) {
  for (auto [matrix, rows] : columns) matrix->resize(rows, n);
}

}  // namespace

Recorder::Recorder(const System& system, const TransientOptions& options, Eigen::Index n, Transient& out)
    : system_(system), options_(options), out_(out) {
  const auto p = static_cast<Eigen::Index>(system.points().size());
  const auto j = static_cast<Eigen::Index>(system.joints().size());
  const auto l = static_cast<Eigen::Index>(system.meshes().size());
  out.time.resize(n);
  if (options.record_points) resize(n, {{&out.position, 3 * p}, {&out.velocity, 3 * p}});
  if (options.record_rotations) resize(n, {{&out.orientation, 4 * p}, {&out.angular_rate, 3 * p}});
  if (options.record_joints) {
    resize(n, {{&out.joint_angle, j}, {&out.joint_rate, j}, {&out.drive_angle, j}, {&out.drive_rate, j}});
    resize(n, {{&out.joint_torque, j}, {&out.motor_torque, j}});
  }
  if (options.record_energies) {
    for (auto* column : {&out.kinetic, &out.elastic, &out.gravity, &out.damped, &out.work})
      column->setZero(n);
  }
  if (options.record_forces) resize(n, {{&out.section_forces, 12 * l}, {&out.base_wrench, 6}});
}

void Recorder::record(Eigen::Index k, const State& state, const Loads& loads) {
  out_.time[k] = state.t;
  if (options_.record_points || options_.record_rotations) points(k, state);
  if (options_.record_joints) joints(k, state);
  if (options_.record_energies) energy(k, state, loads);
  if (options_.record_forces) forces(k, state, loads);
}

void Recorder::points(Eigen::Index k, const State& state) {
  for (int p = 0; p < static_cast<int>(system_.points().size()); ++p) {
    const geometry::Frame H = system_.point_frame(state, p);
    const geometry::Vector6d v = system_.point_velocity(state, p);
    if (options_.record_points) {
      out_.position.col(k).segment<3>(3 * p) = H.x;
      out_.velocity.col(k).segment<3>(3 * p) = H.R * v.head<3>();
    }
    if (options_.record_rotations) {
      out_.orientation.col(k).segment<4>(4 * p) = Eigen::Quaterniond(H.R).normalized().coeffs();
      out_.angular_rate.col(k).segment<3>(3 * p) = v.tail<3>();
    }
  }
}

void Recorder::joints(Eigen::Index k, const State& state) {
  const Eigen::VectorXd motor = motor_torques(system_, state, true);
  for (int j = 0; j < static_cast<int>(system_.joints().size()); ++j) {
    const int theta = system_.joints()[j].theta, phi = system_.joints()[j].phi;
    const auto rate = [&](int s) { return s < 0 ? 0.0 : state.v[system_.scalar_offset() + s]; };
    const auto angle = [&](int s) { return s < 0 ? 0.0 : state.s[s]; };
    out_.joint_angle(j, k) = angle(theta);
    out_.joint_rate(j, k) = rate(theta);
    out_.drive_angle(j, k) = angle(phi);
    out_.drive_rate(j, k) = rate(phi);
    out_.joint_torque(j, k) = joint_torque(system_, state, j);
    out_.motor_torque(j, k) = motor[j];
  }
}

void Recorder::forces(Eigen::Index k, const State& state, const Loads& loads) {
  for (int link = 0; link < static_cast<int>(system_.meshes().size()); ++link) {
    const SectionForces f = section_forces(system_, state, loads, link);
    out_.section_forces.col(k).segment<12>(12 * link) << f.start, f.end;
  }
  out_.base_wrench.col(k) = base_wrench(system_, state);
}

/// Equation (1).
void Recorder::energy(Eigen::Index k, const State& state, const Loads& loads) {
  const Energies E = energies(system_, state, loads);
  out_.kinetic[k] = E.kinetic;
  out_.elastic[k] = E.elastic;
  out_.gravity[k] = E.gravity;
  Instant now{link_dissipation(system_, state),
              load_power(system_, state, loads) + bow_power(system_, state),
              law_losses(system_, state),
              motor_torques(system_, state, true),
              state.s,
              state.t};
  if (k > 0) {
    const double h = now.t - last_.t;
    double damped = 0.5 * h * (now.dissipation + last_.dissipation);
    double work = 0.5 * h * (now.power + last_.power);
    for (std::size_t i = 0; i < system_.laws().size(); ++i) {
      const double dx =
          system_.deflection(system_.laws()[i], now.s) - system_.deflection(system_.laws()[i], last_.s);
      damped += 0.5 * dx * (now.loss[i] + last_.loss[i]);
    }
    for (std::size_t j = 0; j < system_.joints().size(); ++j) {
      const int phi = system_.joints()[j].phi;
      if (phi >= 0) work += 0.5 * (now.s[phi] - last_.s[phi]) * (now.motor[j] + last_.motor[j]);
    }
    if (const int theta = system_.pedestal().theta; theta >= 0) {
      const auto& pedestal = *system_.arm().pedestal;
      work += 0.5 * (now.s[theta] - last_.s[theta]) * (pedestal.moment(now.t) + pedestal.moment(last_.t));
    }
    out_.damped[k] = out_.damped[k - 1] + damped;
    out_.work[k] = out_.work[k - 1] + work;
  }
  last_ = std::move(now);
}

}  // namespace flexarm::simulation
