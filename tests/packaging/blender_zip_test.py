"""Tests the zip for Blender in Blender itself (PyPI: bpy), as on a machine where nothing of ours is
installed: an empty PATH, and neither our libraries nor the build in sight.

    blender_zip_test.py SOURCE BUILD VERSION FOLDER
"""

import os
import subprocess
import sys

from bare_machine import FOLDER, SOURCE, ZIP, new_folder, strangers, without_packages

INSIDE = "inside"  # the fifth word: this process is the one that sees nothing of ours


def judge_program(judgement, program):
    """Found is the one that came with the zip, it can be run, and it brings its libraries."""
    judgement.check(program.startswith(f"{FOLDER}/blender/user/"), f"the program is {program}")
    judgement.check(os.access(program, os.X_OK), "the program may not be run")
    folder = os.path.dirname(os.path.dirname(program))
    found = strangers(program, folder)
    judgement.check(not found, f"libraries from elsewhere: {found}")
    judgement.count("libraries", len(os.listdir(f"{folder}/lib")))


def judge_bake(judgement, bpy, fixture):
    """Marked, baked with a grade of the program's own, and loaded: the paper moves. What a script
    that starts Blender puts on the loader's path does not reach the program."""
    (FOLDER / "wrong").mkdir()
    (FOLDER / "wrong" / "libstdc++.so.6").write_text("no library", encoding="utf-8")
    os.environ["LD_LIBRARY_PATH"] = str(FOLDER / "wrong")
    scene, sheet = fixture.new_scene("letter")
    fixture.mark_and_hold(judgement, scene, sheet)
    sheet["paper_preset"] = "copy90"
    result, said = fixture.report(bpy.ops.paperbake.bake)
    frames = fixture.LAST - fixture.FIRST + 1
    judgement.check(result == {"FINISHED"} and f"Baked {frames} frames" in said, f"it says {said}")
    if judgement.failures:
        return
    ends = []
    for frame in (fixture.FIRST, fixture.LAST):
        scene.frame_set(frame)
        paper = scene.objects["baked.paper.Letter"]
        mesh = paper.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        ends.append([tuple(vertex.co) for vertex in mesh.vertices])
    moved = max(abs(a - b) for first, last in zip(*ends) for a, b in zip(first, last))
    judgement.check(len(ends[0]) > 100 and moved > 0.005, f"{len(ends[0])} vertices move {moved} m")
    page = FOLDER / "blender" / "letter" / "paperbake" / "report.html"
    judgement.check(page.stat().st_size > 1e6, "the page has no libraries in it")
    judgement.count("vertices", len(ends[0]))


def judge_message(judgement, bpy, fixture):
    """Two corners pulled apart by a tenth: loaded, and the panel says why before it says what was
    missed, as the program of the zip words it. The draft says that it is one."""
    scene, sheet = fixture.new_scene("apart")
    fixture.select(sheet)
    with fixture.heard():
        bpy.ops.paperbake.mark_sheet()
    for u in (-0.5, 0.5):
        ends = fixture.place(sheet, u, 0.5), fixture.place(sheet, 1.1 * u, 0.5)
        fixture.key(fixture.empty("handle", (0, 0, 0)), "location", *ends)
    result, said = fixture.report(bpy.ops.paperbake.draft)
    context = fixture.types.SimpleNamespace(scene=scene, object=None)
    shown = " ".join(fixture.panels(context).texts)
    lines = bpy.data.texts["Paperbake"].as_string().splitlines()
    missed = lines.index("Baked, but less well than asked for:")
    judgement.check(result == {"FINISHED"} and "WARNING" not in lines[0], f"it says {said}")
    judgement.check(missed > 0 and all("handle" in line for line in lines[:missed]),
                    f"the reason is not the first: {lines}")
    judgement.check("a handle is off by" in lines[missed + 1], f"no gate is told: {lines}")
    judgement.check("attempt " not in "".join(lines[:missed + 2]), f"attempts come first: {lines}")
    judgement.check(fixture.part("job").DRAFT_TOLD in lines, f"no word of a draft: {lines}")
    judgement.check(shown.index(lines[0][:20]) < shown.index("less well than"),
                    f"the panel shows {shown}")
    judgement.count("messages", len(lines))


def judge_other_program(judgement, bpy, fixture):
    """The preferences still choose another one."""
    fixture.use(FOLDER / "nowhere")
    result, said = fixture.report(bpy.ops.paperbake.bake)
    judgement.check(result == {"CANCELLED"} and "nowhere is not there" in said, f"it says {said}")
    fixture.use("")
    judgement.count("choices", 1)


def inside():
    sys.path.insert(0, str(SOURCE / "tests" / "interop"))
    sys.argv[1:4] = [str(ZIP), str(FOLDER), str(FOLDER / "blender")]  # the words of the fixture
    import addon_fixture as fixture
    import bpy
    from judgement import Judgement

    judgement = Judgement()
    with fixture.heard():
        bpy.ops.wm.read_factory_settings()
        bpy.ops.extensions.package_install_files(filepath=str(ZIP), repo="user_default",
                                                 enable_on_install=True)
    enabled = fixture.MODULE in bpy.context.preferences.addons
    if judgement.check(enabled, "Blender does not enable the add-on"):
        judge_program(judgement, fixture.part("program").located(""))
        judge_bake(judgement, bpy, fixture)
        judge_message(judgement, bpy, fixture)
        judge_other_program(judgement, bpy, fixture)
    name = f"Blender {bpy.app.version_string}"
    return judgement.conclude(name, ("libraries", "vertices", "messages", "choices"))


def main():
    new_folder()
    words = without_packages(sys.executable, "bpy")
    command = [*words, sys.executable, "-B", __file__, *sys.argv[1:], INSIDE]
    return subprocess.run(command, env={"PATH": "", "HOME": str(FOLDER)}, check=False).returncode


if __name__ == "__main__":
    sys.exit(inside() if sys.argv[5:] == [INSIDE] else main())
