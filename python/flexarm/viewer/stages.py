"""From models and results to scenes: what is drawn of each, how it moves, and what is said of its scale."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from flexarm.arm import Arm
from flexarm.arm.closure import loop_joints, loops
from flexarm.arrays import Floats
from flexarm.assembly import following_joints
from flexarm.drive import Drive
from flexarm.errors import InvalidParameter
from flexarm.modal import Modes, modes
from flexarm.simulation import Simulation, simulate
from flexarm.statics import Statics, static
from flexarm.superelement import SuperElement
from flexarm.viewer.bodies import LAYERS, Bodies, Meshes, gravity_at, part_skins, triad
from flexarm.viewer.measured import Measured
from flexarm.viewer.mode_words import told, twisted
from flexarm.viewer.scene import STYLE, Clip, Label, Layer, Scene, nice
from flexarm.viewer.skeleton import Poses, Skeleton, at_rest, from_quaternions
from flexarm.viewer.solids import Skin, Surface, ball
from flexarm.wording import number, with_unit


def of_arm(arm: Arm, joints: Mapping[str, float] | None = None, meshes: Meshes | None = None) -> Scene:
    """Return the undeformed arm at drive angles [rad, m], and each joint moved alone."""
    # Turn with which the page of a model moves one joint [rad], and how long that takes [s].
    sweep, sweep_seconds = 0.6, 4.0
    skeleton, angles = Skeleton(arm), at_rest(arm, joints or {})
    still = skeleton.rigid(angles)
    size = _size(still.x)
    clips = [Clip("at rest", np.zeros(1), still, "the undeformed arm, without effects")]
    looped = loop_joints(arm)
    time = np.linspace(0, sweep_seconds, 2 * STYLE.mode_frames)
    for i, joint in enumerate(arm.joints):
        if joint.moves and joint.name not in {gear.output for gear in arm.gears}:
            reach = sweep if joint.type == "revolute" else 0.15 * size
            sine = np.sin(2 * np.pi * time / sweep_seconds)
            if joint.name in looped:
                moved, reach = _swept(arm, joint.name, float(angles[0, i]), reach * sine, joints or {})
            else:
                moved = np.repeat(angles, len(time), axis=0)
                moved[:, i] += reach * sine
                if arm.gears:
                    moved = np.array([at_rest(arm, drive_angles(arm, row))[0] for row in moved])
            text = f"{joint.name} moved by {with_unit(reach, 'rad' if joint.type == 'revolute' else 'm')}"
            if len(moved):
                clips.append(Clip(joint.name, time, skeleton.rigid(moved), text, loops=True))
    bodies = Bodies(skeleton, size, meshes)
    notes = (_angles(arm, angles[0]),)
    return _scene(f"{arm.name}: model", notes, bodies, clips)


def of_statics(found: Statics, scale: float | None = None, meshes: Meshes | None = None) -> Scene:
    """Return an equilibrium beside the rigid arm, displacements times `scale` (None: so that they show)."""
    skeleton = Skeleton(found.arm)
    rigid = skeleton.rigid(found.drive_angle[None])
    if found.arm.closures:
        rigid = skeleton.rigid(at_rest(found.arm, drive_angles(found.arm, found.drive_angle, found.driven)))
    forces = {} if found.force is None else dict(zip(found.points, found.force, strict=True))
    held = drive_angles(found.arm, found.drive_angle)
    looped = set(loop_joints(found.arm)) - set(found.driven)
    again = static(
        skeleton.seen,
        {name: angle for name, angle in held.items() if name not in looped},
        {name: force for name, force in forces.items() if np.any(force)},
        at_link=found.at_link,
    )
    poses = Poses(again.rotation[None], again.position[None])[:, skeleton.chosen]
    largest = _farthest(poses.x - rigid.x)
    size = _size(rigid.x)
    times = _scale_of(largest, size, STYLE.shown_deformation) if scale is None else _checked(scale)
    bodies = Bodies(skeleton, size, meshes)
    shown = poses.scaled(rigid, times)
    n = len(skeleton.bones)
    ghost = [skin.shifted(n, "rigid arm", STYLE.ghost, 0.3) for skin in bodies.links()]
    both = Poses(np.concatenate([shown.R, rigid.R], axis=1), np.concatenate([shown.x, rigid.x], axis=1))
    notes = (
        f"displacements × {times:g}; the largest is {with_unit(largest, 'm')}",
        _angles(found.arm, found.drive_angle, found.driven),
    )
    layer = Layer("rigid arm", STYLE.ghost, "rigid arm at the same drive angles")
    clips = [Clip("equilibrium", np.zeros(1), both)]
    return _scene(f"{found.arm.name}: equilibrium", notes, bodies, clips, ghost, [layer])


def of_modes(found: Modes, meshes: Meshes | None = None) -> Scene:
    """Return the mode shapes about the equilibrium, slowed so that one period takes two seconds.

    Raise InvalidParameter if the modes do not say where the arm stood, as those that older versions stored.
    """
    skeleton, rest, shapes = _shapes(found)
    assert found.drive_angle is not None  # without it there are no shapes
    size = _size(rest.x)
    clips = []
    bodies = Bodies(skeleton, size, meshes)
    words = told(bodies, rest, shapes)
    for i, (frequency, shape) in enumerate(zip(found.frequency_hz, shapes, strict=True)):
        least = np.finfo(float).tiny
        amplitude = STYLE.shown_mode * size / max(_farthest(shape[:, :3]), least)
        amplitude = min(amplitude, STYLE.most_turned / max(_farthest(shape[:, 3:]), least))
        phase = 2 * np.pi * np.arange(STYLE.mode_frames) / STYLE.mode_frames
        swing = amplitude * np.sin(phase)[:, None, None]
        poses = Poses(np.repeat(rest.R, len(phase), axis=0), np.repeat(rest.x, len(phase), axis=0))
        time = 2.0 * np.arange(len(phase)) / len(phase)
        slowed = f"slowed {number(2.0 * frequency)} times" if frequency > 0 else "not to time"
        damping = f"damping {number(100 * found.damping_ratio[i], 2)} %"
        text = f"{number(frequency, 4)} Hz, {damping}, {words[i]}; {slowed}"
        name = f"mode {i + 1}: {number(frequency)} Hz"
        moved = poses.moved(swing * shape[:, :3], swing * shape[:, 3:])
        clips.append(Clip(name, time, moved, text, loops=True))
    clips = clips or [Clip("equilibrium", np.zeros(1), rest, "nothing can vibrate")]
    n = len(skeleton.bones)
    both = [_beside(clip, rest) for clip in clips]
    bars = list(bodies.outriggers({twisted(bodies, rest, shape) for shape in shapes}))
    ghost = [skin.shifted(n, "equilibrium", STYLE.ghost, 0.3) for skin in (*bodies.links(), *bars)]
    driven = str(found.solver.get("driven", "")).split()
    notes = (
        "amplitudes are free: shapes are drawn so that they show",
        _angles(found.arm, found.drive_angle, driven),
    )
    layer = Layer("equilibrium", STYLE.ghost, "equilibrium")
    return _scene(f"{found.arm.name}: modes", notes, bodies, both, [*bars, *ghost], [layer])


def moving_parts(found: Modes) -> list[str]:
    """Return a phrase on each mode: which joint or link gives most of it, and the direction of the motion.

    Raise InvalidParameter as `of_modes`.
    """
    skeleton, rest, shapes = _shapes(found)
    return told(Bodies(skeleton, _size(rest.x), None), rest, shapes)


def _shapes(found: Modes) -> tuple[Skeleton, Poses, Floats]:
    """Return the bones, where they rest, and how they move in each mode, (mode, bone, 6)."""
    if found.drive_angle is None:
        raise InvalidParameter("were stored without the pose of the arm; compute them again", where="modes")
    skeleton = Skeleton(found.arm)
    joints = drive_angles(found.arm, found.drive_angle, str(found.solver.get("driven", "")).split())
    arm = skeleton.seen if found.with_gravity else skeleton.seen.replace(gravity=(0.0, 0.0, 0.0))
    still = static(arm, joints)
    rest = Poses(still.rotation[None], still.position[None])[:, skeleton.chosen]
    shapes = modes(skeleton.seen, joints, len(found.frequency_hz), found.with_gravity)
    return skeleton, rest, shapes.shape[:, skeleton.chosen]


def of_simulation(
    run: Simulation,
    scale: float = 1.0,
    meshes: Meshes | None = None,
    measured: Iterable[Measured] = (),
    gaps_times: float | None = None,
) -> Scene:
    """Return a run at true speed, displacements from the rigid arm times `scale`, with what was measured.

    Shapes of links are not stored with a run: it is made again along its own motor angles, with rotations,
    from rest or in motion as it began. Gaps are shown times `gaps_times`, by default so that they show.
    """
    skeleton = Skeleton(run.arm)
    again = _again(skeleton, run)
    wanted = min((run.time[-1] - run.time[0]) * STYLE.frames_per_second, STYLE.most_frames, len(run.time) - 1)
    frames = np.unique(np.linspace(0, len(run.time) - 1, max(2, round(wanted) + 1)).round().astype(int))
    assert again.orientation is not None  # asked for
    x, turn = again.position[frames, skeleton.chosen], again.orientation[frames, skeleton.chosen]
    poses = from_quaternions(x, turn)
    angles = run.drive_angle[frames]
    if run.arm.closures:
        driven = str(run.solver.get("driven", "")).split()
        angles = np.array([at_rest(run.arm, drive_angles(run.arm, row, driven))[0] for row in angles])
    rigid = skeleton.rigid(angles)
    poses, time = poses.scaled(rigid, _checked(scale)), run.time[frames]
    size = _size(poses.x)
    bodies = Bodies(skeleton, size, meshes)
    notes = ["true speed" if scale == 1 else f"true speed, displacements from the rigid arm × {scale:g}"]
    apart = _farthest(again.position[:, : len(run.points)] - run.position)
    if apart > STYLE.point * size:
        notes.append(
            f"the run was made again along its motor angles: points differ by up to {with_unit(apart, 'm')}"
        )
    skins, labels, layers, tracks = [], [], [], [poses.x]
    count = len(skeleton.bones)
    seen = [each for each in measured if each.point in skeleton.points]
    gaps = [each.gap(time) for each in seen]
    largest = _largest(gaps)
    times = gap_scale(run, seen) if gaps_times is None else gaps_times
    if seen:
        notes.append(f"gaps measured − predicted × {times:g}")
        notes += dict.fromkeys(each.note for each in seen if each.note)
    for each, gap in zip(seen, gaps, strict=True):
        name, place, kind = each.name, skeleton.points[each.point], "measured"
        track = poses.x[:, place] + times * gap
        bone = count + len(tracks) - 1
        tracks.append(track[:, None])
        skins.append(ball(1.4 * STYLE.point * size).on(bone, kind, name, STYLE.measured))
        tie = np.array([[place], [bone]])
        skins.append(Skin(kind, f"{name} gap", tie, np.zeros((2, 1, 3)), np.array([[0, 1]]), STYLE.measured))
        labels.append(Label(kind, f"{name} measured", bone))
    if skins:
        layers.append(Layer("measured", STYLE.measured, "measured points, tied to the predicted ones"))
    all_x = np.concatenate(tracks, axis=1)
    extra = np.broadcast_to(np.eye(3), (*all_x.shape[:2], 3, 3)).copy()
    extra[:, :count] = poses.R
    paths = [_path(name, poses.x[:, bone]) for name, bone in skeleton.points.items()]
    layers.append(Layer("paths", STYLE.points, "paths of points"))
    said = f"gaps up to {with_unit(largest, 'm')} along an axis" if seen else ""
    clip = Clip("run", time, Poses(extra, all_x), said)
    return replace(
        _scene(
            f"{run.arm.name}: run of {run.time[-1] - run.time[0]:.4g} s",
            notes,
            bodies,
            [clip],
            skins,
            layers,
            paths,
        ),
        labels=(*bodies.labels(), *labels, *_gravity_label(run.arm, size)),
    )


def gap_scale(run: Simulation, measured: Iterable[Measured]) -> float:
    """Return the factor with which the largest gap of a run shows."""
    largest = _largest([each.gap(run.time) for each in measured])
    return _scale_of(largest, _size(run.position), STYLE.shown_gap)


def of_superelement(part: SuperElement, surface: Surface | None = None) -> Scene:
    """Return a super-element: its mesh where there is one, its interfaces, its centre of mass."""
    corners = part.positions if surface is None else np.concatenate([surface.corners, part.positions])
    size = _size(corners[None])
    bones = list(range(part.n_interfaces))
    skins = list(part_skins(part.name, part, bones, size, surface))
    poses = Poses(part.rotations[None], part.positions[None])
    centre = ball(1.5 * STYLE.point * size).moved(np.eye(3), part.centre)
    skins.append(centre.on(-1, "payloads", "centre of mass", STYLE.payload))
    for bone, name in enumerate(part.interfaces):
        skins += triad(bone, STYLE.frame * size, "frames", name)
    labels = [Label("super-elements", name, bone) for bone, name in enumerate(part.interfaces)]
    labels.append(Label("payloads", f"{number(part.mass_total, 4)} kg", -1, tuple(map(float, part.centre))))  # type: ignore[arg-type]
    low = ", ".join(number(f, 4) for f in part.frequency_hz[:3])
    notes = [f"{part.n_interfaces} interfaces, {part.n_modes} modes" + (f", from {low} Hz" if low else "")]
    if surface is None:
        notes.append("no mesh given: sticks from the middle to the interfaces")
    layers = [
        replace(LAYERS["super-elements"], text="the part and its interfaces"),
        replace(LAYERS["payloads"], text="centre of mass"),
        replace(LAYERS["frames"], text="axes of interfaces: x red, y green, z blue", shown=True),
    ]
    clip = Clip("part", np.zeros(1), poses)
    return Scene(
        f"{part.name}: super-element", tuple(notes), tuple(layers), tuple(skins), tuple(labels), (clip,)
    )


# -------------------------------------------------------------------------------------------- parts of it


def _scene(
    title: str,
    notes: Iterable[str],
    bodies: Bodies,
    clips: list[Clip],
    more: Iterable[Skin] = (),
    layers: Iterable[Layer] = (),
    lines: Iterable[Skin] = (),
) -> Scene:
    skins = [*bodies.skins(), *more, *lines]
    used = {skin.layer for skin in skins}
    shown = [*(layer for name, layer in LAYERS.items() if name in used), *layers]
    labels = [*bodies.labels(), *_gravity_label(bodies.arm, bodies.size)]
    return Scene(title, tuple(filter(None, notes)), tuple(shown), tuple(skins), tuple(labels), tuple(clips))


def _gravity_label(arm: Arm, size: float) -> list[Label]:
    g = float(np.linalg.norm(arm.gravity))
    if not g:
        return []
    at = gravity_at(size) + STYLE.arrow * size * np.asarray(arm.gravity) / g
    return [Label("gravity", f"g = {number(g)} m/s²", -1, tuple(map(float, at)))]  # type: ignore[arg-type]


def _beside(clip: Clip, rest: Poses) -> Clip:
    n = len(clip.time)
    R = np.concatenate([clip.poses.R, np.repeat(rest.R, n, axis=0)], axis=1)
    x = np.concatenate([clip.poses.x, np.repeat(rest.x, n, axis=0)], axis=1)
    return replace(clip, poses=Poses(R, x))


def _path(name: str, x: Floats) -> Skin:
    lines = np.stack([np.arange(len(x) - 1), np.arange(1, len(x))], axis=1)
    bone = np.full((len(x), 1), -1)
    return Skin("paths", f"{name} path", bone, x[:, None], lines, STYLE.points)


def _again(skeleton: Skeleton, run: Simulation) -> Simulation:
    driven = drive_angles(run.arm, run.drive_angle[0], str(run.solver.get("driven", "")).split())
    angles = {name: run.drive_angle[:, run.joints.index(name)] for name in driven}
    drive = Drive.from_samples(run.time, angles)
    return simulate(
        skeleton.seen,
        replace(drive, rates={}) if np.any(run.joint_rate[0]) else drive,
        step=float(run.solver.get("step", np.median(np.diff(run.time)))),
        alpha=float(run.solver.get("alpha", -0.05)),
        rotations=True,
        consistent_forces=False,
    )


def drive_angles(arm: Arm, angles: Floats, driven: Iterable[str] = ()) -> dict[str, float]:
    """Return the angles (joint,) of joints that lead, by name.

    Outputs of gears follow, and so do joints of loops that close when others are `driven`.
    """
    follow = {gear.output for gear in arm.gears} | {*following_joints(arm, (), tuple(driven))}
    return {
        joint.name: float(angle)
        for joint, angle in zip(arm.joints, angles, strict=True)
        if joint.moves and joint.name not in follow
    }


def _swept(
    arm: Arm, joint: str, middle: float, sweep: Floats, joints: Mapping[str, float]
) -> tuple[Floats, float]:
    """Return joint values while a joint of a loop moves and others of it follow, and how far it moves.

    Stated joints of other loops stay. The sweep is halved until the loop closes; no values if it never does.
    """
    held = {name: at for name, at in joints.items() if not any({name, joint} <= loop for loop in loops(arm))}
    for _ in range(5):
        try:
            found = [at_rest(arm, {**held, joint: middle + float(moved)})[0] for moved in sweep]
        except InvalidParameter:
            sweep = sweep / 2
            continue
        return np.array(found), float(np.abs(sweep).max())
    return np.zeros((0, len(arm.joints))), 0.0


def _size(x: Floats) -> float:
    """Return the extent of positions (..., 3) and the origin [m]."""
    flat = np.concatenate([x.reshape(-1, 3), np.zeros((1, 3))])
    return max(float(np.linalg.norm(flat.max(axis=0) - flat.min(axis=0))), 1e-6)


def _largest(gaps: list[Floats]) -> float:
    return max((float(np.nanmax(np.abs(gap), initial=0.0)) for gap in gaps), default=0.0)


def _farthest(moved: Floats) -> float:
    return float(np.linalg.norm(moved, axis=-1).max(initial=0.0))


def _scale_of(largest: float, size: float, share: float) -> float:
    """Return the factor, 1 at least, with which the largest displacement takes that share of the size."""
    return max(1.0, nice(share * size / largest)) if largest > 1e-9 * size else 1.0


def _checked(scale: float) -> float:
    if not 0 < scale <= STYLE.largest_scale:
        what = f"must be positive and at most {STYLE.largest_scale:g}, got {scale:g}"
        raise InvalidParameter(what, where="scale")
    return float(scale)


def _angles(arm: Arm, angles: Floats, driven: Iterable[str] = ()) -> str:
    """Return the drive angles in words, without joints that follow in loops."""
    follow = following_joints(arm, (), tuple(driven)) if arm.closures else ()
    if not np.any(angles):
        return "all drives at 0"
    told = [
        f"{joint.name} {number(float(angle))} {'rad' if joint.type == 'revolute' else 'm'}"
        for joint, angle in zip(arm.joints, angles, strict=True)
        if joint.moves and joint.name not in follow
    ]
    return "drives at " + ", ".join(told) if told else ""
