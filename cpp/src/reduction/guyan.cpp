#include "flexarm/reduction/guyan.hpp"

#include "flexarm/dense.hpp"

namespace flexarm::reduction {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linear_solvers::LowerTriangle;

/// Factors that give freedoms one unit: 1 for translations, `length` for rotations.
VectorXd equal_units(Index n_freedoms, double length) {
  VectorXd scale(n_freedoms);
  for (Index k = 0; k < n_freedoms; ++k) scale[k] = k % 6 < 3 ? 1 : length;
  return scale;
}

/// Orthonormal basis of R̂, rotations multiplied by the length of the support.
MatrixXd rigid_basis(const std::vector<Interface>& interfaces, const Support& support) {
  const MatrixXd R = rigid_motion(interfaces, support.centre);
  return dense::orthonormal(equal_units(R.rows(), support.length).asDiagonal() * R);
}

/// Ψ := Ψ + (R − Ψ R̂) R̂⁺: eq. (3) to rounding.
void restore_rigid_motion(MatrixXd& Psi, const Coordinates& coordinates,
                          const std::vector<Interface>& interfaces, const Support& support) {
  const VectorXd scale = equal_units(Psi.cols(), support.length);
  const MatrixXd R_hat =
      rigid_motion(interfaces, support.centre) * equal_units(6, support.length).cwiseInverse().asDiagonal();
  const MatrixXd inverse = dense::least_squares(scale.asDiagonal() * R_hat, scale.asDiagonal());
  Psi += (scaled_rigid_motion(coordinates, support) - Psi * R_hat) * inverse;
}

}  // namespace

MatrixXd constraint_modes(const LowerTriangle& K, const FixedInterface& part, const Coordinates& coordinates,
                          const std::vector<Interface>& interfaces, const InterfaceMaps& maps,
                          const Support& support) {
  MatrixXd Psi = maps.rigid;
  const Index n = Psi.cols();
  MatrixXd q_a = MatrixXd::Zero(maps.average.cols(), n);
  for (std::size_t k = 0; k < maps.average_columns.size(); ++k) {
    q_a.block<6, 6>(6 * static_cast<Index>(k), maps.average_columns[k]).setIdentity();
  }
  Psi += part.solve(-linear_solvers::multiply(K, Psi), q_a - maps.average.transpose() * Psi);  // eq. (1)
  restore_rigid_motion(Psi, coordinates, interfaces, support);
  return Psi;
}

InterfaceStiffness interface_stiffness(const LowerTriangle& K, const MatrixXd& Psi,
                                       const std::vector<Interface>& interfaces, const Support& support) {
  const MatrixXd raw = Psi.transpose() * linear_solvers::multiply(K, Psi);  // eq. (2)
  const VectorXd inverse = equal_units(Psi.cols(), support.length).cwiseInverse();
  const MatrixXd scaled = inverse.asDiagonal() * (0.5 * (raw + raw.transpose())) * inverse.asDiagonal();
  const MatrixXd Q = rigid_basis(interfaces, support);
  const MatrixXd P = MatrixXd::Identity(Psi.cols(), Psi.cols()) - Q * Q.transpose();
  const MatrixXd projected = P * scaled * P;
  const VectorXd units = inverse.cwiseInverse();
  const MatrixXd half = 0.5 * units.asDiagonal() * projected * units.asDiagonal();
  const double largest = scaled.cwiseAbs().maxCoeff();
  return {half + half.transpose(), largest > 0 ? (projected - scaled).cwiseAbs().maxCoeff() / largest : 0};
}

}  // namespace flexarm::reduction
