"""Judges the maps of a bake with the programs of OpenEXR (Debian package openexr): headers by exrheader and exrinfo, texels by
exrmaketiled, which has to decode every one.

    map_judge.py FOLDER NAME --size N --fps FPS --seed SEED --preset PRESET --side METRES [--layout LAYOUT] --frames FRAME...

LAYOUT    scanline (default) or tiled-mip
FOLDER    as paperbake bake writes it; its maps are those of --frames, and the final one, which is of the last of --frames
Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import argparse
import pathlib
import re
import subprocess
import sys
import tempfile

from judgement import Judgement

HALF, UINT = (f"{kind}, sampling 1 1" for kind in ("16-bit floating-point", "32-bit unsigned integer"))
CHANNELS = {**{name: HALF for name in (*"RGBA", "fold.angle", "fold.peak", "fold.plastic", "dir.x", "dir.y", "strain.min", "strain.max",
                                     "age.crease", "age.apex", "apex.cone", "apex.dist")}, "apex.id": UINT}
OF_EVERY_EXR = {"channels", "compression", "dataWindow", "displayWindow", "lineOrder", "pixelAspectRatio",
                "screenWindowCenter", "screenWindowWidth", "type"}
TILED = {"tiles"}


def run(judgement, path, *words):
    done = subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)
    judgement.check(done.returncode == 0 and not done.stderr, f"{path.name}: {words[0]} says {done.returncode}, {done.stderr.strip()}")
    return done.stdout


def header(text):
    """({attribute: value}, {channel: type}) of what exrheader prints."""
    attributes = dict(re.findall(r"^(\S+) \(type \S+\): ?(.*)$", text, re.M))
    return attributes, dict(re.findall(r"^    (\S+), (.*)$", text, re.M))


def judge_map(judgement, path, frame, expected):
    attributes, channels = header(run(judgement, path, "exrheader", path))
    judgement.check(channels == CHANNELS, f"{path.name}: channels {channels}")
    window = f"(0 0) - ({expected.size - 1} {expected.size - 1})"
    wanted = {"dataWindow": window, "displayWindow": window, "frame": str(frame), "seed": str(expected.seed),
              "framesPerSecond": f"{expected.fps}/1 ({expected.fps})", "preset": f'"{expected.preset}"'}
    for name, value in wanted.items():
        judgement.check(attributes.get(name) == value, f"{path.name}: {name} is {attributes.get(name)}, expected {value}")
        judgement.count("attributes", 1)
    # what says when, where or by whom the file was made would be one more
    tiled_file = expected.layout == "tiled-mip"
    judgement.check(("tiles" in attributes) == tiled_file, f"{path.name}: tiles {attributes.get('tiles')}")
    extra = set(attributes) - OF_EVERY_EXR - (TILED if tiled_file else set()) - set(wanted) - {"texelSize", "foldWidth", "creaseWidth"}
    judgement.check(not extra, f"{path.name}: unexpected attributes {sorted(extra)}")
    texel = float(attributes.get("texelSize", "nan"))
    judgement.near([[texel * expected.size]], [[expected.side]], "texel sizes", path.name)
    for width in ("foldWidth", "creaseWidth"):
        judgement.check(0 < float(attributes.get(width, "nan")) < expected.side, f"{path.name}: {width} {attributes.get(width)}")
    # exrinfo 3.1.5 ends good files with a code that it never sets, OpenEXR's own too; it says nothing of a bad one
    told = subprocess.run(["exrinfo", "-s", path], capture_output=True, text=True)
    judgement.check(str(path) in told.stdout and not told.stderr, f"{path.name}: exrinfo says {told.stdout.strip()} {told.stderr.strip()}")
    with tempfile.TemporaryDirectory() as folder:
        tiled = pathlib.Path(folder) / path.name
        run(judgement, path, "exrmaketiled", path, tiled)
        judgement.check(tiled.is_file() and tiled.stat().st_size > 0, f"{path.name}: its texels cannot be read")
    judgement.count("maps", 1)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("name")
    parser.add_argument("--size", type=int, required=True)
    parser.add_argument("--fps", type=int, required=True)
    parser.add_argument("--seed", type=int, required=True)
    parser.add_argument("--preset", required=True)
    parser.add_argument("--side", type=float, required=True)
    parser.add_argument("--layout", choices=("scanline", "tiled-mip"), default="scanline")
    parser.add_argument("--frames", type=int, nargs="+", required=True)
    expected = parser.parse_args()

    judgement = Judgement()
    wanted = {f"{expected.name}.{frame:04}.exr": frame for frame in expected.frames[:-1]}
    wanted[f"{expected.name}.final.exr"] = expected.frames[-1]
    found = sorted(path.name for path in (expected.folder / "maps").iterdir())
    if judgement.check(found == sorted(wanted), f"maps are {found}, expected {sorted(wanted)}"):
        for name, frame in wanted.items():
            judge_map(judgement, expected.folder / "maps" / name, frame, expected)
    return judgement.conclude("OpenEXR", ("maps", "attributes", "texel sizes"))


if __name__ == "__main__":
    sys.exit(main())
