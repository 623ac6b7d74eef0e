"""Judges a cache with the real Alembic library (PyPI: alembic3d).

    alembic_judge.py FILE.abc EXPECTED.json

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.

EXPECTED.json, in metres and z up, triangles counter-clockwise:
    {"fps": 24, "first_frame": 1, "metadata": {"key": "value"},             (metadata may be missing)
     "sheets": [{"name": "paper", "triangles": [[0, 1, 2]], "uv": [[0, 0], ...],
                 "frames": [{"x": [[0, 0, 0], ...], "velocity": [...], "normal": [...]}, ...]}]}
A frame may have "triangles" and "uv" of its own, which stand for those of the sheet. "uv", "velocity" and "normal" may be
missing: then the cache must not have them. The name is the one stored in the cache.
"""

import json
import sys

from alembic3d import Abc, AbcGeom

from judgement import Judgement

TIME_TOLERANCE = 1e-9  # [s] start + i / fps in doubles
EXISTING = Abc.WrapExistingFlag.kWrapExisting


def z_up(vectors):
    return [(v.x, -v.z, v.y) for v in vectors]


def selector(time):
    return Abc.ISampleSelector(time)


def frames_with_cut(sheet):
    """The frames of a sheet, each with the triangles and the uv that hold there."""
    cut = {key: sheet[key] for key in ("triangles", "uv") if key in sheet}
    return [{**cut, **frame} for frame in sheet["frames"]]


def judge_times(judgement, sampling, count, expected, where):
    for i in range(count):
        time = (expected["first_frame"] + i) / expected["fps"]
        found = sampling.getSampleTime(i)
        judgement.check(abs(found - time) < TIME_TOLERANCE, f"{where}: sample {i} is at {found} s, expected {time} s")


def judge_counts(judgement, schema, frames, expected, where):
    """Every property that is there has a sample for each frame, at the right time."""
    properties = {"mesh": schema, "P": schema.getPositionsProperty(), "bounds": schema.getSelfBoundsProperty(),
                  "face indices": schema.getFaceIndicesProperty(), "face counts": schema.getFaceCountsProperty(),
                  "velocities": schema.getVelocitiesProperty(), "N": schema.getNormalsParam(), "uv": schema.getUVsParam()}
    given = {"velocities": "velocity", "N": "normal", "uv": "uv"}
    for name, prop in properties.items():
        wanted = name not in given or any(given[name] in frame for frame in frames)
        if judgement.check(prop.valid() == wanted, f"{where}: {name} {'missing' if wanted else 'unexpected'}") and wanted:
            count = prop.getNumSamples()
            judgement.check(count == len(frames), f"{where}: {count} samples of {name}, expected {len(frames)}")
            judge_times(judgement, prop.getTimeSampling(), len(frames), expected, f"{where}, {name}")


def judge_topology(judgement, schema, frames, where):
    constant = all(frame["triangles"] == frames[0]["triangles"] for frame in frames)
    found = schema.getTopologyVariance()
    still = len(frames) == 1 or all(frame["x"] == frames[0]["x"] for frame in frames)
    kinds = AbcGeom.MeshTopologyVariance
    wanted = kinds.kHeterogenousTopology if not constant else (
        kinds.kConstantTopology if still else kinds.kHomogenousTopology)
    judgement.check(found == wanted, f"{where}: topology is {found}, expected {wanted}")
    if constant and all(frame.get("uv") == frames[0].get("uv") for frame in frames):
        uv = schema.getUVsParam()
        judgement.check(not uv.valid() or uv.isConstant(), f"{where}: uv should be stored once")


def judge_faces(judgement, sample, frame, where):
    """Clockwise: our triangles, backwards."""
    counts, indices = list(sample.getFaceCounts()), list(sample.getFaceIndices())
    if not judgement.check(counts == [3] * len(frame["triangles"]), f"{where}: face counts are wrong"):
        return
    wanted = [corner for triangle in frame["triangles"] for corner in reversed(triangle)]
    judgement.check(indices == wanted, f"{where}: faces are not the triangles in clockwise order")
    judgement.count("triangles", len(counts))


def judge_bounds(judgement, box, points, where):
    low, high = box.min(), box.max()
    for axis in range(3) if points else ():
        values = [p[axis] for p in points]
        found = (low[axis], high[axis])
        judgement.check(found == (min(values), max(values)),
                        f"{where}: bounds {found} on axis {axis}, P has {min(values)} to {max(values)}")


def judge_corner_uv(judgement, param, time, frame, where):
    sample = param.getExpandedValue(selector(time))
    judgement.check(sample.getScope() == AbcGeom.GeometryScope.kFacevaryingScope, f"{where}: uv are not of face corners")
    wanted = [frame["uv"][corner] for triangle in frame["triangles"] for corner in reversed(triangle)]
    judgement.near([(uv.x, uv.y) for uv in sample.getVals()], wanted, "corner uvs", where)


