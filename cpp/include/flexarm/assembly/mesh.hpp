/// @file
/// Links become nodes and elements. A rigid link is one node at its frame. A beam gets nodes at equal
/// distances, of which those nearest to a payload move to where it sits, so that every concentrated mass has
/// its own node. A super-element has a node at each interface.
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
  std::vector<Frame> interfaces;  ///< of a super-element, in the link's frame; nodes have the link's axes

  int n_nodes() const { return static_cast<int>(interfaces.empty() ? stations.size() : interfaces.size()); }
  bool is_beam() const { return stations.size() > 1; }
  double length() const { return stations.back(); }

  /// Frame of a node where the link stands at H_link and does not bend.
  Frame node_frame(const Frame& H_link, int k) const {
    if (!interfaces.empty()) return H_link * Frame::translation(interfaces[k].x);
    return H_link * Frame{R_LS, R_LS.col(0) * stations[k]};
  }
  /// The link's axes at a node, or the interface's, seen from that node: what joints and payloads meet.
  Frame place_axes(int k) const {
    return Frame::rotation(interfaces.empty() ? Matrix3d(R_LS.transpose()) : interfaces[k].R);
  }
  /// That place in the undeformed link's frame.
  Frame place_in_link(int k) const { return node_frame(Frame{}, k) * place_axes(k); }
};

/// Axes of a section: x along `end`, z the part of `up` normal to it (any normal if `up` is zero).
/// @throws InvalidParameter if `up` runs along the beam.
Matrix3d section_axes(const Vector3d& end, const Vector3d& up);

/// Distances of the nodes of a beam of `elements` elements with masses at `occupied` distances from its
/// origin. A mass within 1e-3 of the length from an end, or from another mass, is carried by the node there.
std::vector<double> beam_stations(double length, int elements, std::vector<double> occupied);

/// What a joint, a payload or a point names: a link, its far end, or an interface of a super-element.
struct Place {
  int link;
  int node;  ///< number within the link
};

/// A position fixed to a link: on one node, or within an element.
template <int D>
struct AttachmentIn {
  int node = 0;                 ///< the node, or the element's first node
  int element = -1;             ///< −1: on the node
  double xi = 0;                ///< place in the element, 0 to 1
  geometry::FrameIn<D> offset;  ///< from the node's (or the section's) frame to the place, in link axes there

  bool operator==(const AttachmentIn&) const = default;
};

using Attachment = AttachmentIn<3>;

/// @param on_node put it rigidly on the nearest node (masses) instead of within an element (sensors).
/// @param interface of a super-element, from whose frame `position` counts.
Attachment attach(const LinkMesh& mesh, const Vector3d& position, bool on_node, int interface = 0);

}  // namespace flexarm::assembly
