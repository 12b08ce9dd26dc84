#include "flexarm/simulation/law_slopes.hpp"

namespace flexarm::simulation {

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
  const auto rates = state.v.tail(system_.n_scalars());
  const auto takes_part = [&](const joints::JointLaw& law) { return friction || joints::acts_at_rest(law); };
  for (std::size_t k = 0; k < responses_.size(); ++k) {
    const assembly::PlacedLaw& law = system_.laws()[k];
    responses_[k] = takes_part(law.law) ? joints::respond(law.law, system_.deflection(law, state.s),
                                                          system_.deflection(law, rates), state.laws[k])
                                        : joints::LawResponse{};
  }
  for (const Varied& one : varied_) {
    const assembly::PlacedLaw& law = system_.laws()[one.law];
    if (!takes_part(law.law)) continue;
    const double x = system_.deflection(law, state.s), x_dot = system_.deflection(law, rates);
    const auto up = joints::respond(one.plus, x, x_dot, state.laws[one.law]);
    const auto down = joints::respond(one.minus, x, x_dot, state.laws[one.law]);
    force_(one.law, one.parameter) = (up.force - down.force) / one.spread;
    z_(one.law, one.parameter) = (up.z - down.z) / one.spread;
  }
}

template class LawSlopesIn<2>;
template class LawSlopesIn<3>;

}  // namespace flexarm::simulation
