#include "flexarm/simulation/recorder.hpp"

#include "flexarm/simulation/energy.hpp"
#include "flexarm/simulation/reactions.hpp"

namespace flexarm::simulation {
namespace {

void resize(Eigen::Index n, std::initializer_list<std::pair<Eigen::MatrixXd*, Eigen::Index>> columns) {
  for (auto [matrix, rows] : columns) matrix->resize(rows, n);
}

}  // namespace

template <int D>
RecorderIn<D>::RecorderIn(const SystemIn<D>& system, const TransientOptions& options, Eigen::Index n,
                          Transient& out, const InSpace<D>& space)
    : system_(system), space_(space), options_(options), out_(out), forces_(system) {
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
    for (auto* column : {&out.kinetic, &out.elastic, &out.gravity, &out.damped, &out.work}) column->resize(n);
  }
  if (options.record_forces) resize(n, {{&out.section_forces, 12 * l}, {&out.base_wrench, 6}});
  now_.drives.resize(system.n_scalars());
  last_.drives.resize(system.n_scalars());
}

template <int D>
void RecorderIn<D>::record(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads) {
  write(k, options_.has_consistent_forces() ? forces_.of(state, &loads) : state, loads);
}

template <int D>
void RecorderIn<D>::write(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads) {
  out_.time[k] = state.t;
  system_.scalar_residual(state, true, now_.drives);
  if (options_.record_points || options_.record_rotations) points(k, state);
  if (options_.record_joints) joints(k, state);
  if (options_.record_energies) energy(k, state, loads);
  if (options_.record_forces) forces(k, state, loads);
}

template <int D>
void RecorderIn<D>::points(Eigen::Index k, const StateIn<D>& state) {
  for (int p = 0; p < static_cast<int>(system_.points().size()); ++p) {
    const FrameIn<D> H = system_.point_frame(state, p);
    const Twist<D> v = system_.point_velocity(state, p);
    if (options_.record_points) {
      out_.position.col(k).segment<3>(3 * p) = space_.place(p, H.x);
      out_.velocity.col(k).segment<3>(3 * p) = space_.arrow(H.R * v.template head<D>());
    }
    if (options_.record_rotations) {
      const Matrix3d R = space_.orientation(p, H.R);
      out_.orientation.col(k).segment<4>(4 * p) = Eigen::Quaterniond(R).normalized().coeffs();
      out_.angular_rate.col(k).segment<3>(3 * p) =
          space_.spin_at_point(p, v.template tail<geometry::turns<D>>());
    }
  }
}

template <int D>
void RecorderIn<D>::joints(Eigen::Index k, const StateIn<D>& state) {
  const double* rates = state.v.data() + system_.scalar_offset();
  int row = 0;
  for (int j = 0; j < static_cast<int>(system_.joints().size()); ++j) {
    const int theta = system_.joints()[j].theta, phi = system_.joints()[j].phi;
    const auto& constraint = system_.constraints()[j];
    const bool moves = theta >= 0;
    out_.joint_angle(j, k) = moves ? state.s[theta] : 0.0;
    out_.joint_rate(j, k) = moves ? rates[theta] : 0.0;
    out_.drive_angle(j, k) = moves ? state.s[phi] : 0.0;
    out_.drive_rate(j, k) = moves ? rates[phi] : 0.0;
    out_.motor_torque(j, k) = moves ? now_.drives[phi] : 0.0;
    out_.joint_torque(j, k) =
        moves ? -constraint.twist().dot(state.multipliers.template segment<geometry::freedoms<D>>(row)) : 0.0;
    row += constraint.rows();
  }
}

template <int D>
void RecorderIn<D>::forces(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads) {
  for (int link = 0; link < static_cast<int>(system_.meshes().size()); ++link) {
    const SectionForces f = section_forces(system_, state, loads, link, space_);
    out_.section_forces.col(k).template segment<12>(12 * link) << f.start, f.end;
  }
  out_.base_wrench.col(k) = base_wrench(system_, state, space_);
}

/// Equation (1).
template <int D>
void RecorderIn<D>::energy(Eigen::Index k, const StateIn<D>& state, const LoadsIn<D>& loads) {
  const Energies E = energies(system_, state, loads);
  out_.kinetic[k] = E.kinetic;
  out_.elastic[k] = E.elastic;
  out_.gravity[k] = E.gravity;
  now_.dissipation = E.dissipation;
  now_.in_passage = E.in_passage;
  now_.power = load_power(system_, state, loads) + E.bow_power + E.table_power;
  law_losses(system_, state, now_.loss);
  now_.s = state.s;
  now_.t = state.t;
  out_.damped[k] = out_.work[k] = 0;
  if (k > 0) {
    const double h = now_.t - last_.t;
    double damped = 0.5 * h * (now_.dissipation + last_.dissipation) - (now_.in_passage - last_.in_passage);
    double work = 0.5 * h * (now_.power + last_.power);
    for (std::size_t i = 0; i < system_.laws().size(); ++i) {
      const auto& law = system_.laws()[i];
      const double dx = system_.deflection(law, now_.s) - system_.deflection(law, last_.s);
      damped += 0.5 * dx * (now_.loss[i] + last_.loss[i]);
    }
    for (const auto& joint : system_.joints()) {
      if (joint.phi < 0) continue;
      const double turned = now_.s[joint.phi] - last_.s[joint.phi];
      work += 0.5 * turned * (now_.drives[joint.phi] + last_.drives[joint.phi]);
    }
    const auto& pedestal = system_.pedestal();
    for (std::size_t i = 0; i < pedestal.thetas.size(); ++i) {
      const double turned = now_.s[pedestal.thetas[i]] - last_.s[pedestal.thetas[i]];
      work += 0.5 * turned * (pedestal.moment(i, now_.t) + pedestal.moment(i, last_.t));
    }
    out_.damped[k] = out_.damped[k - 1] + damped;
    out_.work[k] = out_.work[k - 1] + work;
  }
  std::swap(last_, now_);
}

template class RecorderIn<2>;
template class RecorderIn<3>;

}  // namespace flexarm::simulation
