#include "flexarm/reduction/quality.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "flexarm/dense.hpp"

namespace flexarm::reduction {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using linear_solvers::LowerTriangle;
using std::numbers::pi;

// The sums (2) are quadratic in this residual.
constexpr double mass_tolerance = 1e-7;
constexpr int mass_turns = 300;
// Between the first mode left out and the highest frequency to be trusted, by custom.
constexpr double safety = 1.5;
constexpr double trusted_error = 0.01;

/// X = M_ii⁻¹ F by conjugate gradients, preconditioned by the diagonal: a mass matrix is well-conditioned, so
/// some tens of turns do. `free` is one where a freedom is inner and has mass, zero elsewhere.
MatrixXd solve_mass(const LowerTriangle& M, const VectorXd& free, const MatrixXd& F) {
  const VectorXd inverse = free.cwiseQuotient(linear_solvers::diagonal(M).cwiseMax(1e-300));
  MatrixXd X = MatrixXd::Zero(F.rows(), F.cols()), R = free.asDiagonal() * F, Z = inverse.asDiagonal() * R,
           P = Z;
  VectorXd rz = R.cwiseProduct(Z).colwise().sum();
  const VectorXd target = mass_tolerance * mass_tolerance * rz;
  for (int turn = 0; turn < mass_turns && (rz.array() > target.array()).any(); ++turn) {
    const MatrixXd MP = free.asDiagonal() * linear_solvers::multiply(M, P);
    const VectorXd curvature = P.cwiseProduct(MP).colwise().sum();
    const VectorXd step = (curvature.array() > 0).select(rz.cwiseQuotient(curvature), 0.0);
    X += P * step.asDiagonal();
    R -= MP * step.asDiagonal();
    Z = inverse.asDiagonal() * R;
    const VectorXd next = R.cwiseProduct(Z).colwise().sum();
    const VectorXd turned = (rz.array() > 0).select(next.cwiseQuotient(rz), 0.0);
    P = Z + P * turned.asDiagonal();
    rz = next;
  }
  return X;
}

VectorXd inner_with_mass(const LowerTriangle& M, const InterfaceMaps& maps) {
  VectorXd free = (linear_solvers::diagonal(M).array() > 0).cast<double>();
  for (Index j = 0; j < free.size(); ++j) {
    if (maps.follows[static_cast<std::size_t>(j)]) free[j] = 0;
  }
  return free;
}

/// Eq. (2), on W u = 0 where there are average interfaces.
VectorXd movable(const LowerTriangle& M, const InterfaceMaps& maps, const MatrixXd& MR) {
  const VectorXd free = inner_with_mass(M, maps);
  MatrixXd F(MR.rows(), MR.cols() + maps.average.cols());
  F << MR, MatrixXd(maps.average);
  const MatrixXd X = solve_mass(M, free, F);
  VectorXd sum = (F.leftCols(6).transpose() * X.leftCols(6)).diagonal();
  if (maps.average.cols() > 0) {
    const MatrixXd S = maps.average.transpose() * X.rightCols(maps.average.cols());
    const MatrixXd held = maps.average.transpose() * X.leftCols(6);
    sum -= (held.transpose() * S.ldlt().solve(held)).diagonal();
  }
  return sum.cwiseMax(0.0);
}

}  // namespace

void compute_mass_properties(const LowerTriangle& M, const Coordinates& coordinates,
                             const InterfaceMaps& maps, const Support& support, const MatrixXd& shapes,
                             ReductionQuality& quality) {
  const MatrixXd about_mean = rigid_motion(coordinates, support.centre);
  const MatrixXd rough = about_mean.transpose() * linear_solvers::multiply(M, about_mean);
  quality.mass = rough.topLeftCorner<3, 3>().trace() / 3;
  // The upper right block of RᵀMR is −m c~.
  const Eigen::Matrix3d moment = rough.topRightCorner<3, 3>();
  const Vector3d first(moment(1, 2) - moment(2, 1), moment(2, 0) - moment(0, 2), moment(0, 1) - moment(1, 0));
  quality.centre = support.centre;
  if (quality.mass > 0) quality.centre += first / (2 * quality.mass);
  const MatrixXd R = rigid_motion(coordinates, quality.centre);
  const MatrixXd MR = linear_solvers::multiply(M, R);
  quality.inertia = (R.transpose() * MR).bottomRightCorner<3, 3>();
  quality.effective_mass = (shapes.transpose() * MR).cwiseAbs2();  // eq. (1)
  quality.movable_mass = movable(M, maps, MR);
}

void estimate_errors(const LowerTriangle& K, const LowerTriangle& M, const FixedInterface& part,
                     const MatrixXd& T, const MatrixXd& stiffness, const MatrixXd& mass,
                     double left_out_lambda, ReductionQuality& quality) {
  quality.left_out_frequency_hz = std::sqrt(left_out_lambda) / (2 * pi);
  quality.trusted_frequency_hz = quality.left_out_frequency_hz / safety;
  if (!dense::is_positive_definite(mass)) return;  // interfaces without mass: no free modes
  const dense::Eigenpairs free = dense::eigenpairs(stiffness, mass);
  // Of modes near the first left out S bounds nothing, and their rows of (3) would spoil the whole spectrum.
  const double highest = left_out_lambda / (safety * safety);
  const Index last = (free.values.array() < highest).count(), n = std::max<Index>(last - 6, 0);
  if (n == 0) return;
  const VectorXd lambda = free.values.segment(6, n);
  const MatrixXd U = T * free.vectors.middleCols(6, n);
  const MatrixXd r = linear_solvers::multiply(K, U) - linear_solvers::multiply(M, U) * lambda.asDiagonal();
  const VectorXd S = (1 - lambda.array() / left_out_lambda).rsqrt();
  const MatrixXd E = S.asDiagonal() * (r.transpose() * part.solve(r)) * S.asDiagonal();
  const MatrixXd condensed = MatrixXd(lambda.asDiagonal()) - 0.5 * (E + E.transpose());  // eq. (3)
  const VectorXd better = dense::eigenpairs(condensed).values.cwiseMax(0.0);
  quality.free_frequency_hz = lambda.cwiseSqrt() / (2 * pi);
  quality.free_frequency_error = 1 - better.cwiseQuotient(lambda).cwiseSqrt().array().min(1.0);
  for (Index k = 0; k < n; ++k) {
    if (quality.free_frequency_error[k] <= trusted_error) continue;
    const double doubtful = quality.free_frequency_hz[k] * (1 - quality.free_frequency_error[k]);
    quality.trusted_frequency_hz = std::min(quality.trusted_frequency_hz, doubtful);  // eq. (4)
  }
}

}  // namespace flexarm::reduction
