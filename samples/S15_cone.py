"""Writes S15_cone.glb beside itself: a disc of paper that a finger pushes into a ring, so that it becomes a d-cone.

    python3 samples/S15_cone.py

The disc has a radius of 60 mm, the opening of the ring one of 40 mm, as in the experiments on developable
cones. The finger holds the middle of the disc and goes 30 mm down (frames 4-54).
"""
import math
import os

from glb import FPS, Glb, y_up

RADIUS, CORNERS = 0.06, 40  # m, 1
INNER, OUTER, TOP, BOTTOM, AROUND = 0.04, 0.055, -0.0006, -0.01, 48  # m, and 1: of the ring
FIRST, STILL, LAST, DEPTH = 4, 54, 60, 0.03  # frames, m


def circle(radius, z, corners):
    angles = [2 * math.pi * i / corners for i in range(corners)]
    return [(radius * math.cos(a), radius * math.sin(a), z) for a in angles]


def disc():
    """Points, uv and triangles of the flat sheet, whose middle is in the origin."""
    points = [(0.0, 0.0, 0.0)] + circle(RADIUS, 0.0, CORNERS)
    uv = [(0.5 + 0.5 * x / RADIUS, 0.5 - 0.5 * y / RADIUS) for x, y, _ in points]
    return points, uv, [(0, 1 + i, 1 + (i + 1) % CORNERS) for i in range(CORNERS)]


def ring():
    """Points of the closed ring, and triangles that are counter-clockwise seen from outside."""
    section = ((INNER, BOTTOM), (OUTER, BOTTOM), (OUTER, TOP), (INNER, TOP))
    points = [p for radius, z in section for p in circle(radius, z, AROUND)]
    triangles = []
    for k in range(len(section)):
        one, other = k * AROUND, (k + 1) % len(section) * AROUND
        for i in range(AROUND):
            j = (i + 1) % AROUND
            triangles += [(one + i, one + j, other + j), (one + i, other + j, other + i)]
    return points, triangles


def depth(frame):
    """How far down the finger is: it begins and ends at rest."""
    t = min(max((frame - FIRST) / (STILL - FIRST), 0.0), 1.0)
    return DEPTH * t * t * t * (10 - 15 * t + 6 * t * t)


def write(path):
    glb = Glb()
    points, uv, triangles = disc()
    paper = {"attributes": {"POSITION": glb.add([y_up(p) for p in points]), "TEXCOORD_0": glb.add(uv)},
             "indices": glb.add([i for t in triangles for i in t], "H")}
    points, triangles = ring()
    opening = {"attributes": {"POSITION": glb.add([y_up(p) for p in points])},
               "indices": glb.add([i for t in triangles for i in t], "H")}
    frames = range(1, LAST + 1)
    sampler = {"input": glb.add([frame / FPS for frame in frames]), "interpolation": "LINEAR",
               "output": glb.add([y_up((0.0, 0.0, -depth(frame))) for frame in frames])}
    nodes = [{"name": "paper", "mesh": 0, "extras": {"paper_size": [2 * RADIUS, 2 * RADIUS], "paper_fps": FPS}},
             {"name": "collider.ring", "mesh": 1}, {"name": "handle.tip", "translation": [0.0, 0.0, 0.0]}]
    glb.write(path, nodes, [{"name": "paper", "primitives": [paper]}, {"name": "ring", "primitives": [opening]}],
              {"name": "push", "channels": [{"sampler": 0, "target": {"node": 2, "path": "translation"}}], "samplers": [sampler]})


if __name__ == "__main__":
    write(os.path.join(os.path.dirname(os.path.abspath(__file__)), "S15_cone.glb"))
