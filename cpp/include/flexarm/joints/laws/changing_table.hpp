/// @file
/// A table that gives way to another one about an instant t_c:
///
///     y(x, t) = (1 − s) y₀(x) + s y₁(x),    s = (t − t_c)/τ + ½, held at 0 and 1                    (1)
///
/// Over the duration τ the change is linear in time: so the impulse of a force is a continuous function of
/// t_c for any step, and exact where τ is a multiple of it. Units: t, t_c, τ in s.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "flexarm/errors.hpp"
#include "flexarm/joints/laws/monotone_cubic.hpp"

namespace flexarm::joints {

/// The table of (1) at one instant.
struct TableAtInstant {
  const MonotoneCubic &before, &after;
  double s, s_rate;

  MonotoneCubic::Value operator()(double x) const {
    if (s == 0) return before(x);
    const auto a = before(x), b = after(x);
    return {mean(a.y, b.y), mean(a.first, b.first), mean(a.second, b.second)};
  }
  /// ∂y/∂t.
  double rate(double x) const { return s_rate == 0 ? 0.0 : s_rate * (after(x).y - before(x).y); }
  double integral(double x) const {
    return s == 0 ? before.integral(x) : mean(before.integral(x), after.integral(x));
  }
  /// Bounds of the values.
  std::pair<double, double> range() const {
    if (s == 0) return before.range();
    const auto a = before.range(), b = after.range();
    return {mean(a.first, b.first), mean(a.second, b.second)};
  }

 private:
  double mean(double a, double b) const { return (1 - s) * a + s * b; }
};

struct ChangingTable {
  MonotoneCubic before, after = {};
  double instant = std::numeric_limits<double>::infinity();  ///< t_c
  double duration = 1;                                       ///< τ

  ChangingTable() = default;
  ChangingTable(MonotoneCubic table) : before(std::move(table)) {}
  ChangingTable(MonotoneCubic first, MonotoneCubic second, double t_c, double tau)
      : before(std::move(first)), after(std::move(second)), instant(t_c), duration(tau) {}

  bool operator==(const ChangingTable&) const = default;

  bool changes() const { return std::isfinite(instant); }

  TableAtInstant at(double t) const {
    const double s = changes() ? std::clamp((t - instant) / duration + 0.5, 0.0, 1.0) : 0.0;  // eq. (1)
    return {before, after, s, s > 0 && s < 1 ? 1 / duration : 0.0};
  }

  /// Least slope at any instant.
  double least_slope() const { return std::min(before.slopes().first, after.slopes().first); }

  void check() const {
    if (changes() && !(duration > 0 && std::isfinite(duration))) {
      throw InvalidParameter("a table must change over a positive duration, got " + std::to_string(duration) +
                             " s");
    }
  }
};

}  // namespace flexarm::joints
