"""What the tests of the add-on share: its files and folders, scenes made as an artist makes them, and what stands for a window.

The words of the command line are those of blender_addon_test.py. To be imported before bpy.
"""

import contextlib
import importlib
import os
import pathlib
import shutil
import sys
import tempfile
import time
import types

PROGRAM, ADDON, FOLDER = (pathlib.Path(word).resolve() for word in sys.argv[1:4])
shutil.rmtree(FOLDER, ignore_errors=True)
FOLDER.mkdir(parents=True)
os.environ["BLENDER_USER_RESOURCES"] = str(FOLDER / "user")  # nobody's own Blender is touched

import bpy  # noqa: E402
from mathutils import Vector  # noqa: E402

from judgement import Judgement  # noqa: E402

MODULE = "bl_ext.user_default.paperbake"
SIDES = (0.10, 0.14)  # [m]
FIRST, LAST = 5, 14
FPS = 30 / 1.001      # the rate that Blender's exporter gets wrong


def part(name):
    return importlib.import_module(f"{MODULE}.{name}")


def use(program):
    bpy.context.preferences.addons[MODULE].preferences.program = str(program)


@contextlib.contextmanager
def heard():
    """What Blender prints, reports among it, in a list of one string."""
    said = [""]
    sys.stdout.flush()
    kept = os.dup(1)
    with tempfile.TemporaryFile() as file:
        os.dup2(file.fileno(), 1)
        try:
            yield said
        finally:
            sys.stdout.flush()
            os.dup2(kept, 1)
            os.close(kept)
            file.seek(0)
            said[0] = file.read().decode(errors="replace")


def report(operator, **settings):
    """(what the operator returned, what it reported)"""
    with heard() as said:
        try:
            result = operator(**settings)
        except RuntimeError as error:  # an ERROR
            return {"CANCELLED"}, str(error).strip()
    return result, said[0].strip()


def key(thing, path, *values_at_ends):
    for frame, value in zip((FIRST, LAST), values_at_ends):
        setattr(thing, path, value)
        thing.keyframe_insert(path, frame=frame)


def empty(name, place):
    thing = bpy.data.objects.new(name, None)
    thing.location = place
    bpy.context.scene.collection.objects.link(thing)
    return thing


def select(*things):
    for thing in bpy.context.scene.objects:
        thing.select_set(thing in things)
    bpy.context.view_layer.objects.active = things[0]


def rig(corner, goal):
    """An empty on the moving bone of an armature that is itself turned: what only evaluation knows."""
    armature = bpy.data.objects.new("Rig", bpy.data.armatures.new("Rig"))
    bpy.context.scene.collection.objects.link(armature)
    armature.location, armature.rotation_euler = corner, (0.4, -0.3, 1.0)
    select(armature)
    bpy.ops.object.mode_set(mode="EDIT")
    bone = armature.data.edit_bones.new("Hand")
    bone.head, bone.tail = (0, 0, -0.05), (0, 0, 0)
    bpy.ops.object.mode_set(mode="OBJECT")
    pose = armature.pose.bones["Hand"]
    bpy.context.view_layer.update()
    there = (armature.matrix_world @ armature.data.bones["Hand"].matrix_local).to_3x3().inverted() @ (goal - corner)
    key(pose, "location", (0, 0, 0), there)
    grip = empty("Grip", (0, 0, 0))
    grip.parent, grip.parent_type, grip.parent_bone = armature, "BONE", "Hand"
    return grip


def new_scene(name):
    """A sheet of one quad somewhere in space, not yet marked; saved as NAME.blend."""
    with heard():
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = FIRST, LAST
    scene.render.fps, scene.render.fps_base = 30, 1.001
    scene.frame_set(FIRST)
    with heard():
        bpy.ops.mesh.primitive_plane_add(size=1)
        sheet = bpy.context.object
        sheet.name, sheet.scale = "Letter", (*SIDES, 1)
        bpy.ops.object.transform_apply(scale=True)
    sheet.location, sheet.rotation_euler = (0.3, -0.2, 0.5), (0.3, 0.2, 0.5)
    sheet.data.name = "Letter"
    bpy.context.view_layer.update()
    scene.paperbake.quality = "draft"
    (FOLDER / name).mkdir(exist_ok=True)
    bpy.ops.wm.save_as_mainfile(filepath=str(FOLDER / name / f"{name}.blend"))
    return scene, sheet