def judge_frame(judgement, schema, time, frame, where):
    sample = schema.getValue(selector(time))
    points = list(sample.getPositions())
    judgement.near(z_up(points), frame["x"], "positions", where)
    judge_faces(judgement, sample, frame, where)
    judge_bounds(judgement, sample.getSelfBounds(), points, where)
    if "velocity" in frame:
        judgement.near(z_up(sample.getVelocities()), frame["velocity"], "velocities", where)
    if "normal" in frame:
        normals = schema.getNormalsParam().getExpandedValue(selector(time))
        judgement.check(normals.getScope() == AbcGeom.GeometryScope.kVertexScope, f"{where}: N is not of vertices")
        judgement.near(z_up(normals.getVals()), frame["normal"], "normals", where)
    if "uv" in frame:
        judge_corner_uv(judgement, schema.getUVsParam(), time, frame, where)


def judge_xform(judgement, xform, schema, count, where):
    judgement.check(xform.isConstantIdentity() and xform.getInheritsXforms(), f"{where}: the transform is not identity")
    bounds, own = xform.getChildBoundsProperty(), schema.getSelfBoundsProperty()
    if judgement.check(bounds.valid() and bounds.getNumSamples() == count, f"{where}: child bounds are not per frame"):
        for i in range(count):
            at = selector(bounds.getTimeSampling().getSampleTime(i))
            judgement.check(bounds.getValue(at) == own.getValue(at), f"{where}: child bounds of sample {i} differ")


def judge_sheet(judgement, xform, sheet, expected):
    name, frames = sheet["name"], frames_with_cut(sheet)
    names = [child.getName() for child in xform.children]
    if not judgement.check(names == [name + "Shape"], f"{name}: children {names}, expected {name}Shape"):
        return
    mesh = xform.children[0]
    if not judgement.check(AbcGeom.IPolyMesh.matches(mesh.getHeader()), f"{name}: not a PolyMesh"):
        return
    schema = AbcGeom.IPolyMesh(mesh, EXISTING).getSchema()
    judge_counts(judgement, schema, frames, expected, name)
    judge_topology(judgement, schema, frames, name)
    judge_xform(judgement, AbcGeom.IXform(xform, EXISTING).getSchema(), schema, len(frames), name)
    for i, frame in enumerate(frames):
        time = (expected["first_frame"] + i) / expected["fps"]
        judge_frame(judgement, schema, time, frame, f"{name}, frame {expected['first_frame'] + i}")


def judge_archive_bounds(judgement, top, expected):
    prop = Abc.IBox3dProperty(top.getProperties(), ".childBnds")
    count = len(expected["sheets"][0]["frames"])
    if not judgement.check(prop.getNumSamples() == count, f"archive: bounds have {prop.getNumSamples()} samples"):
        return
    for i in range(count):
        box = prop.getValue(selector(prop.getTimeSampling().getSampleTime(i)))
        rows = [row for sheet in expected["sheets"] for row in sheet["frames"][i]["x"]]
        corners = z_up([box.min(), box.max()])
        wanted = [[pick(row[axis] for row in rows) for axis in range(3)] for pick in (min, max)]
        wanted[0][1], wanted[1][1] = wanted[1][1], wanted[0][1]  # the axis that turning to y up has turned over
        judgement.near(corners, wanted, "corners of archive bounds", f"archive, sample {i}")


def judge_archive(judgement, archive, expected):
    top = archive.getTop()
    metadata = dict(pair.split("=", 1) for pair in top.getMetaData().serialize().split(";"))
    wanted = {"_ai_Application": "paperbake", "FramesPerTimeUnit": f"{expected['fps']:.6f}", **expected.get("metadata", {})}
    for key, value in wanted.items():
        judgement.check(metadata.get(key) == value, f"archive: metadata {key} is {metadata.get(key)}, expected {value}")
    judgement.check("_ai_DateWritten" not in metadata, "archive: a date was written")

    count = len(expected["sheets"][0]["frames"])
    found = archive.getMaxNumSamplesForTimeSamplingIndex(1)
    judgement.check(found == count, f"archive: {found} samples on the clock, expected {count}")
    judge_times(judgement, archive.getTimeSampling(1), count, expected, "archive")

    names = [child.getName() for child in top.children]
    wanted_names = [sheet["name"] for sheet in expected["sheets"]]
    if judgement.check(names == wanted_names, f"archive: objects {names}, expected {wanted_names}"):
        for xform, sheet in zip(top.children, expected["sheets"]):
            judge_sheet(judgement, xform, sheet, expected)
        judge_archive_bounds(judgement, top, expected)


def main(arguments):
    if len(arguments) != 2:
        print("usage: alembic_judge.py FILE.abc EXPECTED.json")
        return 2
    judgement = Judgement()
    with open(arguments[1], encoding="utf-8") as file:
        expected = json.load(file)
    try:
        if judgement.check(expected["sheets"], f"{arguments[1]} expects nothing"):
            judge_archive(judgement, Abc.IArchive(arguments[0]), expected)
    except RuntimeError as error:
        judgement.check(False, f"Alembic refuses {arguments[0]}: {error}")
    return judgement.conclude("Alembic", ("positions", "triangles"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
