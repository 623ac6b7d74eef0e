"""What the tests of the packages share: where everything is, and a machine on which nothing of
ours is installed, played by this one.

The words of the command line are SOURCE BUILD VERSION FOLDER: the project, its build, the version
of its packages, and a folder for everything that is written, which is emptied first.
"""

import os
import pathlib
import shutil
import subprocess
import sys

SOURCE, BUILD, FOLDER = (pathlib.Path(sys.argv[number]).resolve() for number in (1, 2, 4))
VERSION = sys.argv[3]
PROGRAM, BUNDLE, DIST = BUILD / "paperbake", BUILD / "bundle", BUILD / "dist"
DEB = DIST / f"paperbake_{VERSION}_amd64.deb"
ZIP = DIST / f"paperbake_blender-{VERSION}-linux-x64.zip"
SKIPPED = 77  # the code by which ctest knows it

# Files that the program was built from, and must not need any more
BUILT_FROM = [SOURCE / "presets", SOURCE / "baker", SOURCE / "core", SOURCE / "formats",
              pathlib.Path("/usr/share/javascript")]
# hides what comes before the --, then becomes what comes after it
HIDE = f"""MOUNT={shutil.which("mount")}
while [ "$1" != -- ]; do
  if [ -d "$1" ]
  then "$MOUNT" -t tmpfs none "$1" || exit 1
  else "$MOUNT" --bind /dev/null "$1" || exit 1
  fi
  shift
done
shift
exec "$@"
"""
# libraries of the system, as the loader names them
SYSTEM = {"linux-vdso.so.1", "ld-linux-x86-64.so.2", "libc.so.6", "libm.so.6", "libstdc++.so.6",
          "libgcc_s.so.1", "libpthread.so.0", "libdl.so.2", "librt.so.1"}


def skip(why):
    print(f"skipped: {why}")
    sys.exit(SKIPPED)


def new_folder():
    shutil.rmtree(FOLDER, ignore_errors=True)
    FOLDER.mkdir(parents=True)


def the_wheel():
    (path,) = DIST.glob(f"paperbake-{VERSION}-py3-none-*.whl")
    return path


def own_mounts():
    """Words before a command that give it mounts of its own; none: it is not permitted here."""
    unshare = shutil.which("unshare") or "unshare"
    for words in ([unshare, "--mount"], [unshare, "--map-root-user", "--mount"]):
        if subprocess.run([*words, "true"], capture_output=True, check=False).returncode == 0:
            return words
    return []


def libraries_of(program):
    """{name: path} as the loader of this machine finds them; path None: it does not."""
    environment = {"LD_TRACE_LOADED_OBJECTS": "1"}
    listed = subprocess.run([program], env=environment, capture_output=True, text=True, check=True)
    found = {}
    for line in listed.stdout.splitlines():
        name, _, rest = line.strip().partition(" => ")
        path = rest.split(" (")[0]
        found[pathlib.Path(name.split(" ")[0]).name] = path if path.startswith("/") else None
    return found


def mapped(python, module):
    """Files that Python has in memory with this module: they cannot be hidden from it."""
    code = f"import {module}; print(open('/proc/self/maps').read())"
    command = [python, "-B", "-c", code]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return {line.split()[-1] for line in said.splitlines() if "/" in line}


def without_packages(python, module):
    """Words before a command of this Python: it finds neither the libraries of the bundle on the
    loader's path, nor the build, nor what the program was built from.

    module   that it needs: what Python maps with it stays in sight
    """
    words = own_mounts()
    if not words:
        print("mounts are not permitted here: the libraries of this machine stay in sight")
        return []
    ours = [path for name, path in libraries_of(PROGRAM).items() if path and name not in SYSTEM]
    hidden = {os.path.realpath(path) for path in ours} - mapped(python, module)
    assert len(hidden) > 10, hidden  # else nothing would be tested
    places = [*sorted(hidden), *(path for path in [BUNDLE, *BUILT_FROM] if path.is_dir())]
    words += ["/bin/sh", "-c", HIDE, "sh", *map(str, places), "--"]
    here = subprocess.run([*words, PROGRAM, "--version"], capture_output=True, check=False)
    assert here.returncode == 127, here  # the program of the build does not find its libraries
    return words


def strangers(program, folder):
    """Libraries that the loader would take from outside the folder, though they are not the
    system's."""
    found = libraries_of(program)
    return {name: path for name, path in found.items()
            if name not in SYSTEM and not os.path.realpath(path or "/").startswith(f"{folder}/")}
