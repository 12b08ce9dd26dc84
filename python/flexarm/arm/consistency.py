"""Consistency of the parts of a model: names, references, the tree of joints."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import TYPE_CHECKING, Any

from flexarm.arm.joint import Gear, Joint, coupled_joints
from flexarm.arm.link import Beam, SuperElementLink
from flexarm.arm.names import link_of
from flexarm.arm.vocabulary import places
from flexarm.tables.field import Path

if TYPE_CHECKING:
    from flexarm.arm.arm import Arm
    from flexarm.arm.closure import Closure
    from flexarm.arm.effect import Effect

Found = Iterable[tuple[Path, str]]


def inconsistencies(arm: Arm) -> list[tuple[Path, str]]:
    """Return pairs of place and sentence for all that does not fit."""
    found = [*_duplicates(arm), *_joint_ends(arm)]
    found += [] if found else [*_tree(arm)]
    found += _closures(arm)
    found += [*_gears(arm), *_attachments(arm), *_sensors(arm), *_encoders(arm)]
    return [*found, *_drives(arm), *_effects(arm)]


def missing(kind: str, name: str, known: Iterable[str]) -> str:
    """Sentence on a name that nothing has, with those that exist, of many the first."""
    # Names in one message: enough for an arm; a thousand errors that list a thousand names nobody reads.
    most_listed = 50
    names = list(known)
    listed = ", ".join(names[:most_listed])
    if len(names) > most_listed:
        listed += f" and {len(names) - most_listed} more"
    return f"there is no {kind} {name!r}; " + (
        f"there are {listed}" if listed else f"the model has no {kind}s"
    )


def _duplicates(arm: Arm) -> Found:
    for table in ("joints", "gears", "links", "payloads", "points", "sensors", "closures"):
        seen: set[str] = set()
        for i, entry in enumerate(getattr(arm, table)):
            if entry.name in seen:
                yield (table, i, "name"), f"{entry.name!r} is used twice; names within {table} must differ"
            seen.add(entry.name)
    for table in ("motors", "controllers"):
        of: set[str] = set()
        for i, entry in enumerate(getattr(arm, table)):
            if entry.joint in of:
                yield (table, i, "joint"), f"joint {entry.joint!r} has two {table}; it can have one"
            of.add(entry.joint)
    for i, link in enumerate(arm.links):
        if link.name == "base":
            yield ("links", i, "name"), '"base" is the ground and cannot be the name of a link'


def _joint_ends(arm: Arm) -> Found:
    links = {link.name: link for link in arm.links}
    for i, joint in enumerate(arm.joints):
        for end in ("parent", "child"):
            place = getattr(joint, end)
            name = link_of(place)
            if name == "base" and end == "parent":
                continue
            if name not in links:
                yield ("joints", i, end), missing("link", name, links)
            elif ":" in place and not isinstance(links[name], SuperElementLink):
                what = f"{place!r}: only a super-element has interfaces, {name!r} is a {links[name].type}"
                yield ("joints", i, end), what
            elif ":" not in place and isinstance(links[name], SuperElementLink):
                what = f"must name an interface of the super-element, as {name}:INTERFACE, got {place!r}"
                yield ("joints", i, end), what
        parent = links.get(link_of(joint.parent))
        if joint.at == "end" and not isinstance(parent, Beam):
            yield ("joints", i, "at"), f'"end" needs a beam as parent, got {joint.parent!r}'


def _tree(arm: Arm) -> Found:
    """Yield links that do not hang on the base through exactly one chain of joints."""
    holder: dict[str, Joint] = {}
    for i, joint in enumerate(arm.joints):
        child = link_of(joint.child)
        if child == link_of(joint.parent):
            yield ("joints", i, "child"), f"joins {child!r} to itself"
        elif child in holder:
            what = (
                f"link {child!r} is already the child of joint {holder[child].name!r}; "
                "joints must form a tree; a table [[closures]] closes a loop"
            )
            yield ("joints", i, "child"), what
        holder.setdefault(child, joint)
    held: set[str] = set()
    for i, link in enumerate(arm.links):
        if link.name not in holder:
            yield ("links", i), f"no joint has link {link.name!r} as its child; every link hangs on a joint"
        elif loop := _loop_above(link.name, holder, held):
            yield ("links", i), f"hangs on itself and not on the base: {' <- '.join(loop)}"


def _loop_above(link: str, holder: dict[str, Joint], held: set[str]) -> list[str]:
    """Return the chain from a link to one met twice; empty if it ends at the base or at a loose link.

    Links without a loop above them are added to `held`, where the walks of later links end.
    """
    chain: dict[str, None] = {link: None}
    while link in holder and link not in held:
        link = link_of(holder[link].parent)
        if link in chain:
            return [*chain, link]
        chain[link] = None
    held.update(chain)
    return []


def _gears(arm: Arm) -> Found:
    joints = {joint.name: joint for joint in arm.joints}
    for i, gear in enumerate(arm.gears):
        for end in ("input", "output"):
            name = getattr(gear, end)
            if name not in joints:
                yield ("gears", i, end), missing("joint", name, joints)
            elif not joints[name].moves:
                yield ("gears", i, end), f"joint {name!r} is fixed; a gear couples joints that move"
        output = joints.get(gear.output)
        if output is not None and output.gear_ratio != 1:
            what = (
                f"joint {gear.output!r} has gear_ratio = {output.gear_ratio:g} already; "
                "give either the gear or the joint's gear_ratio"
            )
            yield ("gears", i, "output"), what
    yield from _coupled_twice(arm)


def _coupled_twice(arm: Arm) -> Found:
    """Yield gears that couple two joints by a second path, which repeats the first or contradicts it."""
    input_of: dict[str, Gear] = {}
    for i, gear in enumerate(arm.gears):
        others = arm.gears[:i]
        if first := input_of.get(gear.output):
            yield (
                ("gears", i, "output"),
                f"joint {gear.output!r} is the output of gear {first.name!r} (ratio {first.ratio:g}) "
                f"already, got ratio {gear.ratio:g}; a joint has one input",
            )
        elif gear.output in coupled_joints([gear.input], others):
            names = ", ".join(repr(other.name) for other in others)
            yield (
                ("gears", i, "output"),
                f"joints {gear.input!r} and {gear.output!r} are coupled already by gears before it "
                f"({names}); gears must not form a loop",
            )
        input_of.setdefault(gear.output, gear)


def _attachments(arm: Arm) -> Found:
    links = {link.name: link for link in arm.links}
    for table in ("payloads", "points"):
        for i, entry in enumerate(getattr(arm, table)):
            name = link_of(entry.link)
            if name not in links:
                yield (table, i, "link"), missing("link", name, links)
            elif (":" in entry.link) != isinstance(links[name], SuperElementLink):
                wanted = "LINK:INTERFACE" if isinstance(links[name], SuperElementLink) else "LINK"
                what = f"must be {wanted} as {name!r} is a {links[name].type}, got {entry.link!r}"
                yield (table, i, "link"), what


def _closures(arm: Arm) -> Found:
    """Yield closures, and poses of assembly, that do not fit the arm."""
    links = {link.name: link for link in arm.links}
    for i, closure in enumerate(arm.closures):
        for end in ("a", "b"):
            place, at = getattr(closure, end), getattr(closure, f"{end}_at")
            name = link_of(place)
            if name != "base" and name not in links:
                yield ("closures", i, end), missing("link", name, links)
            elif (":" in place) != isinstance(links.get(name), SuperElementLink):
                wanted = "LINK:INTERFACE" if isinstance(links.get(name), SuperElementLink) else "LINK"
                yield ("closures", i, end), f"must be {wanted}, got {place!r}"
            elif at == "end" and not isinstance(links.get(name), Beam):
                yield ("closures", i, f"{end}_at"), f'"end" needs a beam, got {place!r}'
        if link_of(closure.a) == link_of(closure.b):
            what = f"is on {link_of(closure.b)!r} as a is; a closure ties two links, or a link and the base"
            yield ("closures", i, "b"), what
    joints = {joint.name for joint in arm.joints}
    for i, closure in enumerate(arm.closures):
        if closure.name in joints:
            yield (("closures", i, "name"), f"{closure.name!r} is the name of a joint; the two must differ")
    moving = {joint.name: None for joint in arm.joints if joint.moves}
    for name in arm.assembly:
        if name not in moving:
            yield ("assembly", name), missing("moving joint", name, moving)
    if arm.assembly and not arm.closures:
        yield ("assembly",), "says where joints stand when loops are closed, but the model has no closures"


def _sensors(arm: Arm) -> Found:
    names = {
        key: {entry.name: None for entry in getattr(arm, f"{key}s")} for key in ("joint", "point", "link")
    }
    for i, sensor in enumerate(arm.sensors):
        if sensor.spec.only_static:
            what = f"{sensor.quantity} belongs to a record of poses, it is not a sensor"
            yield ("sensors", i, "quantity"), what
        for key, known in names.items():
            name = getattr(sensor, key)
            if name is not None and name not in known:
                yield ("sensors", i, key), missing(key, name, known)


def _encoders(arm: Arm) -> Found:
    joints = {joint.name: None for joint in arm.joints}
    for signal, joint in arm.encoders.items():
        if joint not in joints:
            yield ("encoders", signal), missing("joint", joint, joints)


def _drives(arm: Arm) -> Found:
    moving = {joint.name: None for joint in arm.joints if joint.moves}
    tables: list[tuple[str, Sequence[Any]]] = [("motors", arm.motors), ("controllers", arm.controllers)]
    for table, entries in tables:
        for i, entry in enumerate(entries):
            if entry.joint not in moving:
                yield (table, i, "joint"), missing("moving joint", entry.joint, moving)
    motors = {motor.joint for motor in arm.motors}
    sensors = {sensor.name: sensor for sensor in arm.sensors}
    for i, controller in enumerate(arm.controllers):
        if controller.type != "state_feedback":
            continue
        if controller.joint not in motors:
            what = f"state feedback sets a voltage, but joint {controller.joint!r} has no motor"
            yield ("controllers", i, "joint"), what
        name = controller.deflection
        if name is not None and name not in sensors:
            yield ("controllers", i, "deflection"), missing("sensor", name, sensors)
        elif name is not None and sensors[name].quantity != "deflection":
            what = f"sensor {name!r} measures {sensors[name].quantity}, not a deflection"
            yield ("controllers", i, "deflection"), what


def _effects(arm: Arm) -> Found:
    names = {kind: places(arm, kind) for kind in {effect.place for effect in arm.effects}}
    closures = {closure.name: closure for closure in arm.closures}
    for i, effect in enumerate(arm.effects):
        known, closure = names[effect.place], closures.get(effect.at)
        at_closure = closure is not None and closure.type in effect.at_closures
        if known is None or effect.at in known or at_closure:
            yield from ((("effects", i, key), what) for key, what in effect.problems(arm))
        elif closure is not None:
            yield ("effects", i, "at"), _not_at_closure(effect, closure)
        else:
            kind = "moving joint" if effect.place == "joint" else effect.place
            yield ("effects", i, "at"), missing(kind, effect.at, known)


def _not_at_closure(effect: Effect, closure: Closure) -> str:
    """Sentence on an effect that does not act at a closure."""
    if effect.at_closures:
        return (
            f"{closure.name!r} is a {closure.type} closure; {effect.name} acts at one that is "
            + " or ".join(effect.at_closures)
        )
    return (
        f"{closure.name!r} is a closure, where {effect.name} does not act; "
        "cut the loop elsewhere, so that this is a joint of the tree"
    )