def place(sheet, u, v, up=0.0):
    """World position of a point of the flat sheet. u, v in [-1/2, 1/2] of its sides, up [m]"""
    return sheet.matrix_world @ Vector((u * SIDES[0], v * SIDES[1], up))


def mark_and_hold(judgement, scene, sheet):
    """What the artist does, by the panel's operators: two handles keyed, one carried by a bone, one by a constraint. Returns their names."""
    select(sheet)
    bpy.ops.object.mode_set(mode="EDIT")
    bpy.ops.mesh.select_all(action="DESELECT")
    bpy.ops.object.mode_set(mode="OBJECT")
    for vertex in sheet.data.vertices:
        vertex.select = vertex.co.y < 0
    bpy.ops.object.mode_set(mode="EDIT")
    with heard():
        judgement.check(bpy.ops.paperbake.mark_sheet() == {"FINISHED"} and sheet.name == "paper.Letter", f"the sheet is named {sheet.name}")
        bpy.ops.paperbake.add_handles()
    bpy.ops.object.mode_set(mode="OBJECT")
    added = [thing for thing in scene.objects if thing.name.startswith("handle")]
    judgement.check(len(added) == 2, f"{len(added)} handles at 2 vertices")
    local = sheet.matrix_world.inverted()
    for thing in added:
        at = local @ thing.location
        key(thing, "location", thing.location.copy(), sheet.matrix_world @ Vector((0.94 * at.x, 0.8 * at.y, 0.004)))
    grip = rig(place(sheet, -0.5, 0.5), place(sheet, -0.46, 0.42, 0.01))
    guide, follower = empty("Guide", (0, 0, 0)), empty("Follower", (0, 0, 0))
    key(guide, "location", place(sheet, 0.5, 0.5), place(sheet, 0.46, 0.42, -0.01))
    follower.constraints.new("COPY_LOCATION").target = guide
    select(grip, follower)
    with heard():
        bpy.ops.paperbake.mark_handles()
    judgement.check({grip.name, follower.name} == {"handle.Grip", "handle.Follower"}, f"handles are named {grip.name}, {follower.name}")
    return [thing.name for thing in (*added, grip, follower)]


def holding(name):
    """A scene that bakes, in another file. Returns it."""
    scene, sheet = new_scene(name)
    mark_and_hold(Judgement(), scene, sheet)
    return scene


def standing_in(name, *lines):
    """A program that bakes as the real one does, and then does this. Returns its path."""
    path = FOLDER / name
    path.write_text("\n".join(["#!/bin/sh", f'"{PROGRAM}" "$@"', *lines, ""]))
    path.chmod(0o755)
    return path


def until(job, condition, seconds=30):
    end = time.monotonic() + seconds
    while not condition() and job.step() and time.monotonic() < end:
        time.sleep(0.01)


class Window:
    """Stands for the context of a window, of which there is none here: for the operator that steps a job by a timer."""

    def __init__(self, scene):
        self.scene, self.window, self.timers = scene, None, 0
        self.window_manager = types.SimpleNamespace(event_timer_add=self.add, event_timer_remove=self.remove, modal_handler_add=lambda operator: None)

    def add(self, seconds, window):
        self.timers += 1
        return self

    def remove(self, timer):
        self.timers -= 1


class Layout:
    """Stands for a panel's layout: what it is asked to show must be there."""

    def __init__(self):
        self.shown, self.texts, self.pictures = [], [], []

    def prop(self, data, name, **settings):
        data.path_resolve(name)
        self.shown.append(name)

    def operator(self, name, **settings):
        kind = getattr(getattr(bpy.ops, name.split(".")[0]), name.split(".")[1]).get_rna_type()
        self.shown.append(name)
        return types.SimpleNamespace(**{p.identifier: None for p in kind.properties})

    def label(self, text="", icon="NONE"):
        bpy.types.UILayout.bl_rna.functions["label"].parameters["icon"].enum_items[icon]
        self.texts.append(text)

    def template_icon(self, icon_value, scale):
        self.pictures.append(icon_value)

    def progress(self, factor, text):
        self.texts.append(text)

    def column(self, **settings):
        return self

    row = box = column


def panels(context):
    layout = Layout()
    for kind in part("panel").CLASSES:
        panel = types.SimpleNamespace(layout=layout)
        for name in ("draw_sheet", "draw_handle", "draw_collider", "draw_outcome"):
            if hasattr(kind, name):
                setattr(panel, name, types.MethodType(getattr(kind, name), panel))
        kind.draw(panel, context)
    return layout
