"""Takes what an artist has put on the vertices of a sheet through a bake: vertex groups, colours and other attributes.

They are sent as attributes whose names glTF allows, and properties of the sheet tell their own ones. They are brought back from the USD layer:
of Alembic Blender reads colours alone, and these with 8 bits. They go onto the mesh of the paper, which the cache moves and otherwise leaves as
it is."""

import collections
import contextlib

import bpy

from . import names

BLENDERS_OWN = {"position", "sharp_face", "sharp_edge", "material_index", "crease_edge", "crease_vert", "bevel_weight_edge", "bevel_weight_vert",
                "custom_normal", "freestyle_edge", "freestyle_face", "uv_seam", "id"}  # attributes that Blender makes, or that are read otherwise
OF_CACHE = {"crease", "pattern", "velocity"}  # what the paper has besides
OF_USD = {"st", "normals", "displayColor", "displayOpacity"}  # and what is taken in USD alone
TEMPORARY = "_PAPERBAKE"
SENT_AS = {"FLOAT": ("FLOAT", "value", 1), "INT": ("FLOAT", "value", 1), "INT8": ("FLOAT", "value", 1), "BOOLEAN": ("FLOAT", "value", 1),
           "FLOAT2": ("FLOAT2", "vector", 2), "FLOAT_VECTOR": ("FLOAT_VECTOR", "vector", 3),
           "FLOAT_COLOR": ("FLOAT_COLOR", "color", 4), "BYTE_COLOR": ("FLOAT_COLOR", "color", 4)}  # type: type, member, numbers

Carried = collections.namedtuple("Carried", "name group domain type")  # group: its index, of an attribute None


def own_attributes(mesh):
    """Those that the artist has made, but for uv maps."""
    return [attribute for attribute in mesh.attributes
            if not (attribute.name in BLENDERS_OWN or attribute.is_internal or attribute.name.startswith(".") or attribute.name in mesh.uv_layers)]


def carried(sheet):
    """What of the sheet comes back. Edges have no place in glTF, and of two names that become the same only the first is told apart."""
    mesh = sheet.data
    if mesh.library:
        return []  # nothing can be added to it
    found = [Carried(attribute.name, None, attribute.domain, attribute.data_type) for attribute in own_attributes(mesh)
             if attribute.domain != "EDGE" and attribute.data_type in SENT_AS]
    found += [Carried(group.name, group.index, "POINT", "FLOAT") for group in sheet.vertex_groups]
    taken = {names.in_usd(layer.name) for layer in mesh.uv_layers}
    return [one for one in found if not (names.in_usd(one.name) in taken or taken.add(names.in_usd(one.name)))]


def not_carried(sheet):
    """{"vertex groups", "colours", "attributes": their names}, of what the sheet has and does not come back."""
    there, mesh = carried(sheet), sheet.data
    attributes, groups = {one.name for one in there if one.group is None}, {one.name for one in there if one.group is not None}
    left = [attribute for attribute in own_attributes(mesh) if attribute.name not in attributes]
    colours = [attribute.name for attribute in left if attribute.data_type.endswith("COLOR")]
    return {"vertex groups": [group.name for group in sheet.vertex_groups if group.name not in groups], "colours": colours,
            "attributes": [attribute.name for attribute in left if attribute.name not in colours]}


def weights(mesh, group):
    """Of every vertex in a group."""
    found = [0.0] * len(mesh.vertices)
    for vertex in mesh.vertices:
        for element in vertex.groups:
            if element.group == group:
                found[vertex.index] = element.weight
    return found


def numbers(data, member, width):
    values = [0.0] * (len(data) * width)
    data.foreach_get(member, values)
    return [float(value) for value in values]


@contextlib.contextmanager
def sent(mesh, sheet):
    """What is carried of a sheet as attributes of its mesh that the exporter writes. The context is the properties that tell their names."""
    told, made = {"paper_colours": [], "paper_attributes": []}, []
    try:
        for n, one in enumerate(carried(sheet)):
            kind, member, width = SENT_AS[one.type]
            written = one.name
            if one.group is not None or not one.name.startswith("_"):
                values = weights(mesh, one.group) if one.group is not None else numbers(mesh.attributes[one.name].data, member, width)
                attribute = mesh.attributes.new(f"{TEMPORARY}_{n}", kind, one.domain)
                made.append(attribute.name)
                attribute.data.foreach_set(member, values)
                written = attribute.name
            # the exporter writes capitals, and what is read has no underscore
            told["paper_colours" if member == "color" else "paper_attributes"].append(f"{written.upper()[1:]}={one.name}")
        yield {name: "\n".join(lines) for name, lines in told.items() if lines}
    finally:
        for name in made:
            mesh.attributes.remove(mesh.attributes[name])


