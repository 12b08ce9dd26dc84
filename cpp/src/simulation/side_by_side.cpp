#include "flexarm/simulation/side_by_side.hpp"

#include <algorithm>
#include <chrono>
#include <limits>

#include "flexarm/lanes/stepper.hpp"
#include "flexarm/simulation/consistent_forces.hpp"
#include "flexarm/simulation/consistent_start.hpp"
#include "flexarm/simulation/in_space.hpp"
#include "flexarm/simulation/recorder.hpp"

namespace flexarm::simulation {
namespace {

using assembly::PlanarSystem;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using lanes::Rows;

/// Instants that are kept in the lanes' order before they go to the runs.
constexpr Eigen::Index instants_at_once = 32;

using Clock = std::chrono::steady_clock;
double seconds_since(Clock::time_point t) { return std::chrono::duration<double>(Clock::now() - t).count(); }

/// An arm where its motion is computed.
template <int D>
struct Placed {
  std::size_t which;  // of the variants
  const assembly::SystemIn<D>* system;
  assembly::StateIn<D> state;
  assembly::LoadsIn<D> loads;
  std::unique_ptr<PlanarSystem> plane = {};  // which is the system in a plane

  InSpace<D> space() const {
    if constexpr (D == 2) {
      return InSpace<2>(*plane);
    } else {
      return {};
    }
  }
};

bool records_what_lanes_have(const TransientOptions& options) {
  return !options.record_rotations && !options.record_energies && !options.record_forces;
}

bool shake_alike(const assembly::PedestalCoordinates& one, const assembly::PedestalCoordinates& other) {
  const auto &a = one.shaking, &b = other.shaking;
  if (a.amplitude == 0 && b.amplitude == 0) return true;
  return a.amplitude == b.amplitude && a.frequency == b.frequency && a.phase == b.phase &&
         one.cosines == other.cosines;
}

/// Locked joints stay where they are, drives of links go backwards through transmissions, and pedestals are
/// shaken: only if these are alike, drives mean the same.
template <int D>
bool same_drives(const Placed<D>& one, const Placed<D>& other) {
  if (!shake_alike(one.system->pedestal(), other.system->pedestal())) return false;
  for (std::size_t j = 0; j < one.system->joints().size(); ++j) {
    const int phi = one.system->joints()[j].phi;
    if (phi < 0) continue;
    const assembly::DriveKind kind = one.system->drives()[j];
    if (kind == assembly::DriveKind::locked && one.state.s[phi] != other.state.s[phi]) return false;
    if (kind != assembly::DriveKind::link_angle) continue;
    const auto *teeth = one.system->transmission(static_cast<int>(j)),
               *others = other.system->transmission(static_cast<int>(j));
    if (teeth != nullptr && others != nullptr && !(*teeth == *others)) return false;
  }
  return true;
}

/// Tells a lane what Φ'' and turned joints change in accelerations of free scalar coordinates and in
/// multipliers, consistent_forces.hpp (2).
template <int D>
void make_consistent(const Placed<D>& arm, int lane, lanes::StepperIn<D>& stepper) {
  const assembly::SystemIn<D>& system = *arm.system;
  const Eigen::Index m = system.n_constraints(), n_free = system.n_free(), first = system.scalar_offset();
  const Eigen::Index n_changed = n_free - first + m;
  ConsistentForcesIn<D> forces(system, system.constraints().size());
  const auto& update = forces.update();
  MatrixXd change(n_changed + update.W().cols(), m);
  for (Eigen::Index k = 0; k < m; ++k) {
    VectorXd x = VectorXd::Zero(system.n_unknowns());
    x[n_free + k] = -forces.scale();
    forces.solve(arm.state, x);
    change.col(k) << x.tail(n_changed), update.along(x);
  }
  MatrixXd W = update.W().bottomRows(n_changed);
  change.middleRows(n_free - first, m) *= forces.scale();
  W.bottomRows(m) *= forces.scale();
  stepper.set_consistent(lane, change, update, W);
}

/// Runs of up to as many arms as there are lanes.
template <int D>
class Group {
 public:
  Group(const lanes::Kernel& kernel, std::vector<Placed<D>> arms, const TransientOptions& options,
        Eigen::Index n_steps)
      : arms_(std::move(arms)),
        options_(options),
        n_steps_(n_steps),
        lanes_(kernel.lanes),
        stepper_(kernel, systems(), loads(), states(),
                 integrators::HhtCoefficients::from_alpha(options.alpha), {.tolerance = options.tolerance}),
        block_(static_cast<int>(instants_at_once) * stepper_.recorded_rows(), lanes_),
        runs_(arms_.size()) {
    if (options.has_consistent_forces()) {
      for (int k = 0; k < size(); ++k) make_consistent(arms_[at(k)], k, stepper_);
    }
    for (std::size_t k = 0; k < arms_.size(); ++k) {
      // Its constructor makes room for what is recorded.
      RecorderIn<D>(*arms_[k].system, options, n_steps + 1, runs_[k], arms_[k].space());
    }
  }

