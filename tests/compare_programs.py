"""Bakes every sample with two builds of paperbake and compares what they write, to the last byte.

    tests/compare_programs.py OLD_PAPERBAKE NEW_PAPERBAKE FOLDER [--only TEXT]

For changes that must not change anything that is computed. Caches, maps, point caches and singular.csv must
be the same bytes; certificates the same values, apart from times, from the hashes that name a build or a file
of the report, and from fields that only the new build writes. What the old build baked into FOLDER/old is kept
and used again. Prints one line for each bake and exits with 1 when any differs.
"""

import argparse
import json
import pathlib
import shutil
import subprocess
import sys

SAMPLES = pathlib.Path(__file__).resolve().parent.parent / "samples"
QUICK = ["--map-size", "256"]

# name, scene, options: every sample as its README bakes it, then every method, format and restart once
BAKES = [
    ("S1", "S1_push.glb", QUICK),
    ("S1_fbx", "S1_push.fbx", QUICK),
    ("S2", "S2_moebius.glb", QUICK),
    ("S2_fbx", "S2_moebius.fbx", QUICK),
    ("S3", "S3_unload.glb", QUICK),
    ("S3_fbx", "S3_unload.fbx", QUICK),
    ("S4", "S4_crumple.glb", []),
    ("S4_fbx", "S4_crumple.fbx", QUICK),
    ("S4r", "S4r_release.glb", QUICK),
    ("S5", "S5_roll.glb", [*QUICK, "--gravity", "9.81"]),
    ("S5_fbx", "S5_roll.fbx", [*QUICK, "--gravity", "9.81"]),
    ("S7", "S7_stacks.glb", QUICK),
    ("S7_fbx", "S7_stacks.fbx", QUICK),
    ("S8", "S8_dcone.glb", QUICK),
    ("S8_fbx", "S8_dcone.fbx", QUICK),
    ("S8_pinned", "S8_pinned.toml", QUICK),
    ("S9", "S9_unload.glb", QUICK),
    ("S10", "S10_ball.glb", QUICK),
    ("S11", "S11_palm.glb", QUICK),
    ("S14", "S14_hands.glb", QUICK),
    ("S1_fem", "S1_push.glb", [*QUICK, "--method", "fem", "--triangles", "400"]),
    ("S8_adaptive", "S8_dcone.glb", [*QUICK, "--method", "adaptive", "--triangles", "600", "--frames", "1-60"]),
    ("S2_polish", "S2_moebius.glb", [*QUICK, "--polish", "600", "--frames", "1-24"]),
    ("S8_hero", "S8_dcone.glb", [*QUICK, "--quality", "hero", "--polish", "0", "--frames", "1-50"]),
    ("S4_simulation", "S4_crumple.glb", [*QUICK, "--mesh", "simulation", "--seed", "7"]),
    ("S8_probe", "S8_dcone.glb", [*QUICK, "--probe", "12", "--frames", "1-60"]),
    ("S4_tissue", "S4_crumple.glb", [*QUICK, "--preset", "tissue17", "--frames", "1-60"]),
]
FORMATS = "abc,maps,cert,usd,pc2"
UNLIKE = ("_ms", "seconds", "cpu_s", "machine", "version", "job_hash", "input_hash", "files", "seal", "program")


def bake(program, scene, options, folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.parent.mkdir(parents=True, exist_ok=True)
    command = [program, "bake", str(SAMPLES / scene), "-o", str(folder), "--progress", "none", *options]
    if "simulation" in options:
        command += ["--formats", "abc,cert"]
    else:
        command += ["--formats", FORMATS]
    return subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, check=False).returncode


def alike(value):
    """Without what may differ between two builds that compute the same."""
    if isinstance(value, dict):
        return {key: alike(entry) for key, entry in value.items() if not any(key.endswith(end) for end in UNLIKE)}
    if isinstance(value, list):
        return [alike(entry) for entry in value]
    return value


def without_new_fields(old, new):
    if isinstance(old, dict) and isinstance(new, dict):
        return {key: without_new_fields(old[key], entry) for key, entry in new.items() if key in old}
    if isinstance(old, list) and isinstance(new, list) and len(old) == len(new):
        return [without_new_fields(a, b) for a, b in zip(old, new)]
    return new


def parsed(path):
    if path.suffix == ".jsonl":
        return [json.loads(line) for line in path.read_text().splitlines()]
    return json.loads(path.read_text())


def compare(old, new):
    """The differences, one sentence each, and the number of bytes that are the same."""
    found, same = [], 0
    names = sorted({p.relative_to(root) for root in (old, new) for p in root.rglob("*")
                    if p.is_file() and not p.relative_to(root).parts[0].startswith(".")})
    for name in names:
        if name.name == "job.lock.toml":  # says which build wrote it
            continue
        if not (old / name).is_file() or not (new / name).is_file():
            found.append(f"{name} is written by one of the builds only")
        elif name.suffix in (".json", ".jsonl"):
            a, b = alike(parsed(old / name)), alike(parsed(new / name))
            if a != without_new_fields(a, b):
                found.append(f"{name} has other values")
        else:
            a, b = (old / name).read_bytes(), (new / name).read_bytes()
            if a != b:
                found.append(f"{name} has other bytes")
            same += len(a) if a == b else 0
    return found, same


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("old"), parser.add_argument("new"), parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--only", default="", help="bakes whose name contains this text")
    arguments = parser.parse_args()
    differ = 0
    for name, scene, options in BAKES:
        if arguments.only not in name:
            continue
        old, new = arguments.folder / "old" / name, arguments.folder / "new" / name
        code = old / ".exit_code"
        if not code.is_file():
            code_of_old = bake(arguments.old, scene, options, old)
            code.write_text(str(code_of_old))
        code_of_new = bake(arguments.new, scene, options, new)
        found, same = compare(old, new)
        if int(code.read_text()) != code_of_new:
            found.append(f"exit codes {code.read_text()} and {code_of_new}")
        if same == 0:
            found.append("nothing was compared")
        differ += bool(found)
        print(f"{name:14} {'; '.join(found) or f'same, {same / 1e6:.1f} MB'}", flush=True)
        shutil.rmtree(new, ignore_errors=True)
    sys.exit(1 if differ else 0)


if __name__ == "__main__":
    main()
