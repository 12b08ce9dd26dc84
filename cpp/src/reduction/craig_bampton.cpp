#include "flexarm/reduction/craig_bampton.hpp"

#include <chrono>
#include <cmath>
#include <numbers>

#include "flexarm/eigen/block_lanczos.hpp"
#include "flexarm/errors.hpp"
#include "flexarm/reduction/guyan.hpp"

namespace flexarm::reduction {
namespace {

using Eigen::Index;
using eigen::LanczosModes;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using linear_solvers::LowerTriangle;
using std::numbers::pi;

double seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Tells the phases and takes their time.
class Phases {
 public:
  explicit Phases(const ReductionProgress& progress) : progress_(progress), begin_(seconds()) {}

  /// Ends the phase before, if any, and begins this one.
  void begin(const char* name, double& taken) {
    end();
    name_ = name;
    taken_ = &taken;
    start_ = seconds();
    tell(0);
  }
  void tell(double done) const {
    if (progress_) progress_(name_, done);
  }
  double end() {
    if (taken_ != nullptr) {
      *taken_ = seconds() - start_;
      tell(1);
    }
    taken_ = nullptr;
    return seconds() - begin_;
  }

 private:
  const ReductionProgress& progress_;
  double begin_, start_ = 0, *taken_ = nullptr;
  const char* name_ = "";
};

void check(const ReductionOptions& options) {
  if (options.modes < 0) {
    throw InvalidParameter("the number of modes must not be negative, got " + std::to_string(options.modes));
  }
  if (!(options.max_frequency >= 0) || !std::isfinite(options.max_frequency)) {
    throw InvalidParameter("the highest frequency must be positive, got " +
                           std::to_string(options.max_frequency) + " Hz");
  }
  if (options.modes > 0 && options.max_frequency > 0) {
    throw InvalidParameter(
        "modes are asked for by number or by highest frequency, got both: " + std::to_string(options.modes) +
        " and " + std::to_string(options.max_frequency) + " Hz");
  }
}

LanczosModes fixed_interface_modes(const FixedInterface& part, const LowerTriangle& M,
                                   const ReductionOptions& options, const Phases& phases, int& block) {
  eigen::LanczosOptions lanczos;
  lanczos.count = options.modes;
  lanczos.max_lambda = std::pow(2 * pi * options.max_frequency, 2);
  block = lanczos.block;
  return eigen::block_lanczos([&](const MatrixXd& F) { return part.solve(F); }, M, lanczos,
                              [&](double done) { phases.tell(done); });
}

/// Eq. (2) and (3); what is known exactly is written exactly.
void fill_matrices(const LowerTriangle& K, const LowerTriangle& M, const std::vector<Interface>& interfaces,
                   const Support& support, const MatrixXd& Psi, const LanczosModes& modes,
                   ReducedPart& reduced) {
  const Index n = Psi.cols(), m = modes.lambda.size();
  const InterfaceStiffness static_part = interface_stiffness(K, Psi, interfaces, support);
  reduced.quality.rigid_body_correction = static_part.correction;
  reduced.stiffness = MatrixXd::Zero(n + m, n + m);
  reduced.stiffness.topLeftCorner(n, n) = static_part.matrix;
  reduced.stiffness.diagonal().tail(m) = modes.lambda;
  const MatrixXd M_Psi = linear_solvers::multiply(M, Psi);
  const MatrixXd half = 0.5 * Psi.transpose() * M_Psi;
  reduced.mass = MatrixXd::Identity(n + m, n + m);
  reduced.mass.topLeftCorner(n, n) = half + half.transpose();
  reduced.mass.bottomLeftCorner(m, n) = modes.shapes.transpose() * M_Psi;
  reduced.mass.topRightCorner(n, m) = reduced.mass.bottomLeftCorner(m, n).transpose();
  MatrixXd R_t = MatrixXd::Zero(n + m, 3);
  R_t.topRows(n) = rigid_motion(interfaces, support.centre).leftCols<3>();
  reduced.inertia_load = reduced.mass * R_t;
  reduced.frequency_hz = modes.lambda.cwiseSqrt() / (2 * pi);
}

}  // namespace

ReducedPart reduce_part(const LowerTriangle& K, const LowerTriangle& M, const Coordinates& coordinates,
                        const std::vector<Interface>& interfaces, const ReductionOptions& options,
                        const ReductionProgress& progress) {
  ReducedPart reduced;
  ReductionStatistics& statistics = reduced.statistics;
  Phases phases(progress);
  phases.begin("check", statistics.seconds_check);
  check(options);
  const Support support = reduction::support(K, M, coordinates, interfaces);
  const InterfaceMaps maps = interface_maps(interfaces, coordinates);

  phases.begin("factor", statistics.seconds_factor);
  const FixedInterface part(K, coordinates, interfaces, maps, support);
  phases.begin("interfaces", statistics.seconds_interfaces);
  MatrixXd Psi = constraint_modes(K, part, coordinates, interfaces, maps, support);
  phases.begin("modes", statistics.seconds_modes);
  const LanczosModes modes = fixed_interface_modes(part, M, options, phases, statistics.lanczos_block);

  phases.begin("matrices", statistics.seconds_matrices);
  fill_matrices(K, M, interfaces, support, Psi, modes, reduced);
  reduced.recovery.resize(Psi.rows(), Psi.cols() + modes.shapes.cols());
  reduced.recovery << Psi, modes.shapes;
  Psi.resize(0, 0);

  phases.begin("quality", statistics.seconds_quality);
  ReductionQuality& quality = reduced.quality;
  quality.mode_residual = modes.residual;
  compute_mass_properties(M, coordinates, maps, support, modes.shapes, quality);
  phases.tell(0.5);
  estimate_errors(K, M, part, reduced.recovery, reduced.stiffness, reduced.mass, modes.next_lambda, quality);

  statistics.factor = part.report();
  statistics.n_freedoms = static_cast<int>(K.rows());
  statistics.n_inner = static_cast<int>(part.n_inner());
  statistics.unused_points = support.unused_points;
  statistics.lanczos_steps = modes.steps;
  statistics.seconds = phases.end();
  return reduced;
}

}  // namespace flexarm::reduction
