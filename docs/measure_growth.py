"""How CPU time and memory of a bake grow with the size of what is asked: rows of growth.csv.

The scenes are made here: sheets of 0.21 m side by side, each held along two borders, which are
pushed together and let apart again by 8 % of the sheet, once in 96 frames. Some lie on a ball.
"""

import json
import math
import os
import pathlib
import struct
import subprocess
import sys
import tempfile

SIDE, PUSH, PERIOD, FPS = 0.21, 0.04, 96, 24  # m, share of the side for each border, frames, 1/s
BALL, BELOW = 0.06, 0.005  # m, radius, and how far below the middle of a sheet it begins


class Series:
    """What grows, its values, and why it grows so.

    scene    frames, sheets, handles of each sheet and triangles of a ball, for a value
    options  of the bake, with {} for the value
    """

    def __init__(self, what, values, scene, options, why):
        self.what, self.values, self.scene, self.options, self.why = (
            what,
            values,
            scene,
            options,
            why,
        )


SERIES = (
    Series(
        "frames",
        (125, 500, 2000),
        lambda n: (n, 1, 4),
        "--formats abc,cert --quality draft",
        "every frame is simulated, rendered and written once; in memory stays the simulated shape, "
        "which the render mesh is made for",
    ),
    Series(
        "sheets",
        (2, 8, 32),
        lambda n: (12, n, 4),
        "--formats abc,cert --quality draft",
        "sheets that never come near each other are rendered one after the other",
    ),
    Series(
        "simulated triangles",
        (1250, 5000, 20000),
        lambda n: (6, 1, 4),
        "--method fem --triangles {} --formats cert",
        "a factor of a plane mesh of n triangles takes n^1.5 operations and n log n of memory",
    ),
    Series(
        "render triangles",
        ("draft", "shot", "hero"),
        lambda n: (24, 1, 4),
        "--formats abc,cert --quality {} --polish 0",
        "a frame passes over all triangles; a factor of the mesh, n^1.5, is made once",
    ),
    Series(
        "map size",
        (512, 2048, 8192),
        lambda n: (2, 1, 4),
        "--formats cert,maps --map-size {}",
        "two maps of size^2 texels, whose long rows leave the caches of the processor; in memory "
        "are one strip of texels and the packed file",
    ),
    Series(
        "handles",
        (24, 96, 400),
        lambda n: (48, 1, n),
        "--formats cert",
        "the mesh has a vertex at each handle, so it grows with them from some number on",
    ),
    Series(
        "triangles of a collider",
        (1600, 12800, 102400),
        lambda n: (48, 1, 4, n),
        "--gravity 9.81 --formats cert",
        "the tree over n triangles is made once, in n log n; of them those within a few millimetres "
        "of the paper count in each step, a share of n",
    ),
)


class Glb:
    """The buffer of a .glb file."""

    def __init__(self):
        self.bytes, self.views, self.accessors = b"", [], []

    def add(self, rows, code):
        """rows: of one length, of floats (code f) or indices (H). returns their accessor"""
        self.bytes += b"\0" * (-len(self.bytes) % 4)
        packed = b"".join(struct.pack(f"<{len(row)}{code}", *row) for row in rows)
        self.views.append(
            {"buffer": 0, "byteOffset": len(self.bytes), "byteLength": len(packed)}
        )
        self.bytes += packed
        self.accessors.append(
            {
                "bufferView": len(self.views) - 1,
                "componentType": {"f": 5126, "H": 5123}[code],
                "count": len(rows),
                "type": {1: "SCALAR", 2: "VEC2", 3: "VEC3"}[len(rows[0])],
                "min": [min(column) for column in zip(*rows)],
                "max": [max(column) for column in zip(*rows)],
            }
        )
        return len(self.accessors) - 1

    def file(self, scene):
        scene = {
            **scene,
            "accessors": self.accessors,
            "bufferViews": self.views,
            "buffers": [{"byteLength": len(self.bytes)}],
        }
        text = json.dumps(scene).encode()
        text += b" " * (-len(text) % 4)
        data = self.bytes + b"\0" * (-len(self.bytes) % 4)
        chunks = struct.pack("<II", len(text), 0x4E4F534A) + text
        chunks += struct.pack("<II", len(data), 0x004E4942) + data
        return struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks


def ball(triangles):
    """Its corners and triangles."""
    around = round(math.sqrt(triangles))
    rows = round(triangles / (2 * around)) + 1
    points = [(0, -BALL, 0), (0, BALL, 0)]
    faces = []
    for k in range(1, rows):
        angle = math.pi * k / rows
        points += [
            (
                BALL * math.sin(angle) * math.sin(2 * math.pi * i / around),
                -BALL * math.cos(angle),
                BALL * math.sin(angle) * math.cos(2 * math.pi * i / around),
            )
            for i in range(around)
        ]
    for i in range(around):
        j, first, last = (i + 1) % around, 2, 2 + (rows - 2) * around
        faces += [(0, first + j, first + i), (1, last + i, last + j)]
        for here in range(first, last, around):
            above = here + around
            faces += [(here + i, here + j, above + j), (here + i, above + j, above + i)]
    return points, faces


