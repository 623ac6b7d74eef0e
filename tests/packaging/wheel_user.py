"""Tests `import paperbake` where its wheel is installed.

    wheel_user.py FOLDER SCENE      FOLDER: for everything that is written
"""

import contextlib
import importlib.metadata
import itertools
import json
import os
import pathlib
import pickle
import re
import shutil
import signal
import subprocess
import sys
import time
import unittest
from unittest import mock

import paperbake

FOLDER, SCENE = map(pathlib.Path, sys.argv[1:3])
FRAMES = 12
DRAFT = {"quality": "draft", "frames": f"1-{FRAMES}", "map_size": 64}
LONG = {"quality": "draft", "frames": "1-3000", "map_size": 64, "formats": ["abc", "cert"]}


def frames_in(folder):
    lines = (folder / "cert" / "frames.jsonl").read_text(encoding="utf-8").splitlines()
    return [json.loads(line)["frame"] for line in lines]


def standing_in(name, *lines):
    """A program that does this and nothing else; for mock.patch."""
    path = FOLDER / name
    path.write_text("\n".join(["#!/bin/sh", *lines, ""]), encoding="utf-8")
    path.chmod(0o755)
    return mock.patch("paperbake.baking.program", lambda: str(path))


def children():
    """Processes that this one has started and that still run."""
    return pathlib.Path(f"/proc/self/task/{os.getpid()}/children").read_text().split()


class Baking(unittest.TestCase):
    def test_every_frame_is_told_as_it_is_simulated_and_then_as_it_is_rendered(self):
        told = []
        summary = paperbake.bake_and_wait(SCENE, FOLDER / "told", told.append, **DRAFT)
        self.assertEqual([(record.stage, record.frame, record.done) for record in told],
                         [(stage, frame, frame) for stage in ("simulated", "rendered")
                          for frame in range(1, FRAMES + 1)])
        self.assertEqual({(record.sheet, record.frames) for record in told}, {("paper", FRAMES)})
        self.assertIn("frame rate", told[0].messages[0])
        self.assertFalse(any(record.messages for record in told[1:]))
        self.assertGreater(told[-1].triangles, 1000)
        self.assertEqual(told[-1].seconds_left, 0)
        self.assertEqual(summary.messages, told[0].messages)

    def test_the_summary_is_that_of_the_certificate(self):
        summary = paperbake.bake_and_wait(SCENE, FOLDER / "summary", **DRAFT)
        written = json.loads((FOLDER / "summary/cert/summary.json").read_text(encoding="utf-8"))
        self.assertEqual(dict(summary), written)
        self.assertEqual((summary["frames"], summary.exit_code), (FRAMES, 0))
        self.assertEqual(summary.gates_missed, ())
        self.assertIn(FOLDER / "summary" / "S1_push.abc", summary.files)
        self.assertTrue(all(file.is_file() for file in summary.files))

    def test_the_page_tells_the_truth(self):
        """Every example of README.md, which is the description of the wheel, runs as it stands."""
        page = importlib.metadata.metadata("paperbake").get_payload()
        examples = re.findall(r"```python\n(.*?)```", page, re.S)
        self.assertEqual(len(examples), 3)
        shutil.copyfile(SCENE, FOLDER / "shot.glb")
        words = {"enough": lambda: True, "print": lambda *said: None}
        with contextlib.chdir(FOLDER):
            for example in examples:
                exec(example, words)
        self.assertEqual(words["summary"]["frames"], 60)
        self.assertEqual(list(words["bake"]), [])  # it was closed

    def test_a_bake_without_a_certificate_has_no_numbers(self):
        summary = paperbake.bake_and_wait(SCENE, FOLDER / "none", **DRAFT, formats="preview")
        self.assertEqual(dict(summary), {})
        self.assertEqual([file.name for file in summary.files][0], "S1_push.preview.png")

    def test_a_missed_gate_is_told_and_is_no_error(self):
        summary = paperbake.bake_and_wait(SCENE, FOLDER / "gate", **DRAFT, max_stretch=1e-7)
        self.assertEqual(summary.exit_code, 4)
        self.assertEqual(list(summary.gates_missed), summary["gates_missed"])
        self.assertIn("an edge is off", summary.gates_missed[0])

    def test_options_are_those_of_the_program(self):
        options = {**DRAFT, "formats": ["cert"], "set": {"friction": 0.4, "apex_scatter": 0.003},
                   "strict": True, "gravity": -1.5, "take": None, "seed": 7}
        settings = paperbake.bake_and_wait(SCENE, FOLDER / "options", **options)["settings"]
        used = {key: settings[key] for key in settings if key.startswith(("bake.", "paper."))}
        wanted = {"bake.gravity": "-1.5", "bake.strict": "true", 'paper."paper".seed': "7",
                  'paper."paper".friction': "0.4", 'paper."paper".apex_scatter': "0.003"}
        self.assertEqual({key: used[key] for key in wanted}, wanted)
        off = paperbake.bake_and_wait(SCENE, FOLDER / "options", **{**options, "strict": False})
        self.assertEqual(off["settings"]["bake.strict"], "false")

    def test_options_that_are_not_for_it_are_refused_at_once(self):
        for name in ("progress", "output", "dry_run", "write_job"):
            with self.subTest(name), self.assertRaisesRegex(TypeError, name):
                paperbake.bake(SCENE, FOLDER / "refused", **dict.fromkeys([name], "x"))

    def test_a_dcc_s_libraries_are_not_for_the_program(self):
        (FOLDER / "wrong").mkdir(parents=True, exist_ok=True)
        (FOLDER / "wrong" / "libstdc++.so.6").write_text("not a library")
        with mock.patch.dict(os.environ, {"LD_LIBRARY_PATH": str(FOLDER / "wrong")}):
            summary = paperbake.bake_and_wait(SCENE, FOLDER / "dcc", **DRAFT)
        self.assertEqual(summary["frames"], FRAMES)


