/// How loops are closed: joints of the undeformed arm are sought at which all conditions of its closures
/// hold,
///
///     g(θ) = 0,   Δθ = −G⁺ g,   G = ∂g/∂θ                                                           (1)
///
/// by Newton's method with least-squares steps: G may have more rows than columns or the other way round, and
/// rows that repeat one another. Of G only the joints on the way between the two ends of a closure matter,
/// with δ = Ad(H⁻¹ B) ξ δθ the motion of a node at H by a joint at B. Lengths count in parts of the reach.
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cstdio>
#include <random>

#include "flexarm/assembly/system.hpp"
#include "flexarm/dense.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::assembly {
namespace {

using namespace geometry;

// Of a joint in one step of (1) [rad, parts of the reach].
constexpr double longest_step = 0.5;
constexpr int most_steps = 100;
// Conditions count as met below this part of the reach.
constexpr double met = 1e-11;
// Singular values below this part of the largest are zero. Exact repetitions leave 1e-12 of it.
constexpr double rank_tolerance = 1e-8;
// The same where joints are driven: near a pose in line, which Newton's method reaches to 1e-6 only, forces
// have less than this of the leverage that they need.
constexpr double least_leverage = 1e-5;
// Other poses to start from, ever further away: up to half a turn.
constexpr int most_tries = 40;
// Poses near the first one that are asked for the rank of the conditions, too: where links are in line some
// repeat only there. Joints differ by up to the second number [rad, parts of the reach].
constexpr int most_nearby_poses = 3;
constexpr double nearby = 0.1;
// Driven joints move from where the loop was closed first in steps up to this, so that it stays closed the
// same way [rad, parts of the reach].
constexpr double drive_step = 0.1;

}  // namespace

std::vector<int> System::chain_to(int link) const {
  std::vector<int> chain;
  while (link >= 0) {
    const auto joint = std::find_if(arm_.joints.begin(), arm_.joints.end(),
                                    [&](const model::Joint& j) { return place(j.child).link == link; });
    if (joint == arm_.joints.end() || chain.size() > arm_.joints.size())
      throw InvalidParameter("link '" + model::name_of(arm_.links[link]) +
                             "' is not connected to the base by joints");
    chain.push_back(static_cast<int>(joint - arm_.joints.begin()));
    link = joint->parent == "base" ? -1 : place(joint->parent, joint->at_end).link;
  }
  return chain;
}

/// The conditions, then those of gears between joints of loops.
VectorXd System::loop_residual(const std::vector<double>& joint_values) const {
  VectorXd g = rigid_closures_.residual(open_state(joint_values).frames);
  for (const model::Gear& gear : arm_.gears) {
    const int in = joint_index(gear.input), out = joint_index(gear.output);
    if (!in_loop_[in]) continue;
    g.conservativeResize(g.size() + 1);
    g[g.size() - 1] = reach_ * (joint_values[in] - gear.ratio * joint_values[out]);
  }
  return g;
}

/// Columns of slides times the reach, so that all columns are lengths.
MatrixXd System::loop_jacobian(const std::vector<double>& joint_values,
                               const std::vector<int>& unknowns) const {
  const State state = open_state(joint_values);
  const auto columns = static_cast<Eigen::Index>(unknowns.size());
  MatrixXd G = MatrixXd::Zero(loop_residual(joint_values).size(), columns);
  int row = 0;
  for (std::size_t k = 0; k < rigid_closures_.size(); ++k) {
    const joints::ClosureConstraint& closure = rigid_closures_[k];
    const auto J = closure.jacobian(frame(state, closure.node_a()), frame(state, closure.node_b()));
    const auto add = [&](int link, int node, const joints::ClosureConstraint::Rows& rows) {
      for (const int j : chain_to(link)) {
        const auto column = std::find(unknowns.begin(), unknowns.end(), j);
        if (column == unknowns.end()) continue;
        const joints::JointConstraint& joint = constraints_[j];
        const Frame B = frame(state, joint.node_b()) * joint.frame_b();
        const Frame from_node = relative<3>(frame(state, node), B);
        G.block(row, column - unknowns.begin(), closure.size(), 1) +=
            rows * adjoint_product<3>(from_node, joint.twist());
      }
    };
    add(loop_ends_[k].first, closure.node_a(), J.a);
    add(loop_ends_[k].second, closure.node_b(), J.b);
    row += closure.size();
  }
  for (const model::Gear& gear : arm_.gears) {
    const int in = joint_index(gear.input), out = joint_index(gear.output);
    if (!in_loop_[in]) continue;
    for (Eigen::Index i = 0; i < columns; ++i) {
      if (unknowns[i] == in) G(row, i) += reach_;
      if (unknowns[i] == out) G(row, i) -= reach_ * gear.ratio;
    }
    ++row;
  }
  for (Eigen::Index i = 0; i < columns; ++i) {
    if (arm_.joints[unknowns[i]].type == joints::JointType::prismatic) G.col(i) *= reach_;
  }
  return G;
}

