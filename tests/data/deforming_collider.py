"""Writes deforming_collider.glb, .fbx and .json with Blender: a finger with two bones and a shape key, and a ball whose node is mirrored and scaled
by another factor on each axis, both keyed. The .json has the vertices that Blender itself evaluates in every frame, in metres.

    python tests/data/deforming_collider.py FOLDER       (needs bpy)
"""

import json
import math
import pathlib
import sys

import bpy
import mathutils

FRAMES = 9
SIDE, CELLS = 0.1, 4
RINGS, LENGTH = 8, 0.1


def add_mesh(name, vertices, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(vertices, [], faces)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_sheet():
    row = CELLS + 1
    vertices = [(SIDE * i / CELLS, SIDE * j / CELLS, 0) for j in range(row) for i in range(row)]
    sheet = add_mesh("paper", vertices, [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i)
                                         for j in range(CELLS) for i in range(CELLS)])
    uv = sheet.data.uv_layers.new()
    for loop in sheet.data.loops:
        at = sheet.data.vertices[loop.vertex_index].co
        uv.data[loop.index].uv = (at.x / SIDE, at.y / SIDE)
    sheet["paper_fps"] = 24
    handle = bpy.data.objects.new("handle", None)
    bpy.context.scene.collection.objects.link(handle)
    for frame in (1, FRAMES):
        handle.location = (0, 0, 0.001 * frame)
        handle.keyframe_insert("location", frame=frame)


def add_finger():
    ring = [(-0.01, -0.01), (0.01, -0.01), (0.01, 0.01), (-0.01, 0.01)]
    vertices = [(x, y, LENGTH * k / RINGS) for k in range(RINGS + 1) for x, y in ring]
    faces = [(4 * k + s, 4 * k + (s + 1) % 4, 4 * k + 4 + (s + 1) % 4, 4 * k + 4 + s) for k in range(RINGS) for s in range(4)]
    finger = add_mesh("collider.finger", vertices, faces + [(3, 2, 1, 0), tuple(4 * RINGS + s for s in range(4))])
    finger.shape_key_add(name="Basis")
    fat = finger.shape_key_add(name="fat")
    for point, (x, y, z) in zip(fat.data, vertices):
        point.co = (1.7 * x, 1.3 * y, z)
    for frame, weight in ((1, 0), (5, 1), (FRAMES, 0.3)):
        fat.value = weight
        fat.keyframe_insert("value", frame=frame)
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    below = rig.data.edit_bones.new("below")
    below.head, below.tail = (0, 0, 0), (0, 0, 0.05)
    above = rig.data.edit_bones.new("above")
    above.head, above.tail, above.parent = (0, 0, 0.05), (0, 0, LENGTH), below
    bpy.ops.object.mode_set(mode="OBJECT")
    share = [min(1, max(0, (0.07 - z) / 0.04)) for _, _, z in vertices]
    for bone, weights in (("below", share), ("above", [1 - w for w in share])):
        group = finger.vertex_groups.new(name=bone)
        for vertex, weight in enumerate(weights):
            if weight > 0:
                group.add([vertex], weight, "REPLACE")
    finger.parent = rig
    finger.modifiers.new("rig", "ARMATURE").object = rig
    rig.rotation_euler, rig.scale = (0.2, 0.1, 0.3), (1.2, 1.2, 1.2)
    bone = rig.pose.bones["above"]
    bone.rotation_mode = "QUATERNION"
    for frame in range(1, FRAMES + 1):
        turn = 1.2 * math.sin((frame - 1) / (FRAMES - 1) * math.pi)
        bone.rotation_quaternion = mathutils.Quaternion((1, 0, 0), turn)
        bone.keyframe_insert("rotation_quaternion", frame=frame)
        rig.location = (0.3, 0.02 + 0.001 * frame, -0.05)
        rig.keyframe_insert("location", frame=frame)
    return finger


def add_ball():
    vertices = [(0.02, 0, 0), (-0.02, 0, 0), (0, 0.03, 0), (0, -0.03, 0), (0, 0, 0.01), (0, 0, -0.01)]
    ball = add_mesh("collider.ball", vertices, [(0, 2, 4), (2, 1, 4), (1, 3, 4), (3, 0, 4), (2, 0, 5), (1, 2, 5), (3, 1, 5), (0, 3, 5)])
    ball.location = (-0.2, 0, 0)
    for frame in range(1, FRAMES + 1):
        ball.scale, ball.rotation_euler = (-1 - 0.05 * frame, 1 + 0.002 * frame ** 2, 0.8), (0.3, 0.5 + 0.02 * frame, 0.7)
        ball.keyframe_insert("scale", frame=frame)
        ball.keyframe_insert("rotation_euler", frame=frame)
    return ball


def evaluated(things):
    """The vertices of every object in every frame, as Blender evaluates them."""
    truth = {thing.name: [] for thing in things}
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for thing in things:
            moved = thing.evaluated_get(graph)
            truth[thing.name].append([[round(c, 7) for c in moved.matrix_world @ v.co] for v in moved.to_mesh().vertices])
            moved.to_mesh_clear()
    return truth


def main():
    path = pathlib.Path(sys.argv[1]) / "deforming_collider"
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 1, FRAMES, 24
    add_sheet()
    things = [add_finger(), add_ball()]
    path.with_suffix(".json").write_text(json.dumps(evaluated(things)) + "\n")
    scene.frame_set(1)
    bpy.ops.export_scene.gltf(filepath=str(path.with_suffix(".glb")), export_extras=True)
    bpy.ops.export_scene.fbx(filepath=str(path.with_suffix(".fbx")), use_custom_props=True, bake_anim_simplify_factor=0, add_leaf_bones=False)


main()
