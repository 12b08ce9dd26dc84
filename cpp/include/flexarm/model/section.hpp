/// @file
/// Cross-sections of beams, in section axes: local x along the beam, y and z across it.
///
///     tube        A = π (D² − d²)/4,  I = π (D⁴ − d⁴)/64,  J = 2 I,  shear factor 0.53          (1)
///     round       A = π D²/4,         I = π D⁴/64,         J = 2 I,  shear factor 0.886         (2)
///     rectangle   A = b h,  I_y = b h³/12,  I_z = h b³/12,           shear factor 5/6           (3)
///                 J = b h³ [1/3 − 64/π⁵ (h/b) Σ tanh((2n + 1) π b/(2 h))/(2n + 1)⁵],  h ≤ b     (4)
///
/// Units: m, m², m⁴. Sources: [Cowper1966] for the shear factors of thin tubes and full sections at Poisson
/// ratio 0.3 (0.53 and 0.886), [TimoshenkoGoodier] for (4).
#pragma once

#include <limits>

namespace flexarm::model {

/// Bending, torsion and shear properties of a section. An infinite shear area is rigid in shear.
struct Section {
  double area;              ///< A [m²]
  double second_moment_y;   ///< I_y = ∫ z² dA [m⁴], bending in the x-z plane
  double second_moment_z;   ///< I_z = ∫ y² dA [m⁴], bending in the x-y plane
  double torsion_constant;  ///< J [m⁴]
  double shear_area_y = std::numeric_limits<double>::infinity();  ///< k A along y [m²], shear factor included
  double shear_area_z = std::numeric_limits<double>::infinity();  ///< k A along z [m²]

  /// @throws InvalidParameter naming the property that is not positive.
  void check() const;
};

/// Equation (1). @throws InvalidParameter unless 0 < thickness <= outer_diameter/2.
Section tube_section(double outer_diameter, double thickness);

/// Equation (2).
Section round_section(double diameter);

/// Equations (3), (4): width b along y, height h along z.
Section rectangle_section(double width, double height);

/// Isotropic linear elastic material.
struct Material {
  double youngs_modulus;  ///< E [Pa]
  double shear_modulus;   ///< G [Pa]
  double density;         ///< ρ [kg/m³]

  void check() const;
};

}  // namespace flexarm::model
