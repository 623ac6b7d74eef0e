"""Judges a report.html in a headless Chromium: it renders, without a word on the console, and its slider moves the sheet.

    report_judge.py REPORT.html PICTURES FIRST_FRAME LAST_FRAME

Leaves PICTURES/first.png and last.png to look at. Prints one line for each check that failed and exits with 1, or what was
compared and exits with 0.
"""

import os
import subprocess
import sys

import bpy
import numpy

from judgement import Judgement

WIDTH, HEIGHT = 1400, 1100


def opened(report, frame, picture):
    """What Chromium says while it draws the page at a frame."""
    command = ["chromium", "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
               "--enable-logging=stderr", f"--window-size={WIDTH},{HEIGHT}", "--virtual-time-budget=8000", f"--screenshot={picture}",
               f"file://{os.path.abspath(report)}#frame={frame}"]
    return subprocess.run(command, capture_output=True, text=True, timeout=120, check=False).stderr


def pixels(picture):
    image = bpy.data.images.load(os.path.abspath(picture))
    values = numpy.empty(image.size[0] * image.size[1] * 4, dtype=numpy.float32)
    image.pixels.foreach_get(values)
    return values.reshape(image.size[1], image.size[0], 4)[::-1, :, :3]


def main(arguments):
    if len(arguments) != 4:
        print("usage: report_judge.py REPORT.html PICTURES FIRST_FRAME LAST_FRAME")
        return 2
    report, folder = arguments[:2]
    judgement = Judgement()
    os.makedirs(folder, exist_ok=True)
    seen = []
    for name, frame in zip(("first", "last"), arguments[2:]):
        picture = os.path.join(folder, name + ".png")
        said = opened(report, frame, picture)
        for line in said.splitlines():
            judgement.check("CONSOLE" not in line, f"frame {frame}: {line}")
        if judgement.check(os.path.exists(picture), f"frame {frame}: Chromium drew nothing"):
            seen.append(pixels(picture)[120:700, 40:810])  # the view in 3D
            sheet = (abs(seen[-1] - seen[-1][2, 2]).max(axis=2) > 0.05).mean()
            judgement.check(sheet > 0.02, f"frame {frame}: the sheet takes {100 * sheet:.1f} % of the view")
            judgement.count("views", 1)
    if len(seen) == 2:
        moved = (abs(seen[0] - seen[1]).max(axis=2) > 0.05).mean()
        judgement.check(moved > 0.02, f"only {100 * moved:.1f} % of the view differ between the frames")
    return judgement.conclude("Chromium", ("views",))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