bool System::axes_agree(const std::vector<double>& joint_values) const {
  const State state = open_state(joint_values);
  for (std::size_t k = 0; k < rigid_closures_.size(); ++k) {
    const joints::ClosureConstraint& closure = rigid_closures_[k];
    if (!closure.axes_agree(frame(state, closure.node_a()), frame(state, closure.node_b()))) return false;
  }
  return true;
}

namespace {

/// Random values near those of some joints.
std::vector<double> nearby_values(const model::Arm& arm, std::vector<double> values,
                                  const std::vector<int>& joints, double reach, std::mt19937& generator) {
  std::uniform_real_distribution<double> any(-nearby, nearby);
  for (const int j : joints) {
    values[j] += any(generator) * (arm.joints[j].type == joints::JointType::prismatic ? reach : 1.0);
  }
  return values;
}

}  // namespace

/// Equation (1), each step shortened until the conditions come closer.
System::Closed System::newton(std::vector<double> values, const std::vector<int>& unknowns) const {
  const auto moved = [&](const VectorXd& step) {
    std::vector<double> to = values;
    for (std::size_t i = 0; i < unknowns.size(); ++i) {
      const bool slides = arm_.joints[unknowns[i]].type == joints::JointType::prismatic;
      to[unknowns[i]] += (slides ? reach_ : 1.0) * step[static_cast<Eigen::Index>(i)];
    }
    return to;
  };
  VectorXd g = loop_residual(values);
  for (int k = 0; k < most_steps && !unknowns.empty(); ++k) {
    const bool close = g.lpNorm<Eigen::Infinity>() <= met * reach_;
    VectorXd step = -dense::least_squares(loop_jacobian(values, unknowns), g, rank_tolerance);
    if (!step.allFinite()) break;
    step *= std::min(1.0, longest_step / std::max(step.lpNorm<Eigen::Infinity>(), 1e-300));
    bool closer = false;
    for (int halvings = 0; halvings < 20 && !closer; ++halvings, step *= 0.5) {
      const std::vector<double> trial = moved(step);
      const VectorXd there = loop_residual(trial);
      if (!(there.norm() < g.norm())) continue;
      closer = true;
      values = trial;
      g = there;
    }
    if (!closer || close) break;  // to rounding, or nowhere
  }
  return {values, g.lpNorm<Eigen::Infinity>() <= met * reach_ && axes_agree(values)};
}

/// Newton's method from the values, then from others; of those that fail the nearest is told.
System::Closed System::search(const std::vector<double>& values, const std::vector<int>& unknowns) const {
  Closed best = newton(values, unknowns);
  std::mt19937 generator(1);  // the same tries every time
  for (int k = 1; k <= most_tries && !best.met; ++k) {
    std::uniform_real_distribution<double> any(-1, 1);
    std::vector<double> start = values;
    for (const int j : unknowns) {
      const bool slides = arm_.joints[j].type == joints::JointType::prismatic;
      start[j] += k * (slides ? reach_ : 3.2) * any(generator) / most_tries;
    }
    const Closed found = newton(start, unknowns);
    if (found.met || loop_residual(found.values).norm() < loop_residual(best.values).norm()) best = found;
  }
  return best;
}

void System::refuse(const std::vector<double>& nearest, const std::vector<int>& unknowns) const {
  const State state = open_state(nearest);
  std::size_t worst = 0;
  double largest = -1;
  std::vector<joints::ClosureConstraint::Misclosure> misclosures;
  for (std::size_t k = 0; k < rigid_closures_.size(); ++k) {
    const joints::ClosureConstraint& closure = rigid_closures_[k];
    misclosures.push_back(closure.misclosure(frame(state, closure.node_a()), frame(state, closure.node_b())));
    const double size = misclosures[k].distance + reach_ * misclosures[k].angle;
    if (size > largest) worst = k;
    largest = std::max(largest, size);
  }
  std::string held;
  for (std::size_t j = 0; j < in_loop_.size(); ++j) {
    if (!in_loop_[j] || std::find(unknowns.begin(), unknowns.end(), static_cast<int>(j)) != unknowns.end())
      continue;
    if (joint_coordinates_[j].phi < 0) continue;
    char one[80];
    std::snprintf(one, sizeof one, " = %.6g", nearest[j]);
    held += (held.empty() ? " with " : ", ") + arm_.joints[j].name + one;
  }
  char gap[120];
  std::snprintf(gap, sizeof gap, "%.3g m", misclosures[worst].distance);
  std::string text = gap;
  if (misclosures[worst].angle > 1e-6) {
    std::snprintf(gap, sizeof gap, " and %.3g rad", misclosures[worst].angle);
    text += gap;
  }
  text += " apart at the nearest";
  std::vector<int> joints;
  for (std::size_t j = 0; j < in_loop_.size(); ++j) {
    if (in_loop_[j] && joint_coordinates_[j].phi >= 0) joints.push_back(static_cast<int>(j));
  }
  const auto free =
      static_cast<Eigen::Index>(joints.size()) - dense::rank(loop_jacobian(nearest, joints), rank_tolerance);
  const auto driven = static_cast<Eigen::Index>(joints.size() - unknowns.size());
  if (driven > free) {
    text += "; " + std::to_string(driven) + " joints of the loops are given where " + std::to_string(free) +
            (free == 1 ? " suffices" : " suffice");
  }
  throw InvalidParameter("closure '" + closures_.name(worst) + "' cannot be closed" + held + ": " + text);
}

