#include "flexarm/solvers/tangent_changes.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "flexarm/solvers/elimination.hpp"

namespace flexarm::solvers {
namespace {

using namespace geometry;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// More turning joints than this make (1) dearer than the iterations it saves.
constexpr std::size_t most_turning_joints = 3;
// Of a tangent: rounding.
constexpr double unchanged = 1e-12;

template <int D>
bool linear_laws(const assembly::SystemIn<D>& system) {
  return std::all_of(system.laws().begin(), system.laws().end(), [](const assembly::PlacedLaw& law) {
    if (const auto* spring = std::get_if<joints::ReducerSpring>(&law.law)) {
      return spring->cubic_stiffness == 0 && spring->gap == 0;
    }
    return std::holds_alternative<joints::CableTorque>(law.law) ||
           std::holds_alternative<joints::ViscousFriction>(law.law);
  });
}

/// Translations and rotations across the axis of a joint.
Eigen::Matrix<double, 6, 4> across_axis(const Twist<3>& motion) {
  const bool turns = motion.tail<3>().squaredNorm() > 0;
  const Vector3d axis = turns ? motion.tail<3>() : motion.head<3>();
  Eigen::Matrix<double, 3, 2> plane;
  plane.col(0) = axis.unitOrthogonal();
  plane.col(1) = axis.normalized().cross(plane.col(0));
  Eigen::Matrix<double, 6, 4> P = Eigen::Matrix<double, 6, 4>::Zero();
  P.topLeftCorner<3, 2>() = P.bottomRightCorner<3, 2>() = plane;
  return P;
}

}  // namespace

template <int D>
TangentChangesIn<D>::TangentChangesIn(const assembly::SystemIn<D>& system)
    : system_(system), n_laws_(linear_laws(system) ? 0 : static_cast<int>(system.laws().size())) {
  find_turning_joints();
  const auto columns = static_cast<Eigen::Index>(2 * across * joints_.size()) + n_laws_;
  W_.resize(system.n_unknowns(), columns);
  C_ = MatrixXd::Zero(columns, columns);
}

template <int D>
void TangentChangesIn<D>::find_turning_joints() {
  int row = system_.n_free();
  for (std::size_t k = 0; k < system_.constraints().size(); ++k) {
    const auto& joint = system_.constraints()[k];
    const int first_row = row;
    row += joint.rows();
    if (joint.coordinate() < 0 || joint.node_a() < 0) continue;
    Across P;
    if constexpr (D == 3) {
      P = across_axis(joint.twist());
    } else {
      P.setIdentity();
    }
    const Across on_parent = adjoint<D>(joint.frame_a().inverse()).transpose() * P;
    joints_.push_back({static_cast<int>(k), first_row, n * joint.node_a(), P, on_parent});
  }
  if (joints_.size() > most_turning_joints) joints_.clear();
}

template <int D>
typename TangentChangesIn<D>::Turned TangentChangesIn<D>::turned(const TurningJoint& joint,
                                                                 double theta) const {
  const auto& constraint = system_.constraints()[joint.constraint];
  if constexpr (D == 2) {
    return adjoint<2>(exponential<2>(-theta * constraint.twist()));
  } else {
    Turned T = Turned::Identity();  // eq. (4)
    if (constraint.type() == joints::JointType::revolute) {
      const double c = std::cos(theta), s = std::sin(theta);
      T << c, s, 0, 0, -s, c, 0, 0, 0, 0, c, s, 0, 0, -s, c;
    } else {
      T(0, 3) = theta;
      T(1, 2) = -theta;
    }
    return T;
  }
}

template <int D>
void TangentChangesIn<D>::directions(MatrixXd& U) const {
  U.setZero();
  Eigen::Index column = 0;
  for (const TurningJoint& joint : joints_) {
    U.template block<n, across>(joint.node_row, column) = joint.on_parent;  // eq. (3)
    U.template block<n, across>(joint.first_row, column + across) = joint.P;
    column += 2 * across;
  }
  for (int k = 0; k < n_laws_; ++k, ++column) {
    const auto& law = system_.laws()[k];  // eq. (2)
    if (system_.is_free(law.plus)) U(system_.scalar_offset() + law.plus, column) += 1;
    if (law.minus >= 0 && system_.is_free(law.minus)) U(system_.scalar_offset() + law.minus, column) -= 1;
  }
}

template <int D>
void TangentChangesIn<D>::keep(const assembly::StateIn<D>& state, const assembly::TangentFactors& c,
                               const VectorXd& laws, const SparseFactor& factor) {
  factors_ = c;
  kept_laws_ = laws;
  for (TurningJoint& joint : joints_) {
    joint.kept_angle = state.s[system_.constraints()[joint.constraint].coordinate()];
    joint.kept = turned(joint, joint.kept_angle);
  }
  if (W_.cols() == 0) return;
  directions(W_);
  factor.solve(W_);
  G_.resize(W_.cols(), W_.cols());
  for (Eigen::Index k = 0; k < W_.cols(); ++k) G_.col(k) = along(W_.col(k));
  packed_W_ = PackedMatrix(W_);
  Wy_.resize(packed_W_.filled_rows());
}

/// C of this state. @return whether anything has changed
template <int D>
bool TangentChangesIn<D>::update(const assembly::StateIn<D>& state) {
  bool any = false;
  Eigen::Index at = 0;
  for (const TurningJoint& joint : joints_) {
    const double theta = state.s[system_.constraints()[joint.constraint].coordinate()];
    any = any || theta != joint.kept_angle;
    const Turned E = factors_.constraint * (joint.kept - turned(joint, theta));
    C_.template block<across, across>(at + across, at) = E;  // eq. (3)
    C_.template block<across, across>(at, at + across) = E.transpose();
    at += 2 * across;
  }
  if (n_laws_ == 0) return any;
  const VectorXd laws = system_.law_tangents(state, factors_, true);
  for (int k = 0; k < n_laws_; ++k) {
    const double change = laws[k] - kept_laws_[k];
    any = any || std::abs(change) > unchanged * std::abs(kept_laws_[k]);
    C_(at + k, at + k) = change;  // eq. (2)
  }
  return any;
}

template <int D>
VectorXd TangentChangesIn<D>::along(const VectorXd& x) const {
  VectorXd Ux(W_.cols());
  Eigen::Index at = 0;
  for (const TurningJoint& joint : joints_) {
    Ux.segment<across>(at) = joint.on_parent.transpose() * x.segment<n>(joint.node_row);
    Ux.segment<across>(at + across) = joint.P.transpose() * x.segment<n>(joint.first_row);
    at += 2 * across;
  }
  for (int k = 0; k < n_laws_; ++k) {
    const auto& law = system_.laws()[k];
    const auto entry = [&](int scalar) {
      return scalar >= 0 && system_.is_free(scalar) ? x[system_.scalar_offset() + scalar] : 0.0;
    };
    Ux[at + k] = entry(law.plus) - entry(law.minus);
  }
  return Ux;
}

/// One joint, by far the most frequent case: the blocks of (3) without their zeros, sizes known when
/// compiled.
template <int D>
void TangentChangesIn<D>::correct_for_one_joint(VectorXd& x) {
  constexpr int size = 2 * across;
  const TurningJoint& joint = joints_.front();
  const Eigen::Map<const Eigen::Matrix<double, size, size>> G(G_.data());
  const Turned E = C_.template bottomLeftCorner<across, across>();
  Eigen::Matrix<double, size, size, Eigen::RowMajor> A;  // I + C G
  A.template topRows<across>() = E.transpose().lazyProduct(G.template bottomRows<across>());
  A.template bottomRows<across>() = E.lazyProduct(G.template topRows<across>());
  A.diagonal().array() += 1;
  const Eigen::Matrix<double, across, 1> on_node = joint.on_parent.transpose() * x.segment<n>(joint.node_row);
  const Eigen::Matrix<double, across, 1> on_row = joint.P.transpose() * x.segment<n>(joint.first_row);
  Eigen::Matrix<double, size, 1> y;
  y.template head<across>() = E.transpose() * on_row;
  y.template tail<across>() = E * on_node;
  eliminate(A, y);
  packed_W_.multiply(y.data(), Wy_.data());
  x -= Wy_.head(x.size());  // eq. (1)
}

template <int D>
void TangentChangesIn<D>::correct_for_all(VectorXd& x) const {
  MatrixXd A = C_ * G_;
  A.diagonal().array() += 1;
  x.noalias() -= W_ * A.partialPivLu().solve(C_ * along(x));  // eq. (1)
}

template <int D>
void TangentChangesIn<D>::correct(const assembly::StateIn<D>& state, VectorXd& x) {
  if (W_.cols() == 0 || !update(state)) return;
  if (joints_.size() == 1 && n_laws_ == 0) {
    correct_for_one_joint(x);
  } else {
    correct_for_all(x);
  }
}

template class TangentChangesIn<2>;
template class TangentChangesIn<3>;

}  // namespace flexarm::solvers
