/// @file
/// The closures of an arm, and which of their conditions count.
///
///     Φ = Pᵀ g,   g: conditions of all closures,   forces Jᵀ P μ                                    (1)
///
/// Conditions of a loop may repeat one another: a flat loop of rigid links keeps its plane by its joints
/// alone, so three conditions of a revolute closure are met anyway. With N an orthonormal basis of the
/// combinations of g that the other constraints hold already,
///
///     1 − N Nᵀ = P Pᵀ,   Pᵀ P = 1                                                                   (2)
///
/// by Cholesky's method with pivots, which leaves single conditions single. The forces λ = P μ are those
/// without a part along N, hence the smallest: rigid links do not tell more. P = 1 where nothing repeats, as
/// in a plane (D = 2), whose conditions do not hold what its motion cannot leave.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "flexarm/assembly/beam_slide.hpp"
#include "flexarm/joints/closure_constraint.hpp"

namespace flexarm::assembly {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using joints::Conditions;

template <int D>
class LoopClosuresIn {
 public:
  static constexpr int n = geometry::freedoms<D>;
  using FrameD = geometry::FrameIn<D>;
  using TwistD = geometry::Twist<D>;
  using TwistMatrixD = geometry::TwistMatrix<D>;
  using Frames = std::vector<FrameD>;
  using Closure = joints::ClosureConstraintIn<D>;
  using Slide = BeamSlideIn<D>;

  /// @param slide takes the place of the closure's conditions where a point slides along a beam.
  void add(const std::string& name, const Closure& closure, std::optional<Slide> slide = {});

  bool empty() const { return closures_.empty(); }
  std::size_t size() const { return closures_.size(); }
  const std::string& name(std::size_t k) const { return names_[k]; }
  const Closure& operator[](std::size_t k) const { return closures_[k]; }
  const std::optional<Slide>& slide(std::size_t k) const { return slides_[k]; }
  int rows() const { return static_cast<int>(P_.cols()); }        ///< of Φ
  int conditions() const { return static_cast<int>(P_.rows()); }  ///< of g
  int redundant() const { return conditions() - rows(); }
  int first_condition(std::size_t k) const { return first_[k]; }  ///< of a closure, in g
  const MatrixXd& counted() const { return P_; }                  ///< P

  /// Equation (2) from N, whose columns are orthonormal.
  void leave_out(const MatrixXd& N);
  /// Takes P of the same closures at slightly other places, so that rows of Φ mean the same.
  void count_as(const LoopClosuresIn& other) { P_ = other.P_; }

  VectorXd residual(const Frames& frames) const;                                                ///< g [m]
  VectorXd violation(const Frames& frames) const { return P_.transpose() * residual(frames); }  ///< Φ
  /// What is left of g along N, largest entry [m]: not zero where loops lock.
  double unmet(const Frames& frames) const;
  /// @throws NotConverged if that is more than 1e-7 of the reach [m], at a time t [s].
  void check(const Frames& frames, double reach, double t) const;

  /// Adds Φ_qᵀ μ to the rows of the nodes. @return Φ
  VectorXd add_forces(const Frames& frames, const Eigen::Ref<const VectorXd>& mu, VectorXd& r) const;

  /// λ of a closure.
  Conditions multipliers(std::size_t k, const Eigen::Ref<const VectorXd>& mu) const;

  /// Φ'' for velocities and accelerations of the nodes.
  VectorXd acceleration(const Frames& frames, const VectorXd& v, const VectorXd& v_dot) const;

  /// Force and moment of a closure on b at the origin of B, base axes.
  TwistD wrench_on_b(std::size_t k, const Frames& frames, const Eigen::Ref<const VectorXd>& mu) const {
    return wrench_of(k, frames, multipliers(k, mu));
  }
  /// Largest change of each entry of that wrench by unit multipliers along N; zero of what is unique.
  TwistD indeterminacy(std::size_t k, const Frames& frames) const;