  /// @return false if `told` says so
  bool run(const integrators::Drives& drives, const std::function<bool(Eigen::Index steps)>& told) {
    const auto began = Clock::now();
    auto called = began;
    record(0);
    Eigen::Index k = 1;
    bool goes_on = true;
    for (; k <= n_steps_ && goes_on && stepper_.any_runs(); ++k) {
      stepper_.advance(options_.step, drives);
      stepper_.set_time(time(k));
      record(k);
      if (k % instants_at_once == 0 && seconds_since(called) > seconds_between_calls) {
        called = Clock::now();
        goes_on = told(k);
      }
    }
    empty(k - 1);
    for (Transient& run : runs_) {
      run.seconds = seconds_since(began) / static_cast<double>(arms_.size());
      run.dimension = D;
      run.cancelled = k <= n_steps_;
      if (run.cancelled) run.finish(k);
    }
    return goes_on;
  }

  void hand_over(const std::vector<Variant>& variants, std::vector<std::optional<Transient>>& found) {
    for (int k = 0; k < size(); ++k) {
      if (!stepper_.runs(k)) continue;
      const Placed<D>& arm = arms_[at(k)];
      Transient& run = runs_[at(k)];
      run.statistics = stepper_.statistics(k);
      if constexpr (D == 2) {
        run.final_state = arm.plane->embed(stepper_.final_state(k), variants[arm.which].equilibrium->state);
      } else {
        run.final_state = stepper_.final_state(k);
      }
      found[arm.which] = std::move(run);
    }
  }

 private:
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }
  int size() const { return static_cast<int>(arms_.size()); }
  double time(Eigen::Index k) const { return options_.start + static_cast<double>(k) * options_.step; }

  std::vector<const assembly::SystemIn<D>*> systems() const {
    std::vector<const assembly::SystemIn<D>*> all;
    for (const Placed<D>& arm : arms_) all.push_back(arm.system);
    return all;
  }
  std::vector<assembly::LoadsIn<D>> loads() const {
    std::vector<assembly::LoadsIn<D>> all;
    for (const Placed<D>& arm : arms_) all.push_back(arm.loads);
    return all;
  }
  std::vector<assembly::StateIn<D>> states() const {
    std::vector<assembly::StateIn<D>> all;
    for (const Placed<D>& arm : arms_) all.push_back(arm.state);
    return all;
  }

  void record(Eigen::Index k) {
    if (k > 0 && k % instants_at_once == 0) empty(k - 1);
    const Eigen::Index row = (k % instants_at_once) * stepper_.recorded_rows();
    stepper_.record(block_.data() + row * lanes_);
  }

  /// Hands on the instants of the block, the last of which is the k-th.
  void empty(Eigen::Index last) {
    const Eigen::Index first = last - last % instants_at_once;
    for (Eigen::Index k = first; k <= last; ++k) {
      for (Transient& run : runs_) run.time[k] = time(k);
    }
    for (int lane = 0; lane < size(); ++lane) {
      int row = 0;
      if (options_.record_points) {
        row = hand_on_points(lane, first, last);
      } else {
        row = 2 * D * static_cast<int>(arms_[at(lane)].system->points().size());
      }
      if (options_.record_joints) hand_on_joints(lane, row, first, last);
    }
  }

  int hand_on_points(int lane, Eigen::Index first, Eigen::Index last) {
    const InSpace<D> space = arms_[at(lane)].space();
    const int n_points = static_cast<int>(arms_[at(lane)].system->points().size());
    for (int p = 0; p < n_points; ++p) {
      for (Eigen::Index k = first; k <= last; ++k) {
        Point<D> x, v;
        for (int i = 0; i < D; ++i) {
          x[i] = number(lane, 2 * D * p + i, k);
          v[i] = number(lane, 2 * D * p + D + i, k);
        }
        runs_[at(lane)].position.col(k).segment<3>(3 * p) = space.place(p, x);
        runs_[at(lane)].velocity.col(k).segment<3>(3 * p) = space.arrow(v);
      }
    }
    return 2 * D * n_points;
  }

  void hand_on_joints(int lane, int row, Eigen::Index first, Eigen::Index last) {
    Transient& run = runs_[at(lane)];
    const auto& joints = arms_[at(lane)].system->joints();
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const bool moves = joints[j].theta >= 0;
      for (MatrixXd* column : {&run.joint_angle, &run.joint_rate, &run.drive_angle, &run.drive_rate,
                               &run.motor_torque, &run.joint_torque}) {
        double* to = column->data() + j;
        for (Eigen::Index k = first; k <= last; ++k) {
          to[k * column->rows()] = moves ? number(lane, row, k) : 0.0;
        }
        row += moves;
      }
    }
  }

  /// Of the block, by the instant of the run.
  double number(int lane, int row, Eigen::Index k) const {
    return block_(static_cast<int>(k % instants_at_once) * stepper_.recorded_rows() + row, lane);
  }

