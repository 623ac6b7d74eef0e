"""Renders the pictures of the paper grades that the add-on shows, icons/GRADE.png: of each a sheet of 200 x 140 mm that is
held at one of its shorter sides and hangs from there under its own weight.

    .venv/bin/python baker/blender/make_icons.py [PROGRAM] [GRADE...]     PROGRAM: build/paperbake

Needs Blender as the Python module bpy. A picture takes some seconds of one core.
"""

import json
import pathlib
import subprocess
import sys
import tempfile

import bpy
from mathutils import Vector

HERE = pathlib.Path(__file__).resolve().parent
ICONS = HERE / "icons"
PIXELS, SAMPLES = 64, 48
LENGTH, WIDTH, HELD = 0.2, 0.14, 0.012  # [m] of the sheet, and how much of it is clamped
LAST = 24
EYE, MIDDLE, FIELD = Vector((0.16, -0.5, 0.22)), Vector((0.085, 0, -0.06)), 0.27  # [m] FIELD: width of the picture there
WHITE = (0.85, 0.84, 0.81)
# colour of the paper and how much light goes through; the others are white and opaque to 0.1
LOOKS = {"kraft90": ((0.42, 0.26, 0.13), 0.05), "newsprint45": ((0.6, 0.57, 0.5), 0.2), "tissue17": (WHITE, 0.5),
         "tracing92": ((0.8, 0.83, 0.85), 0.6), "washi35": ((0.84, 0.78, 0.64), 0.35), "kami63": ((0.72, 0.1, 0.09), 0.05)}


def write_scene(path):
    """The sheet in the plane z = 0, with two rows of handles at its end x = 0."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.frame_start, scene.frame_end = 1, LAST
    mesh = bpy.data.meshes.new("paper")
    mesh.from_pydata([(x, y, 0) for x, y in ((0, -WIDTH / 2), (LENGTH, -WIDTH / 2), (LENGTH, WIDTH / 2), (0, WIDTH / 2))], [], [(0, 1, 2, 3)])
    sheet = bpy.data.objects.new("paper", mesh)
    sheet["paper_gravity"], sheet["paper_fps"] = 9.81, 24.0
    scene.collection.objects.link(sheet)
    for x in (0, HELD):
        for k in range(5):
            handle = bpy.data.objects.new("handle", None)
            handle.location = (x, WIDTH * (k - 2) / 4.2, 0)
            scene.collection.objects.link(handle)
    bpy.ops.export_scene.gltf(filepath=str(path), export_extras=True)


def bake(program, scene, grade, folder):
    words = [program, "bake", str(scene), "-o", str(folder), "--preset", grade, "--dynamics", "off", "--frames", f"{LAST}",
             "--formats", "abc", "--progress", "none"]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode not in (0, 4):
        sys.exit(f"{' '.join(words)} ends with {done.returncode}: {done.stderr.strip()}")
    return folder / f"{scene.stem}.abc"


def material(grade):
    colour, through = LOOKS.get(grade, (WHITE, 0.1))
    made = bpy.data.materials.new(grade)
    made.use_nodes = True
    nodes, links = made.node_tree.nodes, made.node_tree.links
    shader, light, mix = nodes["Principled BSDF"], nodes.new("ShaderNodeBsdfTranslucent"), nodes.new("ShaderNodeMixShader")
    shader.inputs["Base Color"].default_value = light.inputs["Color"].default_value = (*colour, 1)
    shader.inputs["Roughness"].default_value = 0.9
    mix.inputs["Fac"].default_value = through
    links.new(shader.outputs[0], mix.inputs[1])
    links.new(light.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], nodes["Material Output"].inputs["Surface"])
    return made


def put(scene, data, at, towards):
    thing = bpy.data.objects.new(data.name, data)
    thing.location, thing.rotation_euler = at, (towards - at).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(thing)
    return thing


def render(cache, grade, path):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.wm.alembic_import(filepath=str(cache), set_frame_range=False)
    scene.frame_set(LAST)
    for thing in [thing for thing in scene.objects if thing.type == "MESH"]:
        thing.data.materials.clear()
        thing.data.materials.append(material(grade))
    camera = bpy.data.cameras.new("camera")
    camera.type, camera.ortho_scale, camera.clip_start = "ORTHO", FIELD, 0.001
    scene.camera = put(scene, camera, EYE, MIDDLE)
    sun = bpy.data.lights.new("sun", "SUN")
    sun.energy, sun.angle = 3.5, 0.1
    put(scene, sun, Vector((-0.3, -0.5, 0.9)), Vector())
    scene.world = bpy.data.worlds.new("world")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 4
    settings = scene.render
    settings.engine, settings.film_transparent, settings.threads_mode, settings.threads = "CYCLES", True, "FIXED", 1
    scene.cycles.samples, scene.cycles.use_denoising = SAMPLES, False
    scene.view_settings.view_transform = "Standard"
    settings.resolution_x = settings.resolution_y = PIXELS
    settings.image_settings.file_format, settings.image_settings.color_mode = "PNG", "RGBA"
    settings.use_stamp_date = settings.use_stamp_time = settings.use_stamp_render_time = False
    settings.filepath = str(path)
    bpy.ops.render.render(write_still=True)


def main(program="build/paperbake", *grades):
    program = str(pathlib.Path(program).resolve())
    listed = json.loads(subprocess.run([program, "presets", "--json"], capture_output=True, text=True, check=True).stdout)
    ICONS.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        scene = pathlib.Path(folder) / "hanging.glb"
        write_scene(scene)
        for grade in grades or [preset["name"] for preset in listed]:
            cache = bake(program, scene, grade, pathlib.Path(folder) / grade)
            render(cache, grade, ICONS / f"{grade}.png")
            print(ICONS / f"{grade}.png")


if __name__ == "__main__":
    main(*sys.argv[1:])
