#include "flexarm/elements/superelement.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <cmath>

#include "flexarm/errors.hpp"

namespace flexarm::elements {
namespace {

using namespace geometry;

Vector6d offset(const Vector3d& from, const Vector3d& to) {
  Vector6d d = Vector6d::Zero();
  d.head<3>() = to - from;
  return d;
}

/// Motion of a point at `arm` from the centre of a unit rigid motion.
Matrix6d rigid_motion(const Vector3d& arm) {
  Matrix6d R = Matrix6d::Identity();
  R.topRightCorner<3, 3>() = -skew(arm);
  return R;
}

void check(const model::SuperElementLink& part) {
  const auto n = static_cast<Eigen::Index>(part.frames.size());
  const auto refuse = [&](const std::string& what) {
    throw InvalidParameter("link '" + part.name + "': " + what);
  };
  if (n == 0 || part.interfaces.size() != part.frames.size()) {
    refuse("a super-element needs at least one interface, each with a name and a frame");
  }
  const Eigen::Index size = part.stiffness.rows();
  const auto fits = [&](const MatrixXd& matrix) { return matrix.rows() == size && matrix.cols() == size; };
  const bool damping_fits = part.damping.size() == 0 || fits(part.damping);
  if (size < 6 * n || !fits(part.stiffness) || !fits(part.mass) || !damping_fits) {
    refuse("stiffness, mass and damping must be square, of one size, and have six rows an interface; " +
           std::to_string(n) + " interfaces and " + std::to_string(size) + " rows");
  }
}

}  // namespace

SuperElement::SuperElement(const model::SuperElementLink& part, int first_node, int first_mode)
    : name_(part.name), first_node_(first_node), first_mode_(first_mode) {
  check(part);
  for (const Frame& frame : part.frames) positions_.push_back(frame.x);
  const int n = 6 * n_interfaces();
  n_modes_ = static_cast<int>(part.stiffness.rows()) - n;

  MatrixXd R = MatrixXd::Zero(n + n_modes_, 6);
  for (int i = 0; i < n_interfaces(); ++i) {
    R.middleRows<6>(6 * i) = rigid_motion(positions_[i] - positions_[0]);
  }
  rigid_mass_ = R.transpose() * part.mass * R;
  const double mass = rigid_mass_(0, 0);
  if (!(mass > 0)) {
    throw InvalidParameter("link '" + name_ + "': the mass must be positive, got " + std::to_string(mass) +
                           " kg");
  }
  mode_scale_.resize(n_modes_);
  for (int k = 0; k < n_modes_; ++k) {  // modal mass = mass of the part, so that η is a length
    const double modal_mass = part.mass(n + k, n + k);
    mode_scale_[k] = modal_mass > 0 ? std::sqrt(mass / modal_mass) : 1.0;
  }
  G_ = MatrixXd::Zero(n + n_modes_, n - 6 + n_modes_);
  for (int i = 1; i < n_interfaces(); ++i) {
    G_.block<6, 6>(6 * i, 6 * i - 6) = right_tangent(offset(positions_[0], positions_[i]));
  }
  G_.bottomRightCorner(n_modes_, n_modes_) = mode_scale_.asDiagonal();

  VectorXd scale = VectorXd::Ones(n + n_modes_);
  scale.tail(n_modes_) = mode_scale_;
  M_ = scale.asDiagonal() * part.mass * scale.asDiagonal();
  K_ = G_.transpose() * part.stiffness * G_;  // eq. (3)
  C_ = MatrixXd::Zero(K_.rows(), K_.cols());
  if (part.damping.size() > 0) C_ = G_.transpose() * part.damping * G_;
  Gamma_ = G_.transpose() * part.mass * R.leftCols<3>();
  if (part.damping_ratio > 0) set_damping_ratio(part.damping_ratio);
}

Weight SuperElement::weight() const {
  const Matrix3d s = rigid_mass_.bottomLeftCorner<3, 3>();  // s~ = m c~
  return {rigid_mass_(0, 0), 0.5 * Vector3d(s(2, 1) - s(1, 2), s(0, 2) - s(2, 0), s(1, 0) - s(0, 1))};
}

void SuperElement::set_damping_ratio(double zeta) {
  if (K_.rows() == 0) return;
  const Eigen::LLT<MatrixXd> factor(K_);
  if (factor.info() != Eigen::Success) {
    throw InvalidParameter("link '" + name_ +
                           "': a damping ratio needs a stiffness that resists every deformation");
  }
  MatrixXd G = G_;
  G.bottomRightCorner(n_modes_, n_modes_).setIdentity();  // M counts the amplitudes in η already
  const MatrixXd half = factor.matrixL().solve(G.transpose() * M_ * G);
  const MatrixXd A = factor.matrixL().solve(half.transpose());
  const Eigen::SelfAdjointEigenSolver<MatrixXd> modes(0.5 * (A + A.transpose()), Eigen::EigenvaluesOnly);
  C_ = 2 * zeta * std::sqrt(modes.eigenvalues().maxCoeff()) * K_;
}

VectorXd SuperElement::strains(const Configuration& at) const {
  VectorXd d(6 * n_interfaces() - 6);
  for (int i = 1; i < n_interfaces(); ++i) {
    d.segment<6>(6 * i - 6) = log6(relative(at.frames[0], at.frames[i]));
  }
  return d;
}

VectorXd SuperElement::deformation(const Configuration& at) const {
  VectorXd epsilon(K_.rows());
  epsilon << strains(at), at.eta;
  for (int i = 1; i < n_interfaces(); ++i) {
    epsilon.segment<6>(6 * i - 6) -= offset(positions_[0], positions_[i]);  // eq. (1)
  }
  return epsilon;
}

MatrixXd SuperElement::strain_matrix(const VectorXd& d) const {
  MatrixXd B = MatrixXd::Zero(K_.rows(), size());
  for (int i = 1; i < n_interfaces(); ++i) {
    const Vector6d d_i = d.segment<6>(6 * i - 6);
    B.block<6, 6>(6 * i - 6, 0) = -left_tangent_inverse(d_i);  // eq. (2)
    B.block<6, 6>(6 * i - 6, 6 * i) = right_tangent_inverse(d_i);
  }
  B.bottomRightCorner(n_modes_, n_modes_).setIdentity();
  return B;
}

VectorXd SuperElement::to_nodes(const VectorXd& d, const VectorXd& sigma) const {
  VectorXd f = VectorXd::Zero(size());
  for (int i = 1; i < n_interfaces(); ++i) {
    const auto pair = InverseTangent(d.segment<6>(6 * i - 6)).transpose_times(sigma.segment<6>(6 * i - 6));
    f.head<6>() -= pair.left;
    f.segment<6>(6 * i) = pair.right;
  }
  f.tail(n_modes_) = sigma.tail(n_modes_);
  return f;
}

SuperElement::Forces SuperElement::internal_forces(const Configuration& at, const VectorXd& V,
                                                   const Vector3d& gravity) const {
  const VectorXd d = strains(at), epsilon = deformation(at);
  const Vector3d gamma = at.frames[0].R.transpose() * gravity;
  VectorXd epsilon_dot(K_.rows());
  for (int i = 1; i < n_interfaces(); ++i) {
    epsilon_dot.segment<6>(6 * i - 6) =
        InverseTangent(d.segment<6>(6 * i - 6)).strain_rate(V.head<6>(), V.segment<6>(6 * i));  // eq. (2)
  }
  epsilon_dot.tail(n_modes_) = V.tail(n_modes_);

  Forces out;
  const VectorXd elastic = K_ * epsilon, viscous = C_ * epsilon_dot;
  const Vector3d shift = Gamma_.transpose() * epsilon;  // of the first moment, eq. (5)
  out.elastic = 0.5 * epsilon.dot(elastic);
  out.gravity = -gamma.dot(shift);
  out.dissipation = epsilon_dot.dot(viscous);
  out.f = to_nodes(d, elastic + viscous - Gamma_ * gamma);  // eq. (3)
  out.f.segment<3>(3) -= shift.cross(gamma);
  return out;
}

VectorXd SuperElement::inertia_forces(const VectorXd& V, const VectorXd& V_dot) const {
  const VectorXd momentum = M_ * V;
  VectorXd f = M_ * V_dot;
  for (int i = 0; i < n_interfaces(); ++i) {  // eq. (4)
    f.segment<6>(6 * i) -= ad_transpose(V.segment<6>(6 * i), momentum.segment<6>(6 * i));
  }
  return f;
}

MatrixXd SuperElement::stiffness_matrix(const Configuration& at, const VectorXd& V,
                                        const Vector3d& gravity) const {
  const VectorXd d = strains(at), epsilon = deformation(at);
  const Vector3d gamma = at.frames[0].R.transpose() * gravity;
  const MatrixXd B = strain_matrix(d);
  const VectorXd sigma = K_ * epsilon + C_ * (B * V) - Gamma_ * gamma;  // ε' = B V
  MatrixXd material = K_;                                               // and C ∂ε'/∂ε
  for (int i = 1; i < n_interfaces(); ++i) {
    const int k = 6 * i - 6;
    material.middleCols<6>(k) +=
        C_.middleCols<6>(k) * strain_rate_gradient(d.segment<6>(k), V.head<6>(), V.segment<6>(6 * i));
  }
  MatrixXd K = B.transpose() * material * B;
  for (int i = 1; i < n_interfaces(); ++i) {
    const auto geometric = geometric_stiffness(d.segment<6>(6 * i - 6), sigma.segment<6>(6 * i - 6));
    const MatrixXd B_i = B.middleRows<6>(6 * i - 6);
    K.topRows<6>() -= geometric.left * B_i;
    K.middleRows<6>(6 * i) += geometric.right * B_i;
  }
  const MatrixXd turning = B.transpose() * Gamma_ * skew(gamma);  // gravity seen from a turning frame
  K.middleCols<3>(3) -= turning;
  K.middleRows<3>(3) -= turning.transpose();
  K.block<3, 3>(3, 3) -= skew(Gamma_.transpose() * epsilon) * skew(gamma);
  return K;
}

MatrixXd SuperElement::damping_matrix(const Configuration& at) const {
  const MatrixXd B = strain_matrix(strains(at));
  return B.transpose() * C_ * B;
}

MatrixXd SuperElement::gyroscopic_matrix(const VectorXd& V) const {
  const VectorXd momentum = M_ * V;
  MatrixXd D = MatrixXd::Zero(size(), size());
  for (int i = 0; i < n_interfaces(); ++i) {
    const Vector6d v = V.segment<6>(6 * i);
    D.middleRows<6>(6 * i) = -ad(v).transpose() * M_.middleRows<6>(6 * i);
    D.block<6, 6>(6 * i, 6 * i) -= ad_transpose_by_twist(momentum.segment<6>(6 * i));
  }
  return D;
}

SuperElement::Shape SuperElement::shape(const Configuration& at) const {
  return {at.frames[0] * Frame::translation(-positions_[0]), G_ * deformation(at)};
}

}  // namespace flexarm::elements
