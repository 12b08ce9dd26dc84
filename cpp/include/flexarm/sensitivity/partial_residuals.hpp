/// @file
/// What parameters do to the equations of motion (r, Φ) = 0 of assembly/equations.hpp directly: ∂(r, Φ)/∂p at
/// fixed free coordinates, for all parameters at once.
///
/// Only what the two models of a variation do not share is evaluated. The stress of a beam in its strain e
/// and its rate e', and the inertia forces of beams and bodies, are linear in what differs,
///
///     ∂σ/∂p = ∂K/∂p e + ∂(η K)/∂p e' − ∂(K d₀)/∂p − ∂(η K b')/∂p                                    (1)
///     ∂f/∂p = ∂M/∂p v' − ad(v)ᵀ ∂M/∂p v                                                             (2)
///
/// with differences of the models' K, M, ... made once; σ goes to the nodes as in elements/beam.hpp, by
/// beam_slopes.hpp. Weights and rotor inertias alike. Joints, gears, closures and super-elements that differ
/// are evaluated in both models at the state, and so are loads of tables (assembly/state_loads.hpp). Laws:
/// law_slopes.hpp. Prescribed coordinates and motor torques
/// that depend on p come in with the tangents of what they touch.
#pragma once

#include <utility>
#include <vector>

#include "flexarm/sensitivity/beam_slopes.hpp"
#include "flexarm/sensitivity/law_slopes.hpp"

namespace flexarm::sensitivity {

using simulation::Slopes;
using simulation::StateDerivative;
using simulation::VariationIn;

template <int D>
class PartialResidualsIn {
 public:
  using SystemD = assembly::SystemIn<D>;
  using StateD = assembly::StateIn<D>;
  using LoadsD = assembly::LoadsIn<D>;

  PartialResidualsIn(const SystemD& system, const std::vector<VariationIn<D>>& variations);

  /// Writes the prescribed rows of the derivative at time t, and what motor torques do then.
  void prescribe(double t, StateDerivative& derivative);

  /// rhs := −∂(r, Φ)/∂p, n_unknowns() rows. Memories of laws move with `derivative`, prescribed coordinates
  /// as prescribe() has left them; `laws` have been evaluated at the state.
  void evaluate(const StateD& state, const StateDerivative& derivative, const LoadsD& loads,
                const LawSlopesIn<D>& laws, Slopes& rhs);

 private:
  static constexpr int n = geometry::freedoms<D>;
  using Beam = elements::BeamElementIn<D>;
  using Columns = std::vector<Eigen::Index>;

  /// A beam whose stress depends on parameters; one column of slopes for each of `columns`.
  struct Strained {
    std::size_t beam;
    Columns columns;
    std::vector<std::pair<const Beam*, const Beam*>> models;
    bool grows = false;
    StressSlopes slopes;
  };
  /// A beam whose mass depends on parameters.
  struct Massive {
    std::size_t beam;
    Columns columns;
    MassSlopes slopes;
  };
  /// Something of which a parameter has two versions, or of which one object is the derivative.
  template <class T>
  struct Both {
    std::size_t index;
    Eigen::Index column;
    const T *plus, *minus;
  };
  template <class T>
  struct Slope {
    std::size_t index;
    Eigen::Index column;
    T value;
  };

  void find_strained();
  void find_massive();
  void find_others(const VariationIn<D>& variation, Eigen::Index column);
  void rest(Strained& group, double t) const;
  void take(const Beam& beam, const Columns& columns, Slopes& rhs) const;

  void stresses(const StateD& state, Slopes& rhs);
  void inertia(const StateD& state, Slopes& rhs);
  void weights(const StateD& state, const LoadsD& loads, Slopes& rhs) const;
  void state_loads(const StateD& state, const StateDerivative& derivative, Slopes& rhs) const;
  void joints(const StateD& state, Slopes& rhs) const;
  void closures(const StateD& state, Slopes& rhs) const;
  void parts(const StateD& state, const LoadsD& loads, Slopes& rhs);
  void force_laws(const StateDerivative& derivative, const LawSlopesIn<D>& laws, Slopes& rhs) const;
  void driven(const StateD& state, const StateDerivative& derivative, const LawSlopesIn<D>& laws,
              Slopes& rhs) const;

  const SystemD& system_;
  const std::vector<VariationIn<D>>& variations_;
  std::vector<Strained> strained_;
  std::vector<Massive> massive_;
  std::vector<Slope<elements::RigidBodyIn<D>>> bodies_;
  std::vector<Slope<elements::WeightIn<D>>> weights_;
  std::vector<Slope<double>> rotors_;
  std::vector<Both<joints::JointConstraintIn<D>>> joints_;
  std::vector<Both<joints::GearConstraint>> gears_;
  std::vector<Both<elements::SuperElementIn<D>>> parts_;
  Columns driven_;  // parameters on which the drives depend
  Columns looped_;  // and closures
  integrators::DriveValues up_, down_;
  Slopes torques_;  // derivatives of motor torques, one row a scalar coordinate
  Slopes forces_;   // of one beam in its nodes
};

}  // namespace flexarm::sensitivity
