/// @file
/// A beam element that the tests share.
#pragma once

#include "flexarm/elements/beam.hpp"

namespace flexarm::tests {

/// All stiffnesses and inertias different and of one size, so that no term hides behind another.
inline constexpr elements::BeamProperties plump{.EA = 900,
                                                .GJ = 30,
                                                .EIy = 50,
                                                .EIz = 20,
                                                .GAy = 400,
                                                .GAz = 250,
                                                .rho_A = 2.0,
                                                .rho_Iy = 0.03,
                                                .rho_Iz = 0.05,
                                                .rho_J = 0.08};

/// A straight beam along x, damped by η [s].
inline elements::BeamElement straight_beam(double length, const elements::BeamProperties& properties = plump,
                                           double eta = 0, int node1 = 0, int node2 = 1) {
  elements::BeamElement beam(node1, node2, {}, geometry::Frame::translation({length, 0, 0}), properties);
  beam.set_damping_time(eta);
  return beam;
}

}  // namespace flexarm::tests
