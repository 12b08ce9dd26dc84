#include "flexarm/sensitivity/law_slopes.hpp"

namespace flexarm::sensitivity {

using namespace simulation;

template <int D>
LawSlopesIn<D>::LawSlopesIn(const assembly::SystemIn<D>& system,
                            const std::vector<VariationIn<D>>& variations)
    : system_(system), responses_(system.laws().size()) {
  const auto n_laws = static_cast<Eigen::Index>(system.laws().size());
  const auto n_parameters = static_cast<Eigen::Index>(variations.size());
  force_.setZero(n_laws, n_parameters);
  z_.setZero(n_laws, n_parameters);
  for (Eigen::Index p = 0; p < n_parameters; ++p) {
    const VariationIn<D>& one = variations[p];
    for (Eigen::Index k = 0; k < n_laws; ++k) {
      const joints::JointLaw &plus = one.plus->laws()[k].law, &minus = one.minus->laws()[k].law;
      if (!(plus == minus)) varied_.push_back({k, p, plus, minus, one.spread()});
    }
  }
}

template <int D>
void LawSlopesIn<D>::evaluate(const assembly::StateIn<D>& state, bool friction) {
  const auto takes_part = [&](const joints::JointLaw& law) { return friction || joints::acts_at_rest(law); };
  for (std::size_t k = 0; k < responses_.size(); ++k) {
    responses_[k] = takes_part(system_.laws()[k].law) ? system_.respond(k, state) : joints::LawResponse{};
  }
  for (const Varied& one : varied_) {
    const auto k = static_cast<std::size_t>(one.law);
    if (!takes_part(system_.laws()[k].law)) continue;
    const auto up = system_.respond(k, state, one.plus), down = system_.respond(k, state, one.minus);
    force_(one.law, one.parameter) = (up.force - down.force) / one.spread;
    z_(one.law, one.parameter) = (up.z - down.z) / one.spread;
  }
}

template class LawSlopesIn<2>;
template class LawSlopesIn<3>;

}  // namespace flexarm::sensitivity
