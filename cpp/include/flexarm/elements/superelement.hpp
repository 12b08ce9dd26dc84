/// @file
/// A reduced part in local frames: the element of beam.hpp with n interface nodes and m internal modes.
///
/// The node of an interface stands at its position p_i; its axes are the part's in the undeformed part. The
/// first node carries the floating frame of the part, from which its deformation counts:
///
///     d_i = log(H₁⁻¹ H_i),  d_i0 = (p_i − p₁, 0),   ε = (d₂ − d₂₀, …, d_n − d_n0, η)                 (1)
///     ε' = B V,   V = (v₁, …, v_n, η'),   d_i' = T_r⁻¹(d_i) v_i − T_l⁻¹(d_i) v₁                      (2)
///
/// with the amplitudes η of the internal modes. To first order the part's displacements in the freedoms of
/// the reduction are u = G ε, where the block of interface i is T_r(d_i0) and that of the first is zero.
/// Since the reduced matrices K, C do not resist rigid motion (or must not: damping acts on deformation
/// only),
///
///     f = Bᵀ (K_ε ε + C_ε ε' − Γ γ),   K_ε = Gᵀ K G,  C_ε = Gᵀ C G,  Γ = Gᵀ M R_t                    (3)
///     M V' − ad(v)ᵀ M V                  interface by interface, M constant                          (4)
///
/// R_t moves the whole part by a translation, γ = R₁ᵀ g is gravity in the floating frame. Gravity derives
/// from
///
///     −g · (m x₁ + R₁ s),   s = s₁ + Γᵀ ε                                                           (5)
///
/// whose part with s₁, the first moment about the first node, is a Weight of that node. Logarithms of
/// relative frames bend a slender part along an arc, so that two interfaces without modes are exactly the
/// beam element. (4) takes M at the undeformed part, and leaves out what the rotation of the floating frame
/// does to internal modes directly (centrifugal and Coriolis forces, of order (angular rate / frequency of
/// the mode)²): what the rotation does to the interfaces is in. Units: SI. Sources: [Sonneville2014],
/// [Cardona1991]; docs/theory.md, section "Super-elements in the arm".
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "flexarm/elements/weight.hpp"
#include "flexarm/geometry/plane.hpp"
#include "flexarm/geometry/se3.hpp"
#include "flexarm/model/arm.hpp"

namespace flexarm::elements {

using Eigen::MatrixXd;
using Eigen::VectorXd;
using geometry::Frame;
using geometry::FrameIn;
using geometry::Matrix3d;
using geometry::Matrix6d;
using geometry::Twist;
using geometry::TwistMatrix;
using geometry::Vector3d;
using geometry::Vector6d;

template <int D>
class SuperElementIn {
 public:
  static constexpr int n = geometry::freedoms<D>;
  using PointD = geometry::Point<D>;
  using TwistD = Twist<D>;

  /// @param first_node,first_mode the nodes and the scalar coordinates of the modes follow one another.
  /// @throws InvalidParameter naming the link if the matrices do not fit together.
  SuperElementIn(const model::SuperElementLink& part, int first_node, int first_mode)
    requires(D == 3);

  /// The part within a plane. @param modes columns: amplitudes η of the combinations of modes that stay.
  SuperElementIn(const SuperElementIn<3>& part, const geometry::PlaneAxes& axes, const MatrixXd& modes,
                 int first_mode)
    requires(D == 2);

  int n_interfaces() const { return static_cast<int>(positions_.size()); }
  int n_modes() const { return n_modes_; }
  int size() const { return n * n_interfaces() + n_modes_; }  ///< entries of V
  int node(int interface) const { return first_node_ + interface; }
  int mode(int k) const { return first_mode_ + k; }  ///< scalar coordinate of a mode

  const MatrixXd& mass() const { return M_; }
  const MatrixXd& deformation_stiffness() const { return K_; }  ///< K_ε
  const MatrixXd& deformation_damping() const { return C_; }    ///< C_ε
  const auto& weight_by_deformation() const { return Gamma_; }  ///< Γ
  const std::string& name() const { return name_; }
  const TwistMatrix<D>& rigid_mass() const { return rigid_mass_; }  ///< about the first node
  /// m and s₁ of (5).
  WeightIn<D> weight() const;

