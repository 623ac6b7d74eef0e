"""Judges whether what an artist made of a sheet comes back: uv sets, colours, attributes, materials, names, custom properties.

    authored_surface_judge.py author FOLDER                 writes plain.glb, plain.fbx, seam.glb, seam.fbx with Blender
    authored_surface_judge.py READER FOLDER                 judges FOLDER/NAME.SUFFIX/NAME.abc or .usda, a bake of each, as one
                                                            of alembic, usd, blender, blender_usd reads it

The sheet is a newspaper of 0.2 x 0.3 m whose uv set "Print" covers 0 to 1. "seam" has besides a set "Back" that is cut in the
middle, and another material there; in "plain" that set is one map and there is one material. The colour "Dye" jumps there, too.
Of FBX only colours are read: what the others are called there are colours that Blender's exporter makes of them.
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
SHORTS = 1 / 65535              # in which Blender writes the colour of a material
ATTRIBUTES = {                  # name: what kind, how near. "_Stain" is told to be a colour, "_Four" is not
    "Dye": ("colour", SHORTS),
    "Stain": ("colour", 4 * NEAR),
    "Wear": ("number", 100 * NEAR),
    "Pair": ("number", 7 * NEAR),
    "SHIFT": ("number", 4 * NEAR),
    "Four": ("number", 4 * NEAR),
}
SCENES = [(kind, suffix) for kind in ("plain", "seam") for suffix in ("glb", "fbx")]


def print_uv(pattern):
    return pattern / SIZE


def back_uv(pattern, right, seam):
    u, v = print_uv(pattern).T
    cut = numpy.stack([numpy.where(right, u + 1, u), numpy.where(right, 0.5 * v, v)], axis=1)
    return cut if seam else numpy.stack([2 * u, 3 * v], axis=1)


def attributes(pattern, right, seam):
    """{name: |C|x1..4} as authored, but for rounding."""
    u, v = print_uv(pattern).T
    zero = numpy.zeros_like(u)
    columns = {
        "Dye": (0.2 + 0.6 * u, 0.9 - 0.5 * v, numpy.where(right & seam, 0.8, 0.3), zero + 1),
        "Stain": (u, v, zero + 2.5, zero + 0.5),
        "Wear": (100 * u - 20 * v,),
        "Pair": (7 * u, v),
        "SHIFT": (u, v, u + v),
        "Four": (u, v, zero + 3, zero - 4),
    }
    return {name: numpy.stack(values, axis=1) for name, values in columns.items()}


def put_attributes(mesh, seam):
    """On the mesh as an artist has them, with the names for glTF."""
    corner = numpy.array([loop.vertex_index for loop in mesh.loops])
    places = numpy.array([vertex.co[:2] for vertex in mesh.vertices]) + SIZE / 2
    right = numpy.zeros(len(corner), dtype=bool)
    for face in mesh.polygons:
        right[list(face.loop_indices)] = face.center.x > 0
    of_vertices, of_corners = attributes(places, places[:, 0] > SIZE[0] / 2, seam), attributes(places[corner], right, seam)
    for name, given, kind, domain, member, values in (
            ("Dye", "Dye", "FLOAT_COLOR", "CORNER", "color", of_corners), ("Stain", "_Stain", "FLOAT_COLOR", "POINT", "color", of_vertices),
            ("Wear", "_Wear", "FLOAT", "POINT", "value", of_vertices), ("Pair", "_Pair", "FLOAT2", "POINT", "vector", of_vertices),
            ("SHIFT", "_shift", "FLOAT_VECTOR", "POINT", "vector", of_vertices), ("Four", "_Four", "FLOAT_COLOR", "POINT", "color", of_vertices)):
        mesh.attributes.new(given, kind, domain).data.foreach_set(member, values[name].ravel())
    mesh.color_attributes.active_color_index = mesh.color_attributes.render_color_index = mesh.color_attributes.find("Dye")


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
        put_attributes(mesh, seam)
        sheet["paper_uv_sets"] = "Print\nBack"  # glTF has no names for them
        sheet["paper_colours"], sheet["paper_attributes"] = "Color=Dye\nSTAIN=Stain\n_Stain=Stain", "WEAR=Wear\nPAIR=Pair\nFOUR=Four"
        for i, x in enumerate((-0.1, 0.1)):
            handle = bpy.data.objects.new(f"handle.{i}", None)
            scene.collection.objects.link(handle)
            for frame, place in ((1, (x, -0.15, 0)), (4, (0.95 * x, -0.13, 0.02))):
                handle.location = place
                handle.keyframe_insert("location", frame=frame)
        name = "seam" if seam else "plain"
        bpy.ops.export_scene.gltf(filepath=f"{folder}/{name}.glb", export_extras=True, export_attributes=True, export_vertex_color="ACTIVE",
                                  export_all_vertex_colors=False)
        bpy.ops.export_scene.fbx(filepath=f"{folder}/{name}.fbx", use_custom_props=True, bake_anim_simplify_factor=0, colors_type="LINEAR")


def judge_attributes(judgement, where, what, found, wanted):
    """found: {name: (kind, |C|x1..4)}"""
    reads = {"alembic": ATTRIBUTES, "usd": ATTRIBUTES, "blender": ("Dye", "Stain"), "blender_usd": [name for name in ATTRIBUTES if name != "Four"]}[what]
    expected = {name: ATTRIBUTES[name] for name in reads}
    if where.endswith("fbx"):
        expected = {name: expected[name] for name in ("Dye", "Stain")}
        expected["_Four"] = ("colour", 4 * NEAR)
        wanted = {**wanted, "_Four": wanted["Four"]}
    kinds = {name: kind for name, (kind, _) in found.items()}
    judgement.check(kinds == {name: kind for name, (kind, _) in expected.items()}, f"{where}: the attributes are {kinds}")
    for name, (kind, near) in expected.items():
        if name not in found:
            continue
        values = found[name][1]
        if what == "blender":  # it makes bytes of colours of Alembic, and takes them for those of a screen
            judgement.near(values, numpy.clip(wanted[name], 0, 1), "colours", f"{where}, {name}", 0.6 / 255)
        else:
            judgement.near(values, wanted[name], "colours" if kind == "colour" else "numbers", f"{where}, {name}", near)


def judge_sheet(judgement, where, what, seam, found):
    """found: {"uv": {name: |C|x2}, "attributes": {name: (kind, |C|x1..4)}, "pattern": |C|x2, "centre": |T|x2 of the pattern,
    "materials": |T| names, "properties"}, corners face by face."""
    pattern = found["pattern"] * SIZE.max()
    right = numpy.repeat(found["centre"][:, 0] * SIZE.max() > SIZE[0] / 2, 3)
    judgement.check(set(found["uv"]) == {"Print", "Back"}, f"{where}: uv sets are {sorted(found['uv'])}")
    if set(found["uv"]) == {"Print", "Back"}:
        judgement.near(found["uv"]["Print"], print_uv(pattern), "uvs", f"{where}, Print", NEAR)
        judgement.near(found["uv"]["Back"], back_uv(pattern, right, seam), "uvs", f"{where}, Back", 3 * NEAR)
        low, high = found["uv"]["Print"].min(axis=0), found["uv"]["Print"].max(axis=0)
        judgement.near([low, high], [[0, 0], [1, 1]], "uvs", f"{where}, range of Print", NEAR)
    judge_attributes(judgement, where, what, found["attributes"], attributes(pattern, right, seam))
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

    def corners(param, members=("x", "y")):
        values = param.getExpandedValue(Abc.ISampleSelector(0)).getVals()
        rows = numpy.array([[getattr(v, member) for member in members] for v in values] if members else values)
        rows = rows.reshape(-1, len(members) or param.getArrayExtent())
        return rows.reshape(-1, 3, rows.shape[1])[:, ::-1].reshape(-1, rows.shape[1])

    params, uv, attributes_ = schema.getArbGeomParams(), {}, {}
    for i in range(params.getNumProperties()):
        header = params.getPropertyHeader(i)
        name = header.getName()
        if name == "crease":
            continue
        if AbcGeom.IV2fGeomParam.matches(header):
            uv[name] = corners(AbcGeom.IV2fGeomParam(params, name))
        elif AbcGeom.IC4fGeomParam.matches(header):
            attributes_[name] = ("colour", corners(AbcGeom.IC4fGeomParam(params, name), "rgba"))
        elif AbcGeom.IV3fGeomParam.matches(header):
            attributes_[name] = ("number", corners(AbcGeom.IV3fGeomParam(params, name), "xyz"))
        elif AbcGeom.IFloatGeomParam.matches(header):
            attributes_[name] = ("number", corners(AbcGeom.IFloatGeomParam(params, name), ()))
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
    return {"uv": uv, "attributes": attributes_, "pattern": pattern, "centre": centres(pattern), "materials": materials, "properties": properties}


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
    types = {"color4f[]": "colour", "float[]": "number", "float2[]": "number", "float3[]": "number", "float4[]": "number"}
    attributes_ = {}
    for primvar in primvars.GetPrimvars():
        kind = types.get(str(primvar.GetTypeName()))
        if kind and primvar.GetInterpolation() == "faceVarying":
            attributes_[primvar.GetPrimvarName()] = kind, numpy.array(primvar.ComputeFlattened(1)).reshape(len(vertices), -1)
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
    return {"uv": uv, "attributes": attributes_, "pattern": pattern, "centre": centres(pattern), "materials": materials, "properties": properties}


def on_screen(linear):
    """The byte of a colour from what Blender says it is. source  IEC 61966-2-1"""
    curved = numpy.where(linear <= 0.0031308, 12.92 * linear, 1.055 * numpy.maximum(linear, 1e-9) ** (1 / 2.4) - 0.055)
    return numpy.concatenate([curved[:, :3], linear[:, 3:]], axis=1)


def attributes_of_blender(mesh):
    from blender_judge import floats

    kinds = {"BYTE_COLOR": ("color", 4), "FLOAT_COLOR": ("color", 4), "FLOAT": ("value", 1), "FLOAT2": ("vector", 2), "FLOAT_VECTOR": ("vector", 3)}
    found = {}
    for attribute in mesh.attributes:
        if attribute.domain != "CORNER" or attribute.data_type not in kinds or attribute.name in ("crease", "normals", "Print", "Back", "pattern", "st"):
            continue
        member, width = kinds[attribute.data_type]
        values = floats(attribute.data, member, width).reshape(-1, width)
        if attribute.data_type == "BYTE_COLOR":
            values = on_screen(values)
        found[attribute.name] = "colour" if member == "color" else "number", values
    return found


def of_blender(path):
    """As Blender imports the cache; it takes no user properties of Alembic."""
    import bpy

    from blender_judge import empty_scene, floats, imported, integers

    scene = empty_scene(24)
    assert imported(path)
    (thing,) = (o for o in scene.objects if o.type == "MESH")
    mesh = thing.data
    uv = {layer.name: floats(layer.uv, "vector", 2) for layer in mesh.uv_layers if layer.name not in ("Pair", "st")}  # pairs of corners are uv maps there
    pattern = uv.pop("pattern")
    in_usd = {name.replace(" ", "_").replace(".", "_"): name for name in (FRONT, SPORT)}
    slots = [in_usd.get(slot.material.name, slot.material.name) for slot in thing.material_slots]
    materials = [slots[i] for i in integers(mesh.polygons, "material_index")]
    return {"uv": uv, "attributes": attributes_of_blender(mesh), "pattern": pattern, "centre": centres(pattern), "materials": materials, "properties": PROPERTIES}


def main(arguments):
    what, folder = arguments[0], pathlib.Path(arguments[1])
    if what == "author":
        author(folder)
        return 0
    judgement = Judgement()
    read = {"alembic": of_alembic, "usd": of_usd, "blender": of_blender, "blender_usd": of_blender}[what]
    for kind, suffix in SCENES:
        path = folder / f"{kind}.{suffix}.out" / f"{kind}.{'usda' if what.endswith('usd') else 'abc'}"
        judge_sheet(judgement, f"{kind}.{suffix}", what, kind == "seam", read(path))
    return judgement.conclude(what, ("uvs", "faces", "colours") + (() if what == "blender" else ("numbers",)))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
