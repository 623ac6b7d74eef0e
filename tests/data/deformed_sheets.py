"""Writes deformed_sheets.glb and .fbx with Blender: sheets of 200 x 100 mm that bones and shape keys deform. At the first frame "paper.rolled" is
rolled with a radius of 80 mm by a shape key, which then opens it; "paper.folded" is folded by 60 degrees at its middle by a bone, where the mesh has
an edge that is marked as a crease; "paper.bulged" is stretched by a shape key. All begin flat in the mesh.

    python tests/data/deformed_sheets.py FOLDER       (needs bpy)
"""

import math
import pathlib
import sys

import bpy

LAST = 9
WIDTH, HEIGHT, COLUMNS, ROWS = 0.2, 0.1, 10, 2
RADIUS, ANGLE = 0.08, math.radians(60)


def add(name, data):
    thing = bpy.data.objects.new(name, data)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_sheet(name, above):
    row = COLUMNS + 1
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata([(WIDTH * i / COLUMNS, HEIGHT * j / ROWS, 0) for j in range(ROWS + 1) for i in range(row)], [],
                     [(j * row + i, j * row + i + 1, (j + 1) * row + i + 1, (j + 1) * row + i) for j in range(ROWS) for i in range(COLUMNS)])
    uv = mesh.uv_layers.new()
    for loop in mesh.loops:
        at = mesh.vertices[loop.vertex_index].co
        uv.data[loop.index].uv = (at.x / WIDTH, at.y / WIDTH)
    sheet = add(name, mesh)
    sheet.location.z = above
    handle = add(f"handle.{name}", None)
    for frame in (1, LAST):
        handle.location = (0, 0, above + 0.001 * (frame - 1))
        handle.keyframe_insert("location", frame=frame)
    return sheet


def key_shape(sheet, shape, weights):
    sheet.shape_key_add(name="Basis")
    key = sheet.shape_key_add(name="shape")
    for point, vertex in zip(key.data, sheet.data.vertices):
        point.co = shape(*vertex.co)
    for frame, weight in weights:
        key.value = weight
        key.keyframe_insert("value", frame=frame)


def fold(sheet):
    for edge in sheet.data.edges:
        if all(abs(sheet.data.vertices[v].co.x - WIDTH / 2) < 1e-6 for v in edge.vertices):
            marks = sheet.data.attributes.get("crease_edge") or sheet.data.attributes.new("crease_edge", "FLOAT", "EDGE")
            marks.data[edge.index].value = 1
    sheet["paper_crease"] = "modelled"
    rig = add("rig", bpy.data.armatures.new("rig"))
    rig.location = sheet.location
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, head, tail in (("left", 0, WIDTH / 2), ("right", WIDTH / 2, WIDTH)):
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = (head, HEIGHT / 2, 0), (tail, HEIGHT / 2, 0)
    bpy.ops.object.mode_set(mode="OBJECT")
    for name, beyond in (("left", False), ("right", True)):
        inside = [v.index for v in sheet.data.vertices if (v.co.x > WIDTH / 2 + 1e-6) == beyond]
        sheet.vertex_groups.new(name=name).add(inside, 1, "REPLACE")
    sheet.parent, sheet.location = rig, (0, 0, 0)
    sheet.modifiers.new("rig", "ARMATURE").object = rig
    bone = rig.pose.bones["right"]
    bone.rotation_mode = "XYZ"
    for frame in (1, LAST):
        bone.rotation_euler.x = ANGLE
        bone.keyframe_insert("rotation_euler", frame=frame)


def main():
    path = pathlib.Path(sys.argv[1]) / "deformed_sheets"
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end, scene.render.fps = 1, LAST, 24
    rolled, folded, bulged = add_sheet("paper.rolled", 0), add_sheet("paper.folded", 0.3), add_sheet("paper.bulged", 0.6)
    rolled["paper_fps"] = 24
    key_shape(rolled, lambda x, y, z: (RADIUS * math.sin(x / RADIUS), y, RADIUS - RADIUS * math.cos(x / RADIUS)), ((1, 1), (LAST, 0)))
    fold(folded)
    key_shape(bulged, lambda x, y, z: (x, y, 40 * x * (WIDTH - x) * y), ((1, 1), (LAST, 1)))
    scene.frame_set(1)
    bpy.ops.export_scene.gltf(filepath=str(path.with_suffix(".glb")), export_extras=True)
    bpy.ops.export_scene.fbx(filepath=str(path.with_suffix(".fbx")), use_custom_props=True, bake_anim_simplify_factor=0, add_leaf_bones=False,
                             bake_anim_use_all_actions=False, bake_anim_use_nla_strips=False)


main()