  /// C_ε = 2 ζ/ω₁ K_ε instead of the part's own; ω₁ is the lowest frequency with the first interface clamped.
  void set_damping_ratio(double zeta)
    requires(D == 3);

  /// Where the part is: its interfaces' frames and the amplitudes of its modes.
  struct Configuration {
    std::vector<FrameIn<D>> frames;
    VectorXd eta;
  };

  /// Equation (1): ε.
  VectorXd deformation(const Configuration& at) const;

  /// Equation (3).
  struct Forces {
    VectorXd f;          ///< one entry a velocity, in the nodes' axes
    double elastic;      ///< ½ εᵀ K_ε ε [J]
    double gravity;      ///< −γ · Γᵀ ε, what (5) adds to the weight of the first node [J]
    double dissipation;  ///< ε'ᵀ C_ε ε' [W]
  };
  Forces internal_forces(const Configuration& at, const VectorXd& V, const PointD& gravity) const;

  /// M V.
  VectorXd momentum(const VectorXd& V) const { return M_ * V; }

  /// Equation (4).
  VectorXd inertia_forces(const VectorXd& V, const VectorXd& V_dot) const;

  /// The same at once, as views into the state of an arm: frames of the interfaces, amplitudes of the modes,
  /// velocities and accelerations of both.
  struct Motion {
    const FrameIn<D>* frames;
    Eigen::Map<const VectorXd> eta, v, eta_dot, v_dot, eta_ddot;

    VectorXd velocities() const { return (VectorXd(v.size() + eta.size()) << v, eta_dot).finished(); }
    VectorXd accelerations() const { return (VectorXd(v.size() + eta.size()) << v_dot, eta_ddot).finished(); }
  };
  Configuration configuration(const Motion& at) const;

  /// (3) + (4), added to the rows of the interfaces and to those of the modes: what internal_forces() and
  /// inertia_forces() give, faster.
  void add_forces(const Motion& at, const PointD& gravity, Eigen::Ref<VectorXd> r,
                  Eigen::Ref<VectorXd> r_modes) const;

  struct Energies {
    double kinetic, elastic, gravity, dissipation = 0;  ///< [J], [J], [J] as in Forces, [W]
  };
  Energies energies(const Motion& at, const PointD& gravity) const;

  /// ∂(3)/∂(increments), geometric stiffness included.
  MatrixXd stiffness_matrix(const Configuration& at, const VectorXd& V, const PointD& gravity) const;

  /// ∂(3)/∂V = Bᵀ C_ε B.
  MatrixXd damping_matrix(const Configuration& at) const;

  /// ∂(4)/∂V.
  MatrixXd gyroscopic_matrix(const VectorXd& V) const;

  /// The part's frame, fixed to the first interface, and u = G ε in the freedoms of the reduction.
  struct Shape {
    Frame frame;
    VectorXd u;
  };
  Shape shape(const Configuration& at) const
    requires(D == 3);

  bool operator==(const SuperElementIn&) const = default;

 private:
  template <int>
  friend class SuperElementIn;

  template <int I>
  struct Sized;           // superelement_motion.cpp
  void find_structure();  // rest_, damped_, modes_apart_ of the matrices

  VectorXd strains(const Configuration& at) const;                    // d_i of all but the first interface
  MatrixXd strain_matrix(const VectorXd& d) const;                    // B
  VectorXd to_nodes(const VectorXd& d, const VectorXd& sigma) const;  // Bᵀ σ

  std::string name_;
  int first_node_, first_mode_, n_modes_;
  std::vector<PointD> positions_;
  VectorXd mode_scale_;  // amplitude of the part's mode for η = 1 m
  MatrixXd G_, M_, K_, C_;
  Eigen::Matrix<double, Eigen::Dynamic, D> Gamma_;
  TwistMatrix<D> rigid_mass_;
  VectorXd rest_;             // d_i0 of all but the first interface
  bool damped_ = false;       // C is not zero
  bool modes_apart_ = false;  // nothing but M_bm couples them
};

using SuperElement = SuperElementIn<3>;

}  // namespace flexarm::elements