def scene(frames, sheets, handles, of_ball=0):
    """The bytes of a .glb file.

    handles  of each sheet, half of them along each of two borders
    of_ball  triangles of a ball below the first sheet; 0: there is none
    """
    glb, nodes, channels, samplers = Glb(), [], [], []
    corners = [(0, 0), (1, 0), (1, 1), (0, 1)]
    attributes = {
        "POSITION": glb.add([(u * SIDE, 0, -v * SIDE) for u, v in corners], "f"),
        "TEXCOORD_0": glb.add([(float(u), 1.0 - v) for u, v in corners], "f"),
    }
    indices = glb.add([[v] for v in (0, 1, 2, 0, 2, 3)], "H")
    times = glb.add([[k / FPS] for k in range(1, frames + 1)], "f")
    ways = [
        PUSH * SIDE * 0.5 * (1 - math.cos(2 * math.pi * k / PERIOD)) for k in range(frames)
    ]
    for s in range(sheets):
        left, front = 1.5 * SIDE * (s % 8), -1.5 * SIDE * (s // 8)
        nodes.append(
            {
                "name": f"paper.{s:02}",
                "mesh": s,
                "translation": [left, 0, front],
                "extras": {"paper_size": [SIDE, SIDE], "paper_fps": FPS},
            }
        )
        for k in range(handles):
            share, side = (k // 2) / max(1, handles // 2 - 1), k % 2
            at = (left + side * SIDE, 0, front - share * SIDE)
            moved = [(at[0] + (1 - 2 * side) * way, 0, at[2]) for way in ways]
            samplers.append(
                {"input": times, "interpolation": "LINEAR", "output": glb.add(moved, "f")}
            )
            channels.append(
                {
                    "sampler": len(samplers) - 1,
                    "target": {"node": len(nodes), "path": "translation"},
                }
            )
            nodes.append({"name": f"handle.{s}.{k}", "translation": list(at)})
    meshes = [
        {"name": "paper", "primitives": [{"attributes": attributes, "indices": indices}]}
        for _ in range(sheets)
    ]
    if of_ball:
        points, faces = ball(of_ball)
        nodes.append(
            {
                "name": "collider.ball",
                "mesh": len(meshes),
                "translation": [SIDE / 2, -BALL - BELOW, -SIDE / 2],
            }
        )
        corners = glb.add([[v] for face in faces for v in face], "H")
        attributes = {"POSITION": glb.add(points, "f")}
        meshes.append({"name": "ball", "primitives": [{"attributes": attributes, "indices": corners}]})
    return glb.file(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": list(range(len(nodes)))}],
            "nodes": nodes,
            "meshes": meshes,
            "animations": [{"name": "push", "channels": channels, "samplers": samplers}],
        }
    )


def bake(program, size, options):
    """CPU seconds, peak memory [MB] and summary of one bake on one thread."""
    with tempfile.TemporaryDirectory() as folder:
        file, out = pathlib.Path(folder) / "sheets.glb", pathlib.Path(folder) / "out"
        file.write_bytes(scene(*size))
        words = [program, "bake", str(file), "-o", str(out), "--progress", "none", "--threads", "1"]
        process = subprocess.Popen(words + options.split(), stdout=subprocess.DEVNULL)
        _, status, used = os.wait4(process.pid, 0)
        process.returncode = os.waitstatus_to_exitcode(status)
        if process.returncode not in (0, 4):
            sys.exit(f"{' '.join(words + options.split())} ends with {process.returncode}")
        summary = json.loads((out / "cert" / "summary.json").read_text())
        return used.ru_utime + used.ru_stime, used.ru_maxrss / 1024, summary


def exponent(before, now, key):
    """p where the column grows with size^p between two rows."""
    sizes = float(now["size"]) / float(before["size"])
    return f"{math.log(float(now[key]) / float(before[key])) / math.log(sizes):.2f}"


def measure_growth(program, in_part):
    rows = []
    for series in SERIES[:1] if in_part else SERIES:
        before = None
        for value in series.values[:2] if in_part else series.values:
            options = series.options.format(value)
            seconds, memory, summary = bake(program, series.scene(value), options)
            row = {"what": series.what, "size": value}
            if series.what == "simulated triangles":
                row["size"] = round(summary["triangles"]["mean"])
            if series.what == "render triangles":
                row["size"] = round(summary["render_triangles"]["mean"])
            row.update(cpu_s=f"{seconds:.2f}", peak_MB=f"{memory:.0f}")
            if before:
                row["cpu_exponent"] = exponent(before, row, "cpu_s")
                row["memory_exponent"] = exponent(before, row, "peak_MB")
            else:
                row["why"] = series.why
            row["options"] = options
            rows.append(row)
            before = row
    return rows
