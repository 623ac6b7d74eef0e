"""Writes S0_note.glb and S0_note.handles.csv beside itself: a square note that six fingers crumple and let go.

    python3 samples/S0_note.py

One finger holds each corner, one the front border and one the back border, both a little left of the
middle. They close to 55 % of their distance from the centre (frames 1-56) while the corners sink
and the two others rise by 18 mm and the two ends of the note are turned against each other by
2 x 7 degrees; rest; open by 40 % of the way (60-76); and let go one after the other (78-84), but for
the two corners in front. At every frame any two fingers are nearer to each other than on the flat note.
"""
import json
import math
import os
import struct

SIDE, SHARE, RISE, TURN, OPENED = 0.21, 0.55, 0.018, math.radians(7), 0.4  # m, 1, m, rad, 1
LAST, FPS = 92, 24
MOTION = ((1, 0.0), (56, 1.0), (60, 1.0), (76, 1.0 - OPENED), (LAST, 1.0 - OPENED))  # frame, how far the fingers are closed
FINGERS = (  # name, place on the note, rises or sinks, frame of release
    ("front.left", 0.0, 0.0, -1, None),
    ("front.right", 1.0, 0.0, -1, None),
    ("back.right", 1.0, 1.0, -1, 84),
    ("back.left", 0.0, 1.0, -1, 82),
    ("front.middle", 0.47, 0.0, 1, 80),
    ("back.middle", 0.44, 1.0, 1, 78),
)


def closed(u, v, way):
    """Where the finger at (u, v) of the flat note is when all are closed."""
    x, y = SHARE * (u - 0.5) * SIDE, SHARE * (v - 0.5) * SIDE
    turn = TURN * (2 * u - 1)
    return SIDE / 2 + x, SIDE / 2 + y * math.cos(turn), way * RISE + y * math.sin(turn)


def between(a, b, t):
    return tuple(p + t * (q - p) for p, q in zip(a, b))


def closing(frame):
    """How far the fingers are closed at a frame: between two of MOTION a cubic that begins and ends at rest."""
    for (begin, a), (end, b) in zip(MOTION, MOTION[1:]):
        if frame <= end:
            t = (frame - begin) / (end - begin)
            return a + (b - a) * t * t * (3 - 2 * t)
    return MOTION[-1][1]


class Glb:
    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def add(self, values, width, code):
        """values: rows of that width, one after the other; code: of struct, f or H. returns the number of the accessor"""
        rows = [values[i:i + width] for i in range(0, len(values), width)]
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": struct.calcsize(code) * len(values)})
        self.bytes += struct.pack("<%d%s" % (len(values), code), *values)
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": {"f": 5126, "H": 5123}[code], "count": len(rows),
                               "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3"}[width],
                               "min": [min(column) for column in zip(*rows)], "max": [max(column) for column in zip(*rows)]})
        return len(self.accessors) - 1

    def file(self, scene):
        """The bytes of the whole file: header, scene as JSON, buffer."""
        scene = {**scene, "accessors": self.accessors, "bufferViews": self.views, "buffers": [{"byteLength": len(self.bytes)}]}
        text = json.dumps(scene, separators=(",", ":")).encode()
        chunks = b""
        for kind, data, fill in ((0x4E4F534A, text, b" "), (0x004E4942, self.bytes, b"\0")):
            data += fill * (-len(data) % 4)
            chunks += struct.pack("<II", len(data), kind) + data
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def y_up(p):
    return [p[0], p[2], -p[1]]


def note(glb):
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    attributes = {"POSITION": glb.add([c for u, v in corners for c in y_up((u * SIDE, v * SIDE, 0))], 3, "f"),
                  "TEXCOORD_0": glb.add([c for u, v in corners for c in (u, 1 - v)], 2, "f")}
    return {"name": "paper", "primitives": [{"attributes": attributes, "indices": glb.add([0, 1, 2, 0, 2, 3], 1, "H")}]}


def scene(glb):
    nodes = [{"name": "paper", "mesh": 0, "extras": {"paper_size": [SIDE, SIDE], "paper_gsm": 70, "paper_thickness": 9e-5, "paper_fps": FPS}}]
    channels, samplers = [], []
    meshes = [note(glb)]
    frames = range(1, LAST + 1)  # a key at each: programs differ in how they read curves with tangents
    times = glb.add([frame / FPS for frame in frames], 1, "f")
    for name, u, v, way, release in FINGERS:
        flat, end = (u * SIDE, v * SIDE, 0.0), closed(u, v, way)
        keyed = [c for frame in frames for c in y_up(between(flat, end, closing(frame)))]
        samplers.append({"input": times, "interpolation": "LINEAR", "output": glb.add(keyed, 3, "f")})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": len(nodes), "path": "translation"}})
        nodes.append({"name": "handle." + name, "translation": y_up(flat)})
        if release is not None:
            nodes[-1]["extras"] = {"paper_release_frame": release}
    return {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes, "meshes": meshes,
            "animations": [{"name": "crumple", "channels": channels, "samplers": samplers}]}


def write(folder):
    glb = Glb()
    with open(os.path.join(folder, "S0_note.glb"), "wb") as file:
        file.write(glb.file(scene(glb)))
    with open(os.path.join(folder, "S0_note.handles.csv"), "w") as file:
        file.write("frame,handle,x,y,z,qw,qx,qy,qz\n")
        for frame in range(1, LAST + 1):
            for name, u, v, way, _ in FINGERS:
                place = between((u * SIDE, v * SIDE, 0.0), closed(u, v, way), closing(frame))
                file.write("%d,handle.%s,%.7f,%.7f,%.7f,1.000000,0.000000,0.000000,0.000000\n" % (frame, name, *place))


write(os.path.dirname(os.path.abspath(__file__)))
