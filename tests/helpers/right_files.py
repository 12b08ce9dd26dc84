"""Models and records that are right, for tests to spoil."""

MODEL = """\
format = "flexarm-arm/1"
name = "crane"
gravity = [0.0, 0.0, -9.81]

[[joints]]
name = "hinge"
type = "revolute"
parent = "base"
child = "rod"
origin = { xyz = [0, 0, 0.4], rpy = [0, 0, 0] }
axis = [0, 1, 0]
gear_ratio = 120
rotor_inertia = 1.0e-3

[[joints]]
name = "wrist"
type = "fixed"
parent = "rod"
child = "gripper"
at = "end"

[[links]]
name = "rod"
type = "beam"
end = [0, 0, 3.0]
section = { shape = "tube", outer_diameter = 0.06024, thickness = 3.25e-3 }
material = { youngs_modulus = 210e9, poisson_ratio = 0.3, density = 7850 }
elements = 4
damping_ratio = 0.005

[[links]]
name = "gripper"
type = "rigid"
mass = 2.0
com = [0, 0, 0.1]
inertia = [0.02, 0.02, 0.01]

[[payloads]]
name = "load"
link = "gripper"
position = [0, 0, 0.2]
mass = 14.1

[[points]]
name = "tip"
link = "rod"
position = [0, 0, 3.0]

[[sensors]]
name = "tracker"
quantity = "position"
point = "tip"
axes = ["x", "z"]
rate_hz = 10
noise_std = 0.05
unit = "mm"

[[motors]]
joint = "hinge"
resistance = 2.6
torque_constant = 0.0077

[[controllers]]
joint = "hinge"
type = "cascade"
position_gain = 12.0
velocity_gain = 4.0e3
integral_time = 0.05
sample_time = 0.002

[[effects]]
name = "joint_compliance"
at = "hinge"
stiffness = 1.0e5
damping = 20.0

[uncertainty]
"links.rod.material.youngs_modulus" = 0.02
"payloads.load.mass" = 0.005
"points.tip.position_m" = 0.001
"""

RECORD = """\
format = "flexarm-record/1"
description = "slow sine"
drive = "hinge"

[joints]
wrist = 0.3

[payloads]
load = { mass = 5.0 }

[clocks]
controller = 0.0
tracker = { offset = 0.01, sigma = 2.0e-3 }

[frames]
tracker = { translation = 1.0e-3, rotation = 5.0e-4 }

[[signals]]
name = "hinge"
quantity = "joint_angle"
joint = "hinge"
side = "motor"
file = "encoder.csv"
time = "time_s"
channels = ["encoder_deg"]
unit = "deg"
noise_std = 1.0e-4
clock = "controller"

[[signals]]
name = "tip"
quantity = "position"
point = "tip"
axes = ["x", "z"]
frame = "tracker"
file = "tracker.csv"
time = "time_s"
channels = ["tip_x_mm", "tip_z_mm"]
unit = "mm"
noise_std = 0.05
clock = "tracker"
"""

ENCODER = "time_s,encoder_deg\n# started by hand\n0.0,10.0\n0.1,20.0\n0.2,30.0\n"
TRACKER = "time_s,tip_x_mm,tip_z_mm\n0.05,520,3350\n0.15,,3200\n0.25,nan,nan\n"

RESPONSES = """format = "flexarm-record/1"
kind = "frequency_response"

[joints]
hinge = 0.3

[[signals]]
name = "hammer"
quantity = "force"
point = "tip"
axes = ["x"]

[[signals]]
name = "imu"
quantity = "acceleration"
point = "tip"
axes = ["x"]
input = "hammer"
file = "frf.csv"
frequency = "hz"
channels = ["re", "im"]
unit = "m/s2/N"
coherence = "coherence"
averages = 8
"""
