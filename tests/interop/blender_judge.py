"""Judges a cache with Blender itself (PyPI: bpy 4.5, CPython 3.11): imports it and looks at every frame.

    blender_judge.py FILE.abc|FILE.usda|FILE.usdc EXPECTED.json

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
EXPECTED.json is described in alembic_judge.py; metadata, and that "velocity" and "normal" are absent, is judged only there.
The sheets must move: Blender takes neither a frame range nor velocities from a mesh that is still. And they should not
start at frames far over 1000 with broken fps such as 29.97: Blender's own clock is off by 1e-4 frames there.
"""

import json
import math
import os
import sys

import bpy
import numpy

from judgement import Judgement

NORMAL_TOLERANCE = 1e-3  # [rad] Blender keeps custom normals as two 16-bit angles


def floats(collection, attribute, width):
    values = numpy.empty(len(collection) * width, dtype=numpy.float32)
    collection.foreach_get(attribute, values)
    return values.reshape(-1, width)


def integers(collection, attribute):
    values = numpy.empty(len(collection), dtype=numpy.int32)
    collection.foreach_get(attribute, values)
    return values


def empty_scene(fps):
    """Blender has fps as a whole number over a base; the base is a 32-bit float, so 29.97 is not quite met."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = math.ceil(fps)
    scene.render.fps_base = math.ceil(fps) / fps
    return scene


def imported(path):
    """Blender talks while it imports; what it says is no verdict, so it goes to stderr."""
    sys.stdout.flush()
    verdicts = os.dup(1)
    os.dup2(2, 1)
    try:
        if str(path).endswith((".usda", ".usdc")):
            return "FINISHED" in bpy.ops.wm.usd_import(filepath=os.path.abspath(path))
        return "FINISHED" in bpy.ops.wm.alembic_import(filepath=os.path.abspath(path), as_background_job=False)
    except RuntimeError:
        return False
    finally:
        os.dup2(verdicts, 1)
        os.close(verdicts)


def face_normals(frame):
    """The normals, and how far off [rad] they may be in a mesh of 32-bit floats: rounding over the height of a triangle."""
    x = numpy.asarray(frame["x"], dtype=float)
    a, b, c = (x[[triangle[i] for triangle in frame["triangles"]]] for i in range(3))
    normals = numpy.cross(b - a, c - a)
    doubled_areas = numpy.linalg.norm(normals, axis=1)
    longest = numpy.max([numpy.linalg.norm(edge, axis=1) for edge in (b - a, c - b, a - c)], axis=0)
    rounding = numpy.finfo(numpy.float32).eps * abs(x).max()
    return normals / doubled_areas[:, None], 1e-6 + 4 * rounding / (doubled_areas / longest).min()


def judge_faces(judgement, mesh, turn, frame, where):
    """Blender's faces are counter-clockwise again, and their front is the sheet's front."""
    found = integers(mesh.loops, "vertex_index").reshape(-1, 3)
    right = numpy.array_equal(integers(mesh.polygons, "loop_total"), [3] * len(frame["triangles"]))
    if not judgement.check(right, f"{where}: faces are not {len(frame['triangles'])} triangles"):
        return False
    turned = [tuple(numpy.roll(triangle, -list(triangle).index(min(triangle)))) for triangle in found.tolist()]
    wanted = [tuple(numpy.roll(triangle, -triangle.index(min(triangle)))) for triangle in frame["triangles"]]
    judgement.check(turned == wanted, f"{where}: faces are not the counter-clockwise triangles")
    normals, tolerance = face_normals(frame)
    judgement.near(floats(mesh.polygons, "normal", 3) @ turn, normals, "face normals", where, tolerance)
    return True


def judge_corners(judgement, mesh, turn, frame, where):
    corners = integers(mesh.loops, "vertex_index")
    if "uv" in frame and judgement.check(mesh.uv_layers.active, f"{where}: no uv"):
        judgement.near(floats(mesh.uv_layers.active.uv, "vector", 2), numpy.asarray(frame["uv"])[corners], "corner uvs", where)
    if "normal" in frame and judgement.check(mesh.has_custom_normals, f"{where}: no normals"):
        judgement.near(floats(mesh.corner_normals, "vector", 3) @ turn, numpy.asarray(frame["normal"])[corners], "corner normals",
                       where, NORMAL_TOLERANCE)


def judge_frame(judgement, blender_object, frame, where):
    mesh = blender_object.to_mesh()
    world = numpy.array(blender_object.matrix_world)  # of a USD layer: from y up to z up
    turn = world[:3, :3].T
    positions = floats(mesh.vertices, "co", 3) @ turn + world[:3, 3]
    judgement.near(positions, frame["x"], "positions", where)
    if "velocity" in frame and judgement.check("velocity" in mesh.attributes, f"{where}: no velocities"):
        judgement.near(floats(mesh.attributes["velocity"].data, "vector", 3) @ turn, frame["velocity"], "velocities", where)
    if judge_faces(judgement, mesh, turn, frame, where):
        judge_corners(judgement, mesh, turn, frame, where)
    blender_object.to_mesh_clear()


def judge_scene(judgement, scene, expected):
    first, count = expected["first_frame"], len(expected["sheets"][0]["frames"])
    found = (scene.frame_start, scene.frame_end)
    judgement.check(found == (first, first + count - 1), f"scene: frames {found}, expected {(first, first + count - 1)}")
    names = sorted(o.name for o in scene.objects if o.type == "MESH")
    wanted = sorted(sheet["name"] for sheet in expected["sheets"])
    if not judgement.check(names == wanted, f"scene: meshes {names}, expected {wanted}"):
        return
    for i in range(count):
        scene.frame_set(first + i)
        graph = bpy.context.evaluated_depsgraph_get()
        for sheet in expected["sheets"]:
            frame = {**{key: sheet[key] for key in ("triangles", "uv") if key in sheet}, **sheet["frames"][i]}
            evaluated = scene.objects[sheet["name"]].evaluated_get(graph)
            judge_frame(judgement, evaluated, frame, f"{sheet['name']}, frame {first + i}")


def main(arguments):
    if len(arguments) != 2:
        print("usage: blender_judge.py FILE.abc EXPECTED.json")
        return 2
    judgement = Judgement()
    with open(arguments[1], encoding="utf-8") as file:
        expected = json.load(file)
    scene = empty_scene(expected["fps"])
    if judgement.check(expected["sheets"], f"{arguments[1]} expects nothing") and judgement.check(
            imported(arguments[0]), f"Blender does not import {arguments[0]}"):
        judge_scene(judgement, scene, expected)
    return judgement.conclude(f"Blender {bpy.app.version_string}", ("positions", "face normals"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
