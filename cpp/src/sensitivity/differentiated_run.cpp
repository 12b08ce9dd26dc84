#include "flexarm/sensitivity/differentiated_run.hpp"

#include <cmath>
#include <memory>

#include "flexarm/errors.hpp"
#include "flexarm/sensitivity/derivative_recorder.hpp"
#include "flexarm/simulation/consistent_start.hpp"

namespace flexarm::sensitivity {
namespace {

using namespace simulation;

using assembly::PlanarSystem;
using integrators::HhtCoefficients;

/// A run and its derivatives in the plane, with the models of every parameter.
struct InPlane {
  std::unique_ptr<PlanarSystem> system;
  std::vector<std::unique_ptr<PlanarSystem>> models;  // plus and minus of each variation
};

/// Null if the arm, or the perturbed model of a parameter, leaves the plane or has other axes in it.
std::unique_ptr<InPlane> in_plane(const System& system, const Equilibrium& equilibrium,
                                  const std::vector<Variation>& variations, const TransientOptions& options) {
  if (options.dimension == Dimension::space) return nullptr;
  const auto of = [&](const System& model) {
    return PlanarSystem::about(model, equilibrium.state, equilibrium.loads);
  };
  auto found = std::make_unique<InPlane>();
  auto nominal = of(system);
  std::string obstacle = nominal.obstacle;
  found->system = std::move(nominal.system);
  for (const Variation& p : variations) {
    for (const auto* model : {p.plus, p.minus}) {
      if (!found->system) break;
      auto perturbed = of(static_cast<const System&>(*model));  // in space all systems are
      if (!perturbed.system || !perturbed.system->same_coordinates(*found->system)) {
        obstacle = "with a parameter a little changed it leaves it. " + perturbed.obstacle;
        found->system.reset();
        break;
      }
      if (p.drive_plus && perturbed.system->n_scalars() != system.n_scalars()) {
        obstacle = "its drives count coordinates of space";
        found->system.reset();
        break;
      }
      found->models.push_back(std::move(perturbed.system));
    }
  }
  if (found->system) return found;
  if (options.dimension == Dimension::plane) {
    throw InvalidParameter("the arm does not move in a plane: " + obstacle);
  }
  return nullptr;
}

/// The derivative of a state in the coordinates of the plane.
StateDerivative part(const PlanarSystem& plane, const State& state, const StateDerivative& derivative) {
  StateDerivative flat(plane, derivative.size());
  for (Eigen::Index k = 0; k < derivative.size(); ++k) {
    State column = state;  // twists and wrenches go over as velocities and multipliers do
    column.v = derivative.position.col(k);
    column.v_dot = derivative.v_dot.col(k);
    column.a = derivative.a.col(k);
    column.multipliers = derivative.multipliers.col(k);
    const auto projected = plane.part(column);
    flat.position.col(k) = projected.v;
    flat.v_dot.col(k) = projected.v_dot;
    flat.a.col(k) = projected.a;
    flat.multipliers.col(k) = projected.multipliers;
    column.v = derivative.velocity.col(k);
    flat.velocity.col(k) = plane.part(column).v;
  }
  flat.law_x = derivative.law_x;
  flat.law_z = derivative.law_z;
  return flat;
}

/// The observer of a run that carries its sensitivities along and records them.
template <int D>
RunObserverIn<D> observer(SensitivitiesIn<D>& sensitivities, DerivativeRecorderIn<D>& recorder) {
  using State = assembly::StateIn<D>;
  using Loads = assembly::LoadsIn<D>;
  return {[&](const State& before, const State& after, const VectorXd& exponent, double h,
              const Loads& loads) { sensitivities.follow(before, after, exponent, h, loads); },
          [&](Eigen::Index k, const State& state, const Loads& loads) {
            recorder.record(k, state, sensitivities.derivative(), loads);
          }};
}

}  // namespace

DifferentiatedRun simulate(const System& system, const Equilibrium& at_rest,
                           const std::vector<PiecewisePolynomial>& drives, const TransientOptions& options,
                           std::vector<Variation> variations, StateDerivative initial,
                           const Progress& progress) {
  DifferentiatedRun result;
  const Equilibrium equilibrium =
      consistent_start(system, at_rest, drives_of_joints<3>(system, at_rest.state, drives), options.start);
  initial = consistent_start(system, equilibrium, options.start, variations, std::move(initial));
  const Eigen::Index n = number_of_steps(system.joints().size(), drives, options) + 1;
  const auto coefficients = HhtCoefficients::from_alpha(options.alpha);
  if (const auto plane = in_plane(system, equilibrium, variations, options)) {
    std::vector<VariedInSpace<2>> varied;
    for (std::size_t k = 0; k < variations.size(); ++k) {
      const PlanarSystem &plus = *plane->models[2 * k], &minus = *plane->models[2 * k + 1];
      const Variation& p = variations[k];
      varied.push_back(
          {{&plus, &minus, p.up, p.down, p.drive_plus, p.drive_minus}, InSpace<2>(plus), InSpace<2>(minus)});
    }
    SensitivitiesIn<2> sensitivities(*plane->system, coefficients, variations_of(varied),
                                     part(*plane->system, equilibrium.state, initial));
    DerivativeRecorderIn<2> recorder(*plane->system, InSpace<2>(*plane->system), varied, options, n,
                                     result.derivatives);
    result.run = simulate_in_plane(*plane->system, equilibrium, drives, options, progress,
                                   observer(sensitivities, recorder));
  } else {
    std::vector<VariedInSpace<3>> varied;
    for (const Variation& p : variations) varied.push_back({p, {}, {}});
    SensitivitiesIn<3> sensitivities(system, coefficients, variations, std::move(initial));
    DerivativeRecorderIn<3> recorder(system, {}, varied, options, n, result.derivatives);
    result.run =
        simulate_in_space(system, equilibrium, drives, options, progress, observer(sensitivities, recorder));
  }
  result.derivatives.finish(result.run.time.size());
  return result;
}

}  // namespace flexarm::sensitivity
