"""Writes S0_note.glb and S0_note.handles.csv beside itself: a square note that six fingers crumple and let go.

    python3 samples/S0_note.py

One finger holds each corner, one the front border and one the back border, both a little left of the
middle. They close to 55 % of their distance from the centre (frames 1-56) while the corners sink
and the two others rise by 18 mm and the two ends of the note are turned against each other by
2 x 7 degrees; rest; open by 40 % of the way (60-76); and let go one after the other (78-84), but for
the two corners in front. At every frame any two fingers are nearer to each other than on the flat note.
"""
import math
import os

from glb import write_handles

SIDE, SHARE, RISE, TURN, OPENED = 0.21, 0.55, 0.018, math.radians(7), 0.4  # m, 1, m, rad, 1
LAST = 92
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


def handle(name, u, v, way, release):
    flat, end = (u * SIDE, v * SIDE, 0.0), closed(u, v, way)
    return ("handle." + name, lambda frame: between(flat, end, closing(frame)),
            {} if release is None else {"extras": {"paper_release_frame": release}})


if __name__ == "__main__":
    frames = range(1, LAST + 1)  # a key at each: programs differ in how they read curves with tangents
    write_handles(os.path.splitext(os.path.abspath(__file__))[0], (SIDE, SIDE), "crumple", frames,
                  [handle(*finger) for finger in FINGERS])
