/// @file
/// A function given by a table: monotone cubic between its knots, held beyond them.
///
///     y(x) = y_i + m_i u + (3 s_i − 2 m_i − m_{i+1}) u²/h_i + (m_i + m_{i+1} − 2 s_i) u³/h_i²        (1)
///     1/m_i = [(2 h_i + h_{i−1})/s_{i−1} + (h_i + 2 h_{i−1})/s_i]/(3 (h_i + h_{i−1}))                (2)
///
/// for x_i <= x <= x_{i+1}, with u = x − x_i, h_i = x_{i+1} − x_i and the secants s_i = (y_{i+1} − y_i)/h_i.
/// m_i = 0 where the secants beside a knot differ in sign or one of them is zero. At the ends m is the slope
/// of the parabola through three knots, limited so that (1) stays monotone; of two knots it is the line. A
/// table on a straight line gives that line. Units: those of the table. Source: [Fritsch1984].
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "flexarm/errors.hpp"

namespace flexarm::joints {

class MonotoneCubic {
 public:
  MonotoneCubic() = default;  ///< zero everywhere
  MonotoneCubic(std::vector<double> x, std::vector<double> y)
      : x_(std::move(x)), y_(std::move(y)), slope_(x_.size()), area_(x_.size()) {
    check();
    for (std::size_t i = 0; i < x_.size(); ++i) slope_[i] = knot_slope(i);
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) area_[i + 1] = area_[i] + piece(i).area(h(i));
    zero_ = area_until(0);
  }

  bool empty() const { return x_.empty(); }

  struct Value {
    double y = 0, first = 0, second = 0;  ///< y, y', y''
  };

  Value operator()(double x) const {
    if (empty()) return {};
    if (x < x_.front()) return {y_.front()};
    if (x > x_.back()) return {y_.back()};
    const std::size_t i = interval(x);
    return piece(i)(x - x_[i]);
  }

  /// The integral of y from 0 to x.
  double integral(double x) const { return empty() ? 0 : area_until(x) - zero_; }

  /// Least and largest value: those of knots, for (1) is monotone between them.
  std::pair<double, double> range() const {
    if (empty()) return {0, 0};
    const auto [low, high] = std::minmax_element(y_.begin(), y_.end());
    return {*low, *high};
  }

  /// Least and largest slope, those of the parts that are held included.
  std::pair<double, double> slopes() const {
    std::pair<double, double> found{0, 0};
    const auto take = [&](double slope) {
      found = {std::min(found.first, slope), std::max(found.second, slope)};
    };
    for (std::size_t i = 0; i + 1 < x_.size(); ++i) {
      const Piece p = piece(i);
      const double turn = -p.c / (3 * p.d);  // where y' has its extremum
      for (const double u : {0.0, h(i), turn > 0 && turn < h(i) ? turn : 0.0}) take(p(u).first);
    }
    return found;
  }

  bool operator==(const MonotoneCubic& other) const { return x_ == other.x_ && y_ == other.y_; }

 private:
  /// Equation (1).
  struct Piece {
    double a, b, c, d;

    Value operator()(double u) const {
      return {a + u * (b + u * (c + u * d)), b + u * (2 * c + 3 * u * d), 2 * c + 6 * u * d};
    }
    double area(double u) const { return u * (a + u * (b / 2 + u * (c / 3 + u * d / 4))); }
  };

  double h(std::size_t i) const { return x_[i + 1] - x_[i]; }
  double secant(std::size_t i) const { return (y_[i + 1] - y_[i]) / h(i); }

  std::size_t interval(double x) const {
    const auto after = std::upper_bound(x_.begin() + 1, x_.end() - 1, x);
    return static_cast<std::size_t>(after - x_.begin()) - 1;
  }

  Piece piece(std::size_t i) const {
    const double s = secant(i), m0 = slope_[i], m1 = slope_[i + 1];
    return {y_[i], m0, (3 * s - 2 * m0 - m1) / h(i), (m0 + m1 - 2 * s) / (h(i) * h(i))};
  }

  double knot_slope(std::size_t i) const {
    const std::size_t last = x_.size() - 1;
    if (last == 1) return secant(0);
    if (i == 0) return end_slope(h(0), h(1), secant(0), secant(1));
    if (i == last) return end_slope(h(last - 1), h(last - 2), secant(last - 1), secant(last - 2));
    const double before = secant(i - 1), after = secant(i);
    if (!(before * after > 0)) return 0;
    const double w1 = 2 * h(i) + h(i - 1), w2 = h(i) + 2 * h(i - 1);
    return (w1 + w2) / (w1 / before + w2 / after);  // eq. (2)
  }

  /// h0 and s0 of the interval at the end, h1 and s1 of the one beside it.
  static double end_slope(double h0, double h1, double s0, double s1) {
    const double m = ((2 * h0 + h1) * s0 - h0 * s1) / (h0 + h1);
    if (!(m * s0 > 0)) return 0;
    if (!(s0 * s1 > 0) && std::abs(m) > 3 * std::abs(s0)) return 3 * s0;
    return m;
  }

  /// From the first knot.
  double area_until(double x) const {
    if (x < x_.front()) return (x - x_.front()) * y_.front();
    if (x > x_.back()) return area_.back() + (x - x_.back()) * y_.back();
    const std::size_t i = interval(x);
    return area_[i] + piece(i).area(x - x_[i]);
  }

  void check() const {
    if (x_.size() != y_.size() || x_.size() < 2) {
      throw InvalidParameter("a table needs as many values as knots, two or more, got " +
                             std::to_string(y_.size()) + " values at " + std::to_string(x_.size()) +
                             " knots");
    }
    for (std::size_t i = 0; i < x_.size(); ++i) {
      const bool rises = i == 0 || x_[i] > x_[i - 1];
      if (rises && std::isfinite(x_[i]) && std::isfinite(y_[i])) continue;
      char text[120];
      std::snprintf(text, sizeof text,
                    "knots of a table must rise and be finite like their values, got %g at %g", y_[i], x_[i]);
      throw InvalidParameter(text);
    }
  }

  std::vector<double> x_, y_, slope_, area_;  // area_: integral from the first knot
  double zero_ = 0;                           // the same until x = 0
};

}  // namespace flexarm::joints
