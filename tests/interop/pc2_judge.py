"""Judges a point cache with Blender's Mesh Cache modifier, on the mesh of the .obj beside it (PyPI: bpy 4.5).

    pc2_judge.py FILE.pc2 FILE.rest.obj EXPECTED.json [SHEET]        SHEET: number of the sheet in EXPECTED.json, else 0

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
EXPECTED.json is described in alembic_judge.py.
"""

import json
import os
import sys

import bpy
import numpy

from blender_judge import empty_scene, floats, integers
from judgement import Judgement


def import_rest(path):
    bpy.ops.wm.obj_import(filepath=os.path.abspath(path), forward_axis="Y", up_axis="Z")
    return bpy.context.selected_objects[0]


def main(arguments):
    if len(arguments) not in (3, 4):
        print("usage: pc2_judge.py FILE.pc2 FILE.rest.obj EXPECTED.json [SHEET]")
        return 2
    judgement = Judgement()
    with open(arguments[2], encoding="utf-8") as file:
        expected = json.load(file)
    sheet = expected["sheets"][int(arguments[3]) if len(arguments) == 4 else 0]
    scene = empty_scene(expected["fps"])
    sys.stdout.flush()
    verdicts = os.dup(1)
    os.dup2(2, 1)
    rest = import_rest(arguments[1])
    os.dup2(verdicts, 1)
    judgement.check(numpy.array_equal(integers(rest.data.loops, "vertex_index").reshape(-1, 3), sheet["triangles"]), "the .obj has other triangles")
    uv = numpy.zeros((len(rest.data.vertices), 2))
    uv[integers(rest.data.loops, "vertex_index")] = floats(rest.data.uv_layers.active.uv, "vector", 2)
    judgement.near(uv, sheet["uv"], "uvs", "the .obj")
    modifier = rest.modifiers.new("cache", "MESH_CACHE")
    modifier.cache_format, modifier.filepath = "PC2", os.path.abspath(arguments[0])
    modifier.forward_axis, modifier.up_axis = "POS_Y", "POS_Z"
    modifier.frame_start = expected["first_frame"]
    for i, frame in enumerate(sheet["frames"]):
        scene.frame_set(expected["first_frame"] + i)
        mesh = rest.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
        judgement.near(floats(mesh.vertices, "co", 3), frame["x"], "positions", f"frame {expected['first_frame'] + i}")
    return judgement.conclude(f"Blender {bpy.app.version_string}", ("positions", "uvs"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
