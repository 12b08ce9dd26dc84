/// @file
/// Arms of one structure side by side, in a plane (D = 2) or in space (3), as code for one kind of processor
/// sees them: numbers and places. A twist has n of them, 3 or 6.
///
/// Every quantity of an arm is a row of N numbers, one a lane, and rows lie one after the other. Rows named
/// `frame` are R by columns, x. The code is compiled with options that other code must not share, so
/// nothing here has functions, and matrices are rows of their entries by columns.
#pragma once

namespace flexarm::lanes {

/// Numbers of a frame.
template <int D>
inline constexpr int frame_rows = D * D + D;

struct JointPlace {
  int node_a, node_b, coordinate, first_row;
  bool folded;  ///< takes no part in steps (integrators/rigid_joint_condensation.hpp)
};

/// A gear between scalar coordinates, with its constraint's row; `waves` if some arm has a transmission
/// error.
struct GearPlace {
  int input, output, row;
  bool waves;
};

/// A law between scalar coordinates: plus less minus, or plus alone (−1). Linear laws have numbers; of others
/// the force is given with the motion.
struct LawPlace {
  int plus, minus;
  bool linear;
};

/// A node that follows another one (integrators/rigid_joint_condensation.hpp); −1: the base.
struct FollowerPlace {
  int node, carrier;
};

/// A part of the kept inverse (linear_solvers/dissected_inverse.hpp).
struct InversePart {
  int first, size, n_boundary;
  const int* boundary;
  const double* inverse;        ///< (size + n_boundary, size), by blocks of rows
  const double* from_boundary;  ///< (size, n_boundary), by blocks of rows
};

/// Rows of one block; the last one has what is left. Within a block columns follow one another.
inline constexpr int block_rows = 6;

/// Columns that are recorded of a joint: −1 for what it has not.
struct JointOutput {
  int theta, phi, constraint;
};

/// A point on a node of all arms, or −1 and the number of its section.
struct PointPlace {
  int node, section;
};

/// A joint between two links that move, which turns their axes: the places of its coordinate and, among the
/// unknowns, of the parent's node and of its multipliers.
struct TurningJoint {
  int coordinate, node, multipliers;
  bool slides;
};

/// What turned joints change in a kept matrix (integrators/woodbury_update.hpp), with blocks of `across`
/// rows.
struct Turns {
  int n_joints, n_columns, n_rows;  ///< of U, and of W
  const TurningJoint* joints;
  const double* scale;    ///< s
  const double* numbers;  ///< T(θ₀) (across²), ξ (n), Ad_aᵀ Q (n across), P (rows across) of each joint
  const double* G;        ///< (n_columns, n_columns)
  const double* W;        ///< (n_rows, n_columns), by blocks of rows
  double* E;              ///< (across²) of each joint
  double* factors;        ///< of I + C G, by rows, then which rows were pivots, and the pivots' inverses
  double* other_factors;  ///< room for as many
};

/// Everything that does not change from step to step.
struct Arms {
  int n_nodes, n_scalars, n_free_scalars, n_constraints;
  bool damped;
  int n_beams, n_bodies, n_joints, n_gears, n_laws, n_carriers, n_followers;
  const int *beam_nodes, *body_nodes, *carriers;
  const JointPlace* joints;
  const GearPlace* gears;
  const LawPlace* laws;
  const FollowerPlace* followers;
  const double* beams;            ///< K (n), d₀ + b (n), η, M (4 n²) of each
  const double* bodies;           ///< M (n²) of each
  const double* weights;          ///< mass, first moment (D) of each node
  const double* gravity;          ///< (D)
  const double* joint_numbers;    ///< X_b, X_a⁻¹, X_b⁻¹ (frames), ξ (n), Ad_a, Ad_b (n² each) of each
  const double* gear_numbers;     ///< 1/scale, A, m, β of each (joints/transmission.hpp)
  const double* law_numbers;      ///< force without deflection and rate, stiffness, damping of each
  const double* scalar_inertia;   ///< of each scalar coordinate
  const double* follower_frames;  ///< X, X⁻¹ of each
  const double* reach;
  const double* mass_scale;  ///< of constraints and multipliers, times β h²

  int n_reduced, n_parts, n_separated;
  const int* order;  ///< the unknown of the k-th row of the inverse
  const InversePart* parts;
  const double* separator;

  int n_points;
  const PointPlace* points;
  const double* point_offsets;  ///< (D) of each
  const int* section_nodes;     ///< of each section the first node of every lane, then the second
  const double* sections;       ///< d₀ (n), ξ d₀ (n), N (n²) of each, elements/beam_section.hpp
  int n_outputs;
  const JointOutput* outputs;
  Turns turns;  ///< of the kept inverse
  int n_forces;
  const double*
      by_forces;  ///< W of forces that are found lane by lane: (n_reduced, n_forces), by blocks of rows
  /// Change of accelerations of free scalar coordinates, of multipliers and of Uᵀ x by Φ'': (n_free_scalars +
  /// n_constraints + n_columns, n_constraints); null: forces are those of the stepping. W has rows of the
  /// first two.
  const double* consistent;
  Turns consistent_turns;
};

/// What moves.
struct Motion {
  double *frames, *frames_before;  ///< a node
  double *s, *s_before;            ///< scalar coordinates
  double *v, *v_dot, *a;           ///< freedoms of nodes, then scalar coordinates
  double* multipliers;
  double* exponent;      ///< of free velocities
  double* r;             ///< of all velocities
  double* dx;            ///< of all unknowns: residuals, then increments
  double* law_forces;    ///< of each law; read where it is not linear
  double* work;          ///< four times as many rows as there are unknowns, and more
  double* acceleration;  ///< Φ'', then what `consistent` makes of it
};

/// One for all arms: what drives them at the end of a step, one number a scalar coordinate.
struct Drive {
  const double *s, *v, *v_dot, *torques;
};

/// Coefficients of integrators/hht.hpp, and the step.
struct Step {
  double h, alpha, beta, gamma;
};

/// The code for one kind of processor and number of lanes.
struct Kernel {
  int lanes;
  /// State 1 with the accelerations of state 0.
  void (*predict)(const Arms&, Motion&, const Step&, const Drive&);
  /// What the increments of state 1 solve: right sides from its residuals, in their place.
  void (*find_sides)(const Arms&, Motion&, const Step&, const Drive&);
  /// The increments that the kept inverse makes of them.
  void (*solve)(const Arms&, Motion&);
  /// What turned joints make of the increments. @param fresh not 0 in lanes whose joints have turned since
  /// the last call, or that have another inverse
  void (*turn)(const Arms&, Motion&, const double* fresh);
  /// What forces of turned joints and laws, of which each lane has its own, make of the increments.
  void (*take_forces)(const Arms&, Motion&, const double* forces);
  /// Corrects state 1 in lanes whose entry of `active` is not 0. @param sizes of the increments in all lanes;
  /// not a number where one is not finite
  void (*correct)(const Arms&, Motion&, const Step&, const double* active, double* sizes);
  /// Position and velocity of every point (2 D rows), and of every joint θ, θ', φ, φ', the motor's torque and
  /// the joint's (6 rows).
  void (*record)(const Arms&, Motion&, double* rows);
};

/// The code that this processor runs in a plane (2) or in space (3), with as many lanes as it has vectors
/// for, but not twice as many as there are arms; null: none.
const Kernel* kernel_for(int dimension, int arms);

}  // namespace flexarm::lanes
