#include "flexarm/lanes/arm_numbers.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "flexarm/integrators/hht_coefficients.hpp"
#include "flexarm/integrators/woodbury_update.hpp"
#include "flexarm/linear_solvers/cached_factorisation.hpp"

namespace flexarm::lanes {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

template <int D>
int put_frame(Rows& rows, int row, int lane, const geometry::FrameIn<D>& H) {
  return rows.put(rows.put(row, lane, H.R), lane, H.x);
}

int put_blocks(Rows& rows, int row, int lane, const linear_solvers::PackedMatrix& A, int first, int count) {
  return rows.put_blocks(row, lane, A, first, count, static_cast<int>(A.cols()));
}

int count(const auto& things) { return static_cast<int>(things.size()); }

}  // namespace

bool has_three_numbers(const assembly::PlacedLaw& law) { return law.of < 0 && joints::is_linear(law.law); }

template <int D>
bool suits(const SystemIn<D>& arm, const LoadsIn<D>& loads, bool consistent) {
  const bool others = !arm.closures().empty() || !arm.superelements().empty() || !loads.points.empty() ||
                      arm.has_state_loads();
  if (others) return false;
  const auto winds = [](const auto& gear) { return !gear.transmission.windup.empty(); };
  const auto is_ball = [](const auto& joint) { return joint.type() == joints::JointType::spherical; };
  if (std::ranges::any_of(arm.gears(), winds) || std::ranges::any_of(arm.constraints(), is_ball))
    return false;
  const integrators::RigidJointCondensationIn<D> condensation(arm, true);
  if (condensation.n_unknowns() > linear_solvers::CachedFactorisation::largest_inverse) return false;
  return !consistent || integrators::WoodburyUpdateIn<D>(arm, condensation, false, arm.constraints().size())
                            .follows_constraints();
}

template <int D>
bool same_structure(const SystemIn<D>& one, const SystemIn<D>& other) {
  const auto alike = [](const auto& a, const auto& b, auto same) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(), same);
  };
  return one.n_nodes() == other.n_nodes() && one.n_free() == other.n_free() &&
         one.n_velocities() == other.n_velocities() && one.drives() == other.drives() &&
         alike(
             one.beams(), other.beams(),
             [](const auto& a, const auto& b) { return a.node1() == b.node1() && a.node2() == b.node2(); }) &&
         alike(one.bodies(), other.bodies(),
               [](const auto& a, const auto& b) { return a.node() == b.node(); }) &&
         alike(one.constraints(), other.constraints(),
               [](const auto& a, const auto& b) {
                 return a.type() == b.type() && a.node_a() == b.node_a() && a.node_b() == b.node_b() &&
                        a.coordinate() == b.coordinate();
               }) &&
         alike(one.gears(), other.gears(),
               [](const auto& a, const auto& b) { return a.input == b.input && a.output == b.output; }) &&
         alike(one.laws(), other.laws(),
               [](const auto& a, const auto& b) {
                 return a.plus == b.plus && a.minus == b.minus &&
                        has_three_numbers(a) == has_three_numbers(b);
               }) &&
         alike(one.joints(), other.joints(),
               [](const auto& a, const auto& b) { return a.theta == b.theta && a.phi == b.phi; }) &&
         one.points().size() == other.points().size();
}

template <int D>
ArmNumbersIn<D>::ArmNumbersIn(const std::vector<const SystemIn<D>*>& arms,
                              const std::vector<LoadsIn<D>>& loads, int lanes)
    : lanes_(lanes) {
  for (const SystemIn<D>* arm : arms)
    condensation_.push_back(std::make_unique<integrators::RigidJointCondensationIn<D>>(*arm, true));
  place_points(arms);
  for (const SystemIn<D>* arm : arms) {
    for (const auto& beam : arm->beams()) arms_.damped = arms_.damped || beam.damping_time() > 0;
  }
  lay_out(*arms.front());
  unknowns_.resize(static_cast<std::size_t>(arms_.n_reduced));
  for (int k = 0; k < arms.front()->n_unknowns(); ++k) {
    const int row = condensation_.front()->row(k);
    if (row >= 0) unknowns_[static_cast<std::size_t>(row)] = k;
  }
  std::vector<int> as_they_are(unknowns_.size());
  std::iota(as_they_are.begin(), as_they_are.end(), 0);
  set_order(std::move(as_they_are));
  for (int lane = 0; lane < lanes; ++lane) {
    const std::size_t which = lane < count(arms) ? static_cast<std::size_t>(lane) : 0;
    fill(lane, *arms[which], loads[which]);
  }
}

