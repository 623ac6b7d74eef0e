"""Tests the add-on in Blender itself (PyPI: bpy 4.5), from its zip to the paper in the scene.

    blender_addon_test.py PAPERBAKE ADDON FOLDER

ADDON     its source, baker/blender
FOLDER    for everything that is written; emptied first
Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import contextlib
import json
import math
import pathlib
import re
import subprocess
import sys
import time
import types

from addon_fixture import (ADDON, FIRST, FOLDER, FPS, LAST, MODULE, PROGRAM, SIDES, Window, empty, heard, holding, key, mark_and_hold, new_scene,
                           panels, part, place, report, select, standing_in, until, use)

import bmesh
import bpy
import numpy
from mathutils import Vector

from bake_judge import read_rows, read_with_alembic, triple, vertex_at
from blender_judge import floats, integers
from judgement import Judgement

HELD = 1e-4            # [m]
FAN_TOLERANCE = 0.015  # [rad] corners at a vertex whose normals differ by less share one in Blender


def test_zip_installs(judgement):
    """The same bytes twice; Blender's own installer takes it; it is of the program's version."""
    paths = [subprocess.run([sys.executable, "-B", str(ADDON / "make_zip.py"), str(FOLDER / name)], capture_output=True, text=True, check=True).stdout.strip()
             for name in ("one", "two")]
    judgement.check(pathlib.Path(paths[0]).read_bytes() == pathlib.Path(paths[1]).read_bytes(), "the zip has other bytes the second time")
    version = subprocess.run([str(PROGRAM), "--version"], capture_output=True, text=True, check=True).stdout.split()[1]
    judgement.check(pathlib.Path(paths[0]).name == f"paperbake_blender-{version}.zip", f"{paths[0]} is not of version {version}")
    with heard():
        bpy.ops.wm.read_factory_settings()
        bpy.ops.extensions.package_install_files(filepath=paths[0], repo="user_default", enable_on_install=True)
    judgement.check(MODULE in bpy.context.preferences.addons, "Blender does not enable the add-on")
    judgement.count("zips", len(paths))


def test_settings_are_properties(judgement, sheet, handle):
    """What the panel shows is what the file carries, and what it takes away is gone."""
    sheet.paperbake.preset, sheet.paperbake.seed = "copy90", 7
    judgement.check((sheet["paper_preset"], sheet["paper_seed"]) == ("copy90", 7), "grade or seed do not reach the sheet's properties")
    sheet["paper_preset"] = "mine.toml"
    judgement.check(sheet.paperbake.preset == "mine.toml", "a grade that the program does not list is shown as another one")
    sheet.paperbake.preset = "default"
    judgement.check("paper_preset" not in sheet, "the default grade leaves a property behind")
    sheet.paperbake.preset = "copy90"
    select(handle)
    with heard():
        bpy.ops.paperbake.set_handle(name="paper_radius")
        judgement.check(handle.get("paper_radius") == 0.01, "no radius was set")
        handle.paperbake.mode = "relative"
        judgement.check(handle.get("paper_mode") == "relative", "no mode was set")
        bpy.ops.paperbake.unmark()
    judgement.check(handle.name == "Grip" and not [k for k in handle.keys() if k.startswith("paper_")], "unmark leaves a name or properties behind")
    with heard():
        bpy.ops.paperbake.mark_handles()
    judgement.count("settings", 6)


def test_grades_have_pictures(judgement, scene, sheet):
    """Blender loads a picture for every grade that the program lists; list and panel show it. Without a window, Blender numbers no icons:
    numbers of our own stand in."""
    properties = part("properties")
    grades = [name for name, *_ in properties.grade_items(sheet.paperbake, None) if name != "default"]
    loaded = {grade: tuple(picture.image_size) for grade, picture in properties._pictures.items()}
    judgement.check(len(grades) >= 13 and loaded == {grade: (64, 64) for grade in grades}, f"of the grades {grades} these have pictures: {loaded}")
    pixels = {grade: tuple(picture.image_pixels_float) for grade, picture in properties._pictures.items()}
    judgement.check(len(set(pixels.values())) == len(grades), "two grades have the same picture")
    genuine, properties.picture_of = properties.picture_of, lambda grade: 100 + grades.index(grade) if grade in grades else 0
    try:
        items = {item[0]: item[3] for item in properties.grade_items(sheet.paperbake, None)}
        sheet.paperbake.preset = "kraft90"
        shown = panels(types.SimpleNamespace(scene=scene, object=sheet)).pictures
        judgement.check(items["kraft90"] == 100 + grades.index("kraft90") and items["default"] == 0, f"the list has the pictures {items}")
        judgement.check(sheet["paper_preset"] == "kraft90" and shown == [items["kraft90"]], f"the panel shows the pictures {shown}")
        sheet.paperbake.preset = "copy90"
    finally:
        properties.picture_of = genuine
    judgement.count("pictures", len(grades))


def truth_of(scene, handles):
    """{(frame, handle): where Blender has it}"""
    found = {}
    for frame in range(FIRST, LAST + 1):
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for name in handles:
            found[frame, name] = numpy.array(scene.objects[name].evaluated_get(graph).matrix_world.translation)
    scene.frame_set(FIRST)
    return found


def hide(scene, eye, viewport, away):
    """Three handles out of sight, in the three ways there are: they hold the sheet all the same."""
    scene.objects[eye].hide_set(True)
    scene.objects[viewport].hide_viewport = True
    collection = bpy.data.collections.new("Away")
    scene.collection.children.link(collection)
    collection.objects.link(scene.objects[away])
    scene.collection.objects.unlink(scene.objects[away])
    bpy.context.view_layer.layer_collection.children["Away"].exclude = True


def judge_handles(judgement, folder, cache, truth, pattern):
    """The sheet point of every handle is where Blender itself has the handle, in the cache and in the certificate."""
    rows = read_rows(folder / "cert" / "handles.csv")
    judgement.check({(int(row["frame"]), row["handle"]) for row in rows} == set(truth), "certificate and scene differ in frames or handles")
    vertex = {row["handle"]: vertex_at(judgement, pattern, row) for row in rows}
    for row in rows:
        where = int(row["frame"]), row["handle"]
        if where in truth:
            judgement.near([triple(row, "keyed_x", "keyed_y", "keyed_z")], [truth[where]], "keyed places", f"frame {where[0]}, {where[1]}", HELD)
            judgement.near([cache.positions[where[0] - FIRST][vertex[where[1]]]], [truth[where]], "held places", f"frame {where[0]}, {where[1]}", HELD)
    moved = max(numpy.linalg.norm(truth[LAST, handle] - truth[FIRST, handle]) for _, handle in truth)
    judgement.check(moved > 0.005, f"no handle moves more than {moved} m")


def judge_loaded(judgement, scene, name, cache):
    """The object in the scene is the cache, at three frames."""
    thing = scene.objects[name]
    for frame in (FIRST, (FIRST + LAST) // 2, LAST):
        scene.frame_set(frame)
        shown = thing.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh, world = shown.to_mesh(), numpy.array(shown.matrix_world)
        positions = floats(mesh.vertices, "co", 3) @ world[:3, :3].T + world[:3, 3]
        judgement.near(positions, cache.positions[frame - FIRST], "positions", f"{name}, frame {frame}")
        judgement.check(mesh.has_custom_normals and "crease" in mesh.attributes and "velocity" in mesh.attributes,
                        f"{name}, frame {frame}: normals, crease or velocity are missing")
        if frame == LAST:
            judge_normals(judgement, mesh, cache, name)
        shown.to_mesh_clear()


def judge_normals(judgement, mesh, cache, where):
    """Those of the cache, corner by corner: Blender lists the corners of a face the other way round, and begins where it likes."""
    found, wanted = ({(face, vertex): normal for face, vertex, normal in zip(numpy.arange(len(corners)) // 3, corners, normals)}
                     for corners, normals in ((integers(mesh.loops, "vertex_index"), floats(mesh.corner_normals, "vector", 3)),
                                              (cache.corners[-1], cache.corner_normals)))
    if judgement.check(set(found) == set(wanted), f"{where}: faces are not those of the cache"):
        judgement.near([found[corner] for corner in wanted], list(wanted.values()), "corner normals", where, FAN_TOLERANCE)


def judge_scene(judgement, scene, folder):
    """The sheet is out of sight, the paper in its collection and no sheet itself; its material has the map."""
    sheet, paper = scene.objects["paper.Letter"], scene.objects["baked.paper.Letter"]
    judgement.check(sheet.hide_render and sheet.hide_get(), "the sheet is still in sight")
    judgement.check([c.name for c in paper.users_collection] == ["Paper"], f"the paper is in {[c.name for c in paper.users_collection]}")
    judgement.check(part("names").role(paper) is None, "the paper would be exported as a sheet")
    judgement.check(scene.render.fps_base == numpy.float32(1.001) and (scene.frame_start, scene.frame_end) == (FIRST, LAST),
                    "the export changed the scene's clock")
    judgement.check(not bpy.data.collections.get("paperbake export") and "paper_fps" not in sheet, "the export left something behind")
    pictures = [node.image for node in paper.material_slots[0].material.node_tree.nodes if node.type == "TEX_IMAGE"]
    judgement.check([tuple(image.size) for image in pictures] == [(1024, 1024)], f"the material's pictures are {[tuple(i.size) for i in pictures]}")
    judgement.check([image.filepath for image in pictures] == [f"//paperbake/maps/{folder.parent.name}.blender.exr"], "the map's path is not beside the .blend")
    judgement.check((folder / "maps" / f"{folder.parent.name}.blender.exr").exists(), "no picture was made of the map")


def test_bake(judgement):
    """Mark, bake, load: everything where Blender has it; a second bake goes on with the artist's object."""
    scene, sheet = new_scene("letter")
    handles = mark_and_hold(judgement, scene, sheet)
    test_settings_are_properties(judgement, sheet, scene.objects["handle.Grip"])
    test_grades_have_pictures(judgement, scene, sheet)
    truth = truth_of(scene, handles)
    hide(scene, *handles[:3])
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"FINISHED"} and f"Baked {LAST - FIRST + 1} frames" in said, f"the bake says {said}")
    if judgement.failures:
        return
    folder = FOLDER / "letter" / "paperbake"
    cache = read_with_alembic(folder / "letter.abc", FPS)
    judgement.near([cache.times], [[frame / FPS for frame in range(FIRST, LAST + 1)]], "times", "the cache", 1e-6)
    pattern = numpy.zeros((len(cache.positions[0]), 2))
    pattern[cache.corners[0]] = cache.corner_uv * max(SIDES)
    judge_handles(judgement, folder, cache, truth, pattern)
    judge_loaded(judgement, scene, "baked.paper.Letter", cache)
    judge_scene(judgement, scene, folder)
    eye, viewport, away = (scene.objects[name] for name in handles[:3])
    judgement.check(eye.hide_get() and viewport.hide_viewport and away.name not in bpy.context.view_layer.objects, "a hidden handle is in sight after the bake")
    settings = (folder / "job.lock.toml").read_text(encoding="utf-8")
    judgement.check("copy90" in settings and "seed = 7" in settings, "grade or seed of the panel are not those of the bake")
    bake_again(judgement, scene, folder)


