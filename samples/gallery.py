"""Writes the scenes G1 to G12, which are shots of docs/gallery.md, beside itself, each as .glb.

    python samples/gallery.py [NAME...]          with Blender 4.2 or later as the module bpy

Every sheet is one quad with the uv set `print`, except for those that begin folded. What moves begins and ends at rest and is keyed at
every frame.
"""
import contextlib
import io
import math
import os
import sys

import bpy
from mathutils import Vector

FPS = 24
EARTH = {"paper_fps": FPS, "paper_gravity": 9.81}
GRADES = ("tissue17", "newsprint45", "copy80", "offset160", "card200", "card300")
FOLDER = os.path.dirname(os.path.abspath(__file__))


def place(name, data, **properties):
    """A new object of the scene with these custom properties."""
    thing = bpy.data.objects.new(name, data)
    bpy.context.collection.objects.link(thing)
    for key, value in properties.items():
        thing[key] = value
    return thing


def quad(name, corner, right, up, **properties):
    """A mesh of one face: its lower left corner and its sides [m]."""
    mesh, (corner, right, up) = bpy.data.meshes.new(name), map(Vector, (corner, right, up))
    mesh.from_pydata([corner, corner + right, corner + right + up, corner + up], [], [range(4)])
    for loop, at in zip(mesh.uv_layers.new(name="print").data, ((0, 0), (1, 0), (1, 1), (0, 1))):
        loop.uv = at
    return place(name, mesh, **properties)


def sheet(name, grade, corner, right, up):
    paper = {"paper_preset": grade, "paper_uv_sets": "print", **EARTH}
    return quad("paper." + name, corner, right, up, **paper)


def hold(name, points, target):
    for i, point in enumerate(points):
        place(f"handle.{name}.{i}", None, paper_target="paper." + target).location = point


def carry(name, path, last, target):
    """A handle whose place at frames 1 to last is path(frame)."""
    handle = place(f"handle.{name}", None, paper_target="paper." + target)
    for frame in range(1, last + 1):
        handle.location = path(frame)
        handle.keyframe_insert("location", frame=frame)
    return last


def eased(frame, last):
    """From 0 at frame 1 to 1 at frame last, at rest at both."""
    t = min((frame - 1) / (last - 1), 1)
    return t * t * t * (10 - 15 * t + 6 * t * t)


def newspaper():
    """A double page that hangs from its two upper corners in a gusty wind."""
    width, height = 0.40, 0.58
    sheet("newspaper", "newsprint45", (0, 0, 0), (width, 0, 0), (0, 0, height))
    hold("top", [(x, 0, height) for x in (0, 0.05, width - 0.05, width)], "newspaper")
    wind = place("wind", None, paper_speed=1.2, paper_gust=0.5, paper_seed=3)
    wind.rotation_euler = (math.radians(-90), 0, math.radians(25))
    return 1


def poster():
    """A poster that is pinned to a wall by three corners; the fourth is peeled off."""
    width, height = 0.297, 0.42
    sheet("poster", "offset160", (0, 0, 0), (0, -width, 0), (0, 0, height))
    quad("collider.wall", (0.002, 0.3, -0.3), (0, -0.9, 0), (0, 0, 1.02))
    hold("pin", [(0, 0, 0), (0, -width, 0), (0, 0, height)], "poster")

    def corner(frame):
        t = eased(frame, 48)
        away = 0.12 * t
        return -0.10 * math.sin(0.55 * math.pi * t), 0.85 * away - width, height - away

    return carry("corner", corner, 60, "poster")


def page():
    """A page of a book that is turned over by its lower corner, above the next page."""
    width, height = 0.15, 0.21
    for name, z, left in (("page", 0, 0), ("next", -0.001, 0.002)):
        sheet(name, "book120", (left, 0, z), (width - left, 0, 0), (0, height, 0))
        hold("spine." + name, [(left, height * i / 4, z) for i in range(5)], name)
    quad("collider.book", (-0.2, -0.05, -0.002), (0.4, 0, 0), (0, height + 0.1, 0))

    def corner(frame):
        turned = math.pi * eased(frame, 60)
        radius = width * (1 - 0.12 * math.sin(turned))
        return radius * math.cos(turned), 0.02 * math.sin(turned), 0.95 * radius * math.sin(turned)

    return carry("corner", corner, 72, "page")


