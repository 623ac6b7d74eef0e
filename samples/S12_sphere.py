"""Writes S12_sphere.glb beside itself: a sheet that begins inside a sphere which shrinks and opens again.

    python3 samples/S12_sphere.py

No handle holds the sheet. The sphere, a mesh of 1,280 triangles whose node is scaled, shrinks from
a radius of 115 mm to 35 mm (frames 1-81), rests (to 87) and opens again to 115 mm (87-127). Because
the whole sheet begins inside the closed mesh, it stays there.
"""
import math
import os

from glb import FPS, Glb

SIDE, QUADS = 0.15, 6  # m, 1
WIDE, NARROW = 0.115, 0.035  # m
MOTION = ((1, WIDE), (81, NARROW), (87, NARROW), (127, WIDE))  # frame, radius
DIVISIONS = 3  # of the triangles of an icosahedron, each into four


def sphere():
    """Points on the unit sphere, and triangles that are counter-clockwise seen from outside."""
    golden = (1 + math.sqrt(5)) / 2
    points = [(x, y * golden, 0) for y in (1, -1) for x in (-1, 1)]
    points += [(0, x, y * golden) for y in (1, -1) for x in (-1, 1)]
    points += [(y * golden, 0, x) for y in (1, -1) for x in (-1, 1)]
    triangles = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
                 (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
                 (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(DIVISIONS):
        middles, finer = {}, []

        def middle(a, b):
            ends = (min(a, b), max(a, b))
            if ends not in middles:
                middles[ends] = len(points)
                points.append(tuple((p + q) / 2 for p, q in zip(points[a], points[b])))
            return middles[ends]

        for a, b, c in triangles:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            finer += [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
        triangles = finer
    return [tuple(c / math.sqrt(sum(d * d for d in p)) for c in p) for p in points], triangles


def sheet():
    """Points, uv and triangles of a flat square in its middle."""
    steps = [i / QUADS for i in range(QUADS + 1)]
    points = [((u - 0.5) * SIDE, 0, (0.5 - v) * SIDE) for v in steps for u in steps]
    uv = [(u, 1 - v) for v in steps for u in steps]
    triangles, row = [], QUADS + 1
    for j in range(QUADS):
        for i in range(QUADS):
            a = j * row + i
            triangles += [(a, a + 1, a + row + 1), (a, a + row + 1, a + row)]
    return points, uv, triangles


def write(path):
    glb = Glb()
    points, uv, triangles = sheet()
    paper = {"attributes": {"POSITION": glb.add(points), "TEXCOORD_0": glb.add(uv)}, "indices": glb.add([i for t in triangles for i in t], "I")}
    points, triangles = sphere()
    ball = {"attributes": {"POSITION": glb.add(points)}, "indices": glb.add([i for t in triangles for i in t], "I")}
    sampler = {"input": glb.add([frame / FPS for frame, _ in MOTION]), "interpolation": "LINEAR",
               "output": glb.add([(radius,) * 3 for _, radius in MOTION])}
    nodes = [{"name": "paper", "mesh": 0, "extras": {"paper_size": [SIDE, SIDE], "paper_fps": FPS}},
             {"name": "collider.sphere", "mesh": 1, "scale": [WIDE] * 3}]
    glb.write(path, nodes, [{"name": "paper", "primitives": [paper]}, {"name": "sphere", "primitives": [ball]}],
              {"name": "shrink", "channels": [{"sampler": 0, "target": {"node": 1, "path": "scale"}}], "samplers": [sampler]})


if __name__ == "__main__":
    write(os.path.join(os.path.dirname(os.path.abspath(__file__)), "S12_sphere.glb"))
