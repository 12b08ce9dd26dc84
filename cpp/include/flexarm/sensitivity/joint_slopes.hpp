/// @file
/// Derivatives of what is recorded of joints: angles, rates and torques.
///
/// The motor's torque is the row of φ in the equations of motion (assembly/equations.hpp), the joint's torque
/// −ξᵀ λ. Both are sums of few terms whose derivatives by states and parameters are known:
///
///     dT_φ = J dφ'' + ∂J/∂p φ'' ± dQ − ξᵀ dλ − ∂ξ/∂pᵀ λ + d(ψ' λ)                                    (1)
///
/// with the laws' dQ of law_slopes.hpp; terms of joints and gears stand there if φ is their coordinate.
#pragma once

#include <vector>

#include "flexarm/sensitivity/law_slopes.hpp"
#include "flexarm/simulation/transient.hpp"

namespace flexarm::sensitivity {

using simulation::Slopes;
using simulation::StateDerivative;
using simulation::Transient;
using simulation::VariationIn;

template <int D>
class JointSlopesIn {
 public:
  JointSlopesIn(const assembly::SystemIn<D>& system, const std::vector<VariationIn<D>>& variations);

  /// Writes column k of `out`: for each joint one row of all parameters.
  void record(Eigen::Index k, const assembly::StateIn<D>& state, const StateDerivative& derivative,
              Transient& out);

 private:
  using RowsOfColumn = Eigen::Map<Slopes>;
  struct Turned {  ///< a joint whose twist depends on a parameter
    std::size_t joint;
    Eigen::Index column;
    geometry::Twist<D> slope;
  };
  struct Rotor {
    int scalar;
    Eigen::Index column;
    double slope;
  };
  struct Geared {
    std::size_t gear;
    Eigen::Index column;
    const joints::Transmission *plus, *minus;
    double spread;
  };

  void torque_about(std::size_t joint, const assembly::StateIn<D>& state, const StateDerivative& derivative);
  void add_laws(int scalar, const StateDerivative& derivative);
  void add_gears(int scalar, const assembly::StateIn<D>& state, const StateDerivative& derivative);

  const assembly::SystemIn<D>& system_;
  LawSlopesIn<D> laws_;
  std::vector<Turned> turned_;
  std::vector<Rotor> rotors_;
  std::vector<Geared> geared_;
  Eigen::RowVectorXd torque_, motor_;
};

}  // namespace flexarm::sensitivity
