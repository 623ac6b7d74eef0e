"""Writes what paperbake needs of a scene as glTF: sheets, handles, clamps, winds, colliders and the armatures that deform them. What
carries them stays behind: the exporter writes where an object is in the world when its parent is not written."""

import contextlib
import json
import struct

import bpy

from . import attributes, marking, names
from .program import Unusable

TEMPORARY = "paperbake export"
DEFORMING = {"CLOTH", "CURVE", "HOOK", "LATTICE", "MESH_CACHE", "MESH_DEFORM", "MESH_SEQUENCE_CACHE", "NODES", "SHRINKWRAP", "SIMPLE_DEFORM",
             "SOFT_BODY", "SURFACE_DEFORM", "WARP", "WAVE"}  # modifiers that may change a shape from frame to frame


def has_marked_bones(thing):
    return thing.type == "ARMATURE" and any(names.begins_with(bone.name, names.HANDLE) or "paper_point" in bone for bone in thing.data.bones)


def rigs(thing):
    """The armatures that deform an object."""
    return [modifier.object for modifier in thing.modifiers if modifier.type == "ARMATURE" and modifier.object]


def relevant(scene):
    """Every marked object, armatures with marked bones, those that deform colliders, and what is between a collider and the empty that makes
    it one."""
    colliders = names.of_role(scene, names.COLLIDER)
    deforming = [rig for thing in colliders for rig in rigs(thing)]
    grouping = [above for thing in colliders for above in names.up_to_group(thing)]
    return [thing for thing in scene.objects if names.role(thing) or has_marked_bones(thing) or thing in deforming or thing in grouping]


def has_shapes(scene):
    """Whether a collider has shape keys. The exporter writes them only where it applies no modifiers."""
    return any(thing.data.shape_keys for thing in names.of_role(scene, names.COLLIDER))


def curves(action):
    """Its F-curves, of all its slots where it has such."""
    if not hasattr(action, "layers"):
        return list(action.fcurves)  # before Blender 4.4
    return [curve for layer in action.layers for strip in layer.strips for bag in strip.channelbags for curve in bag.fcurves]


def keyed(thing, path):
    """Whether the object's action animates this property."""
    action = thing.animation_data and thing.animation_data.action
    return bool(action) and any(curve.data_path == path for curve in curves(action))


def not_followed(thing, applied):
    """A sentence about how a collider changes its shape, which no bake follows; empty when all is followed, as bones and shape keys are.
    applied: whether the export applies modifiers"""
    shown_ones = [modifier for modifier in thing.modifiers if modifier.show_viewport]
    deforming = [modifier for modifier in shown_ones if modifier.type in DEFORMING]
    if deforming:
        return f"{thing.name} is deformed by {deforming[0].name}: it stays as it is in the first frame. Bake it to shape keys."
    if any(modifier.type == "ARMATURE" and modifier.use_deform_preserve_volume for modifier in shown_ones):
        return f"{thing.name}: its armature preserves volume, which is not followed. Switch Preserve Volume off."
    others = [modifier for modifier in shown_ones if modifier.type != "ARMATURE"]
    if others and not applied:
        return f"{thing.name}: its modifier {others[0].name} is left out, because a collider has shape keys. Apply it."
    return ""


def left_out(thing):
    """A sentence about an object that is named like what is exported, and is not, because it has no mesh of its own. Empty for all others."""
    meant = names.meant_as(thing)
    if meant:
        return f"{thing.name} is no mesh and is left out, although it is named or marked as {meant}. Select it and use Object > Convert > Mesh."
    if thing.type == "EMPTY" and thing.instance_type == "COLLECTION" and thing.instance_collection:
        inside = [part.name for part in thing.instance_collection.all_objects if names.role(part) or names.meant_as(part)]
        if inside or names.says_collider(thing):
            what = f", with {inside[0]} in it," if inside else ""
            return f"{thing.name} is an instance of a collection and{what} is left out. Select it and use Object > Apply > Make Instances Real."
    return ""


