#include "parts.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

namespace flexarm::tests {

Structure star_of_beams(const std::vector<Vector3d>& ends, int elements, const model::BeamLink& like) {
  Structure part;
  part.nodes = ends;
  part.nodes.emplace_back(Vector3d::Zero());
  const int centre = static_cast<int>(ends.size());
  const int n = 6 * (centre + 1 + static_cast<int>(ends.size()) * (elements - 1));
  part.K = part.M = MatrixXd::Zero(n, n);
  for (int arm = 0; arm < centre; ++arm) {
    const Matrix3d R = assembly::section_axes(ends[arm], {0.3, 0.2, 1});
    int before = centre;
    for (int e = 0; e < elements; ++e) {
      const int after = e + 1 == elements ? arm : static_cast<int>(part.nodes.size());
      if (after != arm) part.nodes.emplace_back(ends[arm] * (e + 1.0) / elements);
      const Frame H1{R, part.nodes[before]}, H2{R, part.nodes[after]};
      const elements::BeamElement beam(before, after, H1, H2, elements::BeamProperties::from(like));
      Eigen::Matrix<double, 12, 12> to_section = Eigen::Matrix<double, 12, 12>::Zero();
      for (int k = 0; k < 4; ++k) to_section.block<3, 3>(3 * k, 3 * k) = R.transpose();
      const MatrixXd K = to_section.transpose() * beam.stiffness_matrix(H1, H2) * to_section;
      const MatrixXd M = to_section.transpose() * beam.mass() * to_section;
      const int at[] = {6 * before, 6 * after};
      for (int i = 0; i < 2; ++i)
        for (int j = 0; j < 2; ++j) {
          part.K.block<6, 6>(at[i], at[j]) += K.block<6, 6>(6 * i, 6 * j);
          part.M.block<6, 6>(at[i], at[j]) += M.block<6, 6>(6 * i, 6 * j);
        }
      before = after;
    }
  }
  return part;
}

model::SuperElementLink craig_bampton(const std::string& name, const Structure& full, int interfaces,
                                      int n_modes) {
  const int b = 6 * interfaces, n = static_cast<int>(full.K.rows()), i = n - b;
  MatrixXd T = MatrixXd::Zero(n, b + n_modes);
  T.topLeftCorner(b, b).setIdentity();
  T.bottomLeftCorner(i, b) = -full.K.bottomRightCorner(i, i).ldlt().solve(full.K.bottomLeftCorner(i, b));
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> modes(full.K.bottomRightCorner(i, i),
                                                                 full.M.bottomRightCorner(i, i));
  T.bottomRightCorner(i, n_modes) = modes.eigenvectors().leftCols(n_modes);
  model::SuperElementLink part{
      .name = name, .stiffness = T.transpose() * full.K * T, .mass = T.transpose() * full.M * T};
  for (int k = 0; k < interfaces; ++k) {
    part.interfaces.push_back(std::string("i").append(std::to_string(k + 1)));
    part.frames.push_back(Frame::translation(full.nodes[k]));
  }
  return part;
}

model::SuperElementLink reduced_beam(const model::BeamLink& beam, int elements, int n_modes) {
  model::BeamLink half = beam;
  Structure part = star_of_beams({-0.5 * beam.end, 0.5 * beam.end}, elements / 2, half);
  for (Vector3d& node : part.nodes) node += 0.5 * beam.end;
  return craig_bampton(beam.name, part, 2, n_modes);
}

model::SuperElementLink tripod() {
  const auto like = thin_beam("leg", {1, 0, 0}, 1);
  model::SuperElementLink part = craig_bampton(
      "tripod", star_of_beams({{0.5, 0.1, 0}, {-0.2, 0.4, 0.1}, {0, -0.1, 0.6}}, 3, like), 3, 2);
  part.frames[1].R = geometry::exp3({0.3, -0.2, 2.9});
  part.damping = 1e-3 * part.stiffness;
  return part;
}

model::Arm tripod_arm() {
  model::Arm arm;
  arm.name = "tripod";
  arm.links = {thin_beam("column", {0.1, 0.2, 0.9}, 2), tripod(),
               model::RigidLink{"hand", 1.0, {0.05, 0.02, 0.1}, Vector3d(0.02, 0.03, 0.04).asDiagonal()},
               thin_beam("boom", {0.5, 0.1, -0.1}, 2)};
  model::Joint turn{.name = "turn", .child = "column", .axis = Vector3d(0.1, 0.2, 1)};
  turn.drive_train = compliant(3000, 2);
  model::Joint flange{.name = "flange", .type = JointType::fixed, .parent = "column", .child = "tripod:i1"};
  flange.at_end = true;
  flange.origin = geometry::exp6((Vector6d() << 0, 0.05, 0.02, 0.4, 0.1, -0.2).finished());
  model::Joint wrist{.name = "wrist", .parent = "tripod:i2", .child = "hand", .axis = Vector3d(0, 1, 0.1)};
  wrist.drive_train.rotor_inertia = 0.05;
  model::Joint mount{.name = "mount", .type = JointType::fixed, .parent = "tripod:i3", .child = "boom"};
  mount.origin = Frame::translation({0.1, 0.05, 0.1});
  arm.joints = {turn, flange, wrist, mount};
  arm.payloads = {{.name = "tool", .link = "tripod:i2", .position = {0.1, 0.1, 0}, .mass = 1.2},
                  {.name = "load", .link = "boom", .position = {0.5, 0.1, -0.1}, .mass = 0.8}};
  arm.points = {{.name = "tip", .link = "boom", .position = {0.5, 0.1, -0.1}, .loaded = true},
                {.name = "leg", .link = "tripod:i2", .position = {0.05, 0, 0.1}, .loaded = true}};
  return arm;
}

}  // namespace flexarm::tests
