#!/usr/bin/env python3
"""Bakes the shots of the gallery, renders a picture of each with Cycles, makes its preview smaller, and writes docs/gallery.md. The
shots are those of docs/gallery.toml.

    .venv/bin/python docs/make_gallery.py [PROGRAM] [NAME...]     PROGRAM: build/paperbake

Needs Blender as the Python module bpy. Names choose some of the shots; the page lists those that have a picture. A picture
takes some seconds of one core, a bake as long as the benchmarks say.
"""

import collections
import os
import pathlib
import subprocess
import sys
import tempfile
import tomllib

import bpy
from mathutils import Vector

DOCS = pathlib.Path(os.path.abspath(__file__)).parent
PICTURES = DOCS / "pictures" / "gallery"
SIZE, SAMPLES = (480, 360), 16
PREVIEW_WIDTH, SHADES = 432, 51  # pixels; of each colour: fewer make a smaller file

Shot = collections.namedtuple("Shot", "name title scene options frame view honest uv", defaults=("",))
SHOTS = [Shot(**shot) for shot in tomllib.loads((DOCS / "gallery.toml").read_text(encoding="utf-8"))["shot"]]


def command(shot):
    words = ["build/paperbake", "bake", f"samples/{shot.scene}.glb", "-o", "DIR", *shot.options.split()]
    return " ".join(words)


def bake(program, shot, folder):
    words = [program, "bake", str(DOCS.parent / "samples" / f"{shot.scene}.glb"), "-o", str(folder),
             "--formats", "abc,cert,preview", "--progress", "none", "--threads", "1", *shot.options.split()]
    done = subprocess.run(words, capture_output=True, text=True)
    if done.returncode not in (0, 4):
        sys.exit(f"{' '.join(words)} ends with {done.returncode}: {done.stderr.strip()}")
    return folder / f"{shot.scene}.abc"


def print_on(material, uv):
    """Columns of grey lines, as of a newspaper, by the uv set of that name."""
    nodes, links = material.node_tree.nodes, material.node_tree.links
    where, lines = nodes.new("ShaderNodeUVMap"), nodes.new("ShaderNodeTexBrick")
    where.uv_map, lines.offset = uv, 0
    settings = {"Color1": (0.3, 0.3, 0.3, 1), "Color2": (0.42, 0.42, 0.41, 1), "Mortar": (0.84, 0.82, 0.77, 1),
                "Scale": 1, "Mortar Size": 0.005, "Brick Width": 0.2, "Row Height": 0.018}
    for name, value in settings.items():
        lines.inputs[name].default_value = value
    links.new(where.outputs[0], lines.inputs["Vector"])
    links.new(lines.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])


def paper(uv):
    """White on both sides, a little light through; printed if it has that uv set."""
    material = bpy.data.materials.new("paper")
    material.use_nodes = True
    nodes, links = material.node_tree.nodes, material.node_tree.links
    shader, through, mix = nodes["Principled BSDF"], nodes.new("ShaderNodeBsdfTranslucent"), nodes.new("ShaderNodeMixShader")
    shader.inputs["Base Color"].default_value = (0.86, 0.85, 0.82, 1)
    shader.inputs["Roughness"].default_value = 0.9
    through.inputs["Color"].default_value = (0.86, 0.82, 0.74, 1)
    mix.inputs["Fac"].default_value = 0.15
    links.new(shader.outputs[0], mix.inputs[1])
    links.new(through.outputs[0], mix.inputs[2])
    links.new(mix.outputs[0], nodes["Material Output"].inputs["Surface"])
    if uv:
        print_on(material, uv)
    return material


def look_from(scene, view, middle, radius):
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    camera.data.lens, camera.data.clip_start = 60, 0.001
    camera.location = middle + Vector(view).normalized() * 4.2 * radius
    camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(camera)
    scene.camera = camera


def light(scene, middle, radius):
    lamp = bpy.data.objects.new("window", bpy.data.lights.new("window", "AREA"))
    lamp.data.energy, lamp.data.size = 115 * radius * radius, 1.2 * radius
    lamp.location = middle + Vector((-3.0, 0.9, 1.5)) * radius
    lamp.rotation_euler = (middle - lamp.location).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(lamp)
    scene.world = bpy.data.worlds.new("room")
    scene.world.use_nodes = True
    scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.075, 0.085, 0.1, 1)


