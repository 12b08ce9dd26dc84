/// @file
/// Steps of arms side by side, in a plane or in space: integrators/hht.hpp with the equations of
/// assembly/equations.hpp, without a decision that depends on a lane. Included once for each kind of
/// processor.
#pragma once

#include <utility>

#include "flexarm/elements/beam_forces.hpp"
#include "flexarm/elements/beam_section.hpp"
#include "flexarm/elements/rigid_body.hpp"
#include "flexarm/elements/weight.hpp"
#include "flexarm/joints/joint_constraint.hpp"
#include "flexarm/lanes/gear_code.hpp"
#include "flexarm/lanes/numbers.hpp"
#include "flexarm/lanes/turn_code.hpp"
#include "flexarm/simd/pack.hpp"

namespace flexarm::lanes {

template <int D, int N, class Processor>
class KernelCode : TurnCode<D, N, Processor> {
  using Turning = TurnCode<D, N, Processor>;
  using Gears = GearCode<N, Processor>;
  using Turning::add, Turning::add_matrix, Turning::at, Turning::multiply, Turning::put, Turning::put_matrix;

 public:
  static constexpr Kernel kernel{N,
                                 &KernelCode::predict,
                                 &KernelCode::find_sides,
                                 &KernelCode::solve,
                                 &KernelCode::turn,
                                 &KernelCode::take_forces,
                                 &KernelCode::correct,
                                 &KernelCode::record};

 private:
  using Real = geometry::Pack<N, Processor>;
  using Frame = geometry::FrameIn<D, Real>;
  using Twist = geometry::Twist<D, Real>;
  using TwistMatrix = geometry::TwistMatrix<D, Real>;
  using Point = geometry::Point<D, Real>;
  using Joint = joints::JointFrames<D, Real>;
  static constexpr int n = geometry::freedoms<D>, frame_rows = lanes::frame_rows<D>;

  static Frame frame(const double* rows, int k) {
    return {matrix<geometry::Rotation<D, Real>>(rows, frame_rows * k),
            matrix<Point>(rows, frame_rows * k + D * D)};
  }
  static void put_frame(double* rows, int k, const Frame& H) {
    put_matrix(rows, frame_rows * k, H.R);
    put_matrix(rows, frame_rows * k + D * D, H.x);
  }

  static Joint joint(const Arms& arms, int k) {
    constexpr int rows = 3 * frame_rows + n + 2 * n * n;
    const double* own = arms.joint_numbers + N * rows * k;
    return {frame(own, 0),
            frame(own, 1),
            frame(own, 2),
            matrix<Twist>(own, 3 * frame_rows),
            matrix<TwistMatrix>(own, 3 * frame_rows + n),
            matrix<TwistMatrix>(own, 3 * frame_rows + n + n * n)};
  }

  [[gnu::flatten]] static void place(const Arms& arms, Motion& motion) {
    for (int i = 0; i < arms.n_carriers; ++i) {
      const int k = arms.carriers[i];
      const Frame H = frame(motion.frames_before, k) *
                      geometry::exponential<D, Real>(matrix<Twist>(motion.exponent, n * k));
      put_frame(motion.frames, k, H);
    }
    for (int i = 0; i < arms.n_followers; ++i) {
      const auto [node, carrier] = arms.followers[i];
      const Frame X = frame(arms.follower_frames, 2 * i);
      put_frame(motion.frames, node, carrier < 0 ? X : frame(motion.frames, carrier) * X);
    }
    for (int k = 0; k < arms.n_free_scalars; ++k) {
      put(motion.s, k, at(motion.s_before, k) + at(motion.exponent, n * arms.n_nodes + k));
    }
  }

