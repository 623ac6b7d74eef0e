"""The form of the sources, checked by clang-format and lizard:

    tests/style_test.py ROOT

- every C++ file is formatted as .clang-format says;
- no function is longer than 60 lines or has more than 6 parameters.

Prints one line for each fault and exits with 1, or what was checked and exits with 0.
`clang-format-14 -i FILE` mends the first kind.
"""

import pathlib
import subprocess
import sys

import lizard

CLANG_FORMAT = "clang-format-14"  # other versions format a few lines differently
FOLDERS = ["core", "formats", "baker", "tests", "samples"]
MAX_LINES, MAX_PARAMETERS = 60, 6


def sources(root):
    return sorted(path for folder in FOLDERS for path in (root / folder).rglob("*")
                  if path.suffix in (".h", ".cpp"))


def unformatted(files):
    done = subprocess.run([CLANG_FORMAT, "--dry-run", "-Werror", *map(str, files)],
                          capture_output=True, text=True, check=False)
    faults = {line.split(":")[0] for line in done.stderr.splitlines() if "clang-format-violations" in line}
    if done.returncode != 0 and not faults:
        sys.exit(f"{CLANG_FORMAT} failed: {done.stderr.strip()}")
    return [f"{fault}: not formatted ({CLANG_FORMAT} -i)" for fault in sorted(faults)]


def too_large(files):
    """Functions of the product; tests may list as many cases as they need."""
    faults, functions = [], 0
    for path in files:
        for function in lizard.analyze_file(str(path)).function_list:
            functions += 1
            parameters = len(function.full_parameters)
            where = f"{path}:{function.start_line}: {function.name}"
            if function.length > MAX_LINES:
                faults.append(f"{where} has {function.length} lines, at most {MAX_LINES} are allowed")
            if parameters > MAX_PARAMETERS:
                faults.append(f"{where} has {parameters} parameters, at most {MAX_PARAMETERS} are allowed")
    return faults, functions


def main():
    root = pathlib.Path(sys.argv[1]).resolve()
    files = sources(root)
    product = [path for path in files if path.relative_to(root).parts[0] in ("core", "formats", "baker")]
    faults, functions = too_large(product)
    if len(product) < 100 or functions < 1000:
        sys.exit(f"Only {len(product)} files and {functions} functions were found in {root}.")
    faults += unformatted(files)
    for fault in faults:
        print(fault.replace(f"{root}/", ""))
    print(f"{len(files)} files, {functions} functions: {len(faults)} faults")
    sys.exit(1 if faults else 0)


if __name__ == "__main__":
    main()