def not_returned(sheet):
    """A sentence about what the artist has put on the vertices of a sheet, which does not come back; empty where there is nothing."""
    kinds = [f"{kind} {', '.join(found)}" for kind, found in attributes.not_carried(sheet).items() if found]
    return f"{sheet.name}: the baked paper has other vertices and does not get its {'; '.join(kinds)}. Use a UV map or a texture." if kinds else ""


def remarks(scene):
    """Sentences about what the bake does not do as the scene has it."""
    found = [not_followed(thing, not has_shapes(scene)) for thing in names.of_role(scene, names.COLLIDER)]
    found += [left_out(thing) for thing in scene.objects]
    found += [not_returned(thing) for thing in names.of_role(scene, names.SHEET)]
    found += [f"{thing.name} is {names.size_text(scene, thing)}: is it meant that large?"
              for thing in names.of_role(scene, names.SHEET) if names.is_large(scene, thing)]
    return [sentence for sentence in found if sentence]


def gravity_of(scene):
    """[m/s2] that of the panel or, where that is 0, of the property of an object; and what says so"""
    if scene.paperbake.gravity:
        return scene.paperbake.gravity, "the panel"
    for thing in relevant(scene):
        try:
            value = float(thing.get("paper_gravity", 0))
        except (TypeError, ValueError):  # the program says what is wrong with it
            continue
        if value:
            return value, f"paper_gravity of {thing.name}"
    return 0, "the panel"


def check(scene):
    """Throws Unusable: what the program could not say as well, because it does not see this scene."""
    sheets = names.of_role(scene, names.SHEET)
    if not sheets:
        raise Unusable("There is no sheet: select a mesh and press Mark Sheet.")
    holders = names.of_role(scene, names.HANDLE) + [thing for thing in scene.objects if has_marked_bones(thing)]
    if not holders and not gravity_of(scene)[0] and not any(names.of_role(scene, mover) for mover in (names.WIND, names.COLLIDER)):
        raise Unusable("Nothing holds the sheet, and nothing moves it: select empties and press Mark Handles, press Add Handles, "
                       "or give it Gravity, a wind or a collider.")
    for thing in holders:
        if keyed(thing, "hide_viewport"):
            raise Unusable(f"{thing.name}: its visibility in viewports is keyed, and Blender does not move what is hidden. "
                           "Key its scale to 0 instead, or set Release.")


@contextlib.contextmanager
def shown(scene, things):
    """The objects in a collection of the view layer, and enabled: Blender does not evaluate what is disabled. (The eye hides no motion.)"""
    collection = bpy.data.collections.new(TEMPORARY)
    scene.collection.children.link(collection)
    before = [(thing, thing.hide_viewport) for thing in things]
    try:
        for thing in things:
            collection.objects.link(thing)
            thing.hide_viewport = False
        yield collection
    finally:
        bpy.data.collections.remove(collection)
        for thing, disabled in before:
            thing.hide_viewport = disabled


@contextlib.contextmanager
def clock(scene, last):
    """The scene at its first frame, its clip up to `last`, with the frame rate that the exporter writes rightly.

    It divides by fps * fps_base where fps / fps_base is meant (29.97 would become 30.03)."""
    before = scene.frame_current, scene.frame_end, scene.render.fps_base
    try:
        scene.frame_end = last
        scene.render.fps_base = 1 / before[2]
        scene.frame_set(scene.frame_start)
        yield
    finally:
        scene.render.fps_base, scene.frame_end = before[2], before[1]
        scene.frame_set(before[0])


@contextlib.contextmanager
def told(thing, **properties):
    """The properties on the object: they carry what glTF has no place for, as the frame rate and the names of uv maps."""
    before = {name: thing.get(name) for name in properties}
    for name, value in properties.items():
        thing[name] = value
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del thing[name]
            else:
                thing[name] = value


