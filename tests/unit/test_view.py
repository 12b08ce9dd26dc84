"""Claims about pictures of arms: bones lie where the model's points are, and a page draws without network."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from arms import TUBE, beam, fixed, hinge, point, rigid
from arms import arm as arm_of
from browser import needs_chromium, visit
from matplotlib.text import Text

import flexarm
from flexarm import Arm
from flexarm.cli.run import run as command
from flexarm.errors import InvalidFile, InvalidParameter
from flexarm.viewer import page as pages
from flexarm.viewer import view
from flexarm.viewer.scene import placed
from flexarm.viewer.skeleton import Skeleton
from flexarm.viewer.solids import ball, box, hung, rod
from flexarm.viewer.stages import of_arm, of_modes, of_simulation, of_statics

EXAMPLES = Path(__file__).parents[2] / "examples"


def an_arm(stiffness: float = 2e4, **more) -> Arm:
    tables = {
        "name": "two links",
        "joints": [hinge("shoulder", "upper"), hinge("elbow", "lower", "upper", at="end")],
        "links": [beam("upper", [0, 0, 1.0], TUBE), beam("lower", [0, 0, 0.8], TUBE)],
        "payloads": [{"name": "load", "link": "lower", "position": [0, 0.05, 0.8], "mass": 10.0}],
        "points": [{"name": "tip", "link": "lower", "position": [0, 0, 0.8]}],
        "effects": [{"name": "joint_compliance", "at": "elbow", "stiffness": stiffness, "damping": 20}],
    }
    return Arm.from_dict({**tables, **more})


POSE = {"shoulder": 0.7, "elbow": 0.9}


@pytest.fixture(scope="module")
def run():
    drive = flexarm.Drive.from_samples(
        [0, 0.2, 0.4, 0.6], {"shoulder": [0, 0.3, 0.5, 0.5], "elbow": [0.9, 0.7, 0.6, 0.6]}
    )
    return flexarm.simulate(an_arm(), drive)


def test_bones_of_an_equilibrium_lie_at_its_points_and_displacements_scale():
    found = flexarm.static(an_arm(), POSE, forces={"tip": [0, 40.0, 0]})
    bone = Skeleton(found.arm).points["tip"]
    for scale in (1.0, 30.0):
        x = of_statics(found, scale).clips[0].poses.x[0, bone]
        rigid_place = (found.position - found.displacement)[0]
        assert np.allclose(x, rigid_place + scale * found.displacement[0], atol=1e-9)


def test_bones_on_a_link_of_another_length_lie_where_its_points_are():
    """Points keep their fraction of a link that is 2 cm longer, and a reflector its offset from there."""
    longer = {"name": "link_length", "at": "lower", "error": 0.02}
    shifted = {"name": "reflector_offset", "at": "tip", "offset": [0.0, 0.01, 0.02]}
    effects = [{"name": "joint_compliance", "at": "elbow", "stiffness": 2e4}, longer, shifted]
    found = flexarm.static(an_arm(effects=effects), POSE)
    skeleton, poses = Skeleton(found.arm), of_statics(found, 1.0).clips[0].poses
    assert poses.x[0, skeleton.points["tip"]] == pytest.approx(found.position[0], abs=1e-4)
    end = poses.x[0, skeleton.along["lower"][-1]] + poses.R[0, skeleton.along["lower"][-1]] @ [0, 0.01, 0.02]
    assert end == pytest.approx(found.position[0], abs=1e-4)
    load = poses.x[0, skeleton.loads["load"]] - poses.x[0, skeleton.along["lower"][-1]]
    assert np.linalg.norm(load) == pytest.approx(0.05, abs=1e-9)


def test_a_run_that_begins_in_motion_is_drawn_so():
    """Made again from rest, the tip would be centimetres off."""
    time = np.linspace(0, 0.6, 61)
    swing = flexarm.Drive.from_samples(time, {"shoulder": 0.5 * np.sin(4 * time), "elbow": 0.9 - time})
    moving = flexarm.simulate(an_arm(), replace(swing, rates={}))
    bone = Skeleton(moving.arm).points["tip"]
    scene = of_simulation(moving)
    times = np.searchsorted(moving.time, scene.clips[0].time)
    assert scene.clips[0].poses.x[:, bone] == pytest.approx(moving.position[times, 0], abs=1e-5)
    assert not [note for note in scene.notes if "made again" in note]


def test_a_held_crane_is_drawn_in_a_run_as_it_is_at_rest():
    """Displacements of both are from the rigid crane whose loop the driven piston closes."""
    arm = Arm.from_toml(EXAMPLES / "crane.toml")
    rest = flexarm.static(arm, {"piston": 0.211})
    held = flexarm.Drive.from_samples(np.linspace(0, 0.1, 11), {"piston": np.full(11, 0.211)})
    run = flexarm.simulate(arm, held, step=5e-3)
    scenes = [of_statics(rest, 10.0), of_simulation(run, 10.0)]
    bone = Skeleton(arm).points[rest.points[0]]
    at_rest, moving = (scene.clips[0].poses.x[0, bone] for scene in scenes)
    assert moving == pytest.approx(at_rest, abs=1e-6)
    assert any("drives at piston 0.211 m" in note for note in scenes[0].notes)


def test_each_joint_of_several_loops_moves_alone_from_where_the_arm_stands():
    """Other cylinders stay where they are stated; a sweep is halved until its loop closes."""
    arm = Arm.from_toml(EXAMPLES / "excavator" / "excavator.toml")
    scene = of_arm(arm, {"boom_piston": 0.6, "stick_piston": 0.7})
    rest, *moved = scene.clips
    assert [clip.name for clip in moved] == [joint.name for joint in arm.moving_joints]
    for clip in moved:
        assert np.allclose(clip.poses.x[0], rest.poses.x[0], atol=1e-9), clip.name
        assert np.ptp(clip.poses.x, axis=0).max() > 0.1


def test_a_record_of_poses_tells_how_one_is_seen(tmp_path, capsys):
    an_arm().to_toml(tmp_path / "arm.toml")
    head = 'format = "flexarm-record/1"\nkind = "static"\ndrive = ["shoulder"]\n'
    head += '[[signals]]\nname = "shoulder"\nquantity = "joint_angle"\njoint = "shoulder"\n'
    head += 'side = "motor"\nfile = "a.csv"\npose = "pose"\n'
    (tmp_path / "record.toml").write_text(head + 'channels = ["q"]\n')
    (tmp_path / "a.csv").write_text("pose,q\n1,0.1\n2,0.3\n")
    given = ["view", str(tmp_path), "--model", str(tmp_path / "arm.toml"), "--out", str(tmp_path / "p.html")]
    assert command(given) == 2
    assert "see one by flexarm view MODEL --joint NAME=VALUE" in capsys.readouterr().err


def test_a_page_is_not_written_into_a_picture(tmp_path):
    with pytest.raises(InvalidFile, match=r"must end in \.html or \.htm, got '\.png'"):
        an_arm().view().save(tmp_path / "arm.png")
    assert not (tmp_path / "arm.png").exists()


def test_a_stored_equilibrium_is_drawn_as_before(tmp_path):
    found = flexarm.static(an_arm(), POSE, forces={"tip": [0, 40.0, 0]}, at_link=["elbow"])
    found.save(tmp_path / "static.nc")
    again = flexarm.Statics.load(tmp_path / "static.nc")
    ours, theirs = (of_statics(each).clips[0].poses.x for each in (found, again))
    assert np.allclose(ours, theirs, atol=1e-12)


def test_a_beam_is_drawn_with_its_section_along_its_deformed_centre_line():
    found = flexarm.static(an_arm(), POSE)
    scene = of_statics(found, 1.0)
    skin = next(skin for skin in scene.skins if skin.name == "lower" and skin.layer == "beams")
    corners = placed(skin, scene.clips[0].poses, 0)
    from_tip = np.linalg.norm(corners - found.position[0], axis=1)
    assert from_tip.min() == pytest.approx(TUBE["outer_diameter"] / 2, rel=1e-9)
    length = np.linalg.norm(corners.max(axis=0) - corners.min(axis=0))
    assert length == pytest.approx(0.8, rel=0.1)


def test_a_sliding_joint_is_drawn_as_long_as_its_stroke():
    """Oblique axis and origin: the rod ends at the frames of the joint and of its child."""
    slide = {
        "name": "slide",
        "type": "prismatic",
        "parent": "base",
        "child": "rod",
        "origin": {"xyz": [0.2, -0.1, 0.3], "rpy": [0.3, -0.4, 0.5]},
        "axis": [0, 0, 1],
    }
    arm = Arm.from_dict(
        {"joints": [slide], "links": [rigid("rod", 2.0)], "points": [point("eye", "rod", [0, 0, 0])]}
    )
    found = flexarm.static(arm, {"slide": 0.4})
    scene = of_statics(found, 1.0)
    skin = next(skin for skin in scene.skins if skin.name == "slide stroke")
    corners = placed(skin, scene.clips[0].poses, 0)
    base = np.array(slide["origin"]["xyz"])
    along = (found.position[0] - base) / 0.4
    assert np.linalg.norm(along) == pytest.approx(1.0)
    reach = np.unique(np.round((corners - base) @ along, 9))
    assert reach == pytest.approx([0.0, 0.4], abs=1e-9)


def test_bones_of_a_run_lie_at_its_points(run):
    scene = of_simulation(run)
    clip, bone = scene.clips[0], Skeleton(run.arm).points["tip"]
    assert clip.time[[0, -1]] == pytest.approx([run.time[0], run.time[-1]])
    there = run.at(clip.time, "tip")
    assert np.allclose(clip.poses.x[:, bone], there, atol=1e-9)
    assert scene.notes[0] == "true speed"


def test_what_gives_most_of_a_mode_is_named():
    soft, stiff = (of_modes(flexarm.modes(an_arm(k), POSE, count=1)).clips[0].text for k in (2e3, 1e9))
    assert "joint elbow" in soft
    assert "bending of" in stiff


def test_the_table_of_modes_tells_what_moves(tmp_path, capsys):
    an_arm(2e3).to_toml(tmp_path / "arm.toml")
    asked = ["modes", str(tmp_path / "arm.toml"), "--joint", "shoulder=0.7", "--joint", "elbow=0.9"]
    assert command(asked) == 0
    _, head, first, *_ = capsys.readouterr().out.splitlines()
    assert head.endswith("moves most")
    assert "joint elbow" in first and "motion" in first
    stiff = Arm.from_dict(
        {"links": [rigid("hand", 1.0, inertia=[1, 1, 1])], "joints": [hinge("wrist", "hand")]}
    )
    stiff.to_toml(tmp_path / "stiff.toml")
    assert command(["modes", str(tmp_path / "stiff.toml")]) == 0
    assert "none, as nothing with mass can vibrate" in capsys.readouterr().out


def test_modes_play_about_the_equilibrium_of_their_pose():
    found = flexarm.modes(an_arm(), POSE, count=2)
    clip = of_modes(found).clips[1]
    bone = Skeleton(found.arm).points["tip"]
    assert clip.poses.x[0, bone] == pytest.approx(flexarm.static(an_arm(), POSE).position[0], abs=1e-9)
    moved = clip.poses.x[8, bone] - clip.poses.x[0, bone]
    assert abs(moved @ found.shape[1, 0, :3]) == pytest.approx(
        np.linalg.norm(moved) * np.linalg.norm(found.shape[1, 0, :3]), rel=1e-6
    )


def test_what_turns_in_a_mode_keeps_its_shape():
    """A wrist's mode turns a hand far before its load moves far: the load stays at its distance, to second
    order of the turn, sqrt(1 + 0.4^2) - 1 = 8 %.
    """
    arm = Arm.from_dict(
        {
            "joints": [
                hinge("shoulder", "boom"),
                {**hinge("wrist", "hand", "boom", at="end"), "axis": [0, 0, 1]},
            ],
            "links": [beam("boom", [0, 0, 4.0], TUBE), rigid("hand", 5.0, [0, 0, 0.1], [0.1, 0.1, 0.1])],
            "points": [point("wrist", "hand", [0, 0, 0]), point("load", "hand", [0.25, 0, 0.3])],
            "payloads": [{"name": "load", "link": "hand", "position": [0.25, 0, 0.3], "mass": 20.0}],
            "effects": [{"name": "joint_compliance", "at": "wrist", "stiffness": 3e4}],
        }
    )
    scene, bones = of_modes(flexarm.modes(arm, count=6)), Skeleton(arm).points
    for clip in scene.clips:
        away = np.linalg.norm(clip.poses.x[:, bones["load"]] - clip.poses.x[:, bones["wrist"]], axis=1)
        assert away == pytest.approx(away[0], rel=0.08), clip.text


def test_measured_points_stand_off_by_the_gap(tmp_path, run):
    from flexarm.measurement import measure
    from flexarm.record import Signal

    assert measure is not None
    time = np.linspace(0.05, 0.55, 26)
    shift = np.array([0.003, 0.0, -0.002])
    angles = {
        name: Signal(
            name=name,
            quantity="joint_angle",
            joint=name,
            time=run.time,
            unit="rad",
            noise_std=1e-7,
            values=run.drive_angle[:, [i]],
        )
        for i, name in enumerate(run.joints)
    }
    tip = Signal(
        name="tip",
        quantity="position",
        point="tip",
        time=time,
        values=run.at(time, "tip") + shift,
        unit="m",
        noise_std=1e-5,
    )
    record = flexarm.Record(signals=[*angles.values(), tip], drive=tuple(angles))
    scene = run.view(record).scene
    clip = scene.clips[0]
    bones = [skin.bone[0, 0] for skin in scene.skins if skin.layer == "measured" and skin.name == "tip"]
    tip_bone = Skeleton(run.arm).points["tip"]
    away = clip.poses.x[:, bones[0]] - clip.poses.x[:, tip_bone]
    inside = (clip.time > 0.06) & (clip.time < 0.54)
    times = float(next(note for note in scene.notes if "gaps" in note).split("× ")[1])
    assert np.allclose(away[inside], times * shift, atol=times * 2e-6)
    assert np.isnan(away[0]).all()  # before the first row nothing is shown


def test_rigid_motion_does_not_deform_a_part_between_its_interfaces():
    rng = np.random.default_rng(3)
    surface = ball(0.3)
    positions = rng.normal(size=(3, 3))
    skin = hung(surface, [0, 1, 2], positions, np.stack([np.eye(3)] * 3), "super-elements", "hub", "#000000")
    from flexarm.viewer.skeleton import Poses

    R = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    R *= np.linalg.det(R)
    poses = Poses(np.stack([[R] * 3]), (positions @ R.T + 1.0)[None])
    assert np.allclose(placed(skin, poses, 0), surface.corners @ R.T + 1.0, atol=1e-12)


@pytest.mark.parametrize(
    "surface", [ball(0.5), box(np.array([1.0, 2, 3])), rod(np.zeros(3), np.ones(3), 0.2)]
)
def test_faces_look_outwards(surface):
    a, b, c = (surface.corners[surface.faces[:, k]] for k in range(3))
    normal, away = np.cross(b - a, c - a), (a + b + c) / 3 - surface.corners.mean(axis=0)
    assert (np.sum(normal * away, axis=1) >= -1e-12).all()


def test_meshes_of_a_urdf_stand_in_their_links(tmp_path):
    trimesh = pytest.importorskip("trimesh")
    trimesh.creation.box(extents=(1, 2, 3)).export(tmp_path / "block.stl")
    (tmp_path / "robot.urdf").write_text(
        """<robot name="r"><link name="world"/>
        <link name="arm"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
        </inertial><visual><origin xyz="0 0 0.5" rpy="0 0 0"/><geometry>
        <mesh filename="package://r/block.stl" scale="0.1 0.1 0.1"/></geometry></visual></link>
        <joint name="turn" type="continuous"><parent link="world"/><child link="arm"/>
        <axis xyz="0 0 1"/></joint>
        </robot>"""
    )
    assert command(["view", str(tmp_path / "robot.urdf"), "--out", str(tmp_path / "robot.html")]) == 0
    arm = Arm.from_toml(tmp_path / "robot.urdf")
    skins = arm.view(urdf=tmp_path / "robot.urdf").scene.skins
    body = next(skin for skin in skins if skin.layer == "rigid links")
    assert np.ptp(body.place[:, 0], axis=0) == pytest.approx([0.1, 0.2, 0.3])
    assert body.place[:, 0].mean(axis=0) == pytest.approx([0, 0, 0.5])


def test_plain_pictures_draw_arms_and_name_modes(run):
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    axes = flexarm.static(an_arm(), POSE).plot()
    assert "displacements ×" in axes.get_title()
    assert len(axes.collections) > 8  # surfaces, no dots
    first = flexarm.modes(an_arm(), POSE, count=4).plot()
    titles = [each.get_title() for each in first.figure.axes[:4]]
    assert all("Hz" in title and "motion" in title for title in titles)
    assert an_arm().plot().get_xlabel() == "x [m]"
    assert len(run.plot("tip").lines) == 3
    with pytest.raises(InvalidParameter, match="point: there is no point 'top'; there are tip"):
        run.plot("top")
    plt.close("all")


def reacher() -> Arm:
    """A column that turns, a boom along x that is lifted, and a heavy tool."""
    wide = {"shape": "rectangle", "width": 0.08, "height": 0.12, "thickness": 0.004}
    return arm_of(
        joints=[
            hinge("slew", "post", axis=[0, 0, 1]),
            hinge("pitch", "outer", "post", at="end", axis=[0, -1, 0]),
        ],
        links=[beam("post", [0, 0, 0.9], TUBE), beam("outer", [2.6, 0, 0], wide, up=[0, 0, 1])],
        payloads=[
            {"name": "tool_changer_with_a_camera", "link": "outer", "position": [2.6, 0, 0], "mass": 8.0}
        ],
        points=[point("tip", "outer", [2.6, 0, 0])],
    )


def test_an_arm_in_space_is_drawn_along_its_reach():
    """Slewing moves its end along y, lifting along z; it reaches 2.6 m along x."""
    axes = reacher().plot()
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x [m]", "z [m]")


def test_each_mode_is_drawn_in_a_plane_in_which_it_moves():
    """Motion mainly along y must show, however small its amplitude is drawn."""
    found = flexarm.modes(reacher(), {"pitch": 0.4}, count=6)
    drawn = {}
    for panel in found.plot().figure.axes:
        title = panel.get_title().replace("\n", " ")
        if "mainly" in title:
            drawn[title] = title[-1] in panel.get_xlabel()[0] + panel.get_ylabel()[0]
    assert len(drawn) > 3 and all(drawn.values())


@pytest.mark.parametrize("count", [1, 3, 7])
def test_names_in_a_picture_cover_none_of_each_other(count):
    links = [f"link_{k}" for k in range(count)]
    ends = {name: [0, 0, 0.35 if k % 2 else 0.05] for k, name in enumerate(links)}
    arm = Arm.from_dict(
        {
            "name": f"{count} joints",
            "joints": [hinge("joint_0", links[0])]
            + [hinge(f"joint_{k}", links[k], links[k - 1], at="end") for k in range(1, count)],
            "links": [beam(name, end, TUBE) for name, end in ends.items()],
            "points": [point(f"target_{k}", name, ends[name]) for k, name in enumerate(links)],
            "payloads": [
                {"name": name, "link": links[-1], "position": [0, 0, 0], "mass": 2} for name in "ab"
            ],
        }
    )
    axes = arm.plot(joints={joint.name: 0.4 for joint in arm.moving_joints})
    axes.figure.draw_without_rendering()
    boxes = [Text.get_window_extent(name) for name in axes.texts]
    assert len(boxes) == 2 * count + 2
    assert not any(one.overlaps(other) for k, one in enumerate(boxes) for other in boxes[:k])


def test_a_missing_extra_names_the_command_that_installs_it(monkeypatch):
    monkeypatch.setattr(pages, "find_spec", lambda name: None)
    with pytest.raises(InvalidParameter, match=r"pip install 'flexarm\[view\]'"):
        _ = an_arm().view().html


def test_a_record_without_one_model_beside_it_asks_for_it(tmp_path, capsys, run):
    run.arm.to_toml(tmp_path / "arm.toml")
    (tmp_path / "swing.csv").write_text("time_s,elbow\n0,0.9\n0.1,0.8\n0.2,0.7\n")
    asked = ["simulate", str(tmp_path / "arm.toml"), "--drive", str(tmp_path / "swing.csv"), "--out"]
    assert command([*asked, str(tmp_path / "run")]) == 0
    view_it = ["view", str(tmp_path / "run" / "record.toml"), "--out", str(tmp_path / "page.html")]
    (tmp_path / "run" / "simulation.nc").unlink()
    (tmp_path / "arm.toml").rename(tmp_path / "a.toml")
    run.arm.to_toml(tmp_path / "b.toml")
    assert command(view_it) == 2
    assert "model: is not clear: beside the record stand" in capsys.readouterr().err
    for name in ("a.toml", "b.toml"):
        (tmp_path / name).unlink()
    assert command(view_it) == 2
    assert "is not stated, and no model stands beside the record; --model names it" in capsys.readouterr().err


def test_the_command_shows_models_runs_and_records(tmp_path, capsys, run):
    arm = an_arm()
    arm.to_toml(tmp_path / "arm.toml")
    out = tmp_path / "page.html"
    assert command(["view", str(tmp_path / "arm.toml"), "--joint", "elbow=0.5", "--out", str(out)]) == 0
    assert "<title>two links: model</title>" in out.read_text()
    assert command(["view", str(tmp_path / "arm.toml"), "--out", str(out)]) == 2
    assert "exists already" in capsys.readouterr().err
    (tmp_path / "swing.csv").write_text("time_s,elbow\n0,0.9\n0.1,0.8\n0.2,0.7\n0.3,0.7\n")
    simulate = ["simulate", str(tmp_path / "arm.toml"), "--drive", str(tmp_path / "swing.csv"), "--out"]
    assert command([*simulate, str(tmp_path / "run")]) == 0
    for name in ("run", "run/simulation.nc", "run/record.toml"):  # the model is beside the record
        assert command(["view", str(tmp_path / name), "--out", str(out), "--force"]) == 0
        assert "<title>two links: run of 0.3 s" in out.read_text() or "gaps measured" in out.read_text()
    (tmp_path / "part.inp").write_text("")
    assert command(["view", str(tmp_path / "part.inp"), "--out", str(out), "--force"]) == 2
    assert command(["view", str(tmp_path / "arm.toml"), "--scale", "-1"]) == 2


@pytest.mark.parametrize(
    ("file", "name", "said"),
    [
        ("comparison.json", "", "is of `flexarm compare`, whose gap-NAME.png show the gap"),
        ("comparison.json", "gap-tip.csv", "is of `flexarm compare`, whose gap-NAME.png show the gap"),
        ("calibration.json", "gaps.nc", "is of `flexarm calibrate`, whose report.html shows it"),
        ("notes.txt", "", "holds no report.json, simulation.nc or record.toml, which are shown"),
    ],
)
def test_results_without_a_page_tell_where_they_are_seen(file, name, said, tmp_path, capsys):
    for each in {file, name} - {""}:
        (tmp_path / each).write_text("")
    assert command(["view", str(tmp_path / name), "--out", str(tmp_path / "page.html")]) == 2
    assert said in capsys.readouterr().err


def test_only_what_has_a_picture_is_shown():
    with pytest.raises(InvalidParameter, match="view: must be one of Arm, Statics"):
        view(3.0)
    for scale in (-1.0, 0.0, 1e300, float("nan")):
        with pytest.raises(InvalidParameter, match="scale: must be positive and at most 1e\\+12"):
            flexarm.static(an_arm()).view(scale=scale)
    assert np.isfinite(of_statics(flexarm.static(an_arm()), 1e12).clips[0].poses.x).all()


def test_rigid_arms_on_fixed_joints_are_drawn():
    arm = an_arm(
        joints=[fixed("foot", "post"), hinge("shoulder", "upper", "post", origin={"xyz": [0, 0, 0.4]})],
        links=[rigid("post", 5.0, com=[0, 0, 0.2]), beam("upper", [0, 0, 1.0], TUBE)],
        payloads=[],
        points=[{"name": "tip", "link": "upper", "position": [0, 0, 1.0]}],
        effects=[],
    )
    scene = arm.view().scene
    post = next(skin for skin in scene.skins if skin.name == "post" and skin.layer == "rigid links")
    assert post.place[..., 2].max() == pytest.approx(0.4, abs=0.02)


def test_a_result_of_an_older_version_says_what_to_do():
    from dataclasses import replace

    with pytest.raises(InvalidParameter, match="modes: were stored without the pose"):
        replace(flexarm.modes(an_arm(), count=1), drive_angle=None).view()


def test_a_file_is_named_where_a_page_cannot_be_written(tmp_path):
    with pytest.raises(InvalidFile, match="directory that exists"):
        an_arm().view().save(tmp_path / "absent" / "page.html")


@needs_chromium
def test_a_page_draws_and_its_slider_moves_the_arm_without_network(tmp_path, run):
    run.view(scale=1.0).save(tmp_path / "run.html")
    seen = {}

    async def look(page):
        seen["start"] = await page.picture()
        slide = (
            "const s = document.getElementById('slider'); s.value = {}; s.dispatchEvent(new Event('input'))"
        )
        await page.run(f"{{ {slide.format(0.5)} }}")
        seen["later"] = await page.picture()
        await page.run(f"{{ {slide.format(0.0)} }}")
        seen["again"] = await page.picture()
        seen["clock"] = await page.run("document.getElementById('clock').textContent")

    page = visit(tmp_path / "run.html", tmp_path / "profile", look, "#t=0")
    assert not page.errors
    assert [url for url in page.requests if not url.startswith(("file:", "data:", "blob:"))] == []
    assert seen["clock"] == "0.00 / 0.60 s"

    def blue(pixels):  # of the beams; panels and slider left out
        pane = pixels[:-80, 380:]
        return (pane[..., 2] > pane[..., 0] + 0.25) & (pane[..., 2] > 0.4)

    start, later, again = (blue(seen[name]) for name in ("start", "later", "again"))
    assert start.sum() > 500
    assert (start ^ later).sum() > 0.5 * start.sum()
    assert (start ^ again).sum() < 0.02 * start.sum()


@needs_chromium
def test_names_lie_inside_the_window(tmp_path):
    """The tool is near the right edge; its name stands left of it there."""
    reacher().view().save(tmp_path / "arm.html")
    seen = {}

    async def look(page):
        seen["beyond"] = await page.run(
            "[...document.querySelectorAll('.label')].filter(e => e.getBoundingClientRect().right >"
            " window.innerWidth).map(e => e.textContent).join()"
        )
        seen["names"] = await page.run("document.querySelectorAll('.label').length")

    visit(tmp_path / "arm.html", tmp_path / "profile", look)
    assert seen["names"] > 3
    assert seen["beyond"] == ""


@needs_chromium
def test_what_a_notebook_gets_is_the_page_in_a_frame(tmp_path):
    (tmp_path / "cell.html").write_text(
        f"<body>{an_arm().view()._repr_html_()}<script>window.flexarm = 1</script></body>"
    )
    seen = {}

    async def look(page):
        seen["inside"] = await page.run(
            "new Promise(done => setTimeout(() => done(document.querySelector('iframe').contentWindow"
            ".flexarm !== undefined), 1500))"
        )

    page = visit(tmp_path / "cell.html", tmp_path / "profile", look)
    assert seen["inside"]
    assert not page.errors


def test_a_mode_that_twists_is_named_and_turns_what_is_drawn():
    """A shaft with a disc at its end: 1/2pi sqrt(GJ/(L I)) of the twist lies below its bending."""
    disc = {"name": "disc", "link": "shaft", "position": [2, 0, 0], "mass": 5.0, "inertia": [20, 10, 10]}
    arm = arm_of(
        joints=[hinge("hinge", "shaft")],
        links=[beam("shaft", [2, 0, 0], {"shape": "tube", "outer_diameter": 0.06, "thickness": 3e-3})],
        payloads=[disc],
        points=[point("tip", "shaft", [2, 0, 0])],
    )
    found = flexarm.modes(arm, count=2)
    scene = of_modes(found)
    assert "twist of shaft" in scene.clips[0].text
    assert "bending of shaft" in scene.clips[1].text
    bars = [skin for skin in scene.skins if " outrigger " in skin.name and skin.layer == "beams"]
    for axis in (1, 2):  # as seen along z and along y
        spans = [
            [np.ptp(placed(skin, scene.clips[0].poses, frame)[:, axis]) for skin in bars] for frame in (0, 8)
        ]
        change = np.array(spans[1]) / spans[0]
        assert change[0] == pytest.approx(1.0, abs=0.01)
        assert abs(change[-1] - 1) > 0.2
    assert found.plot(mode=1).get_title().endswith("twist of shaft")


def test_notebooks_show_summaries(tmp_path):
    """Models, results and records, in letters of one width; `<` and `>` are no tags."""
    arm = an_arm()
    found = flexarm.static(arm)
    record = flexarm.measure(
        flexarm.simulate(arm, flexarm.Drive({}, end=0.1)),
        [flexarm.Sensor(name="tip", quantity="position", point="tip", rate_hz=50)],
        np.random.default_rng(1),
    )
    assert found._repr_html_().startswith("<pre>") and "mm" in found._repr_html_()
    assert f"{len(arm.joints)} " in arm._repr_html_() and "joint " in arm._repr_html_()
    assert "&lt;Signal &#x27;tip&#x27;: position at tip" in record._repr_html_()