def again_dressed(judgement, scene, material):
    """The material of another bake: what the artist did to its nodes stays, the clock of the creases is the new one."""
    (shader,) = (node for node in material.node_tree.nodes if node.type == "BSDF_PRINCIPLED")
    shader.inputs["Roughness"].default_value = 0.25
    part("material").build(scene, material.name, None, LAST + 30, max(SIDES))
    scene.frame_set(LAST)
    clock = material.node_tree.evaluated_get(bpy.context.evaluated_depsgraph_get()).nodes["seconds to the end"].outputs[0].default_value
    judgement.near([[clock]], [[30 / FPS]], "clocks", "the material of another bake")
    judgement.near([[shader.inputs["Roughness"].default_value]], [[0.25]], "values of the artist's", "the material of another bake")


def bake_again(judgement, scene, folder):
    """Of a .blend that was saved and opened, with another mesh: the same object, with what the artist did to it."""
    paper = scene.objects["baked.paper.Letter"]
    again_dressed(judgement, scene, paper.material_slots[0].material)
    mine = bpy.data.materials.new("mine")
    paper.material_slots[0].material = mine
    paper.modifiers.new("Thick", "SOLIDIFY")
    with heard():
        bpy.ops.wm.save_mainfile()
        bpy.ops.wm.open_mainfile(filepath=bpy.data.filepath)
    scene = bpy.context.scene
    scene.paperbake.quality, scene.paperbake.own_frames, scene.paperbake.first, scene.paperbake.last = "shot", True, FIRST, FIRST + 3
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"FINISHED"} and "Baked 4 frames" in said, f"the second bake says {said}")
    paper, cache = scene.objects["baked.paper.Letter"], read_with_alembic(folder / "letter.abc", FPS)
    judgement.check([m.type for m in paper.modifiers] == ["MESH_SEQUENCE_CACHE", "SOLIDIFY"], f"modifiers are {[m.type for m in paper.modifiers]}")
    judgement.check(paper.material_slots[0].material.name == "mine", "the artist's material is gone")
    left = [thing.name for kind in (bpy.data.objects, bpy.data.meshes) for thing in kind if thing.users and "baked" in thing.name]
    left += [cached.name for cached in bpy.data.cache_files]
    judgement.check(left == ["baked.paper.Letter", "baked.paper.Letter", "baked.paper.Letter.abc"], f"in the file are {left}")
    paper.modifiers["Thick"].show_viewport = False
    scene.frame_set(FIRST + 2)
    found = floats(paper.evaluated_get(bpy.context.evaluated_depsgraph_get()).data.vertices, "co", 3)
    judgement.near(found, cache.positions[2], "positions", "the second bake")
    scene.objects["paper.Letter"]["paper_preset"] = "vellum9"
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"CANCELLED"} and "vellum9" in said and not part("baking").last.loaded, f"a bake that fails right after another: it says {said}")
    judgement.check(paper.name in scene.objects and len(bpy.data.cache_files) == 1, "a failed bake changes what is there")


