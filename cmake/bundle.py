"""Puts the program into a folder with all libraries that it needs, so that it runs where none of
them is installed.

    bundle.py PROGRAM FOLDER LICENSE PACKAGE...

FOLDER      emptied first; then bin/paperbake, lib/, licenses/ and libraries.txt, which says of
            every library which Debian package of which version it comes from
LICENSE     of the program
PACKAGE     Debian packages whose source is compiled into the program: their terms go into
            licenses/ with those of the libraries

The libraries are Debian's own files, found where the loader finds them. The same program and
libraries give the same bytes.
"""

import pathlib
import shutil
import subprocess
import sys

# What every Linux has. libstdc++ and libgcc_s are among it: those of Debian 12 ask for a newer C
# library than all the rest does.
OF_THE_SYSTEM = {"ld-linux-x86-64.so.2", "libc.so.6", "libm.so.6", "libpthread.so.0", "libdl.so.2",
                 "librt.so.1", "libstdc++.so.6", "libgcc_s.so.1"}
BLAS, BLAS_PACKAGE = "libblas.so.3", "libopenblas0-pthread"


def fail(place, cause, remedy):
    sys.exit(f"bundle.py: {place}\n  {cause}\n  {remedy}")


def output_of(*command):
    try:
        return subprocess.run(command, check=True, capture_output=True, text=True).stdout
    except FileNotFoundError:
        fail(command[0], "There is no such program here.",
             "Install the packages of the group [packages] in packages.txt.")
    except subprocess.CalledProcessError as error:
        fail(" ".join(map(str, command)), error.stderr.strip(),
             "The libraries of a package come from Debian's packages: pack on Debian 12.")


def libraries_of(program):
    """{name: path} of all that the loader loads and not every system has."""
    found = {}
    for line in output_of("ldd", program).splitlines():
        name, arrow, rest = line.strip().partition(" => ")
        if not arrow or name in OF_THE_SYSTEM:
            continue
        if rest.startswith("not found"):
            fail(program, f"The loader does not find {name}, which it needs.",
                 "Install the library and build again.")
        found[name] = pathlib.Path(rest.split(" (")[0]).resolve()
    return dict(sorted(found.items()))


def version_of(package):
    return output_of("dpkg-query", "-W", "-f", "${Version}", package)


def package_of(path):
    """Name of the Debian package that installed the file."""
    # some packages still list /lib, which is a link to /usr/lib
    listed = pathlib.Path("/", *path.parts[2:]) if path.is_relative_to("/usr/lib") else path
    known = subprocess.run(["dpkg", "-S", path, listed],
                           capture_output=True, text=True, check=False)
    return (known.stdout or output_of("dpkg", "-S", path)).split(":")[0]


def copy_library(path, to):
    shutil.copyfile(path, to)
    to.chmod(0o644)
    # The loader takes DT_RUNPATH after LD_LIBRARY_PATH and DT_RPATH before it: libraries that the
    # calling program has put there must not come between these.
    if "RUNPATH" in output_of("objdump", "-p", to):
        output_of("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN", to)


def copy_program(path, to):
    output_of("strip", "-o", to, path)
    output_of("patchelf", "--force-rpath", "--set-rpath", "$ORIGIN/../lib", to)
    to.chmod(0o755)


def bundle(program, folder, license_file, compiled_in):
    shutil.rmtree(folder, ignore_errors=True)
    for sub in ("bin", "lib", "licenses"):
        (folder / sub).mkdir(parents=True)
    libraries = libraries_of(program)
    packages = {name: package_of(path) for name, path in libraries.items()}
    if packages.get(BLAS, BLAS_PACKAGE) != BLAS_PACKAGE:
        fail(BLAS, f"That of {packages[BLAS]} is slow or not safe for several threads.",
             f"Choose that of {BLAS_PACKAGE} with update-alternatives.")
    copy_program(program, folder / "bin" / "paperbake")
    for name, path in libraries.items():
        copy_library(path, folder / "lib" / name)
    shutil.copyfile(license_file, folder / "licenses" / "paperbake")
    for package in sorted({*compiled_in, *packages.values()}):
        shutil.copyfile(f"/usr/share/doc/{package}/copyright", folder / "licenses" / package)
    lines = [f"{name}  {package} {version_of(package)}\n" for name, package in packages.items()]
    lines += [f"compiled in  {package} {version_of(package)}\n" for package in sorted(compiled_in)]
    (folder / "libraries.txt").write_text("".join(lines), encoding="utf-8")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    bundle(*map(pathlib.Path, sys.argv[1:4]), sys.argv[4:])
