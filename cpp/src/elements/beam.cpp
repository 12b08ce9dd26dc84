#include "flexarm/elements/beam.hpp"

#include <array>
#include <cmath>

namespace flexarm::elements {
namespace {

using namespace geometry;

/// Four-point Gauss rule on [0, 1]: exact for products of two cubics.
constexpr std::array<double, 4> gauss_points = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                                0.93056815579702629};
constexpr std::array<double, 4> gauss_weights = {0.17392742256872692, 0.32607257743127308,
                                                 0.32607257743127308, 0.17392742256872692};

/// Nodal values that take part in bending in the x-y and in the x-z plane: w₁, θ₁, w₂, θ₂.
constexpr std::array<int, 4> bending_xy = {1, 5, 7, 11};
constexpr std::array<int, 4> bending_xz = {2, 4, 8, 10};

/// Displacements and rotations of the section at ξ from the 12 nodal values: rows u, v, w, θx, θy, θz.
Eigen::Matrix<double, 6, 12> section_shape(double xi, double length, double Phi_y, double Phi_z) {
  Eigen::Matrix<double, 6, 12> N = Eigen::Matrix<double, 6, 12>::Zero();
  N(0, 0) = N(3, 3) = 1 - xi;
  N(0, 6) = N(3, 9) = xi;
  const auto xy = bending_shape(xi, length, Phi_y);  // v and θz: v' = θz
  const auto xz = bending_shape(xi, length, Phi_z);  // w and θy: w' = −θy
  const std::array<double, 4> sign = {1, -1, 1, -1};
  for (int k = 0; k < 4; ++k) {
    N(1, bending_xy[k]) = xy(0, k);
    N(5, bending_xy[k]) = xy(1, k);
    N(2, bending_xz[k]) = sign[k] * xz(0, k);
    N(4, bending_xz[k]) = -sign[k] * xz(1, k);
  }
  return N;
}

double shear_parameter(double EI, double GA, double length) { return 12 * EI / (GA * length * length); }

}  // namespace

BeamProperties BeamProperties::from(const model::BeamLink& link) {
  BeamProperties p = from(link.section, link.material, link.theory);
  for (double* EI : {&p.EIy, &p.EIz}) *EI *= link.bending_scale;
  for (double* inertia : {&p.rho_A, &p.rho_Iy, &p.rho_Iz, &p.rho_J}) *inertia *= link.mass_scale;
  return p;
}

BeamProperties BeamProperties::from(const model::Section& s, const model::Material& m,
                                    model::BeamTheory theory) {
  const double E = m.youngs_modulus, G = m.shear_modulus, rho = m.density;
  const bool timoshenko = theory == model::BeamTheory::timoshenko;
  const double rigid = std::numeric_limits<double>::infinity();
  return {.EA = E * s.area,
          .GJ = G * s.torsion_constant,
          .EIy = E * s.second_moment_y,
          .EIz = E * s.second_moment_z,
          .GAy = timoshenko ? G * s.shear_area_y : rigid,
          .GAz = timoshenko ? G * s.shear_area_z : rigid,
          .rho_A = rho * s.area,
          .rho_Iy = timoshenko ? rho * s.second_moment_y : 0.0,
          .rho_Iz = timoshenko ? rho * s.second_moment_z : 0.0,
          .rho_J = rho * (s.second_moment_y + s.second_moment_z)};
}

Eigen::Matrix<double, 2, 4> bending_shape(double xi, double length, double Phi) {
  const double L = length, x2 = xi * xi, x3 = x2 * xi;
  Eigen::Matrix<double, 2, 4> N;
  N << 1 - 3 * x2 + 2 * x3 + Phi * (1 - xi), L * (xi - 2 * x2 + x3 + Phi / 2 * (xi - x2)),
      3 * x2 - 2 * x3 + Phi * xi,
      L * (x3 - x2 + Phi / 2 * (x2 - xi)),  //
      6 * (x2 - xi) / L, 1 - 4 * xi + 3 * x2 + Phi * (1 - xi), 6 * (xi - x2) / L, 3 * x2 - 2 * xi + Phi * xi;
  return N / (1 + Phi);
}

template <int D>
BeamElementIn<D>::BeamElementIn(int node1, int node2, const Frame& H1, const Frame& H2,
                                const BeamProperties& p)
  requires(D == 3)
    : node1_(node1), node2_(node2), length_((H2.x - H1.x).norm()), d0_(log6(relative(H1, H2))), rest_(d0_) {
  const double L = length_;
  mass_total_ = p.rho_A * L;
  Phi_ = {shear_parameter(p.EIz, p.GAy, L), shear_parameter(p.EIy, p.GAz, L)};
  const double L3 = L * L * L;
  K_ << p.EA / L, 12 * p.EIz / (L3 * (1 + Phi_[0])), 12 * p.EIy / (L3 * (1 + Phi_[1])), p.GJ / L, p.EIy / L,
      p.EIz / L;  // eq. (5)
  Vector6d density;
  density << p.rho_A, p.rho_A, p.rho_A, p.rho_J, p.rho_Iy, p.rho_Iz;
  M_.setZero();
  for (std::size_t g = 0; g < gauss_points.size(); ++g) {
    const auto N = section_shape(gauss_points[g], L, Phi_[0], Phi_[1]);
    M_ += gauss_weights[g] * L * N.transpose() * density.asDiagonal() * N;  // eq. (6)
  }
}

