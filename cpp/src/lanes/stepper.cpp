#include "flexarm/lanes/stepper.hpp"

#include <algorithm>

#include "flexarm/integrators/hht_coefficients.hpp"
#include "flexarm/integrators/increment.hpp"
#include "flexarm/integrators/step_iteration.hpp"

namespace flexarm::lanes {

using integrators::StepIteration;

template <int D>
StepperIn<D>::StepperIn(const Kernel& kernel, const std::vector<const SystemIn<D>*>& arms,
                        const std::vector<LoadsIn<D>>& loads, const std::vector<StateIn<D>>& states,
                        const integrators::HhtCoefficients& coefficients,
                        const integrators::HhtOptions& options)
    : kernel_(kernel),
      coefficients_(coefficients),
      options_(options),
      numbers_(arms, loads, kernel.lanes),
      t_(states.front().t),
      start_(states.front().start) {
  constexpr int n = geometry::freedoms<D>;
  const Arms& all = numbers_.arms();
  const int n_velocities = n * all.n_nodes + all.n_scalars, lanes = kernel.lanes;
  const int n_unknowns = n * all.n_nodes + all.n_free_scalars + all.n_constraints;
  const auto room = [&](Rows& rows, int count) {
    rows = Rows(count, lanes);
    return rows.data();
  };
  motion_ = {.frames = room(frames_, frame_rows<D> * all.n_nodes),
             .frames_before = room(frames_before_, frame_rows<D> * all.n_nodes),
             .s = room(s_, all.n_scalars),
             .s_before = room(s_before_, all.n_scalars),
             .v = room(v_, n_velocities),
             .v_dot = room(v_dot_, n_velocities),
             .a = room(a_, n_velocities),
             .multipliers = room(multipliers_, all.n_constraints),
             .exponent = room(exponent_, n_velocities),
             .r = room(r_, n_velocities),
             .dx = room(dx_, n_unknowns),
             .law_forces = room(law_forces_, all.n_laws),
             .work = room(work_, 4 * n_unknowns + all.n_scalars),
             .acceleration = room(acceleration_, 2 * all.n_constraints + all.n_scalars)};
  active_ = Rows(1, lanes);
  fresh_ = Rows(1, lanes);
  sizes_ = Rows(1, lanes);
  for (std::size_t k = 0; k < arms.size(); ++k) {
    lane_.push_back({arms[k], loads[k], states[k], assembly::IterationMatrixIn<D>(*arms[k]),
                     integrators::WoodburyUpdateIn<D>(*arms[k], numbers_.condensation(static_cast<int>(k)))});
  }
  for (int lane = 0; lane < lanes; ++lane) {
    put(lane, states[lane < static_cast<int>(states.size()) ? static_cast<std::size_t>(lane) : 0]);
  }
  for (int k = 0; k < all.n_laws; ++k) {
    if (!all.laws[k].linear) own_laws_.push_back(k);
  }
  for (int lane = 0; lane < static_cast<int>(lane_.size()); ++lane) {
    const auto grows = [](const auto& beam) { return beam.grows(); };
    if (std::ranges::any_of(arms[static_cast<std::size_t>(lane)]->beams(), grows)) growing_.push_back(lane);
    take_scalars(lane);
    find_law_forces(lane);
  }
  if (!own_laws_.empty()) forces_ = Rows(static_cast<int>(lane_.front().update.W().cols()), lanes);
  const Eigen::VectorXd zero = Eigen::VectorXd::Zero(all.n_scalars);
  drive_ = {zero, zero, zero, zero};
}

template <int D>
void StepperIn<D>::put(int lane, const StateIn<D>& state) {
  int row = 0;
  for (const auto& H : state.frames) row = frames_.put(frames_.put(row, lane, H.R), lane, H.x);
  s_.put(0, lane, state.s);
  v_.put(0, lane, state.v);
  v_dot_.put(0, lane, state.v_dot);
  a_.put(0, lane, state.a);
  multipliers_.put(0, lane, state.multipliers);
}

template <int D>
StateIn<D> StepperIn<D>::state(int lane) const {
  const Lane& own = lane_[static_cast<std::size_t>(lane)];
  const int lanes = kernel_.lanes;
  StateIn<D> state = own.now;
  state.t = t_;
  const auto number = [&](const double* rows, int row) { return rows[lanes * row + lane]; };
  for (std::size_t k = 0; k < state.frames.size(); ++k) {
    const int row = frame_rows<D> * static_cast<int>(k);
    for (int i = 0; i < D * D; ++i) state.frames[k].R.data()[i] = number(motion_.frames, row + i);
    for (int i = 0; i < D; ++i) state.frames[k].x[i] = number(motion_.frames, row + D * D + i);
  }
  for (int k = 0; k < state.s.size(); ++k) state.s[k] = number(motion_.s, k);
  v_.take(0, lane, state.v);
  v_dot_.take(0, lane, state.v_dot);
  a_.take(0, lane, state.a);
  multipliers_.take(0, lane, state.multipliers);
  return state;
}

/// What laws need of the motion of a lane.
template <int D>
void StepperIn<D>::take_scalars(int lane) {
  Lane& own = lane_[static_cast<std::size_t>(lane)];
  const int lanes = kernel_.lanes, offset = own.arm->scalar_offset();
  own.now.t = t_;
  for (int k = 0; k < own.now.s.size(); ++k) {
    own.now.s[k] = motion_.s[lanes * k + lane];
    own.now.v[offset + k] = v_(offset + k, lane);
  }
}

/// What laws that are not linear put against the scalar coordinates of a lane.
template <int D>
void StepperIn<D>::find_law_forces(int lane) {
  Lane& own = lane_[static_cast<std::size_t>(lane)];
  for (const int k : own_laws_) {
    law_forces_(k, lane) = own.arm->respond(static_cast<std::size_t>(k), own.now).force;
  }
}

template <int D>
void StepperIn<D>::take_unknowns(int lane, Eigen::VectorXd& x) const {
  const std::vector<int>& unknowns = numbers_.unknowns();
  x.resize(static_cast<Eigen::Index>(unknowns.size()));
  for (Eigen::Index k = 0; k < x.size(); ++k) x[k] = dx_(unknowns[static_cast<std::size_t>(k)], lane);
}

template <int D>
void StepperIn<D>::put_unknowns(int lane, const Eigen::VectorXd& x) {
  const std::vector<int>& unknowns = numbers_.unknowns();
  for (Eigen::Index k = 0; k < x.size(); ++k) dx_(unknowns[static_cast<std::size_t>(k)], lane) = x[k];
}

/// Forces of what has changed in the matrix of a lane since that was factored.
template <int D>
void StepperIn<D>::find_forces(int lane, bool again) {
  Lane& own = lane_[static_cast<std::size_t>(lane)];
  if (!own.update.prepare(own.now, again)) {
    forces_.put(0, lane, Eigen::VectorXd::Zero(own.update.W().cols()));
    return;
  }
  const std::vector<int>& unknowns = numbers_.unknowns();
  along_.resize(own.update.W().cols());
  own.update.find_along([&](int row) { return dx_(unknowns[static_cast<std::size_t>(row)], lane); }, along_);
  forces_.put(0, lane, own.update.forces(own.now, along_));
}

/// Increments of all lanes, as the matrices that were factored make them.
template <int D>
void StepperIn<D>::solve(const Step& step, const Drive& drive) {
  const int n_lanes = static_cast<int>(lane_.size());
  const auto of_itself = [&](int k, auto do_it) {
    Lane& lane = lane_[static_cast<std::size_t>(k)];
    if (lane.own_factor && active_(0, k) != 0) do_it(lane);
  };
  kernel_.find_sides(numbers_.arms(), motion_, step, drive);
  for (int k = 0; k < n_lanes; ++k) {
    of_itself(k, [&](Lane& lane) {
      take_unknowns(k, lane.increments);
      lane.own_factor->solve(lane.increments);
    });
  }
  kernel_.solve(numbers_.arms(), motion_);
  for (int k = 0; k < n_lanes; ++k) {
    of_itself(k, [&](Lane& lane) { put_unknowns(k, lane.increments); });
  }
}

template <int D>
StateIn<D> StepperIn<D>::final_state(int lane) const {
  StateIn<D> found = state(lane);
  if (own_laws_.empty()) integrators::remember_laws(*lane_[static_cast<std::size_t>(lane)].arm, found);
  LoadsIn<D> loads = lane_[static_cast<std::size_t>(lane)].loads;
  loads.torques = drive_.torques;
  numbers_.condensation(lane).recover_multipliers(found, loads);
  return found;
}

template <int D>
bool StepperIn<D>::any_runs() const {
  return std::any_of(lane_.begin(), lane_.end(), [](const Lane& lane) { return lane.runs; });
}

template <int D>
bool StepperIn<D>::factor(int lane, double h) {
  Lane& own = lane_[static_cast<std::size_t>(lane)];
  const StateIn<D> here = state(lane);
  const auto c = integrators::step_factors(coefficients_, h, integrators::constraint_scale(*own.arm));
  const Eigen::VectorXd law_tangents = own.arm->law_tangents(here, c, true);
  ++own.statistics.factorisations;
  const auto* S = own.matrix.assemble(here, own.loads, c, law_tangents);
  if (S == nullptr) return false;
  const auto& condensation = numbers_.condensation(lane);
  auto factor = std::make_unique<linear_solvers::CachedFactorisation>();
  if (!factor->factor(condensation.any() ? condensation.reduce(*S) : *S)) return false;
  own.update.keep(here, c, law_tangents, factor->by_substitution());
  const bool with_others = numbers_.set_inverse(lane, factor->inverse());
  own.own_factor = with_others ? nullptr : std::move(factor);
  if (turns_together()) numbers_.set_turns(lane, own.update);
  if (!own_laws_.empty()) numbers_.set_by_forces(lane, own.update.W());
  return true;
}

template <int D>
void StepperIn<D>::advance(double h, const integrators::Drives& drives) {
  const int n_lanes = static_cast<int>(lane_.size());
  t_ += h;
  if (factored_h_ != h) {
    for (int k = 0; k < n_lanes; ++k) {
      Lane& lane = lane_[static_cast<std::size_t>(k)];
      lane.runs = lane.runs && factor(k, h);
    }
    factored_h_ = h;
  }
  drives(t_, drive_);
  for (const int k : growing_) numbers_.grow_bows(k, *lane_[static_cast<std::size_t>(k)].arm, t_ - start_);
  const Step step{h, coefficients_.alpha, coefficients_.beta, coefficients_.gamma};
  const Drive drive{drive_.s.data(), drive_.v.data(), drive_.v_dot.data(), drive_.torques.data()};
  kernel_.predict(numbers_.arms(), motion_, step, drive);
  iterate(step, drive);
  ++steps_;
  for (int k = 0; k < n_lanes; ++k) {
    Lane& lane = lane_[static_cast<std::size_t>(k)];
    lane.statistics.steps += lane.runs;
    if (own_laws_.empty() || !lane.runs) continue;
    take_scalars(k);
    integrators::remember_laws(*lane.arm, lane.now);
    find_law_forces(k);
  }
}

template <int D>
void StepperIn<D>::iterate(const Step& step, const Drive& drive) {
  std::vector<StepIteration> iterations;
  iterations.reserve(lane_.size());
  const int n_lanes = static_cast<int>(lane_.size());
  const bool together = turns_together(), by_lane = !own_laws_.empty();
  int waited_for = 0;
  for (std::size_t k = 0; k < lane_.size(); ++k) {
    iterations.emplace_back(coefficients_, options_, step.h, steps_, lane_[k].contraction);
    active_(0, static_cast<int>(k)) = lane_[k].runs;
    waited_for += lane_[k].runs;
  }
  while (waited_for > 0) {
    for (int k = 0; k < n_lanes && by_lane; ++k) {
      if (active_(0, k) == 0) continue;
      take_scalars(k);
      find_law_forces(k);
    }
    solve(step, drive);
    for (int k = 0; k < n_lanes && by_lane; ++k) {
      if (active_(0, k) != 0) find_forces(k, iterations[static_cast<std::size_t>(k)].again());
    }
    if (by_lane) kernel_.take_forces(numbers_.arms(), motion_, forces_.data());
    if (together) {
      for (int k = 0; k < kernel_.lanes; ++k) {  // those that are left over go with the first
        fresh_(0, k) = !iterations[static_cast<std::size_t>(k < n_lanes ? k : 0)].again();
      }
      kernel_.turn(numbers_.arms(), motion_, fresh_.data());
    }
    kernel_.correct(numbers_.arms(), motion_, step, active_.data(), sizes_.data());
    for (int k = 0; k < n_lanes; ++k) {
      if (active_(0, k) == 0) continue;
      Lane& lane = lane_[static_cast<std::size_t>(k)];
      ++lane.statistics.iterations;
      const auto verdict = iterations[static_cast<std::size_t>(k)].judge(sizes_(0, k));
      if (verdict == StepIteration::Verdict::go_on) continue;
      if (verdict == StepIteration::Verdict::factor && factor(k, step.h)) continue;
      lane.runs = verdict == StepIteration::Verdict::converged;
      active_(0, k) = 0;
      --waited_for;
    }
  }
}

template class StepperIn<2>;
template class StepperIn<3>;

}  // namespace flexarm::lanes