  std::vector<Placed<D>> arms_;
  const TransientOptions& options_;
  Eigen::Index n_steps_;
  int lanes_;
  lanes::StepperIn<D> stepper_;
  Rows block_;
  std::vector<Transient> runs_;
};

/// Puts an arm to those of its structure, if it suits.
template <int D>
void sort_in(Placed<D> arm, const TransientOptions& options, std::vector<std::vector<Placed<D>>>& groups) {
  arm.state.t = arm.state.start = options.start;
  if (!lanes::suits(*arm.system, arm.loads, options.has_consistent_forces())) return;
  const auto group = std::find_if(groups.begin(), groups.end(), [&](const auto& others) {
    return lanes::same_structure(*others.front().system, *arm.system) && same_drives(others.front(), arm);
  });
  if (group == groups.end()) {
    groups.emplace_back().push_back(std::move(arm));
  } else {
    group->push_back(std::move(arm));
  }
}

/// Runs of all groups, as many at a time as there are lanes.
class Runs {
 public:
  Runs(const std::vector<Variant>& variants, const std::vector<PiecewisePolynomial>& drives,
       const TransientOptions& options, const Progress& progress)
      : variants_(variants),
        drives_(drives),
        options_(options),
        progress_(progress),
        found(variants.size()) {}

  /// @return false if the progress says so
  template <int D>
  bool make(std::vector<std::vector<Placed<D>>> groups) {
    for (auto& arms : groups) {
      while (!arms.empty()) {
        const lanes::Kernel& kernel = *lanes::kernel_for(D, static_cast<int>(arms.size()));
        const std::size_t n = std::min(arms.size(), static_cast<std::size_t>(kernel.lanes));
        std::vector<Placed<D>> some(std::make_move_iterator(arms.end() - static_cast<std::ptrdiff_t>(n)),
                                    std::make_move_iterator(arms.end()));
        arms.resize(arms.size() - n);
        if (!make_some(kernel, std::move(some))) return false;
        done_ += n;
      }
    }
    return true;
  }

 private:
  template <int D>
  bool make_some(const lanes::Kernel& kernel, std::vector<Placed<D>> some) {
    const auto n = static_cast<double>(some.size());
    const auto drive = drives_of_joints<D>(*some.front().system, some.front().state, drives_);
    const Eigen::Index n_steps = number_of_steps(some.front().system->joints().size(), drives_, options_);
    Group<D> group(kernel, std::move(some), options_, n_steps);
    const auto told = [&](Eigen::Index k) {
      const double here = static_cast<double>(k) / static_cast<double>(n_steps);
      const double share = static_cast<double>(done_) + here * n;
      return !progress_ || progress_(share / static_cast<double>(variants_.size()));
    };
    const bool goes_on = group.run(drive, told);
    group.hand_over(variants_, found);
    return goes_on;
  }

  const std::vector<Variant>& variants_;
  const std::vector<PiecewisePolynomial>& drives_;
  const TransientOptions& options_;
  const Progress& progress_;
  std::size_t done_ = 0;

 public:
  std::vector<std::optional<Transient>> found;
};

}  // namespace

int arms_side_by_side() {
  const lanes::Kernel* widest = lanes::kernel_for(2, std::numeric_limits<int>::max());
  return widest == nullptr ? 0 : widest->lanes;
}

std::vector<std::optional<Transient>> simulate_side_by_side(const std::vector<Variant>& variants,
                                                            const std::vector<PiecewisePolynomial>& drives,
                                                            const TransientOptions& options,
                                                            const Progress& progress) {
  Runs runs(variants, drives, options, progress);
  if (!records_what_lanes_have(options) || lanes::kernel_for(2, 1) == nullptr) return runs.found;
  std::vector<std::vector<Placed<2>>> in_planes;
  std::vector<std::vector<Placed<3>>> in_space;
  for (std::size_t k = 0; k < variants.size(); ++k) {
    const auto& [system, equilibrium] = variants[k];
    number_of_steps(system->joints().size(), drives, options);
    Equilibrium start = consistent_start(
        *system, *equilibrium, drives_of_joints<3>(*system, equilibrium->state, drives), options.start);
    std::unique_ptr<PlanarSystem> plane;
    if (options.dimension != Dimension::space) {
      plane = PlanarSystem::about(*system, start.state, start.loads).system;
    }
    if (plane) {
      const PlanarSystem& in_it = *plane;
      sort_in<2>({k, &in_it, in_it.part(start.state), in_it.part(start.loads), std::move(plane)}, options,
                 in_planes);
    } else if (options.dimension != Dimension::plane) {
      sort_in<3>({k, system, std::move(start.state), std::move(start.loads)}, options, in_space);
    }
  }
  if (runs.make(std::move(in_planes))) runs.make(std::move(in_space));
  return std::move(runs.found);
}

}  // namespace flexarm::simulation
