"""The material of baked paper: creases show as fine ridges and valleys, each from the moment it appeared."""

import bpy

CREASE_HEIGHT = 1.5e-4  # [m] of a sharp crease in the bump: about two thicknesses
FIBRE_HEIGHT = 3e-6     # [m]
FIBRE_SIZE = 4e-4       # [m]
APPEARS_IN = 0.1        # [s]
PAPER = (0.83, 0.82, 0.79, 1)
CLOCK = "seconds to the end"
PATTERN = "pattern"  # the uv map of the crease maps
WORN = (0.90, 0.895, 0.88, 1)  # broken fibres scatter more


class Graph:
    """Nodes of a material, laid out in columns from left to right."""

    def __init__(self, tree):
        self.tree, self.rows = tree, {}

    def node(self, kind, column, **settings):
        node = self.tree.nodes.new(kind)
        row = self.rows[column] = self.rows.get(column, 0) + 1
        node.location = 220 * column, -260 * row
        for name, value in settings.items():
            setattr(node, name, value)
        return node

    def feed(self, socket, source):
        """A socket from another one, or from a constant."""
        if isinstance(source, bpy.types.NodeSocket):
            self.tree.links.new(source, socket)
        else:
            socket.default_value = source

    def math(self, column, operation, *values, clamp=False):
        node = self.node("ShaderNodeMath", column, operation=operation, use_clamp=clamp)
        for socket, value in zip(node.inputs, values):
            self.feed(socket, value)
        return node.outputs[0]


def clock_expression(scene, last):
    return f"({last} - frame) / {scene.render.fps / scene.render.fps_base:.9g}"


def seconds_to_the_end(graph, column, scene, last):
    """A value that runs with the frames: seconds from now to frame `last`, of which the map is."""
    node = graph.node("ShaderNodeValue", column, name=CLOCK, label=CLOCK)
    node.outputs[0].driver_add("default_value").driver.expression = clock_expression(scene, last)
    return node.outputs[0]


def creases_of_map(graph, scene, image, last):
    """(signed height, strength) in [-1, 1], [0, 1]: creases of the picture that have appeared by now."""
    picture = graph.node("ShaderNodeTexImage", 1, image=image, extension="EXTEND")
    graph.feed(picture.inputs["Vector"], graph.node("ShaderNodeUVMap", 0, uv_map=PATTERN).outputs[0])
    split = graph.node("ShaderNodeSeparateColor", 2)
    graph.feed(split.inputs[0], picture.outputs["Color"])
    older = graph.math(3, "SUBTRACT", split.outputs[1], seconds_to_the_end(graph, 2, scene, last))
    there = graph.math(4, "MULTIPLY_ADD", older, 1 / APPEARS_IN, 1.0, clamp=True)
    height = graph.math(5, "MULTIPLY", split.outputs[0], there)
    return height, graph.math(6, "ABSOLUTE", height)


def creases_of_colour(graph):
    """The same from the cache's colour: what is folded now, as wide as its triangles."""
    colour = graph.node("ShaderNodeVertexColor", 3, layer_name="crease")
    split = graph.node("ShaderNodeSeparateColor", 4)
    graph.feed(split.inputs[0], colour.outputs["Color"])
    return split.outputs[0], split.outputs[0]


def bump(graph, scene, height, side):
    """A normal from creases and fibres; what is a ridge in front is a valley behind. side [m]: one unit of uv"""
    unit = scene.unit_settings.scale_length
    behind = graph.node("ShaderNodeNewGeometry", 5).outputs["Backfacing"]
    signed = graph.math(7, "MULTIPLY", height, graph.math(6, "MULTIPLY_ADD", behind, -2.0, 1.0))
    creases = graph.node("ShaderNodeBump", 8)
    for name, value in (("Height", signed), ("Strength", 1.0), ("Distance", CREASE_HEIGHT / unit)):
        graph.feed(creases.inputs[name], value)
    fibres = graph.node("ShaderNodeTexNoise", 7)
    for name, value in (("Vector", graph.node("ShaderNodeUVMap", 6, uv_map=PATTERN).outputs[0]), ("Scale", side / FIBRE_SIZE), ("Detail", 3.0)):
        graph.feed(fibres.inputs[name], value)
    both = graph.node("ShaderNodeBump", 9)
    for name, value in (("Height", fibres.outputs[0]), ("Strength", 1.0), ("Distance", FIBRE_HEIGHT / unit), ("Normal", creases.outputs[0])):
        graph.feed(both.inputs[name], value)
    return both.outputs[0]


def surface(graph, normal, strength):
    """Matt and slightly translucent, whiter where the fibres are broken."""
    colour = graph.node("ShaderNodeMix", 9, data_type="RGBA")
    graph.feed(colour.inputs["Factor"], strength)
    colour.inputs[6].default_value, colour.inputs[7].default_value = PAPER, WORN  # A and B of colours
    front = graph.node("ShaderNodeBsdfPrincipled", 10)
    through = graph.node("ShaderNodeBsdfTranslucent", 10)
    for node, name in ((front, "Base Color"), (through, "Color")):
        graph.feed(node.inputs[name], colour.outputs[2])
        graph.feed(node.inputs["Normal"], normal)
    front.inputs["Roughness"].default_value, front.inputs["Specular IOR Level"].default_value = 0.75, 0.3
    mix = graph.node("ShaderNodeMixShader", 11)
    mix.inputs[0].default_value = 0.15
    for socket, node in zip(mix.inputs[1:], (front, through)):
        graph.feed(socket, node.outputs[0])
    graph.feed(graph.node("ShaderNodeOutputMaterial", 12).inputs["Surface"], mix.outputs[0])


def refresh(material, scene, last):
    """Another bake of the same sheet: what the artist did to the nodes stays, clock and picture are the new ones."""
    tree = material.node_tree
    for curve in tree.animation_data.drivers if tree.animation_data else ():
        if curve.data_path == f'nodes["{CLOCK}"].outputs[0].default_value':
            curve.driver.expression = clock_expression(scene, last)
    for node in list(tree.nodes):
        if node.type == "TEX_IMAGE" and node.image:
            node.image.reload()
            if not node.inputs["Vector"].is_linked:  # of a version in which the paper had one uv map only
                place = tree.nodes.new("ShaderNodeUVMap")
                place.uv_map, place.location = PATTERN, (node.location.x - 220, node.location.y)
                tree.links.new(place.outputs[0], node.inputs["Vector"])


def build(scene, name, picture, last, side):
    """The material of a sheet under its name, new or refreshed.

    picture  file of crease_map.crease_picture, None: only the cache's colour is there
    last     frame of the picture
    side     [m] longer side of the sheet
    """
    material = bpy.data.materials.get(name)
    if material and material.node_tree:
        refresh(material, scene, last)
        return material
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    material.node_tree.nodes.clear()
    graph = Graph(material.node_tree)
    if picture:
        image = bpy.data.images.load(picture, check_existing=True)
        if bpy.data.filepath and bpy.context.preferences.filepaths.use_relative_paths:
            image.filepath = bpy.path.relpath(picture)  # a project that is moved keeps its map, as its cache
        image.colorspace_settings.is_data = True
        height, strength = creases_of_map(graph, scene, image, last)
    else:
        height, strength = creases_of_colour(graph)
    surface(graph, bump(graph, scene, height, side), strength)
    return material
