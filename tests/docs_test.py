"""Runs every command line that the documentation prints, and checks what else it claims.

    python3 tests/docs_test.py SOURCE BUILD SCRATCH

Commands: a command line is an indented line, a line of an sh block, or a code span, that begins
with a program (COMMAND). They run in a folder of links that looks like the clone after a build, in
the order in which they are printed; DIR after -o is a new folder each time. A line that several
pages print runs once, unless it uses a file that others write (NEW). What is made shorter, and what
is not run and why, stands in SHORTER, BEHIND and NOT_RUN. What a bench prints must be what
docs/measure_benchmarks.py reads.
Code: options in code spans must be options of the program, files of build/ must exist, a block that
names the sample it shows must be that file, and a C++ program of the README must compile.
Pages: docs_pages.py checks links, citations and names; a page that a script writes must be what it
writes today.
"""

import os
import pathlib
import re
import subprocess
import sys
import time

import docs_pages

sys.path.insert(0, str(pathlib.Path(sys.argv[1]).resolve() / "docs"))
import make_benchmarks  # noqa: E402
import make_command_line  # noqa: E402
import measure_benchmarks  # noqa: E402

COMMAND = re.compile(
    r"(?:[A-Z_]+=\S+ )*(build/\w+|paperbake|samples/run|tests/run|cmake|ctest|ninja|python3"
    r"|\.venv/bin/python|blender)(?= |$)"
)
OWN = ("build/paperbake", "paperbake")
GOOD = {
    "bake": (0, 4),
    "wedge": (0, 4),
}  # 4: baked, but a gate was missed, as in a range this short
LONGEST = 600  # [s] of one line

# what words stand for; those that follow -o stand for something new
MEANT = {
    "SCENE": "samples/S1_push.glb",
    "DIR": "baked",
    "A": "baked",
    "B": "baked",
    "FILE.abc": "baked/S1_push.abc",
    "NAME": "S1_push",
    "FRAME...": "1",
    "N": "2",
    "M": "hybrid",
    "[options]": "--quality draft --frames 1-12",
}
NEW = {"JOB.toml", "POINTS.csv", "PICTURES", "STEM"}  # files of the scratch folder, called so

# added to a line that does not say it itself; of the tables, one small mesh of one scene
SHORTER = {
    "bake": {"--quality": "draft", "--frames": "1-12", "--map-size": "64"},
    "wedge": {"--quality": "draft", "--frames": "1-6", "--map-size": "64", "--attempts": "1"},
    "chart": {"--frames": "1-6", "--reference": "300", "--repeat": "1", "--budget": "30"},
}
BEHIND = {bench.command[0]: " ".join(bench.part) for bench in measure_benchmarks.BENCHES}
LESS = {"--budget": "30"}  # where a line says more
NOT_RUN = {  # each has to be printed somewhere
    "tests/run": "runs this test",
    "tests/run -L fast": "runs this test's like",
    "ctest -R docs": "runs this test",
    "ctest --test-dir build -R docs": "runs this test",
    ".venv/bin/python docs/make_gallery.py": "ten minutes of rendering",
    ".venv/bin/python docs/make_gallery.py grades": "renders; needs Blender",
    "python3 docs/measure_benchmarks.py": "an hour; its parsers read what the benches print here",
    "python3 docs/measure_benchmarks.py growth": "a minute, on an idle machine",
    "build/paperbake_bench_crumple": "a minute and more on one core, and nothing makes it shorter",
    "cmake --install build --prefix PREFIX": "the test library installs and moves it",
    "cmake -S samples/cpp -B OWN -DCMAKE_PREFIX_PATH=PREFIX": "the test library does",
    "cmake --build OWN": "the test library does",
    "cmake --preset fuzz": "configures anew, with clang",
    "ctest --test-dir build -L packages": "runs tests like this one",
    "ctest --test-dir build-package -L packages -V": "runs tests like this one, in another build",
    "python3 tests/packaging/baseline_cost.py build-package/paperbake build/paperbake": "needs a second build",
    "cmake --preset package": "configures anew; the tests of the label packages pack this build",
    "cmake --build --preset package --target package_deb": "packages.made does, in this build",
    "cmake --build --preset package --target blender_addon": "packages.made does, in this build",
    "cmake --build --preset package --target wheel": "packages.made does, in this build",
    "blender -b": "Blender is not installed; interop.blender_addon bakes in its Python module",
}


OPTIONAL = {
    "build/paperbake_bench": "there is no Google Benchmark here"
}  # where they were not built


