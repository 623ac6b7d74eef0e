"""Which objects paperbake reads and by what name, as formats/scene/scene_properties.h and samples/README.md say."""

import re

SHEET, HANDLE, CLAMP, COLLIDER, CREASE, WIND = "paper", "handle", "clamp", "collider", "crease", "wind"
BAKED = "baked"  # what comes back must not be a sheet itself
ROLES = (SHEET, HANDLE, CLAMP, COLLIDER, CREASE, WIND)
NO_SHAPE = {"EMPTY", "ARMATURE", "CAMERA", "LATTICE", "LIGHT", "LIGHT_PROBE", "SPEAKER"}  # object types that nothing can collide with


def matched(name):
    """As the program matches names: without case and namespace, and with `.` `_` `-` alike. "Paper: Letter" has no namespace."""
    read = (SHEET, HANDLE, COLLIDER, CREASE, WIND)
    whole = name.lower()
    behind = whole.rsplit(":", 1)[-1]
    return re.sub(r"[_-]", ".", whole if whole.startswith(read) and not behind.startswith(read) else behind)


def begins_with(name, role):
    return matched(name).startswith(role)


def role(thing):
    """One of ROLES, or None. Colliders first: a mesh may be both by its names."""
    if thing.type == "MESH" and says_collider(thing):
        return COLLIDER
    if thing.type == "MESH" and begins_with(thing.name, SHEET):
        return SHEET
    if thing.type == "MESH" and begins_with(thing.name, CREASE):
        return CREASE
    if is_wind(thing):
        return WIND
    held = next((prefix for prefix in (HANDLE, CLAMP) if begins_with(thing.name, prefix)), None)
    return COLLIDER if held is None and up_to_group(thing) else held


def says_collider(thing):
    return bool(thing.get("paper_collider")) or begins_with(thing.name, COLLIDER)


def up_to_group(thing):
    """What is above a mesh, up to the empty that makes it a collider; nothing where none does."""
    return below_group(thing) if thing.type == "MESH" else []


def below_group(thing):
    """The same of an object of any type."""
    if "paper_collider" in thing or "paper_crease" in thing:
        return []
    above = [thing.parent]
    while above[-1] and not (above[-1].type == "EMPTY" and says_collider(above[-1])):
        above.append(above[-1].parent)
    return above if above[-1] else []


def is_wind(thing):
    """As formats/scene/scene_winds.h says: wind, wind.001, wind_left; windmill only with a speed."""
    name = matched(thing.name)
    return thing.type == "EMPTY" and name.startswith(WIND) and (not name[4:5].isalpha() or "paper_speed" in thing)


def meant_as(thing):
    """What an object without a role is named or marked as, of what only meshes can be, or None. Instances of a collection mean nothing by their own
    names: what is in the collection does."""
    if thing.type in NO_SHAPE or role(thing):
        return None
    if says_collider(thing) or below_group(thing):
        return COLLIDER
    return next((kind for kind in (SHEET, CREASE) if begins_with(thing.name, kind)), None)


def in_usd(name):
    """As formats/cache/usd_cache.cpp writes a name, but for those that would become the same."""
    legal = re.sub(r"[^0-9A-Za-z_]", "_", name)
    return f"_{legal}" if not legal or legal[0].isdigit() else legal


def of_role(scene, wanted):
    return [thing for thing in scene.objects if role(thing) == wanted]


def with_prefix(name, prefix):
    return name if begins_with(name, prefix) else f"{prefix}.{name}"


def without_prefix(name):
    """What the object was called before it was marked; "sheet", "handle"... when there was nothing else."""
    for prefix in ROLES:
        if begins_with(name, prefix):
            return name[len(prefix):].lstrip("._-") or ("sheet" if prefix == SHEET else "object")
    return name


def in_cache(name):
    """A sheet's name in the .abc."""
    return name.replace(".", "_")


LARGE = 1.0  # [m] few sheets of paper have a longer side, and Blender's own plane has one of 2 m


def sides(scene, thing):
    """Longer and shorter side of the box of a mesh, without its thinnest direction. [m]"""
    scale = scene.unit_settings.scale_length
    return tuple(scale * side for side in sorted(thing.dimensions, reverse=True)[:2])


def is_large(scene, thing):
    return sides(scene, thing)[0] > LARGE


def size_text(scene, thing):
    longer, shorter = sides(scene, thing)
    return f"{1000 * shorter:.0f} \u00d7 {1000 * longer:.0f} mm"
