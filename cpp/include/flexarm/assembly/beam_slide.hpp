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
/// Beyond the ends the beam goes on as its last element bends. In a plane (2) is p_y = 0. Source:
/// [Sugiyama2003] for the sliding joint.
#pragma once

#include <array>
#include <vector>

#include "flexarm/elements/beam.hpp"
#include "flexarm/geometry/se3.hpp"

namespace flexarm::assembly {

template <int D>
class BeamSlideIn {
 public:
  static constexpr int n = geometry::freedoms<D>;
  using FrameD = geometry::FrameIn<D>;
  using PointD = geometry::Point<D>;
  using TwistD = geometry::Twist<D>;
  using Frames = std::vector<FrameD>;
  using Conditions = Eigen::Matrix<double, D - 1, 1>;
  using Rows = Eigen::Matrix<double, D - 1, 3 * n>;  // of the element's two nodes, and of b
  using Velocities = Eigen::Matrix<double, 3 * n, 1>;
  using Stiffness = Eigen::Matrix<double, 3 * n, 3 * n>;

  /// @param beam the elements in their order; @param place_on_b the point, in the frame of node b (−1: base).
  BeamSlideIn(std::vector<elements::BeamElementIn<D>> beam, int node_b, const PointD& place_on_b);
  /// The part within a plane, whose axes are seen from the nodes of the beam and from b.
  BeamSlideIn(const BeamSlideIn<3>& slide, const geometry::PlaneAxes& of_beam,
              const geometry::PlaneAxes& of_b)
    requires(D == 2);

  std::size_t size() const { return beam_.size(); }  ///< elements
  std::array<int, 3> nodes(std::size_t element) const {
    return {beam_[element].node1(), beam_[element].node2(), node_b_};
  }
  std::size_t touched(const Frames& frames) const;  ///< the element of (1)

  Conditions residual(const Frames& frames) const;  ///< (2) [m]
  Rows jacobian(const Frames& frames) const;        ///< (3)
  /// Derivative of Jᵀλ for fixed λ with respect to the increments.
  Stiffness geometric_stiffness(const Frames& frames, const Conditions& lambda) const;
  /// (dJ/dt) v for velocities v of all nodes.
  Conditions convective(const Frames& frames, const Eigen::VectorXd& v) const;
  /// Force on b at the point, base axes.
  PointD force_on_b(const Frames& frames, const Conditions& lambda) const;

  /// Entries of a vector of all nodes at those of an element; zero for the base.
  Velocities part(std::size_t element, const Eigen::VectorXd& v) const;

 private:
  struct Contact {
    const elements::BeamElementIn<D>* element;
    std::array<FrameD, 3> H;
  };
  template <int>
  friend class BeamSlideIn;
  Contact contact(const Frames& frames) const;
  double place(const Contact&) const;            // ξ of (1)
  PointD seen(const Contact&, double xi) const;  // p
  Rows rows(const Contact&) const;

  std::vector<elements::BeamElementIn<D>> beam_;
  int node_b_;
  PointD place_on_b_;
};

using BeamSlide = BeamSlideIn<3>;

}  // namespace flexarm::assembly
