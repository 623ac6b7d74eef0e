"""Judges a USD layer with OpenUSD itself (PyPI: usd-core): its validators, then every value at every frame.

    usd_judge.py FILE.usda EXPECTED.json

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
EXPECTED.json is described in alembic_judge.py.
"""

import json
import re
import sys

import numpy
from pxr import Usd, UsdGeom, UsdValidation

from judgement import Judgement


def identifier(name):
    return re.sub(r"[^0-9A-Za-z_]", "_", name)


def z_up(vectors):
    a = numpy.asarray(vectors, dtype=float).reshape(-1, 3)
    return numpy.stack([a[:, 0], -a[:, 2], a[:, 1]], axis=1)


def judge_validators(judgement, stage):
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    for error in context.Validate(stage):
        judgement.check(False, f"validator: {error.GetName()}: {error.GetMessage()}")
    judgement.count("validators passed", 1)


def judge_stage(judgement, stage, expected):
    last = expected["first_frame"] + len(expected["sheets"][0]["frames"]) - 1
    for found, wanted, what in ((stage.GetStartTimeCode(), expected["first_frame"], "first frame"), (stage.GetEndTimeCode(), last, "last frame"),
                                (stage.GetTimeCodesPerSecond(), expected["fps"], "time codes a second"), (stage.GetFramesPerSecond(), expected["fps"], "fps"),
                                (UsdGeom.GetStageMetersPerUnit(stage), 1, "metres a unit"), (UsdGeom.GetStageUpAxis(stage), "Y", "axis up")):
        judgement.check(found == wanted, f"stage: {what} is {found}, expected {wanted}")
    custom = stage.GetRootLayer().customLayerData
    for key, value in expected.get("metadata", {}).items():
        judgement.check(custom.get(key) == value, f"stage: {key} is {custom.get(key)}, expected {value}")


def judge_frame(judgement, mesh, frame, code, where):
    judgement.near(z_up(mesh.GetPointsAttr().Get(code)), frame["x"], "positions", where)
    if "velocity" in frame:
        judgement.near(z_up(mesh.GetVelocitiesAttr().Get(code)), frame["velocity"], "velocities", where)
    if "normal" in frame:
        judgement.near(z_up(mesh.GetNormalsAttr().Get(code)), frame["normal"], "normals", where)
    if "uv" in frame:
        for name in ("st", "pattern"):  # the caches that are judged here have no other uv
            judgement.near(UsdGeom.PrimvarsAPI(mesh).GetPrimvar(name).Get(code), frame["uv"], "uvs", where)
    faces = numpy.asarray(mesh.GetFaceVertexIndicesAttr().Get(code)).reshape(-1, 3)
    judgement.check(numpy.array_equal(faces, frame["triangles"]), f"{where}: faces are not the counter-clockwise triangles")
    judgement.count("faces", len(faces))
    low, high = z_up(mesh.GetExtentAttr().Get(code))
    x = numpy.asarray(frame["x"])
    judgement.near([numpy.minimum(low, high), numpy.maximum(low, high)], [x.min(axis=0), x.max(axis=0)], "extents", where)


def main(arguments):
    if len(arguments) != 2:
        print("usage: usd_judge.py FILE.usda EXPECTED.json")
        return 2
    judgement = Judgement()
    with open(arguments[1], encoding="utf-8") as file:
        expected = json.load(file)
    stage = Usd.Stage.Open(arguments[0])
    judge_validators(judgement, stage)
    judge_stage(judgement, stage, expected)
    for sheet in expected["sheets"]:
        mesh = UsdGeom.Mesh(stage.GetPrimAtPath(f"/shot/{identifier(sheet['name'])}"))
        if not judgement.check(bool(mesh), f"there is no mesh {sheet['name']}"):
            continue
        judgement.check(mesh.GetSubdivisionSchemeAttr().Get() == "none", f"{sheet['name']}: would be subdivided")
        for i, own in enumerate(sheet["frames"]):
            frame = {**{key: sheet[key] for key in ("triangles", "uv") if key in sheet}, **own}
            judge_frame(judgement, mesh, frame, expected["first_frame"] + i, f"{sheet['name']}, frame {expected['first_frame'] + i}")
    return judgement.conclude(f"OpenUSD {'.'.join(map(str, Usd.GetVersion()))}", ("positions", "velocities", "normals", "uvs", "faces"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
