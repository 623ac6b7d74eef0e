"""Writes the fold scenes F1 to F10 beside itself, each as .glb, .fbx and .handles.csv.

    python samples/folds.py [NAME...]          with Blender 4.2 or later as the module bpy

Sheets lie in z = 0, their lower left corner at the origin. A hand is a group of handles that keep
their distances from each other; its pose says where it takes the paper at a frame. Every motion
begins and ends at rest and is keyed at every frame, so that curved paths are exact there.

Before it writes a scene, the script asserts what paper needs to follow (`check`), on the positions
that Blender evaluates, and prints how near each of these limits is.
"""
import contextlib
import datetime
import io
import itertools
import math
import os
import sys
import zlib
from dataclasses import dataclass
from typing import Callable, Optional, Tuple

import bpy
from mathutils import Matrix, Vector

FPS = 24
COPY70, COPY80 = (70.0, 9e-5), (80.0, 1e-4)  # g/m2, m
MM = 1e-3
LAYER_GAP = 0.5 * MM  # layers that lie on each other, and paper on a collider, are not held nearer
ROUNDING = 1e-6  # m; Blender and the files count in single precision
FOLDER = os.path.dirname(os.path.abspath(__file__))


# Scenes as data


@dataclass(frozen=True)
class Hand:
    """Handles that move as one rigid body."""

    name: str
    points: Tuple[Tuple[float, float], ...]  # [m] where they hold the flat sheet
    pose: Callable[[int], Matrix]  # frame -> 4x4, the motion of the flat sheet at these points
    flap: Optional[Tuple[Tuple[float, float], ...]] = None  # [m] corners of the part kept flat
    release: Optional[int] = None  # the first frame at which it no longer holds

    def names(self):
        return ["handle.%s.%d" % (self.name, i) for i in range(len(self.points))]

    def holds(self, frame):
        return self.release is None or frame < self.release


@dataclass(frozen=True)
class Box:
    """A collider with faces parallel to the axes."""

    name: str
    low: Tuple[float, float, float]  # [m] corner of least coordinates where `offset` is 0
    size: Tuple[float, float, float]  # [m]
    offset: Callable[[int], Vector] = lambda frame: Vector((0, 0, 0))

    def distance(self, point, frame):
        """[m] From the box at a frame to a point outside; 0 for points inside."""
        low = Vector(self.low) + self.offset(frame)
        return Vector(max(a - c, 0, c - a - s) for a, s, c in zip(low, self.size, point)).length


@dataclass(frozen=True)
class Scene:
    name: str
    size: Tuple[float, float]  # [m] of the sheet
    last: int  # frame
    hands: Tuple[Hand, ...]
    boxes: Tuple[Box, ...] = ()
    gravity: float = 0.0  # m/s2
    paper: Tuple[float, float] = COPY70  # g/m2, m
    # [m] ends of the creases that are drawn on the flat sheet
    creases: Tuple[Tuple[Tuple[float, float], Tuple[float, float]], ...] = ()


# Motions


def eased(frame, begin, end):
    """0 up to frame `begin`, 1 from frame `end`, and a cubic that begins and ends at rest."""
    t = min(1.0, max(0.0, (frame - begin) / (end - begin)))
    return t * t * (3 - 2 * t)


def along(frame, stops):
    """The value at a frame of a motion that rests at each of its stops ((frame, value), ...)."""
    value = stops[0][1]
    for (begin, a), (end, b) in zip(stops, stops[1:]):
        value += (b - a) * eased(frame, begin, end)
    return value


def flat(frame):
    """The pose of what stays where it is."""
    return Matrix.Identity(4)


def turned(degrees, point, axis):
    """The turn about the line through `point` of the sheet, right-handed about `axis`."""
    origin = Matrix.Translation(Vector((*point, 0)))
    return origin @ Matrix.Rotation(math.radians(degrees), 4, Vector(axis)) @ origin.inverted()


def mm(*points):
    """Points of the sheet, given in millimetres."""
    return tuple(tuple(c * MM for c in p) for p in points)


def rectangle(x0, y0, x1, y1):
    return mm((x0, y0), (x1, y0), (x1, y1), (x0, y1))


