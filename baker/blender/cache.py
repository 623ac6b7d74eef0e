"""Brings a baked cache back: one object a sheet in the collection "Paper", and the sheet itself out of sight.

It wears what the sheet wears: its uv maps and materials, face by face, its vertex groups, colours and attributes. The uv map `pattern` is that of the crease maps."""

import collections
import contextlib
import json
import os
import pathlib
import shutil

import bpy

from . import attributes, crease_map, material, names
from .program import Unusable

COLLECTION = "Paper"

Cached = collections.namedtuple("Cached", "sheet picture last side")  # name; path or None; frame; [m]


def paper_collection(scene):
    """Found or made, in the scene."""
    collection = bpy.data.collections.get(COLLECTION) or bpy.data.collections.new(COLLECTION)
    if COLLECTION not in scene.collection.children:
        scene.collection.children.link(collection)
    return collection


def reader(thing):
    """Its modifier that reads a cache, or None."""
    return next((modifier for modifier in thing.modifiers if modifier.type == "MESH_SEQUENCE_CACHE"), None)


def imported(scene, path):
    """{sheet's name in the cache: new object}, all of them in this scene. Throws Unusable."""
    before = set(bpy.data.objects)
    try:
        with bpy.context.temp_override(scene=scene):
            bpy.ops.wm.alembic_import(filepath=str(path), scale=1 / scene.unit_settings.scale_length, set_frame_range=False, validate_meshes=False,
                                      always_add_cache_reader=True, as_background_job=False)
    except RuntimeError as error:
        raise Unusable(f"Blender does not read {path}: {str(error).strip()}") from error
    found = {}
    for thing in set(bpy.data.objects) - before:
        modifier = reader(thing)
        if modifier:
            for constraint in list(thing.constraints):
                thing.constraints.remove(constraint)  # a sheet's transform in the cache is the unit's scale, and still
            found[modifier.object_path.split("/")[1]] = thing
    if not found:
        raise Unusable(f"Blender found no sheet in {path}.")
    return found


def remove_unused(cache_file):
    if cache_file and not cache_file.users:
        bpy.data.batch_remove([cache_file])


def replaced(old, new):
    """The artist's object goes on, with its materials and modifiers, with mesh and cache of the new one."""
    fresh, modifier = reader(new), reader(old)
    if modifier is None:
        modifier = old.modifiers.new(fresh.name, "MESH_SEQUENCE_CACHE")
        old.modifiers.move(len(old.modifiers) - 1, 0)
    stale_mesh, stale_cache = old.data, modifier.cache_file
    worn = [slot.material for slot in old.material_slots]
    modifier.cache_file, modifier.object_path, modifier.read_data = fresh.cache_file, fresh.object_path, fresh.read_data
    new_mesh = new.data
    bpy.data.objects.remove(new)
    while len(new_mesh.materials) < len(stale_mesh.materials):
        new_mesh.materials.append(None)  # an object has as many slots as its mesh
    old.data = new_mesh
    for slot, material in zip(old.material_slots, worn):
        if material:  # what the artist gave to the paper stays
            slot.material = material
    if not stale_mesh.users:
        bpy.data.meshes.remove(stale_mesh)
    remove_unused(stale_cache)
    return old


def placed(scene, thing, cached):
    """The object under its own name in the collection, shown instead of the sheet."""
    name = f"{names.BAKED}.{cached.sheet}"
    old = scene.objects.get(name)
    if old and old.type == "MESH":
        thing = replaced(old, thing)
    else:
        for collection in thing.users_collection:
            collection.objects.unlink(thing)
        paper_collection(scene).objects.link(thing)
        thing.name = name
    thing.data.name = name
    reader(thing).cache_file.name = f"{name}.abc"
    return thing


def as_the_sheet(scene, thing, cached):
    """The sheet's materials, uv maps and custom properties: those of the cache have the same order, and names that glTF may have changed."""
    sheet = scene.objects.get(cached.sheet)
    if not sheet or sheet.type != "MESH":
        return
    worn = [slot.material for slot in sheet.material_slots if slot.material]
    for slot in thing.material_slots:
        if slot.material and slot.link == "DATA":
            slot.material = next((own for own in worn if own.name == slot.material.name), slot.material)
    layers = thing.data.uv_layers
    for layer, own in zip(layers, sheet.data.uv_layers):
        if own.active_render:
            layer.active_render, layers.active = True, layer
    for name, value in sheet.items():
        if name not in thing and not name.startswith("paper") and isinstance(value, (bool, int, float, str)):
            thing[name] = value


def dress(scene, thing, cached):
    """The materials of the sheet; where it has none, the one that shows the creases. They are on the object's slots, so that they stay when
    the mesh is another one, and a material that the artist gives to the paper stays too."""
    own = f"{names.BAKED}.{cached.sheet}"
    as_the_sheet(scene, thing, cached)
    if not thing.material_slots:
        thing.data.materials.append(None)
    for slot in thing.material_slots:
        kept = slot.material
        slot.link = "OBJECT"
        slot.material = slot.material or kept
    slot = thing.material_slots[0]
    if slot.material is None or slot.material.name == own:
        slot.material = material.build(scene, own, cached.picture, cached.last, cached.side)
    elif cached.picture:
        material.build(scene, own, cached.picture, cached.last, cached.side).use_fake_user = True  # for who wants the creases of the map


