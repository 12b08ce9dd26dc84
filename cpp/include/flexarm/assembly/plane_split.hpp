/// @file
/// What of a matrix a plane of motion splits: twists within and across it, and how far they are coupled.
///
/// For nodes with the same axes, P and Q as in geometry/plane.hpp, rotations counted per length so that all
/// columns have one unit, the coupling of a symmetric matrix is the largest of
///
///     |q A p| / √(A_q A_p),   p a column of P, q of Q, A_p = pᵀ A p                                  (1)
///
/// where A_p and A_q of whatever resists less than a translation count as that of a translation.
#pragma once

#include "flexarm/elements/superelement.hpp"
#include "flexarm/geometry/plane.hpp"

namespace flexarm::assembly {

/// Of couplings in reduced parts, whose modes come from an iteration that stops near this.
inline constexpr double reduced = 1e-9;

/// Twists within and across the plane of `nodes` nodes with the same axes, then combinations of modes.
struct Split {
  Eigen::MatrixXd within, across;

  Split(const geometry::PlaneAxes& axes, int nodes, double length, const Eigen::MatrixXd& kept,
        const Eigen::MatrixXd& left_out);
  Split(const geometry::PlaneAxes& axes, int nodes, double length);

  /// Equation (1).
  double coupling(const Eigen::MatrixXd& A) const;
};

/// Combinations of a part's modes: those that the plane moves, and the rest.
struct ModeSplit {
  Eigen::MatrixXd kept, left_out;
};

/// Modes of one frequency may come as any combination of each other, so each group of equal frequencies is
/// turned until its first members take all that couples it to the plane.
ModeSplit split_modes(const elements::SuperElement& part, const geometry::PlaneAxes& axes);

}  // namespace flexarm::assembly
