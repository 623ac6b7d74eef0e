"""Uses the libraries as another project does.

    python3 tests/library/library_test.py SOURCE BUILD SCRATCH

Installs BUILD into SCRATCH and moves what was installed, so that nothing can be found by a path of
the build. Then it builds samples/cpp and the project "consumer" beside this file, each with
find_package(paperbake), and runs them. Prints one line for each check; exits with 1 when one fails.
"""

import json
import pathlib
import re
import shutil
import subprocess
import sys
import traceback

SOURCE, BUILD, SCRATCH = (pathlib.Path(path).resolve() for path in sys.argv[1:])
HERE = pathlib.Path(__file__).resolve().parent
PREFIX = SCRATCH / "moved"
# options of our own build that a project which links the libraries must not get
OURS = ("-march", "-Wall", "-Wextra", "-fno-math-errno", "-frounding-math", "-fpch-preprocess",
        "-fno-semantic-interposition", "prefix-map", "-Werror", "-fsanitize", "PAPERBAKE_VERSION")


def run(*command, expect=0):
    done = subprocess.run([str(word) for word in command], stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, check=False)
    assert done.returncode == expect, \
        f"{' '.join(map(str, command))} ends with {done.returncode}, not {expect}:\n" \
        f"{done.stdout[-3000:]}"
    return done.stdout


def configure(source, build, *options, expect=0):
    return run("cmake", "-S", source, "-B", build, f"-DCMAKE_PREFIX_PATH={PREFIX}",
               "-DCMAKE_EXPORT_COMPILE_COMMANDS=ON", *options, expect=expect)


def installs_and_moves():
    run("cmake", "--install", BUILD, "--prefix", SCRATCH / "installed")
    (SCRATCH / "installed").rename(PREFIX)
    assert (PREFIX / "include/paperbake/paperbake.h").is_file()
    archives = {path.name for path in PREFIX.rglob("*.a")}
    assert archives == {f"libpaperbake_{name}.a" for name in ("core", "formats", "bake")}, archives


def nothing_installed_names_a_folder_of_the_build():
    texts = [path for path in PREFIX.rglob("*") if path.suffix in (".cmake", ".h")]
    assert len(texts) > 80, len(texts)
    for path in texts:
        text = path.read_text()
        for folder in (SOURCE, BUILD, SCRATCH):
            assert str(folder) not in text, f"{path} names {folder}"
        for option in OURS if path.suffix == ".cmake" else ():
            assert option not in text, f"{path} has {option}"
    for path in PREFIX.rglob("*.a"):
        assert str(BUILD).encode() not in path.read_bytes(), f"{path} names {BUILD}"


def options_of_a_consumer_are_its_own(build):
    commands = json.loads((build / "compile_commands.json").read_text())
    assert commands
    for entry in commands:
        for option in OURS:
            assert option not in entry["command"], f"{entry['file']}: {option}"
        assert str(SOURCE / "core") not in entry["command"]
        # both sides have to align matrices alike; host.cpp sees none of ours
        if not entry["file"].endswith("host.cpp"):
            assert "-DEIGEN_MAX_ALIGN_BYTES=32" in entry["command"], entry["command"]


def builds_the_samples():
    configure(SOURCE / "samples/cpp", SCRATCH / "samples")
    options_of_a_consumer_are_its_own(SCRATCH / "samples")
    run("cmake", "--build", SCRATCH / "samples")


def bakes_a_sheet_and_reads_its_cache():
    said = run(SCRATCH / "samples/bake_a_sheet", SCRATCH / "arch")
    assert said.count("simulated frame") == said.count("rendered frame") == 25, said
    cache = SCRATCH / "arch/arch.abc"
    assert f"wrote {cache}\n" in said and "gate missed" not in said, said
    said = run(SCRATCH / "samples/read_a_cache", cache)
    assert "24 frames a second\nsheet paper: 25 frames\n" in said, said
    heights = [(float(low), float(high)) for low, high in re.findall(r"from (\S+) to (\S+) mm", said)]
    assert len(heights) == 25
    rises = [max(-low, high) for low, high in heights]
    assert rises[0] < 0.1, rises
    # an elastic arch of 120 mm whose ends are 90 mm apart rises by 0.31 of its length
    assert 32 < rises[-1] < 42, rises
    assert "read_a_cache" in run(SCRATCH / "samples/read_a_cache", expect=2)
    assert "arch.png" in run(SCRATCH / "samples/read_a_cache", SCRATCH / "arch.png", expect=3)


