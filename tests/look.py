"""Pictures of a bake, to be looked at: the sheet at some frames, and the mesh of its pattern.

    .venv/bin/python tests/look.py CACHE.abc PICTURE_STEM FRAME... [--crease DEGREES] [--mesh] [--view X Y Z]

Writes PICTURE_STEM.####.png for each frame (Cycles, light at a grazing angle, normals of the cache;
with --crease, normals of its own, split where the mesh folds by more than that), and with
--mesh PICTURE_STEM.mesh.png, the triangles of the pattern at the first of the frames.
"""
import argparse
import math
import sys

import bpy
from mathutils import Vector


def meshes():
    return [o for o in bpy.context.scene.objects if o.type == "MESH"]


def box(objects):
    depsgraph = bpy.context.evaluated_depsgraph_get()
    points = []
    for o in objects:
        e = o.evaluated_get(depsgraph)
        points += [e.matrix_world @ v.co for v in e.data.vertices]
    low = Vector(min(p[i] for p in points) for i in range(3))
    high = Vector(max(p[i] for p in points) for i in range(3))
    return low, high


def paper_material():
    material = bpy.data.materials.new("paper")
    material.use_nodes = True
    shader = material.node_tree.nodes["Principled BSDF"]
    shader.inputs["Base Color"].default_value = (0.9, 0.88, 0.82, 1)
    shader.inputs["Roughness"].default_value = 0.8
    return material


def aim(camera, low, high, view):
    middle, size = (low + high) / 2, (high - low).length
    direction = Vector(view).normalized()
    camera.location = middle + 2.3 * size * direction
    camera.rotation_euler = (-direction).to_track_quat("-Z", "Y").to_euler()
    camera.data.lens = 70
    camera.data.clip_start = 0.01 * size
    return size


def creased(sheet, degrees, material):
    """A copy of a sheet as it is now, with normals that are split at its folds."""
    data = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    copy = bpy.data.meshes.new("creased")
    copy.from_pydata([v.co[:] for v in data.vertices], [], [p.vertices[:] for p in data.polygons])
    copy.polygons.foreach_set("use_smooth", [True] * len(copy.polygons))
    copy.set_sharp_from_angle(angle=math.radians(degrees))
    copy.materials.append(material)
    shown = bpy.data.objects.new("creased", copy)
    shown.matrix_world = sheet.matrix_world
    bpy.context.scene.collection.objects.link(shown)
    return shown


def render(path):
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("cache")
    parser.add_argument("stem")
    parser.add_argument("frames", nargs="+", type=int)
    parser.add_argument("--crease", type=float)
    parser.add_argument("--mesh", action="store_true")
    parser.add_argument("--view", nargs=3, type=float, default=(-0.6, -1.0, 0.55))
    arguments = parser.parse_args(sys.argv[1:])

    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.alembic_import(filepath=arguments.cache, as_background_job=False)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.cycles.samples = 24
    scene.render.resolution_x, scene.render.resolution_y = 900, 640
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.10, 0.11, 0.13, 1)
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
    lamp.data.energy, lamp.data.angle = 4.0, 0.05
    lamp.rotation_euler = (math.radians(62), 0, math.radians(-75))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    for o in (lamp, camera):
        scene.collection.objects.link(o)
    scene.camera = camera
    material = paper_material()
    for o in meshes():
        o.data.materials.clear()
        o.data.materials.append(material)

    for frame in arguments.frames:
        scene.frame_set(frame)
        aim(camera, *box(meshes()), arguments.view)
        copies = []
        if arguments.crease is not None:
            sheets = list(meshes())
            copies = [creased(o, arguments.crease, material) for o in sheets]
            for o in sheets:
                o.hide_render = True
        render(f"{arguments.stem}.{frame:04d}.png")
        for o in copies:
            bpy.data.objects.remove(o)

    if arguments.mesh:
        scene.frame_set(arguments.frames[0])
        depsgraph = bpy.context.evaluated_depsgraph_get()
        for o in list(meshes()):
            data = o.evaluated_get(depsgraph).data
            uv = data.uv_layers[0].data
            place = {loop.vertex_index: uv[i].uv for i, loop in enumerate(data.loops)}
            flat = bpy.data.meshes.new("pattern")
            flat.from_pydata([(*place[v], 0) for v in range(len(data.vertices))], [], [tuple(p.vertices) for p in data.polygons])
            pattern = bpy.data.objects.new("pattern", flat)
            scene.collection.objects.link(pattern)
            wire = pattern.modifiers.new("wire", "WIREFRAME")
            wire.thickness = 0.0018
            o.hide_render = True
            bpy.data.objects.remove(o)
        scene.render.resolution_x = scene.render.resolution_y = 1200
        aim(camera, *box(meshes()), (0, -0.001, 1))
        render(f"{arguments.stem}.mesh.png")


if __name__ == "__main__":
    main()
