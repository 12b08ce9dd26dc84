#include "flexarm/assembly/loop_closures.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "flexarm/errors.hpp"

namespace flexarm::assembly {

template <int D>
void LoopClosuresIn<D>::add(const std::string& name, const Closure& closure, std::optional<Slide> slide) {
  first_.push_back(conditions());
  names_.push_back(name);
  closures_.push_back(closure);
  slides_.push_back(std::move(slide));
  const int m = conditions() + size_of(size() - 1);
  P_ = MatrixXd::Identity(m, m);
}

template <int D>
void LoopClosuresIn<D>::leave_out(const MatrixXd& N) {
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

template <int D>
VectorXd LoopClosuresIn<D>::residual(const Frames& frames) const {
  VectorXd g(conditions());
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const Closure& closure = closures_[k];
    if (slides_[k]) {
      g.segment<D - 1>(first_[k]) = slides_[k]->residual(frames);
      continue;
    }
    g.segment(first_[k], closure.size()) =
        closure.residual(frame(frames, closure.node_a()), frame(frames, closure.node_b()));
  }
  return g;
}

template <int D>
double LoopClosuresIn<D>::unmet(const Frames& frames) const {
  if (redundant() == 0) return 0;
  const VectorXd g = residual(frames);
  return (g - P_ * (P_.transpose() * g)).lpNorm<Eigen::Infinity>();
}

template <int D>
void LoopClosuresIn<D>::check(const Frames& frames, double reach, double t) const {
  char text[240];
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    if (!slides_[k]) continue;
    const geometry::Point<D> at = place_on_b(k, frames);
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

template <int D>
Conditions LoopClosuresIn<D>::multipliers(std::size_t k, const Eigen::Ref<const VectorXd>& mu) const {
  if (redundant() == 0) return mu.segment(first_[k], size_of(k));
  return part(k) * mu;
}

template <int D>
VectorXd LoopClosuresIn<D>::add_forces(const Frames& frames, const Eigen::Ref<const VectorXd>& mu,
                                       VectorXd& r) const {
  VectorXd g(conditions());
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const Closure& closure = closures_[k];
    const Conditions lambda = multipliers(k, mu);
    if (const auto& slide = slides_[k]) {
      const typename Slide::Velocities f = slide->jacobian(frames).transpose() * lambda;
      const std::array<int, 3> nodes = slide->nodes(slide->touched(frames));
      for (int i = 0; i < 3; ++i)
        if (nodes[i] >= 0) r.segment<n>(n * nodes[i]) += f.template segment<n>(n * i);
      g.segment<D - 1>(first_[k]) = slide->residual(frames);
      continue;
    }
    const int a = closure.node_a(), b = closure.node_b();
    const auto now = closure.respond(frame(frames, a), frame(frames, b), lambda);
    if (a >= 0) r.segment<n>(n * a) += now.a;
    if (b >= 0) r.segment<n>(n * b) += now.b;
    g.segment(first_[k], closure.size()) = now.residual;
  }
  return redundant() == 0 ? g : P_.transpose() * g;
}

template <int D>
VectorXd LoopClosuresIn<D>::acceleration(const Frames& frames, const VectorXd& v,
                                         const VectorXd& v_dot) const {
  VectorXd c(conditions());
  const auto of = [](const VectorXd& u, int node) {
    return node < 0 ? TwistD(TwistD::Zero()) : TwistD(u.segment<n>(n * node));
  };
  for (std::size_t k = 0; k < closures_.size(); ++k) {
    const Closure& closure = closures_[k];
    if (const auto& slide = slides_[k]) {
      c.segment<D - 1>(first_[k]) =
          slide->jacobian(frames) * slide->part(slide->touched(frames), v_dot) + slide->convective(frames, v);
      continue;
    }
    const int a = closure.node_a(), b = closure.node_b();
    c.segment(first_[k], closure.size()) = closure.acceleration(
        frame(frames, a), frame(frames, b), {of(v, a), of(v, b)}, {of(v_dot, a), of(v_dot, b)});
  }
  return redundant() == 0 ? c : P_.transpose() * c;
}

template <int D>
geometry::Twist<D> LoopClosuresIn<D>::wrench_of(std::size_t k, const Frames& frames,
                                                const Conditions& lambda) const {
  const Closure& closure = closures_[k];
  if (slides_[k]) {
    TwistD wrench = TwistD::Zero();
    wrench.template head<D>() = slides_[k]->force_on_b(frames, lambda);
    return wrench;
  }
  return closure.wrench_on_b(frame(frames, closure.node_a()), frame(frames, closure.node_b()), lambda);
}

template <int D>
geometry::Twist<D> LoopClosuresIn<D>::indeterminacy(std::size_t k, const Frames& frames) const {
  TwistD most = TwistD::Zero();
  if (redundant() == 0) return most;
  const MatrixXd along = MatrixXd::Identity(conditions(), conditions()) - P_ * P_.transpose();
  for (int j = 0; j < conditions(); ++j) {
    const Conditions lambda = along.col(j).segment(first_[k], size_of(k));
    most = most.cwiseMax(wrench_of(k, frames, lambda).cwiseAbs());
  }
  return most;
}

template class LoopClosuresIn<2>;
template class LoopClosuresIn<3>;

}  // namespace flexarm::assembly