def table(width, height):
    """A table top under a sheet of this size, as far below it as paper lies on colliders."""
    margin, depth = 30 * MM, 10 * MM
    low = (-margin, -margin, -LAYER_GAP - depth)
    return Box("collider.table", low, (width + 2 * margin, height + 2 * margin, depth))


# The scenes


def letter():
    """A4 folded in three: the bottom third up by 177.5 degrees, the top third over it by 165.

    The top third has no paper to spare: flat from its fold at y = 198 to its handles, it passes
    1.6 mm over the place of the bottom edge, which a flat bottom third would lift to 4.2 mm. So the
    lower hand does not hold the edge: 30 mm of it stay free and bend down by 3 mm.
    """
    free = 30

    def bottom(frame):
        return turned(along(frame, ((1, 0), (45, 177.5))), mm((0, 96))[0], (-1, 0, 0))

    def top(frame):
        return turned(along(frame, ((40, 0), (90, 165))), mm((0, 198))[0], (1, 0, 0))

    edge = turned(177.5, mm((0, 96))[0], (-1, 0, 0)) @ sheet_point(0, 0)
    room = (198 * MM - edge.y) * math.tan(math.radians(180 - 165))  # [m] under the top third there
    assert room >= 2 * LAYER_GAP, "the bottom edge has no place between its neighbours"

    middle = mm((0, 110), (210, 110), (105, 147), (0, 184), (210, 184))
    low = mm((0, free), (105, free), (210, free), (52.5, 66), (157.5, 66))
    high = mm((0, 297), (105, 297), (210, 297), (52.5, 247.5), (157.5, 247.5))
    return Scene("F1_letter", (0.210, 0.297), 96, (
        Hand("middle", middle, flat, rectangle(0, 96, 210, 198)),
        Hand("bottom", low, bottom, rectangle(0, free, 210, 96)),
        Hand("top", high, top, rectangle(0, 198, 210, 297))))


def half():
    """A square folded in half; a bar presses the fold; the flap is turned back and let go.

    The bar comes down to 2.5 mm over x = 47 to 77. From 172 degrees on it takes the flap along: the
    hand turns on to where the flat flap lies half a millimetre under the edge of the bar, so that
    the paper is never asked to be longer than it is.
    """
    side, fold, edge = 150, 75, 47

    def bar(frame):
        return Vector((0, 0, along(frame, ((40, 110), (58, 2.5), (64, 2.5), (78, 110))) * MM))

    def open_under_bar(frame):
        """[degrees] between the halves when the flap lies under the bar's edge."""
        across, up = fold - edge, bar(frame).z / MM
        gap = (LAYER_GAP + 20e-6) / MM
        return math.degrees(math.atan2(up, across) - math.asin(gap / math.hypot(across, up)))

    def flap(frame):
        turn = along(frame, ((1, 0), (40, 172)))
        if turn > 171.9:
            turn = max(turn, 180 - open_under_bar(frame))
        turn -= along(frame, ((64, 0), (90, 1))) * (turn - 80)
        return turned(turn, mm((fold, 0))[0], (0, -1, 0))

    held = mm((0, 0), (0, 75), (0, 150), (40, 20), (40, 130))
    moved = mm((150, 0), (150, 75), (150, 150), (112.5, 37.5), (112.5, 112.5))
    return Scene("F2_half", (0.150, 0.150), 120, (
        Hand("left", held, flat, rectangle(0, 0, fold, side)),
        Hand("flap", moved, flap, rectangle(fold, 0, side, side), release=92)),
        (table(0.150, 0.150), Box("collider.bar", (edge * MM, 0, 0), (0.030, 0.150, 0.020), bar)),
        gravity=9.81)


