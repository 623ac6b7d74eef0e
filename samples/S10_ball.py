"""Writes S10_ball.glb and S10_ball.handles.csv beside itself: A4 crushed to 15 % of its size by twelve handles.

Ten handles on the border and two inside go, frames 1-120, straight to the corners of an icosahedron that fits a ball of 44 mm, and stay to
frame 132. They only come nearer to each other: paper can follow as far as its own thickness lets it.
"""
import json
import math
import os
import struct

WIDTH, HEIGHT, SHARE, LAST, CRUSHED, FPS = 0.21, 0.297, 0.15, 132, 120, 24
RADIUS = SHARE * HEIGHT / 2


def handles():
    """(name, on the flat sheet, in the ball): each goes to the corner of the icosahedron on its side of the sheet."""
    ring = [(0, 0), (.5, 0), (1, 0), (1, 1 / 3), (1, 2 / 3), (1, 1), (.5, 1), (0, 1), (0, 2 / 3), (0, 1 / 3)]
    flat = [("border.%d" % i, u * WIDTH, v * HEIGHT) for i, (u, v) in enumerate(ring)]
    result = []
    for i, (name, x, y) in enumerate(flat):
        around = math.atan2(y - HEIGHT / 2, x - WIDTH / 2)
        z = RADIUS / math.sqrt(5) * (1 if i % 2 == 0 else -1)
        out = 2 * RADIUS / math.sqrt(5)
        result.append(("handle." + name, (x, y, 0), (WIDTH / 2 + out * math.cos(around), HEIGHT / 2 + out * math.sin(around), z)))
    for i, (v, z) in enumerate(((0.35, RADIUS), (0.65, -RADIUS))):
        result.append(("handle.inside.%d" % i, (WIDTH / 2, v * HEIGHT, 0), (WIDTH / 2, HEIGHT / 2, z)))
    return result


class Glb:
    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def add(self, values, width, kind):
        rows = [values[i:i + width] for i in range(0, len(values), width)]
        code, component = ("f", 5126) if kind == "f" else ("H", 5123)
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": struct.calcsize(code) * len(values)})
        self.bytes += struct.pack("<%d%s" % (len(values), code), *values)
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": component, "count": len(rows),
                               "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3"}[width],
                               "min": [min(c) for c in zip(*rows)], "max": [max(c) for c in zip(*rows)]})
        return len(self.accessors) - 1


def y_up(p):
    return [p[0], p[2], -p[1]]


def write(folder):
    glb, nodes, channels, samplers = Glb(), [], [], []
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    attributes = {"POSITION": glb.add([c for u, v in corners for c in y_up((u * WIDTH, v * HEIGHT, 0))], 3, "f"),
                  "TEXCOORD_0": glb.add([c for u, v in corners for c in (u * WIDTH / HEIGHT, 1 - v)], 2, "f")}
    mesh = {"name": "paper", "primitives": [{"attributes": attributes, "indices": glb.add([0, 1, 2, 0, 2, 3], 1, "H")}]}
    nodes.append({"name": "paper", "mesh": 0, "extras": {"paper_size": [WIDTH, HEIGHT], "paper_gsm": 70, "paper_thickness": 9e-5, "paper_fps": FPS}})
    times = glb.add([1 / FPS, CRUSHED / FPS, LAST / FPS], 1, "f")
    for name, begin, end in handles():
        samplers.append({"input": times, "interpolation": "LINEAR", "output": glb.add(y_up(begin) + y_up(end) + y_up(end), 3, "f")})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": len(nodes), "path": "translation"}})
        nodes.append({"name": name, "translation": y_up(begin)})
    scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": [mesh],
             "animations": [{"name": "crush", "channels": channels, "samplers": samplers}], "accessors": glb.accessors,
             "bufferViews": glb.views, "buffers": [{"byteLength": len(glb.bytes)}]}
    text = json.dumps(scene, separators=(",", ":")).encode()
    chunks = b""
    for kind, data, fill in ((0x4E4F534A, text, b" "), (0x004E4942, glb.bytes, b"\0")):
        data += fill * (-len(data) % 4)
        chunks += struct.pack("<II", len(data), kind) + data
    with open(os.path.join(folder, "S10_ball.glb"), "wb") as file:
        file.write(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)
    with open(os.path.join(folder, "S10_ball.handles.csv"), "w") as file:
        file.write("frame,handle,x,y,z,qw,qx,qy,qz\n")
        for frame in range(1, LAST + 1):
            t = min(1, (frame - 1) / (CRUSHED - 1))
            for name, begin, end in handles():
                file.write("%d,%s,%.7f,%.7f,%.7f,1.000000,0.000000,0.000000,0.000000\n" % (frame, name, *(a + t * (b - a) for a, b in zip(begin, end))))


write(os.path.dirname(os.path.abspath(__file__)))