class Line:
    def __init__(self, place, text, block):
        self.place, self.text, self.block = (
            place,
            text,
            block,
        )  # block: a line by itself, not in a sentence


def lines_of(path, name):
    """Command lines and other code of a page."""
    text = path.read_text().replace("\\|", " ")
    found = []
    fence, block, before = None, False, ""
    prose = []
    for number, line in enumerate(text.split("\n"), 1):
        place = f"{name}:{number}"
        if line.startswith("```"):
            fence = line[3:].strip() if fence is None else None
            prose.append("")
        elif fence is not None:
            if fence == "sh" and line.strip() or line.startswith("# paperbake "):
                found.append(
                    Line(place, re.split(r"  +", line.removeprefix("# ").strip())[0], True)
                )
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


SMALL = " --quality draft --map-size 64"


class Clone:
    """A folder that looks like the clone, and all that is its own."""

    def __init__(self, source, build, scratch):
        self.root, self.fresh, self.judgements = scratch, 0, {}
        for entry in source.iterdir():
            if entry.name not in ("samples", "docs", "build", ".git"):
                (scratch / entry.name).symlink_to(entry)
        for folder in ("samples", "docs"):  # commands write into these
            (scratch / folder).mkdir()
            for entry in (source / folder).iterdir():
                if entry.name != "out":
                    (scratch / folder / entry.name).symlink_to(entry)
        (scratch / "build").symlink_to(build)
        self.environment = {**os.environ, "PATH": f"{build}:{os.environ['PATH']}"}
        for line in (
            "bake samples/S1_push.glb -o baked --formats abc,maps,cert,usd,report --frames 1-24" + SMALL,
            "bake samples/S1_push.glb -o out/job --frames 1-6 --write-job JOB.toml" + SMALL,
            "fit --experiment copy70 --sheets 12 -o POINTS.csv",
        ):
            code, said = self.run("paperbake " + line)
            assert code in (0, 4), f"{line}: {said}"

    def run(self, command):
        try:
            done = subprocess.run(
                ["sh", "-c", command],
                cwd=self.root,
                env=self.environment,
                stdin=subprocess.DEVNULL,
                stdout=subprocess.PIPE,
                stderr=subprocess.STDOUT,
                text=True,
                timeout=LONGEST,
            )
            return done.returncode, done.stdout
        except subprocess.TimeoutExpired:
            return -1, f"not done in {LONGEST} s"

    def left_out(self, line):
        """Why the line is not run; empty: it is."""
        return NOT_RUN.get(line.text) or (
            OPTIONAL.get(line.text, "") if not (self.root / line.text).exists() else ""
        )

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
        more = [
            w
            for option, value in SHORTER.get(command, {}).items()
            if option not in words
            for w in (option, value)
        ]
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
    speaks_of_it = not line.block and program in OWN and words[-1] == command != "presets"
    key = line.text + (" --help" if speaks_of_it else "")
    if key not in clone.judgements or NEW & set(words):
        code, said = clone.run(" ".join(clone.shortened(words + ["--help"] * speaks_of_it)))
        good = code in GOOD.get(command, (0,))
        clone.judgements[key] = (
            unread(program, said) if good else f"ends with {code}: {said[-1500:]}"
        )
    return clone.judgements[key]


def unread(program, said):
    """What docs/measure_benchmarks.py cannot read of the output of a bench; empty: nothing."""
    for bench in measure_benchmarks.BENCHES:
        if bench.command[0] == program and len(bench.command) == 1:
            for name, parse in bench.tables.items():
                if not parse(said):
                    return (
                        f"docs/measure_benchmarks.py finds no row of {name}.csv in: {said[-1500:]}"
                    )
    return ""


def stale_pages(clone, source):
    """Generated pages that are not what their scripts write today: place, what."""
    readme = (source / "README.md").read_text()
    pages = [
        (
            "docs/command_line.md",
            make_command_line.page(str(clone.root / "build/paperbake")),
            "make_command_line",
        ),
        ("docs/benchmarks.md", make_benchmarks.page(), "make_benchmarks"),
    ]
    wrong = [
        (name, f"is not what docs/{script}.py writes; run it")
        for name, text, script in pages
        if (source / name).read_text() != text
    ]
    return wrong + (
        []
        if readme == make_benchmarks.readme(readme)
        else [("README.md", "its table is not what docs/make_benchmarks.py writes; run it")]
    )