/// Orthonormal combinations of the closures' rows that the other constraints hold already. @param all_joints
/// may move, also those that are driven
MatrixXd System::held_by_others(const State& state, bool all_joints) const {
  if (closures_.rows() == 0) return MatrixXd(0, 0);
  const int columns = all_joints ? n_velocities() : n_free();
  const auto counts = [&](int scalar) { return scalar >= 0 && (all_joints || is_free(scalar)); };
  VectorXd length = VectorXd::Constant(columns, 1 / reach_);  // rotations in parts of the reach
  for (int k = 0; k < n_nodes_; ++k) length.segment<3>(6 * k).setOnes();
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, double value) {
    if (value != 0) entries.emplace_back(row, column, value * length[column]);
  };
  int row = 0;
  for (const Joint& joint : constraints_) {
    const int a = joint.node_a(), b = joint.node_b(), q = joint.coordinate();
    const auto J = joint.jacobian(frame(state, a), frame(state, b), q < 0 ? 0.0 : state.s[q]);
    for (int i = 0; i < joint.rows(); ++i) {
      for (int j = 0; j < 6; ++j) {
        add(row + i, 6 * b + j, J.b(i, j));
        if (a >= 0) add(row + i, 6 * a + j, J.a(i, j));
      }
      if (counts(q)) add(row + i, scalar_offset() + q, J.theta[i]);
    }
    row += joint.rows();
  }
  for (const joints::GearConstraint& gear : gears_) {
    if (counts(gear.input))
      add(row, scalar_offset() + gear.input, gear.transmission(state.s[gear.input]).first);
    if (counts(gear.output)) add(row, scalar_offset() + gear.output, -1);
    ++row;
  }
  Eigen::SparseMatrix<double> J(row, columns);
  J.setFromTriplets(entries.begin(), entries.end());
  MatrixXd R = MatrixXd::Zero(columns, closures_.rows());
  closures_.emit(
      state.frames, VectorXd::Zero(closures_.rows()),
      [&](int i, int column, double value) { R(column, i) += value * length[column]; },
      [](int, int, double) {});
  const Eigen::SparseMatrix<double> JJ = J * J.transpose();
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(JJ);
  for (int pass = 0; pass < 2; ++pass)  // once more against rounding
    R -= J.transpose() * MatrixXd(factor.solve(MatrixXd(J * R)));
  const auto [values, vectors] = dense::right_singular(R);
  const Eigen::Index rank = (values.array() > (all_joints ? rank_tolerance : least_leverage)).count();
  return vectors.rightCols(vectors.cols() - rank);
}

void System::close_loops() {
  in_loop_.assign(arm_.joints.size(), false);
  if (closures_.empty()) return;
  for (const auto& [a, b] : loop_ends_) {
    const std::vector<int> of_a = chain_to(a), of_b = chain_to(b);
    const auto only = [&](const std::vector<int>& chain, const std::vector<int>& other) {
      for (const int j : chain) {
        if (std::find(other.begin(), other.end(), j) == other.end()) in_loop_[j] = true;
      }
    };
    only(of_a, of_b);
    only(of_b, of_a);
  }
  for (std::size_t pass = 0; pass < arm_.gears.size(); ++pass) {
    for (const model::Gear& gear : arm_.gears) {
      const int in = joint_index(gear.input), out = joint_index(gear.output);
      in_loop_[in] = in_loop_[out] = in_loop_[in] || in_loop_[out];
    }
  }
  std::vector<double> start(arm_.joints.size(), 0.0);
  for (const auto& [name, value] : arm_.assembly) start[joint_index(name)] = value;
  std::vector<int> joints, unstated;
  for (int j = 0; j < static_cast<int>(in_loop_.size()); ++j) {
    if (!in_loop_[j] || joint_coordinates_[j].phi < 0) continue;
    joints.push_back(j);
    if (!arm_.assembly.contains(arm_.joints[j].name)) unstated.push_back(j);
  }
  Closed found = newton(start, unstated);
  if (!found.met) found = search(found.values, joints);  // stated values contradict: near their best fit
  if (!found.met) refuse(found.values, joints);
  assembled_ = found.values;

  MatrixXd N = held_by_others(open_state(assembled_), true);
  std::mt19937 generator(1);
  for (int k = 0; k < most_nearby_poses && N.cols() > 0; ++k) {
    const Closed pose = newton(nearby_values(arm_, assembled_, joints, reach_, generator), joints);
    if (!pose.met) continue;
    const MatrixXd other = held_by_others(open_state(pose.values), true);
    if (other.cols() < N.cols()) N = other;
  }
  if (N.cols() == 0) return;
  closures_.leave_out(N);
  n_constraints_ -= closures_.redundant();
}