def quarter():
    """A square folded twice, the second fold across the first: four layers.

    The first fold is turned by 178.8 degrees, so that its layers are 0.6 to 1.3 mm apart where
    hands hold them. The second turns the lower layer by 176 degrees and, at its end, lifts it by
    1.2 mm over the two layers that it carries between itself and the lower half: round those, this
    outer layer needs the paper on both sides of its fold, and has just enough. The layer inside is
    held at its corner until it can no longer spring out; then it lies as long as it is.
    """
    middle, side = 60, 120

    def second(frame):
        return along(frame, ((48, 0), (96, 176)))

    def first_fold(frame):
        return turned(along(frame, ((1, 0), (40, 178.8))), mm((middle, 0))[0], (0, -1, 0))

    def second_fold(frame):
        lift = Vector((0, 0, 1.2 * MM * eased(second(frame), 120, 176)))
        turn = turned(second(frame), mm((0, middle))[0], (1, 0, 0))
        return Matrix.Translation(lift) @ turn

    def both_folds(frame):
        return second_fold(frame) @ first_fold(frame)

    released = min(f for f in range(48, 97) if second(f) >= 120)
    return Scene("F3_quarter", (0.120, 0.120), 108, (
        Hand("lower", mm((0, 0), (30, 3), (3, 35)), flat, rectangle(0, 0, middle, middle)),
        Hand("lower.over", mm((120, 0), (90, 5), (118, 25)), first_fold,
             rectangle(middle, 0, side, middle)),
        Hand("upper", mm((0, 120), (30, 117), (3, 85)), second_fold,
             rectangle(0, middle, middle, side)),
        Hand("upper.over", mm((120, 120)), both_folds, release=released)))


def fan():
    """Five strips turned to and fro by 80 degrees, four pleats between; then opened by half."""
    width, height, count, inset = 160, 100, 5, 8
    strip = width / count

    def steepness(frame):
        return along(frame, ((1, 0), (60, 80), (66, 80), (90, 40)))

    def hand(i):
        centre = (i + 0.5) * strip

        def pose(frame):
            turn = steepness(frame)
            nearer = (centre - width / 2) * (math.cos(math.radians(turn)) - 1) * MM
            way = turned(turn * (-1) ** i, mm((centre, 0))[0], (0, -1, 0))
            return Matrix.Translation(Vector((nearer, 0, 0))) @ way

        points = [(centre + x, y) for y in (0, height) for x in (-inset, inset)]
        return Hand("strip%d" % i, mm(*points), pose,
                    rectangle(i * strip, 0, (i + 1) * strip, height))

    return Scene("F4_fan", (0.160, 0.100), 96, tuple(hand(i) for i in range(count)))


def corner():
    """A corner folded over along a diagonal line, turned back, and folded again on that line."""
    def folded(frame):
        turn = along(frame, ((1, 0), (36, 175), (42, 175), (66, 20), (70, 20), (102, 175)))
        return turned(turn, mm((105, 105))[0], (1, -1, 0))

    page = mm((0, 0), (75, 0), (150, 0), (0, 75), (0, 150), (90, 90))
    flap = mm((150, 150), (145, 85), (85, 145), (120, 120))
    return Scene("F5_corner", (0.150, 0.150), 108, (
        Hand("page", page, flat, mm((0, 0), (150, 0), (150, 60), (60, 150), (0, 150))),
        Hand("flap", flap, folded, mm((150, 60), (150, 150), (60, 150)))))


def pinch():
    """A page of which two fingers carry one edge over to the other; a flat box presses the loop.

    No hand holds three points, so nothing says where the fold is to be: the sheet lies in a loop,
    and the box makes the fold, a little beyond the middle.
    """
    width, height = 150, 210
    end, above = 6, 3  # [mm] where the carried edge comes to lie

    def carried(frame):
        t = along(frame, ((1, 0), (44, 1)))
        around, half_way = math.pi * t, (height - end) / 2
        y = height - half_way * (1 - math.cos(around))
        return Matrix.Translation(Vector((0, y - height, 80 * math.sin(around) + above * t)) * MM)

    def pressing(frame):
        height_above = along(frame, ((40, 140), (70, 3), (76, 3), (92, 140)))
        return Vector((0, 0, height_above * MM))

    return Scene("F6_pinch", (0.150, 0.210), 120, (
        Hand("near", mm((30, 0), (120, 0)), flat),
        Hand("far", mm((30, height), (120, height)), carried, release=96)),
        (table(0.150, 0.210), Box("collider.press", mm((-10, 50, 0))[0], (0.170, 0.070, 0.015),
                                  pressing)),
        gravity=9.81)


