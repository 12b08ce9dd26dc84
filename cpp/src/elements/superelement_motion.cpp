/// @file
/// What time stepping asks of a super-element in every iteration: (3) + (4) of superelement.hpp and its
/// energies, in one pass over the state and without temporaries of run-time size where there are two
/// interfaces. Modes of a fixed-interface reduction stand alone in K and C and are orthogonal in M,
///
///     K = [K_bb 0; 0 diag],  C alike,  M = [M_bb M_bm; M_bmᵀ diag]                                   (1)
///
/// so that only M_bm couples them to the interfaces; parts that are not of this kind take the general
/// products.
#include "flexarm/elements/superelement.hpp"

namespace flexarm::elements {
namespace {

using namespace geometry;

bool is_diagonal(const MatrixXd& A) {
  MatrixXd rest = A;
  rest.diagonal().setZero();
  return rest.isZero(0);
}

/// y += A x, a column at a time.
template <class A, class X, class Y>
void add_product(const A& a, const X& x, Y& y) {
  for (Eigen::Index k = 0; k < a.cols(); ++k) y += x[k] * a.col(k);
}

}  // namespace

/// Sizes of a part with I interfaces; those of several are known at run time only.
template <int D>
template <int I>
struct SuperElementIn<D>::Sized {
  static constexpr int ends = I == Eigen::Dynamic ? Eigen::Dynamic : n * I;
  static constexpr int strains = I == Eigen::Dynamic ? Eigen::Dynamic : n * (I - 1);
  using Ends = Eigen::Matrix<double, ends, 1>;
  using Strain = Eigen::Matrix<double, strains, 1>;

  const SuperElementIn& part;
  const Motion& at;
  Eigen::Index n_ends = n * part.n_interfaces(), n_strains = n_ends - n, n_modes = part.n_modes();
  Strain d{n_strains};  // of all but the first interface

  Sized(const SuperElementIn& of, const Motion& motion) : part(of), at(motion) {
    for (int i = 1; i < part.n_interfaces(); ++i) {
      d.template segment<n>(n * i - n) = logarithm<D>(relative<D>(at.frames[0], at.frames[i]));
    }
  }

  auto M_bb() const { return part.M_.template topLeftCorner<ends, ends>(n_ends, n_ends); }
  auto M_bm() const { return part.M_.template topRightCorner<ends, Eigen::Dynamic>(n_ends, n_modes); }
  auto M_mm() const { return part.M_.diagonal().tail(n_modes); }
  auto K_bb() const { return part.K_.template topLeftCorner<strains, strains>(n_strains, n_strains); }
  auto C_bb() const { return part.C_.template topLeftCorner<strains, strains>(n_strains, n_strains); }
  auto of_modes(const MatrixXd& A) const { return A.diagonal().tail(n_modes); }
  auto Gamma_b() const { return part.Gamma_.template topRows<strains>(n_strains); }
  auto Gamma_m() const { return part.Gamma_.bottomRows(n_modes); }

  Strain deformation() const { return d - part.rest_; }

  Strain rate() const {  // eq. (2) of superelement.hpp
    Strain e_dot(n_strains);
    for (int i = 1; i < part.n_interfaces(); ++i) {
      e_dot.template segment<n>(n * i - n) =
          InverseTangentIn<D>(d.template segment<n>(n * i - n))
              .strain_rate(at.v.template head<n>(), at.v.template segment<n>(n * i));
    }
    return e_dot;
  }

  /// Of the first moment by the deformation, eq. (5) of superelement.hpp.
  PointD shift(const Strain& e) const {
    PointD s = Gamma_b().transpose() * e;
    if (n_modes > 0) s.noalias() += Gamma_m().transpose() * at.eta;
    return s;
  }

  [[gnu::flatten]] void add_internal(const PointD& gravity, Eigen::Ref<VectorXd> r,
                                     Eigen::Ref<VectorXd> r_modes) const {
    const PointD gamma = at.frames[0].R.transpose() * gravity;
    const Strain e = deformation();
    Strain sigma = -(Gamma_b() * gamma);
    add_product(K_bb(), e, sigma);
    if (part.damped_) add_product(C_bb(), rate(), sigma);
    for (int i = 1; i < part.n_interfaces(); ++i) {
      const auto pair = InverseTangentIn<D>(d.template segment<n>(n * i - n))
                            .transpose_times(sigma.template segment<n>(n * i - n));
      r.template head<n>() -= pair.left;
      r.template segment<n>(n * i) += pair.right;
    }
    r.template segment<turns<D>>(D) -= moment_of<D>(shift(e), gamma);
    if (n_modes == 0) return;
    r_modes += of_modes(part.K_).cwiseProduct(at.eta);
    if (part.damped_) r_modes += of_modes(part.C_).cwiseProduct(at.eta_dot);
    r_modes.noalias() -= Gamma_m() * gamma;
  }

