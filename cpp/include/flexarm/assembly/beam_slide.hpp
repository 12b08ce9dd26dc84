/// @file
/// A point that slides along a beam, wherever the beam bends: the pad of a telescope.
///
/// With A(ξ) the section of the beam at ξ in an element and p the point B in its axes, x along the beam,
///
///     p_x(ξ) = 0                    where the point touches                                            (1)
///     φ = (p_y, p_z) = 0            it stays on the axis                                               (2)
///     δφ = δ(p_y, p_z)|_ξ − ∂(p_y, p_z)/∂ξ δp_x|_ξ/(∂p_x/∂ξ)                                           (3)
///     δp|_ξ = Aᵀ δx_B − ρ_A − ω_A × p                                                                  (4)
///
/// The force is thus normal to the axis, which the shear turns from the section, and does no work along it.
/// A(ξ) is that of the element's shape functions, ρ_A and ω_A follow from increments of its nodes. What the
/// force does for a moving contact, its geometric stiffness and dJ/dt, are central differences of (3).
/// Beyond the ends the beam goes on as its last element bends. Source: [Sugiyama2003] for the sliding joint.
#pragma once

#include <array>
#include <vector>

#include "flexarm/elements/beam.hpp"
#include "flexarm/geometry/se3.hpp"

namespace flexarm::assembly {

class BeamSlide {
 public:
  using Frame = geometry::Frame;
  using Vector6d = geometry::Vector6d;
  using Frames = std::vector<Frame>;
  using Rows = Eigen::Matrix<double, 2, 18>;  // of the element's two nodes, and of b
  using Stiffness = Eigen::Matrix<double, 18, 18>;

  /// @param beam the elements in their order; @param place_on_b the point, in the frame of node b (−1: base).
  BeamSlide(std::vector<elements::BeamElementIn<3>> beam, int node_b, const geometry::Vector3d& place_on_b);

  std::size_t size() const { return beam_.size(); }  ///< elements
  std::array<int, 3> nodes(std::size_t element) const {
    return {beam_[element].node1(), beam_[element].node2(), node_b_};
  }
  std::size_t touched(const Frames& frames) const;  ///< the element of (1)

  Eigen::Vector2d gap(const Frames& frames) const;  ///< (2) [m]
  Rows jacobian(const Frames& frames) const;        ///< (3)
  /// Derivative of Jᵀλ for fixed λ with respect to the increments.
  Stiffness geometric_stiffness(const Frames& frames, const Eigen::Vector2d& lambda) const;
  /// (dJ/dt) v for velocities v of all nodes.
  Eigen::Vector2d convective(const Frames& frames, const Eigen::VectorXd& v) const;
  /// Force on b at the point, base axes.
  geometry::Vector3d force_on_b(const Frames& frames, const Eigen::Vector2d& lambda) const;

  /// Entries of a vector of all nodes at those of an element; zero for the base.
  Eigen::Matrix<double, 18, 1> part(std::size_t element, const Eigen::VectorXd& v) const;

 private:
  struct Contact {
    const elements::BeamElementIn<3>* element;
    std::array<Frame, 3> H;
  };
  Contact contact(const Frames& frames) const;
  double place(const Contact&) const;                        // ξ of (1)
  geometry::Vector3d seen(const Contact&, double xi) const;  // p
  Rows rows(const Contact&) const;

  std::vector<elements::BeamElementIn<3>> beam_;
  int node_b_;
  geometry::Vector3d place_on_b_;
};

}  // namespace flexarm::assembly