def test_centimetres(judgement):
    """A scene whose unit is the centimetre gets paper of the size of its sheet."""
    scene, sheet = new_scene("centimetres")
    scene.unit_settings.scale_length = 0.01
    sheet.location, sheet.rotation_euler, sheet.scale = (0, 0, 0), (0, 0, 0), (100, 100, 100)
    select(sheet)
    with heard():
        bpy.ops.paperbake.mark_sheet()
    for v in (-0.5, 0.5):
        corner = Vector((100 * v * SIDES[0], 100 * v * SIDES[1], 0))
        key(empty("handle", (0, 0, 0)), "location", corner, 0.9 * corner)
    result, said = report(bpy.ops.paperbake.bake)
    if judgement.check(result == {"FINISHED"}, f"centimetres: it says {said}"):
        scene.frame_set(LAST)
        paper = scene.objects["baked.paper.Letter"].evaluated_get(bpy.context.evaluated_depsgraph_get())
        found = floats(paper.data.vertices, "co", 3) @ numpy.array(paper.matrix_world)[:3, :3].T
        cache = read_with_alembic(FOLDER / "centimetres" / "paperbake" / "centimetres.abc", FPS)
        judgement.near(found, 100 * cache.positions[-1], "positions", "centimetres")
        judgement.check(8 < numpy.ptp(found[:, 0]) < 11, f"the paper is {numpy.ptp(found[:, 0])} units wide")


def test_what_was_made_stays(judgement):
    """A printed sheet with two materials and its own uv maps: the paper wears them, and a bake after a new print too."""
    scene, sheet = new_scene("printed")
    mesh = sheet.data
    mesh.uv_layers[0].name = "Print"
    mesh.uv_layers.new(name="Stamp")
    for name in ("Front page", "Unused"):
        mesh.materials.append(bpy.data.materials.new(name))
    for layer, scale in (("Print", 1.0), ("Stamp", 3.0)):
        for loop, place_ in zip(mesh.loops, mesh.uv_layers[layer].data):
            corner = mesh.vertices[loop.vertex_index].co
            place_.uv = scale * (corner.x / SIDES[0] + 0.5), scale * (corner.y / SIDES[1] + 0.5)
    sheet["title"] = "Daily"
    mark_and_hold(Judgement(), scene, sheet)
    result, said = report(bpy.ops.paperbake.bake)
    if not judgement.check(result == {"FINISHED"}, f"a printed sheet: it says {said}"):
        return
    paper = scene.objects["baked.paper.Letter"]
    layers = {layer.name: floats(layer.uv, "vector", 2) for layer in paper.data.uv_layers}
    judgement.check(list(layers) == ["Print", "Stamp", "pattern"], f"the paper's uv maps are {list(layers)}")
    pattern = layers["pattern"] * max(SIDES)
    judgement.near(layers["Print"], pattern / SIDES, "uvs", "Print", 2e-6)
    judgement.near(layers["Stamp"], 3 * pattern / SIDES, "uvs", "Stamp", 6e-6)
    judgement.check(paper.data.uv_layers["Print"].active_render, "another uv map than the sheet's is rendered")
    judgement.check([slot.material.name for slot in paper.material_slots] == ["Front page"], f"materials are {[s.material and s.material.name for s in paper.material_slots]}")
    judgement.check(len([m for m in bpy.data.materials if m.name.startswith("Front page")]) == 1, "the material was copied")
    judgement.check(paper.get("title") == "Daily" and "paper_uv_sets" not in sheet and "paper_preset" not in paper, "custom properties do not come along as they should")
    creases = bpy.data.materials["baked.paper.Letter"]
    uses = {node.uv_map for node in creases.node_tree.nodes if node.type == "UVMAP"}
    judgement.check(uses == {"pattern"}, f"the material of the creases reads the uv maps {uses}")
    scene.paperbake.quality = "shot"
    report(bpy.ops.paperbake.bake)
    paper = scene.objects["baked.paper.Letter"]
    judgement.check([slot.material.name for slot in paper.material_slots] == ["Front page"] and [layer.name for layer in paper.data.uv_layers] == list(layers),
                    "the second bake changes materials or uv maps")
    judgement.count("printed sheets", 1)


def put_on_vertices(sheet):
    """Two panels side by side of two faces each, with a vertex group, colours and other attributes on them."""
    select(sheet)
    with heard():
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        bpy.ops.mesh.subdivide(number_cuts=1)
        bpy.ops.object.mode_set(mode="OBJECT")
    mesh = sheet.data
    group = sheet.vertex_groups.new(name="Worn edge")
    for vertex in mesh.vertices:
        group.add([vertex.index], vertex.co.x / SIDES[0] + 0.5, "REPLACE")
    points = [vertex.co for vertex in mesh.vertices]
    corners = [(points[mesh.loops[i].vertex_index], face.center.x > 0) for face in mesh.polygons for i in face.loop_indices]
    given = {
        "wetness": ("FLOAT", "POINT", "value", [40 * p.x - 90 * p.y for p in points]),
        "_own": ("FLOAT", "POINT", "value", [p.y for p in points]),
        "flow": ("FLOAT_VECTOR", "POINT", "vector", [n for p in points for n in (p.x, p.y, 1)]),
        "offset": ("FLOAT2", "POINT", "vector", [n for p in points for n in (7 * p.x, p.y)]),
        "panel": ("INT", "FACE", "value", [3 if face.center.x > 0 else -2 for face in mesh.polygons]),
        "printed": ("BOOLEAN", "FACE", "value", [face.center.x > 0 for face in mesh.polygons]),
        "Dye": ("FLOAT_COLOR", "CORNER", "color", [n for p, right in corners for n in (2.5 if right else 0.1, p.y + 0.5, 0.25, 0.75)]),
        "Stain": ("BYTE_COLOR", "POINT", "color", [n for p in points for n in (0.5, 0.25, 0.125, 1)]),
    }
    for name, (kind, domain, member, values) in given.items():
        mesh.attributes.new(name, kind, domain).data.foreach_set(member, values)
    mesh.color_attributes.active_color_index = mesh.color_attributes.find("Stain")
    mesh.color_attributes.render_color_index = mesh.color_attributes.find("Dye")


