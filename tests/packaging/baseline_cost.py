"""What a build for every processor costs beside one for newer ones: two programs bake the same
scenes in turns, on one thread, and only simulate. A table, not a test; nothing else should run.

    baseline_cost.py BASELINE OTHER [RUNS]      for instance build-package/paperbake build/paperbake

time    CPU time of the baseline over that of the other: median of all pairs of runs that follow
        each other, and the least and the most
steps   the same of the Newton steps: the last bits of the two differ, and a crumple goes another
        way with them
each    time over steps: what a Newton step costs
"""

import json
import os
import pathlib
import statistics
import subprocess
import sys
import tempfile

SAMPLES = pathlib.Path(__file__).resolve().parents[2] / "samples"
SCENES = ("S4r_release.glb", "S8_dcone.glb")


def bake(program, scene, folder):
    """(CPU seconds, Newton steps)"""
    command = [program, "bake", SAMPLES / scene, "-o", folder, "--formats", "cert",
               "--threads", "1", "--resume", "never", "--progress", "none"]
    before = os.times()
    code = subprocess.run(command, stdout=subprocess.DEVNULL, check=False).returncode
    after = os.times()
    if code not in (0, 4):
        sys.exit(f"{program} ended with {code}")
    seconds = sum(after[2:4]) - sum(before[2:4])
    lines = (pathlib.Path(folder) / "cert" / "frames.jsonl").read_text().splitlines()
    return seconds, sum(json.loads(line)["newton_iterations"] for line in lines)


def spread(ratios):
    return f"{statistics.median(ratios):5.3f} [{min(ratios):5.3f}, {max(ratios):5.3f}]"


def main(baseline, other, runs):
    print(f"{'':<16}{'seconds':>18}   {'time':^20}   {'steps':^6}   {'each':^6}   {runs} runs")
    for scene in SCENES:
        pairs = []
        with tempfile.TemporaryDirectory() as folder:
            for number in range(runs):
                order = (baseline, other) if number % 2 == 0 else (other, baseline)
                found = {program: bake(program, scene, folder) for program in order}
                pairs.append((found[baseline], found[other]))
        time = [ours[0] / theirs[0] for ours, theirs in pairs]
        steps = statistics.median(ours[1] / theirs[1] for ours, theirs in pairs)
        seconds = [statistics.median(run[k][0] for run in pairs) for k in (0, 1)]
        print(f"{scene:<16}{seconds[0]:8.2f} {seconds[1]:8.2f}    {spread(time)}    {steps:5.3f}"
              f"    {statistics.median(time) / steps:5.3f}", flush=True)


if __name__ == "__main__":
    if len(sys.argv) not in (3, 4):
        sys.exit(__doc__)
    main(sys.argv[1], sys.argv[2], int(sys.argv[3]) if len(sys.argv) == 4 else 7)
