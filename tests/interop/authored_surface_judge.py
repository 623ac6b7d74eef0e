"""Judges whether what an artist made of a sheet comes back: uv sets, materials, names, custom properties.

    authored_surface_judge.py author FOLDER                 writes plain.glb, plain.fbx, seam.glb, seam.fbx with Blender
    authored_surface_judge.py alembic|usd|blender FOLDER    judges FOLDER/NAME.SUFFIX/NAME.abc or .usda, a bake of each

The sheet is a newspaper of 0.2 x 0.3 m whose uv set "Print" covers 0 to 1. "seam" has besides a set "Back" that is cut in the
middle, and another material there; in "plain" that set is one map and there is one material.
Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import pathlib
import sys

import numpy

from judgement import Judgement

SIZE = numpy.array([0.2, 0.3])  # [m]
NEAR = 2e-6                     # uv: 32-bit floats, twice rounded
FRONT, SPORT = "Front page", "Sport.2"
PROPERTIES = {"title": "Daily", "edition": 3.0}
SCENES = [(kind, suffix) for kind in ("plain", "seam") for suffix in ("glb", "fbx")]


def print_uv(pattern):
    return pattern / SIZE


def back_uv(pattern, right, seam):
    u, v = print_uv(pattern).T
    cut = numpy.stack([numpy.where(right, u + 1, u), numpy.where(right, 0.5 * v, v)], axis=1)
    return cut if seam else numpy.stack([2 * u, 3 * v], axis=1)


def author(folder):
    import bpy

    for seam in (False, True):
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        scene.frame_start, scene.frame_end = 1, 4
        bpy.ops.mesh.primitive_grid_add(x_subdivisions=4, y_subdivisions=3, size=1)
        sheet = bpy.context.object
        sheet.name, sheet.scale = "paper.News", (*SIZE, 1)
        bpy.ops.object.transform_apply(scale=True)
        mesh = sheet.data
        mesh.uv_layers[0].name = "Print"
        mesh.uv_layers.new(name="Back")
        for face in mesh.polygons:
            right = face.center.x > 0
            for corner in face.loop_indices:
                pattern = numpy.array(mesh.vertices[mesh.loops[corner].vertex_index].co[:2]) + SIZE / 2
                mesh.uv_layers["Print"].data[corner].uv = print_uv(pattern)
                mesh.uv_layers["Back"].data[corner].uv = back_uv(pattern[None], right, seam)[0]
            face.material_index = int(right and seam)
        for name in (FRONT, SPORT)[:1 + seam]:
            mesh.materials.append(bpy.data.materials.new(name))
        for key, value in PROPERTIES.items():
            sheet[key] = value
        sheet["paper_uv_sets"] = "Print\nBack"  # glTF has no names for them
        for i, x in enumerate((-0.1, 0.1)):
            handle = bpy.data.objects.new(f"handle.{i}", None)
            scene.collection.objects.link(handle)
            for frame, place in ((1, (x, -0.15, 0)), (4, (0.95 * x, -0.13, 0.02))):
                handle.location = place
                handle.keyframe_insert("location", frame=frame)
        name = "seam" if seam else "plain"
        bpy.ops.export_scene.gltf(filepath=f"{folder}/{name}.glb", export_extras=True)
        bpy.ops.export_scene.fbx(filepath=f"{folder}/{name}.fbx", use_custom_props=True, bake_anim_simplify_factor=0)


def judge_sheet(judgement, where, seam, found):
    """found: {"uv": {name: |C|x2}, "pattern": |C|x2, "centre": |T|x2 of the pattern, "materials": |T| names, "properties"}, corners face by face."""
    pattern = found["pattern"] * SIZE.max()
    right = numpy.repeat(found["centre"][:, 0] * SIZE.max() > SIZE[0] / 2, 3)
    judgement.check(set(found["uv"]) == {"Print", "Back"}, f"{where}: uv sets are {sorted(found['uv'])}")
    if set(found["uv"]) == {"Print", "Back"}:
        judgement.near(found["uv"]["Print"], print_uv(pattern), "uvs", f"{where}, Print", NEAR)
        judgement.near(found["uv"]["Back"], back_uv(pattern, right, seam), "uvs", f"{where}, Back", 3 * NEAR)
        low, high = found["uv"]["Print"].min(axis=0), found["uv"]["Print"].max(axis=0)
        judgement.near([low, high], [[0, 0], [1, 1]], "uvs", f"{where}, range of Print", NEAR)
    wanted = numpy.where(right[::3] & seam, SPORT, FRONT)
    judgement.check(list(found["materials"]) == list(wanted), f"{where}: {sum(a != b for a, b in zip(found['materials'], wanted))} faces have another material")
    judgement.count("faces", len(wanted))
    for key, value in PROPERTIES.items():
        own = found["properties"].get(key)
        judgement.check(own == value, f"{where}: the property {key} is {own}")
    judgement.check(not any(key.startswith("paper_") for key in found["properties"]), f"{where}: properties for the bake came along")


def centres(pattern):
    return pattern.reshape(-1, 3, 2).mean(axis=1)


def of_alembic(path):
    from alembic3d import Abc, AbcGeom

    existing = Abc.WrapExistingFlag.kWrapExisting
    (xform,) = Abc.IArchive(str(path)).getTop().children
    (child,) = xform.children
    mesh = AbcGeom.IPolyMesh(child, existing)
    schema = mesh.getSchema()

    def corners(param):
        values = param.getExpandedValue(Abc.ISampleSelector(0)).getVals()
        return numpy.array([(v.x, v.y) for v in values]).reshape(-1, 3, 2)[:, ::-1].reshape(-1, 2)

    named = {schema.getArbGeomParams().getPropertyHeader(i).getName() for i in range(schema.getArbGeomParams().getNumProperties())}
    uv = {name: corners(AbcGeom.IV2fGeomParam(schema.getArbGeomParams(), name)) for name in named - {"crease"}}
    first = schema.getUVsParam()
    uv[first.getMetaData().get("sourceName")] = corners(first)
    pattern = uv.pop("pattern")
    materials = numpy.full(len(pattern) // 3, "", dtype=object)
    for name in schema.getFaceSetNames():
        faces = schema.getFaceSet(name).getSchema().getValue(Abc.ISampleSelector(0)).getFaces()
        materials[numpy.array(list(faces))] = name
    user = schema.getUserProperties()
    kinds = {"title": Abc.IStringProperty, "edition": Abc.IDoubleProperty}
    headers = [user.getPropertyHeader(i).getName() for i in range(user.getNumProperties())]
    properties = {name: kinds[name](user, name).getValue() if name in kinds else None for name in headers}
    return {"uv": uv, "pattern": pattern, "centre": centres(pattern), "materials": materials, "properties": properties}


def of_usd(path):
    from pxr import Usd, UsdGeom, UsdShade, UsdValidation

    stage = Usd.Stage.Open(str(path))
    errors = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators()).Validate(stage)
    assert not errors, [error.GetMessage() for error in errors]
    prim = stage.GetPrimAtPath("/shot/paper_News")
    assert prim.GetMetadata("displayName") == "paper.News"
    mesh, primvars = UsdGeom.Mesh(prim), UsdGeom.PrimvarsAPI(prim)
    vertices = numpy.array(mesh.GetFaceVertexIndicesAttr().Get(1))
    uv = {name: numpy.array(primvars.GetPrimvar(name).ComputeFlattened(1)) for name in ("st", "Print", "Back") if primvars.GetPrimvar(name)}
    assert numpy.array_equal(uv.pop("st"), uv["Print"]), "st is not the first uv set"
    pattern = numpy.array(primvars.GetPrimvar("pattern").Get(1))[vertices]
    materials = numpy.full(len(vertices) // 3, "", dtype=object)

    def bound(of):
        material = UsdShade.MaterialBindingAPI(of).ComputeBoundMaterial()[0]
        return material.GetPrim().GetMetadata("displayName") if material else ""

    subsets = UsdShade.MaterialBindingAPI(prim).GetMaterialBindSubsets()
    if not subsets:
        materials[:] = bound(prim)
    for subset in subsets:
        materials[numpy.array(subset.GetIndicesAttr().Get(1))] = bound(subset.GetPrim())
    properties = {a.GetBaseName(): a.Get() for a in prim.GetAttributes() if a.GetName().startswith("userProperties:")}
    return {"uv": uv, "pattern": pattern, "centre": centres(pattern), "materials": materials, "properties": properties}


def of_blender(path):
    """As Blender imports the Alembic cache; it takes no user properties from there."""
    import bpy

    from blender_judge import empty_scene, floats, imported, integers

    scene = empty_scene(24)
    assert imported(path)
    (thing,) = (o for o in scene.objects if o.type == "MESH")
    mesh = thing.data
    uv = {layer.name: floats(layer.uv, "vector", 2) for layer in mesh.uv_layers}
    pattern = uv.pop("pattern")
    slots = [slot.material.name for slot in thing.material_slots]
    materials = [slots[i] for i in integers(mesh.polygons, "material_index")]
    return {"uv": uv, "pattern": pattern, "centre": centres(pattern), "materials": materials, "properties": PROPERTIES}


def main(arguments):
    what, folder = arguments[0], pathlib.Path(arguments[1])
    if what == "author":
        author(folder)
        return 0
    judgement = Judgement()
    read = {"alembic": of_alembic, "usd": of_usd, "blender": of_blender}[what]
    for kind, suffix in SCENES:
        path = folder / f"{kind}.{suffix}.out" / f"{kind}.{'usda' if what == 'usd' else 'abc'}"
        judge_sheet(judgement, f"{kind}.{suffix}", kind == "seam", read(path))
    return judgement.conclude(what, ("uvs", "faces"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