def wrong_programs(clone, source):
    """C++ programs of the README that do not compile: place, what."""
    if not (source / "core/animation").is_dir():  # they include the code as it is laid out in rooms
        return []
    wrong = []
    for number, program in enumerate(
        re.findall(r"^```cpp\n(.*?)^```$", (source / "README.md").read_text(), re.M | re.S), 1
    ):
        (clone.root / f"readme{number}.cpp").write_text(program)
        code, said = clone.run(
            "g++ -std=c++17 -fsyntax-only -I . -I build/include -isystem /usr/include/eigen3 "
            f"-isystem /usr/include/suitesparse readme{number}.cpp"
        )
        wrong += [("README.md", f"C++ program {number}: {said[-1500:]}")] if code else []
    return wrong


def options_of(clone):
    said = clone.run("paperbake --help")[1]
    commands = re.findall(r"^  ([a-z]+) ", said.split("Subcommands:")[1], re.M)
    assert len(commands) > 4, said
    return set(
        re.findall(
            r"--[a-z][a-z-]*",
            said + "".join(clone.run(f"paperbake {c} --help")[1] for c in commands),
        )
    )


def faults_of_page(clone, source, page, options, seen):
    """(place, what it says, what is wrong with it) of a page, and how many command lines ran."""
    name = str(page.relative_to(source))
    wrong = [
        (name, file, "the block is not that file")
        for block, file in blocks_of(page.read_text())
        if (source / file).read_text() != block
    ]
    ran = 0
    for line in lines_of(page, name):
        begun = time.monotonic()
        if COMMAND.match(line.text):
            seen.add(line.text)
            what, why_not = judged(clone, line), clone.left_out(line)
            ran += not why_not
            print(
                f"{time.monotonic() - begun:6.1f} s  {line.place}: {line.text}"
                + (f"  # not run: {why_not}" if why_not else ""),
                flush=True,
            )
        elif line.block:
            what = "a line by itself that is no command: COMMAND"
        elif line.text.startswith("--"):
            what = (
                ""
                if re.match(r"--[a-z-]*", line.text)[0] in options
                else "no command has this option"
            )
        elif re.fullmatch(r"build/\S+", line.text):
            what = "" if (clone.root / line.text).exists() else "there is no such file"
        else:
            continue
        wrong += [(line.place, line.text, what)] if what else []
    return wrong, ran


def try_the_checks(clone):
    """What is wrong on purpose must be found."""
    for wrong in (
        "build/paperbake bake SCENE -o DIR --qualty draft",
        "paperbake inspct SCENE",
        "build/paperbake_none",
        "paperbake verify FOLDER",
    ):
        assert judged(clone, Line("here", wrong, True)), f"{wrong} went unnoticed"
    page = clone.root / "page.md"
    page.write_text(
        "# One `two`, three\n\n[a](page.md#one-two-three) [b](page.md#four) [c](none.md) "
        "![d](none.png) `[e](none)`\n"
    )
    assert [what.split(":")[0] for _, what in docs_pages.wrong_links(page, page.read_text())] == [
        "page.md#four",
        "none.md",
        "none.png",
    ]
    keys = [
        key
        for _, key, _ in docs_pages.cited_keys(
            "/// [Cerda 1999,\n///  Mowitz 2020] as [Narain 2012, 2013], x[2000]"
        )
    ]
    assert keys == ["Cerda 1999", "Mowitz 2020", "Narain 2012", "Narain 2013"], keys
    assert docs_pages.yearless_keys("/// a\n/// [m] of [Cerda], [N m]\nx = y[A];\n") == [(2, "Cerda")]


def main():
    source, build, scratch = (pathlib.Path(path).resolve() for path in sys.argv[1:])
    clone = Clone(source, build, scratch)
    try_the_checks(clone)
    options = options_of(clone)
    wrong = [
        (place, "", what)
        for place, what in docs_pages.faults(source)
        + stale_pages(clone, source)
        + wrong_programs(clone, source)
    ]
    ran, seen = 0, set()
    for page in docs_pages.markdown_pages(source):
        of_page, ran_here = faults_of_page(clone, source, page, options, seen)
        wrong, ran = wrong + of_page, ran + ran_here
    wrong += [
        ("tests/docs_test.py", text, "in NOT_RUN, but no page prints it")
        for text in sorted(NOT_RUN.keys() - seen)
    ]
    for place, text, what in wrong:
        print(f"WRONG  {place}: {text}\n       {what}", flush=True)
    print(f"{ran} command lines, {len(clone.judgements)} of them different, {len(wrong)} wrong")
    return len(wrong) > 0 or ran < 20


if __name__ == "__main__":
    sys.exit(main())
