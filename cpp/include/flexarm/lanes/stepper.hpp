/// @file
/// Arms of one structure that step together, one a lane of vector registers.
///
/// Each lane makes the steps of integrators/hht.hpp: it stops iterating by its own increments and waits for
/// the others, and no number of it depends on theirs, so that an arm moves the same way in any company. Laws
/// that are not linear are followed lane by lane (integrators/woodbury_update.hpp), with them inner hinges.
/// Where an iteration fails, the arm leaves its lane: it is to run alone.
#pragma once

#include <memory>
#include <vector>

#include "flexarm/assembly/iteration_matrix.hpp"
#include "flexarm/integrators/hht.hpp"
#include "flexarm/integrators/woodbury_update.hpp"
#include "flexarm/lanes/arm_numbers.hpp"
#include "flexarm/linear_solvers/cached_factorisation.hpp"

namespace flexarm::lanes {

template <int D>
class StepperIn {
 public:
  /// @param arms of one structure, which suit, up to as many as the kernel has lanes; with the loads on each
  /// and the states where they start, at rest
  StepperIn(const Kernel& kernel, const std::vector<const SystemIn<D>*>& arms,
            const std::vector<LoadsIn<D>>& loads, const std::vector<StateIn<D>>& states,
            const integrators::HhtCoefficients& coefficients, const integrators::HhtOptions& options);

  /// One step of size h along drives that all arms share.
  void advance(double h, const integrators::Drives& drives);

  bool runs(int lane) const { return lane_[static_cast<std::size_t>(lane)].runs; }
  bool any_runs() const;
  void set_time(double t) { t_ = t; }  ///< with no drift from adding up
  const integrators::HhtStatistics& statistics(int lane) const {
    return lane_[static_cast<std::size_t>(lane)].statistics;
  }
  StateIn<D> state(int lane) const;
  /// The same with the forces of joints that steps leave out.
  StateIn<D> final_state(int lane) const;

  /// Change of accelerations and multipliers by Φ'' that record() is to add, see ArmNumbersIn.
  void set_consistent(int lane, const Eigen::MatrixXd& change, const integrators::WoodburyUpdateIn<D>& update,
                      const Eigen::MatrixXd& W) {
    numbers_.set_consistent(lane, change, update, W);
  }
  int recorded_rows() const { return 2 * D * numbers_.arms().n_points + 6 * numbers_.arms().n_outputs; }
  /// See Kernel::record.
  void record(double* rows) { kernel_.record(numbers_.arms(), motion_, rows); }

 private:
  struct Lane {
    const SystemIn<D>* arm;
    LoadsIn<D> loads;
    StateIn<D> now;  // as it started, but for what laws need
    assembly::IterationMatrixIn<D> matrix;
    integrators::WoodburyUpdateIn<D> update;
    /// Where the lane's matrix is not cut as those of others, as when entries have joined its pattern.
    std::unique_ptr<linear_solvers::CachedFactorisation> own_factor = {};
    Eigen::VectorXd increments = {};  // of its own factors
    bool runs = true;
    double contraction = 0.5;
    integrators::HhtStatistics statistics = {};
  };

  void put(int lane, const StateIn<D>& state);
  void take_scalars(int lane);
  void find_law_forces(int lane);
  bool turns_together() const { return own_laws_.empty() && lane_.front().update.any(); }
  void find_forces(int lane, bool again);
  void take_unknowns(int lane, Eigen::VectorXd& x) const;
  void put_unknowns(int lane, const Eigen::VectorXd& x);
  void solve(const Step& step, const Drive& drive);
  bool factor(int lane, double h);
  void iterate(const Step& step, const Drive& drive);

  const Kernel& kernel_;
  integrators::HhtCoefficients coefficients_;
  integrators::HhtOptions options_;
  ArmNumbersIn<D> numbers_;
  std::vector<Lane> lane_;
  double t_, factored_h_ = 0;
  double start_;  ///< of the runs [s]
  long steps_ = 0;
  integrators::DriveValues drive_;
  Rows frames_, frames_before_, s_, s_before_, v_, v_dot_, a_, multipliers_, exponent_, r_, dx_, work_,
      acceleration_, law_forces_, forces_, active_, fresh_, sizes_;
  Eigen::VectorXd along_;      // scratch
  std::vector<int> own_laws_;  // whose forces are found lane by lane
  std::vector<int> growing_;   // lanes with beams whose bow grows
  Motion motion_;
};

}  // namespace flexarm::lanes