def check_on_vertices(judgement, paper, frame, where):
    """As the paper is in a frame, its modifiers applied."""
    bpy.context.scene.frame_set(frame)
    mesh = paper.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    pattern = floats(mesh.uv_layers["pattern"].uv, "vector", 2) * max(SIDES) - numpy.array(SIDES) / 2
    vertex_of = integers(mesh.loops, "vertex_index")
    points = numpy.empty((len(mesh.vertices), 2))
    points[vertex_of] = pattern
    right = pattern.reshape(-1, 3, 2).mean(axis=1)[:, 0] > 0
    corner_right, one = numpy.repeat(right, 3), numpy.ones(len(points))
    expected = {
        "wetness": ("FLOAT", "POINT", "value", 40 * points[:, 0] - 90 * points[:, 1]),
        "_own": ("FLOAT", "POINT", "value", points[:, 1]),
        "flow": ("FLOAT_VECTOR", "POINT", "vector", numpy.stack([points[:, 0], points[:, 1], one], axis=1)),
        "offset": ("FLOAT2", "POINT", "vector", points * (7, 1)),
        "panel": ("INT", "FACE", "value", numpy.where(right, 3, -2)),
        "printed": ("BOOLEAN", "FACE", "value", right),
        "Dye": ("FLOAT_COLOR", "CORNER", "color", numpy.stack([numpy.where(corner_right, 2.5, 0.1), pattern[:, 1] + 0.5, 0 * pattern[:, 0] + 0.25,
                                                               0 * pattern[:, 0] + 0.75], axis=1)),
        "Stain": ("FLOAT_COLOR", "CORNER", "color", numpy.tile([0.5, 0.25, 0.125, 1], (len(pattern), 1))),
    }
    for name, (kind, domain, member, values) in expected.items():
        found = mesh.attributes.get(name)
        if not judgement.check(found and (found.data_type, found.domain) == (kind, domain), f"{where}: {name} is {found and (found.data_type, found.domain)}"):
            continue
        near = 2 / 255 if name == "Stain" else 2e-5  # bytes; 90 times a place of 32 bits
        numbers = numpy.array([getattr(element, member) for element in found.data], dtype=float)
        judgement.near(numbers.reshape(len(values), -1), numpy.asarray(values, dtype=float).reshape(len(values), -1), "attributes", f"{where}, {name}", near)
    colours = mesh.color_attributes
    chosen = colours[colours.active_color_index].name, colours[colours.render_color_index].name
    judgement.check(chosen == ("Stain", "Dye"), f"{where}: active and rendered are the colours {chosen}")
    group = paper.vertex_groups.get("Worn edge")
    if judgement.check(group is not None, f"{where}: the vertex group is lost"):
        weights = [next((g.weight for g in vertex.groups if g.group == group.index), 0.0) for vertex in mesh.vertices]
        judgement.near(numpy.array(weights)[:, None], (points[:, :1] / SIDES[0] + 0.5), "attributes", f"{where}, the vertex group", 2e-5)


def test_what_is_on_vertices_comes_back(judgement):
    """Vertex groups, colours and other attributes, on vertices, faces and corners, in every frame, after a draft and after a bake."""
    scene, sheet = new_scene("dyed")
    mark_and_hold(Judgement(), scene, sheet)
    put_on_vertices(sheet)
    before = [(attribute.name, attribute.data_type, attribute.domain) for attribute in sheet.data.attributes]
    for bake in (bpy.ops.paperbake.draft, bpy.ops.paperbake.bake):
        result, said = report(bake)
        where = bake.idname_py()
        if not judgement.check(result == {"FINISHED"} and "come back" not in said, f"{where}: it says {said}"):
            return
        for frame in (FIRST, LAST):
            check_on_vertices(judgement, scene.objects["baked.paper.Letter"], frame, f"{where}, frame {frame}")
    after = [(attribute.name, attribute.data_type, attribute.domain) for attribute in sheet.data.attributes]
    judgement.check(after == before and "paper_colours" not in sheet, f"the export leaves {after}")
    scene.paperbake.options = "--mesh simulation"
    _, said = report(bpy.ops.paperbake.draft)
    judgement.check(part("job").CHANGING_MESH in said, f"of a changing mesh is said {said}")
    judgement.check(not [thing.name for thing in bpy.data.objects if "paper_Letter" in thing.name], "the USD layer stays in the scene")
    judgement.check([file.name for file in bpy.data.cache_files if file.users] == ["baked.paper.Letter.abc"], "a cache file too many is left")


def folded_sheet(scene, sheet):
    """The sheet as a Z: two folds across, of +60 and -60 degrees, in three panels that do not stretch."""
    mesh = bmesh.new()
    third, turn, (w, h) = SIDES[1] / 3, math.radians(60), SIDES
    profile = [(0, 0), (third, 0), (third + third * math.cos(turn), third * math.sin(turn)), (2 * third + third * math.cos(turn), third * math.sin(turn))]
    rows = [[mesh.verts.new((x - w / 2, y - h / 2, z)) for x in (0, w)] for y, z in profile]
    for a, b in zip(rows, rows[1:]):
        mesh.faces.new((a[0], a[1], b[1], b[0]))
    mesh.to_mesh(sheet.data)
    mesh.free()
    return rows


def test_creases(judgement):
    """Folds as modelled are creases of their own angles in what the program sees, and so are edges marked for subdivision."""
    scene, sheet = new_scene("creases")
    folded_sheet(scene, sheet)
    mark_and_hold(Judgement(), scene, sheet)
    select(sheet)
    with heard():
        bpy.ops.object.mode_set(mode="EDIT")
        bpy.ops.mesh.select_all(action="SELECT")
        result = bpy.ops.paperbake.mark_creases()
        bpy.ops.object.mode_set(mode="OBJECT")
    made = sorted(thing["paper_crease"] for thing in scene.objects if thing.name.startswith("crease"))
    judgement.check(result == {"FINISHED"} and made == [-60, 60], f"creases of {made} degrees were made")
    with heard():
        part("scene_export").write(scene, str(FOLDER / "creases" / "marked.glb"), LAST)
    inspected = json.loads(subprocess.run([str(PROGRAM), "inspect", str(FOLDER / "creases" / "marked.glb"), "--json"], capture_output=True, text=True, check=True).stdout)
    found = sorted(round(crease["angle_deg"]) for crease in inspected["sheets"][0]["creases"])
    judgement.check(found == [-60, 60], f"the program sees creases of {found} degrees")
    for thing in [thing for thing in scene.objects if thing.name.startswith("crease")]:
        bpy.data.objects.remove(thing)
    marks = sheet.data.attributes.new("crease_edge", "FLOAT", "EDGE")
    for edge, mark in zip(sheet.data.edges, marks.data):
        mark.value = float(all(abs(sheet.data.vertices[v].co.y + SIDES[1] / 6) < 1e-6 for v in edge.vertices))
    with heard():
        part("scene_export").write(scene, str(FOLDER / "creases" / "edges.glb"), LAST)
    inspected = json.loads(subprocess.run([str(PROGRAM), "inspect", str(FOLDER / "creases" / "edges.glb"), "--json"], capture_output=True, text=True, check=True).stdout)
    judgement.check(len(inspected["sheets"][0]["creases"]) == 1, f"of marked edges the program sees {inspected['sheets'][0]['creases']}")
    judgement.check(not [thing.name for thing in bpy.data.objects if thing.name.startswith("crease")], "the export left creases behind")
    judgement.count("creases", 3)


