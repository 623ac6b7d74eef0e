"""Judges a bake of one sheet: reads its cache with the real Alembic library or with Blender, and compares it with the
certificate of the bake and with where the DCC had the handles.

    bake_judge.py alembic|blender FOLDER TRUTH.csv --fps FPS [--truth-mm MM] [--relative HANDLE]...

FOLDER    as paperbake bake writes it
TRUTH     frame,handle,x,y,z,... of every handle at every frame of the shot, in metres and z up
--truth-mm    how far a held point may be from the truth: 0.01, or more where the file itself is coarser
--relative    a handle whose motion counts and not its place
Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import argparse
import csv
import dataclasses
import json
import pathlib
import sys

import numpy

from judgement import Judgement

HELD_TOLERANCE = 1e-6  # [m] of a 32-bit float under 1 m there are 17 steps in this
TIME_TOLERANCE = 1e-9  # [s]
LEAST_MOTION = 1e-3  # [m] a shot in which nothing moves more proves nothing


@dataclasses.dataclass
class Cache:
    name: str  # of the mesh
    times: list  # [s]
    positions: list  # |V|x3 [m] of each frame, z up
    corners: list  # vertices of the faces of each frame, in a row
    sizes: list  # corners of each face of each frame
    corner_uv: numpy.ndarray  # of the uv set "pattern", first frame
    corner_normals: numpy.ndarray  # of the last frame


def corner_normals(schema, time, sample):
    from alembic3d import AbcGeom

    from alembic_judge import selector, z_up

    normals = schema.getNormalsParam().getExpandedValue(selector(time))
    values = numpy.array(z_up(normals.getVals()))
    of_corners = normals.getScope() == AbcGeom.GeometryScope.kFacevaryingScope
    return values if of_corners else values[numpy.array(sample.getFaceIndices())]


def read_with_alembic(path, fps):
    from alembic3d import Abc, AbcGeom

    from alembic_judge import EXISTING, selector, z_up

    (xform,) = Abc.IArchive(str(path)).getTop().children
    (mesh,) = xform.children
    schema = AbcGeom.IPolyMesh(mesh, EXISTING).getSchema()
    sampling = schema.getTimeSampling()
    times = [sampling.getSampleTime(i) for i in range(schema.getNumSamples())]
    samples = [schema.getValue(selector(time)) for time in times]
    uv = AbcGeom.IV2fGeomParam(schema.getArbGeomParams(), "pattern").getExpandedValue(selector(times[0])).getVals()
    return Cache(xform.getName(), times, [numpy.array(z_up(s.getPositions())) for s in samples],
                 [numpy.array(s.getFaceIndices()) for s in samples], [numpy.array(s.getFaceCounts()) for s in samples],
                 numpy.array([(p.x, p.y) for p in uv]), corner_normals(schema, times[-1], samples[-1]))


def read_with_blender(path, fps):
    import bpy

    from blender_judge import empty_scene, floats, imported, integers

    scene = empty_scene(fps)
    if not imported(path):
        raise RuntimeError("Blender does not import it")
    (sheet,) = (o for o in scene.objects if o.type == "MESH")
    cache = Cache(sheet.name, [], [], [], [], None, None)
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        evaluated = sheet.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh, world = evaluated.to_mesh(), numpy.array(evaluated.matrix_world)
        cache.times.append(frame / fps)
        cache.positions.append(floats(mesh.vertices, "co", 3) @ world[:3, :3].T + world[:3, 3])
        cache.corners.append(integers(mesh.loops, "vertex_index"))
        cache.sizes.append(integers(mesh.polygons, "loop_total"))
        if cache.corner_uv is None:
            cache.corner_uv = floats(mesh.uv_layers["pattern"].uv, "vector", 2)
        cache.corner_normals = floats(mesh.corner_normals, "vector", 3)
        evaluated.to_mesh_clear()
    return cache


def read_rows(path):
    with open(path, encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file))


def triple(row, *names):
    return numpy.array([float(row[name]) for name in names])


def read_truth(path):
    """{(frame, handle): position}; what is no handle (clamps, parents) is left out."""
    return {(int(row["frame"]), row["handle"]): triple(row, "x", "y", "z")
            for row in read_rows(path) if row["handle"].startswith("handle")}


def judge_clock(judgement, cache, frames, fps):
    if judgement.check(len(cache.times) == len(frames), f"{len(cache.times)} samples, the truth has {len(frames)} frames"):
        for i, frame in enumerate(frames):
            judgement.check(abs(cache.times[i] - frame / fps) < TIME_TOLERANCE,
                            f"sample {i} is at {cache.times[i]} s, expected {frame / fps} s")
        judgement.count("sample times", len(frames))


def judge_mesh(judgement, cache, summary, changing):
    """Meshes of triangles, one for the whole shot unless the method changes it; finite, and in motion."""
    (sheet,) = summary["sheets"]
    judgement.check(cache.name == sheet["name"].replace(".", "_"), f"the mesh is named {cache.name}")
    for i, positions in enumerate(cache.positions):
        same = numpy.array_equal(cache.corners[i], cache.corners[0]) and positions.shape == cache.positions[0].shape
        judgement.check(same or changing, f"sample {i}: the mesh is not that of the first sample")
        judgement.check(len(cache.sizes[i]) and (cache.sizes[i] == 3).all(), f"sample {i}: not all faces are triangles")
        judgement.check(numpy.isfinite(positions).all(), f"sample {i}: a position is not finite")
        judgement.count("positions", len(positions))
    kept = min(len(positions) for positions in cache.positions)  # a method may add vertices behind the first
    motion = max(abs(positions[:kept] - cache.positions[0][:kept]).max() for positions in cache.positions)
    judgement.check(motion > LEAST_MOTION, f"nothing moves more than {motion} m")


def judge_normals(judgement, cache, clockwise):
    """Unit, and on the side of the face: that of its corners in the order of the file, or against it."""
    corners = cache.positions[-1][cache.corners[-1]].reshape(-1, 3, 3)
    faces = numpy.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]) * (-1 if clockwise else 1)
    faces = numpy.repeat(faces / numpy.linalg.norm(faces, axis=1)[:, None], 3, axis=0)
    if not judgement.check(len(cache.corner_normals) == len(faces), f"{len(cache.corner_normals)} normals for {len(faces)} corners"):
        return
    judgement.check(abs(numpy.linalg.norm(cache.corner_normals, axis=1) - 1).max() < 1e-3, "a normal is not of unit length")
    along = (cache.corner_normals * faces).sum(axis=1)
    judgement.check(along.mean() > 0.9, f"the normals are not those of the faces: {along.mean()}")
    judgement.count("normals", len(faces))


def vertex_at(judgement, pattern, row):
    """The vertex of the cache that is the handle's point of the sheet."""
    distance = numpy.linalg.norm(pattern - triple(row, "u", "v"), axis=1)
    judgement.check(distance.min() < HELD_TOLERANCE, f"{row['handle']}: no vertex is nearer than {distance.min()} m to its point")
    return distance.argmin()