  [[gnu::flatten]] static void predict(const Arms& arms, Motion& motion, const Step& step,
                                       const Drive& drive) {
    const double h = step.h, h2_a = h * h * (0.5 - step.beta), h2_v_dot = h * h * step.beta,
                 h_a = h * (1 - step.gamma), h_v_dot = h * step.gamma;
    std::swap(motion.frames, motion.frames_before);
    std::swap(motion.s, motion.s_before);
    const int offset = n * arms.n_nodes, n_free = offset + arms.n_free_scalars;
    for (int k = 0; k < n_free; ++k) {
      const Real v = at(motion.v, k), a = at(motion.a, k), v_dot = at(motion.v_dot, k);
      put(motion.exponent, k, h * v + h2_a * a + h2_v_dot * v_dot);  // eq. (3)
      put(motion.v, k, v + h_a * a + h_v_dot * v_dot);               // eq. (4)
      put(motion.a, k, v_dot);
    }
    for (int k = arms.n_free_scalars; k < arms.n_scalars; ++k) {
      put(motion.s, k, drive.s[k]);
      put(motion.v, offset + k, drive.v[k]);
      put(motion.v_dot, offset + k, drive.v_dot[k]);
    }
    place(arms, motion);
  }

  /// Laws, inertias, joints and gears on the scalar coordinates.
  static void scalar_residual(const Arms& arms, const Motion& motion, const double* v_dot,
                              const double* multipliers, double* r) {
    const int offset = n * arms.n_nodes;
    for (int k = 0; k < arms.n_scalars; ++k) put(r, k, at(arms.scalar_inertia, k) * at(v_dot, k));
    for (int k = 0; k < arms.n_laws; ++k) {
      const auto [plus, minus, linear] = arms.laws[k];
      Real force = at(motion.law_forces, k);
      if (linear) {
        Real x = at(motion.s, plus), rate = at(motion.v, offset + plus);
        if (minus >= 0) {
          x -= at(motion.s, minus);
          rate -= at(motion.v, offset + minus);
        }
        force = at(arms.law_numbers, 3 * k) + at(arms.law_numbers, 3 * k + 1) * x +
                at(arms.law_numbers, 3 * k + 2) * rate;
      }
      add(r, plus, force);
      if (minus >= 0) add(r, minus, -force);
    }
    for (int k = 0; k < arms.n_joints; ++k) {
      const JointPlace& place = arms.joints[k];
      if (place.coordinate < 0) continue;
      add(r, place.coordinate, -torque(arms, k, multipliers));
    }
    Gears::add_forces(arms, motion, multipliers, r);
  }

  /// ξᵀ λ of a joint.
  static Real torque(const Arms& arms, int k, const double* multipliers) {
    return joint(arms, k).twist.dot(matrix<Twist>(multipliers, arms.joints[k].first_row));
  }

  [[gnu::flatten]] static void find_residual(const Arms& arms, Motion& motion, const Drive& drive) {
    const int offset = n * arms.n_nodes, n_free = offset + arms.n_free_scalars;
    double* r = motion.r;
    for (int k = 0; k < offset; ++k) put(r, k, 0.0);
    scalar_residual(arms, motion, motion.v_dot + N * offset, motion.multipliers, r + N * offset);
    for (int k = 0; k < arms.n_scalars; ++k) add(r, offset + k, -Real(drive.torques[k]));
    for (int i = 0; i < arms.n_bodies; ++i) {
      const int k = n * arms.body_nodes[i];
      add_matrix(r, k,
                 elements::RigidBodyIn<D>::template inertia_forces<Real>(
                     matrix<TwistMatrix>(arms.bodies, n * n * i), matrix<Twist>(motion.v, k),
                     matrix<Twist>(motion.v_dot, k)));
    }
    const auto gravity = matrix<Point>(arms.gravity, 0);
    for (int k = 0; k < arms.n_nodes; ++k) {
      const int own = (1 + D) * k;
      const elements::WeightIn<D, Real> weight{at(arms.weights, own), matrix<Point>(arms.weights, own + 1)};
      add_matrix(r, n * k, Twist(-weight.force(frame(motion.frames, k).R, gravity)));
    }
    for (int k = 0; k < arms.n_joints; ++k) add_joint(arms, motion, k, n_free);
    Gears::find_violation(arms, motion, motion.dx + N * n_free);
    for (int k = 0; k < arms.n_beams; ++k) add_beam(arms, motion, k);
  }

  [[gnu::always_inline]] static void add_joint(const Arms& arms, Motion& motion, int k, int n_free) {
    const auto [a, b, q, row, folded] = arms.joints[k];
    if (folded) {
      put_matrix(motion.dx, n_free + row, Twist(Twist::Zero()));
      return;
    }
    const auto now =
        joint(arms, k).respond(a < 0 ? Frame{} : frame(motion.frames, a), frame(motion.frames, b), q >= 0,
                               q < 0 ? Real(0.0) : at(motion.s, q), matrix<Twist>(motion.multipliers, row));
    add_matrix(motion.r, n * b, now.b);
    if (a >= 0) add_matrix(motion.r, n * a, now.a);
    put_matrix(motion.dx, n_free + row, now.violation);
  }