def grades():
    """Strips of six grades, 20 x 5 cm, held along the first 2 cm."""
    for i, grade in enumerate(GRADES):
        y = 0.075 * i
        sheet(grade, grade, (0, y, 0), (-0.2, 0, 0), (0, -0.05, 0))
        rows = [(x, y - across, 0) for x in (0, -0.02) for across in (0, 0.025, 0.05)]
        hold(grade, rows, grade)
    return 1


def strips_of(name, width, curve, columns=20, **properties):
    """A sheet of this width [m] along x whose cross section is a list of points (y, z) [m]."""
    mesh = bpy.data.meshes.new(name)
    corners = [(width * i / columns, y, z) for y, z in curve for i in range(columns + 1)]
    faces = [(k, k + 1, k + columns + 2, k + columns + 1)
             for k in range(len(corners) - columns - 2) if (k + 1) % (columns + 1)]
    mesh.from_pydata(corners, [], faces)
    return place(name, mesh, **properties)


def envelope():
    """A letter slides into an envelope: a sheet that begins folded about its lower edge."""
    width, height, gap, letter_width, letter_height = 0.22, 0.11, 0.004, 0.20, 0.10
    radius, rows = gap / 2, 12
    back = [(0, height - height * k / rows) for k in range(rows)]
    bend = [(radius - radius * math.cos(a), -radius * math.sin(a))
            for a in (math.pi * k / 6 for k in range(7))]
    front = [(gap, height * k / rows) for k in range(1, rows + 1)]
    strips_of("paper.envelope", width, back + bend + front, paper_preset="copy80", **EARTH)
    hold("back", [(x, 0, height) for x in (0, width / 2, width)], "envelope")
    sides = [(x, gap, z) for x in (0, width) for z in (0.001, height / 2, height)]
    hold("front", sides, "envelope")
    left, top = (width - letter_width) / 2, height + 0.01 + letter_height
    sheet("letter", "copy80", (left, radius, top - letter_height), (letter_width, 0, 0),
          (0, 0, letter_height))
    for i, x in enumerate((0.02, letter_width / 2, letter_width - 0.02)):
        carry(f"hand.{i}", lambda frame, x=x: (left + x, radius, top - 0.104 * eased(frame, 48)),
              60, "letter")
    return 60


def book():
    """Four pages of a book; the upper three are turned over one after the other."""
    width, height, thickness, slant, wait = 0.15, 0.21, 0.0012, 0.0015, 12
    for k in range(4):
        left, z = slant * k, -thickness * k
        sheet(f"page.{k}", "book120", (left, 0, z), (width, 0, 0), (0, height, 0))
        hold(f"spine.{k}", [(left, height * i / 4, z) for i in range(5)], f"page.{k}")

    def corner(page):
        left, z = slant * page, -thickness * page

        def path(frame):
            turned = 0.98 * math.pi * eased(max(1, frame - wait * page), 40)
            radius = width * (1 - 0.12 * math.sin(turned))
            rest = z if turned < math.pi / 2 else -z
            return (left + radius * math.cos(turned), 0.02 * math.sin(turned),
                    0.95 * radius * math.sin(turned) + rest)
        return path

    for k in range(3):
        carry(f"corner.{k}", corner(k), 80, f"page.{k}")
    quad("collider.book", (-0.2, -0.05, -0.006), (0.4, 0, 0), (0, height + 0.1, 0))
    return 80