def judge_handles(judgement, cache, rows, pattern, first_frame):
    """Every held point of the certificate is in the cache where the certificate says."""
    vertex = {row["handle"]: vertex_at(judgement, pattern, row) for row in rows}
    for row in rows:
        if row["state"] == "free":
            continue
        where = f"frame {row['frame']}, {row['handle']}"
        found = cache.positions[int(row["frame"]) - first_frame][vertex[row["handle"]]]
        judgement.near([found], [triple(row, "held_x", "held_y", "held_z")], "held points", where, HELD_TOLERANCE)


def judge_truth(judgement, rows, truth, relative, tolerance):
    """Every handle of the DCC is in the certificate at every frame, and held where the DCC has it."""
    judgement.check({(int(row["frame"]), row["handle"]) for row in rows} == set(truth), "certificate and truth differ in frames or handles")
    offset = {}  # of relative handles, where they begin to hold
    for row in rows:
        key = (int(row["frame"]), row["handle"])
        if row["state"] != "held" or key not in truth:
            continue
        held = triple(row, "held_x", "held_y", "held_z")
        if row["handle"] in relative:
            held = held - offset.setdefault(row["handle"], held - truth[key])
        judgement.near([held], [truth[key]], "places of the DCC", f"frame {key[0]}, {key[1]}", tolerance)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("reader", choices=("alembic", "blender"))
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("truth", type=pathlib.Path)
    parser.add_argument("--fps", type=float, required=True)
    parser.add_argument("--truth-mm", type=float, default=0.01)
    parser.add_argument("--relative", action="append", default=[])
    parser.add_argument("--changing-mesh", action="store_true")  # vertices keep their numbers all the same
    arguments = parser.parse_args()

    judgement = Judgement()
    truth = read_truth(arguments.truth)
    rows = read_rows(arguments.folder / "cert" / "handles.csv")
    summary = json.loads((arguments.folder / "cert" / "summary.json").read_text(encoding="utf-8"))
    (path,) = arguments.folder.glob("*.abc")
    read = {"alembic": read_with_alembic, "blender": read_with_blender}[arguments.reader]
    cache = read(path, arguments.fps)

    frames = sorted({frame for frame, _ in truth})
    judge_clock(judgement, cache, frames, arguments.fps)
    judge_mesh(judgement, cache, summary, arguments.changing_mesh)
    judge_normals(judgement, cache, arguments.reader == "alembic")
    pattern = numpy.zeros((len(cache.positions[0]), 2))
    pattern[cache.corners[0]] = cache.corner_uv * max(summary["sheets"][0]["width_m"], summary["sheets"][0]["height_m"])
    if not judgement.failures:
        judge_handles(judgement, cache, rows, pattern, frames[0])
        judge_truth(judgement, rows, truth, arguments.relative, 1e-3 * arguments.truth_mm)
    return judgement.conclude(arguments.reader.capitalize(), ("sample times", "positions", "held points", "places of the DCC"))


if __name__ == "__main__":
    sys.exit(main())
