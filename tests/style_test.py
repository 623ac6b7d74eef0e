"""The form of the sources, checked by clang-format and lizard:

    tests/style_test.py ROOT

- every C++ file is formatted as .clang-format says;
- no line of C++, CMake or shell has more than 100 columns;
- no function is longer than 60 lines or has more than 6 parameters.

Prints one line for each fault and exits with 1, or what was checked and exits with 0.
`clang-format-14 -i FILE` mends the first kind.
"""

import pathlib
import re
import subprocess
import sys

import lizard

CLANG_FORMAT = "clang-format-14"  # other versions format a few lines differently
FOLDERS = ["core", "formats", "baker", "tests", "samples"]
MAX_LINES, MAX_PARAMETERS, MAX_COLUMNS = 60, 6, 100

# Functions that are still larger, with what they have: none of them may grow, and one that has
# become small enough is a fault until its line here is gone.
STILL_LARGER = {
    ("chart_picture.cpp", "text"): (60, 7),
}


def sources(root):
    return sorted(path for folder in FOLDERS for path in (root / folder).rglob("*")
                  if path.suffix in (".h", ".cpp"))


def scripts(root):
    """Files that are neither C++ nor Python."""
    return sorted([*root.glob("CMakeLists.txt"), *root.glob("cmake/*.cmake"), root / ".ci/run",
                   root / "samples/run", root / "samples/setup.sh", root / "tests/run",
                   *(path for folder in FOLDERS for path in (root / folder).rglob("CMakeLists.txt")
                     if "build" not in path.parts)])


def too_wide(files):
    """Lines that clang-format could not break either; a raw string and a single word may be wider."""
    faults = []
    for path in files:
        for number, line in enumerate(path.read_text().split("\n"), 1):
            if (len(line) > MAX_COLUMNS and 'R"(' not in line
                    and " " in re.sub(r"^\W+", "", line)):
                faults.append(f"{path}:{number}: {len(line)} columns, at most {MAX_COLUMNS}")
    return faults


def unformatted(files):
    done = subprocess.run([CLANG_FORMAT, "--dry-run", "-Werror", *map(str, files)],
                          capture_output=True, text=True, check=False)
    faults = {line.split(":")[0] for line in done.stderr.splitlines()
              if "clang-format-violations" in line}
    if done.returncode != 0 and not faults:
        sys.exit(f"{CLANG_FORMAT} failed: {done.stderr.strip()}")
    return [f"{fault}: not formatted ({CLANG_FORMAT} -i)" for fault in sorted(faults)]


def too_large(files):
    """Functions of the product; tests may list as many cases as they need."""
    faults, functions, larger = [], 0, set()
    for path in files:
        for function in lizard.analyze_file(str(path)).function_list:
            functions += 1
            parameters = len(function.full_parameters)
            where = f"{path}:{function.start_line}: {function.name}"
            key = (path.name, function.name.removeprefix("paperbake::"))
            lines_allowed, parameters_allowed = STILL_LARGER.get(key, (MAX_LINES, MAX_PARAMETERS))
            if function.length > MAX_LINES or parameters > MAX_PARAMETERS:
                larger.add(key)
            if function.length > lines_allowed:
                faults.append(f"{where} has {function.length} lines, at most {lines_allowed}")
            if parameters > parameters_allowed:
                faults.append(f"{where} has {parameters} parameters, at most {parameters_allowed}")
    for name, function in sorted(set(STILL_LARGER) - larger):
        faults.append(f"{name}: {function} is small enough: take it out of STILL_LARGER")
    return faults, functions


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = sources(root)
    product = [path for path in files
               if path.relative_to(root).parts[0] in ("core", "formats", "baker")]
    faults, functions = too_large(product)
    if len(product) < 100 or functions < 1000:
        sys.exit(f"Only {len(product)} files and {functions} functions were found in {root}.")
    faults += unformatted(files) + too_wide(files + scripts(root))
    for fault in faults:
        print(fault.replace(f"{root}/", ""))
    print(f"{len(files)} files, {functions} functions: {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
