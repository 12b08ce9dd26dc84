#include "flexarm/model/section.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "flexarm/errors.hpp"

namespace flexarm::model {
namespace {

using std::numbers::pi;

void require_positive(double value, const std::string& what, const std::string& unit) {
  if (!(value > 0)) {
    throw InvalidParameter(what + " must be positive, got " + std::to_string(value) + " " + unit);
  }
}

}  // namespace

void Section::check() const {
  require_positive(area, "section area", "m²");
  require_positive(second_moment_y, "section second_moment_y", "m⁴");
  require_positive(second_moment_z, "section second_moment_z", "m⁴");
  require_positive(torsion_constant, "section torsion_constant", "m⁴");
  require_positive(shear_area_y, "section shear_area_y", "m²");
  require_positive(shear_area_z, "section shear_area_z", "m²");
}

void Material::check() const {
  require_positive(youngs_modulus, "Young's modulus", "Pa");
  require_positive(shear_modulus, "shear modulus", "Pa");
  if (!(density >= 0)) {
    throw InvalidParameter("density must not be negative, got " + std::to_string(density) + " kg/m³");
  }
}

Section tube_section(double outer_diameter, double thickness) {
  require_positive(outer_diameter, "tube outer_diameter", "m");
  require_positive(thickness, "tube thickness", "m");
  if (thickness > outer_diameter / 2) {
    throw InvalidParameter("tube thickness must be at most half the outer diameter " +
                           std::to_string(outer_diameter) + " m, got " + std::to_string(thickness) + " m");
  }
  const double D = outer_diameter;
  const double d = D - 2 * thickness;
  const double A = pi / 4 * (D * D - d * d);
  const double I = pi / 64 * (std::pow(D, 4) - std::pow(d, 4));
  return {A, I, I, 2 * I, 0.53 * A, 0.53 * A};  // eq. (1)
}

Section round_section(double diameter) {
  require_positive(diameter, "round diameter", "m");
  const double A = pi / 4 * diameter * diameter;
  const double I = pi / 64 * std::pow(diameter, 4);
  return {A, I, I, 2 * I, 0.886 * A, 0.886 * A};  // eq. (2)
}

Section rectangle_section(double width, double height) {
  require_positive(width, "rectangle width", "m");
  require_positive(height, "rectangle height", "m");
  const double A = width * height;
  const double b = std::max(width, height);
  const double h = std::min(width, height);
  double series = 0;
  for (int n = 0; n < 20; ++n) {
    const double k = 2 * n + 1;
    series += std::tanh(k * pi * b / (2 * h)) / std::pow(k, 5);
  }
  const double J = b * h * h * h * (1.0 / 3 - 64 / std::pow(pi, 5) * (h / b) * series);   // eq. (4)
  return {A, A * height * height / 12, A * width * width / 12, J, A * 5 / 6, A * 5 / 6};  // eq. (3)
}

}  // namespace flexarm::model
