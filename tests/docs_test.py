"""Runs every command line that the documentation prints, as a reader would after a build.

    python3 tests/docs_test.py SOURCE BUILD SCRATCH

A command line is an indented or fenced line, or a code span, that begins with a program (COMMAND). They run in a folder of links that looks
like the clone, in the order in which they are printed, DIR after -o a new folder each time. What is made shorter, and what is not run and why,
stands in SHORTER and NOT_RUN. Code spans that are options have to be options of the program; those that are files of build/ have to be
there; a block that says which sample it is has to be that file.
"""
import os
import pathlib
import re
import subprocess
import sys
import time

COMMAND = re.compile(r"(?:[A-Z_]+=\S+ )*(build/\w+|paperbake|samples/run|tests/run|cmake|ctest|ninja|python3|\.venv/bin/python|blender)(?= |$)")
OWN = ("build/paperbake", "paperbake")
GOOD = {"bake": (0, 4), "wedge": (0, 4)}  # 4: baked, but a gate was missed, as in a range this short
LONGEST = 600  # [s] of one line

# what words stand for; those that follow -o stand for something new
MEANT = {"SCENE": "samples/S1_push.glb", "DIR": "baked", "FILE.abc": "baked/S1_push.abc", "NAME": "S1_push", "FRAME...": "1", "N": "2", "M": "hybrid",
         "[options]": "--quality draft --frames 1-12"}
NEW = {"JOB.toml", "POINTS.csv", "PICTURES", "STEM"}  # files of the scratch folder, called so

# added to a line that does not say it itself; of the tables, one small mesh of one scene
SHORTER = {
    "bake": {"--quality": "draft", "--frames": "1-12", "--map-size": "64"},
    "wedge": {"--quality": "draft", "--frames": "1-6", "--map-size": "64"},
    "chart": {"--frames": "1-6", "--reference": "300", "--repeat": "1", "--budget": "30"},
}
BEHIND = {
    "build/paperbake_bench": "--benchmark_filter=energy/150 --benchmark_min_time=0.01",
    "build/paperbake_bench_hybrid": "300 S2",
    "build/paperbake_bench_adaptive": "300 S2",
    "build/paperbake_bench_polish": "300 S2",
    "build/paperbake_bench_render": "S2",
    "build/paperbake_bench_fit": "1 copy70 3",
    "build/paperbake_features": "1 S2",
    "build/paperbake_invariance": "fem S2",
    "build/paperbake_validation": "V1",
    "build/core_tests": "--gtest_filter=Archive.*",
}
LESS = {"--budget": "30"}  # where a line says more
NOT_RUN = {  # each has to be printed somewhere
    "tests/run": "runs this test",
    "tests/run -L fast": "runs this test's like",
    "build/paperbake_bench_crumple": "a minute and more on one core, and nothing makes it shorter",
    "cmake --preset fuzz": "configures anew, with clang",
    "blender -b": "Blender is not installed; interop.blender_addon bakes in its Python module",
}


OPTIONAL = {"build/paperbake_bench": "there is no Google Benchmark here"}  # where they were not built


class Line:
    def __init__(self, place, text, block):
        self.place, self.text, self.block = place, text, block  # block: a line by itself, not in a sentence


def lines_of(path, name):
    """Command lines and other code of a page."""
    text = path.read_text()
    found = []
    fence, block, before = None, False, ""
    prose = []
    for number, line in enumerate(text.split("\n"), 1):
        place = f"{name}:{number}"
        if line.startswith("```"):
            fence = line[3:].strip() if fence is None else None
            prose.append("")
        elif fence is not None:
            if fence == "sh" or line.startswith("# paperbake "):
                found.append(Line(place, re.split(r"  +", line.removeprefix("# ").strip())[0], True))
            prose.append("")
        elif block := line.startswith("    ") and (block or not before):
            found.append(Line(place, re.split(r"  +", line.strip())[0], True))
            prose.append("")
        else:
            prose.append(line)
        before = line
    for span in re.finditer(r"`([^`]+)`", "\n".join(prose)):
        number = "\n".join(prose).count("\n", 0, span.start()) + 1
        found.append(Line(f"{name}:{number}", " ".join(span[1].split()), False))
    return sorted(found, key=lambda line: int(line.place.split(":")[1]))


def blocks_of(text):
    """Fenced blocks that begin with "# paperbake bake FILE": block, FILE."""
    return re.findall(r"^```\w*\n(# paperbake bake (\S+).*?)^```$", text, re.M | re.S)


