/// @file
/// Two-node beam element in local frames: the smallest super-element.
///
/// Node frames H₁, H₂ sit on the beam's axis, x along it. With T_r, T_l the tangent operators of SE(3),
///
///     d  = log(H₁⁻¹ H₂),   e = d − d₀ − b(t)                   deformation                          (1)
///     e' = T_r⁻¹(d) v₂ − T_l⁻¹(d) v₁ − b'(t)                   its rate                             (2)
///     f₁ = −T_l⁻ᵀ K (e + η e'),  f₂ = T_r⁻ᵀ K (e + η e')       internal forces in the nodes' axes   (3)
///     M v' − ad(v)ᵀ M v                                        inertia forces, M constant           (4)
///
/// In the coordinates (1) the exact static stiffness of a straight beam is diagonal,
///
///     K = diag(EA/L, 12 EI_z/(L³ (1 + Φ_y)), 12 EI_y/(L³ (1 + Φ_z)), GJ/L, EI_y/L, EI_z/L)           (5)
///     Φ_y = 12 EI_z/(G A_y L²),  Φ_z = 12 EI_y/(G A_z L²)      zero for Euler-Bernoulli beams
///
/// because log measures the lateral offset from the chord of constant curvature, w − θL/2. M is the
/// consistent mass
///
///     M = ∫ ρA N_uᵀ N_u + ρI N_θᵀ N_θ dx                                                            (6)
///
/// of the shape functions that solve the unloaded static beam (cubic, with Φ). A bow is a strain that needs
/// no stress,
///
///     b(t) = b (1 − exp(−t/τ)),   b' = b exp(−t/τ)/τ           constant for τ = 0                   (7)
///
/// and a uniform curvature κ of it has b = L (0, 0, 0, 0, κ_y, κ_z) exactly. Since (1)-(4) see relative
/// motion only, they do not change when the element moves as a rigid body. In a plane (D = 2) stretch and one
/// plane of bending are left of (5) and (6). Units: SI. Sources: [Sonneville2014] for (1)-(4), [Friedman1993]
/// for the shape functions of (6); docs/theory.md, section "Beams".
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>

#include "flexarm/elements/beam_section.hpp"
#include "flexarm/elements/uncoupled.hpp"
#include "flexarm/geometry/plane.hpp"
#include "flexarm/geometry/se3.hpp"
#include "flexarm/model/arm.hpp"

namespace flexarm::elements {

using geometry::Frame;
using geometry::FrameIn;
using geometry::Matrix6d;
using geometry::Twist;
using geometry::TwistMatrix;
using geometry::Vector6d;

/// Stiffness and inertia per length of a beam, in section axes.
struct BeamProperties {
  double EA, GJ, EIy, EIz;       ///< [N], [N m²]
  double GAy, GAz;               ///< shear stiffness [N]; infinite: rigid in shear
  double rho_A;                  ///< [kg/m]
  double rho_Iy, rho_Iz, rho_J;  ///< rotary inertia about y, z and polar inertia [kg m]

  static BeamProperties from(const model::BeamLink& link);
  static BeamProperties from(const model::Section&, const model::Material&, model::BeamTheory);
};

/// Shape functions of one bending plane at ξ in [0, 1]: rows (w, θ) from (w₁, θ₁, w₂, θ₂), θ = w' without
/// shear.
Eigen::Matrix<double, 2, 4> bending_shape(double xi, double length, double Phi);

template <int D>
class BeamElementIn {
 public:
  static constexpr int n = geometry::freedoms<D>;
  using FrameD = FrameIn<D>;
  using TwistD = Twist<D>;
  using Ends = TwoTwists<D>;
  using EndsMatrix = TwoTwistsMatrix<D>;
  using StrainMatrix = Eigen::Matrix<double, n, 2 * n>;

  /// @param H1,H2 placements of the nodes in the undeformed arm, x axes along the element.
  BeamElementIn(int node1, int node2, const Frame& H1, const Frame& H2, const BeamProperties& properties)
    requires(D == 3);