template <int D>
BeamElementIn<D>::BeamElementIn(const BeamElementIn<3>& beam, const PlaneAxes& axes)
  requires(D == 2)
    : node1_(beam.node1_),
      node2_(beam.node2_),
      length_(beam.length_),
      mass_total_(beam.mass_total_),
      eta_(beam.eta_) {
  const auto P = axes.within();
  Eigen::Matrix<double, 12, 6> both = Eigen::Matrix<double, 12, 6>::Zero();
  both.topLeftCorner<6, 3>() = both.bottomRightCorner<6, 3>() = P;
  const double y = axes.normal().y(), z = axes.normal().z();
  Phi_ = {z * z * beam.Phi_[0] + y * y * beam.Phi_[1]};  // normal along a principal axis, or both are equal
  d0_ = P.transpose() * beam.d0_;
  set_bow(P.transpose() * beam.bow_, beam.bow_time_);
  K_ = (P.transpose() * beam.K_.asDiagonal() * P).diagonal();
  M_ = both.transpose() * beam.M_ * both;
}

template <int D>
typename BeamElementIn<D>::StrainMatrix BeamElementIn<D>::strain_matrix(const TwistD& d) const {
  StrainMatrix B;
  B << -geometry::left_tangent_inverse<D>(d), geometry::right_tangent_inverse<D>(d);
  return B;
}

template <int D>
typename BeamElementIn<D>::EndsMatrix BeamElementIn<D>::stiffness_matrix(const FrameD& H1, const FrameD& H2,
                                                                         const TwistD& v1, const TwistD& v2,
                                                                         double t) const {
  const TwistD d = logarithm<D>(relative<D>(H1, H2));
  return stiffness_at(d, strain_matrix(d), v1, v2, t);
}

template <int D>
typename BeamElementIn<D>::EndsMatrix BeamElementIn<D>::stiffness_at(const TwistD& d, const StrainMatrix& B,
                                                                     const TwistD& v1, const TwistD& v2,
                                                                     double t) const {
  TwistD stress = K_.cwiseProduct(d - rest(t));
  StrainMatrix material = K_.asDiagonal() * B;
  if (eta_ > 0) {
    TwistD e_dot = InverseTangentIn<D>(d).strain_rate(v1, v2);
    if (grows()) e_dot -= bow_rate(t);
    stress += eta_ * K_.cwiseProduct(e_dot);
    const TwistMatrix<D> gradient = geometry::strain_rate_gradient<D>(d, v1, v2);
    material += (eta_ * K_).asDiagonal() * gradient.lazyProduct(B);
  }
  const auto geometric = geometry::geometric_stiffness<D>(d, stress);
  EndsMatrix K = B.transpose().lazyProduct(material);
  K.template topRows<n>() -= geometric.left.lazyProduct(B);
  K.template bottomRows<n>() += geometric.right.lazyProduct(B);
  return K;
}

template <int D>
typename BeamElementIn<D>::EndsMatrix BeamElementIn<D>::damping_matrix(const FrameD& H1,
                                                                       const FrameD& H2) const {
  return damping_at(strain_matrix(logarithm<D>(relative<D>(H1, H2))));
}

template <int D>
[[gnu::flatten]] void BeamElementIn<D>::find_tangents(const FrameD& H1, const FrameD& H2, const Ends& v,
                                                      double t, bool damping, bool stiffness,
                                                      TangentMatrices& found) const {
  const TwistD d = logarithm<D>(relative<D>(H1, H2));
  const StrainMatrix B = strain_matrix(d);
  if (stiffness) found.stiffness = stiffness_at(d, B, v.template head<n>(), v.template tail<n>(), t);
  if (damping) found.damping = damping_at(B) + gyroscopic_matrix(v);
}

template <int D>
typename BeamElementIn<D>::EndsMatrix BeamElementIn<D>::gyroscopic_matrix(const Ends& v) const {
  const Ends p = momentum(v);
  EndsMatrix G;
  for (int end = 0; end < 2; ++end) {
    const TwistD v_end = v.template segment<n>(n * end);
    const TwistD momentum_end = p.template segment<n>(n * end);
    for (int j = 0; j < 2 * n; ++j) {
      const TwistD column = M_.col(j).template segment<n>(n * end);
      G.col(j).template segment<n>(n * end) = -geometry::ad_transpose<D>(v_end, column);
    }
    G.template block<n, n>(n * end, n * end) -= geometry::ad_transpose_by_twist<D>(momentum_end);
  }
  return G;
}

template <int D>
TwistMatrix<D> BeamElementIn<D>::shape_matrix(double xi) const {
  // Row i of the interpolated log, c(ξ), from d, both measured from node 1. Across the beam c = w − θ x/2.
  TwistMatrix<D> N = xi * TwistMatrix<D>::Identity();
  const double L = length_;
  const auto plane = [&](int w, int theta, double sign, double Phi) {
    const auto shape = bending_shape(xi, L, Phi);
    // d gives w₂ = d_w + sign d_θ L/2 and θ₂ = sign d_θ.
    const double w_w = shape(0, 2), w_t = shape(0, 2) * L / 2 + shape(0, 3);
    const double t_w = shape(1, 2), t_t = shape(1, 2) * L / 2 + shape(1, 3);
    N(w, w) = w_w - t_w * xi * L / 2;
    N(w, theta) = sign * (w_t - t_t * xi * L / 2);
    N(theta, w) = sign * t_w;
    N(theta, theta) = t_t;
  };
  plane(bending[0][0], bending[0][1], 1.0, Phi_[0]);
  if constexpr (D == 3) plane(bending[1][0], bending[1][1], -1.0, Phi_[1]);  // w' = −θy
  return N;
}

template class BeamElementIn<2>;
template class BeamElementIn<3>;

}  // namespace flexarm::elements
