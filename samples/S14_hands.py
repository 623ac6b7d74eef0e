"""Writes S14_hands.glb and S14_hands.handles.csv beside itself: A4 crushed loosely between two hands.

    python3 samples/S14_hands.py

Each hand holds a short side by three fingers. In frames 2-80 the hands come nearer to each other by
170 mm, turn against each other by 2 x 46 degrees, and close to half of their width; they rest until
frame 96. Paper can follow: fem of 1,700 triangles does.
"""
import functools
import math
import os

from glb import write_handles

WIDTH, HEIGHT, MARGIN = 0.297, 0.21, 0.03  # m
NEARER, APART, TURN, CLOSED = 0.085, 0.01, 0.8, 0.5  # m, m, rad, 1
BEGIN, END, LAST = 2, 80, 96  # frames
FINGERS = (0.04, HEIGHT / 2, HEIGHT - 0.04)  # m


def finger(frame, side, place):
    """side: 1 for the left hand, -1 for the right one; place: along the short side of the flat sheet [m]"""
    t = min(1, max(0, (frame - BEGIN) / (END - BEGIN)))
    done = t * t * (3 - 2 * t)
    out = (place - HEIGHT / 2) * (1 - CLOSED * done)
    turn = side * TURN * done
    x = (MARGIN if side > 0 else WIDTH - MARGIN) + side * NEARER * done
    return x, HEIGHT / 2 + out * math.cos(turn), out * math.sin(turn) + side * APART * done


if __name__ == "__main__":
    write_handles(os.path.splitext(os.path.abspath(__file__))[0], (WIDTH, HEIGHT), "crush", range(1, LAST + 1),
                  [("handle.%s.%d" % (hand, k), functools.partial(finger, side=side, place=place), {})
                   for hand, side in (("left", 1), ("right", -1)) for k, place in enumerate(FINGERS, 1)])