def test_what_is_not_followed_is_told(judgement):
    """A collider whose armature preserves volume, and paper of the size of Blender's own plane."""
    scene = holding("told")
    with heard():
        bpy.ops.mesh.primitive_cube_add(size=0.1, location=(3, 0, 0))
    hand = bpy.context.object
    hand.name = "collider.hand"
    rig_ = bpy.data.objects.new("Bones", bpy.data.armatures.new("Bones"))
    scene.collection.objects.link(rig_)
    bones = hand.modifiers.new("Bones", "ARMATURE")
    bones.object, bones.use_deform_preserve_volume = rig_, True
    scene.paperbake.own_frames, scene.paperbake.first, scene.paperbake.last = True, FIRST, FIRST + 1
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"FINISHED"} and "collider.hand: its armature preserves volume" in said, f"a deformed collider: it says {said!r}")
    layout = panels(types.SimpleNamespace(scene=scene, object=hand))
    judgement.check("collider.hand" in layout.texts and any("preserves" in text for text in layout.texts), f"the panel of a collider says {layout.texts}")
    sheet = scene.objects["paper.Letter"]
    select(sheet)
    with heard() as said:
        sheet.scale = (20, 20, 1)
        bpy.context.view_layer.update()
        bpy.ops.paperbake.mark_sheet()
    judgement.check("2000 \u00d7 2800 mm: is it meant that large?" in said[0], f"a sheet of 2.8 m: it says {said[0]!r}")
    judgement.count("remarks", 2)


def test_winds(judgement):
    """Marked or added, they blow along their Z axis with the speed of the panel in what the program sees."""
    scene = holding("winds")
    arrow = empty("Fan", (0, 0, 1))
    arrow.rotation_euler = (0, math.radians(90), 0)  # along +x
    select(arrow)
    with heard():
        result = bpy.ops.paperbake.mark_wind()
    names = part("names")
    judgement.check(result == {"FINISHED"} and arrow.name == "wind.Fan" and names.role(arrow) == names.WIND, f"the wind is named {arrow.name}")
    arrow["paper_speed"] = 3.5
    layout = panels(types.SimpleNamespace(scene=scene, object=arrow))
    judgement.check('["paper_speed"]' in layout.shown and any("1 wind(s)" in text for text in layout.texts), "no panel shows the wind")
    judgement.check("share" in part("properties").WIND["paper_gust"][0], "the strength of gusts, a share of the speed, is shown in another unit")
    with heard():
        part("scene_export").write(scene, str(FOLDER / "winds" / "wind.glb"), LAST)
    blown = FOLDER / "winds" / "blown"
    subprocess.run([str(PROGRAM), "bake", str(FOLDER / "winds" / "wind.glb"), "-o", str(blown), "--frames", f"{FIRST}-{FIRST + 1}", "--formats", "cert"],
                   capture_output=True, check=False)
    summary = (blown / "cert" / "summary.json").read_text(encoding="utf-8")
    judgement.check("wind.Fan" in summary and "of 3.5 m/s" in summary, "the program sees no wind")
    bpy.ops.object.select_all(action="DESELECT")
    with heard():
        bpy.ops.paperbake.mark_wind()
    judgement.check("wind" in scene.objects and scene.objects["wind"].empty_display_type == "SINGLE_ARROW", "no wind was added")
    select(arrow)
    with heard():
        bpy.ops.paperbake.unmark()
    judgement.check(arrow.name == "Fan" and names.role(arrow) is None, "a wind that was unmarked blows on")


def test_groups_of_colliders(judgement):
    """A mesh below an empty that is a collider is exported as one, with what is between them."""
    scene = holding("groups")
    group, between = empty("collider_hand", (0, 0, 1)), empty("between", (0.5, 0, 0))
    between.parent = group
    for name, parent in (("palm", between), ("ring", group)):
        bpy.ops.mesh.primitive_cube_add(size=0.02)
        bpy.context.object.name, bpy.context.object.parent = name, parent
    scene.objects["ring"]["paper_collider"] = False
    names = part("names")
    judgement.check([thing.name for thing in names.of_role(scene, names.COLLIDER)] == ["palm"], "other colliders than the program has")
    path = FOLDER / "groups" / "groups.glb"
    with heard():
        part("scene_export").write(scene, str(path), LAST)
    seen = subprocess.run([str(PROGRAM), "inspect", str(path)], capture_output=True, text=True, check=False).stdout
    judgement.check('collider "palm"' in seen and "ring" not in seen, "the program sees other colliders")
    judgement.check(names.matched("Paper: Letter") == "paper: letter" and names.matched("rig:Handle_A") == "handle.a", "names with a colon")


def test_draft_messages_and_deletion(judgement):
    """A draft beside the bake, shown; every sentence in the text block; the cache goes with its files, and nobody else's."""
    scene = holding("drafted")
    folder = FOLDER / "drafted" / "paperbake"
    scene.paperbake.quality = "shot"
    report(bpy.ops.paperbake.bake)
    finished = (folder / "drafted.abc").read_bytes()
    result, said = report(bpy.ops.paperbake.draft)
    judgement.check(result == {"FINISHED"} and "Baked" in said, f"the draft says {said}")
    judgement.check((folder / "drafted.abc").read_bytes() == finished, "the draft changes the bake")
    paper = scene.objects["baked.paper.Letter"]
    path = bpy.path.abspath(part("cache").reader(paper).cache_file.filepath)
    judgement.check(pathlib.Path(path) == folder / "draft" / "drafted.abc", f"{path} is shown after a draft")
    judgement.check(not (folder / "draft" / "maps").exists() and not (folder / "draft" / "report.html").exists(), "a draft has maps or a report")
    lines = bpy.data.texts["Paperbake"].as_string().splitlines()
    judgement.check(lines and lines[0].startswith("Baked 10 frames"), f"the text block says {lines}")
    (folder / "notes.txt").write_text("mine", encoding="utf-8")
    result, said = report(bpy.ops.paperbake.delete_cache)
    judgement.check(result == {"FINISHED"} and "1 sheet(s)" in said, f"the deletion says {said}")
    left = sorted(str(path.relative_to(folder)) for path in folder.rglob("*") if path.is_file())
    judgement.check(left == ["notes.txt"], f"after the deletion there are {left}")
    sheet = scene.objects["paper.Letter"]
    judgement.check("baked.paper.Letter" not in scene.objects and not sheet.hide_render and not sheet.hide_get(), "the sheet is not in sight again")
    judgement.check(not bpy.data.cache_files, "the cache is still in the file")
    judgement.count("drafts", 1)


