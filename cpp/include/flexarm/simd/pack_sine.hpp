/// @file
/// Sine and cosine of several numbers at once.
///
/// With k the nearest integer to 2 φ/π, r = φ − k π/2 is found by π/2 in three parts, of which the products
/// with k are exact up to k = 1e6, and sine and cosine of |r| ≤ π/4 by the polynomials of [Sun1993]:
///
///     sin φ, cos φ = sin r, cos r;  cos r, −sin r;  −sin r, −cos r;  −cos r, sin r   for k mod 4 = 0, 1, 2,
///     3  (1)
#pragma once

#include "flexarm/simd/pack.hpp"

namespace flexarm::simd {

template <class Real>
struct SineCosine {
  Real sine, cosine;
};

template <int N, class Processor>
SineCosine<Pack<N, Processor>> sine_cosine(const Pack<N, Processor>& phi) {
  using Real = Pack<N, Processor>;
  constexpr double two_per_pi = 6.36619772367581382433e-01;
  constexpr double part1 = 1.57079632673412561417e+00, part2 = 6.07710050630396597660e-11,
                   part3 = 2.02226624879595063154e-21;  // of π/2, 33 bits each but the last
  constexpr double to_integer = 6755399441055744.0;     // 1.5 2^52: a sum with it has no fraction
  const Real k = (phi * two_per_pi + to_integer) - to_integer;
  const Real r = ((phi - k * part1) - k * part2) - k * part3;
  const Real q = k - 4 * ((0.25 * k + to_integer) - to_integer);  // −2, −1, 0, 1 or 2
  const Real x = r * r;
  const Real sine =
      r + r * x *
              (-1.66666666666666324348e-01 +
               x * (8.33333333332248946124e-03 +
                    x * (-1.98412698298579493134e-04 +
                         x * (2.75573137070700676789e-06 +
                              x * (-2.50507602534068634195e-08 + x * 1.58969099521155010221e-10)))));
  const Real cosine =
      1 -
      (0.5 * x - x * x *
                     (4.16666666666666019037e-02 +
                      x * (-1.38888888888741095749e-03 +
                           x * (2.48015872894767294178e-05 +
                                x * (-2.75573143513906633035e-07 +
                                     x * (2.08757232129817482790e-09 + x * -1.13596475577881948265e-11))))));
  const Real even = 1 - 0.5 * q * q;     // sign of (1) where q is even
  const Real odd = q * q * (4 - q * q);  // not 0 where it is odd
  const Real is_even = 3 - odd;
  return {(q * cosine).where(odd) + (even * sine).where(is_even),
          (-q * sine).where(odd) + (even * cosine).where(is_even)};
}

}  // namespace flexarm::simd