void System::count_closures_as(const System& nominal) {
  if (closures_.conditions() != nominal.closures_.conditions() ||
      closures_.rows() != nominal.closures_.rows()) {
    throw InvalidParameter("the loops of the two models repeat different numbers of conditions");
  }
  closures_.count_as(nominal.closures_);
}

/// The driven joints walk from where the loops were closed first; the others follow.
std::vector<double> System::closed(const std::vector<double>& joint_values) const {
  if (joint_values.size() != arm_.joints.size()) return joint_values;  // open_state() tells
  std::vector<int> unknowns;
  std::vector<double> now = assembled_, driven = joint_values;
  double farthest = 0;
  for (std::size_t j = 0; j < driven.size(); ++j) {
    if (!in_loop_[j]) {
      now[j] = driven[j];
    } else if (drives_[j] == DriveKind::free) {
      unknowns.push_back(static_cast<int>(j));
      driven[j] = assembled_[j];
    } else {
      const double unit = arm_.joints[j].type == joints::JointType::prismatic ? reach_ : 1.0;
      farthest = std::max(farthest, std::abs(driven[j] - assembled_[j]) / unit);
    }
  }
  const std::vector<double> begin = now;
  const int steps = std::clamp(static_cast<int>(std::ceil(farthest / drive_step)), 1, 1000);
  Closed found{now, false};
  for (int k = 1; k <= steps; ++k) {
    std::vector<double> next = found.values;
    for (std::size_t j = 0; j < next.size(); ++j) {
      if (std::find(unknowns.begin(), unknowns.end(), static_cast<int>(j)) != unknowns.end()) continue;
      next[j] = k == steps ? driven[j] : begin[j] + (driven[j] - begin[j]) * k / steps;
    }
    found = newton(next, unknowns);
  }
  if (!found.met) found = search(found.values, unknowns);
  if (!found.met) refuse(found.values, unknowns);
  if (held_by_others(open_state(found.values), false).cols() > 0) {
    std::string names;
    for (std::size_t j = 0; j < in_loop_.size(); ++j) {
      if (in_loop_[j] && joint_coordinates_[j].phi >= 0 && drives_[j] != DriveKind::free)
        names += (names.empty() ? "" : ", ") + arm_.joints[j].name;
    }
    throw InvalidParameter("the loops of the closures are singular at this pose: its driven joints (" +
                           (names.empty() ? std::string("none") : names) +
                           ") leave the forces in them open, as where links are in line, or where more "
                           "joints are driven than the loops let move");
  }
  return found.values;
}

std::vector<int> System::joints_to_hold(const std::vector<int>& held,
                                        const std::vector<int>& candidates) const {
  if (closures_.empty()) return {};
  std::vector<int> joints, unknowns, hold;
  for (int j = 0; j < static_cast<int>(in_loop_.size()); ++j) {
    const bool stands = std::find(held.begin(), held.end(), j) != held.end();
    if (!in_loop_[j] || joint_coordinates_[j].phi < 0) continue;
    joints.push_back(j);
    if (!stands) unknowns.push_back(j);
  }
  std::vector<std::vector<double>> poses = {assembled_};
  std::mt19937 generator(1);
  for (int k = 0; k < most_nearby_poses; ++k) {
    const Closed pose = newton(nearby_values(arm_, assembled_, joints, reach_, generator), joints);
    if (pose.met) poses.push_back(pose.values);
  }
  const auto rank = [&](const std::vector<int>& of) {
    Eigen::Index most = 0;
    for (const std::vector<double>& pose : poses) {
      if (!of.empty()) most = std::max(most, dense::rank(loop_jacobian(pose, of), rank_tolerance));
    }
    return most;
  };
  const Eigen::Index needed = rank(unknowns);
  for (const int j : candidates) {
    if (static_cast<Eigen::Index>(unknowns.size()) == needed) break;
    std::vector<int> rest = unknowns;
    std::erase(rest, j);
    if (rest.size() == unknowns.size() || rank(rest) < needed) continue;
    unknowns = rest;
    hold.push_back(j);
  }
  return hold;
}

}  // namespace flexarm::assembly
