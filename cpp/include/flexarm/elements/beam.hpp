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
/// motion only, they do not change when the element moves as a rigid body. Units: SI. Sources:
/// [Sonneville2014] for (1)-(4), [Friedman1993] for the shape functions of (6); docs/theory.md, section
/// "Beams".
#pragma once

#include <Eigen/Core>

#include "flexarm/geometry/se3.hpp"
#include "flexarm/model/arm.hpp"

namespace flexarm::elements {

using geometry::Frame;
using geometry::Matrix6d;
using geometry::Vector6d;
using Matrix12d = Eigen::Matrix<double, 12, 12>;
using Vector12d = Eigen::Matrix<double, 12, 1>;

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

class BeamElement {
 public:
  /// @param H1,H2 placements of the nodes in the undeformed arm, x axes along the element.
  BeamElement(int node1, int node2, const Frame& H1, const Frame& H2, const BeamProperties& properties);

  int node1() const { return node1_; }
  int node2() const { return node2_; }
  double length() const { return length_; }
  const Vector6d& stiffness() const { return K_; }   ///< diagonal of (5)
  const Matrix12d& mass() const { return M_; }       ///< equation (6)
  double mass_total() const { return mass_total_; }  ///< ρA L [kg]

  /// Equation (7): b of this element and τ [s].
  void set_bow(const Vector6d& b, double tau) { bow_ = b, bow_time_ = tau; }
  bool grows() const { return bow_time_ > 0; }

  double damping_time() const { return eta_; }
  void set_damping_time(double eta) { eta_ = eta; }  ///< η of (3) [s]

  /// Equation (1): e. Here and below t is the time since the start of the run [s].
  Vector6d deformation(const Frame& H1, const Frame& H2, double t = 0) const;

  /// Equation (3); zero velocities give the elastic part, but for the rate of a growing bow.
  struct EndForces {
    Vector6d f1, f2;
    double energy;       ///< ½ eᵀ K e [J]
    double dissipation;  ///< η e'ᵀ K e' [W]
    double bow_power;    ///< −b'ᵀ K (e + η e'): what the growing bow gives [W]
  };
  EndForces internal_forces(const Frame& H1, const Frame& H2, const Vector6d& v1, const Vector6d& v2,
                            double t = 0) const;

  /// M v, using that stretch, twist and the two bending planes do not couple.
  Vector12d momentum(const Vector12d& v) const;

  /// Equation (4).
  Vector12d inertia_forces(const Vector12d& v, const Vector12d& v_dot) const;

  /// ∂(3)/∂(increments of the nodes), geometric stiffness included.
  Matrix12d stiffness_matrix(const Frame& H1, const Frame& H2, const Vector6d& v1 = Vector6d::Zero(),
                             const Vector6d& v2 = Vector6d::Zero(), double t = 0) const;

  /// ∂(3)/∂(velocities) = η Bᵀ K B with B = [−T_l⁻¹, T_r⁻¹].
  Matrix12d damping_matrix(const Frame& H1, const Frame& H2) const;

  /// ∂(4)/∂(velocities): gyroscopic terms.
  Matrix12d gyroscopic_matrix(const Vector12d& v) const;

  /// Placement of the section at ξ in [0, 1], from the shape functions in the coordinates (1).
  Frame interpolate(const Frame& H1, const Frame& H2, double xi) const;

  /// Velocity of that section in its own axes.
  Vector6d interpolate_velocity(const Frame& H1, const Frame& H2, const Vector6d& v1, const Vector6d& v2,
                                double xi) const;

  /// Share of the element's weight at its two ends: mass [kg] and first moment [kg m] of the consistent
  /// gravity load.
  double end_mass() const { return 0.5 * mass_total_; }
  double end_moment() const { return mass_total_ * length_ / 12; }

 private:
  Matrix6d shape_matrix(double xi) const;
  Vector6d rest(double t) const;      // d₀ + b(t)
  Vector6d bow_rate(double t) const;  // b'(t)

  int node1_, node2_;
  double length_, mass_total_;
  double Phi_y_, Phi_z_;
  double eta_ = 0;
  Vector6d d0_, K_;
  Vector6d bow_ = Vector6d::Zero();  // b
  double bow_time_ = 0;              // τ
  Matrix12d M_;
};

}  // namespace flexarm::elements
