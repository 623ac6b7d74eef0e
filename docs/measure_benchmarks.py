#!/usr/bin/env python3
"""Runs the benches of a build and writes what they print to docs/data/*.csv.

    python3 docs/measure_benchmarks.py [--try] [NAME...]

Without a name all of them: an hour on an idle machine. --try runs a small part of each and writes
nothing: whether every program runs and prints what is read here.
Every file says on which machine, at which commit and by which command its rows were measured.
docs/make_benchmarks.py makes docs/benchmarks.md and the table of the README from these files.
"""

import csv
import io
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

from measure_growth import measure_growth

ROOT = pathlib.Path(os.path.abspath(__file__)).parent.parent
DATA = ROOT / "docs" / "data"
NUMBER = r"[-+]?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?"


def group_numbers(pattern, text):
    """The numbers of a pattern in which # stands for a number and a blank for any number of blanks.

    None when the text does not contain it.
    """
    found = re.search(re.escape(pattern).replace(r"\ ", r"\s*").replace(r"\#", f"({NUMBER})"), text)
    return found.groups() if found else None


def blocks(text):
    """Scene, last frame and lines of each block that begins with "SCENE, frames 1-N"."""
    parts = re.split(r"^(\w+), frames 1-(\d+).*$", text, flags=re.M)
    return [
        (parts[k], parts[k + 1], parts[k + 2].strip("\n").split("\n"))
        for k in range(1, len(parts), 3)
    ]


def mean(values, digits):
    values = [float(value) for value in values]
    return f"{sum(values) / len(values):.{digits}f}"


# ---- what each bench prints -> rows ---------------------------------------------------------

RUN = "# # + # ( #) # it c_m # edge #"  # triangles, elastic, geometry, worst, iterations, c_m, edge


def runs_in(lines):
    """(method, numbers of RUN, RMS, line) of the lines of a block that are a run."""
    found = []
    for line in lines:
        numbers, rms = group_numbers(RUN, line), group_numbers("rms # %", line)
        if numbers and rms and not line.strip().startswith("hybrid:"):
            found.append((line.split()[0], numbers, rms[0], line))
    return found


def parse_hybrid(text):
    rows = []
    for scene, last, lines in blocks(text):
        (_, fine, _, _), (_, usual, usual_rms, _), *hybrids = runs_in(lines)
        means = group_numbers("hybrid: # tri, # + # ms, nrm # deg, rms # [#, #] %", lines[-1])
        births = [int(group_numbers("sing #", line)[0]) for _, _, _, line in hybrids]
        rows.append(
            {
                "scene": scene,
                "frames": f"1-{last}",
                "fem_6000_ms": fine[1],
                "fem_1700_ms": usual[1],
                "fem_1700_rms_pct": usual_rms,
                "triangles": means[0],
                "elastic_ms": means[1],
                "geometry_ms": means[2],
                "worst_frame_ms": max((run[1][3] for run in hybrids), key=float),
                "normals_deg": means[3],
                "rms_pct": means[4],
                "rms_least_pct": means[5],
                "rms_most_pct": means[6],
                "c_m_pct": mean((run[1][5] for run in hybrids), 4),
                "worst_edge_pct": max((run[1][6] for run in hybrids), key=float),
                "births_least": min(births),
                "births_most": max(births),
            }
        )
    return rows


def parse_adaptive(text):
    rows = []
    for scene, last, lines in blocks(text):
        (_, own, rms, _), (_, fem, fem_rms, _), *_ = runs_in(lines)
        rows.append(
            {
                "scene": scene,
                "frames": f"1-{last}",
                "triangles": own[0],
                "elastic_ms": own[1],
                "geometry_ms": own[2],
                "worst_frame_ms": own[3],
                "rms_pct": rms,
                "fem_triangles": fem[0],
                "fem_ms": fem[1],
                "fem_rms_pct": fem_rms,
            }
        )
    return rows