class Clone:
    """A folder that looks like the clone, and all that is its own."""

    def __init__(self, source, build, scratch):
        self.root, self.fresh = scratch, 0
        for entry in source.iterdir():
            if entry.name not in ("samples", "build", ".git"):
                (scratch / entry.name).symlink_to(entry)
        (scratch / "samples").mkdir()
        for entry in (source / "samples").iterdir():
            if entry.name != "out":
                (scratch / "samples" / entry.name).symlink_to(entry)
        (scratch / "build").symlink_to(build)
        self.environment = {**os.environ, "PATH": f"{build}:{os.environ['PATH']}"}
        for line in ("bake samples/S1_push.glb -o baked --formats abc,maps,cert,usd --quality draft --frames 1-24 --map-size 64",
                     "bake samples/S1_push.glb -o out/job --quality draft --frames 1-6 --map-size 64 --write-job JOB.toml",
                     "fit --experiment copy70 --sheets 12 -o POINTS.csv"):
            code, said = self.run("paperbake " + line)
            assert code in (0, 4), f"{line}: {said}"

    def run(self, command):
        try:
            done = subprocess.run(["sh", "-c", command], cwd=self.root, env=self.environment, stdin=subprocess.DEVNULL,
                                  stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=LONGEST)
            return done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            return -1, f"not done in {LONGEST} s"

    def left_out(self, line):
        """Why the line is not run; empty: it is."""
        return NOT_RUN.get(line.text) or (OPTIONAL.get(line.text, "") if not (self.root / line.text).exists() else "")

    def meant(self, text):
        """The line with files in the place of its words; or what is not known of it."""
        words = []
        for word in text.split(" "):
            if words and words[-1] == "-o" and word == "DIR":
                self.fresh += 1
                word = f"out/{self.fresh}"
            parts = re.split(r"(/|(?<=NAME)\.|(?<=\w)=)", word) if word not in MEANT else [word]
            word = "".join(MEANT.get(part, part) for part in parts)
            unknown = re.fullmatch(r"[A-Z]{2,}[.\w]*(\.\.\.)?", word)
            if unknown and word not in NEW:
                raise KeyError(word)
            words += word.split(" ")
        return words

    def program_and_command(self, words):
        program = COMMAND.match(" ".join(words))[1]
        at = words.index(program)
        return program, words[at + 1] if program in OWN and len(words) > at + 1 else program

    def shortened(self, words):
        _, command = self.program_and_command(words)
        if "--help" in words or ">" in words:
            return words
        for option, most in LESS.items():
            if option in words:
                words[words.index(option) + 1] = most
        more = [w for option, value in SHORTER.get(command, {}).items() if option not in words for w in (option, value)]
        return words + more + BEHIND.get(command, "").split()


def judged(clone, line):
    """What is wrong with a command line; empty: nothing."""
    if clone.left_out(line):
        return ""
    try:
        words = clone.meant(line.text)
    except KeyError as word:
        return f"nobody knows what {word} stands for: MEANT"
    program, command = clone.program_and_command(words)
    if program.startswith("build/") and not (clone.root / program).exists():
        return "there is no such program"
    alone = words[-1] == program
    if not line.block and alone and program in OWN + ("samples/run",):
        return ""  # speaks of it
    if not line.block and program in OWN and words[-1] == command != "presets":
        words.append("--help")  # speaks of it
    code, said = clone.run(" ".join(clone.shortened(words)))
    return "" if code in GOOD.get(command, (0,)) else f"ends with {code}: {said[-1500:]}"


def options_of(clone):
    said = clone.run("paperbake --help")[1]
    commands = re.findall(r"^  ([a-z]+) ", said.split("Subcommands:")[1], re.M)
    assert len(commands) > 4, said
    return set(re.findall(r"--[a-z][a-z-]*", said + "".join(clone.run(f"paperbake {c} --help")[1] for c in commands)))


def main():
    source, build, scratch = map(pathlib.Path, sys.argv[1:])
    clone = Clone(source.resolve(), build.resolve(), scratch.resolve())
    options = options_of(clone)
    for wrong in ("build/paperbake bake SCENE -o DIR --qualty draft", "paperbake inspct SCENE", "build/paperbake_none", "paperbake verify FOLDER"):
        assert judged(clone, Line("here", wrong, True)), f"{wrong} went unnoticed"

    pages = [source / "README.md"] + sorted(p for top in ("baker", "core", "formats", "presets", "samples", "tests") for p in (source / top).rglob("*.md"))
    faults, ran, seen = 0, 0, set()
    for page in pages:
        name = str(page.relative_to(source))
        wrong = [(name, file, "the block is not that file") for block, file in blocks_of(page.read_text()) if (source / file).read_text() != block]
        for line in lines_of(page, name):
            begun = time.monotonic()
            if COMMAND.match(line.text):
                seen.add(line.text)
                what, why_not = judged(clone, line), clone.left_out(line)
                ran += not why_not
                print(f"{time.monotonic() - begun:6.1f} s  {line.place}: {line.text}" + (f"  # not run: {why_not}" if why_not else ""), flush=True)
            elif line.block:
                what = "a line by itself that is no command: COMMAND"
            elif line.text.startswith("--"):
                what = "" if re.match(r"--[a-z-]*", line.text)[0] in options else "no command has this option"
            elif re.fullmatch(r"build/\S+", line.text):
                what = "" if (clone.root / line.text).exists() else "there is no such file"
            else:
                continue
            wrong += [(line.place, line.text, what)] if what else []
        for fault in wrong:
            print("WRONG  {}: {}\n       {}".format(*fault), flush=True)
        faults += len(wrong)
    for text in NOT_RUN.keys() - seen:
        print(f"WRONG  {text}: in NOT_RUN, but no page prints it")
        faults += 1
    print(f"{ran} command lines run, {faults} wrong")
    return faults > 0 or ran < 20


if __name__ == "__main__":
    sys.exit(main())