def pleats():
    """A card that begins folded to and fro; one end is pushed to the other and drawn out again."""
    facets, long, width, slope = 6, 0.04, 0.10, math.radians(40)
    run, rise = long * math.cos(slope), long * math.sin(slope)
    corners = [(i * run, y, rise * (i % 2)) for i in range(facets + 1) for y in (0, width)]
    mesh = bpy.data.meshes.new("pleats")
    mesh.from_pydata(corners, [], [(2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1) for i in range(facets)])
    place("paper.pleats", mesh, paper_preset="offset160", **EARTH)
    lines = bpy.data.meshes.new("crease")
    lines.from_pydata(corners[2:-2], [(2 * i, 2 * i + 1) for i in range(facets - 1)], [])
    place("crease.pleats", lines, paper_crease="modelled")
    quad("collider.table", (-0.3, -0.3, -0.001), (1, 0, 0), (0, 0.7, 0))
    rows = (0, width / 2, width)
    hold("end", [(0, y, 0) for y in rows], "pleats")
    for i, y in enumerate(rows):
        def path(frame, y=y):
            pushed, drawn = eased(frame, 36), eased(max(1, frame - 35), 36)
            return facets * (run * (1 - 0.5 * pushed) + (0.92 * long - 0.5 * run) * drawn), y, 0
        carry(f"hand.{i}", path, 72, "pleats")
    return 84


def strip():
    """A strip that begins rolled up, with its layers apart; its outer end is drawn away, and its inner
    end is held along a line about which it turns."""
    width, outer, apart, turns, rows, tail, away = 0.04, 0.0156, 0.0012, 3.5, 24, 0.003, 0.262

    def wound(k):
        angle, radius = 2 * math.pi * k / rows, outer - apart * k / rows
        return -radius * math.sin(angle), -radius * math.cos(angle)

    curve = [(tail, -outer)] + [wound(k) for k in range(round(turns * rows) + 1)]
    strips_of("paper.strip", width, curve, columns=2, paper_preset="copy80", **EARTH)
    quad("collider.table", (-0.1, -0.2, -outer - 0.002), (0.24, 0, 0), (0, 0.7, 0))
    across = (0, width / 2, width)
    hold("core", [(x, *curve[-1]) for x in across], "strip")
    for i, x in enumerate(across):
        carry(f"hand.{i}", lambda frame, x=x: (x, tail + away * eased(frame, 60), -outer), 72, "strip")
    return 72


def plane():
    """A dart of one layer with three creases, whose nose a thread holds in a gusty wind."""
    long, half, body = 0.21, 0.09, 0.022
    steep, flat = math.radians(76), math.radians(4)  # of the body's two sides, and of the wings

    def corner(across, along, side=1):
        wing = max(across - body, 0)
        out = (across - wing) * math.cos(steep) + wing * math.cos(flat)
        return side * out, along, (across - wing) * math.sin(steep) + wing * math.sin(flat)

    right = [(body, long * (1 - body / half)), (body, 0), (half, 0)]  # the wing: its crease, its tip
    corners = [corner(0, long), corner(0, 0), *(corner(*at, side) for side in (1, -1) for at in right)]
    mesh, creases = bpy.data.meshes.new("plane"), bpy.data.meshes.new("crease")
    mesh.from_pydata(corners, [], [(0, 1, 3, 2), (2, 3, 4), (1, 0, 5, 6), (6, 5, 7)])
    creases.from_pydata(corners, [(0, 1), (2, 3), (5, 6)], [])
    place("paper.plane", mesh, paper_preset="copy80", **EARTH)
    place("crease.plane", creases, paper_crease="modelled")
    hold("nose", corners[:1], "plane")
    wind = place("wind", None, paper_speed=3, paper_gust=0.4, paper_seed=5)
    wind.rotation_euler = math.radians(90), 0, 0
    return 1


def arch():
    """A page on a table. Two fingers hold one edge, two push the other one in, and the page rises between them."""
    width, height, inset, way = 0.297, 0.21, 0.01, 0.07
    sheet("page", "copy80", (0, 0, 0), (width, 0, 0), (0, height, 0))
    quad("collider.table", (-0.2, -0.2, -0.0006), (0.7, 0, 0), (0, 0.6, 0))
    rows = (height / 4, 3 * height / 4)
    hold("edge", [(inset, y, 0) for y in rows], "page")
    for i, y in enumerate(rows):
        carry(f"push.{i}", lambda frame, y=y: (width - inset - way * eased(frame, 32), y, 0), 48, "page")
    return 48


