"""Writes S10_ball.glb and S10_ball.handles.csv beside itself: A4 crushed to 15 % of its size by twelve handles.

Ten handles on the border and two inside go, frames 1-120, straight to the corners of an icosahedron that fits a ball of 44 mm, and stay to
frame 132. They only come nearer to each other: paper can follow as far as its own thickness lets it.
"""
import functools
import math
import os

from glb import write_handles

WIDTH, HEIGHT, SHARE, LAST, CRUSHED = 0.21, 0.297, 0.15, 132, 120
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


def at(frame, begin, end):
    t = min(1, (frame - 1) / (CRUSHED - 1))
    return tuple(a + t * (b - a) for a, b in zip(begin, end))


if __name__ == "__main__":
    write_handles(os.path.splitext(os.path.abspath(__file__))[0], (WIDTH, HEIGHT), "crush", (1, CRUSHED, LAST),
                  [(name, functools.partial(at, begin=begin, end=end), {}) for name, begin, end in handles()])