def parse_invariance(text):
    row = re.compile(rf"^(\w+)\s+(hybrid|adaptive|fem\d*)\s.*?\s({NUMBER}): (.*), (.*)$", re.M)
    return [
        {"scene": scene, "method": method, "largest_pct": largest, "between": f"{a}; {b}"}
        for scene, method, largest, a, b in row.findall(text)
    ]


def parse_jitter(text):
    row = re.compile(
        rf"^(\w+)\s+apart ({NUMBER}) ({NUMBER})  worst frame ({NUMBER})  births ({NUMBER}) "
        rf"({NUMBER})  from fem ({NUMBER}); ({NUMBER}) ({NUMBER}) ({NUMBER})$",
        re.M,
    )
    names = (
        "scene",
        "apart_mean_pct",
        "apart_most_pct",
        "worst_frame_pct",
        "births_least",
        "births_most",
        "from_fem_pct",
        "from_fem_mean_pct",
        "from_fem_least_pct",
        "from_fem_most_pct",
    )
    return [dict(zip(names, found)) for found in row.findall(text)]


def parse_features(text):
    rows = []
    for scene, last, lines in blocks_of_features(text):
        head = group_numbers(
            ": # ms a frame; everything forced off # ms: # times, moved # %", lines[0]
        )
        cost = {
            name: re.search(rf"^\s+{name}\s.*?({NUMBER}) ms", "\n".join(lines), re.M)
            for name in ("plasticity", "singular points", "contact")
        }
        rows.append(
            {
                "scene": scene,
                "frames": f"1-{last}",
                "ms": head[0],
                "ms_all_off": head[1],
                "ratio": head[2],
                "moved_pct": head[3],
                **{
                    name.replace(" ", "_") + "_ms": found[1].lstrip("+")
                    for name, found in cost.items()
                },
            }
        )
    return rows


def blocks_of_features(text):
    parts = re.split(r"^(\w+), frames 1-(\d+)(?=:)", text, flags=re.M)
    return [(parts[k], parts[k + 1], parts[k + 2].split("\n")) for k in range(1, len(parts), 3)]


def parse_estimate(text):
    rows = []
    for scene, _, lines in blocks(text):
        for line in lines:
            found = group_numbers("estimate # true # ratio #", line)
            if found:
                after = re.search(
                    rf"({NUMBER}) ms,\s+\d+ it;\s+polished ({NUMBER})\s+({NUMBER}) ms", line
                )
                rows.append(
                    {
                        "scene": scene,
                        "frame": group_numbers("f#", line)[0],
                        "estimate_pct": found[0],
                        "true_pct": found[1],
                        "estimate_ms": after[1],
                        "polished_pct": after[2],
                        "polish_ms": after[3],
                    }
                )
    return rows


def parse_crumples(text):
    rows = []
    for scene, body in re.findall(r"^(\w+) by seed\n(.*?)\n\n", text, re.M | re.S):
        runs = [
            line.split()
            for line in body.replace("(", " ").replace(")", " ").split("\n")
            if re.match(r"\s+\d+\s+\d+\s", line)
        ]
        runs = [
            [float(word) for word in run if word != "+"] for run in runs
        ]  # seed, tri, elastic, geometry, worst, c_m, edge, crossed, births, ...
        column = list(zip(*runs))
        total = [a + b for a, b in zip(column[2], column[3])]
        rows.append(
            {
                "scene": scene,
                "seeds": len(runs),
                "triangles": mean(column[1], 0),
                "ms_median": f"{median(total):.2f}",
                "worst_frame_ms_median": f"{median(column[4]):.1f}",
                "worst_frame_ms_max": f"{max(column[4]):.1f}",
                "c_m_pct": mean(column[5], 4),
                "worst_edge_median_pct": median(column[6]),
                "worst_edge_max_pct": max(column[6]),
                "crossed_frames": int(sum(column[7])),
                "births_least": int(min(column[8])),
                "births_most": int(max(column[8])),
                "lag_median_mm": median(column[10]),
            }
        )
    return rows


