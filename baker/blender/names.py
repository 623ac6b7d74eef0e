"""Which objects paperbake reads and by what name, as formats/scene/scene_properties.h and samples/README.md say."""

import re

SHEET, HANDLE, CLAMP, COLLIDER = "paper", "handle", "clamp", "collider"
BAKED = "baked"  # what comes back must not be a sheet itself
ROLES = (SHEET, HANDLE, CLAMP, COLLIDER)


def matched(name):
    """As the program matches names: without case and namespace, and with `.` `_` `-` alike."""
    return re.sub(r"[_-]", ".", name.rsplit(":", 1)[-1].lower())


def begins_with(name, role):
    return matched(name).startswith(role)


def role(thing):
    """One of ROLES, or None. Colliders first: a mesh may be both by its names."""
    if thing.type == "MESH" and (thing.get("paper_collider") or begins_with(thing.name, COLLIDER)):
        return COLLIDER
    if thing.type == "MESH" and begins_with(thing.name, SHEET):
        return SHEET
    return next((prefix for prefix in (HANDLE, CLAMP) if begins_with(thing.name, prefix)), None)


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
