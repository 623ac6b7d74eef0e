"""Judges a report.html in a headless Chromium: it renders, without a word on the console; it opens at the frame it
says it begins with, plays by itself, and stands still when it is paused; its slider moves the sheet.

    report_judge.py REPORT.html PICTURES FIRST_FRAME LAST_FRAME

Leaves PICTURES/opened.png, first.png and last.png to look at, and PICTURES/handled.html, the report with the script
that handles it. Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import json
import os
import re
import subprocess
import sys

import bpy
import numpy

from judgement import Judgement

WIDTH, HEIGHT = 1400, 1100


# Handles the page as a reader would, and writes down what its button and the label beside its slider say.
HANDLING = """<script>
const seen = {}, look = name => { seen[name] = [document.getElementById("label").textContent, document.getElementById("play").textContent]; };
const press = () => document.getElementById("play").click();
const at = (milliseconds, ...steps) => setTimeout(() => steps.forEach(step => step()), milliseconds);
const slide = () => { const slider = document.getElementById("frame"); slider.value = 0; slider.dispatchEvent(new Event("input")); };
at(500, () => look("opened"));
at(2000, () => look("played"), press, () => look("paused"));
at(2400, () => look("still paused"), press);
at(2800, () => look("played on"), slide, () => look("slid"));
at(3200, () => look("still slid"), () => console.log("seen " + JSON.stringify(seen) + " so far"));
</script></body>"""


def opened(report, picture, milliseconds, fragment=""):
    """What Chromium says while it draws the page as it is after so long."""
    command = ["chromium", "--headless", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--hide-scrollbars",
               "--enable-logging=stderr", f"--window-size={WIDTH},{HEIGHT}", f"--virtual-time-budget={milliseconds}",
               f"--screenshot={picture}", f"file://{os.path.abspath(report)}{fragment}"]
    # Chromium itself hangs now and then while it starts: then it is started once more
    for seconds in (60, 120):
        try:
            return subprocess.run(command, capture_output=True, text=True, timeout=seconds, check=False).stderr
        except subprocess.TimeoutExpired:
            if seconds == 120:
                raise


def judge_playing(judgement, report, folder):
    """Plays, pauses and slides through the report."""
    page = os.path.join(folder, "handled.html")
    with open(report, encoding="utf-8") as file:
        text = file.read()
    data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.S)[1])
    with open(page, "w", encoding="utf-8") as file:
        file.write(HANDLING.join(text.rsplit("</body>", 1)))
    found = re.search(r'"seen (.*?) so far"', opened(page, os.path.join(folder, "handled.png"), 4000))
    if not judgement.check(found, "the page did not come to the end of what is done with it"):
        return
    seen = json.loads(found[1])
    begin, first = (f"frame {data['frames'][index]}" for index in (data["begin"], 0))
    judgement.check(seen["opened"][0] == begin, f"opens at {seen['opened'][0]}, not at {begin}, where it begins")
    for name, playing in (("opened", False), ("played", True), ("paused", False), ("still paused", False), ("played on", True),
                          ("slid", False)):
        word = "Pause" if playing else "Play"
        judgement.check(seen[name][1].endswith(word), f"{name}: the button says {seen[name][1]}, not {word}")
    judgement.check(seen["played"][0] != begin, f"does not play by itself: still at {begin}")
    judgement.check(seen["still paused"][0] == seen["paused"][0], "goes on after a pause")
    judgement.check(seen["played on"][0] != seen["paused"][0], "does not play when the button is pressed")
    judgement.check(seen["slid"][0] == seen["still slid"][0] == first, f"the slider leads to {seen['still slid'][0]}, not to {first}")
    judgement.count("positions of the slider", len(seen))


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
    judge_playing(judgement, report, folder)
    views = {}
    # after 1500 ms it plays by itself, from the first frame; a busy machine draws late
    for name, time, fragment in (("opened", 300, ""), ("first", 8000, "#frame=" + arguments[2]), ("last", 8000, "#frame=" + arguments[3])):
        picture = os.path.join(folder, name + ".png")
        for line in opened(report, picture, time, fragment).splitlines():
            judgement.check("CONSOLE" not in line, f"{name}: {line}")
        if judgement.check(os.path.exists(picture), f"{name}: Chromium drew nothing"):
            views[name] = pixels(picture)[120:700, 40:810]  # the view in 3D
            sheet = (abs(views[name] - views[name][2, 2]).max(axis=2) > 0.05).mean()
            judgement.check(sheet > 0.02, f"{name}: the sheet takes {100 * sheet:.1f} % of the view")
            judgement.count("views", 1)
    for name in views.keys() - {"first"}:
        moved = (abs(views["first"] - views[name]).max(axis=2) > 0.05).mean()
        judgement.check(moved > 0.02, f"only {100 * moved:.1f} % of the view differ between the first frame and the one that is {name}")
    return judgement.conclude("Chromium", ("views", "positions of the slider"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