  /// Origin of B in the base.
  geometry::Point<D> place_on_b(std::size_t k, const Frames& frames) const {
    return closures_[k].place_on_b(frame(frames, closures_[k].node_b()));
  }
  /// How B is turned against A.
  geometry::Rotation<D> rotation(std::size_t k, const Frames& frames) const {
    return closures_[k].rotation(frame(frames, closures_[k].node_a()), frame(frames, closures_[k].node_b()));
  }

  /// Tells entries of Φ_q, and of the geometric stiffness for multipliers mu:
  /// constrain(row of Φ, column, value), stiffen(row, column, value), in an order that never changes.
  template <class Constrain, class Stiffen>
  void emit(const Frames& frames, const Eigen::Ref<const VectorXd>& mu, Constrain&& constrain,
            Stiffen&& stiffen) const;

 private:
  static const FrameD& frame(const Frames& frames, int node) {
    static const FrameD base;
    return node < 0 ? base : frames[static_cast<std::size_t>(node)];
  }
  int size_of(std::size_t k) const { return slides_[k] ? D - 1 : closures_[k].size(); }
  TwistD wrench_of(std::size_t k, const Frames& frames, const Conditions& lambda) const;
  Eigen::Block<const MatrixXd> part(std::size_t k) const {  // rows of P of a closure
    return P_.middleRows(first_[k], size_of(k));
  }

  std::vector<std::string> names_;
  std::vector<Closure> closures_;
  std::vector<std::optional<Slide>> slides_;
  std::vector<int> first_;  // row of g
  MatrixXd P_;
};

using LoopClosures = LoopClosuresIn<3>;

template <int D>
template <class Constrain, class Stiffen>
void LoopClosuresIn<D>::emit(const Frames& frames, const Eigen::Ref<const VectorXd>& mu,
                             Constrain&& constrain, Stiffen&& stiffen) const {
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const auto entries = [&](int node, const auto& of) {
      if (node < 0) return;
      for (int i = 0; i < this->rows(); ++i) {
        if (part(k).col(i).isZero(0)) continue;
        const Eigen::Matrix<double, 1, n> row = part(k).col(i).transpose() * of;
        for (int j = 0; j < n; ++j) constrain(i, n * node + j, row[j]);
      }
    };
    const auto block = [&](int row, int column, const TwistMatrixD& of) {
      if (row < 0 || column < 0) return;
      for (int j = 0; j < n; ++j)
        for (int i = 0; i < n; ++i) stiffen(n * row + i, n * column + j, of(i, j));
    };
    if (const std::optional<Slide>& slide = slides_[k]) {
      const std::size_t touched = slide->touched(frames);
      const typename Slide::Rows J = slide->jacobian(frames);
      const typename Slide::Stiffness K = slide->geometric_stiffness(frames, multipliers(k, mu));
      for (std::size_t e = 0; e < slide->size(); ++e) {  // zeros elsewhere: the point may slide there
        const double here = e == touched ? 1 : 0;
        const std::array<int, 3> nodes = slide->nodes(e);
        for (int i = 0; i < 3; ++i) {
          entries(nodes[i], here * J.template middleCols<n>(n * i));
          for (int j = 0; j < 3; ++j) block(nodes[i], nodes[j], here * K.template block<n, n>(n * i, n * j));
        }
      }
      continue;
    }
    const Closure& closure = closures_[k];
    const int a = closure.node_a(), b = closure.node_b();
    const FrameD &H_a = frame(frames, a), &H_b = frame(frames, b);
    const auto J = closure.jacobian(H_a, H_b);
    const auto K = closure.geometric_stiffness(H_a, H_b, multipliers(k, mu));
    entries(a, J.a);
    entries(b, J.b);
    block(a, a, K.a_a);
    block(a, b, K.a_b);
    block(b, a, K.b_a);
    block(b, b, K.b_b);
  }
}

}  // namespace flexarm::assembly