def writes_its_own_output():
    folder = SCRATCH / "frames"
    folder.mkdir()
    scene = SOURCE / "samples/S1_push.glb"
    said = run(SCRATCH / "samples/own_output", scene, folder, 5)
    files = sorted(folder.iterdir())
    assert len(files) == 5 == said.count("vertices"), f"{files}: {said}"
    for path in files:
        lines = path.read_text().split("\n")
        vertices = sum(line.startswith("v ") for line in lines)
        corners = [int(word) for line in lines if line.startswith("f ") for word in line.split()[1:]]
        assert vertices > 50 and max(corners) == vertices and min(corners) == 1, path


def builds_a_shared_library_and_every_header():
    build = SCRATCH / "consumer"
    build.mkdir()
    headers = sorted(path.relative_to(PREFIX / "include")
                     for path in (PREFIX / "include").rglob("*.h"))
    (build / "all_headers.cpp").write_text("".join(f"#include <{path}>\n" for path in headers))
    configure(HERE / "consumer", build)
    options_of_a_consumer_are_its_own(build)
    run("cmake", "--build", build)


def bakes_a_file_as_the_program_does():
    scene = SOURCE / "samples/S1_push.glb"
    run(SCRATCH / "consumer/host", scene, SCRATCH / "by_library")
    run(BUILD / "paperbake", "bake", scene, "-o", SCRATCH / "by_program", "--quality", "draft",
        "--frames", "1-6", "--formats", "abc,cert", "--progress", "none")
    for name in ("S1_push.abc", "singular.csv"):
        ours, theirs = (SCRATCH / folder / name for folder in ("by_library", "by_program"))
        assert ours.read_bytes() == theirs.read_bytes(), f"{name} differs"
    said = run(SCRATCH / "consumer/host", SCRATCH / "none.glb", SCRATCH / "nothing", expect=3)
    assert "none.glb" in said, said


def finds_no_other_version_and_components_by_name():
    project = SCRATCH / "find"
    project.mkdir()

    def found(arguments, then=""):
        (project / "CMakeLists.txt").write_text(
            "cmake_minimum_required(VERSION 3.16)\nproject(find LANGUAGES CXX)\n"
            f"find_package(paperbake {arguments})\nmessage(\"found: ${{paperbake_FOUND}}\")\n{then}")
        shutil.rmtree(project / "build", ignore_errors=True)
        return "found: 1" in configure(project, project / "build")

    version = re.search(r"VERSION (\S+)", (SOURCE / "CMakeLists.txt").read_text()
                        .split("project(paperbake", 1)[1])[1]
    assert found(version)
    assert not found("99.0")
    assert not found("COMPONENTS crumple")
    # the simulation alone needs none of the libraries that read and write files
    assert found("COMPONENTS core", "if(TARGET fmt::fmt OR TARGET PkgConfig::OPENEXR)\n"
                 "message(FATAL_ERROR \"more than core\")\nendif()\n")


def main():
    checks = (installs_and_moves, nothing_installed_names_a_folder_of_the_build, builds_the_samples,
              bakes_a_sheet_and_reads_its_cache, writes_its_own_output,
              builds_a_shared_library_and_every_header, bakes_a_file_as_the_program_does,
              finds_no_other_version_and_components_by_name)
    failed = 0
    for check in checks:
        try:
            check()
            print("ok     ", check.__name__.replace("_", " "))
        except Exception:  # the other checks have something to say too
            failed += 1
            print("FAILED ", check.__name__.replace("_", " "))
            traceback.print_exc(file=sys.stdout)
        sys.stdout.flush()
    sys.exit(failed > 0)


main()
