/// @file
/// A part reduced to its interfaces and the modes it has while they are held (Craig and Bampton):
///
///     u = Ψ q + Φ η,   K Φ = M Φ Λ with q = 0,   Φᵀ M Φ = 1                                          (1)
///     K̂ = [ΨᵀKΨ  0; 0  Λ],   M̂ = [ΨᵀMΨ  ΨᵀMΦ; ΦᵀMΨ  1]                                              (2)
///     b̂ = M̂ R̂_t                 generalised force of a unit acceleration of the frame               (3)
///
/// Ψ of guyan.hpp, Φ by block Lanczos with the same factor of K_ii. No modes: Guyan. Freedoms: three
/// translations and three rotations about the part's axes an interface, then η [m √kg]. Units: SI. Source:
/// [Craig1968].
#pragma once

#include <functional>
#include <string>

#include "flexarm/reduction/quality.hpp"

namespace flexarm::reduction {

struct ReductionOptions {
  int modes = 0;             ///< fixed-interface modes kept; fewer if the part has fewer
  double max_frequency = 0;  ///< instead: all up to this one [Hz]
};

/// How the numbers came about.
struct ReductionStatistics {
  linear_solvers::CholeskyReport factor;
  int n_freedoms = 0, n_inner = 0, unused_points = 0;
  int lanczos_steps = 0, lanczos_block = 0;
  double seconds_check = 0, seconds_factor = 0, seconds_interfaces = 0, seconds_modes = 0,
         seconds_matrices = 0, seconds_quality = 0, seconds = 0;
};

struct ReducedPart {
  Eigen::MatrixXd stiffness, mass;  ///< K̂, M̂
  Eigen::MatrixXd inertia_load;     ///< (dof, 3) b̂, acceleration along x, y, z
  Eigen::VectorXd frequency_hz;     ///< of Φ
  Eigen::MatrixXd recovery;         ///< T = [Ψ Φ]: displacement of every freedom of the part
  ReductionQuality quality;
  ReductionStatistics statistics;
};

/// Hears the phase ("check", "factor", "interfaces", "modes", "matrices", "quality") and the part of it that
/// is done; may throw to end the work.
using ReductionProgress = std::function<void(const char* phase, double done)>;

/// @param K, M  of the free part: three freedoms a point
/// @throws InvalidParameter, NotConverged
ReducedPart reduce_part(const linear_solvers::LowerTriangle& K, const linear_solvers::LowerTriangle& M,
                        const Coordinates& coordinates, const std::vector<Interface>& interfaces,
                        const ReductionOptions& options, const ReductionProgress& progress = nullptr);

}  // namespace flexarm::reduction
