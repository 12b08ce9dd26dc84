/// What the two models of each variation do not share: found once, before partial_residuals.cpp evaluates it
/// in every step.
#include "flexarm/sensitivity/partial_residuals.hpp"

namespace flexarm::sensitivity {

using namespace geometry;
using namespace simulation;

template <int D>
PartialResidualsIn<D>::PartialResidualsIn(const SystemD& system,
                                          const std::vector<VariationIn<D>>& variations)
    : system_(system), variations_(variations) {
  const VectorXd zero = VectorXd::Zero(system.n_scalars());
  up_ = down_ = {zero, zero, zero, zero};
  torques_.setZero(system.n_scalars(), static_cast<Eigen::Index>(variations.size()));
  find_strained();
  find_massive();
  for (std::size_t p = 0; p < variations.size(); ++p) {
    find_others(variations[p], static_cast<Eigen::Index>(p));
    if (variations[p].drive_plus) driven_.push_back(static_cast<Eigen::Index>(p));
  }
}

template <int D>
void PartialResidualsIn<D>::find_strained() {
  for (std::size_t k = 0; k < system_.beams().size(); ++k) {
    Strained group{k, {}, {}, false, {}};
    for (std::size_t p = 0; p < variations_.size(); ++p) {
      const Beam &plus = variations_[p].plus->beams()[k], &minus = variations_[p].minus->beams()[k];
      if (plus.same_strength(minus)) continue;
      group.columns.push_back(static_cast<Eigen::Index>(p));
      group.models.emplace_back(&plus, &minus);
      group.grows = group.grows || plus.grows() || minus.grows();
    }
    if (group.columns.empty()) continue;
    const auto m = static_cast<Eigen::Index>(group.columns.size());
    StressSlopes& slopes = group.slopes;
    for (Slopes* rows : {&slopes.by_strain, &slopes.by_rate, &slopes.at_rest}) {
      rows->setZero(n, filled_up(group.columns.size()));
    }
    for (Eigen::Index j = 0; j < m; ++j) {
      const auto [plus, minus] = group.models[j];
      const double spread = variations_[group.columns[j]].spread();
      slopes.by_strain.col(j) = (plus->stiffness() - minus->stiffness()) / spread;
      slopes.by_rate.col(j) =
          (plus->damping_time() * plus->stiffness() - minus->damping_time() * minus->stiffness()) / spread;
    }
    rest(group, 0);
    strained_.push_back(std::move(group));
  }
}

template <int D>
void PartialResidualsIn<D>::find_massive() {
  for (std::size_t k = 0; k < system_.beams().size(); ++k) {
    Massive group{k, {}, {}};
    std::vector<elements::TwoTwistsMatrix<D>> slopes;
    elements::TwoTwistsMatrix<D> any = elements::TwoTwistsMatrix<D>::Zero();
    for (std::size_t p = 0; p < variations_.size(); ++p) {
      const VariationIn<D>& one = variations_[p];
      slopes.push_back((one.plus->beams()[k].mass() - one.minus->beams()[k].mass()) / one.spread());
      if (slopes.back().isZero(0)) {
        slopes.pop_back();
        continue;
      }
      any += slopes.back().cwiseAbs();
      group.columns.push_back(static_cast<Eigen::Index>(p));
    }
    for (int i = 0; i < 2 * n; ++i)
      for (int j = 0; j < 2 * n; ++j)
        if (any(i, j) > 0) group.slopes.entries.push_back({i, j});
    const auto& entries = group.slopes.entries;
    if (entries.empty()) continue;
    Slopes& mass = group.slopes.mass;
    mass.setZero(static_cast<Eigen::Index>(entries.size()), filled_up(slopes.size()));
    for (std::size_t e = 0; e < entries.size(); ++e)
      for (std::size_t j = 0; j < slopes.size(); ++j)
        mass(static_cast<Eigen::Index>(e), static_cast<Eigen::Index>(j)) =
            slopes[j](entries[e].row, entries[e].column);
    massive_.push_back(std::move(group));
  }
}

template <int D>
void PartialResidualsIn<D>::find_others(const VariationIn<D>& p, Eigen::Index column) {
  const double per_spread = 1 / p.spread();
  const auto pairs = [&](const auto& plus, const auto& minus, auto& found) {
    for (std::size_t k = 0; k < plus.size(); ++k) {
      if (!(plus[k] == minus[k])) found.push_back({k, column, &plus[k], &minus[k]});
    }
  };
  pairs(p.plus->constraints(), p.minus->constraints(), joints_);
  pairs(p.plus->gears(), p.minus->gears(), gears_);
  pairs(p.plus->superelements(), p.minus->superelements(), parts_);
  bool same = true;
  for (std::size_t k = 0; k < p.plus->closures().size(); ++k)
    same = same && p.plus->closures()[k] == p.minus->closures()[k];
  if (!same) looped_.push_back(column);
  for (std::size_t k = 0; k < system_.bodies().size(); ++k) {
    const auto &plus = p.plus->bodies()[k], &minus = p.minus->bodies()[k];
    if (plus == minus) continue;
    const TwistMatrix<D> slope = per_spread * (plus.mass() - minus.mass());
    bodies_.push_back({k, column, elements::RigidBodyIn<D>(plus.node(), slope)});
  }
  for (std::size_t k = 0; k < system_.weights().size(); ++k) {
    const auto &plus = p.plus->weights()[k], &minus = p.minus->weights()[k];
    if (plus == minus) continue;
    weights_.push_back(
        {k, column, {per_spread * (plus.mass - minus.mass), per_spread * (plus.moment - minus.moment)}});
  }
  for (int k = 0; k < system_.n_scalars(); ++k) {
    const double slope = per_spread * (p.plus->scalar_inertia()[k] - p.minus->scalar_inertia()[k]);
    if (slope != 0 && system_.is_free(k)) rotors_.push_back({static_cast<std::size_t>(k), column, slope});
  }
}

template PartialResidualsIn<2>::PartialResidualsIn(const SystemD&, const std::vector<VariationIn<2>>&);
template PartialResidualsIn<3>::PartialResidualsIn(const SystemD&, const std::vector<VariationIn<3>>&);

}  // namespace flexarm::sensitivity