@contextlib.contextmanager
def edge_creases(scene):
    """The edges of sheets that are marked as creases (Edge > Edge Crease) as objects of their own, as long as the context lasts: glTF has no
    place for such marks."""
    made = []
    try:
        for sheet in names.of_role(scene, names.SHEET):
            marks = sheet.data.attributes.get("crease_edge")
            marked = [edge for edge, mark in zip(sheet.data.edges, marks.data) if mark.value > 0] if marks else []
            if marked:
                places = [sheet.data.vertices[v].co for edge in marked for v in edge.vertices]
                made.append(marking.crease_object(sheet, round(sheet.get("paper_crease", 0.0)),
                                                  [tuple(places[i:i + 2]) for i in range(0, len(places), 2)]))
        bpy.context.view_layer.update()
        yield
    finally:
        for thing in made:
            mesh = thing.data
            bpy.data.objects.remove(thing)
            bpy.data.meshes.remove(mesh)


@contextlib.contextmanager
def all_told(scene, fps):
    """On every sheet the names of its uv maps and attributes, with these, and on the first the frame rate, and the gravity where there is any:
    a scene without handles has to say what moves its sheets."""
    sheets = names.of_role(scene, names.SHEET)
    with contextlib.ExitStack() as stack:
        named = {}  # sheets may share a mesh
        for sheet in sheets:
            if sheet.data not in named:
                named[sheet.data] = stack.enter_context(attributes.sent(sheet.data, sheet))
            stack.enter_context(told(sheet, **named[sheet.data]))
            stack.enter_context(told(sheet, paper_uv_sets="\n".join(layer.name for layer in sheet.data.uv_layers)))
        gravity = {"paper_gravity": scene.paperbake.gravity} if scene.paperbake.gravity else {}
        stack.enter_context(told(sheets[0], paper_fps=fps, **gravity))
        yield


def frames_per_second(scene):
    return scene.render.fps / scene.render.fps_base


def check_times(path, last, fps):
    """Throws Unusable where the last key is not at the time of the last frame: an exporter with another idea of the frame rate."""
    with open(path, "rb") as file:
        length = struct.unpack("<12xI4x", file.read(20))[0]
        document = json.loads(file.read(length))
    ends = [document["accessors"][sampler["input"]]["max"][0] for clip in document.get("animations", []) for sampler in clip["samplers"]]
    if ends and abs(max(ends) * fps - last) > 0.01:
        raise Unusable(f"Blender wrote frame {last} at {max(ends):.4f} s, at {fps:g} frames a second it is {last / fps:.4f} s: choose a whole frame rate.")


def write(scene, path, last):
    """The clip from the scene's first frame to `last`, handles as Blender itself has them at every frame. Throws Unusable."""
    check(scene)
    fps = frames_per_second(scene)
    if bpy.context.object and bpy.context.object.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    things = relevant(scene)
    with shown(scene, things) as collection, edge_creases(scene), clock(scene, last), all_told(scene, fps):
        try:
            bpy.ops.export_scene.gltf(
                filepath=path, export_format="GLB", collection=collection.name, export_extras=True, export_yup=True, use_mesh_edges=True,
                export_current_frame=True,  # the sheet as it is at the first frame
                export_apply=not has_shapes(scene), export_normals=False, export_materials="EXPORT", export_image_format="NONE",
                export_attributes=True, export_vertex_color="NONE",  # colours are attributes there, with all their bits
                export_morph=True, export_morph_normal=False, export_skins=True, export_def_bones=False,
                export_animations=True, export_animation_mode="SCENE", export_anim_scene_split_object=False, export_force_sampling=True,
                export_frame_range=True, export_frame_step=1, export_anim_slide_to_zero=False, export_optimize_animation_size=False,
                export_optimize_animation_keep_anim_object=True, export_optimize_animation_keep_anim_armature=True)
        except (RuntimeError, AttributeError) as error:
            raise Unusable(f"Blender's glTF export failed: {str(error).strip()} (the add-on \"glTF 2.0 format\" has to be enabled)") from error
    check_times(path, last, fps)