def said_of(code, messages, gates, error=""):
    """(the panel's sentence, the text block's lines) of a bake that ends so."""
    outcome = outcome_of(code, messages, gates, error)
    return outcome.sentence, list(outcome.told)


def outcome_of(code, messages, gates, error=""):
    process = types.SimpleNamespace(messages=messages, gates=gates, error=error, cancelled=False, last=None)
    return part("program").outcome(code, process, {}, True)


def test_order_and_words_of_messages(judgement):
    """The reason first, attempts last and their progress in the text block alone; options by the names that they have in the panel."""
    warnings = ["attempt 2 of 4 is tried, because in the attempt before it a handle is off by 3.0 mm", "attempts: in the first attempt a handle is off",
                'the box "b" is open', 'The handle "handle.c" is 100 mm away']
    gate = 'Frame 3: the handle "handle.c" is off; try more --base-triangles'
    sentence, lines = said_of(4, warnings, [gate])
    judgement.check(lines == [warnings[3], "Baked, but less well than asked for:", gate, warnings[2], warnings[1], "What begins with -- goes into Options of the panel.", warnings[0]],
                    f"the lines of a missed gate are {lines}")
    judgement.check(sentence == " ".join(lines[:-1]), f"the panel says {sentence!r}")
    sentence, lines = said_of(0, warnings[:1], [])
    judgement.check(sentence.startswith("Baked") and "attempt" not in sentence and lines[1:] == warnings[:1], f"of attempts under way the panel says {sentence!r}")
    level = [outcome_of(0, said, []).level for said in (warnings[1:2], warnings[2:3])]
    judgement.check(level == ["INFO", "WARNING"], f"a good bake of another attempt, and one with a warning, end as {level}")
    sentence, _ = said_of(2, [], [], "paperbake: a.glb\n  Too large.\n  The file is probably in mm: bake with --unit-scale 0.001, or --fps 30.\n")
    judgement.check(sentence == "a.glb: Too large. The file is probably in mm: bake with Scene > Units > Unit Scale 0.001, or Output > Frame Rate 30.", f"an error says {sentence!r}")
    judgement.count("orders", 3)


def test_options_of_the_panel(judgement):
    """They reach the program; those that the add-on gives itself are refused."""
    scene = holding("options")
    scene.paperbake.own_frames, scene.paperbake.first, scene.paperbake.last = True, FIRST, FIRST + 1
    scene.paperbake.options = "--base-triangles 90 --formats=abc"
    expect_error(judgement, "an option of the add-on's own", "--formats is what the add-on itself says")
    scene.paperbake.options = '--set "friction'
    expect_error(judgement, "an open quotation mark", "quotation mark")
    scene.paperbake.options = "--base-triangles 90"
    result, said = report(bpy.ops.paperbake.bake)
    settings = (FOLDER / "options" / "paperbake" / "job.lock.toml").read_text(encoding="utf-8")
    judgement.check(result == {"FINISHED"} and re.search(r"base_triangles *= *90\b", settings), f"an option of the panel: it says {said!r}")


def test_nothing_holds_it(judgement):
    """A page that falls, and one that is blown, need no handle."""
    for name, gravity, of_sheet in (("falling", 9.81, None), ("blown", 0, None), ("heavy", 0, 9.81)):
        scene, sheet = new_scene(name)
        select(sheet)
        with heard():
            bpy.ops.paperbake.mark_sheet()
            bpy.ops.object.select_all(action="DESELECT")
            if of_sheet:
                scene.objects["paper.Letter"]["paper_gravity"] = of_sheet
            elif not gravity:
                bpy.ops.paperbake.mark_wind()
        scene.paperbake.gravity = gravity
        result, said = report(bpy.ops.paperbake.bake)
        judgement.check(result == {"FINISHED"} and "Baked 10 frames" in said, f"a {name} page: it says {said!r}")
        judgement.check(scene.objects["paper.Letter"].get("paper_gravity") == of_sheet, "the export left another gravity behind")
        if result == {"FINISHED"}:
            ends = []
            for frame in (FIRST, LAST):
                scene.frame_set(frame)
                paper = scene.objects["baked.paper.Letter"].evaluated_get(bpy.context.evaluated_depsgraph_get())
                ends.append(floats(paper.data.vertices, "co", 3).mean(axis=0))
            judgement.check(numpy.linalg.norm(ends[1] - ends[0]) > 0.01, f"a {name} page goes from {ends[0]} to {ends[1]}")
    judgement.count("free pages", 3)


def test_what_is_left_out_is_told(judgement):
    """A curve and an instance that are named like colliders, and what is on the sheet's vertices: none of it is silently lost."""
    scene = holding("left")
    sheet, remarks = scene.objects["paper.Letter"], part("scene_export").remarks
    judgement.check(remarks(scene) == [], f"of a plain scene is said {remarks(scene)}")
    with heard():
        bpy.ops.curve.primitive_bezier_circle_add(radius=0.05, location=(3, 0, 0))
    bpy.context.object.name = "collider.curve"
    with heard():
        bpy.ops.object.text_add(location=(4, 0, 0))
    bpy.context.object.name, bpy.context.object.parent = "letters", empty("collider.sign", (4, 0, 0))
    props = bpy.data.collections.new("Props")
    props.objects.link(bpy.data.objects.new("collider.box", bpy.data.meshes.new("box")))
    instance = empty("Desk", (3, 0, 0))
    instance.instance_type, instance.instance_collection = "COLLECTION", props
    sheet.vertex_groups.new(name="Worn")
    sheet.data.color_attributes.new("Dye", "FLOAT_COLOR", "POINT")
    sheet.data.attributes.new("wetness", "FLOAT", "POINT")
    sheet.data.attributes.new("stitch", "FLOAT", "EDGE")
    sheet.data.attributes.new("crease_edge", "FLOAT", "EDGE")  # is read
    found = remarks(scene)
    judgement.check(len(found) == 4, f"there are {len(found)} remarks: {found}")
    for words in (("collider.curve", "Convert > Mesh"), ("letters", "Convert > Mesh"), ("Desk", "collider.box", "Make Instances Real"), ("paper.Letter", "its attributes stitch.")):
        judgement.check(any(all(word in sentence for word in words) for sentence in found), f"no remark says {words}: {found}")
    scene.paperbake.own_frames, scene.paperbake.first, scene.paperbake.last = True, FIRST, FIRST + 1
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"FINISHED"} and all(sentence in said for sentence in found), f"what is left out: the bake says {said!r}")
    judgement.count("remarks", 4)