def remove(scene):
    """Takes baked paper out of the scene and shows the sheets again. Returns the names of what was removed."""
    removed = []
    for thing in [thing for thing in scene.objects if thing.name.startswith(f"{names.BAKED}.") and reader(thing)]:
        sheet = scene.objects.get(thing.name.removeprefix(f"{names.BAKED}."))
        cached, mesh = reader(thing).cache_file, thing.data
        removed.append(thing.name)
        bpy.data.objects.remove(thing)
        if not mesh.users:
            bpy.data.meshes.remove(mesh)
        remove_unused(cached)
        if sheet:
            sheet.hide_render = False
            for layer in scene.view_layers:
                if sheet.name in layer.objects:
                    sheet.hide_set(False, view_layer=layer)
    return removed


def delete_files(folder):
    """Deletes the files that a bake wrote, by its certificate, and what the add-on made beside them; nobody else's. Returns how many."""
    summary = folder / "cert" / "summary.json"
    try:
        told = json.loads(summary.read_text(encoding="utf-8"))
        listed = [folder / name for name in told["files"]] + [summary] if told["program"] == "paperbake" else []
    except (OSError, ValueError, KeyError, TypeError):
        listed = []
    if not listed:
        return 0  # no bake is there
    listed += [path.with_suffix(".glb") for path in listed if path.suffix == ".abc"]  # the scene as it was sent
    listed += [path.with_name(path.name.replace(".final.exr", ".blender.exr")) for path in listed if path.name.endswith(".final.exr")]
    inside = [path for path in listed if path.resolve().is_relative_to(folder.resolve()) and path.is_file()]
    for path in inside:
        path.unlink()
    shutil.rmtree(folder / ".state", ignore_errors=True)
    for place in (folder / "cert", folder / "maps", folder):
        with contextlib.suppress(OSError):
            place.rmdir()  # where nothing else is in it
    return len(inside)


def hide_sheet(scene, name):
    sheet = scene.objects.get(name)
    if sheet:
        sheet.hide_render = True
        for layer in scene.view_layers:
            if sheet.name in layer.objects:
                sheet.hide_set(True, view_layer=layer)


def picture_of(folder, stem, sheet, several):
    """Path of the picture made from the sheet's final map; None where there is no map. Throws Unreadable, OSError, RuntimeError."""
    maps = pathlib.Path(folder) / "maps"
    name = f"{stem}.{names.in_cache(sheet)}" if several else stem
    final = maps / f"{name}.final.exr"
    return crease_map.crease_picture(final, os.fspath(maps / f"{name}.blender.exr")) if final.exists() else None


def bring_attributes(scene, loaded, path):
    """Puts vertex groups, colours and attributes of the sheets onto the paper. Returns sentences about what does not come back.

    loaded  {sheet's name: paper}
    path    of the USD layer
    """
    sheets = {name: sheet for name, sheet in ((name, scene.objects.get(name)) for name in loaded) if sheet and sheet.type == "MESH" and attributes.carried(sheet)}
    if not sheets:
        return []
    try:
        with attributes.layer(scene, path) as meshes:
            missing = {name: attributes.dress(loaded[name], sheet, meshes.get(names.in_usd(name))) for name, sheet in sheets.items()}
    except RuntimeError as error:
        return [f"The paper has no vertex groups, colours and attributes of its sheet: Blender does not read {path}: {str(error).strip()}"]
    return [f"{name}: {', '.join(lost)} did not come back from {path}." for name, lost in missing.items() if lost]


def load(scene, folder, stem, summary):
    """The sheets of DIR/NAME.abc as objects of the scene; those of an earlier bake go on. Throws Unusable.

    summary  cert/summary.json
    returns  the objects, and sentences about what is less than it should be
    """
    abc = pathlib.Path(folder) / f"{stem}.abc"
    found, loaded, remarks = imported(scene, abc), {}, []
    for told in summary["sheets"]:
        name, picture = told["name"], None
        if names.in_cache(name) not in found:
            raise Unusable(f"{abc} has no sheet {name}.")
        try:
            picture = picture_of(folder, stem, name, len(summary["sheets"]) > 1)
        except (OSError, RuntimeError, crease_map.Unreadable) as error:
            remarks.append(f"The map of {name} is not in its material: {error}.")
        cached = Cached(name, picture, summary["last_frame"], max(told["width_m"], told["height_m"]))
        thing = placed(scene, found[names.in_cache(name)], cached)
        dress(scene, thing, cached)
        hide_sheet(scene, name)
        loaded[name] = thing
    remarks += bring_attributes(scene, loaded, abc.with_suffix(".usdc"))
    return list(loaded.values()), remarks