/// Sections for points that are not on the same node of all arms.
template <int D>
void ArmNumbersIn<D>::place_points(const std::vector<const SystemIn<D>*>& arms) {
  int n_sections = 0;
  for (std::size_t p = 0; p < arms.front()->points().size(); ++p) {
    const int node = arms.front()->points()[p].node;
    const bool on_node = std::all_of(arms.begin(), arms.end(), [&](const SystemIn<D>* arm) {
      return arm->points()[p].element < 0 && arm->points()[p].node == node;
    });
    points_.push_back(on_node ? PointPlace{node, -1} : PointPlace{-1, n_sections++});
  }
  section_nodes_.resize(static_cast<std::size_t>(2 * n_sections * lanes_));
}

/// Places, and room for numbers.
template <int D>
void ArmNumbersIn<D>::lay_out(const SystemIn<D>& arm) {
  constexpr int n = geometry::freedoms<D>;
  for (const auto& beam : arm.beams()) beam_nodes_.insert(beam_nodes_.end(), {beam.node1(), beam.node2()});
  for (const auto& body : arm.bodies()) body_nodes_.push_back(body.node());
  const integrators::RigidJointCondensationIn<D>& condensation = *condensation_.front();
  int row = 0;
  for (std::size_t k = 0; k < arm.constraints().size(); ++k) {
    const auto& joint = arm.constraints()[k];
    const bool folded = !condensation.joints().empty() && condensation.joints()[k];
    joints_.push_back({joint.node_a(), joint.node_b(), joint.coordinate(), row, folded});
    row += joint.rows();
  }
  for (const auto& gear : arm.gears()) gears_.push_back({gear.input, gear.output, row++, false});
  for (const auto& law : arm.laws()) laws_.push_back({law.plus, law.minus, has_three_numbers(law)});
  carriers_ = condensation.carriers();
  for (const auto& follower : condensation.followers())
    followers_.push_back({follower.node, follower.carrier});
  for (std::size_t j = 0; j < arm.joints().size(); ++j) {
    const auto& at = arm.joints()[j];
    if (at.theta >= 0) outputs_.push_back({at.theta, at.phi, static_cast<int>(j)});
  }
  const auto room = [&](Rows& rows, int count) {
    rows = Rows(count, lanes_);
    return rows.data();
  };
  arms_ = {.n_nodes = arm.n_nodes(),
           .n_scalars = arm.n_scalars(),
           .n_free_scalars = arm.n_free() - arm.scalar_offset(),
           .n_constraints = arm.n_constraints(),
           .damped = arms_.damped,
           .n_beams = count(arm.beams()),
           .n_bodies = count(body_nodes_),
           .n_joints = count(joints_),
           .n_gears = count(gears_),
           .n_laws = count(laws_),
           .n_carriers = count(carriers_),
           .n_followers = count(followers_),
           .beam_nodes = beam_nodes_.data(),
           .body_nodes = body_nodes_.data(),
           .carriers = carriers_.data(),
           .joints = joints_.data(),
           .gears = gears_.data(),
           .laws = laws_.data(),
           .followers = followers_.data(),
           .beams = room(beams_, (2 * n + 1 + 4 * n * n) * count(arm.beams())),
           .bodies = room(bodies_, n * n * count(body_nodes_)),
           .weights = room(weights_, (1 + D) * arm.n_nodes()),
           .gravity = room(gravity_, D),
           .joint_numbers = room(joint_numbers_, (3 * frame_rows<D> + n + 2 * n * n) * count(joints_)),
           .gear_numbers = room(gear_numbers_, 4 * count(gears_)),
           .law_numbers = room(law_numbers_, 3 * count(laws_)),
           .scalar_inertia = room(scalar_inertia_, arm.n_scalars()),
           .follower_frames = room(follower_frames_, 2 * frame_rows<D> * count(followers_)),
           .reach = room(reach_, 1),
           .mass_scale = room(mass_scale_, 1),
           .n_reduced = condensation.n_unknowns(),
           .n_parts = 0,
           .n_separated = 0,
           .order = nullptr,
           .parts = nullptr,
           .separator = nullptr,
           .n_points = count(points_),
           .points = points_.data(),
           .point_offsets = room(point_offsets_, D * count(points_)),
           .section_nodes = section_nodes_.data(),
           .sections = room(sections_, (n + 2) * n * count(section_nodes_) / (2 * lanes_)),
           .n_outputs = count(outputs_),
           .outputs = outputs_.data(),
           .turns = {},
           .n_forces = 0,
           .by_forces = nullptr,
           .consistent = nullptr,
           .consistent_turns = {}};
}