def state_of(scene):
    """What a bake changes: the paper, whether it reads a cache that is there, whether the sheet is in sight, and what is left in the file."""
    paper, sheet = scene.objects.get("baked.paper.Letter"), scene.objects["paper.Letter"]
    cached = part("cache").reader(paper).cache_file if paper else None
    readable = bool(cached) and pathlib.Path(bpy.path.abspath(cached.filepath)).exists()
    return bool(paper), readable, sheet.hide_render, sheet.hide_get(), len([file for file in bpy.data.cache_files if file.users])


def test_undo(judgement):
    """Undo after a bake gives the scene before it, redo the paper again, and a bake after an undo bakes."""
    scene = holding("undone")
    bpy.context.preferences.edit.use_global_undo = True
    with heard():
        bpy.ops.ed.undo_push(message="before")
    before = state_of(scene)
    report(bpy.ops.paperbake.bake)
    with heard():
        bpy.ops.ed.undo_push(message="Bake Paper")
    after = state_of(bpy.context.scene)
    judgement.check(before == (False, False, False, False, 0) and after == (True, True, True, True, 1), f"a bake changes the scene from {before} to {after}")
    with heard():
        bpy.ops.ed.undo()
    judgement.check(state_of(bpy.context.scene) == before, f"after undo the scene is {state_of(bpy.context.scene)}")
    with heard():
        bpy.ops.ed.redo()
    judgement.check(state_of(bpy.context.scene) == after, f"after redo the scene is {state_of(bpy.context.scene)}")
    with heard():
        bpy.ops.ed.undo()
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"FINISHED"} and state_of(bpy.context.scene) == after, f"a bake after undo: {state_of(bpy.context.scene)}, it says {said!r}")
    judgement.count("undos", 2)


def expect_error(judgement, what, *fragments):
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"CANCELLED"} and all(fragment in said for fragment in fragments), f"{what}: it says {said!r}")
    judgement.check(not any(thing.name.startswith("baked") for thing in bpy.context.scene.objects), f"{what}: something was loaded")
    judgement.count("failures", 1)


def test_failures_are_told(judgement):
    with heard():
        bpy.ops.wm.read_homefile(use_factory_startup=True, use_empty=True)
    expect_error(judgement, "a file without a name", "Save the .blend first")
    scene, sheet = new_scene("failures")
    expect_error(judgement, "no sheet", "no sheet", "Mark Sheet")
    select(sheet)
    with heard():
        bpy.ops.paperbake.mark_sheet()
    expect_error(judgement, "no handle", "Nothing holds the sheet")
    mark_and_hold(Judgement(), scene, sheet)
    use(FOLDER / "nowhere")
    expect_error(judgement, "a missing program", "nowhere is not there", "Preferences")
    use(ADDON / "README.md")
    expect_error(judgement, "a file that is no program", "is no program that may be run", "Preferences")
    use(PROGRAM)
    sheet["paper_preset"] = "vellum9"
    expect_error(judgement, "an unknown grade", "vellum9", "copy70")
    sheet["paper_preset"] = "copy70"
    scene.objects["handle.Grip"]["paper_mode"] = "sideways"
    expect_error(judgement, "a wrong property", "handle.Grip", "sideways")
    del scene.objects["handle.Grip"]["paper_mode"]
    scene.paperbake.own_frames, scene.paperbake.first = True, FIRST - 1
    expect_error(judgement, "frames before the scene", "Frames 4 to 24", "begins at 5")
    scene.paperbake.own_frames = False
    scene.objects["handle.Grip"].keyframe_insert("hide_viewport", frame=FIRST)
    expect_error(judgement, "a handle that hides", "handle.Grip", "visibility")
    scene.objects["handle.Grip"].animation_data_clear()
    (FOLDER / "failures" / "a file").write_text("")
    scene.paperbake.folder = "//a file"
    expect_error(judgement, "a folder that is a file", "a file")


def test_missed_gate_is_a_warning(judgement):
    """Two corners pulled apart by a tenth: baked, loaded, and said."""
    scene, sheet = new_scene("apart")
    select(sheet)
    with heard():
        bpy.ops.paperbake.mark_sheet()
    for u in (-0.5, 0.5):
        key(empty("handle", (0, 0, 0)), "location", place(sheet, u, 0.5), place(sheet, 1.1 * u, 0.5))
    result, said = report(bpy.ops.paperbake.bake)
    outcome = part("baking").last.outcome
    judgement.check(outcome.level == "WARNING" and "less well" in outcome.sentence and "handle" in outcome.sentence and outcome.sentence in said,
                    f"impossible handles: it says {said!r}")
    judgement.check(result == {"FINISHED"} and "baked.paper.Letter" in scene.objects, "impossible handles: nothing was loaded")
    told = part("job").DRAFT_TOLD
    _, drafted = report(bpy.ops.paperbake.draft)
    summary = json.loads((FOLDER / "apart" / "paperbake" / "draft" / "cert" / "summary.json").read_text(encoding="utf-8"))
    judgement.check(told in drafted and told not in said and summary["attempts"] is None, f"a draft that misses a gate says {drafted!r}")
    judgement.count("failures", 1)


def test_failed_simulation(judgement):
    """What was simulated before it failed is loaded, and the error is told; of a program that was killed nothing is."""
    holding("failed")
    use(standing_in("fails", "printf 'paperbake: frame 12 of 14\n  The sheet cannot follow the handles.\n  Frames 5-11 are kept.\n' >&2", "exit 1"))
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check("Error: frame 12 of 14: The sheet cannot follow the handles. Frames 5-11 are kept." in said, f"a failed simulation: it says {said!r}")
    judgement.check("baked.paper.Letter" in bpy.context.scene.objects, "a failed simulation: what was kept is not loaded")
    holding("killed")
    use(standing_in("dies", "kill -9 $$"))
    expect_error(judgement, "a killed program", "signal 9", "memory")
    use(PROGRAM)


def test_two_sheets(judgement):
    """Each comes back as an object of its own, with its own map and size."""
    scene = holding("two")
    with heard():
        bpy.ops.mesh.primitive_plane_add(size=0.2, location=(1, 0, 0))
        bpy.ops.paperbake.mark_sheet()
    empty("handle", (1.1, 0.1, 0))
    scene.paperbake.own_frames, scene.paperbake.first, scene.paperbake.last = True, FIRST, FIRST + 2
    result, said = report(bpy.ops.paperbake.bake)
    judgement.check(result == {"FINISHED"}, f"two sheets: it says {said}")
    scene.frame_set(FIRST + 2)
    for name, side in (("baked.paper.Letter", 0.14), ("baked.paper.Plane", 0.2)):
        if judgement.check(name in scene.objects, f"two sheets: no {name}"):
            thing = scene.objects[name]
            pictures = {node.image.name for node in thing.material_slots[0].material.node_tree.nodes if node.type == "TEX_IMAGE"}
            judgement.check(pictures == {f"two.{name.removeprefix('baked.').replace('.', '_')}.blender.exr"}, f"{name} has the pictures {pictures}")
            judgement.near([[max(thing.dimensions)]], [[side]], "sides", name, 0.03)