def upright():
    """A page that a hand holds upright near a lower corner, and turns. It loses its balance and falls over."""
    width, height, turn = 0.21, 0.297, math.radians(30)
    sheet("page", "copy80", (0, 0, 0), (width, 0, 0), (0, 0, height))
    for i, (x, z) in enumerate(((0.01, 0.01), (0.05, 0.01), (0.01, 0.05), (0.05, 0.05))):

        def path(frame, x=x - 0.03, z=z):
            angle = turn * eased(max(frame - 9, 1), 27)
            return 0.03 + x * math.cos(angle), x * math.sin(angle), z

        carry(f"hand.{i}", path, 60, "page")
    return 60


def popup():
    """A card with two strips cut across its spine, which stand up as two boxes when it is opened."""
    half, height, last = 0.09, 0.13, 48
    strips = ((0.02, 0.06, 0.03), (0.075, 0.11, 0.018))  # lower and upper cut, depth from the spine
    shut, open_ = math.radians(80), math.radians(45)  # steepness of both halves

    def on_half(side, out, along, steep):
        return side * out * math.cos(steep), along, out * math.sin(steep)

    outs = sorted({0, half, *(depth for *_, depth in strips)})
    columns = [-out for out in reversed(outs[1:])] + outs
    rows = sorted({0, height, *(along for strip in strips for along in strip[:2])})
    corners, faces, number = [], [], {}

    def corner(column, row, strip):
        depth = strip[2] if strip else 0
        key = column, row, strip if abs(column) < depth else None
        if key not in number:
            number[key] = len(corners)
            x, y, z = on_half(math.copysign(1, column), abs(column), row, shut)
            corners.append((x, y, 2 * depth * math.sin(shut) - z) if key[2] else (x, y, z))
        return number[key]

    def strip_at(column, row):
        return next((s for s in strips if s[0] < row < s[1] and abs(column) < s[2]), None)

    folds = []
    for low, high in zip(rows, rows[1:]):
        for left, right in zip(columns, columns[1:]):
            strip = strip_at((left + right) / 2, (low + high) / 2)
            at = [corner(*c, strip) for c in ((left, low), (right, low), (right, high), (left, high))]
            faces.append(at)
            folds += [(at[1], at[2])] if right == 0 or strip and abs(right) == strip[2] else []
            folds += [(at[0], at[3])] if strip and left == -strip[2] else []
    mesh, creases = bpy.data.meshes.new("card"), bpy.data.meshes.new("crease")
    mesh.from_pydata(corners, [], faces)
    creases.from_pydata(corners, folds, [])
    place("paper.card", mesh, paper_preset="card200", **EARTH)
    place("crease.card", creases, paper_crease="modelled")
    for side in (-1, 1):
        for i, (out, along) in enumerate(((0.08, 0.01), (0.08, 0.12), (0.05, 0.065))):
            carry(f"half.{side}.{i}", lambda frame, at=(side, out, along): on_half(
                *at, shut + (open_ - shut) * eased(frame, 36)), last, "card")
    return last


SCENES = {"G1_newspaper": newspaper, "G2_poster": poster, "G3_page": page, "G4_grades": grades,
          "G5_envelope": envelope, "G6_book": book, "G7_pleats": pleats,
          "G8_strip": strip, "G9_plane": plane, "G10_arch": arch, "G11_upright": upright,
          "G12_popup": popup}


def main(names):
    for name in names or SCENES:
        bpy.ops.wm.read_factory_settings(use_empty=True)
        scene = bpy.context.scene
        scene.render.fps, scene.frame_start = FPS, 1
        scene.frame_end = SCENES[name]()
        with contextlib.redirect_stdout(io.StringIO()):  # the exporter talks
            bpy.ops.export_scene.gltf(
                filepath=os.path.join(FOLDER, name + ".glb"), export_extras=True,
                export_normals=False, export_materials="NONE", export_animation_mode="SCENE",
                export_anim_scene_split_object=False, export_force_sampling=True,
                use_mesh_edges=True)


if __name__ == "__main__":
    main(sys.argv[1:])
