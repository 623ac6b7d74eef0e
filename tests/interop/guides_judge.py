"""Judges singular points and folds of a bake, as the Alembic library, OpenUSD and Blender read them.

    guides_judge.py FOLDER NAME

FOLDER has NAME.abc and NAME.usdc of one sheet, baked with --guides on, and singular.csv. A singular point must lie where the
vertex of the mesh lies that has its place on the pattern, from its birth on; folds must lie on the mesh; all three readers must
find the same. Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import csv
import json
import os
import pathlib
import sys

import bpy
import numpy
from alembic3d import Abc, AbcGeom
from pxr import Usd, UsdGeom

from blender_judge import imported
from judgement import Judgement

ON_MESH = 2e-6  # [m] positions are 32-bit floats
EXISTING = Abc.WrapExistingFlag.kWrapExisting


def rows(vectors):
    return numpy.array([tuple(v) for v in vectors], dtype=float).reshape(-1, 3)


def usd_frame(stage, code):
    points, folds = (stage.GetPrimAtPath(f"/shot/paper_{kind}") for kind in ("points", "folds"))
    curves = UsdGeom.BasisCurves(folds)

    def primvar(prim, name):
        return list(UsdGeom.PrimvarsAPI(prim).GetPrimvar(name).Get(code))
    return {"points": rows(UsdGeom.Points(points).GetPointsAttr().Get(code)), "point_id": primvar(points, "point_id"),
            "point_birth": primvar(points, "birth"), "folds": rows(curves.GetPointsAttr().Get(code)),
            "fold_size": list(curves.GetCurveVertexCountsAttr().Get(code)), "fold_id": primvar(folds, "fold_id"),
            "fold_birth": primvar(folds, "birth"), "angle": primvar(folds, "angle")}


def alembic_frame(archive, time):
    shapes = {child.getName(): child.children[0] for child in archive.getTop().children}
    selector = Abc.ISampleSelector(time)
    points = AbcGeom.IPoints(shapes["paper_points"], EXISTING).getSchema()
    curves = AbcGeom.ICurves(shapes["paper_folds"], EXISTING).getSchema()
    sample, curve = points.getValue(selector), curves.getValue(selector)

    def parameter(schema, kind, name):
        return list(kind(schema.getArbGeomParams(), name).getExpandedValue(selector).getVals())
    whole = AbcGeom.IInt32GeomParam
    assert curve.getType() == AbcGeom.CurveType.kLinear and curve.getWrap() == AbcGeom.CurvePeriodicity.kNonPeriodic
    return {"points": rows(sample.getPositions()), "point_id": list(sample.getIds()), "point_birth": parameter(points, whole, "birth"),
            "folds": rows(curve.getPositions()), "fold_size": list(curve.getCurvesNumVertices()),
            "fold_id": parameter(curves, whole, "fold_id"), "fold_birth": parameter(curves, whole, "birth"),
            "angle": parameter(curves, AbcGeom.IFloatGeomParam, "angle")}


def blender_frame(path, frame):
    """What of it Blender reads: of Alembic no parameters."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 24
    if path.suffix == ".abc":
        imported(path)
    else:
        bpy.ops.wm.usd_import(filepath=str(path), import_guide=True)
    scene.frame_set(frame)
    graph = bpy.context.evaluated_depsgraph_get()
    found = {}
    for name, places in (("paper_points", "points"), ("paper_folds", "folds")):
        thing = scene.objects[name].evaluated_get(graph)
        values = numpy.empty(3 * len(thing.data.points), dtype=numpy.float32)
        thing.data.attributes["position"].data.foreach_get("vector", values)
        world = numpy.array(thing.matrix_world)
        x, y, z = (values.reshape(-1, 3) @ world[:3, :3].T + world[:3, 3]).T
        found[places] = numpy.stack([x, z, -y], axis=1)  # y up, as in the files
    folds = scene.objects["paper_folds"].evaluated_get(graph).data
    found["fold_size"] = [curve.points_length for curve in folds.curves]
    if path.suffix != ".abc":
        found["fold_id"] = [item.value for item in folds.attributes["fold_id"].data]
        found["angle"] = [item.value for item in folds.attributes["angle"].data]
    return found


