"""Judges reports: that they have handles and colliders, and the page that compares two bakes: it holds both reports as they are,
and says what differs.

    compare_judge.py PAPERBAKE FOLDER SCENE

Bakes the scene, which has colliders of which one moves, twice into FOLDER, with two seeds. Prints one line for each check that failed and exits with 1, or what was
compared and exits with 0.
"""

import csv
import html
import json
import pathlib
import re
import subprocess
import sys

from judgement import Judgement


def run(*words):
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, check=False)


def judge_report(judgement, folder):
    """Handles where the certificate has them, and colliders in every frame in which they are elsewhere."""
    text = (folder / "report.html").read_text(encoding="utf-8")
    data = json.loads(re.search(r'<script id="data" type="application/json">(.*?)</script>', text, re.S)[1])
    with open(folder / "cert" / "handles.csv", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["state"] != "free"]
    for frame, found in zip(data["frames"], data["handles"]):
        wanted = [[float(row[f"keyed_{axis}"]) for axis in "xyz"] for row in rows if int(row["frame"]) == frame]
        judgement.near([found[i:i + 3] for i in range(0, len(found), 4)], wanted, "handles", f"frame {frame}", 1e-5)
    lengths = sorted(len(collider["x"]) for collider in data["colliders"]["all"])
    judgement.check(lengths == [1, len(data["frames"])], f"the colliders have positions of {lengths} frames")


def main(arguments):
    if len(arguments) != 3:
        print("usage: compare_judge.py PAPERBAKE FOLDER SCENE")
        return 2
    judgement = Judgement()
    program, folder, scene = (pathlib.Path(word).resolve() for word in arguments)
    for seed in (1, 2):
        done = run(program, "bake", scene, "-o", folder / f"seed{seed}", "--seed", seed, "--frames", "1-60x12", "--quality", "draft",
                   "--mesh", "simulation", "--formats", "cert,report")
        judgement.check(done.returncode in (0, 4), f"the bake of seed {seed} ends with {done.returncode}: {done.stderr}")
    page = folder / "two.html"
    done = run(program, "report", folder / "seed1", folder / "seed2", "-o", page)
    if not judgement.check(done.returncode == 0 and done.stdout.strip() == str(page), f"report ends with {done.returncode}: {done.stderr}"):
        return judgement.conclude("The comparison", ())
    text = page.read_text(encoding="utf-8")
    framed = re.findall(r'<iframe title="([^"]*)" srcdoc="([^"]*)"', text)
    judgement.check([name for name, _ in framed] == ["seed1", "seed2"], f"the frames are {[name for name, _ in framed]}")
    for name, source in framed:
        judgement.check(html.unescape(source) == (folder / name / "report.html").read_text(encoding="utf-8"), f"{name}: its report is another one")
        judge_report(judgement, folder / name)
        judgement.count("reports", 1)
    outside = re.sub(r'srcdoc="[^"]*"', "", text)
    rows = dict(re.findall(r"<tr class=\"differs\"><td>([^<]*)</td><td>([^<]*)</td>", outside))
    judgement.check(any(key.endswith(".seed") and value == "1" for key, value in rows.items()), f"of the settings it tells {sorted(rows)}")
    judgement.check("<td>frames</td><td>5</td><td>5</td>" in outside, "it does not tell the frames")
    judgement.check("http" not in outside, "the page needs something else")
    done = run(program, "report", folder / "seed1", folder, "-o", folder / "none.html")
    judgement.check(done.returncode == 2 and "report.html" in done.stderr and not (folder / "none.html").exists(),
                    f"without a second bake it ends with {done.returncode}: {done.stderr}")
    return judgement.conclude("The comparison", ("reports", "handles"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