class Failing(unittest.TestCase):
    def expect(self, exit_code, *arguments, **options):
        with self.assertRaises(paperbake.Error) as caught:
            paperbake.bake_and_wait(*arguments, **options)
        error = caught.exception
        self.assertEqual(error.exit_code, exit_code, error)
        return error

    def test_an_error_is_in_the_program_s_own_words(self):
        command = [paperbake.program(), "bake", SCENE, "-o", FOLDER / "error",
                   "--preset", "vellum9"]
        said = subprocess.run(command, capture_output=True, text=True, check=False).stderr
        error = self.expect(2, SCENE, FOLDER / "error", preset="vellum9")
        self.assertEqual(f"paperbake: {error}\n", said)
        self.assertEqual(error.place, 'preset "vellum9"')
        self.assertEqual(error.cause, 'Unknown paper "vellum9".')
        self.assertTrue(error.remedy.startswith("Papers: "))

    def test_place_cause_and_remedy_survive_another_process(self):
        error = self.expect(3, FOLDER / "nowhere.glb", FOLDER / "error")
        self.assertEqual(error.place, str(FOLDER / "nowhere.glb"))
        again = pickle.loads(pickle.dumps(error))
        self.assertEqual((str(again), again.exit_code, again.remedy),
                         (str(error), error.exit_code, error.remedy))

    def test_a_folder_that_is_a_file_is_an_error(self):
        (FOLDER / "a file").write_text("")
        self.assertIn("a file", str(self.expect(6, SCENE, FOLDER / "a file", **DRAFT)))

    def test_an_option_that_is_unknown_is_an_error(self):
        self.assertIn("--qualty", self.expect(2, SCENE, FOLDER / "error", qualty="draft").cause)

    def test_a_program_that_is_killed_says_by_what(self):
        with standing_in("killed", "kill -9 $$"):
            error = self.expect(-9, SCENE, FOLDER / "killed folder")
        self.assertEqual((error.cause, error.remedy),
                         ("It was ended by signal 9.", "Is memory short?"))
        with standing_in("illegal", "kill -4 $$"):
            self.assertIn("processors", self.expect(-4, SCENE, FOLDER / "killed folder").remedy)

    def test_what_else_is_said_before_an_error_is_not_part_of_it(self):
        with standing_in("talks", "echo 'a library: warning' >&2",
                         "printf 'paperbake: here\\n  This.\\n  That.\\n' >&2", "exit 1"):
            error = self.expect(1, SCENE, FOLDER / "talks folder")
        self.assertEqual((error.place, error.cause, error.remedy), ("here", "This.", "That."))


class Stopping(unittest.TestCase):
    def test_closing_stops_the_program_and_keeps_the_frames(self):
        folder = FOLDER / "closed"
        running = paperbake.bake(SCENE, folder, **LONG)
        told = list(itertools.islice(running, 20))
        (program,) = children()
        # Ctrl-C in a terminal must not reach it beside the signal that it gets from Python: two
        # would end it at once
        self.assertNotEqual(os.getsid(int(program)), os.getsid(0))
        running.close()
        self.assertEqual(children(), [])
        kept = frames_in(folder)
        self.assertEqual(kept, list(range(1, len(kept) + 1)))
        self.assertTrue(told[-1].frame <= len(kept) < 3000, (told[-1].frame, len(kept)))
        self.assertEqual((folder / "S1_push.abc").read_bytes()[:6], b"Ogawa\xff")
        again = next(paperbake.bake(SCENE, folder, **{**LONG, "frames": f"1-{len(kept) + 1}"}))
        self.assertIn("are as an earlier bake simulated them", " ".join(again.messages))

    def test_a_ctrl_c_keeps_the_frames(self):
        """As a terminal does it: the signal goes to Python and to all that it has started."""
        folder = FOLDER / "interrupted"
        code = ("import paperbake, sys\n"
                "told = lambda record: print(record.frame, flush=True)\n"
                f"paperbake.bake_and_wait({str(SCENE)!r}, {str(folder)!r}, told, **{LONG!r})\n")
        with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, start_new_session=True) as python:
            for _ in range(20):
                python.stdout.readline()
            os.killpg(python.pid, signal.SIGINT)
            said = python.communicate(timeout=60)[1]
        self.assertIn("KeyboardInterrupt", said)
        self.assertTrue(20 <= len(frames_in(folder)) < 3000)

    def test_a_bake_that_nobody_looks_at_begins_nothing(self):
        paperbake.bake(SCENE, FOLDER / "never", **DRAFT)
        time.sleep(0.2)
        self.assertFalse((FOLDER / "never").exists())


if __name__ == "__main__":
    FOLDER.mkdir(parents=True)
    unittest.main(argv=sys.argv[:1])
