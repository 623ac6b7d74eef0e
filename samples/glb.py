"""A small writer of .glb scenes, for the samples that need no Blender."""
import json
import struct

FPS = 24
HANDLES_CSV = "frame,handle,x,y,z,qw,qx,qy,qz\n"


def y_up(p):
    return [p[0], p[2], -p[1]]


class Glb:
    """The buffer of a scene and the accessors into it."""

    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def add(self, rows, code="f"):
        """rows: numbers, or tuples of 2 or 3; code: of struct, f, H or I. returns the number of the accessor"""
        rows = [row if isinstance(row, (tuple, list)) else (row,) for row in rows]
        numbers = [n for row in rows for n in row]
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        self.views.append({"buffer": 0, "byteOffset": len(self.bytes), "byteLength": struct.calcsize(code) * len(numbers)})
        self.bytes += struct.pack("<%d%s" % (len(numbers), code), *numbers)
        self.accessors.append({"bufferView": len(self.views) - 1, "componentType": {"f": 5126, "H": 5123, "I": 5125}[code],
                               "count": len(rows), "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3"}[len(rows[0])],
                               "min": [min(column) for column in zip(*rows)], "max": [max(column) for column in zip(*rows)]})
        return len(self.accessors) - 1

    def write(self, path, nodes, meshes, animation):
        scene = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(nodes)))}], "nodes": nodes,
                 "meshes": meshes, "animations": [animation], "accessors": self.accessors, "bufferViews": self.views,
                 "buffers": [{"byteLength": len(self.bytes)}]}
        text = json.dumps(scene, separators=(",", ":")).encode()
        chunks = b""
        for kind, data, fill in ((0x4E4F534A, text, b" "), (0x004E4942, self.bytes, b"\0")):
            data += fill * (-len(data) % 4)
            chunks += struct.pack("<II", len(data), kind) + data
        with open(path, "wb") as file:
            file.write(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


def flat_paper(glb, width, height):
    """The node and the mesh of a flat sheet of copy paper, one of whose corners is in the origin."""
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    side = max(width, height)
    attributes = {"POSITION": glb.add([y_up((u * width, v * height, 0)) for u, v in corners]),
                  "TEXCOORD_0": glb.add([(u * width / side, 1 - v * height / side) for u, v in corners])}
    node = {"name": "paper", "mesh": 0,
            "extras": {"paper_size": [width, height], "paper_gsm": 70, "paper_thickness": 9e-5, "paper_fps": FPS}}
    return node, {"name": "paper", "primitives": [{"attributes": attributes, "indices": glb.add([0, 1, 2, 0, 2, 3], "H")}]}


def write_handles(path, size, action, frames, handles):
    """Writes a flat sheet that handles move: path + .glb, and where they are at every frame, path + .handles.csv.

    size: width and height of the sheet [m]; action: the name of the animation; frames: those of the keys
    handles: (name, position at a frame, more properties of its node) of each; names begin with "handle."
    """
    glb = Glb()
    paper, mesh = flat_paper(glb, *size)
    nodes, channels, samplers = [paper], [], []
    times = glb.add([frame / FPS for frame in frames])
    for name, at, more in handles:
        keys = glb.add([y_up(at(frame)) for frame in frames])
        samplers.append({"input": times, "interpolation": "LINEAR", "output": keys})
        channels.append({"sampler": len(samplers) - 1, "target": {"node": len(nodes), "path": "translation"}})
        nodes.append({"name": name, "translation": y_up(at(1)), **more})
    glb.write(path + ".glb", nodes, [mesh], {"name": action, "channels": channels, "samplers": samplers})
    with open(path + ".handles.csv", "w") as file:
        file.write(HANDLES_CSV)
        for frame in range(1, frames[-1] + 1):
            for name, at, _ in handles:
                file.write("%d,%s,%.7f,%.7f,%.7f,1.000000,0.000000,0.000000,0.000000\n" % (frame, name, *at(frame)))
