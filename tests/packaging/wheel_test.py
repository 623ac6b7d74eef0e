"""Tests the wheel: pip installs it into a new environment, where it is used with an empty PATH and
with neither our libraries nor the build in sight; and mypy reads its types.

    wheel_test.py SOURCE BUILD VERSION FOLDER
"""

import os
import re
import shutil
import subprocess
import sys
import unittest

from bare_machine import (DIST, FOLDER, PROGRAM, SOURCE, VERSION, new_folder, strangers, the_wheel,
                          without_packages)

ENVIRONMENT = FOLDER / "environment"
PYTHON = ENVIRONMENT / "bin" / "python"
SCENE = FOLDER / "S1_push.glb"
BAKE = ["bake", SCENE, "--quality", "draft", "--frames", "1-12", "--map-size", "64", "-o"]
HERE = SOURCE / "tests" / "packaging"


def run(*command, **settings):
    return subprocess.run(command, capture_output=True, text=True, check=False, **settings)


def folder_of_package():
    (folder,) = ENVIRONMENT.glob("lib/python3*/site-packages/paperbake")
    return folder


class Wheel(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        subprocess.run([sys.executable, "-m", "venv", ENVIRONMENT], check=True)
        subprocess.run([PYTHON, "-m", "pip", "install", "--quiet", "--no-index", "--no-deps",
                        "--disable-pip-version-check", the_wheel()], check=True)
        shutil.copyfile(SOURCE / "samples" / SCENE.name, SCENE)
        cls.bare = without_packages(str(PYTHON), "json")

    def bare_run(self, *command):
        return run(*self.bare, *command, env={"PATH": "", "HOME": str(FOLDER)}, cwd=FOLDER)

    def test_the_command_bakes_the_bytes_that_the_build_bakes(self):
        done = self.bare_run(ENVIRONMENT / "bin" / "paperbake", *BAKE, "wheel")
        self.assertEqual(done.returncode, 0, done.stderr)
        built = run(PROGRAM, *BAKE, FOLDER / "build")
        self.assertEqual(built.returncode, 0, built.stderr)
        for name in ("S1_push.abc", "maps/S1_push.final.exr", "singular.csv"):
            self.assertEqual((FOLDER / "wheel" / name).read_bytes(),
                             (FOLDER / "build" / name).read_bytes(), name)
        self.assertGreater((FOLDER / "wheel" / "S1_push.abc").stat().st_size, 1e5)

    def test_the_command_hands_on_what_the_program_says(self):
        for words in ([ENVIRONMENT / "bin" / "paperbake"], [PYTHON, "-m", "paperbake"]):
            said = self.bare_run(*words, "--version")
            self.assertEqual(said.stdout.splitlines()[0], f"paperbake {VERSION.split('+')[0]}")
            failed = self.bare_run(*words, "bake", "nowhere.glb", "-o", "none")
            self.assertEqual(failed.returncode, 3)
            self.assertIn("nowhere.glb", failed.stderr)

    def test_the_program_brings_its_libraries(self):
        folder = folder_of_package() / "bundled"
        self.assertEqual(strangers(folder / "bin" / "paperbake", folder), {})

    def test_the_tag_is_that_of_the_newest_symbol_of_glibc(self):
        tag = r".*-py3-none-manylinux_2_(\d+)_x86_64[.]whl"
        (minor,) = re.fullmatch(tag, the_wheel().name).groups()
        asked = set()
        for path in (folder_of_package() / "bundled").rglob("*"):
            if path.parent.name in ("bin", "lib"):
                needs = run("readelf", "--version-info", "--wide", path).stdout
                asked |= {int(found) for found in re.findall(r"Name: GLIBC_2[.](\d+)", needs)}
        self.assertGreater(len(asked), 10)
        self.assertEqual(max(asked), int(minor))

    def test_python_bakes(self):
        """wheel_user.py, in the environment."""
        done = self.bare_run(PYTHON, "-B", HERE / "wheel_user.py", FOLDER / "user", SCENE)
        print(done.stderr)
        self.assertEqual(done.returncode, 0)
        self.assertRegex(done.stderr, r"Ran \d\d+ tests")

    def test_mypy_reads_its_types(self):
        mypy = shutil.which("mypy")
        self.assertTrue(mypy, "mypy is missing: packages.txt, [packages]")
        words = [mypy, "--strict", f"--cache-dir={FOLDER / 'mypy'}"]
        inside = run(*words, "--python-version=3.9", "-p", "paperbake",
                     cwd=SOURCE / "baker" / "python")
        self.assertEqual(inside.returncode, 0, inside.stdout)
        typed = run(*words, f"--python-executable={PYTHON}", HERE / "typed_user.py", cwd=FOLDER)
        wanted = {int(line.split(":")[0]): line.split("# ")[1]
                  for line in numbered(HERE / "typed_user.py") if "# " in line}
        self.assertEqual(len(wanted), 6)
        for number, text in wanted.items():
            self.assertRegex(typed.stdout, f"typed_user.py:{number}: .*{re.escape(text)}")
        self.assertEqual(len(re.findall(": error:", typed.stdout)), 2, typed.stdout)


def numbered(path):
    return [f"{number}:{line}" for number, line in enumerate(path.read_text().splitlines(), 1)]


if __name__ == "__main__":
    new_folder()
    print(the_wheel().relative_to(DIST))
    os.environ.pop("LD_LIBRARY_PATH", None)
    unittest.main(argv=sys.argv[:1])
