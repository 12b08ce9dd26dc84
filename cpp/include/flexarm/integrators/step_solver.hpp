/// @file
/// Corrections of an iterate by eq. (5) of integrators/hht.hpp, with factors that are kept from step to step.
///
/// Rigid joints are condensed (rigid_joint_condensation.hpp), the factors are those of an earlier state
/// (linear_solvers/cached_factorisation.hpp), and what has changed in few directions since is added to them
/// (woodbury_update.hpp).
#pragma once

#include <memory>

#include "flexarm/assembly/iteration_matrix.hpp"
#include "flexarm/integrators/hht_coefficients.hpp"
#include "flexarm/integrators/rigid_joint_condensation.hpp"
#include "flexarm/integrators/woodbury_update.hpp"
#include "flexarm/linear_solvers/cached_factorisation.hpp"

namespace flexarm::integrators {

using assembly::LoadsIn;
using assembly::StateIn;
using assembly::SystemIn;
using Eigen::VectorXd;

struct HhtOptions {
  double tolerance = 1e-10;              ///< of positions, in parts of the reach and rad
  double acceleration_tolerance = 1e-5;  ///< of accelerations, in parts of the reach and rad [1/s²]
  int max_iterations = 12;               ///< before new factors, or a smaller step
  int max_halvings = 8;
  double slow_contraction = 0.25;  ///< above this rate the matrix is factored anew
  bool reproducible = false;       ///< see HhtMemory; factoring then costs an analysis of the pattern too
  bool condense = false;           ///< condense rigid joints; their forces wait for recover_multipliers()
};

/// Where factors were made.
template <int D>
struct LinearisationIn {
  StateIn<D> state;
  LoadsIn<D> loads;
  double h = 0;
};
using Linearisation = LinearisationIn<3>;

template <int D>
class StepSolverIn {
 public:
  StepSolverIn(const SystemIn<D>& system, const HhtCoefficients& coefficients, const HhtOptions& options);

  const RigidJointCondensationIn<D>& condensation() const { return condensation_; }
  /// Whether there are factors for steps of this size.
  bool has_factors(double h) const { return h == factored_h_; }
  void forget_factors() { factored_h_ = 0; }
  /// Whether the matrix of the last attempt to factor was singular or not finite.
  bool singular() const { return singular_; }

  /// Factors S in a state. @return false if it is singular; there are no factors then
  bool factor(const StateIn<D>& state, const LoadsIn<D>& loads, double h);
  /// Where the factors at hand were made, if there are any and options ask for reproducible steps; else null.
  std::shared_ptr<const LinearisationIn<D>> factored() const {
    return factored_h_ == 0 ? nullptr : factored_;
  }
  /// Makes the factors of another solver, unless they are at hand.
  /// @throws NotConverged if that matrix is singular.
  void recall(const std::shared_ptr<const LinearisationIn<D>>& factored);

  /// Increments Δ of the free coordinates, and of the multipliers behind them.
  /// @param r, phi residuals. @param again in this step, with factors as they were
  const VectorXd& solve(const StateIn<D>& state, const VectorXd& r, const VectorXd& phi, double h,
                        bool again);

 private:
  const SystemIn<D>& system_;
  HhtCoefficients coefficients_;
  bool reproducible_;
  double scale_;  // s of (5), times β h²
  assembly::IterationMatrixIn<D> matrix_;
  RigidJointCondensationIn<D> condensation_;
  WoodburyUpdateIn<D> update_;
  linear_solvers::CachedFactorisation factor_;
  double factored_h_ = 0;  // step for which the factors hold; 0: none
  bool singular_ = false;
  std::shared_ptr<const LinearisationIn<D>> factored_;
  VectorXd dx_, reduced_;  // y of rigid_joint_condensation.hpp
};

}  // namespace flexarm::integrators