def corners():
    """An A4 letter folded in half by its two corners, and pressed by a box.

    As in pinch(), nothing says where the fold is to be. It has its place where both halves lie
    straight between it and their corners: half way between the bottom edge and where the top edge
    comes to lie, measured round the fold, at y = (297 + 8)/2 = 152.5 mm.
    """
    width, height = 210, 297
    end, above = 8, 2  # [mm] where the carried corners come to lie

    def carried(frame):
        t = along(frame, ((1, 0), (44, 1)))
        around, half_way = math.pi * t, (height - end) / 2
        back = half_way * (1 - math.cos(around))
        return Matrix.Translation(Vector((0, -back, 110 * math.sin(around) + above * t)) * MM)

    def pressing(frame):
        return Vector((0, 0, along(frame, ((40, 170), (72, 2.5), (78, 2.5), (94, 170))) * MM))

    return Scene("F7_corners", (0.210, 0.297), 108, (
        Hand("near", mm((0, 0), (width, 0)), flat),
        Hand("far", mm((0, height), (width, height)), carried)),
        (table(0.210, 0.297), Box("collider.press", mm((-10, 60, 0))[0], (0.230, 0.110, 0.015),
                                  pressing)),
        gravity=9.81)


def wrap():
    """A sheet wrapped round a box, two sides first; its corners fold by themselves, like gussets."""
    sheet, box, room = 300, 120, 2  # [mm] the folds are so far from the edges of the box
    low, high = (sheet - box) / 2 - room, (sheet + box) / 2 + room
    middle, near, far = sheet / 2, low + 14, high - 14

    def around(begin, point, axis):
        return lambda frame: turned(90 * eased(frame, begin, begin + 36), point, axis)

    top = mm((middle, middle), (near, middle), (far, middle), (middle, near), (middle, far))
    sides = (("right", 6, mm((high, 0))[0], (0, 1, 0), lambda s: (sheet, s)),
             ("left", 6, mm((low, 0))[0], (0, -1, 0), lambda s: (0, s)),
             ("back", 18, mm((0, high))[0], (-1, 0, 0), lambda s: (s, sheet)),
             ("front", 18, mm((0, low))[0], (1, 0, 0), lambda s: (s, 0)))
    return Scene("F8_wrap", (0.300, 0.300), 66, (
        Hand("top", top, flat, rectangle(low, low, high, high)),
        *(Hand(name, mm(*(place(s) for s in (near, middle, far))), around(begin, point, axis))
          for name, begin, point, axis, place in sides)),
        (Box("collider.box", (*mm((90, 90))[0], -81 * MM), (0.120, 0.120, 0.080)),), gravity=9.81)


def road_map():
    """A map with two creases drawn across each other, folded to a quarter of its size and unfolded.

    Hands hold three of its quarters. The fourth follows between the layers: its crease folds the
    other way round, because the paper there lies upside down.
    """
    width, height = 300, 200

    def first(frame):
        turn = along(frame, ((1, 0), (22, 177.5), (74, 177.5), (95, 0)))
        return turned(turn, mm((width / 2, 0))[0], (0, -1, 0))

    def second(frame):
        turn = along(frame, ((24, 0), (46, 150), (50, 150), (72, 0)))
        return turned(turn, mm((0, height / 2))[0], (1, 0, 0))

    return Scene("F9_map", (0.300, 0.200), 96, (
        Hand("lower", mm((10, 10), (120, 10), (10, 80)), flat, rectangle(0, 0, 150, 100)),
        Hand("right", mm((290, 10), (180, 10), (290, 80)), first, rectangle(150, 0, 300, 100)),
        Hand("upper", mm((10, 190), (120, 190), (10, 160)), second)),
        (table(0.300, 0.200),), gravity=9.81,
        creases=(mm((width / 2, 0), (width / 2, height)), mm((0, height / 2), (width, height / 2))))


