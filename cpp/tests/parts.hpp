/// @file
/// Reduced parts whose full model is known: frames of beams, reduced by dense algebra.
#pragma once

#include "arms.hpp"
#include "flexarm/elements/superelement.hpp"

namespace flexarm::tests {

/// Stiffness and mass of a free structure, six freedoms a node in common axes.
struct Structure {
  std::vector<Vector3d> nodes;
  MatrixXd K, M;
};

/// Star of straight beams from the origin, each cut into `elements`; the ends are the first nodes, in order.
Structure star_of_beams(const std::vector<Vector3d>& ends, int elements, const model::BeamLink& like);

/// Craig and Bampton: the first `interfaces` nodes stay, with `n_modes` modes of the rest.
model::SuperElementLink craig_bampton(const std::string& name, const Structure& full, int interfaces,
                                      int n_modes);

/// A straight beam from the origin as one part with interfaces i1 (origin) and i2 (end).
model::SuperElementLink reduced_beam(const model::BeamLink& beam, int elements, int n_modes);

/// Three arms of different lengths and directions, two modes; one interface's frame is turned.
model::SuperElementLink tripod();

/// A beam on a hinge carries the tripod, which carries a rigid body on a hinge, a beam and a payload.
model::Arm tripod_arm();

}  // namespace flexarm::tests
