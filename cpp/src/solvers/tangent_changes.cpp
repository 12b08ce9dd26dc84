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

/// Whether the tangent of a law is the same in all states.
bool is_linear(const assembly::PlacedLaw& law) {
  if (const auto* spring = std::get_if<joints::ReducerSpring>(&law.law)) {
    return spring->cubic_stiffness == 0 && spring->gap == 0;
  }
  return std::holds_alternative<joints::CableTorque>(law.law) ||
         std::holds_alternative<joints::ViscousFriction>(law.law);
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
TangentChangesIn<D>::TangentChangesIn(const assembly::SystemIn<D>& system, const WeldsIn<D>& welds)
    : system_(system) {
  find_turning_joints(welds);
  find_laws(welds);
  const auto columns = static_cast<Eigen::Index>(2 * across * joints_.size() + laws_.size());
  W_.resize(welds.n_unknowns(), columns);
  C_ = MatrixXd::Zero(columns, columns);
  correct_ = correction(joints_.size(), laws_.size());
}

template <int D>
void TangentChangesIn<D>::find_turning_joints(const WeldsIn<D>& welds) {
  int row = system_.n_free();
  for (std::size_t k = 0; k < system_.constraints().size(); ++k) {
    const auto& joint = system_.constraints()[k];
    const int first_row = row;
    row += joint.rows();
    if (joint.coordinate() < 0 || joint.node_a() < 0) continue;
    const auto parent = welds.place_of(joint.node_a());
    if (parent.row == WeldsIn<D>::none) continue;  // held to the base
    Across P;
    if constexpr (D == 3) {
      P = across_axis(joint.twist());
    } else {
      P.setIdentity();
    }
    const FrameIn<D> to_parent = joint.frame_a().inverse() * parent.to_carrier;
    const Across on_parent = adjoint<D>(to_parent).transpose() * P;
    joints_.push_back({static_cast<int>(k), welds.row(first_row), parent.row, P, on_parent});
  }
  if (joints_.size() > most_turning_joints) joints_.clear();
}

template <int D>
void TangentChangesIn<D>::find_laws(const WeldsIn<D>& welds) {
  const auto row = [&](int scalar) {
    const bool free = scalar >= 0 && system_.is_free(scalar);
    return free ? welds.row(system_.scalar_offset() + scalar) : WeldsIn<D>::none;
  };
  for (std::size_t k = 0; k < system_.laws().size(); ++k) {
    const assembly::PlacedLaw& law = system_.laws()[k];
    law_rows_.push_back({row(law.plus), row(law.minus)});
    if (!is_linear(law)) laws_.push_back(static_cast<int>(k));
  }
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
  for (int k : laws_) {
    if (law_rows_[k].plus >= 0) U(law_rows_[k].plus, column) += 1;  // eq. (2)
    if (law_rows_[k].minus >= 0) U(law_rows_[k].minus, column) -= 1;
    ++column;
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
  if (laws_.empty()) return any;
  const VectorXd tangents = system_.law_tangents(state, factors_, true);
  for (int k : laws_) {
    const double change = tangents[k] - kept_laws_[k];
    any = any || std::abs(change) > unchanged * std::abs(kept_laws_[k]);
    C_(at, at) = change;  // eq. (2)
    ++at;
  }
  return any;
}

/// u·x of a law, eq. (2).
template <int D>
double TangentChangesIn<D>::along_law(int k, const VectorXd& x) const {
  const auto entry = [&](int row) { return row >= 0 ? x[row] : 0.0; };
  return entry(law_rows_[k].plus) - entry(law_rows_[k].minus);
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
  for (int k : laws_) Ux[at++] = along_law(k, x);
  return Ux;
}

/// The readable one, for any numbers of joints and laws.
template <int D>
void TangentChangesIn<D>::correct_for_any(VectorXd& x) {
  MatrixXd A = C_ * G_;
  A.diagonal().array() += 1;
  x.noalias() -= W_ * A.partialPivLu().solve(C_ * along(x));  // eq. (1)
}

/// The same for few, as most arms have: C of (2) and (3) without its zeros, sizes known when compiled.
template <int D>
template <int joints, int laws>
void TangentChangesIn<D>::correct_for_few(VectorXd& x) {
  constexpr int of_joints = 2 * across * joints, size = of_joints + laws;
  const Eigen::Map<const Eigen::Matrix<double, size, size>> G(G_.data());
  Eigen::Matrix<double, size, size, Eigen::RowMajor> A;  // I + C G
  Eigen::Matrix<double, size, 1> y;                      // C Uᵀ x
  for (int k = 0; k < joints; ++k) {
    const TurningJoint& joint = joints_[k];
    const int on_node = 2 * across * k, on_row = on_node + across;
    const Turned E = C_.template block<across, across>(on_row, on_node);
    A.template middleRows<across>(on_node) = E.transpose().lazyProduct(G.template middleRows<across>(on_row));
    A.template middleRows<across>(on_row) = E.lazyProduct(G.template middleRows<across>(on_node));
    y.template segment<across>(on_node) =
        E.transpose() * (joint.P.transpose() * x.segment<n>(joint.first_row));
    y.template segment<across>(on_row) = E * (joint.on_parent.transpose() * x.segment<n>(joint.node_row));
  }
  for (int k = of_joints; k < size; ++k) {
    A.row(k) = C_(k, k) * G.row(k);
    y[k] = C_(k, k) * along_law(laws_[k - of_joints], x);
  }
  A.diagonal().array() += 1;
  eliminate(A, y);
  packed_W_.multiply(y.data(), Wy_.data());
  x -= Wy_.head(x.size());  // eq. (1)
}

template <int D>
typename TangentChangesIn<D>::Correction TangentChangesIn<D>::correction(std::size_t joints,
                                                                         std::size_t laws) {
  using Self = TangentChangesIn<D>;
  static constexpr Correction few[4][3] = {
      {&Self::correct_for_any, &Self::correct_for_few<0, 1>, &Self::correct_for_few<0, 2>},
      {&Self::correct_for_few<1, 0>, &Self::correct_for_few<1, 1>, &Self::correct_for_few<1, 2>},
      {&Self::correct_for_few<2, 0>, &Self::correct_for_few<2, 1>, &Self::correct_for_few<2, 2>},
      {&Self::correct_for_few<3, 0>, &Self::correct_for_few<3, 1>, &Self::correct_for_few<3, 2>}};
  return joints < std::size(few) && laws < std::size(few[0]) ? few[joints][laws] : &Self::correct_for_any;
}

template <int D>
void TangentChangesIn<D>::correct(const assembly::StateIn<D>& state, VectorXd& x) {
  if (W_.cols() > 0 && update(state)) (this->*correct_)(x);
}

template class TangentChangesIn<2>;
template class TangentChangesIn<3>;

}  // namespace flexarm::solvers