def hat():
    """A4 folded in half, and both corners of the folded edge turned down to the middle: a paper hat.

    Six hands hold both layers in the middle and in the corners. The upper layer lies half a
    millimetre over the lower one at the folded edge, and further away beyond. The corners turn
    about lines that meet this edge 2 mm beside its middle, so that they do not touch. In the end
    they are lifted by 1.2 mm, because their outer layer goes round the inner one.
    """
    width, height, beside, brim = 210, 297, 2, 45.5  # [mm] beside the middle; below the corners
    middle, edge = width / 2, height / 2

    def upper(frame):
        turn = along(frame, ((1, 0), (32, 179.5)))
        lift = Vector((0, 0, LAYER_GAP * eased(turn, 120, 179.5)))
        return Matrix.Translation(lift) @ turned(turn, mm((0, edge))[0], (1, 0, 0))

    def down(frame, side, begin):
        """The motion of the right corner (side 1) or the left one (-1), both layers alike."""
        turn = along(frame, ((begin, 0), (begin + 26, 172)))
        lift = Vector((0, 0, 1.2 * MM * eased(turn, 120, 172)))
        line = mm((middle + side * beside, edge))[0]
        return Matrix.Translation(lift) @ turned(turn, line, (1, -side, 0))

    def hands(name, up, pose):
        """The three hands of the lower layer (up -1) or the upper one (1)."""
        def points(side, *places):  # given from the middle of the folded edge
            return mm(*((middle + side * x, edge + up * y) for x, y in places))

        def part(side, *corners):
            return points(side, *corners[::-up * side])

        def corner(where, side, begin):
            return Hand("%s.%s" % (name, where), points(side, (97, 16), (60, 14), (97, 64)),
                        lambda frame: down(frame, side, begin) @ pose(frame),
                        part(side, (beside, 0), (middle, edge - brim), (middle, 0)), release=98)

        flap = part(1, (-middle, edge), (middle, edge), (middle, edge - brim), (beside, 0),
                    (-beside, 0), (-middle, edge - brim))
        return (Hand(name, points(1, (-60, 130), (60, 130), (0, 32)), pose, flap),
                corner("right", 1, 36), corner("left", -1, 66))

    return Scene("F10_hat", (0.210, 0.297), 114,
                 hands("lower", -1, flat) + hands("upper", 1, upper), paper=COPY80)


SCENES = (letter, half, quarter, fan, corner, pinch, corners, wrap, road_map, hat)


# What paper needs to follow


def sheet_point(x, y):
    return Vector((x, y, 0))


def corners_of(scene):
    width, height = scene.size
    return [sheet_point(*p) for p in ((0, 0), (width, 0), (width, height), (0, height))]


def samples_of(flap, count=13):
    """Points of a flap with three or four corners, on its sides and inside."""
    a, b, c, d = [sheet_point(*p) for p in (*flap, flap[-1])[:4]]
    steps = [i / (count - 1) for i in range(count)]
    return [a.lerp(b, u).lerp(d.lerp(c, u), v) for u in steps for v in steps]


def covers(flap, point):
    """Whether a point of the sheet lies on a convex flap, its corners counter-clockwise."""
    return all((bx - ax) * (point.y - ay) - (by - ay) * (point.x - ax) >= 0
               for (ax, ay), (bx, by) in zip(flap, flap[1:] + flap[:1]))


def worst_stretch(scene, positions, frame):
    """[m] By how much two handles are farther apart than on the flat sheet, the most; and for those
    of one hand, by how much their distance has changed."""
    held = [(hand, sheet_point(*p), x) for hand in scene.hands if hand.holds(frame)
            for p, x in zip(hand.points, positions[hand.name])]
    apart = rigid = -math.inf
    for (hand, p, x), (other, q, y) in itertools.combinations(held, 2):
        change = (x - y).length - (p - q).length
        if hand is other:
            rigid = max(rigid, abs(change))
        else:
            apart = max(apart, change)
    return apart, rigid