def colliders(scene, shot):
    """The colliders of the scene, in grey, as they are at the frame of the picture."""
    before = set(scene.objects)
    bpy.ops.import_scene.gltf(filepath=str(DOCS.parent / "samples" / f"{shot.scene}.glb"))
    scene.frame_set(shot.frame)
    grey = bpy.data.materials.new("grey")
    grey.use_nodes = True
    grey.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (0.2, 0.21, 0.22, 1)
    for thing in set(scene.objects) - before:
        if thing.type == "MESH" and (thing.name.startswith("collider") or "paper_collider" in thing):
            thing.data.materials.clear()
            thing.data.materials.append(grey)
        else:
            thing.hide_render = True


def render(cache, shot):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    bpy.ops.wm.alembic_import(filepath=str(cache), as_background_job=False)
    scene.frame_set(shot.frame)
    graph, points = bpy.context.evaluated_depsgraph_get(), []
    for thing in [thing for thing in scene.objects if thing.type == "MESH"]:
        thing.data.materials.clear()
        thing.data.materials.append(paper(shot.uv))
        shown = thing.evaluated_get(graph)
        points += [shown.matrix_world @ vertex.co for vertex in shown.data.vertices]
    low, high = (Vector(pick(point[axis] for point in points) for axis in range(3)) for pick in (min, max))
    middle, radius = (low + high) / 2, (high - low).length / 2
    colliders(scene, shot)
    look_from(scene, shot.view, middle, radius)
    light(scene, middle, radius)
    scene.render.engine, scene.cycles.samples, scene.cycles.seed = "CYCLES", SAMPLES, 1
    scene.cycles.use_denoising, scene.cycles.max_bounces = True, 4
    scene.view_settings.view_transform = "Standard"
    scene.render.threads_mode, scene.render.threads = "FIXED", 1
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    scene.render.image_settings.color_mode = "RGB"
    scene.render.filepath = str(PICTURES / f"{shot.name}.png")
    bpy.ops.render.render(write_still=True)


def preview(contact_sheet, shot):
    """The contact sheet of the bake, small enough for a page."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    image = bpy.data.images.load(str(contact_sheet))
    image.scale(PREVIEW_WIDTH, round(PREVIEW_WIDTH * image.size[1] / image.size[0]))
    image.pixels = [round(value * SHADES) / SHADES for value in image.pixels]
    scene = bpy.context.scene
    scene.view_settings.view_transform = "Standard"
    scene.render.image_settings.color_mode, scene.render.image_settings.compression = "RGB", 100
    image.save_render(str(PICTURES / f"{shot.name}.preview.png"), scene=scene)


def page():
    text = "# Gallery\n\n<!-- Written by docs/make_gallery.py. Do not edit. -->\n\n"
    text += "Every picture is one frame of a sample scene, baked by the command below it and rendered by\n"
    text += f"Cycles with {SAMPLES} samples. Below it is the preview of the whole shot, which the same command writes\n"
    text += "with `--formats preview`, made smaller. `.venv/bin/python docs/make_gallery.py` makes all of\n"
    text += "them and this page.\n\n"
    for shot in [shot for shot in SHOTS if (PICTURES / f"{shot.name}.png").exists()]:
        text += f"## {shot.title}\n\n![{shot.title}](pictures/gallery/{shot.name}.png)\n\n"
        text += f"```sh\n{command(shot)}\n```\n\nFrame {shot.frame}. {shot.honest}\n\n"
        if (PICTURES / f"{shot.name}.preview.png").exists():
            text += f"![Its preview](pictures/gallery/{shot.name}.preview.png)\n\n"
    return text.rstrip("\n") + "\n"


def main():
    words = sys.argv[1:]
    names = {shot.name for shot in SHOTS}
    program = words.pop(0) if words and words[0] not in names else str(DOCS.parent / "build" / "paperbake")
    unknown = set(words) - names
    if unknown:
        sys.exit(f"There is no shot {', '.join(sorted(unknown))}; there are {', '.join(shot.name for shot in SHOTS)}.")
    PICTURES.mkdir(parents=True, exist_ok=True)
    for shot in SHOTS:
        if words and shot.name not in words:
            continue
        with tempfile.TemporaryDirectory() as folder:
            cache = bake(program, shot, pathlib.Path(folder))
            render(cache, shot)
            preview(cache.with_suffix(".preview.png"), shot)
        print(PICTURES / f"{shot.name}.png")
    (DOCS / "gallery.md").write_text(page(), encoding="utf-8")


if __name__ == "__main__":
    main()