def distance_to_triangles(point, a, b, c):
    """Of a point that lies above the inside of one of them, or on an edge; larger for others."""
    normal = numpy.cross(b - a, c - a)
    normal /= numpy.linalg.norm(normal, axis=1)[:, None]
    height = numpy.einsum("ij,ij->i", point - a, normal)
    foot = point - height[:, None] * normal
    outside = numpy.zeros(len(a))
    for p, q in ((a, b), (b, c), (c, a)):
        edge = numpy.cross(normal, q - p)
        outside = numpy.minimum(outside, numpy.einsum("ij,ij->i", foot - p, edge) / numpy.linalg.norm(edge, axis=1))
    return numpy.min(abs(height) - outside)


def judge_places(judgement, stage, code, side, singular, guides):
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath("/shot/paper"))
    x = rows(mesh.GetPointsAttr().Get(code))
    pattern = side * numpy.array(UsdGeom.PrimvarsAPI(mesh).GetPrimvar("pattern").Get(code), dtype=float)
    born = [row for row in singular if int(row["frame"]) <= code]
    judgement.check(guides["point_id"] == [int(row["id"]) for row in born], f"frame {code}: points {guides['point_id']}")
    judgement.check(guides["point_birth"] == [int(row["frame"]) for row in born], f"frame {code}: other births")
    for row, place in zip(born, guides["points"]):
        off = numpy.linalg.norm(pattern - [float(row["u"]), float(row["v"])], axis=1)
        judgement.check(off.min() < 1e-6, f"frame {code}: point {row['id']} is no vertex of the mesh")
        judgement.near(place, x[off.argmin()], "singular points", f"frame {code}, point {row['id']}", ON_MESH)
    faces = numpy.array(mesh.GetFaceVertexIndicesAttr().Get(code)).reshape(-1, 3)
    a, b, c = (x[faces[:, corner]] for corner in range(3))
    for place in guides["folds"][::7]:
        off = distance_to_triangles(place, a, b, c)
        judgement.check(off < ON_MESH, f"frame {code}: a point of a fold is {off:.3g} m off the mesh")
    judgement.count("points of folds", len(guides["folds"][::7]))


def judge_same(judgement, found, wanted, where):
    for key, values in found.items():
        if key in ("points", "folds", "angle"):
            judgement.near(numpy.asarray(values).reshape(-1), numpy.asarray(wanted[key]).reshape(-1), f"{key} of a second reader", where)
        else:
            judgement.check(list(values) == list(wanted[key]), f"{where}: {key} differ")


def main(arguments):
    if len(arguments) != 2:
        print("usage: guides_judge.py FOLDER NAME")
        return 2
    judgement = Judgement()
    folder = pathlib.Path(os.path.abspath(arguments[0]))
    sheet = json.loads((folder / "cert" / "summary.json").read_text(encoding="utf-8"))["sheets"][0]
    side = max(sheet["width_m"], sheet["height_m"])
    abc, usd = folder / f"{arguments[1]}.abc", folder / f"{arguments[1]}.usdc"
    stage, archive = Usd.Stage.Open(str(usd)), Abc.IArchive(str(abc))
    with open(folder / "singular.csv", encoding="utf-8") as file:
        singular = list(csv.DictReader(file))
    for purpose in ("paper_points", "paper_folds"):
        prim = UsdGeom.Imageable(stage.GetPrimAtPath(f"/shot/{purpose}"))
        judgement.check(prim.GetPurposeAttr().Get() == "guide", f"{purpose} would be rendered")
    last = int(stage.GetEndTimeCode())
    for code in (1, last // 2, last):
        guides = usd_frame(stage, code)
        judge_places(judgement, stage, code, side, singular, guides)
        judge_same(judgement, alembic_frame(archive, code / stage.GetTimeCodesPerSecond()), guides, f"Alembic, frame {code}")
    for path in (abc, usd):
        judge_same(judgement, blender_frame(path, last), usd_frame(stage, last), f"Blender, {path.name}")
    return judgement.conclude("Alembic, OpenUSD and Blender", ("singular points", "points of folds", "folds of a second reader"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
