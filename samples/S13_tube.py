"""Writes S13_tube.glb beside itself: a sheet rolled into a tube, in a can whose lid comes down.

    python3 samples/S13_tube.py

The crumple of the experiments of [Gottesman 2018] and [Andrejevic 2021]: a square sheet of 100 mm is
rolled into a tube with a radius of 13.5 mm, in a rigid cylinder, and pressed along its axis by a
piston. It begins as a tube that does not yet overlap. The can, a closed mesh without friction whose
node is scaled, narrows to the radius of the experiment (frames 1-25); then its lid comes down from
the height of the sheet to 60 mm (25-57). No handle holds the sheet.
"""
import math
import os

from glb import FPS, Glb

SIDE = 0.1  # m
WIDE, NARROW = 0.0175, 0.0135  # m, radius of the can: around the sheet without overlap; 0.135 sides
HIGH, LOW = 0.1 + 0.002, 0.06  # m, height of the can
SPACE, OVERLAP = 0.0008, 0.0012  # m, from can to paper; how much farther in one border is
MOTION = ((1, WIDE, HIGH), (25, NARROW, 0.1), (57, NARROW, LOW))  # frame, radius, height
AROUND, QUADS = 64, 48  # corners of the can; quads of the sheet around it


def can():
    """Points of the closed can of radius and height 1, and triangles seen from outside."""
    points, triangles = [], []
    for height in (0.0, 1.0):
        for i in range(AROUND):
            angle = 2 * math.pi * i / AROUND
            points.append((math.cos(angle), height, -math.sin(angle)))
    points += [(0.0, 0.0, 0.0), (0.0, 1.0, 0.0)]
    for i in range(AROUND):
        a, b = i, (i + 1) % AROUND
        triangles += [(a, b, AROUND + b), (a, AROUND + b, AROUND + a),
                      (b, a, 2 * AROUND), (AROUND + a, AROUND + b, 2 * AROUND + 1)]
    return points, triangles


def tube():
    """Points, uv and triangles of the rolled sheet: a spiral, so that one border goes inside."""
    points, uv, triangles = [], [], []
    outer = WIDE - SPACE
    angle, gone, places = 0.0, 0.0, []
    step = SIDE / QUADS
    for i in range(QUADS + 1):
        radius = outer - OVERLAP * gone / SIDE
        places.append((radius, angle))
        # the next place, a chord of the spiral away
        following = outer - OVERLAP * (gone + step) / SIDE
        cosine = (radius**2 + following**2 - step**2) / (2 * radius * following)
        angle += math.acos(cosine)
        gone += step
    for v in (0.0, 1.0):
        for i, (radius, turned) in enumerate(places):
            points.append((radius * math.cos(turned), 0.001 + v * SIDE, -radius * math.sin(turned)))
            uv.append((i / QUADS, 1 - v))
    row = QUADS + 1
    for i in range(QUADS):
        triangles += [(i, i + 1, row + i + 1), (i, row + i + 1, row + i)]
    return points, uv, triangles


def write(path):
    glb = Glb()
    points, uv, triangles = tube()
    paper = {"attributes": {"POSITION": glb.add(points), "TEXCOORD_0": glb.add(uv)},
             "indices": glb.add([i for t in triangles for i in t], "I")}
    points, triangles = can()
    cylinder = {"attributes": {"POSITION": glb.add(points)}, "indices": glb.add([i for t in triangles for i in t], "I")}
    sampler = {"input": glb.add([frame / FPS for frame, _, _ in MOTION]), "interpolation": "LINEAR",
               "output": glb.add([(radius, height, radius) for _, radius, height in MOTION])}
    nodes = [{"name": "paper", "mesh": 0, "extras": {"paper_size": [SIDE, SIDE], "paper_fps": FPS}},
             {"name": "collider.can", "mesh": 1, "scale": [WIDE, HIGH, WIDE],
              "extras": {"paper_friction": 0.0}}]
    glb.write(path, nodes, [{"name": "paper", "primitives": [paper]}, {"name": "can", "primitives": [cylinder]}],
              {"name": "shrink", "channels": [{"sampler": 0, "target": {"node": 1, "path": "scale"}}], "samplers": [sampler]})


if __name__ == "__main__":
    write(os.path.join(os.path.dirname(os.path.abspath(__file__)), "S13_tube.glb"))