  /// The part of a beam within a plane, whose `axes` seen from both nodes have their first along the beam.
  BeamElementIn(const BeamElementIn<3>& beam, const geometry::PlaneAxes& axes)
    requires(D == 2);

  int node1() const { return node1_; }
  int node2() const { return node2_; }
  double length() const { return length_; }
  const TwistD& stiffness() const { return K_; }     ///< diagonal of (5)
  const EndsMatrix& mass() const { return M_; }      ///< equation (6)
  double mass_total() const { return mass_total_; }  ///< ρA L [kg]

  /// Equation (7): b of this element and τ [s].
  void set_bow(const TwistD& b, double tau) { bow_ = b, bow_time_ = tau, rest_ = d0_ + b; }
  const TwistD& bow() const { return bow_; }
  bool grows() const { return bow_time_ > 0; }
  TwistD rest(double t) const {  ///< d₀ + b(t)
    return grows() ? TwistD(d0_ - std::expm1(-t / bow_time_) * bow_) : rest_;
  }
  TwistD bow_rate(double t) const {  ///< b'(t)
    return grows() ? TwistD(std::exp(-t / bow_time_) / bow_time_ * bow_) : TwistD::Zero();
  }

  double damping_time() const { return eta_; }
  void set_damping_time(double eta) { eta_ = eta; }  ///< η of (3) [s]

  /// Equation (1): e. Here and below t is the time since the start of the run [s].
  TwistD deformation(const FrameD& H1, const FrameD& H2, double t = 0) const {
    return geometry::logarithm<D>(geometry::relative<D>(H1, H2)) - rest(t);
  }

  /// Equation (3); zero velocities give the elastic part, but for the rate of a growing bow.
  struct EndForces {
    TwistD f1, f2;
    double energy;       ///< ½ eᵀ K e [J]
    double dissipation;  ///< η e'ᵀ K e' [W]
    double bow_power;    ///< −b'ᵀ K (e + η e'): what the growing bow gives [W]
  };
  EndForces internal_forces(const FrameD& H1, const FrameD& H2, const TwistD& v1, const TwistD& v2,
                            double t = 0) const;

  /// M v, using that stretch, twist and the two bending planes do not couple.
  Ends momentum(const Ends& v) const { return Uncoupled<D>::product(M_, v); }

  /// Equation (4).
  Ends inertia_forces(const Ends& v, const Ends& v_dot) const;

  /// ∂(3)/∂(increments of the nodes), geometric stiffness included.
  EndsMatrix stiffness_matrix(const FrameD& H1, const FrameD& H2, const TwistD& v1 = TwistD::Zero(),
                              const TwistD& v2 = TwistD::Zero(), double t = 0) const;

  /// ∂(3)/∂(velocities) = η Bᵀ K B with B = [−T_l⁻¹, T_r⁻¹].
  EndsMatrix damping_matrix(const FrameD& H1, const FrameD& H2) const;

  /// ∂(4)/∂(velocities): gyroscopic terms.
  EndsMatrix gyroscopic_matrix(const Ends& v) const;

  /// ∂(3) + ∂(4) by increments of the nodes and by velocities, where they are wanted.
  struct TangentMatrices {
    EndsMatrix stiffness, damping;
  };
  void find_tangents(const FrameD& H1, const FrameD& H2, const Ends& v, double t, bool damping,
                     bool stiffness, TangentMatrices& found) const;

  /// The section at ξ in [0, 1], from the shape functions in the coordinates (1).
  BeamSection<D> section(double xi) const { return {d0_, xi * d0_, shape_matrix(xi)}; }
  /// Its placement, and its velocity in its own axes.
  FrameD interpolate(const FrameD& H1, const FrameD& H2, double xi) const {
    return section(xi).frame(H1, H2);
  }
  TwistD interpolate_velocity(const FrameD& H1, const FrameD& H2, const TwistD& v1, const TwistD& v2,
                              double xi) const {
    return section(xi).velocity(H1, H2, v1, v2);
  }

