#include "flexarm/simulation/prescribed_angle.hpp"

namespace flexarm::simulation {
namespace {

const integrators::HhtCoefficients damped = integrators::HhtCoefficients::from_alpha(-1.0 / 3);

}  // namespace

PrescribedAngle PrescribedAngle::reach(double s, double h) const {
  const auto [alpha, beta, gamma] = damped;
  const double a1 = ((s - motion.s - h * motion.v) / (h * h) - (0.5 - beta) * a) / beta;  // eq. (1)
  const double v1 = motion.v + h * ((1 - gamma) * a + gamma * a1);                        // eq. (1)
  return {{s, v1, (a1 + alpha * motion.v_dot) / (1 + alpha)}, a1};                        // eq. (2)
}

PrescribedAngle PrescribedAngle::follow(const Motion& end) const {
  const double alpha = damped.alpha;
  return {end, (1 + alpha) * end.v_dot - alpha * motion.v_dot};  // eq. (2)
}

Motion quintic(const Motion& begin, const Motion& end, double h, double x) {
  // Powers of x from 0 to 5: three are given at the beginning, three make up for what is missing at the end.
  const double c0 = begin.s, c1 = h * begin.v, c2 = 0.5 * h * h * begin.v_dot;
  const double s = end.s - (c0 + c1 + c2), v = h * end.v - (c1 + 2 * c2), w = h * h * end.v_dot - 2 * c2;
  const double c3 = 10 * s - 4 * v + 0.5 * w, c4 = -15 * s + 7 * v - w, c5 = 6 * s - 3 * v + 0.5 * w;
  return {c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * c5)))),
          (c1 + x * (2 * c2 + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / h,
          (2 * c2 + x * (6 * c3 + x * (12 * c4 + x * 20 * c5))) / (h * h)};
}

}  // namespace flexarm::simulation
