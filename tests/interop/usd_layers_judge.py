"""Judges USD that a bake has written as three layers, with OpenUSD and Blender.

    usd_layers_judge.py ONE LAYERED NAME FRAMES FOLDER

ONE and LAYERED are folders of the same bake, of which LAYERED was made with --usd-layers on; FOLDER takes what is composed here.
The composing layer must show at each frame what the single one shows, the animation must consist of overs alone, the validators
must find no fault, and the animation must go onto an asset that an artist has given other materials, as a sublayer and by
reference. Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import pathlib
import sys

import bpy
import numpy
from pxr import Sdf, Usd, UsdGeom, UsdShade, UsdValidation

from judgement import Judgement


def judge_validators(judgement, path):
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    for error in context.Validate(Usd.Stage.Open(str(path))):
        judgement.check(False, f"{path.name}: {error.GetName()}: {error.GetMessage()}")


def judge_same(judgement, layered, one, frames):
    for prim in one.TraverseAll():
        same = layered.GetPrimAtPath(prim.GetPath())
        if not judgement.check(same and same.GetTypeName() == prim.GetTypeName(), f"{prim.GetPath()} is not composed"):
            continue
        for attribute in prim.GetAuthoredAttributes():
            other = same.GetAttribute(attribute.GetName())
            for frame in frames:
                judgement.check(other.Get(frame) == attribute.Get(frame), f"{attribute.GetPath()} differs in frame {frame}")
                judgement.count("values", 1)
        for relationship in prim.GetAuthoredRelationships():
            targets = same.GetRelationship(relationship.GetName()).GetTargets()
            judgement.check(targets == relationship.GetTargets(), f"{relationship.GetPath()} differs")


def judge_overs(judgement, layer):
    def look(path):
        spec = layer.GetObjectAtPath(path)
        if isinstance(spec, Sdf.PrimSpec):
            judgement.check(spec.specifier == Sdf.SpecifierOver, f"{path} of the animation is no over")
            judgement.count("overs", 1)
        if path.name in ("faceVertexIndices", "primvars:st") and path.GetParentPath().name == "paper":
            judgement.check(False, f"{path} does not change and is in the animation")
    layer.Traverse("/", look)


def judge_purposes(judgement, stage, frames):
    paper, proxy = (UsdGeom.Mesh(stage.GetPrimAtPath(f"/shot/{name}")) for name in ("paper", "paper_proxy"))
    judgement.check(paper.ComputePurpose() == "render", "the sheet has not the purpose render")
    judgement.check(proxy.ComputePurpose() == "proxy", "the simulated mesh has not the purpose proxy")
    found = UsdGeom.Imageable(paper).ComputeProxyPrim()
    judgement.check(found and found[0] == proxy.GetPrim(), "the sheet does not know its proxy")
    for frame in frames:
        sizes = [len(mesh.GetFaceVertexCountsAttr().Get(frame)) for mesh in (paper, proxy)]
        judgement.check(sizes[1] < sizes[0] / 2, f"frame {frame}: the proxy has {sizes[1]} of {sizes[0]} triangles")
        boxes = [numpy.array(mesh.GetExtentAttr().Get(frame)) for mesh in (paper, proxy)]
        judgement.near(boxes[1], boxes[0], "boxes of proxies", f"frame {frame}", 5e-3)


def artists_asset(folder, asset):
    """The asset with a material that the artist binds over it."""
    stage = Usd.Stage.CreateNew(str(folder / "look.usda"))
    UsdGeom.SetStageUpAxis(stage, UsdGeom.Tokens.y)
    UsdGeom.SetStageMetersPerUnit(stage, 1)
    stage.GetRootLayer().subLayerPaths.append(str(asset))
    stage.SetDefaultPrim(stage.GetPrimAtPath("/shot"))
    print_of_page = UsdShade.Material.Define(stage, "/shot/looks/newsprint")
    UsdShade.MaterialBindingAPI.Apply(stage.GetPrimAtPath("/shot/paper")).Bind(print_of_page)
    stage.Save()
    return folder / "look.usda"


def judge_artists_stage(judgement, stage, one, root, frames):
    mesh = UsdGeom.Mesh(stage.GetPrimAtPath(f"{root}/paper"))
    material = UsdShade.MaterialBindingAPI(mesh).ComputeBoundMaterial()[0]
    judgement.check(material and material.GetPath() == f"{root}/looks/newsprint", f"{root}: the sheet wears {material.GetPath()}")
    wanted = UsdGeom.Mesh(one.GetPrimAtPath("/shot/paper"))
    for frame in frames:
        judgement.near(mesh.GetPointsAttr().Get(frame), wanted.GetPointsAttr().Get(frame), "points on the artist's asset", f"frame {frame}", 0)


def judge_artists_asset(judgement, folder, files, one, frames):
    look = artists_asset(folder, files["asset"])
    below = Usd.Stage.CreateNew(str(folder / "sublayers.usda"))
    below.GetRootLayer().subLayerPaths = [str(files["animation"]), str(look)]
    judge_artists_stage(judgement, below, one, "/shot", frames)
    by_reference = Usd.Stage.CreateNew(str(folder / "references.usda"))
    references = by_reference.DefinePrim("/World/letter").GetReferences()
    for layer in (files["animation"], look):
        references.AddReference(str(layer))
    judge_artists_stage(judgement, by_reference, one, "/World/letter", frames)


def judge_blender(judgement, path, one, frame):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.wm.usd_import(filepath=str(path), import_proxy=False)
    bpy.context.scene.frame_set(frame)
    meshes = [thing for thing in bpy.context.scene.objects if thing.type == "MESH"]
    if not judgement.check(len(meshes) == 1, f"Blender finds {[thing.name for thing in meshes]}"):
        return
    shown = meshes[0].evaluated_get(bpy.context.evaluated_depsgraph_get())
    x = numpy.array([meshes[0].matrix_world @ vertex.co for vertex in shown.data.vertices])
    y_up = numpy.array(UsdGeom.Mesh(one.GetPrimAtPath("/shot/paper")).GetPointsAttr().Get(frame))
    judgement.near(x, numpy.stack([y_up[:, 0], -y_up[:, 2], y_up[:, 1]], axis=1), "points in Blender", path.name, 2e-6)


def main(arguments):
    if len(arguments) != 5:
        print("usage: usd_layers_judge.py ONE LAYERED NAME FRAMES FOLDER")
        return 2
    judgement = Judgement()
    single, layered, folder = (pathlib.Path(arguments[i]).resolve() for i in (0, 1, 4))
    folder.mkdir(parents=True, exist_ok=True)
    name, last = arguments[2], int(arguments[3])
    frames = range(1, last + 1)
    for ending in ("usda", "usdc"):
        own = folder / ending
        own.mkdir(exist_ok=True)
        for old in own.iterdir():
            old.unlink()
        files = {part: layered / f"{name}.{part}.{ending}" for part in ("asset", "animation")}
        composed = layered / f"{name}.{ending}"
        for path in (composed, files["asset"]):
            judge_validators(judgement, path)
        one, stage = (Usd.Stage.Open(str(path)) for path in (single / f"{name}.{ending}", composed))
        judge_same(judgement, stage, one, frames)
        judge_overs(judgement, Sdf.Layer.FindOrOpen(str(files["animation"])))
        judge_purposes(judgement, stage, frames)
        judge_artists_asset(judgement, own, files, one, frames)
        judge_blender(judgement, composed, one, last)
    return judgement.conclude(f"OpenUSD {'.'.join(map(str, Usd.GetVersion()))} and Blender", ("values", "overs", "points in Blender"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
