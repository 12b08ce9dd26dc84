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

BeamElement::BeamElement(int node1, int node2, const Frame& H1, const Frame& H2, const BeamProperties& p)
    : node1_(node1), node2_(node2), length_((H2.x - H1.x).norm()), d0_(log6(relative(H1, H2))) {
  const double L = length_;
  mass_total_ = p.rho_A * L;
  Phi_y_ = shear_parameter(p.EIz, p.GAy, L);
  Phi_z_ = shear_parameter(p.EIy, p.GAz, L);
  const double L3 = L * L * L;
  K_ << p.EA / L, 12 * p.EIz / (L3 * (1 + Phi_y_)), 12 * p.EIy / (L3 * (1 + Phi_z_)), p.GJ / L, p.EIy / L,
      p.EIz / L;  // eq. (5)
  Vector6d density;
  density << p.rho_A, p.rho_A, p.rho_A, p.rho_J, p.rho_Iy, p.rho_Iz;
  M_.setZero();
  for (std::size_t g = 0; g < gauss_points.size(); ++g) {
    const auto N = section_shape(gauss_points[g], L, Phi_y_, Phi_z_);
    M_ += gauss_weights[g] * L * N.transpose() * density.asDiagonal() * N;  // eq. (6)
  }
}

Vector6d BeamElement::rest(double t) const {
  return grows() ? Vector6d(d0_ - std::expm1(-t / bow_time_) * bow_) : Vector6d(d0_ + bow_);  // eq. (7)
}

Vector6d BeamElement::bow_rate(double t) const {
  return std::exp(-t / bow_time_) / bow_time_ * bow_;  // eq. (7)
}

Vector6d BeamElement::deformation(const Frame& H1, const Frame& H2, double t) const {
  return log6(relative(H1, H2)) - rest(t);  // eq. (1)
}

BeamElement::EndForces BeamElement::internal_forces(const Frame& H1, const Frame& H2, const Vector6d& v1,
                                                    const Vector6d& v2, double t) const {
  const Vector6d d = log6(relative(H1, H2));
  const InverseTangent tangent(d);
  const Vector6d e = d - rest(t);  // eq. (1)
  Vector6d stress = K_.cwiseProduct(e);
  EndForces out;
  out.energy = 0.5 * stress.dot(e);
  out.dissipation = 0;
  if (eta_ > 0) {
    Vector6d e_dot = tangent.strain_rate(v1, v2);
    if (grows()) e_dot -= bow_rate(t);  // eq. (2)
    const Vector6d viscous = eta_ * K_.cwiseProduct(e_dot);
    out.dissipation = viscous.dot(e_dot);
    stress += viscous;
  }
  out.bow_power = grows() ? -bow_rate(t).dot(stress) : 0.0;
  const InverseTangent::Pair pair = tangent.transpose_times(stress);
  out.f1 = -pair.left;  // eq. (3)
  out.f2 = pair.right;
  return out;
}

Vector12d BeamElement::momentum(const Vector12d& v) const {
  Vector12d p;
  for (int k : {0, 3}) {  // stretch, twist
    p[k] = M_(k, k) * v[k] + M_(k, k + 6) * v[k + 6];
    p[k + 6] = M_(k + 6, k) * v[k] + M_(k + 6, k + 6) * v[k + 6];
  }
  for (const auto& plane : {bending_xy, bending_xz}) {
    for (int row : plane) {
      p[row] = M_(row, plane[0]) * v[plane[0]] + M_(row, plane[1]) * v[plane[1]] +
               M_(row, plane[2]) * v[plane[2]] + M_(row, plane[3]) * v[plane[3]];
    }
  }
  return p;
}

Vector12d BeamElement::inertia_forces(const Vector12d& v, const Vector12d& v_dot) const {
  const Vector12d p = momentum(v);
  Vector12d f = momentum(v_dot);
  f.head<6>() -= ad_transpose(v.head<6>(), p.head<6>());  // eq. (4)
  f.tail<6>() -= ad_transpose(v.tail<6>(), p.tail<6>());
  return f;
}

Matrix12d BeamElement::stiffness_matrix(const Frame& H1, const Frame& H2, const Vector6d& v1,
                                        const Vector6d& v2, double t) const {
  const Vector6d d = log6(relative(H1, H2));
  Eigen::Matrix<double, 6, 12> B;
  B << -left_tangent_inverse(d), right_tangent_inverse(d);
  Vector6d stress = K_.cwiseProduct(d - rest(t));
  Matrix6d material = K_.asDiagonal();
  if (eta_ > 0) {
    Vector6d e_dot = InverseTangent(d).strain_rate(v1, v2);
    if (grows()) e_dot -= bow_rate(t);
    stress += eta_ * K_.cwiseProduct(e_dot);
    material += eta_ * K_.asDiagonal() * strain_rate_gradient(d, v1, v2);
  }
  const GeometricStiffness geometric = geometric_stiffness(d, stress);
  Matrix12d K = B.transpose() * material * B;
  K.topRows<6>() -= geometric.left * B;
  K.bottomRows<6>() += geometric.right * B;
  return K;
}

Matrix12d BeamElement::damping_matrix(const Frame& H1, const Frame& H2) const {
  const Vector6d d = log6(relative(H1, H2));
  Eigen::Matrix<double, 6, 12> B;
  B << -left_tangent_inverse(d), right_tangent_inverse(d);
  return eta_ * B.transpose() * K_.asDiagonal() * B;
}

Matrix12d BeamElement::gyroscopic_matrix(const Vector12d& v) const {
  const Vector12d p = momentum(v);
  Matrix12d G;
  for (int end = 0; end < 2; ++end) {
    const Vector6d v_end = v.segment<6>(6 * end);
    const Vector6d momentum_end = p.segment<6>(6 * end);
    G.middleRows<6>(6 * end) = -ad(v_end).transpose() * M_.middleRows<6>(6 * end);
    G.block<6, 6>(6 * end, 6 * end) -= ad_transpose_by_twist(momentum_end);
  }
  return G;
}

Matrix6d BeamElement::shape_matrix(double xi) const {
  // Row i of the interpolated log, c(ξ), from d, both measured from node 1. Across the beam c = w − θ x/2.
  Matrix6d N = xi * Matrix6d::Identity();
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
  plane(1, 5, 1.0, Phi_y_);
  plane(2, 4, -1.0, Phi_z_);
  return N;
}

Frame BeamElement::interpolate(const Frame& H1, const Frame& H2, double xi) const {
  const Vector6d e = log6(relative(H1, H2)) - d0_;
  return H1 * exp6(xi * d0_ + shape_matrix(xi) * e);
}

Vector6d BeamElement::interpolate_velocity(const Frame& H1, const Frame& H2, const Vector6d& v1,
                                           const Vector6d& v2, double xi) const {
  const Vector6d d = log6(relative(H1, H2));
  const Matrix6d N = shape_matrix(xi);
  const Vector6d c = xi * d0_ + N * (d - d0_);
  const Vector6d c_dot = N * InverseTangent(d).strain_rate(v1, v2);
  return adjoint(exp6(-c)) * v1 + right_tangent(c) * c_dot;
}

}  // namespace flexarm::elements
