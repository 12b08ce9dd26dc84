#include "flexarm/assembly/loop_closures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "flexarm/errors.hpp"

namespace flexarm::assembly {

void LoopClosures::add(const std::string& name, const ClosureConstraint& closure,
                       std::optional<BeamSlide> slide) {
  first_.push_back(conditions());
  names_.push_back(name);
  closures_.push_back(closure);
  slides_.push_back(std::move(slide));
  const int m = conditions() + closure.size();
  P_ = MatrixXd::Identity(m, m);
}

void LoopClosures::leave_out(const MatrixXd& N) {
  const Eigen::Index m = P_.rows(), rank = m - N.cols();
  MatrixXd rest = MatrixXd::Identity(m, m) - N * N.transpose();
  P_.resize(m, rank);
  for (Eigen::Index k = 0; k < rank; ++k) {
    Eigen::Index pivot;
    rest.diagonal().maxCoeff(&pivot);
    P_.col(k) = rest.col(pivot) / std::sqrt(rest(pivot, pivot));
    rest -= P_.col(k) * P_.col(k).transpose();
  }
  constexpr double rounding = 1e-12;  // of an orthonormal column, far below what a combination needs
  P_ = (P_.array().abs() < rounding).select(0.0, P_);
}

VectorXd LoopClosures::gap(const Frames& frames) const {
  VectorXd g(conditions());
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const ClosureConstraint& closure = closures_[k];
    if (slides_[k]) {
      g.segment<2>(first_[k]) = slides_[k]->gap(frames);
      continue;
    }
    g.segment(first_[k], closure.size()) =
        closure.gap(frame(frames, closure.node_a()), frame(frames, closure.node_b()));
  }
  return g;
}

double LoopClosures::unmet(const Frames& frames) const {
  if (redundant() == 0) return 0;
  const VectorXd g = gap(frames);
  return (g - P_ * (P_.transpose() * g)).lpNorm<Eigen::Infinity>();
}

void LoopClosures::check(const Frames& frames, double reach, double t) const {
  char text[240];
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    if (!slides_[k]) continue;
    const geometry::Vector3d at = place_on_b(k, frames);
    const auto beyond = [&](int node) { return frames[node].R.col(0).dot(at - frames[node].x); };
    const double off =
        std::max(-beyond(slides_[k]->nodes(0)[0]), beyond(slides_[k]->nodes(slides_[k]->size() - 1)[1]));
    if (off <= 1e-7 * reach) continue;
    std::snprintf(text, sizeof text,
                  "t = %.6g s: the point of closure '%.80s' is %.3g m beyond the end of its beam", t,
                  names_[k].c_str(), off);
    throw NotConverged(text, t, 0, off);
  }
  const double left = unmet(frames);
  if (left <= 1e-7 * reach) return;
  std::snprintf(text, sizeof text,
                "t = %.6g s: the closures are %.2g m open in conditions that their loops should keep by "
                "themselves: the loops lock here",
                t, left);
  throw NotConverged(text, t, 0, left);
}

joints::Conditions LoopClosures::multipliers(std::size_t k, const Eigen::Ref<const VectorXd>& mu) const {
  return part(k) * mu;
}

void LoopClosures::add_forces(const Frames& frames, const Eigen::Ref<const VectorXd>& mu, VectorXd& r) const {
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const ClosureConstraint& closure = closures_[k];
    const joints::Conditions lambda = multipliers(k, mu);
    if (const auto& slide = slides_[k]) {
      const Eigen::Matrix<double, 18, 1> f = slide->jacobian(frames).transpose() * lambda;
      const std::array<int, 3> nodes = slide->nodes(slide->touched(frames));
      for (int i = 0; i < 3; ++i)
        if (nodes[i] >= 0) r.segment<6>(6 * nodes[i]) += f.segment<6>(6 * i);
      continue;
    }
    const int a = closure.node_a(), b = closure.node_b();
    const auto J = closure.jacobian(frame(frames, a), frame(frames, b));
    if (a >= 0) r.segment<6>(6 * a) += J.a.transpose() * lambda;
    if (b >= 0) r.segment<6>(6 * b) += J.b.transpose() * lambda;
  }
}

VectorXd LoopClosures::acceleration(const Frames& frames, const VectorXd& v, const VectorXd& v_dot) const {
  VectorXd c(conditions());
  const auto of = [](const VectorXd& u, int node) {
    return node < 0 ? geometry::Vector6d(geometry::Vector6d::Zero())
                    : geometry::Vector6d(u.segment<6>(6 * node));
  };
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const ClosureConstraint& closure = closures_[k];
    if (const auto& slide = slides_[k]) {
      c.segment<2>(first_[k]) =
          slide->jacobian(frames) * slide->part(slide->touched(frames), v_dot) + slide->convective(frames, v);
      continue;
    }
    const int a = closure.node_a(), b = closure.node_b();
    const Frame &H_a = frame(frames, a), &H_b = frame(frames, b);
    const auto J = closure.jacobian(H_a, H_b);
    c.segment(first_[k], closure.size()) =
        J.a * of(v_dot, a) + J.b * of(v_dot, b) + closure.convective(H_a, H_b, of(v, a), of(v, b));
  }
  return P_.transpose() * c;
}

geometry::Vector6d LoopClosures::wrench_on_b(std::size_t k, const Frames& frames,
                                             const Eigen::Ref<const VectorXd>& mu) const {
  const ClosureConstraint& closure = closures_[k];
  if (slides_[k]) {
    geometry::Vector6d wrench = geometry::Vector6d::Zero();
    wrench.head<3>() = slides_[k]->force_on_b(frames, multipliers(k, mu));
    return wrench;
  }
  return closure.wrench_on_b(frame(frames, closure.node_a()), frame(frames, closure.node_b()),
                             multipliers(k, mu));
}

}  // namespace flexarm::assembly
