"""Judges whether a cache blurs in motion as it should: Blender renders a frame of it with Cycles.

    motion_blur_judge.py FILE.abc FRAME FOLDER

Three pictures, FOLDER/sharp.png, blurred.png and still.png: without motion blur, with it, and with it but the velocities of the
cache scaled to 0. The blurred one must differ from the sharp one, most where the sheet moves most, and nowhere where it is not;
the still one must be the sharp one again, which tells that Blender blurs by the velocities and by nothing else.
Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import math
import os
import pathlib
import sys

import bpy
import numpy
from bpy_extras.object_utils import world_to_camera_view
from mathutils import Vector

from blender_judge import empty_scene, floats, imported
from judgement import Judgement

SIZE = (320, 240)
SHUTTER = 16.0       # [frames], centred on the frame: long, so that slow paper blurs by more than a pixel or two
LEAST_MOTION = 10    # [pixel] of the fastest vertex over the shutter: less could not be told from noise
DIFFERENT = 12 / 255  # of a pixel: most of the noise of 32 samples is below


def lit_scene(scene):
    scene.render.engine = "CYCLES"
    scene.cycles.device = "CPU"
    scene.cycles.samples = 32
    scene.cycles.seed = 1
    scene.cycles.max_bounces = 2
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.resolution_percentage = 100
    scene.render.motion_blur_shutter = SHUTTER
    scene.view_settings.view_transform = "Standard"
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs[0].default_value = (0.1, 0.11, 0.13, 1)
    lamp = bpy.data.objects.new("lamp", bpy.data.lights.new("lamp", "SUN"))
    lamp.data.energy = 4
    lamp.rotation_euler = (math.radians(55), 0, math.radians(-60))
    scene.collection.objects.link(lamp)


def evaluated(sheet):
    """Positions and velocities in the world. [m], [m/s]"""
    shown = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get())
    world = numpy.array(shown.matrix_world)
    mesh = shown.data
    x = floats(mesh.vertices, "co", 3) @ world[:3, :3].T + world[:3, 3]
    v = floats(mesh.attributes["velocity"].data, "vector", 3) @ world[:3, :3].T if "velocity" in mesh.attributes else None
    return x, v


def camera_on(scene, x):
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    middle, size = Vector((x.min(axis=0) + x.max(axis=0)) / 2), float(numpy.linalg.norm(x.max(axis=0) - x.min(axis=0)))
    view = Vector((-0.5, -1, 0.8)).normalized()
    camera.location = middle + 1.9 * size * view
    camera.rotation_euler = (-view).to_track_quat("-Z", "Y").to_euler()
    camera.data.clip_start = 0.01 * size
    scene.collection.objects.link(camera)
    scene.camera = camera
    bpy.context.view_layer.update()
    return camera


def rendered(scene, path, blur):
    scene.render.use_motion_blur = blur
    scene.render.filepath = os.path.abspath(path)
    bpy.ops.render.render(write_still=True)
    picture = bpy.data.images.load(scene.render.filepath)
    pixels = numpy.array(picture.pixels[:], dtype=float).reshape(SIZE[1], SIZE[0], 4)[:, :, :3]  # from the bottom row
    bpy.data.images.remove(picture)
    return pixels


def in_pixels(scene, camera, points):
    found = [world_to_camera_view(scene, camera, Vector(p)) for p in points]
    return numpy.array([(p.x * SIZE[0], p.y * SIZE[1]) for p in found])


def near_motion(start, end):
    """Which pixels a moving vertex comes near."""
    swept = numpy.zeros((SIZE[1], SIZE[0]), dtype=bool)
    for share in numpy.linspace(0, 1, 9):
        at = (start + share * (end - start)).astype(int)
        for dx in range(-4, 5):
            for dy in range(-4, 5):
                swept[numpy.clip(at[:, 1] + dy, 0, SIZE[1] - 1), numpy.clip(at[:, 0] + dx, 0, SIZE[0] - 1)] = True
    return swept


def main(arguments):
    if len(arguments) != 3:
        print("usage: motion_blur_judge.py FILE.abc FRAME FOLDER")
        return 2
    folder = pathlib.Path(arguments[2])
    folder.mkdir(parents=True, exist_ok=True)
    judgement = Judgement()
    scene = empty_scene(24)
    if not judgement.check(imported(arguments[0]), "Blender does not import it"):
        return judgement.conclude("Blender", ())
    sys.stdout.flush()
    verdicts = os.dup(1)
    os.dup2(2, 1)  # Cycles talks of every tile
    lit_scene(scene)
    scene.frame_set(int(arguments[1]))
    (sheet,) = (o for o in scene.objects if o.type == "MESH")
    (modifier,) = (m for m in sheet.modifiers if m.type == "MESH_SEQUENCE_CACHE")
    x, v = evaluated(sheet)
    camera = camera_on(scene, x)
    sharp, blurred = rendered(scene, folder / "sharp.png", False), rendered(scene, folder / "blurred.png", True)
    modifier.velocity_scale = 0
    scene.frame_set(int(arguments[1]))
    still = rendered(scene, folder / "still.png", True)
    os.dup2(verdicts, 1)

    if not judgement.check(v is not None, "there is no velocity on the mesh"):
        return judgement.conclude("Blender", ())
    half = 0.5 * SHUTTER / scene.render.fps * scene.render.fps_base * v
    start, end = in_pixels(scene, camera, x - half), in_pixels(scene, camera, x + half)
    motion = numpy.linalg.norm(end - start, axis=1)
    judgement.check(motion.max() > LEAST_MOTION, f"nothing moves more than {motion.max():.2f} pixels: this judges nothing")
    changed = abs(blurred - sharp).max(axis=2) > DIFFERENT
    moving = motion > 0.5 * motion.max()
    swept, anywhere = near_motion(start[moving], end[moving]), near_motion(start, end)
    judgement.check(changed.sum() > 100, f"the blurred picture is the sharp one but for {changed.sum()} pixels")
    judgement.check(not (changed & ~anywhere).any(), f"{(changed & ~anywhere).sum()} pixels changed where no paper is")
    judgement.check(changed[swept].mean() > 1.2 * changed[~swept & anywhere].mean(),
                    f"it is no more blurred where the sheet moves most ({changed[swept].mean():.3f}) than elsewhere ({changed[~swept & anywhere].mean():.3f})")
    unchanged = abs(still - sharp).max(axis=2) > DIFFERENT
    judgement.check(unchanged.sum() < 0.1 * changed.sum(), f"without velocities {unchanged.sum()} pixels are blurred all the same")
    judgement.count("pixels blurred", int(changed.sum()))
    judgement.count("pixels of motion of the fastest vertex", int(motion.max()))
    return judgement.conclude(f"Blender {bpy.app.version_string}", ("pixels blurred",))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
