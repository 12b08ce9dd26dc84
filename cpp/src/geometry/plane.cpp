#include "flexarm/geometry/plane.hpp"

#include <cmath>

namespace flexarm::geometry {

PlaneAxes PlaneAxes::with_normal(const Vector3d& n, const Vector3d& towards) {
  PlaneAxes axes;
  axes.E.col(2) = n.normalized();
  axes.E.col(0) = (towards - axes.normal() * axes.normal().dot(towards)).normalized();
  axes.E.col(1) = axes.E.col(2).cross(axes.E.col(0));
  return axes;
}

Eigen::Matrix<double, 6, 3> PlaneAxes::within() const {
  Eigen::Matrix<double, 6, 3> P = Eigen::Matrix<double, 6, 3>::Zero();
  P.topLeftCorner<3, 2>() = E.leftCols<2>();
  P.bottomRightCorner<3, 1>() = E.col(2);
  return P;
}

Eigen::Matrix<double, 6, 3> PlaneAxes::across() const {
  Eigen::Matrix<double, 6, 3> Q = Eigen::Matrix<double, 6, 3>::Zero();
  Q.topLeftCorner<3, 1>() = E.col(2);
  Q.bottomRightCorner<3, 2>() = E.leftCols<2>();
  return Q;
}

FrameIn<2> in_plane(const Frame& H, const PlaneAxes& parent, const PlaneAxes& own) {
  const Matrix3d R = parent.E.transpose() * H.R * own.E;
  const double angle = std::atan2(R(1, 0) - R(0, 1), R(0, 0) + R(1, 1));  // the nearest rotation
  FrameIn<2> flat;
  flat.R << std::cos(angle), -std::sin(angle), std::sin(angle), std::cos(angle);
  flat.x = parent.part(H.x);
  return flat;
}

Frame in_space(const FrameIn<2>& H, double z, const PlaneAxes& parent, const PlaneAxes& own) {
  Matrix3d R = Matrix3d::Identity();
  R.topLeftCorner<2, 2>() = H.R;
  return {parent.E * R * own.E.transpose(), parent.embed(H.x) + z * parent.normal()};
}

double tilt(const Frame& H, const PlaneAxes& parent, const PlaneAxes& own) {
  return (H.R * own.normal() - parent.normal()).norm();
}

}  // namespace flexarm::geometry
