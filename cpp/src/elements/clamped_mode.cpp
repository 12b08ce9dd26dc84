#include "flexarm/elements/clamped_mode.hpp"

#include <Eigen/SparseCholesky>
#include <cmath>
#include <vector>

namespace flexarm::elements {

double first_clamped_frequency(std::span<const BeamElement> chain) {
  const int n = 6 * static_cast<int>(chain.size());
  std::vector<Eigen::Triplet<double>> k_entries, m_entries;
  Frame H1;
  for (std::size_t e = 0; e < chain.size(); ++e) {
    const Frame H2 = H1 * Frame::translation(Vector6d::Unit(0).head<3>() * chain[e].length());
    const Matrix12d K = chain[e].stiffness_matrix(H1, H2);
    const Matrix12d& M = chain[e].mass();
    const int first = 6 * static_cast<int>(e) - 6;  // row of node 1; the clamped node has none
    for (int i = 0; i < 12; ++i) {
      for (int j = 0; j < 12; ++j) {
        if (first + i < 0 || first + j < 0) continue;
        k_entries.emplace_back(first + i, first + j, K(i, j));
        m_entries.emplace_back(first + i, first + j, M(i, j));
      }
    }
    H1 = H2;
  }
  Eigen::SparseMatrix<double> K(n, n), M(n, n);
  K.setFromTriplets(k_entries.begin(), k_entries.end());
  M.setFromTriplets(m_entries.begin(), m_entries.end());

  // Inverse iteration: the second mode lies so far above the first that each turn gains three digits in ω².
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(K);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(n);
  x[n - 5] = x[n - 4] = 1;
  double omega_squared = 0;
  for (int turn = 0; turn < 50; ++turn) {
    x = factor.solve(M * x);
    const double next = x.dot(K * x) / x.dot(M * x);
    x.normalize();
    if (std::abs(next - omega_squared) < 1e-12 * next) return std::sqrt(next);
    omega_squared = next;
  }
  return std::sqrt(omega_squared);
}

}  // namespace flexarm::elements
