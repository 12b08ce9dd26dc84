"""Small vectors and matrices without NumPy, so that `flexarm check` starts at once."""

from __future__ import annotations

from math import cos, hypot, sin

from flexarm.arm.inertia import Matrix

Vector = tuple[float, float, float]
Frame = tuple[Matrix, Vector]
IDENTITY: Matrix = ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0), (0.0, 0.0, 1.0))


def from_rpy(rpy: Vector) -> Matrix:
    """R = Rz(yaw) Ry(pitch) Rx(roll), the URDF convention."""
    (cr, sr), (cp, sp), (cy, sy) = ((cos(angle), sin(angle)) for angle in rpy)
    return (
        (cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr),
        (sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr),
        (-sp, cp * sr, cp * cr),
    )


def from_vector(v: Vector) -> Matrix:
    """Return the rotation by |v| [rad] about v: R = 1 + sin a [n] + (1 - cos a) [n]^2 (Rodrigues)."""
    angle = hypot(*v)
    if angle == 0:
        return IDENTITY
    x, y, z = scaled(1 / angle, v)
    s, c = sin(angle), 2 * sin(angle / 2) ** 2  # 1 - cos a without cancellation
    return (
        (1 - c * (y * y + z * z), c * x * y - s * z, c * x * z + s * y),
        (c * x * y + s * z, 1 - c * (x * x + z * z), c * y * z - s * x),
        (c * x * z - s * y, c * y * z + s * x, 1 - c * (x * x + y * y)),
    )


def from_axes(x: Vector, up: Vector) -> Matrix:
    """Return the columns unit x, y = z cross x, and z, the unit part of `up` normal to x."""
    ex = scaled(1 / hypot(*x), x)
    along = dot(up, ex)
    part = (up[0] - along * ex[0], up[1] - along * ex[1], up[2] - along * ex[2])
    ez = scaled(1 / hypot(*part), part)
    ey = cross(ez, ex)
    return transposed((ex, ey, ez))


def across(axis: Vector) -> tuple[Vector, Vector]:
    """Return two unit vectors normal to an axis and to one another: x made normal to it, and axis times that.

    Of an axis within 26 degrees of x, y takes the place of x.
    """
    towards = (0.0, 1.0, 0.0) if abs(axis[0]) > 0.9 * hypot(*axis) else (1.0, 0.0, 0.0)
    _, second, first = transposed(from_axes(axis, towards))
    return first, scaled(-1.0, second)


def part_across(direction: Vector, axis: Vector) -> Vector:
    """Return the part of a direction normal to an axis; its length is the sine between them for unit ones."""
    return added(direction, scaled(-dot(direction, axis) / dot(axis, axis), axis))


def dot(a: Vector, b: Vector) -> float:
    """Scalar product."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def cross(a: Vector, b: Vector) -> Vector:
    """Vector product."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


def scaled(factor: float, a: Vector) -> Vector:
    """Return a vector times a number."""
    return factor * a[0], factor * a[1], factor * a[2]


def added(a: Vector, b: Vector) -> Vector:
    """Sum of two vectors."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def transposed(a: Matrix) -> Matrix:
    """Transpose."""
    return (a[0][0], a[1][0], a[2][0]), (a[0][1], a[1][1], a[2][1]), (a[0][2], a[1][2], a[2][2])


def times(a: Matrix, b: Matrix) -> Matrix:
    """Product of two matrices."""
    columns = transposed(b)
    return rotated(columns, a[0]), rotated(columns, a[1]), rotated(columns, a[2])


def rotated(a: Matrix, x: Vector) -> Vector:
    """Matrix times vector."""
    return dot(a[0], x), dot(a[1], x), dot(a[2], x)


def sum_of(a: Matrix, b: Matrix) -> Matrix:
    """Sum of two matrices."""
    return added(a[0], b[0]), added(a[1], b[1]), added(a[2], b[2])


def chained(a: Frame, b: Frame) -> Frame:
    """Frame b, given in frame a, in the parent of a."""
    return times(a[0], b[0]), added(a[1], rotated(a[0], b[1]))


def inverted(rotation: Matrix, position: Vector) -> Frame:
    """Return the inverse frame: the parent relative to the frame."""
    back = transposed(rotation)
    return back, scaled(-1.0, rotated(back, position))