  /// Share of the element's weight at its two ends: mass [kg] and first moment [kg m] of the consistent
  /// gravity load.
  double end_mass() const { return 0.5 * mass_total_; }
  double end_moment() const { return mass_total_ * length_ / 12; }

  bool operator==(const BeamElementIn&) const = default;

  /// Whether both have the same stress in every deformation: K, η, d₀ and b(t).
  bool same_strength(const BeamElementIn& other) const {
    return K_ == other.K_ && eta_ == other.eta_ && rest_ == other.rest_ && d0_ == other.d0_ &&
           bow_ == other.bow_ && bow_time_ == other.bow_time_;
  }
  /// Whether both have the same shape functions, but for rounding.
  bool same_shape(const BeamElementIn& other) const {
    bool same = length_ == other.length_ && d0_ == other.d0_;
    for (std::size_t k = 0; k < Phi_.size(); ++k) {
      same = same && std::abs(Phi_[k] - other.Phi_[k]) <= 1e-13 * std::abs(Phi_[k]);
    }
    return same;
  }

 private:
  static constexpr auto& bending = Uncoupled<D>::bending;

  TwistMatrix<D> shape_matrix(double xi) const;
  StrainMatrix strain_matrix(const TwistD& d) const;  // B
  EndsMatrix stiffness_at(const TwistD& d, const StrainMatrix& B, const TwistD& v1, const TwistD& v2,
                          double t) const;
  EndsMatrix damping_at(const StrainMatrix& B) const {
    const StrainMatrix stress = (eta_ * K_).asDiagonal() * B;
    return B.transpose().lazyProduct(stress);
  }

  template <int>
  friend class BeamElementIn;

  int node1_, node2_;
  double length_, mass_total_;
  std::array<double, D - 1> Phi_;  // shear parameters of the bending planes
  double eta_ = 0;
  TwistD d0_, K_;
  TwistD bow_ = TwistD::Zero(), rest_;  // b; d₀ + b
  double bow_time_ = 0;                 // τ
  EndsMatrix M_;
};

using BeamElement = BeamElementIn<3>;

template <int D>
typename BeamElementIn<D>::EndForces BeamElementIn<D>::internal_forces(const FrameD& H1, const FrameD& H2,
                                                                       const TwistD& v1, const TwistD& v2,
                                                                       double t) const {
  const TwistD d = geometry::logarithm<D>(geometry::relative<D>(H1, H2));
  const geometry::InverseTangentIn<D> tangent(d);
  const TwistD e = d - rest(t);  // eq. (1)
  TwistD stress = K_.cwiseProduct(e);
  EndForces out;
  out.energy = 0.5 * stress.dot(e);
  out.dissipation = 0;
  if (eta_ > 0) {
    TwistD e_dot = tangent.strain_rate(v1, v2);
    if (grows()) e_dot -= bow_rate(t);  // eq. (2)
    const TwistD viscous = eta_ * K_.cwiseProduct(e_dot);
    out.dissipation = viscous.dot(e_dot);
    stress += viscous;
  }
  out.bow_power = grows() ? -bow_rate(t).dot(stress) : 0.0;
  const auto pair = tangent.transpose_times(stress);
  out.f1 = -pair.left;  // eq. (3)
  out.f2 = pair.right;
  return out;
}

template <int D>
typename BeamElementIn<D>::Ends BeamElementIn<D>::inertia_forces(const Ends& v, const Ends& v_dot) const {
  const Ends p = momentum(v);
  Ends f = momentum(v_dot);
  f.template head<n>() -= geometry::ad_transpose<D>(v.template head<n>(), p.template head<n>());  // eq. (4)
  f.template tail<n>() -= geometry::ad_transpose<D>(v.template tail<n>(), p.template tail<n>());
  return f;
}

}  // namespace flexarm::elements
