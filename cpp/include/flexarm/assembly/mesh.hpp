/// @file
/// Links become nodes and elements. A rigid link is one node at its frame. A beam gets nodes at equal
/// distances, of which those nearest to a payload move to where it sits, so that every concentrated mass has
/// its own node.
#pragma once

#include <vector>

#include "flexarm/elements/beam.hpp"
#include "flexarm/model/arm.hpp"

namespace flexarm::assembly {

using geometry::Frame;
using geometry::Matrix3d;
using geometry::Vector3d;

/// Where the nodes of one link are.
struct LinkMesh {
  int first_node = 0;
  std::vector<double> stations = {0.0};  ///< distance of each node from the link's origin [m]
  Matrix3d R_LS = Matrix3d::Identity();  ///< section axes to link axes
  int first_element = 0;

  int n_nodes() const { return static_cast<int>(stations.size()); }
  int last_node() const { return first_node + n_nodes() - 1; }
  bool is_beam() const { return n_nodes() > 1; }
  double length() const { return stations.back(); }

  /// Frame of a node where the link stands at H_link and does not bend.
  Frame node_frame(const Frame& H_link, int k) const {
    return H_link * Frame{R_LS, R_LS.col(0) * stations[k]};
  }
  /// The link's axes at a node, seen from that node.
  Frame link_axes() const { return Frame::rotation(R_LS.transpose()); }
};

/// Axes of a section: x along `end`, z the part of `up` normal to it (any normal if `up` is zero).
/// @throws InvalidParameter if `up` runs along the beam.
Matrix3d section_axes(const Vector3d& end, const Vector3d& up);

/// Distances of the nodes of a beam of `elements` elements with masses at `occupied` distances from its
/// origin. A mass within 1e-3 of the length from an end, or from another mass, is carried by the node there.
std::vector<double> beam_stations(double length, int elements, std::vector<double> occupied);

/// A position fixed to a link: on one node, or within an element.
struct Attachment {
  int node = 0;      ///< the node, or the element's first node
  int element = -1;  ///< −1: on the node
  double xi = 0;     ///< place in the element, 0 to 1
  Frame offset;      ///< from the node's (or the section's) frame to the place, in link axes there
};

/// @param on_node put it rigidly on the nearest node (masses) instead of within an element (sensors).
Attachment attach(const LinkMesh& mesh, const Vector3d& position, bool on_node);

}  // namespace flexarm::assembly
