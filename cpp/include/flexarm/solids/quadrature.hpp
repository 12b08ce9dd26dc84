/// @file
/// Integration over the reference cells,
///
///     ∫ f dξ ≈ Σ w_p f(ξ_p)                                                                            (1)
///
/// Gauss products on [−1, 1]³ for hexahedra; symmetric rules of degree 1, 2 and 5 on the unit tetrahedron (ξ,
/// η, ζ ≥ 0, ξ + η + ζ ≤ 1, volume 1/6). Sources: [ZienkiewiczTaylor], [Walkington2000] for the rule of
/// degree 5.
#pragma once

#include <Eigen/Core>

namespace flexarm::solids {

template <int n>
struct Quadrature {
  static constexpr int size = n;
  Eigen::Matrix<double, 3, n> points;
  Eigen::Matrix<double, n, 1> weights;
};

const Quadrature<8>& gauss_2();             // exact to degree 3 in each coordinate
const Quadrature<27>& gauss_3();            // to degree 5
const Quadrature<1>& tetrahedron_centre();  // to degree 1
const Quadrature<4>& tetrahedron_4();       // to degree 2
const Quadrature<14>& tetrahedron_14();     // to degree 5

}  // namespace flexarm::solids