def median(values):
    return sorted(values)[len(values) // 2]


def parse_crumple_density(text):
    table = re.search(r"^S4: plastic turn by density.*?\n.*?\n(.*?)\n\n", text, re.M | re.S)
    names = ("base_triangles", "triangles", "frame_24", "frame_48", "frame_72", "frame_96")
    return [dict(zip(names, line.split())) for line in table[1].split("\n")] if table else []


def parse_crumple_grammage(text):
    row = re.compile(
        rf"^\s+({NUMBER}) g/m2,.*?: ({NUMBER}) singular points, "
        rf"({NUMBER}) mm apart, creases ({NUMBER}) mm",
        re.M,
    )
    return [
        dict(zip(("grammage", "singular_points", "spacing_mm", "crease_mm"), found))
        for found in row.findall(text)
    ]


def parse_facets(text):
    row = re.compile(
        rf"^\s+(\w+)\s+f(\d+) height ({NUMBER}): facets ({NUMBER}) law ({NUMBER}), "
        rf"length ({NUMBER}) law ({NUMBER}), distance ({NUMBER}), points ({NUMBER}), "
        rf"edge ({NUMBER}) %, crossed (\d+), unfinished (\d+), ({NUMBER}) ms",
        re.M,
    )
    names = (
        "scene",
        "frame",
        "height",
        "facets",
        "facets_law",
        "crease_sides",
        "crease_sides_law",
        "distance",
        "singular_points",
        "worst_edge_pct",
        "crossed_frames",
        "unfinished_frames",
        "ms",
    )
    seeds = re.search(r"facets beside the law, (\d+) seeds", text)[1]
    return [{**dict(zip(names, found)), "seeds": seeds} for found in row.findall(text)]


def parse_facet_loads(text):
    row = re.compile(
        rf"^\s+(\w+)\s+f(\d+): facets (\d+), most ({NUMBER}), over 4: (\d+), "
        rf"of them stiff (\d+), lag ({NUMBER}) mm",
        re.M,
    )
    names = ("scene", "frame", "facets", "largest_load", "over_4", "stiff", "lag_mm")
    return [dict(zip(names, found)) for found in row.findall(text)]


def parse_render(text):
    rows = []
    for scene, frames, simulated, body in scenes_of_render(text):
        found = group_numbers(
            "render # creases # mesh # s hold # ms # + places # per 100k # "
            "c_m # worst # (f#) edge #",
            next(line for line in body.split("\n") if line.strip().startswith("shot ")),
        )
        rows.append(
            {
                "scene": scene,
                "frames": frames,
                "simulated_triangles": simulated,
                "rendered_triangles": found[0],
                "ms": f"{float(found[4]) + float(found[5]):.1f}",
                "c_m_pct": found[7],
                "c_m_worst_pct": found[8],
                "worst_edge_pct": found[10],
            }
        )
    return rows


def parse_render_energy(text):
    rows = []
    for scene, _, _, body in scenes_of_render(text):
        for line in body.split("\n"):
            if line.strip().startswith("shot ") and "  Ub" in line:
                for frame, ratio, moved in re.findall(
                    rf"(\d+):({NUMBER}) \(({NUMBER}) %\)", line.split("  Ub")[1]
                ):
                    rows.append(
                        {"scene": scene, "frame": frame, "ratio": ratio, "moved_pct": moved}
                    )
    return rows


def scenes_of_render(text):
    parts = re.split(r"^(\w+), (\d+) frames, sim (\d+) triangles.*$", text, flags=re.M)
    return [tuple(parts[k : k + 4]) for k in range(1, len(parts), 4)]


def parse_validation(text):
    rows, case, title = [], "", ""
    for line in text.split("\n"):
        if head := re.match(r"(V\d+)  (.*)", line):
            case, title = head.groups()
        elif case and line.startswith("    "):
            name, quantity, rest = line[4:38].strip(), line[39:69].strip(), line[69:]
            if "cannot: " in line:
                rows.append(
                    {
                        "case": case,
                        "title": title,
                        "method": name,
                        "quantity": quantity,
                        "verdict": "cannot: " + line.split("cannot: ")[1],
                    }
                )
            elif cells := re.match(
                rf"\s*({NUMBER})\s+({NUMBER})\s+({NUMBER}(?: %)?)\s+({NUMBER}(?: %)?)?\s+(.*)$",
                rest,
            ):
                verdict = re.search(r"(pass|FAIL)$", cells[5].strip())
                rows.append(
                    {
                        "case": case,
                        "title": title,
                        "method": name,
                        "quantity": quantity,
                        "expected": cells[1],
                        "computed": cells[2],
                        "deviation": cells[3],
                        "tolerance": cells[4] or "",
                        "verdict": verdict[1] if verdict else "",
                    }
                )
    return rows


def parse_stress(text):
    rows = []
    for method, body in re.findall(
        r"^(hybrid|fem|adaptive), seed \d+\n(.*?)(?=^(?:hybrid|fem|adaptive), seed|\Z)",
        text,
        re.M | re.S,
    ):
        words = re.search(r"^  all +(\d.*)$", body, re.M)[1].split()  # not the row "all released"
        names = (
            "scripts",
            "finished",
            "refused",
            "nan",
            "crashed",
            "endless",
            "feasible",
            "c_m_above_2_pct",
            "unreported",
            "remeshed",
            "rises",
            "unconverged",
            "worst_frame_ms",
            "most_triangles",
        )
        row = dict(zip(names, words))
        rows.append(
            {
                "method": method,
                **{
                    name: row[name]
                    for name in (
                        "scripts",
                        "finished",
                        "refused",
                        "nan",
                        "crashed",
                        "endless",
                        "feasible",
                        "c_m_above_2_pct",
                        "unreported",
                        "worst_frame_ms",
                    )
                },
            }
        )
    return rows


def parse_fit(text):
    found = re.search(
        r"^(\w+), apex_scatter .*?, (\d+) trials of (\d+) sheets: "
        r"deviation held in (\d+), offset u in (\d+), v in (\d+)",
        text,
        re.M,
    )
    names = ("grade", "trials", "sheets", "deviation_held", "offset_u_held", "offset_v_held")
    return [dict(zip(names, found.groups()))] if found else []


def parse_newton_step(text):
    """From JSON; one Newton step is an assembly, a factorisation, a solve and two energies."""
    by_size = {}
    for run in json.loads(text)["benchmarks"]:
        name, size = run["name"].split("/")[:2]
        by_size.setdefault(size, {})[name] = run
    rows = []
    for runs in by_size.values():
        step = (
            sum(
                runs[name]["real_time"]
                for name in ("assembly_of_exact_hessian", "factorisation", "solve")
            )
            + 2 * runs["energy"]["real_time"]
        )
        rows.append(
            {
                "triangles": int(runs["energy"]["triangles"]),
                "newton_step_ms": f"{step:.2f}",
                "factorisation_ms": f"{runs['factorisation']['real_time']:.2f}",
                "frame_ms": f"{runs['frames_of_s1']['elastic_ms/frame']:.2f}",
            }
        )
    return rows


# ---- bakes, whose numbers are in their certificates -----------------------------------------


def bake(program, scene, *options):
    """Seconds, summary and frames of a bake, and the size of its cache in MB."""
    with tempfile.TemporaryDirectory() as folder:
        begun = time.monotonic()
        done = subprocess.run(
            [program, "bake", f"samples/{scene}.glb", "-o", folder, "--progress", "none", *options],
            cwd=ROOT,
            stdout=subprocess.DEVNULL,
        )
        seconds = time.monotonic() - begun
        if done.returncode not in (0, 4):
            sys.exit(f"the bake of {scene} ends with {done.returncode}")
        cert = pathlib.Path(folder) / "cert"
        summary = json.loads((cert / "summary.json").read_text())
        frames = [json.loads(line) for line in (cert / "frames.jsonl").read_text().splitlines()]
        cache = pathlib.Path(folder) / f"{scene}.abc"
        return seconds, summary, frames, cache.stat().st_size / 1e6 if cache.exists() else 0


GRAVITY = {"S5_roll": ("--gravity", "9.81")}


def measure_fem(program, in_part):
    rows = []
    scenes = ("S1_push", "S8_dcone", "S5_roll", "S2_moebius", "S4_crumple")
    for scene in scenes[:1] if in_part else scenes:
        _, summary, frames, _ = bake(
            program,
            scene,
            "--method",
            "fem",
            "--formats",
            "cert",
            "--threads",
            "1",
            *GRAVITY.get(scene, ()),
        )
        rows.append(
            {
                "scene": scene,
                "triangles": round(summary["triangles"]["mean"]),
                "ms_frames_1_40": f"{sum(frame['elastic_ms'] for frame in frames[:40]) / 40:.0f}",
                "ms_all_frames": f"{summary['elastic_ms']['mean']:.0f}",
                "ms_worst_frame": f"{summary['elastic_ms']['max']:.0f}",
                "newton_iterations": f"{summary['newton_iterations']['mean']:.1f}",
                "c_m_pct": f"{summary['stretch_mean_pct']['mean']:.4f}",
                "c_m_worst_pct": f"{summary['stretch_mean_pct']['max']:.3f}",
                "worst_edge_pct": f"{summary['stretch_max_pct']['max']:.2f}",
                "gates": "missed" if summary["gates_missed"] else "kept",
                "handle_error_mm": f"{summary['handle_err_max_mm']['max']:.1f}",
            }
        )
    return rows


def measure_bakes(program, in_part):
    rows = []
    scenes = (
        "S1_push",
        "S2_moebius",
        "S4_crumple",
        "S4r_release",
        "S5_roll",
        "S8_dcone",
        "S9_unload",
        "S10_ball",
    )
    for scene in scenes[:1] if in_part else scenes:
        one, summary, _, size = bake(program, scene, "--threads", "1", *GRAVITY.get(scene, ()))
        two = bake(program, scene, "--threads", "2", *GRAVITY.get(scene, ()))[0]
        rows.append(
            {
                "scene": scene,
                "frames": summary["frames"],
                "seconds_1_thread": f"{one:.1f}",
                "seconds_2_threads": f"{two:.1f}",
                "abc_MB": f"{size:.0f}",
            }
        )
    return rows


# ---- all measurements -----------------------------------------------------------------------


class Bench:
    """A program of the build; several tables may come from what it prints once.

    part  arguments with which it measures a small part only
    """

    def __init__(self, command, tables, part, environment=None, written=None):
        self.command, self.tables, self.part = command, tables, part.split()
        self.environment = environment or {}
        self.written = written or " ".join(
            [f"{k}={v}" for k, v in self.environment.items()] + command
        )

    def output(self, in_part):
        done = subprocess.run(
            self.command + (self.part if in_part else []),
            cwd=ROOT,
            env={**os.environ, "OPENBLAS_NUM_THREADS": "1", **self.environment},
            capture_output=True,
            text=True,
        )
        if (
            done.returncode not in (0, 1) or not done.stdout
        ):  # 1: a line of the validation failed, and says so
            sys.exit(f"{self.written} ends with {done.returncode}: {done.stderr[-500:]}")
        return done.stdout


PROGRAM = "build/paperbake"
BENCHES = [
    Bench(["build/paperbake_bench_hybrid"], {"hybrid": parse_hybrid}, "300 S2"),
    Bench(["build/paperbake_bench_adaptive"], {"adaptive": parse_adaptive}, "300 S2"),
    Bench(
        ["build/paperbake_bench_crumple"],
        {
            "crumples": parse_crumples,
            "crumple_density": parse_crumple_density,
            "crumple_grammage": parse_crumple_grammage,
        },
        "1",
    ),
    Bench(
        ["build/paperbake_bench_facets"],
        {"facets": parse_facets, "facet_loads": parse_facet_loads},
        "1 S4r_release",
    ),
    Bench(
        ["build/paperbake_bench_render"],
        {"render": parse_render, "render_energy": parse_render_energy},
        "S2",
        {"BENCH_POLISH": "1", "BENCH_QUALITY": "shot"},
    ),
    Bench(["build/paperbake_bench_polish"], {"estimate": parse_estimate}, "300 S2"),
    Bench(["build/paperbake_invariance"], {"invariance": parse_invariance}, "hybrid S2"),
    Bench(["build/paperbake_bench_jitter"], {"jitter": parse_jitter}, "1 S1"),
    Bench(["build/paperbake_features"], {"features": parse_features}, "1 S2"),
    Bench(["build/paperbake_stress"], {"stress": parse_stress}, "--scripts 3 --method hybrid"),
    Bench(["build/paperbake_bench_fit"], {"fit": parse_fit}, "1 copy70 3"),
    Bench(["build/paperbake_validation"], {"validation": parse_validation}, "V1"),
    Bench(
        ["build/paperbake_bench", "--benchmark_format=json"],
        {"newton_step": parse_newton_step},
        "--benchmark_filter=/150$ --benchmark_min_time=0.01",
        written="build/paperbake_bench",
    ),
]
BAKES = {
    "fem": (
        measure_fem,
        "build/paperbake bake samples/NAME.glb -o DIR --method fem --formats cert --threads 1",
    ),
    "bakes": (measure_bakes, "build/paperbake bake samples/NAME.glb -o DIR --threads N"),
    "growth": (measure_growth, "python3 docs/measure_benchmarks.py growth"),
}


def machine():
    names = re.findall(r"^model name\s*: (.*)$", pathlib.Path("/proc/cpuinfo").read_text(), re.M)
    return f"{names[0] if names else 'unknown'}, {os.cpu_count()} cores"


def commit():
    def git(*words):
        return subprocess.run(
            ["git", *words], cwd=ROOT, capture_output=True, text=True, check=True
        ).stdout.strip()

    changed = git(
        "status", "--porcelain", "--untracked-files=no", "core", "formats", "baker", "tests"
    )
    return git("rev-parse", "--short", "HEAD") + (" with changes" if changed else "")


def write(name, rows, command, in_part):
    if not rows:
        sys.exit(f"{command} prints nothing that belongs into {name}.csv")
    if in_part:
        print(f"{name}.csv: {rows[0]}", flush=True)
        return
    text = io.StringIO()
    text.write(f"# machine: {machine()}\n# commit: {commit()}\n# command: {command}\n")
    writer = csv.DictWriter(
        text, list(dict.fromkeys(key for row in rows for key in row)), lineterminator="\n"
    )
    writer.writeheader()
    writer.writerows(rows)
    (DATA / f"{name}.csv").write_text(text.getvalue())
    print(f"{name}.csv: {len(rows)} rows", flush=True)


def main():
    in_part = "--try" in sys.argv
    wanted = set(sys.argv[1:]) - {"--try"}
    known = {table for bench in BENCHES for table in bench.tables} | set(BAKES)
    if wanted - known:
        sys.exit(
            f"There is no {', '.join(sorted(wanted - known))}. "
            f"There are: {', '.join(sorted(known))}."
        )
    for bench in BENCHES:
        if wanted and not wanted & set(bench.tables):
            continue
        if not (ROOT / bench.command[0]).exists():
            print(f"{bench.command[0]} was not built: {', '.join(bench.tables)} stay as they are")
            continue
        text = bench.output(in_part)
        for name, parse in bench.tables.items():
            write(name, parse(text), bench.written, in_part)
    for name, (measure, command) in BAKES.items():
        if not wanted or name in wanted:
            write(name, measure(PROGRAM, in_part), command, in_part)


if __name__ == "__main__":
    main()
