#!/usr/bin/env python3
"""Writes docs/benchmarks.md and the table between the two marks of README.md from docs/data/*.csv.

    python3 docs/make_benchmarks.py

No measured number is typed by hand in these two places; docs/measure_benchmarks.py fills the files.
"""

import csv
import os
import pathlib
import re

ROOT = pathlib.Path(os.path.abspath(__file__)).parent.parent
DATA = ROOT / "docs" / "data"
PAGE = ROOT / "docs" / "benchmarks.md"
README = ROOT / "README.md"
MARKS = "<!-- benchmarks: written by docs/make_benchmarks.py -->", "<!-- end of benchmarks -->"

HEAD = """# Benchmarks

<!-- Written by docs/make_benchmarks.py from docs/data. Do not edit. -->

Every table of this page is made from a file in `docs/data`, which names the machine, the commit
and the command that its numbers come from. On an idle machine, after a build with tests,

```sh
python3 docs/measure_benchmarks.py
python3 docs/make_benchmarks.py
```

measure everything again and rewrite this page and the table of the
[README](../README.md#speed-and-accuracy). With names of files, for instance `hybrid render`, the
first command measures only those.

Unless a table says otherwise: one thread, CPU time, paper of grade copy70, shapes without
plasticity. The scenes are described in [samples](../samples/README.md). `c_m` is the mean of \\|l
− L\\|/L over all edges, where l is the length of an edge and L its length on the flat pattern.
Distances between shapes are root mean squares over 41 × 41 points of the pattern, in per cent of
its longer side, averaged over the frames.
"""

SCENES = {
    "S1_push": "S1, sheet pushed into an arch",
    "S2_moebius": "S2, strip twisted into a Möbius strip",
    "S5_roll": "S5, corner carried over the sheet, no ground",
    "S8_dcone": "S8, sheet with clamped borders",
    "S5_ground": "S5, the same on its ground",
    "S4_crumple": "S4, sheet crumpled by eight handles",
    "S4r_release": "S4r, the same, then let go",
    "S9_unload": "S9, arch loaded and unloaded in two steps",
    "S10_ball": "S10, A4 sheet crushed to a ball",
    "S13_tube": "S13, sheet in a can that is pressed",
}


class Data:
    """The rows of a file of docs/data and what its head says; no rows: it has not been measured."""

    def __init__(self, name):
        path = DATA / f"{name}.csv"
        text = path.read_text() if path.exists() else ""
        self.name = name
        self.head = dict(re.findall(r"^# (\w+): (.*)$", text, re.M))
        self.rows = list(
            csv.DictReader(line for line in text.split("\n") if line and not line.startswith("#"))
        )

    def source(self):
        command, where = (
            self.head["command"],
            f"commit {self.head['commit']}, {self.head['machine']}",
        )
        note = (
            f" {self.head['note'][0].upper()}{self.head['note'][1:]}."
            if "note" in self.head
            else ""
        )
        return f"`{command}`; {where}; `docs/data/{self.name}.csv`.{note}"


def span(least, most):
    return least if least == most else f"{least}–{most}"


def cell(column, row):
    text = column(row) if callable(column) else row.get(column, "")
    return "" if text is None else str(text).replace("|", "\\|")


def table(rows, columns):
    """columns  heading -> key of the file, or function of a row; headings with < in front are text"""
    heads = [name.lstrip("<").strip() for name in columns]
    lines = [
        "| " + " | ".join(heads) + " |",
        "|" + "|".join("---" if name.startswith("<") else "--:" for name in columns) + "|",
    ]
    lines += [
        "| " + " | ".join(cell(column, row) for column in columns.values()) + " |" for row in rows
    ]
    return "\n".join(lines) + "\n"


def scene(row):
    return SCENES.get(row["scene"], row["scene"])


def hybrid_ms(row):
    return f"{float(row['elastic_ms']) + float(row['geometry_ms']):.1f}"


def hybrid_distance(row):
    return f"{row['rms_pct']} [{row['rms_least_pct']}, {row['rms_most_pct']}]"


SPEED = {
    "<scene": scene,
    "FEM 6,000, ms": lambda row: f"{float(row['fem_6000_ms']):.0f}",
    "FEM 1,700, ms": lambda row: f"{float(row['fem_1700_ms']):.0f}",
    "its distance, %": "fem_1700_rms_pct",
    "hybrid, ms": hybrid_ms,
    "its distance, % ": "rms_pct",
    "c_m, %": "c_m_pct",
}