def test_cancel(judgement):
    """A bake that is cancelled on its way ends, says where, loads nothing, and leaves a whole cache: of the frames until then."""
    part("program").KILL_AFTER = 1000  # [s] it obeys
    scene = holding("cancelled")
    folder = FOLDER / "cancelled" / "paperbake"
    folder.mkdir(parents=True)
    (folder / "cancelled.abc").write_bytes(b"of the bake before")
    scene.frame_end = 400
    job = part("job").BakeJob(scene, scene.paperbake, str(PROGRAM))
    until(job, lambda: job.fraction() > 0)
    judgement.check(0 < job.fraction() < 0.2 and " of 396)" in job.text(), f"progress is {job.fraction()}, {job.text()}")
    job.cancel()
    outcome = job.run()
    judgement.check(outcome.level == "WARNING" and re.search(r"cancelled at frame \d+; its files end there", outcome.sentence) and not job.loaded, f"cancelled: it says {outcome}")
    judgement.check((folder / "cancelled.abc").read_bytes()[:6] == b"Ogawa\xff", "the cache is not a whole one")
    judgement.count("failures", 1)


def test_deaf_program_is_killed(judgement):
    deaf = FOLDER / "deaf"
    deaf.write_text("#!/usr/bin/env python3\nimport signal, sys, time\nsignal.signal(signal.SIGTERM, signal.SIG_IGN)\n"
                    "print('{\"message\": \"here\"}', file=sys.stderr, flush=True)\ntime.sleep(60)\n")
    deaf.chmod(0o755)
    part("program").KILL_AFTER = 0.3
    job = part("job").BakeJob(holding("deaf_scene"), bpy.context.scene.paperbake, str(deaf))
    until(job, lambda: job._process and (job._process.poll(), job._process.messages)[1])
    begun = time.monotonic()
    job.cancel()
    outcome = job.run()
    judgement.check(time.monotonic() - begun < 20 and "baked before is still there" in outcome.sentence, f"a program that is deaf to SIGTERM: {outcome}")
    judgement.count("failures", 1)


def test_window(judgement):
    """The operator of the window, event by event: it bakes, can be cancelled, and stops its program when Blender takes it away."""
    scene, baking = holding("window"), part("baking")
    context, reports = Window(scene), []
    operator = types.SimpleNamespace(report=lambda level, sentence: reports.append((level, sentence)))
    for name in ("new_job", "finish", "cancel"):
        setattr(operator, name, types.MethodType(getattr(baking.Bake, name), operator))
    tick, other = types.SimpleNamespace(type="TIMER"), types.SimpleNamespace(type="MOUSEMOVE")

    def go(events):
        judgement.check(baking.Bake.invoke(operator, context, None) == {"RUNNING_MODAL"} and context.timers == 1, "the window's bake does not start")
        judgement.check(baking.Bake.modal(operator, context, other) == {"PASS_THROUGH"}, "the window's bake takes the mouse away")
        result = {"PASS_THROUGH"}
        while result == {"PASS_THROUGH"} and events(baking.running):
            result = baking.Bake.modal(operator, context, tick)
            time.sleep(0.01)
        return result

    layouts = []

    def look(job):
        scene.objects["handle.Grip"]["paper_radius"] = 0.004
        for name in ("paper.Letter", "handle.Grip"):
            layouts.append(panels(types.SimpleNamespace(scene=scene, object=scene.objects[name])))
        return True

    judgement.check(go(look) == {"FINISHED"} and reports[-1][0] in ({"INFO"}, {"WARNING"}), f"the window's bake ends with {reports}")
    judgement.check(any("paperbake.cancel" in layout.shown for layout in layouts), "no panel shows Cancel")
    judgement.check(any(text.startswith("Simulating frame") for layout in layouts for text in layout.texts), "no panel shows the frame")
    layouts.append(panels(types.SimpleNamespace(scene=scene, object=None)))
    shown = {name for layout in layouts for name in layout.shown}
    judgement.check({"preset", "mode", '["paper_radius"]', "paperbake.bake"} <= shown, f"the panels show only {shown}")
    scene.frame_end = 400

    def cancel_soon(job):
        if job.fraction() > 0:
            baking.CancelBake.execute(operator, context)
        return True

    judgement.check(go(cancel_soon) == {"CANCELLED"} and "cancelled" in reports[-1][1], f"the window's cancelled bake ends with {reports[-1]}")
    process = []

    def taken_away(job):
        if job.fraction() > 0:
            process.append(job._process._process)
        return not process

    go(taken_away)
    baking.Bake.cancel(operator, context)
    judgement.check(process and process[0].poll() is not None and baking.running is None and context.timers == 0, "the program goes on when Blender ends")
    judgement.count("windows", 3)


def test_reader_of_maps(judgement):
    """Against Blender's own writer: pixels that no predictor guesses, on a size that no block divides."""
    pixels = numpy.random.default_rng(1).random((37, 53, 4), dtype=numpy.float32)
    image = bpy.data.images.new("random", 53, 37, alpha=True, float_buffer=True, is_data=True)
    image.pixels.foreach_set(pixels.ravel())
    settings = bpy.context.scene.render.image_settings
    settings.file_format, settings.color_mode, settings.color_depth, settings.exr_codec = "OPEN_EXR", "RGBA", "32", "ZIP"
    path = FOLDER / "random.exr"
    image.save_render(str(path))
    read = part("crease_map").layers(path, "RGBA")
    for i, name in enumerate("RGBA"):
        judgement.near(read[name][::-1], pixels[..., i], "texels", f"layer {name}")
    (FOLDER / "broken.exr").write_bytes(path.read_bytes()[:900])
    with contextlib.suppress(part("crease_map").Unreadable):
        part("crease_map").layers(FOLDER / "broken.exr", "R")
        judgement.check(False, "half a map is read as a whole one")


def main():
    judgement = Judgement()
    test_zip_installs(judgement)
    if not judgement.failures:
        use(PROGRAM)
        for test in (test_bake, test_what_was_made_stays, test_what_is_on_vertices_comes_back, test_creases, test_what_is_not_followed_is_told, test_winds, test_groups_of_colliders, test_draft_messages_and_deletion, test_order_and_words_of_messages, test_options_of_the_panel, test_nothing_holds_it,
                     test_what_is_left_out_is_told, test_undo, test_centimetres, test_two_sheets, test_failures_are_told, test_missed_gate_is_a_warning, test_failed_simulation,
                     test_cancel, test_deaf_program_is_killed, test_window, test_reader_of_maps):
            test(judgement)
    return judgement.conclude(f"Blender {bpy.app.version_string}", ("positions", "held places", "keyed places", "attributes", "failures", "windows", "texels"))


if __name__ == "__main__":
    sys.exit(main())