  [[gnu::always_inline]] static void add_beam(const Arms& arms, Motion& motion, int k) {
    using Forces = elements::BeamForces<D, Real>;
    constexpr int rows = 2 * n + 1 + 4 * n * n;
    const double* own = arms.beams + N * rows * k;
    const int node1 = arms.beam_nodes[2 * k], node2 = arms.beam_nodes[2 * k + 1];
    const Forces beam{matrix<Twist>(own, 0), matrix<Twist>(own, n), at(own, 2 * n), arms.damped};
    const auto& M =
        *reinterpret_cast<const typename Forces::Mass*>(own + N * (2 * n + 1));  // with many zeros
    typename Forces::Ends u, u_dot;
    u << matrix<Twist>(motion.v, n * node1), matrix<Twist>(motion.v, n * node2);
    u_dot << matrix<Twist>(motion.v_dot, n * node1), matrix<Twist>(motion.v_dot, n * node2);
    const auto f = beam.at(frame(motion.frames, node1), frame(motion.frames, node2), u, u_dot, M);
    add_matrix(motion.r, n * node1, Twist(f.template head<n>()));
    add_matrix(motion.r, n * node2, Twist(f.template tail<n>()));
  }

  [[gnu::flatten]] static void find_sides(const Arms& arms, Motion& motion, const Step& step,
                                          const Drive& drive) {
    find_residual(arms, motion, drive);
    const int n_free = n * arms.n_nodes + arms.n_free_scalars;
    for (int k = 0; k < n_free; ++k) put(motion.dx, k, -at(motion.r, k));
    const Real scale = -(at(arms.mass_scale, 0) * (1 / (step.beta * step.h * step.h)));
    for (int k = 0; k < arms.n_constraints; ++k)
      put(motion.dx, n_free + k, scale * at(motion.dx, n_free + k));
    for (int i = 0; i < arms.n_followers; ++i) {
      const auto [node, carrier] = arms.followers[i];
      if (carrier < 0) continue;
      const Frame X_inverse = frame(arms.follower_frames, 2 * i + 1);
      add_matrix(motion.dx, n * carrier,
                 geometry::adjoint_transpose_product<D>(X_inverse, matrix<Twist>(motion.dx, n * node)));
    }
  }

  /// Equations (2), (3) of linear_solvers/dissected_inverse.hpp.
  [[gnu::flatten]] static void solve(const Arms& arms, Motion& motion) {
    double *b = motion.work, *products = b + N * arms.n_reduced;
    for (int k = 0; k < arms.n_reduced; ++k) put(b, k, at(motion.dx, arms.order[k]));
    double* b_s = b + N * (arms.n_reduced - arms.n_separated);
    double* x_s = products + N * arms.n_reduced;  // behind it the products of one part beyond its size
    double* beyond = x_s + N * arms.n_separated;
    for (int p = 0; p < arms.n_parts; ++p) {
      const InversePart& part = arms.parts[p];
      multiply(part.inverse, part.size, part.size, b + N * part.first, products + N * part.first);
      multiply(part.inverse + N * part.size * part.size, part.n_boundary, part.size, b + N * part.first,
               beyond);
      for (int k = 0; k < part.n_boundary; ++k) add(b_s, part.boundary[k], -at(beyond, k));
    }
    multiply(arms.separator, arms.n_separated, arms.n_separated, b_s, x_s);
    for (int p = 0; p < arms.n_parts; ++p) {
      const InversePart& part = arms.parts[p];
      double* x_p = products + N * part.first;
      if (part.n_boundary == 0) continue;
      double *known = beyond, *from_it = b + N * part.first;
      for (int k = 0; k < part.n_boundary; ++k) put(known, k, at(x_s, part.boundary[k]));
      multiply(part.from_boundary, part.size, part.n_boundary, known, from_it);
      for (int k = 0; k < part.size; ++k) add(x_p, k, -at(from_it, k));
    }
    const int inner = arms.n_reduced - arms.n_separated;
    for (int k = 0; k < inner; ++k) put(motion.dx, arms.order[k], at(products, k));
    for (int k = 0; k < arms.n_separated; ++k) put(motion.dx, arms.order[inner + k], at(x_s, k));
  }