template <int D>
void ArmNumbersIn<D>::fill(int lane, const SystemIn<D>& arm, const LoadsIn<D>& loads) {
  int row = 0;
  for (const auto& beam : arm.beams()) {
    row = beams_.put(row, lane, beam.stiffness());
    row = beams_.put(row, lane, beam.rest(0));
    beams_(row++, lane) = beam.damping_time();
    row = beams_.put(row, lane, beam.mass());
  }
  row = 0;
  for (const auto& body : arm.bodies()) row = bodies_.put(row, lane, body.mass());
  row = 0;
  for (const auto& weight : arm.weights()) {
    weights_(row++, lane) = weight.mass;
    row = weights_.put(row, lane, weight.moment);
  }
  gravity_.put(0, lane, loads.gravity);
  row = 0;
  for (const auto& joint : arm.constraints()) {
    const auto& at = joint.frames();
    for (const auto* H : {&at.X_b, &at.X_a_inverse, &at.X_b_inverse})
      row = put_frame(joint_numbers_, row, lane, *H);
    row = joint_numbers_.put(row, lane, at.twist);
    row = joint_numbers_.put(row, lane, at.Ad_a);
    row = joint_numbers_.put(row, lane, at.Ad_b);
  }
  for (std::size_t k = 0; k < gears_.size(); ++k) {
    const joints::Transmission& teeth = arm.gears()[k].transmission;
    gears_[k].waves = gears_[k].waves || teeth.amplitude != 0;
    row = 4 * static_cast<int>(k);
    for (const double number : {1 / teeth.scale, teeth.amplitude, teeth.multiple, teeth.phase}) {
      gear_numbers_(row++, lane) = number;
    }
  }
  row = 0;
  for (const auto& law : arm.laws()) {
    joints::LawResponse at_rest;
    if (has_three_numbers(law)) at_rest = joints::respond(law.law, 0, 0, {});
    for (const double number : {at_rest.force, at_rest.stiffness, at_rest.damping}) {
      law_numbers_(row++, lane) = number;
    }
  }
  for (int k = 0; k < arm.n_scalars(); ++k) scalar_inertia_(k, lane) = arm.scalar_inertia()[k];
  row = 0;
  const std::size_t which = lane < count(condensation_) ? static_cast<std::size_t>(lane) : 0;
  for (const auto& follower : condensation_[which]->followers()) {
    row = put_frame(follower_frames_, row, lane, follower.X);
    row = put_frame(follower_frames_, row, lane, follower.X_inverse);
  }
  reach_(0, lane) = arm.reach();
  mass_scale_(0, lane) = integrators::constraint_scale(arm);
  row = 0;
  for (const auto& point : arm.points()) row = point_offsets_.put(row, lane, point.offset.x);
  fill_sections(lane, arm);
}

/// Stress of a bow b(t) is that of a rest strain d₀ + b + η b' without it, equations (1), (2) of beam.hpp.
template <int D>
void ArmNumbersIn<D>::grow_bows(int lane, const SystemIn<D>& arm, double t) {
  constexpr int n = geometry::freedoms<D>, rows = 2 * n + 1 + 4 * n * n;
  int row = n;
  for (const auto& beam : arm.beams()) {
    if (beam.grows()) {
      const geometry::Twist<D> rest = beam.rest(t) + beam.damping_time() * beam.bow_rate(t);
      beams_.put(row, lane, rest);
    }
    row += rows;
  }
}

/// On a node: where a section begins.
template <int D>
void ArmNumbersIn<D>::fill_sections(int lane, const SystemIn<D>& arm) {
  int row = 0;
  for (std::size_t p = 0; p < points_.size(); ++p) {
    if (points_[p].section < 0) continue;
    const auto& at = arm.points()[p];
    const auto* beam = at.element < 0 ? nullptr : &arm.beams()[static_cast<std::size_t>(at.element)];
    const auto section = beam == nullptr ? elements::BeamSection<D>{} : beam->section(at.xi);
    for (const auto* strain : {&section.whole, &section.rest}) row = sections_.put(row, lane, *strain);
    row = sections_.put(row, lane, section.N);
    const int first = 2 * points_[p].section * lanes_ + lane;
    section_nodes_[static_cast<std::size_t>(first)] = at.node;
    section_nodes_[static_cast<std::size_t>(first + lanes_)] = beam == nullptr ? at.node : beam->node2();
  }
}

/// The unknowns of the rows of inverses.
template <int D>
void ArmNumbersIn<D>::set_order(std::vector<int> order) {
  cut_order_ = std::move(order);
  order_.clear();
  for (const int k : cut_order_) order_.push_back(unknowns_[static_cast<std::size_t>(k)]);
  arms_.order = order_.data();
}

