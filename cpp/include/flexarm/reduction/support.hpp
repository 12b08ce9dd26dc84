/// @file
/// Whether a part holds together and moves freely: what a reduction must know of K before it factors it.
///
///     K R = 0   for the six rigid motions R of the part                                              (1)
///
/// Points without stiffness and mass are left over by meshers; they are skipped. Anything else that would
/// make the factorisation fail is named here, by point and direction.
#pragma once

#include "flexarm/linear_solvers/lower_triangle.hpp"
#include "flexarm/reduction/interface.hpp"

namespace flexarm::reduction {

struct Support {
  std::vector<bool> used;  ///< points that carry stiffness
  int unused_points = 0;
  Eigen::Vector3d centre;      ///< mean of the used points [m]
  double length = 1;           ///< their root mean square distance from it [m]
  bool floating = false;       ///< no rigid interface: nothing holds the part
  std::vector<int> isostatic;  ///< six freedoms that would hold a floating part without straining it
};

/// @throws InvalidParameter if a freedom has no stiffness, is grounded, or a piece of the part is held by
/// nothing; if sizes do not agree or a number is not finite.
Support support(const linear_solvers::LowerTriangle& K, const linear_solvers::LowerTriangle& M,
                const Coordinates& coordinates, const std::vector<Interface>& interfaces);

/// R of (1) about the centre, rotations divided by the part's length; zero at unused points.
Eigen::MatrixXd scaled_rigid_motion(const Coordinates& coordinates, const Support& support);

/// "point 17 at (0.1, 0, 0.25) m".
std::string name_of_point(const Coordinates& coordinates, Eigen::Index point);
/// "point 17 at (0.1, 0, 0.25) m, direction y".
std::string name_of_freedom(const Coordinates& coordinates, Eigen::Index freedom);

}  // namespace flexarm::reduction