  [[gnu::flatten]] static void turn(const Arms& arms, Motion& motion, const double* fresh) {
    const Turns& turns = arms.turns;
    const Real chosen = Real::at(fresh);
    if (!chosen.all_below(0.5)) Turning::prepare(turns, motion.s, chosen);
    double *along = motion.work, *f = along + N * turns.n_columns;
    Turning::find_along(turns, motion.dx, along);
    Turning::find_forces(turns, along, f);
    subtract(arms, motion, turns.W, turns.n_columns, f, f + N * turns.n_columns);
  }

  [[gnu::flatten]] static void take_forces(const Arms& arms, Motion& motion, const double* forces) {
    subtract(arms, motion, arms.by_forces, arms.n_forces, forces, motion.work);
  }

  /// Δ := Δ − W f.
  static void subtract(const Arms& arms, Motion& motion, const double* W, int columns, const double* f,
                       double* change) {
    multiply(W, arms.n_reduced, columns, f, change);
    for (int k = 0; k < arms.n_reduced; ++k) add(motion.dx, arms.order[k], -at(change, k));
  }

  [[gnu::flatten]] static void correct(const Arms& arms, Motion& motion, const Step& step,
                                       const double* active, double* sizes) {
    const int n_free = n * arms.n_nodes + arms.n_free_scalars;
    for (int i = 0; i < arms.n_followers; ++i) {
      const auto [node, carrier] = arms.followers[i];
      const Twist own = carrier < 0 ? Twist(Twist::Zero())
                                    : geometry::adjoint_product<D>(frame(arms.follower_frames, 2 * i + 1),
                                                                   matrix<Twist>(motion.dx, n * carrier));
      put_matrix(motion.dx, n * node, own);
    }
    const Real chosen = Real::at(active);
    const double per_h2 = 1 / (step.beta * step.h * step.h), per_h = step.gamma * step.h * per_h2,
                 per_h2_v_dot = per_h2 / (1 + step.alpha);
    Real translation = 0.0, rest = 0.0, sum = 0.0;
    for (int k = 0; k < n_free; ++k) {
      const Real dx = at(motion.dx, k);
      sum += dx;
      Real& largest = k < n * arms.n_nodes && k % n < D ? translation : rest;
      largest = Real::larger(largest, dx.magnitude());
      const Real here = dx.where(chosen);
      add(motion.exponent, k, here);
      add(motion.a, k, per_h2 * here);
      add(motion.v, k, per_h * here);
      add(motion.v_dot, k, per_h2_v_dot * here);
    }
    const Real scale = at(arms.mass_scale, 0) * per_h2;
    for (int k = 0; k < arms.n_constraints; ++k) {
      const Real dx = at(motion.dx, n_free + k);
      sum += dx;
      add(motion.multipliers, k, scale * dx.where(chosen));
    }
    (Real::larger(translation / at(arms.reach, 0), rest) + 0.0 * sum).put(sizes);
    place(arms, motion);
  }

