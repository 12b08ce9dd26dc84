/// @file
/// The few equations of a step in which joint laws are not linear, solved by themselves.
///
/// But for these laws a correction of the step is linear. Of law k it would change the deflection by z_k, and
/// forces f of the laws take G f from that. What the laws then put against it is known beyond their tangents:
///
///     w + G f = z,   f_k = q_k(w_k)                                                                  (1)
///     q_k(w) = Q_k(x_k + w, x'_k + c w) − Q_k(x_k, x'_k) − κ_k w                                     (2)
///
/// with w_k the change of the deflection, x_k and x'_k deflection and rate before it, c the rate that a
/// change brings along [1/s], and κ_k what the kept matrix holds of the law's tangent. Newton's method, its
/// step d shortened by t until the error falls,
///
///     F = w + G q(w) − z,   (I + G q') d = −F,   w := w + t d,   t = 1, ½, ¼, ...                    (3)
///
/// gets there from afar where Q grows with the deflection: (1) then is where a convex function is least, G
/// being the flexibility of an arm. Teeth that meet, and friction that turns, so cost evaluations of a scalar
/// law, not iterations over an arm. Source of (3): [Deuflhard2011], section 3.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "flexarm/joints/joint_law.hpp"
#include "flexarm/linear_solvers/elimination.hpp"

namespace flexarm::integrators {

/// A law about the present iterate of a step.
struct LawHere {
  const joints::JointLaw* law;
  joints::LawMemory memory;
  double x, rate;              ///< x_k, x'_k
  double rate_by_x;            ///< c
  double kept;                 ///< κ_k
  joints::LawArgument y = {};  ///< stays: its changes come with the next iterate
  double force = force_at(0).force;

  struct Change {
    double force, tangent;  ///< q_k, q_k'
  };

  /// Equation (2).
  Change change(double w) const {
    const joints::LawResponse at = force_at(w);
    return {at.force - force - kept * w, at.stiffness + rate_by_x * at.damping - kept};
  }

 private:
  joints::LawResponse force_at(double w) const {
    return joints::respond(*law, x + w, rate + rate_by_x * w, memory, y);
  }
};

/// By L laws; where L is Eigen::Dynamic, with room for `most` of them or, Eigen::Dynamic too, for any number.
template <int L, int most>
using LawVector = Eigen::Matrix<double, L, 1, 0, most, 1>;
template <int L, int most>
using LawMatrix = Eigen::Matrix<double, L, L, 0, most, most>;

namespace detail {

/// Newton's iteration ends with steps that are rounding [rad, m].
inline constexpr double last_law_step = 1e-14;
inline constexpr int most_law_steps = 30;
inline constexpr int most_shortenings = 30;

/// q and q' of all laws.
template <class Vector>
struct LawChanges {
  Vector q, tangent;

  LawChanges(const std::vector<LawHere>& laws, const Vector& w) : q(w.size()), tangent(w.size()) {
    for (Eigen::Index k = 0; k < w.size(); ++k) {
      const auto change = laws[static_cast<std::size_t>(k)].change(w[k]);
      q[k] = change.force;
      tangent[k] = change.tangent;
    }
  }
};

/// d of (3).
template <class Matrix, class Vector>
Vector newton_step(const Matrix& G, const Vector& tangent, const Vector& F) {
  Vector d = -F;
  if constexpr (Vector::RowsAtCompileTime == 1) {
    d[0] /= 1 + G(0, 0) * tangent[0];
  } else {
    Matrix A = G * tangent.asDiagonal();
    A.diagonal().array() += 1;
    linear_solvers::eliminate(A, d);
  }
  return d;
}

}  // namespace detail

/// f of (1). Where (3) finds no way down, as laws that fall with their rate may have it, it ends with a step
/// of Newton's method as it is. @param G, z by as many laws as there are
template <class Matrix, class Vector>
Vector law_forces(const Matrix& G, const Vector& z, const std::vector<LawHere>& laws) {
  Vector w = Vector::Zero(z.size());
  detail::LawChanges<Vector> at(laws, w);
  for (int k = 0;; ++k) {
    const Vector F = w + G * at.q - z;
    const Vector d = detail::newton_step(G, at.tangent, F);
    const Vector end = at.q + at.tangent.cwiseProduct(d);  // on the tangents, where w + d + G f = z
    if (k == detail::most_law_steps || !(d.cwiseAbs().maxCoeff() > detail::last_law_step)) return end;
    double t = 1;
    for (int shorter = 0;; ++shorter, t *= 0.5) {
      if (shorter == detail::most_shortenings) return end;
      const Vector further = w + t * d;
      const detail::LawChanges<Vector> there(laws, further);
      if ((further + G * there.q - z).norm() < F.norm()) {
        w = further;
        at = there;
        break;
      }
    }
  }
}

}  // namespace flexarm::integrators