def least_layer_gap(scene, positions, frame):
    """[m] Of a handle from another hand's flap that it lies over, nearly parallel to it."""
    least = math.inf
    hands = [hand for hand in scene.hands if hand.flap and hand.holds(frame)]
    for hand, other in itertools.permutations(hands, 2):
        mine, pose = hand.pose(frame), other.pose(frame)
        normal = pose.to_3x3() @ Vector((0, 0, 1))
        if abs(normal.dot(mine.to_3x3() @ Vector((0, 0, 1)))) < math.cos(math.radians(20)):
            continue
        for x in positions[hand.name]:
            on_sheet = pose.inverted() @ x
            if covers(other.flap, on_sheet):
                least = min(least, abs(on_sheet.z))
    return least


def least_box_gap(scene, positions, frame):
    """[m] Of handles and flat flaps from the boxes."""
    points = []
    if not scene.boxes:
        return math.inf
    for hand in (hand for hand in scene.hands if hand.holds(frame)):
        points += positions[hand.name]
        points += [hand.pose(frame) @ p for p in samples_of(hand.flap)] if hand.flap else []
    return min((box.distance(p, frame) for box in scene.boxes for p in points), default=math.inf)


def check(scene, positions):
    """Asserts at every frame: hands are rigid; no two handles are farther apart than the paper
    between them is long; stacked handles and flaps leave room for layers; boxes are outside."""
    frames = range(1, scene.last + 1)
    assert any(hand.pose(1) != hand.pose(f) for hand in scene.hands for f in frames)
    apart, rigid = map(max, zip(*(worst_stretch(scene, positions[f], f) for f in frames)))
    layers = min(least_layer_gap(scene, positions[f], f) for f in frames if f > 1)
    boxes = min(least_box_gap(scene, positions[f], f) for f in frames)
    off = max((x - hand.pose(f) @ sheet_point(*p)).length for f in frames for hand in scene.hands
              for p, x in zip(hand.points, positions[f][hand.name]))
    start = max((hand.pose(1) @ v - v).length for hand in scene.hands for v in corners_of(scene))
    print("%s: hands rigid to %.5f mm; handles of two hands at most %+.5f mm farther apart than on "
          "the sheet; nearest layer %.3f mm away, nearest collider %.3f mm (inf: there is none)"
          % (scene.name, rigid / MM, apart / MM, layers / MM, boxes / MM))
    assert off <= ROUNDING and start <= ROUNDING  # keys mean what they say; the sheet begins flat
    assert rigid <= ROUNDING and apart <= ROUNDING
    assert layers >= LAYER_GAP - ROUNDING and boxes >= LAYER_GAP - ROUNDING


# Blender


def key_locations(thing, locations):
    """Keys an object at frames 1, 2, ...; one that stays where it is gets no keys."""
    thing.location = locations[0]
    if all((x - locations[0]).length == 0 for x in locations):
        return
    action = bpy.data.actions.new(thing.name)
    for axis in range(3):
        curve = action.fcurves.new("location", index=axis)
        curve.keyframe_points.add(len(locations))
        for key, (i, x) in zip(curve.keyframe_points, enumerate(locations)):
            key.co, key.interpolation = (i + 1, x[axis]), "LINEAR"
        curve.update()
    thing.animation_data_create().action = action  # once it has curves, for their slot to be used


def add_mesh(name, corners, faces):
    mesh = bpy.data.meshes.new(name)
    mesh.from_pydata(corners, [], faces)
    thing = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(thing)
    return thing


def add_sheet(scene):
    corners = corners_of(scene)
    sheet = add_mesh("paper", corners, [(0, 1, 2, 3)])
    for uv, corner in zip(sheet.data.uv_layers.new(name="UVMap").data, corners):
        uv.uv = corner[0] / max(scene.size), corner[1] / max(scene.size)
    sheet["paper_size"] = scene.size
    sheet["paper_gsm"], sheet["paper_thickness"], sheet["paper_fps"] = *scene.paper, FPS
    if scene.gravity:
        sheet["paper_gravity"] = scene.gravity


def add_creases(lines):
    corners = [sheet_point(*p) for line in lines for p in line]
    mesh = bpy.data.meshes.new("crease.lines")
    mesh.from_pydata(corners, [(2 * k, 2 * k + 1) for k in range(len(lines))], [])
    crease = bpy.data.objects.new("crease.lines", mesh)
    bpy.context.scene.collection.objects.link(crease)
    crease["paper_crease"] = 0.0