  /// Accelerations and multipliers of simulation/consistent_forces.hpp behind Φ'' in `motion.acceleration`:
  /// of all scalar coordinates, then of all constraints.
  static void find_consistent(const Arms& arms, Motion& motion) {
    const int offset = n * arms.n_nodes, m = arms.n_constraints;
    const auto rates = [&](const double* v, const JointPlace& place) {
      const auto [a, b, q, row, folded] = place;
      return typename Joint::Rates{a < 0 ? Twist(Twist::Zero()) : matrix<Twist>(v, n * a),
                                   matrix<Twist>(v, n * b), q < 0 ? Real(0.0) : at(v, offset + q)};
    };
    for (int k = 0; k < arms.n_joints; ++k) {
      const JointPlace& place = arms.joints[k];
      const bool moves = place.coordinate >= 0;
      put_matrix(motion.acceleration, place.first_row,
                 joint(arms, k).acceleration(place.node_a < 0, moves,
                                             moves ? at(motion.s, place.coordinate) : Real(0.0),
                                             rates(motion.v, place), rates(motion.v_dot, place)));
    }
    Gears::find_acceleration(arms, motion, offset, motion.acceleration);
    const Turns& turns = arms.consistent_turns;
    const int n_changed = arms.n_free_scalars + m;
    double *change = motion.work, *found = motion.acceleration + N * m;
    multiply(arms.consistent, n_changed + turns.n_columns, m, motion.acceleration, change);
    if (turns.n_joints > 0) {
      double *along = change + N * n_changed, *f = along + N * turns.n_columns;
      double* by_turns = f + N * turns.n_columns;
      Turning::prepare(turns, motion.s, 1.0);
      Turning::find_forces(turns, along, f);
      multiply(turns.W, n_changed, turns.n_columns, f, by_turns);
      for (int k = 0; k < n_changed; ++k) add(change, k, -at(by_turns, k));
    }
    for (int k = 0; k < arms.n_scalars; ++k) {
      const Real v_dot = at(motion.v_dot, offset + k);
      put(found, k, k < arms.n_free_scalars ? v_dot + at(change, k) : v_dot);
    }
    for (int k = 0; k < m; ++k) {
      put(found, arms.n_scalars + k, at(motion.multipliers, k) + at(change, arms.n_free_scalars + k));
    }
  }

  /// Where a point's node or section is, and how fast in its own axes.
  struct Placed {
    Frame H;
    Twist v;
  };
  static Placed placed(const Arms& arms, const Motion& motion, const PointPlace& at) {
    if (at.section < 0) return {frame(motion.frames, at.node), matrix<Twist>(motion.v, n * at.node)};
    const int own = (2 * n + n * n) * at.section;
    const elements::BeamSection<D, Real> section{matrix<Twist>(arms.sections, own),
                                                 matrix<Twist>(arms.sections, own + n),
                                                 matrix<TwistMatrix>(arms.sections, own + 2 * n)};
    Placed ends[2];
    for (int end = 0; end < 2; ++end) {
      const int* nodes = arms.section_nodes + N * (2 * at.section + end);
      ends[end] = {{matrix_by_lane<geometry::Rotation<D, Real>>(motion.frames, 0, frame_rows, nodes),
                    matrix_by_lane<Point>(motion.frames, D * D, frame_rows, nodes)},
                   matrix_by_lane<Twist>(motion.v, 0, n, nodes)};
    }
    const auto& [first, second] = ends;
    return {section.frame(first.H, second.H), section.velocity(first.H, second.H, first.v, second.v)};
  }

  [[gnu::flatten]] static void record(const Arms& arms, Motion& motion, double* rows) {
    const int offset = n * arms.n_nodes;
    for (int i = 0; i < arms.n_points; ++i) {
      const auto [H, v_there] = placed(arms, motion, arms.points[i]);
      const auto lever = matrix<Point>(arms.point_offsets, D * i);
      const Twist v = geometry::adjoint_product<D>(Frame::translation(-lever), v_there);
      put_matrix(rows, 2 * D * i, Point(H * lever));
      put_matrix(rows, 2 * D * i + D, Point(H.R * v.template head<D>()));
    }
    if (arms.n_outputs == 0) return;
    double* told = rows + N * 2 * D * arms.n_points;
    const double *v_dot = motion.v_dot + N * offset, *multipliers = motion.multipliers;
    if (arms.consistent != nullptr) {
      find_consistent(arms, motion);
      v_dot = motion.acceleration + N * arms.n_constraints;
      multipliers = v_dot + N * arms.n_scalars;
    }
    scalar_residual(arms, motion, v_dot, multipliers, motion.work);
    for (int i = 0; i < arms.n_outputs; ++i) {
      const auto [theta, phi, constraint] = arms.outputs[i];
      double* own = told + N * 6 * i;
      put(own, 0, at(motion.s, theta));
      put(own, 1, at(motion.v, offset + theta));
      put(own, 2, at(motion.s, phi));
      put(own, 3, at(motion.v, offset + phi));
      put(own, 4, at(motion.work, phi));
      put(own, 5, -torque(arms, constraint, multipliers));
    }
  }
};

}  // namespace flexarm::lanes