  [[gnu::flatten]] void add_inertia(Eigen::Ref<VectorXd> r, Eigen::Ref<VectorXd> r_modes) const {
    Ends p = Ends::Zero(n_ends), f = Ends::Zero(n_ends);  // M V and M V' of the interfaces
    for (Eigen::Index k = 0; k < n_ends; ++k) {
      const auto column = M_bb().col(k);
      p += at.v[k] * column;
      f += at.v_dot[k] * column;
    }
    for (Eigen::Index k = 0; k < n_modes; ++k) {
      const auto column = M_bm().col(k);
      p += at.eta_dot[k] * column;
      f += at.eta_ddot[k] * column;
      r_modes[k] += column.dot(at.v_dot.template head<ends>(n_ends)) + M_mm()[k] * at.eta_ddot[k];
    }
    for (int i = 0; i < part.n_interfaces(); ++i) {
      f.template segment<n>(n * i) -=
          ad_transpose<D>(at.v.template segment<n>(n * i), p.template segment<n>(n * i));
    }
    r += f;
  }

  Energies energies(const PointD& gravity) const {
    const Strain e = deformation();
    Strain sigma = Strain::Zero(n_strains);
    add_product(K_bb(), e, sigma);
    Ends p = Ends::Zero(n_ends), q = Ends::Zero(n_ends);  // M_bb v and M_bm η'
    add_product(M_bb(), at.v, p);
    add_product(M_bm(), at.eta_dot, q);
    p += 2 * q;
    Energies E;
    E.elastic = 0.5 * (e.dot(sigma) + at.eta.dot(of_modes(part.K_).cwiseProduct(at.eta)));
    E.kinetic = 0.5 * (at.v.template head<ends>(n_ends).dot(p) +
                       at.eta_dot.dot(of_modes(part.M_).cwiseProduct(at.eta_dot)));
    E.gravity = -gravity.dot(at.frames[0].R * shift(e));
    if (part.damped_) {
      const Strain e_dot = rate();
      sigma.setZero();
      add_product(C_bb(), e_dot, sigma);
      E.dissipation = e_dot.dot(sigma) + at.eta_dot.dot(of_modes(part.C_).cwiseProduct(at.eta_dot));
    }
    return E;
  }
};

template <int D>
void SuperElementIn<D>::find_structure() {
  const Eigen::Index n_strains = n * n_interfaces() - n;
  rest_.resize(n_strains);
  for (int i = 1; i < n_interfaces(); ++i) {
    rest_.segment<n>(n * i - n) << positions_[i] - positions_[0], Turn<D>::Zero();
  }
  damped_ = !C_.isZero(0);
  const auto apart = [&](const MatrixXd& A) {
    return A.topRightCorner(n_strains, n_modes_).isZero(0) &&
           A.bottomLeftCorner(n_modes_, n_strains).isZero(0) &&
           is_diagonal(A.bottomRightCorner(n_modes_, n_modes_));
  };
  modes_apart_ = apart(K_) && apart(C_) && is_diagonal(M_.bottomRightCorner(n_modes_, n_modes_)) &&
                 M_.bottomLeftCorner(n_modes_, n * n_interfaces()) ==
                     M_.topRightCorner(n * n_interfaces(), n_modes_).transpose();
}

template <int D>
typename SuperElementIn<D>::Configuration SuperElementIn<D>::configuration(const Motion& at) const {
  return {{at.frames, at.frames + n_interfaces()}, at.eta};
}

template <int D>
void SuperElementIn<D>::add_forces(const Motion& at, const PointD& gravity, Eigen::Ref<VectorXd> r,
                                   Eigen::Ref<VectorXd> r_modes) const {
  const auto add = [&](const auto& sized) {
    sized.add_internal(gravity, r, r_modes);
    sized.add_inertia(r, r_modes);
  };
  if (modes_apart_ && n_interfaces() == 2) return add(Sized<2>(*this, at));
  if (modes_apart_) return add(Sized<Eigen::Dynamic>(*this, at));
  const VectorXd V = at.velocities();
  const VectorXd f = internal_forces(configuration(at), V, gravity).f + inertia_forces(V, at.accelerations());
  r += f.head(n * n_interfaces());
  r_modes += f.tail(n_modes_);
}

template <int D>
typename SuperElementIn<D>::Energies SuperElementIn<D>::energies(const Motion& at,
                                                                 const PointD& gravity) const {
  if (modes_apart_ && n_interfaces() == 2) return Sized<2>(*this, at).energies(gravity);
  if (modes_apart_) return Sized<Eigen::Dynamic>(*this, at).energies(gravity);
  const VectorXd V = at.velocities();
  const Forces forces = internal_forces(configuration(at), V, gravity);
  return {0.5 * V.dot(momentum(V)), forces.elastic, forces.gravity, forces.dissipation};
}

template void SuperElementIn<2>::find_structure();
template void SuperElementIn<3>::find_structure();
template SuperElementIn<2>::Configuration SuperElementIn<2>::configuration(const Motion&) const;
template SuperElementIn<3>::Configuration SuperElementIn<3>::configuration(const Motion&) const;
template void SuperElementIn<2>::add_forces(const Motion&, const PointD&, Eigen::Ref<VectorXd>,
                                            Eigen::Ref<VectorXd>) const;
template void SuperElementIn<3>::add_forces(const Motion&, const PointD&, Eigen::Ref<VectorXd>,
                                            Eigen::Ref<VectorXd>) const;
template SuperElementIn<2>::Energies SuperElementIn<2>::energies(const Motion&, const PointD&) const;
template SuperElementIn<3>::Energies SuperElementIn<3>::energies(const Motion&, const PointD&) const;

}  // namespace flexarm::elements
