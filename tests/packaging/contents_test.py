"""Tests what is in the packages: the same bytes when they are packed again, nothing of the machine
that packed them, no instruction beyond the baseline, and the terms of all that is in them.

    contents_test.py SOURCE BUILD VERSION FOLDER
"""

import hashlib
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import unittest
import zipfile

from bare_machine import (BUILD, BUNDLE, DEB, DIST, FOLDER, PROGRAM, SOURCE, SYSTEM, VERSION, ZIP,
                          libraries_of, new_folder, the_wheel)

EARLIEST = (1980, 1, 1, 0, 0, 0)
# AVX and FMA, BMI and MOVBE: x86-64-v2 has none of them
BEYOND_BASELINE = re.compile(
    r"\t(v\w+ .*%[xyz]mm|(andn|bextr|blsr|mulx|pdep|pext|rorx|sarx|shlx|shrx|movbe)\w? )")


def run(*command, **settings):
    return subprocess.run(command, check=True, capture_output=True, text=True, **settings).stdout


def digest(path):
    return hashlib.sha256(pathlib.Path(path).read_bytes()).hexdigest()


def unpacked_deb():
    """Folder with what the .deb installs."""
    folder = FOLDER / "unpacked"
    if not folder.exists():
        run("dpkg-deb", "-x", DEB, folder)
    return folder


def contents():
    """(name, bytes) of every file in the three packages."""
    for path in (ZIP, the_wheel()):
        with zipfile.ZipFile(path) as archive:
            for entry in archive.infolist():
                yield f"{path.name}: {entry.filename}", archive.read(entry)
    for path in unpacked_deb().rglob("*"):
        if path.is_file():
            yield f"{DEB.name}: {path.relative_to(unpacked_deb())}", path.read_bytes()


class Packages(unittest.TestCase):
    def test_packed_again_they_have_the_same_bytes(self):
        again = FOLDER / "again"
        table = (BUNDLE / "libraries.txt").read_text().splitlines()
        compiled_in = [line.split()[2] for line in table if line.startswith("compiled in")]
        self.assertGreater(len(compiled_in), 3)
        run("python3", "-B", SOURCE / "cmake" / "bundle.py", PROGRAM, FOLDER / "bundle",
            SOURCE / "LICENSE", *compiled_in)
        baker = SOURCE / "baker"
        for script in (baker / "blender" / "make_zip.py", baker / "python" / "make_wheel.py"):
            run("python3", "-B", script, again, FOLDER / "bundle", VERSION)
        run("cpack", "-G", "DEB", "-B", again, cwd=BUILD)
        for path in (ZIP, the_wheel(), DEB):
            self.assertEqual(digest(path), digest(again / path.name), path.name)

    def test_no_time_is_told(self):
        for path in (ZIP, the_wheel()):
            with zipfile.ZipFile(path) as archive:
                self.assertEqual({entry.date_time for entry in archive.infolist()}, {EARLIEST})
        listed = run("dpkg-deb", "-c", DEB, env={**os.environ, "TZ": "UTC"})
        self.assertEqual({line.split()[3] for line in listed.splitlines()}, {"1980-01-01"})
        self.assertEqual({line.split()[1] for line in listed.splitlines()}, {"root/root"})

    def test_no_path_of_this_machine_is_in_them(self):
        files = 0
        for name, data in contents():
            files += 1
            for path in (SOURCE, BUILD, pathlib.Path.home()):
                if len(path.parts) > 2:
                    self.assertNotIn(f"{path}/".encode(), data, name)
        self.assertGreater(files, 50)

    def test_the_program_is_of_the_baseline_or_the_version_says_what_it_is_of(self):
        code = run("objdump", "-d", "--no-show-raw-insn", BUNDLE / "bin" / "paperbake")
        self.assertGreater(len(code), 1e7)
        beyond = BEYOND_BASELINE.search(code)
        if "+" in VERSION:
            self.assertTrue(beyond, f"version {VERSION} of a program for any processor")
        else:
            self.assertIsNone(beyond, f"version {VERSION}: {beyond}")

    def test_program_and_libraries_run_on_the_oldest_processor(self):
        """Nehalem, the first of x86-64-v2, as qemu plays it. A build for newer ones does not."""
        emulator = shutil.which("qemu-x86_64")
        self.assertTrue(emulator, "qemu-x86_64 is missing: packages.txt, [packages]")
        done = subprocess.run(
            [emulator, "-cpu", "Nehalem", BUNDLE / "bin" / "paperbake", "bake",
             SOURCE / "samples" / "S1_push.glb", "-o", FOLDER / "nehalem", "--quality", "draft",
             "--frames", "1-12", "--map-size", "64"], capture_output=True, text=True, check=False)
        if "+" in VERSION:
            self.assertEqual(done.returncode, -signal.SIGILL, done.stderr)
        else:
            self.assertEqual(done.returncode, 0, done.stderr)
            self.assertGreater((FOLDER / "nehalem" / "S1_push.abc").stat().st_size, 1e5)

    def test_every_library_is_in_them_with_its_terms(self):
        needed = {name for name in libraries_of(PROGRAM) if name not in SYSTEM}
        self.assertGreater(len(needed), 10)
        table = (BUNDLE / "libraries.txt").read_text().splitlines()
        package = dict(line.split()[:2] for line in table)
        with zipfile.ZipFile(ZIP) as archive:
            names = set(archive.namelist())
        with zipfile.ZipFile(the_wheel()) as archive:
            in_wheel = set(archive.namelist())
        for name in needed:
            self.assertIn(f"bundled/lib/{name}", names)
            self.assertIn(f"paperbake/bundled/lib/{name}", in_wheel)
            self.assertIn(f"bundled/licenses/{package[name]}", names)
            self.assertIn(f"paperbake-{VERSION}.dist-info/licenses/{package[name]}", in_wheel)
        self.assertIn("bundled/licenses/libcgal-dev", names)

    def test_the_deb_asks_for_the_packages_of_its_libraries(self):
        asked = run("dpkg-deb", "-f", DEB, "Depends")
        for package in ("libc6 (>=", "libcholmod3", "libopenexr-3-1-30", "libopenblas0-pthread"):
            self.assertIn(package, asked)
        self.assertNotIn("-dev", asked)
        files = {path.relative_to(unpacked_deb()).as_posix() for path in unpacked_deb().rglob("*")
                 if path.is_file()}
        terms = {path for path in files if path.startswith("usr/share/doc/paperbake/")}
        self.assertIn("usr/share/doc/paperbake/copyright", terms)
        self.assertEqual(files - terms, {"usr/bin/paperbake"})


if __name__ == "__main__":
    new_folder()
    for package in (DEB, ZIP, the_wheel()):
        print(f"{package.stat().st_size / 1e6:6.1f} MB  {package.relative_to(DIST)}")
    installed = sum(path.stat().st_size for path in BUNDLE.rglob("*") if path.is_file())
    print(f"{installed / 1e6:6.1f} MB  of zip and wheel when they are installed")
    unittest.main(argv=sys.argv[:1])