@contextlib.contextmanager
def layer(scene, path):
    """{sheet's name in USD: mesh} of a USD layer, as long as the context lasts. Throws RuntimeError."""
    kinds = (bpy.data.objects, bpy.data.meshes, bpy.data.cache_files)
    before = [set(kind) for kind in kinds]
    try:
        with bpy.context.temp_override(scene=scene):
            bpy.ops.wm.usd_import(filepath=str(path), set_frame_range=False, import_materials=False)
        yield {thing.name.split(".")[0]: thing.data for thing in set(bpy.data.objects) - before[0] if thing.type == "MESH"}
    finally:
        for kind, kept in zip(kinds, before):
            for made in set(kind) - kept:
                bpy.data.batch_remove([made])


def of_domain(values, width, corners, domain, mesh):
    """The values of vertices or faces, of those of corners. corners: the vertex of each"""
    if domain == "CORNER":
        return values
    if domain == "FACE":
        chosen = [face.loop_start for face in mesh.polygons]
    else:
        of_vertex = dict(zip(corners, range(len(corners))))
        chosen = [of_vertex.get(vertex, 0) for vertex in range(len(mesh.vertices))]
    return [values[width * corner + k] for corner in chosen for k in range(width)]


def put_group(thing, name, values):
    group = thing.vertex_groups.get(name) or thing.vertex_groups.new(name=name)
    for vertex, weight in enumerate(values):
        if weight > 0:
            group.add([vertex], min(weight, 1.0), "REPLACE")


def domain_on_paper(one):
    return "CORNER" if one.type.endswith("COLOR") else one.domain


def put_attribute(mesh, name, one, values):
    _, member, _ = SENT_AS[one.type]
    stale = mesh.attributes.get(name)
    if stale:
        mesh.attributes.remove(stale)  # of Alembic, with 8 bits
    # the cache would write into a colour of bytes, and beside one of vertices put another one of this name
    kind = "FLOAT_COLOR" if member == "color" else one.type
    if kind in {"INT", "INT8", "BOOLEAN"}:
        values = [round(value) for value in values]
    mesh.attributes.new(name, kind, domain_on_paper(one)).data.foreach_set(member, values)


def choose_colours(mesh, sheet):
    """The colours that are active and rendered on the sheet are so on the paper."""
    colours, own = mesh.color_attributes, sheet.data.color_attributes
    for which in ("active_color_index", "render_color_index"):
        chosen = own[getattr(own, which)].name if 0 <= getattr(own, which) < len(own) else ""
        if colours.find(chosen) >= 0:
            setattr(colours, which, colours.find(chosen))


def dress(thing, sheet, given):
    """Puts what is carried of the sheet onto the paper. given: the mesh of the USD layer, or None. Returns the names of what did not come back."""
    mesh, missing = thing.data, []
    corners, same = [0] * len(mesh.loops), False
    mesh.loops.foreach_get("vertex_index", corners)
    if given and len(given.loops) == len(corners):
        others = [0] * len(corners)
        given.loops.foreach_get("vertex_index", others)
        same = corners == others
    for one in carried(sheet):
        name = f"{one.name}_2" if one.name in OF_CACHE else one.name
        in_usd = names.in_usd(name)
        source = given.attributes.get(f"{in_usd}_2" if in_usd in OF_USD else in_usd) if same else None
        _, member, width = SENT_AS[one.type]
        if source is None or source.domain != "CORNER" or not (len(source.data) and hasattr(source.data[0], member)):
            missing.append(one.name)
            continue
        values = of_domain(numbers(source.data, member, width), width, corners, domain_on_paper(one), mesh)
        if one.group is not None:
            put_group(thing, name, values)
        else:
            put_attribute(mesh, name, one, values)
    choose_colours(mesh, sheet)
    return missing
