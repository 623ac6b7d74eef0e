"""Tests the .deb, and the program that is in the zip for Blender, in a minimal Debian 12 without
build tools, which debootstrap makes.

    deb_test.py SOURCE BUILD VERSION FOLDER

Needs root, debootstrap and Debian's archive; says so and is skipped where one of them is missing.
"""

import os
import shutil
import subprocess
import sys
import unittest
import zipfile

from bare_machine import BUILD, DEB, FOLDER, PROGRAM, SOURCE, ZIP, new_folder, skip

ROOT = FOLDER / "debian"
DEBS = BUILD / "packages_test" / "debs"  # what debootstrap has downloaded, for the next time
SCENES = ("S1_push.glb", "S5_roll.fbx")
BAKE = ["--quality", "draft", "--frames", "1-12", "--map-size", "64"]
FILES = ("{}.abc", "maps/{}.final.exr", "singular.csv", "job.lock.toml")
BUILD_TOOLS = ("cc", "c++", "gcc", "g++", "ld", "as", "make", "cmake", "ninja", "python3")
IN_ROOT = 'mount -t proc proc "$0/proc" && exec chroot "$0" "$@"'


def mirror():
    """Debian's archive, as apt of this machine knows it; none: debootstrap knows one itself."""
    known = subprocess.run(["apt-get", "indextargets", "--format", "$(REPO_URI) $(RELEASE)",
                            "Created-By: Packages"], capture_output=True, text=True, check=False)
    found = [line.split()[0] for line in known.stdout.splitlines() if line.endswith(" bookworm")]
    return found[:1]


def make_debian():
    """Skips the test where it is not possible."""
    if os.geteuid() != 0:
        skip("only root may make a Debian system")
    for program in ("debootstrap", "unshare", "chroot"):
        if not shutil.which(program):
            skip(f"{program} is missing: packages.txt, [packages]")
    mounts = ["unshare", "--mount", "mount", "-t", "tmpfs", "none", FOLDER]
    if subprocess.run(mounts, capture_output=True, check=False).returncode != 0:
        skip("mounts are not permitted here")
    DEBS.mkdir(parents=True, exist_ok=True)
    made = subprocess.run(["debootstrap", "--variant=minbase", f"--cache-dir={DEBS}", "bookworm",
                           ROOT, *mirror()], capture_output=True, text=True, check=False)
    if made.returncode != 0:
        skip("debootstrap made no Debian system:\n" + made.stdout[-1500:] + made.stderr[-500:])


def in_debian(*command):
    """Runs it there, with nothing of this machine's environment."""
    environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root", "LC_ALL": "C",
                   "DEBIAN_FRONTEND": "noninteractive"}
    words = [shutil.which("unshare"), "--mount", "--pid", "--fork", "/bin/sh", "-c", IN_ROOT, ROOT]
    return subprocess.run([*words, *command], env=environment, capture_output=True, text=True,
                          check=False)


def bake_here(scene):
    """What the program of the build writes. Returns {name: bytes}."""
    folder = FOLDER / "build"
    command = [PROGRAM, "bake", ROOT / scene, "-o", folder / scene, *BAKE]
    subprocess.run(command, check=True, capture_output=True)
    return files_of(folder / scene, scene)


def files_of(folder, scene):
    return {name: (folder / name.format(scene.split(".")[0])).read_bytes() for name in FILES}


class Debian(unittest.TestCase):
    """In the order of the names: first the bundle, where nothing is installed, then the .deb."""

    @classmethod
    def setUpClass(cls):
        for scene in SCENES:
            shutil.copyfile(SOURCE / "samples" / scene, ROOT / scene)
        cls.baked_here = {scene: bake_here(scene) for scene in SCENES}

    def bakes_the_same(self, program, out):
        for scene in SCENES:
            done = in_debian(program, "bake", f"/{scene}", "-o", f"/{out}/{scene}", *BAKE)
            self.assertEqual(done.returncode, 0, done.stderr)
            for name, data in files_of(ROOT / out / scene, scene).items():
                self.assertEqual(self.baked_here[scene][name], data, f"{scene}: {name}")
            self.assertGreater(len(data), 1000)

    def test_1_there_is_no_build_tool(self):
        for tool in BUILD_TOOLS:
            self.assertNotEqual(in_debian("which", tool).returncode, 0, tool)
        self.assertEqual(in_debian("which", "dpkg").returncode, 0)

    def test_2_the_bundle_bakes_where_nothing_is_installed(self):
        with zipfile.ZipFile(ZIP) as archive:
            archive.extractall(ROOT / "addon")
        program = ROOT / "addon" / "bundled" / "bin" / "paperbake"
        program.chmod(0o755)
        self.bakes_the_same(f"/{program.relative_to(ROOT)}", "bundle")

    def test_3_the_deb_is_installed_and_bakes(self):
        shutil.copyfile(DEB, ROOT / DEB.name)
        apt = ["apt-get", "install", "-y", "-q", "--no-install-recommends", f"/{DEB.name}"]
        done = in_debian(*apt)
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.bakes_the_same("paperbake", "deb")
        blas = os.readlink(ROOT / "etc/alternatives/libblas.so.3-x86_64-linux-gnu")
        self.assertIn("openblas-pthread", blas)
        for tool in BUILD_TOOLS:
            self.assertNotEqual(in_debian("which", tool).returncode, 0, f"it brings {tool}")

    def test_4_the_deb_goes_without_a_trace(self):
        done = in_debian("apt-get", "purge", "-y", "-q", "paperbake")
        self.assertEqual(done.returncode, 0, done.stdout + done.stderr)
        self.assertNotEqual(in_debian("which", "paperbake").returncode, 0)
        self.assertFalse((ROOT / "usr/share/doc/paperbake").exists())


if __name__ == "__main__":
    new_folder()
    make_debian()
    test = unittest.main(argv=sys.argv[:1], exit=False)
    shutil.rmtree(ROOT)
    sys.exit(not test.result.wasSuccessful())
