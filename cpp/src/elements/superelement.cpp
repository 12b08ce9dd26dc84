#include "flexarm/elements/superelement.hpp"

#include <cmath>

#include "flexarm/dense.hpp"
#include "flexarm/errors.hpp"

namespace flexarm::elements {
namespace {

using namespace geometry;

template <int D>
Twist<D> offset(const Point<D>& from, const Point<D>& to) {
  Twist<D> d = Twist<D>::Zero();
  d.template head<D>() = to - from;
  return d;
}

/// diag(P, …, P, modes) with as many P as there are `interfaces`.
MatrixXd repeated(const Eigen::Matrix<double, 6, 3>& P, int interfaces, const MatrixXd& modes) {
  MatrixXd all = MatrixXd::Zero(6 * interfaces + modes.rows(), 3 * interfaces + modes.cols());
  for (int i = 0; i < interfaces; ++i) all.block<6, 3>(6 * i, 3 * i) = P;
  all.bottomRightCorner(modes.rows(), modes.cols()) = modes;
  return all;
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

template <int D>
SuperElementIn<D>::SuperElementIn(const model::SuperElementLink& part, int first_node, int first_mode)
  requires(D == 3)
    : name_(part.name), first_node_(first_node), first_mode_(first_mode) {
  check(part);
  for (const Frame& frame : part.frames) positions_.push_back(frame.x);
  const int m = 6 * n_interfaces();
  n_modes_ = static_cast<int>(part.stiffness.rows()) - m;

  MatrixXd R = MatrixXd::Zero(m + n_modes_, 6);
  for (int i = 0; i < n_interfaces(); ++i) {
    R.middleRows<6>(6 * i) = rigid_motion(positions_[i] - positions_[0]);
  }
  rigid_mass_ = dense::congruent(part.mass, R);
  const double mass = rigid_mass_(0, 0);
  if (!(mass > 0)) {
    throw InvalidParameter("link '" + name_ + "': the mass must be positive, got " + std::to_string(mass) +
                           " kg");
  }
  mode_scale_.resize(n_modes_);
  for (int k = 0; k < n_modes_; ++k) {  // modal mass = mass of the part, so that η is a length
    const double modal_mass = part.mass(m + k, m + k);
    mode_scale_[k] = modal_mass > 0 ? std::sqrt(mass / modal_mass) : 1.0;
  }
  G_ = MatrixXd::Zero(m + n_modes_, m - 6 + n_modes_);
  for (int i = 1; i < n_interfaces(); ++i) {
    G_.block<6, 6>(6 * i, 6 * i - 6) = geometry::right_tangent<3>(offset<3>(positions_[0], positions_[i]));
  }
  G_.bottomRightCorner(n_modes_, n_modes_) = mode_scale_.asDiagonal();

  VectorXd scale = VectorXd::Ones(m + n_modes_);
  scale.tail(n_modes_) = mode_scale_;
  M_ = scale.asDiagonal() * part.mass * scale.asDiagonal();
  K_ = dense::congruent(part.stiffness, G_);  // eq. (3)
  C_ = MatrixXd::Zero(K_.rows(), K_.cols());
  if (part.damping.size() > 0) C_ = dense::congruent(part.damping, G_);
  Gamma_ = G_.transpose() * part.mass * R.leftCols<3>();
  find_structure();
  if (part.damping_ratio > 0) set_damping_ratio(part.damping_ratio);
}

template <int D>
SuperElementIn<D>::SuperElementIn(const SuperElementIn<3>& part, const PlaneAxes& axes, const MatrixXd& modes,
                                  int first_mode)
  requires(D == 2)
    : name_(part.name_),
      first_node_(part.first_node_),
      first_mode_(first_mode),
      n_modes_(static_cast<int>(modes.cols())),
      mode_scale_(VectorXd::Ones(modes.cols())) {
  for (const Vector3d& p : part.positions_) positions_.push_back(axes.part(p));
  const auto P = axes.within();
  const MatrixXd nodes = repeated(P, n_interfaces(), modes), strains = repeated(P, n_interfaces() - 1, modes);
  M_ = dense::congruent(part.M_, nodes);
  K_ = dense::congruent(part.K_, strains);
  C_ = dense::congruent(part.C_, strains);
  Gamma_ = strains.transpose() * part.Gamma_ * axes.E.leftCols<2>();
  rigid_mass_ = dense::congruent(part.rigid_mass_, P);
  find_structure();
}

template <int D>
WeightIn<D> SuperElementIn<D>::weight() const {
  const auto s = rigid_mass_.template bottomLeftCorner<geometry::turns<D>, D>();  // s~ = m c~
  if constexpr (D == 2) {
    return {rigid_mass_(0, 0), {s(0, 1), -s(0, 0)}};
  } else {
    return {rigid_mass_(0, 0), 0.5 * Vector3d(s(2, 1) - s(1, 2), s(0, 2) - s(2, 0), s(1, 0) - s(0, 1))};
  }
}

template <int D>
void SuperElementIn<D>::set_damping_ratio(double zeta)
  requires(D == 3)
{
  if (K_.rows() == 0) return;
  if (!dense::is_positive_definite(K_)) {
    throw InvalidParameter("link '" + name_ +
                           "': a damping ratio needs a stiffness that resists every deformation");
  }
  MatrixXd G = G_;
  G.bottomRightCorner(n_modes_, n_modes_).setIdentity();  // M counts the amplitudes in η already
  const VectorXd inverse_squares = dense::eigenpairs(dense::congruent(M_, G), K_).values;  // 1/ω²
  C_ = 2 * zeta * std::sqrt(inverse_squares.maxCoeff()) * K_;
  find_structure();
}

template <int D>
VectorXd SuperElementIn<D>::strains(const Configuration& at) const {
  VectorXd d(n * n_interfaces() - n);
  for (int i = 1; i < n_interfaces(); ++i) {
    d.segment<n>(n * i - n) = logarithm<D>(relative<D>(at.frames[0], at.frames[i]));
  }
  return d;
}

template <int D>
VectorXd SuperElementIn<D>::deformation(const Configuration& at) const {
  VectorXd epsilon(K_.rows());
  epsilon << strains(at), at.eta;
  for (int i = 1; i < n_interfaces(); ++i) {
    epsilon.segment<n>(n * i - n) -= offset<D>(positions_[0], positions_[i]);  // eq. (1)
  }
  return epsilon;
}

template <int D>
MatrixXd SuperElementIn<D>::strain_matrix(const VectorXd& d) const {
  MatrixXd B = MatrixXd::Zero(K_.rows(), size());
  for (int i = 1; i < n_interfaces(); ++i) {
    const TwistD d_i = d.segment<n>(n * i - n);
    B.block<n, n>(n * i - n, 0) = -geometry::left_tangent_inverse<D>(d_i);  // eq. (2)
    B.block<n, n>(n * i - n, n * i) = geometry::right_tangent_inverse<D>(d_i);
  }
  B.bottomRightCorner(n_modes_, n_modes_).setIdentity();
  return B;
}

template <int D>
VectorXd SuperElementIn<D>::to_nodes(const VectorXd& d, const VectorXd& sigma) const {
  VectorXd f = VectorXd::Zero(size());
  for (int i = 1; i < n_interfaces(); ++i) {
    const auto pair =
        InverseTangentIn<D>(d.segment<n>(n * i - n)).transpose_times(sigma.segment<n>(n * i - n));
    f.head<n>() -= pair.left;
    f.segment<n>(n * i) = pair.right;
  }
  f.tail(n_modes_) = sigma.tail(n_modes_);
  return f;
}

template <int D>
typename SuperElementIn<D>::Forces SuperElementIn<D>::internal_forces(const Configuration& at,
                                                                      const VectorXd& V,
                                                                      const PointD& gravity) const {
  const VectorXd d = strains(at), epsilon = deformation(at);
  const PointD gamma = at.frames[0].R.transpose() * gravity;
  VectorXd epsilon_dot(K_.rows());
  for (int i = 1; i < n_interfaces(); ++i) {
    epsilon_dot.segment<n>(n * i - n) =
        InverseTangentIn<D>(d.segment<n>(n * i - n)).strain_rate(V.head<n>(), V.segment<n>(n * i));  // (2)
  }
  epsilon_dot.tail(n_modes_) = V.tail(n_modes_);

  Forces out;
  const VectorXd elastic = K_ * epsilon, viscous = C_ * epsilon_dot;
  const PointD shift = Gamma_.transpose() * epsilon;  // of the first moment, eq. (5)
  out.elastic = 0.5 * epsilon.dot(elastic);
  out.gravity = -gamma.dot(shift);
  out.dissipation = epsilon_dot.dot(viscous);
  out.f = to_nodes(d, elastic + viscous - Gamma_ * gamma);  // eq. (3)
  out.f.template segment<geometry::turns<D>>(D) -= moment_of<D>(shift, gamma);
  return out;
}

template <int D>
VectorXd SuperElementIn<D>::inertia_forces(const VectorXd& V, const VectorXd& V_dot) const {
  const VectorXd momentum = M_ * V;
  VectorXd f = M_ * V_dot;
  for (int i = 0; i < n_interfaces(); ++i) {  // eq. (4)
    f.segment<n>(n * i) -= geometry::ad_transpose<D>(V.segment<n>(n * i), momentum.segment<n>(n * i));
  }
  return f;
}

template <int D>
MatrixXd SuperElementIn<D>::stiffness_matrix(const Configuration& at, const VectorXd& V,
                                             const PointD& gravity) const {
  constexpr int r = geometry::turns<D>;
  const VectorXd d = strains(at), epsilon = deformation(at);
  const PointD gamma = at.frames[0].R.transpose() * gravity;
  const auto gamma_matrix = lever_matrix<D>(gamma);  // dγ = γ × δ
  const MatrixXd B = strain_matrix(d);
  const VectorXd sigma = K_ * epsilon + C_ * (B * V) - Gamma_ * gamma;  // ε' = B V
  MatrixXd material = K_;                                               // and C ∂ε'/∂ε
  for (int i = 1; i < n_interfaces(); ++i) {
    const int k = n * i - n;
    material.middleCols<n>(k) += C_.middleCols<n>(k) * geometry::strain_rate_gradient<D>(
                                                           d.segment<n>(k), V.head<n>(), V.segment<n>(n * i));
  }
  MatrixXd K = dense::congruent(material, B);
  for (int i = 1; i < n_interfaces(); ++i) {
    const auto geometric =
        geometry::geometric_stiffness<D>(d.segment<n>(n * i - n), sigma.segment<n>(n * i - n));
    const MatrixXd B_i = B.middleRows<n>(n * i - n);
    K.topRows<n>() -= geometric.left * B_i;
    K.middleRows<n>(n * i) += geometric.right * B_i;
  }
  const MatrixXd turning = B.transpose() * Gamma_ * gamma_matrix;  // gravity seen from a turning frame
  K.middleCols<r>(D) -= turning;
  K.middleRows<r>(D) -= turning.transpose();
  const PointD shift = Gamma_.transpose() * epsilon;
  K.block<r, r>(D, D) += lever_matrix<D>(shift).transpose() * gamma_matrix;
  return K;
}

template <int D>
MatrixXd SuperElementIn<D>::damping_matrix(const Configuration& at) const {
  const MatrixXd B = strain_matrix(strains(at));
  return dense::congruent(C_, B);
}

template <int D>
MatrixXd SuperElementIn<D>::gyroscopic_matrix(const VectorXd& V) const {
  const VectorXd momentum = M_ * V;
  MatrixXd gyroscopic = MatrixXd::Zero(size(), size());
  for (int i = 0; i < n_interfaces(); ++i) {
    const TwistD v = V.segment<n>(n * i);
    gyroscopic.middleRows<n>(n * i) = -geometry::ad<D>(v).transpose() * M_.middleRows<n>(n * i);
    gyroscopic.block<n, n>(n * i, n * i) -= geometry::ad_transpose_by_twist<D>(momentum.segment<n>(n * i));
  }
  return gyroscopic;
}

template <int D>
typename SuperElementIn<D>::Shape SuperElementIn<D>::shape(const Configuration& at) const
  requires(D == 3)
{
  return {at.frames[0] * Frame::translation(-positions_[0]), G_ * deformation(at)};
}

template class SuperElementIn<2>;
template class SuperElementIn<3>;

}  // namespace flexarm::elements