/// Room for inverses that are cut like this one.
template <int D>
void ArmNumbersIn<D>::cut(const linear_solvers::DissectedInverse& inverse) {
  set_order(inverse.order());
  for (const auto& part : inverse.parts()) boundaries_.push_back(part.boundary);
  int inner = 0;
  for (std::size_t p = 0; p < boundaries_.size(); ++p) {
    const auto& part = inverse.parts()[p];
    const int rows = static_cast<int>(part.size), n_boundary = count(boundaries_[p]);
    inverses_.emplace_back((rows + n_boundary) * rows, lanes_);
    from_boundaries_.emplace_back(rows * n_boundary, lanes_);
    parts_.push_back({static_cast<int>(part.first), rows, n_boundary, boundaries_[p].data(),
                      inverses_[p].data(), from_boundaries_[p].data()});
    inner += rows;
  }
  arms_.n_parts = count(parts_);
  arms_.n_separated = arms_.n_reduced - inner;
  separator_ = Rows(arms_.n_separated * arms_.n_separated, lanes_);
  arms_.parts = parts_.data();
  arms_.separator = separator_.data();
}

template <int D>
bool ArmNumbersIn<D>::cut_as(const linear_solvers::DissectedInverse& inverse) const {
  return inverse.order() == cut_order_ &&
         std::equal(boundaries_.begin(), boundaries_.end(), inverse.parts().begin(), inverse.parts().end(),
                    [](const auto& boundary, const auto& part) { return boundary == part.boundary; });
}

template <int D>
bool ArmNumbersIn<D>::set_inverse(int lane, const linear_solvers::DissectedInverse* inverse) {
  const bool fits = inverse != nullptr && !inverse->eliminates_first();
  if (std::exchange(is_first_, false) && fits) cut(*inverse);
  if (!fits || !cut_as(*inverse)) return false;
  for (std::size_t p = 0; p < parts_.size(); ++p) {
    const auto& part = inverse->parts()[p];
    const int rows = parts_[p].size, n_boundary = parts_[p].n_boundary;
    const int behind = put_blocks(inverses_[p], 0, lane, part.inverse, 0, rows);
    put_blocks(inverses_[p], behind, lane, part.inverse, rows, n_boundary);
    put_blocks(from_boundaries_[p], 0, lane, part.from_boundary, 0, rows);
  }
  put_blocks(separator_, 0, lane, inverse->separator(), 0, arms_.n_separated);
  return true;
}

template <int D>
void ArmNumbersIn<D>::set_turns(int lane, const Update& update) {
  if (arms_.turns.n_joints == 0) {
    turns_ = TurnNumbersIn<D>(update, unknowns_, arms_.n_reduced, lanes_);
    arms_.turns = turns_.turns();
  }
  turns_.set(lane, update, update.W()(cut_order_, Eigen::all));
}

template <int D>
void ArmNumbersIn<D>::set_by_forces(int lane, const MatrixXd& W) {
  if (arms_.by_forces == nullptr) {
    by_forces_ = Rows(static_cast<int>(W.size()), lanes_);
    arms_.n_forces = static_cast<int>(W.cols());
    arms_.by_forces = by_forces_.data();
  }
  by_forces_.put_blocks(0, lane, MatrixXd(W(cut_order_, Eigen::all)), 0, arms_.n_reduced, arms_.n_forces);
}

template <int D>
void ArmNumbersIn<D>::set_consistent(int lane, const MatrixXd& change, const Update& update,
                                     const MatrixXd& W) {
  if (arms_.consistent == nullptr) {
    consistent_ = Rows(static_cast<int>(change.size()), lanes_);
    arms_.consistent = consistent_.data();
    std::vector<int> all(static_cast<std::size_t>(update.system().n_unknowns()));
    std::iota(all.begin(), all.end(), 0);
    consistent_turns_ = TurnNumbersIn<D>(update, all, static_cast<int>(W.rows()), lanes_);
    arms_.consistent_turns = consistent_turns_.turns();
  }
  consistent_.put_blocks(0, lane, change, 0, static_cast<int>(change.rows()),
                         static_cast<int>(change.cols()));
  consistent_turns_.set(lane, update, W);
}

template bool suits<2>(const SystemIn<2>&, const LoadsIn<2>&, bool);
template bool suits<3>(const SystemIn<3>&, const LoadsIn<3>&, bool);
template bool same_structure<2>(const SystemIn<2>&, const SystemIn<2>&);
template bool same_structure<3>(const SystemIn<3>&, const SystemIn<3>&);
template class ArmNumbersIn<2>;
template class ArmNumbersIn<3>;

}  // namespace flexarm::lanes