def add_box(box, frames):
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    corners = list(itertools.product(*((-s / 2, s / 2) for s in box.size)))
    centre = Vector(box.low) + Vector(box.size) / 2
    key_locations(add_mesh(box.name, corners, faces), [centre + box.offset(f) for f in frames])


def add_handle(name, locations, release):
    handle = bpy.data.objects.new(name, None)
    handle.empty_display_size = 5 * MM
    bpy.context.scene.collection.objects.link(handle)
    key_locations(handle, locations)
    if release is not None:
        handle["paper_release_frame"] = release


def build(scene):
    """Makes it Blender's one scene."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    clip = bpy.context.scene
    clip.render.fps, clip.frame_start, clip.frame_end = FPS, 1, scene.last
    frames = range(1, scene.last + 1)
    add_sheet(scene)
    if scene.creases:
        add_creases(scene.creases)
    for box in scene.boxes:
        add_box(box, frames)
    for hand in scene.hands:
        for name, point in zip(hand.names(), hand.points):
            locations = [hand.pose(f) @ sheet_point(*point) for f in frames]
            add_handle(name, locations, hand.release)


def evaluated(scene):
    """{frame: {hand: [position of each handle]}} as Blender itself computes them."""
    positions = {}
    for frame in range(1, scene.last + 1):
        bpy.context.scene.frame_set(frame)
        positions[frame] = {
            hand.name: [bpy.data.objects[n].matrix_world.translation.copy() for n in hand.names()]
            for hand in scene.hands}
    bpy.context.scene.frame_set(1)
    return positions


# Files


def write_positions(scene, positions):
    with open(os.path.join(FOLDER, scene.name + ".handles.csv"), "w") as file:
        file.write("frame,handle,x,y,z,qw,qx,qy,qz\n")
        for frame, by_hand in positions.items():
            for hand in scene.hands:
                for name, x in zip(hand.names(), by_hand[hand.name]):
                    file.write("%d,%s,%.7f,%.7f,%.7f,1.000000,0.000000,0.000000,0.000000\n"
                               % (frame, name, *(c + 0.0 for c in x)))


def write_gltf(path):
    bpy.ops.export_scene.gltf(
        filepath=path, export_format="GLB", export_extras=True, export_yup=True,
        use_mesh_edges=True, export_normals=False, export_materials="NONE",
        export_animation_mode="SCENE", export_anim_scene_split_object=False,
        export_force_sampling=True, export_frame_range=True)


@contextlib.contextmanager
def repeatable_fbx():
    """Blender's exporter writes the time of day, and numbers objects by Python's hash, which is
    another in every process. Here both are always the same, so that a scene is the same file."""
    from io_scene_fbx import export_fbx_bin, fbx_utils

    header = export_fbx_bin.fbx_header_elements

    def header_without_time(root, data, time=None):
        header(root, data, datetime.datetime(1970, 1, 1))

    export_fbx_bin.fbx_header_elements = header_without_time
    fbx_utils.hash = lambda key: zlib.crc32(repr(key).encode())
    try:
        yield
    finally:
        export_fbx_bin.fbx_header_elements = header
        del fbx_utils.hash


def write_fbx(path):
    with repeatable_fbx():
        bpy.ops.export_scene.fbx(
            filepath=path, use_custom_props=True, use_mesh_edges=True, bake_anim=True,
            bake_anim_use_nla_strips=False, bake_anim_use_all_actions=False,
            bake_anim_simplify_factor=0.0)


def write(scene):
    with contextlib.redirect_stdout(io.StringIO()):  # the exporters talk
        build(scene)
        positions = evaluated(scene)
    check(scene, positions)
    with contextlib.redirect_stdout(io.StringIO()):
        write_gltf(os.path.join(FOLDER, scene.name + ".glb"))
        write_fbx(os.path.join(FOLDER, scene.name + ".fbx"))
    write_positions(scene, positions)


def main(names):
    scenes = [make() for make in SCENES]
    for scene in scenes:
        if not names or scene.name in names:
            write(scene)


if __name__ == "__main__":
    main(sys.argv[1:])