# heading, file, text before the table, columns
SECTIONS = [
    (
        "Hybrid against FEM",
        "hybrid",
        "The hybrid method is compared with finite elements on about 6,000 and about 1,700 "
        "triangles, over the frames in which all methods agree on the branch. The hybrid runs "
        "with three base densities; its columns are means over the three, with the range of the "
        "distance in brackets. The times are those of the elastic step and of everything else "
        "that touches the sheet. ‘Normals’ is the mean angle between the shaded normals.\n\n"
        "![Speed against accuracy on S8](pictures/S8_dcone.chart.svg)\n\n"
        "The picture shows the same trade-off for S8, with the error of the reference itself: "
        "`build/paperbake chart samples/S8_dcone.glb -o DIR --frames 1-44 --repeat 1 --budget "
        "150`. For a chaotic scene, such as S4, `chart` says so and compares energies instead.",
        {
            "<scene": scene,
            "frames": "frames",
            "FEM 6,000, ms": "fem_6000_ms",
            "FEM 1,700, ms": "fem_1700_ms",
            "FEM 1,700, distance, %": "fem_1700_rms_pct",
            "hybrid, triangles": "triangles",
            "hybrid, ms": lambda r: f"{r['elastic_ms']} + {r['geometry_ms']}",
            "worst frame, ms": "worst_frame_ms",
            "hybrid, distance, %": hybrid_distance,
            "normals, °": "normals_deg",
            "c_m, %": "c_m_pct",
            "worst edge, %": "worst_edge_pct",
            "singular points": lambda r: span(r["births_least"], r["births_most"]),
        },
    ),
    (
        "Adaptive remeshing",
        "adaptive",
        "Adaptive remeshing beside finite elements with about as many triangles, against finite "
        "elements on about 6,000. One mesh of each method, so small differences mean nothing.",
        {
            "<scene": scene,
            "frames": "frames",
            "adaptive, triangles": "triangles",
            "adaptive, ms": lambda r: f"{r['elastic_ms']} + {r['geometry_ms']}",
            "worst frame, ms": "worst_frame_ms",
            "adaptive, distance, %": "rms_pct",
            "FEM, triangles": "fem_triangles",
            "FEM, ms": "fem_ms",
            "FEM, distance, %": "fem_rms_pct",
        },
    ),
    (
        "FEM over whole shots",
        "fem",
        "Method `fem` on whole sample scenes (S5 with `--gravity 9.81`, on its ground): the time "
        "of the elastic step and the quality of the result. `gates` says whether all [quality "
        "gates](output_files.md#gates) were met.",
        {
            "<scene": "scene",
            "triangles": "triangles",
            "ms, frames 1-40": "ms_frames_1_40",
            "ms, all frames": "ms_all_frames",
            "worst frame, ms": "ms_worst_frame",
            "Newton steps a frame": "newton_iterations",
            "c_m, %": "c_m_pct",
            "c_m, worst frame, %": "c_m_worst_pct",
            "worst edge, %": "worst_edge_pct",
            "<gates": "gates",
            "largest handle error, mm": "handle_error_mm",
        },
    ),
    (
        "Crumples",
        "crumples",
        "A single crumple has no statistics, so these are medians over seeds: hybrid, with "
        "plasticity and contact. The lag is how far the handles are behind their keys at most, in"
        " a crumple that jams.",
        {
            "<scene": scene,
            "seeds": "seeds",
            "triangles": "triangles",
            "ms a frame, median": "ms_median",
            "worst frame, ms, median": "worst_frame_ms_median",
            "worst frame, ms, worst seed": "worst_frame_ms_max",
            "c_m, %": "c_m_pct",
            "worst edge, %, median": "worst_edge_median_pct",
            "worst edge, %, worst seed": "worst_edge_max_pct",
            "frames with crossings": "crossed_frames",
            "singular points": lambda r: span(r["births_least"], r["births_most"]),
            "lag, mm, median": "lag_median_mm",
        },
    ),
    (
        "Crumples by mesh density",
        "crumple_density",
        "How much the plastic turn of S4 (length of crease × angle kept in it, m rad) depends on "
        "the density of the mesh, mean over seeds.",
        {
            "base triangles": "base_triangles",
            "triangles": "triangles",
            "frame 24": "frame_24",
            "frame 48": "frame_48",
            "frame 72": "frame_72",
            "frame 96": "frame_96",
        },
    ),
    (
        "Crumples by grammage",
        "crumple_grammage",
        "Heavier paper of the same fibres has fewer singular points and larger facets (S4r, mean "
        "over seeds).",
        {
            "g/m²": "grammage",
            "singular points": "singular_points",
            "distance between them, mm": "spacing_mm",
            "mean crease, mm": "crease_mm",
        },
    ),
    (
        "Facets of crumples",
        "facets",
        "Facets, which are what is left in one piece when the pattern is cut along edges that keep "
        "a turn of more than 10 degrees, beside the law of [Andrejevic 2021]: their number, and the "
        "length of the creases between them in sides of the sheet. The distance of the "
        "distribution of their sizes from that of the law is below 1.36 in 19 of 20 samples of the "
        "law. The law is of Mylar that is pressed once in a tube, which S13 does and S4r does not. "
        "Means over seeds, but for the worst edge; frames with crossings and frames not converged "
        "are those up to this frame, in all seeds.",
        {
            "<scene": scene,
            "seeds": "seeds",
            "frame": "frame",
            "height over side": "height",
            "facets": "facets",
            "law": "facets_law",
            "creases, sides": "crease_sides",
            "law ": "crease_sides_law",
            "distance": "distance",
            "singular points": "singular_points",
            "worst edge, %": "worst_edge_pct",
            "frames with crossings": "crossed_frames",
            "frames not converged": "unfinished_frames",
            "ms a frame": "ms",
        },
    ),
    (
        "What facets carry",
        "facet_loads",
        "The load of a facet is the most compressive principal value of its membrane stress, "
        "averaged over it and its neighbours, over 4 π² D/w², under which a plate of its width w "
        "with clamped ends buckles. A square plate that is clamped all round carries 2.5 times that, so "
        "a facet over 4 asks for a crease that the mesh does not have, unless it lies against a "
        "wall, as those of S13 in frame 25. Stiff are those "
        "of them that store, with their neighbours, more than a third of their energy in the "
        "membrane. Here facets are parted by edges that are folded by more than 10 degrees now.",
        {
            "<scene": scene,
            "frame": "frame",
            "facets": "facets",
            "largest load": "largest_load",
            "facets over 4": "over_4",
            "stiff": "stiff",
            "lag of handles, mm": "lag_mm",
        },
    ),
    (
        "Render mesh",
        "render",
        "Putting a simulated frame on the mesh of the whole shot, at `--quality shot`: triangles "
        "of both meshes, time for positions and normals, and how well the rendered mesh keeps its"
        " lengths.",
        {
            "<scene": "scene",
            "frames": "frames",
            "simulated triangles": "simulated_triangles",
            "rendered triangles": "rendered_triangles",
            "ms a frame": "ms",
            "c_m, %": "c_m_pct",
            "c_m, worst frame, %": "c_m_worst_pct",
            "worst edge, %": "worst_edge_pct",
        },
    ),
    (
        "Bending energy of the render mesh",
        "render_energy",
        "The bending energy of a rendered frame over that of the same frame relaxed on the same "
        "mesh, and how far relaxing moves it in per cent of the longer side: 1 would be a shape "
        "at equilibrium. A crumple that is relaxed goes to another crumple.",
        {"<scene": "scene", "frame": "frame", "energy ratio": "ratio", "moved, %": "moved_pct"},
    ),
    (
        "Whole bakes",
        "bakes",
        "A bake with default options (`--quality shot`; cache, maps, certificate and report): "
        "wall-clock time on one and on two threads, and size of the Alembic cache.",
        {
            "<scene": "scene",
            "frames": "frames",
            "s, 1 thread": "seconds_1_thread",
            "s, 2 threads": "seconds_2_threads",
            "cache, MB": "abc_MB",
        },
    ),
    (
        "Growth",
        "growth",
        "CPU time and peak memory of bakes in which one thing grows: sheets that are held along "
        "two borders, pushed together and let apart again (`docs/measure_growth.py` makes the "
        "scenes). The exponent p of a row says that time or memory grows with the p-th power of "
        "the size since the row before. The program itself takes 17 MB. All of it takes a "
        "minute.",
        {
            "<what grows": "what",
            "size": "size",
            "CPU s": "cpu_s",
            "p": "cpu_exponent",
            "peak MB": "peak_MB",
            "p of memory": "memory_exponent",
            "<why": "why",
            "<options": lambda row: f"`{row['options']}`",
        },
    ),
    (
        "One Newton step",
        "newton_step",
        "Assembly, factorisation, solve and two energies, and the mean elastic time of frames "
        "1-24 of S1 by `fem`. Needs Google Benchmark when the project is configured.",
        {
            "triangles": "triangles",
            "Newton step, ms": "newton_step_ms",
            "factorisation, ms": "factorisation_ms",
            "frame of S1, ms": "frame_ms",
        },
    ),
    (
        "Cost of what is not needed",
        "features",
        "What plasticity, singular points and contact cost in a scene, and how far the sheet "
        "moves when all three are forced off.",
        {
            "<scene": "scene",
            "frames": "frames",
            "ms a frame": "ms",
            "ms, all off": "ms_all_off",
            "ratio": "ratio",
            "moved, %": "moved_pct",
            "plasticity, ms": "plasticity_ms",
            "singular points, ms": "singular_points_ms",
            "contact, ms": "contact_ms",
        },
    ),
    (
        "Independence of steps and meshes",
        "invariance",
        "The same shot with frames 4 times as long and as short, handles 4 times as fast and as "
        "slow, first meshes turned by 17, 8 and 41 degrees, and another seed of the initial "
        "imperfection: the largest distance between any two of these runs. S5 on its ground "
        "snaps.",
        {
            "<scene": scene,
            "<method": "method",
            "largest distance, %": "largest_pct",
            "<between": "between",
        },
    ),
    (
        "Noise in the keys",
        "jitter",
        "Ten runs of `hybrid` with keys that are moved by up to a micrometre, against the run "
        "without: mean over the frames of each run, and the worst frame of all. Beside it how far "
        "all of them are from `fem` of 6,000 triangles.",
        {
            "<scene": scene,
            "moved, %: mean": "apart_mean_pct",
            "most": "apart_most_pct",
            "worst frame": "worst_frame_pct",
            "singular points": lambda row: "{births_least}-{births_most}".format(**row),
            "from fem, %": "from_fem_pct",
            "with noise: mean": "from_fem_mean_pct",
            "least": "from_fem_least_pct",
            "most ": "from_fem_most_pct",
        },
    ),
    (
        "Error estimate and polish",
        "estimate",
        "`verify --estimate` relaxes every 12th frame on a finite element mesh of 2,400 "
        "triangles; how far it moves estimates its error. Beside it the true error, and what is "
        "left of it after `--polish 6000`.",
        {
            "<scene": "scene",
            "frame": "frame",
            "estimate, %": "estimate_pct",
            "true error, %": "true_pct",
            "estimate, ms": "estimate_ms",
            "error after polish, %": "polished_pct",
            "polish, ms": "polish_ms",
        },
    ),
    (
        "Stress",
        "stress",
        "Generated handle scripts: jerks, teleports, over-stretch, crossing handles, slivers, "
        "sheets from 2 mm to 10 m. A script is refused when it ends with an error message; it is "
        "feasible when no two handles are ever farther apart than the paper between them is long.",
        {
            "<method": "method",
            "scripts": "scripts",
            "finished": "finished",
            "refused": "refused",
            "NaN": "nan",
            "crashed": "crashed",
            "endless": "endless",
            "feasible": "feasible",
            "feasible with c_m over 2 %": "c_m_above_2_pct",
            "impossible, but not reported": "unreported",
            "worst frame, ms": "worst_frame_ms",
        },
    ),
    (
        "Fit of a grade",
        "fit",
        "How often the 95 % intervals of `paperbake fit` hold the law from which the pushed "
        "sheets were drawn: standard deviation, and mean in u and v.",
        {
            "<grade": "grade",
            "trials": "trials",
            "sheets each": "sheets",
            "deviation": "deviation_held",
            "mean, u": "offset_u_held",
            "mean, v": "offset_v_held",
        },
    ),
    (
        "Validation",
        "validation",
        "Closed forms, exact numerical solutions and measured laws, line by line. "
        "[Validation](validation.md) says what the cases are.",
        {
            "<case": "case",
            "<mesh or method": "method",
            "<quantity": "quantity",
            "expected": "expected",
            "computed": "computed",
            "deviation": "deviation",
            "tolerance": "tolerance",
            "<verdict": "verdict",
        },
    ),
]


def section(heading, name, text, columns):
    data = Data(name)
    if not data.rows:
        return (
            f"\n## {heading}\n\n{text}\n\nNot measured yet: `{name}` is missing from `docs/data`.\n"
        )
    return f"\n## {heading}\n\n{text}\n\n{table(data.rows, columns)}\n{data.source()}\n"


def page():
    return HEAD + "".join(section(*entry) for entry in SECTIONS)


def readme(text):
    """The README with its table made anew."""
    data = Data("hybrid")
    before, after = text.index(MARKS[0]) + len(MARKS[0]), text.index(MARKS[1])
    where = f"Commit {data.head['commit']}, {data.head['machine']}, one thread."
    legend = "`c_m` is the mean error of the edge lengths of the hybrid."
    return text[:before] + f"\n\n{table(data.rows, SPEED)}\n{where} {legend}\n\n" + text[after:]


def write(path, text):
    beside = path.with_name(path.name + ".part")
    beside.write_text(text)
    beside.replace(path)
    print(path)


def main():
    write(PAGE, page())
    write(README, readme(README.read_text()))


if __name__ == "__main__":
    main()
