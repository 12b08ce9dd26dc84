#include "flexarm/integrators/woodbury_update.hpp"

#include <algorithm>
#include <array>
#include <ranges>
#include <type_traits>
#include <variant>

namespace flexarm::integrators {
namespace {

using namespace geometry;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Up to so many laws need no memory of their own at every correction.
constexpr int few_laws = 8;

template <int n_j>
using ByRows = Eigen::Matrix<double, n_j, n_j, Eigen::RowMajor>;

}  // namespace

template <int D>
WoodburyUpdateIn<D>::WoodburyUpdateIn(const assembly::SystemIn<D>& system,
                                      const RigidJointCondensationIn<D>& condensation, bool laws,
                                      std::size_t most_joints)
    : system_(system), follows_constraints_(true) {
  const auto changes = [&](const joints::GearConstraint& gear) {
    const bool ideal = gear.transmission.amplitude == 0 && gear.transmission.windup.empty();
    return system.is_free(gear.input) && !ideal;
  };
  if (std::ranges::any_of(system.gears(), changes)) follows_constraints_ = false;
  find_turning_joints(condensation, most_joints);
  if (laws) find_laws(condensation);
  const auto n_laws = static_cast<Eigen::Index>(laws_.size());
  const Eigen::Index columns = 2 * across * static_cast<Eigen::Index>(joints_.size()) + n_laws;
  W_.resize(condensation.n_unknowns(), columns);
  C_ = MatrixXd::Zero(columns - n_laws, columns - n_laws);
  LU_.resize(columns - n_laws, columns - n_laws);
  C_G_.resize(columns - n_laws, n_laws);
  G_l_.resize(n_laws, n_laws);
  f_.resize(columns);
  for_numbers_ = for_numbers(joints_.size(), laws_.size());
}

template <int D>
void WoodburyUpdateIn<D>::find_turning_joints(const RigidJointCondensationIn<D>& condensation,
                                              std::size_t most) {
  int row = system_.n_free();
  for (std::size_t k = 0; k < system_.constraints().size(); ++k) {
    const auto& joint = system_.constraints()[k];
    const int first_row = row;
    row += joint.rows();
    if (joint.type() == joints::JointType::spherical) follows_constraints_ = false;
    if (joint.coordinate() < 0 || joint.node_a() < 0) continue;
    const auto parent = condensation.place_of(joint.node_a());
    if (parent.row == RigidJointCondensationIn<D>::none) continue;  // held to the base
    const auto [P, Q] = directions_of<D>(joint.twist(), joint.type() == joints::JointType::prismatic);
    const FrameIn<D> to_parent = joint.frame_a().inverse() * parent.to_carrier;
    joints_.push_back({static_cast<int>(k), -1, condensation.row(first_row), parent.row, P,
                       adjoint<D>(to_parent).transpose() * Q});
  }
  find_turning_pins(condensation);
  if (joints_.size() <= most) return;
  // A hinge of a mount turns by what its spring gives way: the kept factor serves it as it is.
  std::erase_if(joints_, [&](const TurningJoint& joint) {
    if (joint.constraint < 0) return false;
    const int hinge = system_.constraints()[joint.constraint].coordinate();
    return std::ranges::any_of(system_.laws(), [&](const assembly::PlacedLaw& law) {
      return law.plus == hinge && law.minus < 0 &&
             (std::holds_alternative<joints::ReducerSpring>(law.law) ||
              std::holds_alternative<joints::RadialClearance>(law.law));
    });
  });
  if (joints_.size() > most) joints_.clear();
  follows_constraints_ = false;
}

/// Closures other than pins and rigid ones, and those of space, are not followed.
template <int D>
void WoodburyUpdateIn<D>::find_turning_pins(const RigidJointCondensationIn<D>& condensation) {
  const auto& closures = system_.closures();
  for (std::size_t k = 0; k < closures.size(); ++k) {
    const auto& closure = closures[k];
    if (D == 3 || closures.slide(k) || !(closure.is_ball() || closure.is_rigid())) {
      follows_constraints_ = false;
    } else if (closure.is_ball() && closure.node_b() >= 0) {
      const auto node = condensation.place_of(closure.node_b());
      if (node.row == RigidJointCondensationIn<D>::none) continue;
      const auto [P, Q] = directions_of<D>(Twist<D>::Unit(n - 1), false);
      const int row = system_.n_unknowns() - closures.rows() + closures.first_condition(k);
      const FrameIn<D> to_b = closure.frame_b().inverse() * node.to_carrier;
      joints_.push_back(
          {-1, static_cast<int>(k), condensation.row(row), node.row, P, adjoint<D>(to_b).transpose() * Q});
    }
  }
}

template <int D>
void WoodburyUpdateIn<D>::find_laws(const RigidJointCondensationIn<D>& condensation) {
  const auto row = [&](int scalar) {
    const bool free = scalar >= 0 && system_.is_free(scalar);
    return free ? condensation.row(system_.scalar_offset() + scalar) : RigidJointCondensationIn<D>::none;
  };
  for (std::size_t k = 0; k < system_.laws().size(); ++k) {
    const assembly::PlacedLaw& law = system_.laws()[k];
    law_rows_.push_back({row(law.plus), row(law.minus)});
    if (!joints::is_linear(law.law)) laws_.push_back(static_cast<int>(k));
  }
}

template <int D>
Turned<D> WoodburyUpdateIn<D>::turned_by(const TurningJoint& joint, const assembly::StateIn<D>& state) const {
  if constexpr (D == 2) {
    if (joint.closure >= 0) return -system_.closures().rotation(joint.closure, state.frames);
  }
  const auto& constraint = system_.constraints()[joint.constraint];
  return turned<D>(constraint.twist(), constraint.type() == joints::JointType::prismatic,
                   state.s[constraint.coordinate()]);
}

template <int D>
void WoodburyUpdateIn<D>::directions(MatrixXd& U) const {
  U.setZero();
  Eigen::Index column = 0;
  for (const TurningJoint& joint : joints_) {
    U.template block<n, across>(joint.node_row, column) = joint.on_parent;  // eq. (2)
    U.template block<rows, across>(joint.first_row, column + across) = joint.P;
    column += 2 * across;
  }
  for (int k : laws_) {
    if (law_rows_[k].plus >= 0) U(law_rows_[k].plus, column) += 1;  // eq. (4)
    if (law_rows_[k].minus >= 0) U(law_rows_[k].minus, column) -= 1;
    ++column;
  }
}

template <int D>
void WoodburyUpdateIn<D>::keep(const assembly::StateIn<D>& state, const assembly::TangentFactors& c,
                               const VectorXd& laws, const linear_solvers::SparseFactor& factor) {
  factors_ = c;
  kept_laws_ = laws;
  for (TurningJoint& joint : joints_) joint.kept = turned_by(joint, state);
  if (W_.cols() == 0) return;
  directions(W_);
  factor.solve(W_);
  G_.resize(W_.cols(), W_.cols());
  for (Eigen::Index k = 0; k < W_.cols(); ++k) G_.col(k) = along(W_.col(k));
  packed_W_ = linear_solvers::PackedMatrix(W_);
  Wy_.resize(packed_W_.filled_rows());
}

/// C of this state. @return whether it is not zero
template <int D>
bool WoodburyUpdateIn<D>::turn_joints(const assembly::StateIn<D>& state) {
  bool any = false;
  Eigen::Index at = 0;
  for (const TurningJoint& joint : joints_) {
    const Turned<D> E = factors_.constraint * (joint.kept - turned_by(joint, state));
    any = any || !E.isZero(0);
    C_.template block<across, across>(at + across, at) = E;  // eq. (2)
    C_.template block<across, across>(at, at + across) = E.transpose();
    at += 2 * across;
  }
  return any;
}

template <int D>
void WoodburyUpdateIn<D>::find_laws_here(const assembly::StateIn<D>& state) {
  laws_here_.clear();
  for (int k : laws_) {
    const assembly::PlacedLaw& law = system_.laws()[k];
    laws_here_.push_back({.law = &law.law,
                          .memory = state.laws[k],
                          .x = system_.deflection(law, state.s),
                          .rate = system_.deflection(law, state.v.tail(system_.n_scalars())),
                          .rate_by_x = factors_.damping,
                          .kept = kept_laws_[k],
                          .y = system_.argument(law, state)});
  }
}

/// Factors of (5), and Ĝ of (6), with C of (2) without its zeros.
template <int D>
template <int joints>
void WoodburyUpdateIn<D>::prepare_for() {
  constexpr int N = columns_of<joints>;
  const Eigen::Index n_l = G_l_.rows(), n_j = N >= 0 ? N : LU_.rows();
  G_l_ = G_.bottomRightCorner(n_l, n_l);
  if constexpr (joints != 0) {
    Eigen::Map<ByRows<N>> A(LU_.data(), n_j, n_j);
    for (int k = 0; 2 * across * k < n_j; ++k) {
      const int on_node = 2 * across * k, on_row = on_node + across;
      const Turned<D> E = C_.template block<across, across>(on_row, on_node);
      const auto G_node = G_.template middleRows<across>(on_node),
                 G_row = G_.template middleRows<across>(on_row);
      A.template middleRows<across>(on_node) = E.transpose().lazyProduct(G_row.template leftCols<N>(n_j));
      A.template middleRows<across>(on_row) = E.lazyProduct(G_node.template leftCols<N>(n_j));
      C_G_.template middleRows<across>(on_node) = E.transpose().lazyProduct(G_row.rightCols(n_l));
      C_G_.template middleRows<across>(on_row) = E.lazyProduct(G_node.rightCols(n_l));
    }
    A.diagonal().array() += 1;
    linear_solvers::factor_in_place(A, pivots_);
    linear_solvers::substitute(A, pivots_, C_G_);
    G_l_ -= G_.template block<Eigen::Dynamic, N>(n_j, 0, n_l, n_j).lazyProduct(C_G_);  // eq. (6)
  }
}

/// f_J of (5) where laws take no forces, with what `prepare_for` made.
template <int D>
template <int joints>
void WoodburyUpdateIn<D>::find_joint_forces(const VectorXd& along) {
  constexpr int N = columns_of<joints>;
  if constexpr (joints != 0) {
    const Eigen::Index n_j = N >= 0 ? N : LU_.rows();
    Eigen::Matrix<double, N, 1> C_x(n_j);
    for (int k = 0; 2 * across * k < n_j; ++k) {
      const int on_node = 2 * across * k, on_row = on_node + across;
      const Turned<D> E = C_.template block<across, across>(on_row, on_node);
      C_x.template segment<across>(on_node) = E.transpose() * along.segment<across>(on_row);
      C_x.template segment<across>(on_row) = E * along.segment<across>(on_node);
    }
    linear_solvers::substitute(Eigen::Map<const ByRows<N>>(LU_.data(), n_j, n_j), pivots_, C_x);
    f_.template head<N>(n_j) = C_x;
  }
}

/// f_L of (6), and what it changes of f_J. @param L, most laws, as LawVector has them
template <int D>
template <int L, int most>
void WoodburyUpdateIn<D>::add_law_forces(const VectorXd& along) {
  const Eigen::Index n_l = G_l_.rows(), n_j = f_.size() - n_l;
  LawVector<L, most> z = along.tail(n_l);
  z -= G_.bottomLeftCorner(n_l, n_j).lazyProduct(f_.head(n_j));
  const LawMatrix<L, most> G_l = G_l_;
  f_.tail(n_l) = law_forces(G_l, z, laws_here_);
  f_.head(n_j) -= C_G_.lazyProduct(f_.tail(n_l));
}

template <int D>
typename WoodburyUpdateIn<D>::ForNumbers WoodburyUpdateIn<D>::for_numbers(std::size_t joints,
                                                                          std::size_t laws) {
  using Self = WoodburyUpdateIn<D>;
  static constexpr std::array prepare = {&Self::prepare_for<0>, &Self::prepare_for<1>, &Self::prepare_for<2>,
                                         &Self::prepare_for<3>, &Self::prepare_for<Eigen::Dynamic>};
  static constexpr std::array of_joints = {&Self::find_joint_forces<0>, &Self::find_joint_forces<1>,
                                           &Self::find_joint_forces<2>, &Self::find_joint_forces<3>,
                                           &Self::find_joint_forces<Eigen::Dynamic>};
  const std::size_t known = std::min<std::size_t>(joints, most_in_steps + 1);
  return {prepare[known], of_joints[known],
          laws == 1          ? &Self::add_law_forces<1, 1>
          : laws <= few_laws ? &Self::add_law_forces<Eigen::Dynamic, few_laws>
                             : &Self::add_law_forces<Eigen::Dynamic, Eigen::Dynamic>};
}

template <int D>
bool WoodburyUpdateIn<D>::prepare(const assembly::StateIn<D>& state, bool again) {
  if (W_.cols() == 0) return false;
  if (!again) {
    turned_ = turn_joints(state);
    if (turned_ || !laws_.empty()) (this->*for_numbers_.prepare)();
  }
  return turned_ || !laws_.empty();
}

template <int D>
const VectorXd& WoodburyUpdateIn<D>::forces(const assembly::StateIn<D>& state, const VectorXd& along) {
  (this->*for_numbers_.find_joint_forces)(along);
  if (!laws_.empty()) {
    find_laws_here(state);
    (this->*for_numbers_.add_law_forces)(along);
  }
  return f_;
}

template <int D>
void WoodburyUpdateIn<D>::correct(const assembly::StateIn<D>& state, VectorXd& x, bool again) {
  if (!prepare(state, again)) return;
  Ux_.resize(W_.cols());
  find_along([&](int row) { return x[row]; }, Ux_);
  forces(state, Ux_);
  packed_W_.multiply(f_.data(), Wy_.data());
  x -= Wy_.head(x.size());  // eq. (1)
}

template class WoodburyUpdateIn<2>;
template class WoodburyUpdateIn<3>;

}  // namespace flexarm::integrators
