"""Judges whether a USD layer shows what the Alembic cache of the same bake shows, in Blender; OpenUSD's validators; and the
numbers of damage, which only the layer has.

    same_mesh_judge.py FILE.abc FILE.usda FRAME...

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import math
import sys

import bpy
import numpy
from pxr import Usd, UsdGeom

from blender_judge import empty_scene, floats, imported, integers
from judgement import Judgement
from usd_judge import judge_validators

LAYERS = ("crease", "foldAngle", "foldPlastic", "foldPeak", "apexDistance", "apexAge")
NORMAL_TOLERANCE = 2e-3  # [rad] Blender keeps custom normals as two 16-bit angles, in the frame of each mesh


def meshes(path, frames):
    """The first sheet at some frames, in the world."""
    scene = empty_scene(24)
    if not imported(path):
        return []
    found = []
    for frame in frames:
        scene.frame_set(frame)
        sheet = next(o for o in scene.objects if o.type == "MESH").evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = sheet.to_mesh()
        turn = [row[:3] for row in sheet.matrix_world.transposed()][:3]
        found.append({"positions": floats(mesh.vertices, "co", 3) @ turn, "corner normals": floats(mesh.corner_normals, "vector", 3) @ turn,
                      "velocities": floats(mesh.attributes["velocity"].data, "vector", 3) @ turn,
                      "corners": integers(mesh.loops, "vertex_index"), "channels": {a.name for a in mesh.attributes}})
        sheet.to_mesh_clear()
    return found


def judge_layers(judgement, stage, frames):
    """Numbers of damage at every vertex and frame; the peaks are peaks."""
    (mesh,) = (UsdGeom.Mesh(prim) for prim in stage.Traverse() if prim.IsA(UsdGeom.Mesh))
    primvars = UsdGeom.PrimvarsAPI(mesh)
    most = 0
    for frame in frames:
        points = len(mesh.GetPointsAttr().Get(frame))
        found = {}
        for name in LAYERS:
            primvar = primvars.GetPrimvar(name)
            if not judgement.check(primvar.HasValue() and primvar.GetInterpolation() == "vertex", f"there is no primvar {name} of vertices"):
                return
            found[name] = numpy.array(primvar.Get(frame), dtype=float)
            judgement.check(found[name].shape == (points,) and numpy.isfinite(found[name]).all(), f"frame {frame}: {name} has {found[name].shape} numbers for {points} points")
        for name in ("foldAngle", "foldPlastic", "foldPeak"):
            judgement.check(abs(found[name]).max() < math.pi + 1e-3, f"frame {frame}: a {name} of {abs(found[name]).max()} rad")
        judgement.check((abs(found["foldPeak"]) >= abs(found["foldAngle"]) - 2e-4).all(), f"frame {frame}: a peak is less than the fold")
        judgement.check(abs(found["foldPeak"]).max() >= most - 2e-4, f"frame {frame}: the largest peak has become smaller")
        most = abs(found["foldPeak"]).max()
        judgement.check(((found["apexAge"] >= 0) | (found["apexAge"] == -1)).all() and (found["apexDistance"] >= 0).all(), f"frame {frame}: ages or distances below 0")
        judgement.count("layers", len(LAYERS))
    judgement.check(most > 0.5, f"the sheet is folded by {most} rad at most: this judges nothing")


def main(arguments):
    if len(arguments) < 3:
        print("usage: same_mesh_judge.py FILE.abc FILE.usda FRAME...")
        return 2
    frames = [int(frame) for frame in arguments[2:]]
    judgement = Judgement()
    stage = Usd.Stage.Open(arguments[1])
    judge_validators(judgement, stage)
    judge_layers(judgement, stage, frames)
    cache, layer = meshes(arguments[0], frames), meshes(arguments[1], frames)
    judgement.check(len(cache) == len(layer) == len(frames), "Blender does not import both files")
    for frame, a, b in zip(frames, cache, layer):
        where = f"frame {frame}"
        for kind, tolerance in (("positions", 1e-6), ("velocities", 1e-6), ("corner normals", NORMAL_TOLERANCE)):
            judgement.near(b[kind], a[kind], kind, where, tolerance)
        judgement.check((a["corners"] == b["corners"]).all(), f"{where}: other faces")
        judgement.check("crease" in a["channels"] and "crease" in b["channels"], f"{where}: no creases")
    return judgement.conclude(f"Blender {bpy.app.version_string}", ("positions", "velocities", "corner normals", "layers"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
