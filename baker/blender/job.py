"""A bake from the scene to the scene: export, the program, load. A plain class: a timer steps it in the window, a loop elsewhere."""

import json
import os
import pathlib
import shlex
import time

import bpy

from . import attributes, cache, messages, names, program, scene_export

EXPORT, BAKE, LOAD, DONE = range(4)
DRAFT = "draft"  # folder of drafts, in that of the bakes
DRAFT_WORDS = ["--quality", "draft", "--method", "hybrid", "--attempts", "1", "--formats", "abc,cert"]  # given last, they count
DRAFT_TOLD = "A draft makes one attempt. Bake tries others where a handle is off by more than 1 mm or the paper crumples or its mesh puts it off, and may come out otherwise."
CHANGING_MESH = "With --mesh simulation, vertex groups, colours and attributes of the sheets are right in the first frame alone."
OWN_WORDS = {"-o", "--output", "--name", "--formats", "--progress", "--write-job", "--dry-run"}  # without which nothing would be loaded


def folder_of(settings):
    """Where the bake goes. Throws Unusable."""
    if settings.folder.startswith("//") and not bpy.data.filepath:
        raise program.Unusable("Save the .blend first, or choose an output folder that does not begin with //.")
    return pathlib.Path(bpy.path.abspath(settings.folder)).resolve()


def stamp(path):
    """Changes with every file of this name; None: there is none."""
    try:
        found = path.stat()
        return found.st_ino, found.st_mtime_ns
    except FileNotFoundError:
        return None


def stem():
    return pathlib.Path(bpy.data.filepath).stem or "paper"


def options(scene, settings):
    """Words of the command line. Grade and seed are properties of the sheets and travel in the file."""
    first, last = (settings.first, settings.last) if settings.own_frames else (scene.frame_start, scene.frame_end)
    if not scene.frame_start <= first <= last:
        raise program.Unusable(f"Frames {first} to {last} cannot be baked: the scene begins at {scene.frame_start}.")
    words = ["--quality", settings.quality, "--method", settings.method, "--frames", f"{first}-{last}"]
    if settings.gravity:  # where the panel says none, that of the objects counts
        words += ["--gravity", f"{settings.gravity:g}"]
    words += further(settings.options)
    if abs(scene.unit_settings.scale_length - 1) > 1e-9:
        words += ["--unit-scale", f"{scene.unit_settings.scale_length:.9g}"]
    return words


def formats(scene, is_draft):
    """Words of the command line: USD is for what Blender does not read of Alembic."""
    if not any(attributes.carried(sheet) for sheet in names.of_role(scene, names.SHEET)):
        return []
    return ["--formats", "abc,cert,usdc" if is_draft else "abc,maps,cert,report,usdc"]


def further(text):
    """Words of the panel's field Options. Throws Unusable."""
    try:
        words = shlex.split(text)
    except ValueError as error:
        raise program.Unusable(f"Options: a quotation mark is not closed in {text}") from error
    taken = OWN_WORDS & {word.split("=")[0] for word in words}
    if taken:
        raise program.Unusable(f"Options: {sorted(taken)[0]} is what the add-on itself says. Take it out.")
    return words


class BakeJob:
    """One bake of a scene.

    step()    goes on with it and returns at once, but for export and load; False when it has ended, and then `outcome` says how
    cancel()  ends it at the next step
    """

    def __init__(self, scene, settings, path, is_draft=False):
        """settings: properties.SceneSettings; path: of the program, empty: on PATH; is_draft: coarse and only to be looked at"""
        self._is_draft = is_draft
        self._scene, self._settings, self._path = scene.name, settings, path
        self._state, self._process, self._before = EXPORT, None, None
        self._folder = self._stem = None
        self._remarks = []
        self.outcome, self.loaded = None, []

    def fraction(self):
        return self._process.fraction if self._process else 0.0

    def report(self):
        """Its page to look at, None when it has none."""
        page = self._folder / "report.html" if self._folder else None
        return page if page and page.exists() else None

    def text(self):
        if self._state == EXPORT:
            return "Writing the scene"
        return program.progress_text(self._process) if self._state == BAKE else "Loading the cache"

    def cancel(self):
        if self._process:
            self._process.cancel()

    def abandon(self):
        """The end without more steps: Blender closes, or opens another file."""
        if self._process:
            self._process.end()
        self._state = DONE

    def run(self):
        """To the end, without a window."""
        while self.step():
            time.sleep(0.02)
        return self.outcome

    def step(self):
        try:
            {EXPORT: self._export, BAKE: self._bake, LOAD: self._load}.get(self._state, lambda: None)()
        except program.Unusable as error:
            self._end(program.Outcome("ERROR", str(error), False))
        except OSError as error:
            self._end(program.Outcome("ERROR", f"{error.filename}: {error.strerror}.", False))
        return self._state != DONE

    def _end(self, outcome):
        self.outcome, self._state = outcome, DONE
        messages.write(outcome.told or [outcome.sentence])

    def _export(self):
        scene = self._in_scene()
        found, self._folder, self._stem = program.located(self._path), folder_of(self._settings), stem()
        words = options(scene, self._settings)
        if self._is_draft:  # beside the bake, which stays
            self._folder = self._folder / DRAFT
            words += DRAFT_WORDS
        for_attributes = formats(scene, self._is_draft)
        words += for_attributes
        os.makedirs(self._folder, exist_ok=True)
        path = self._folder / f"{self._stem}.glb"
        last = max(scene.frame_end, self._settings.last) if self._settings.own_frames else scene.frame_end
        scene_export.write(scene, os.fspath(path), last)
        self._before = stamp(self._cache()), stamp(self._certificate())
        self._remarks = scene_export.remarks(scene)
        if for_attributes and "simulation" in words:
            self._remarks.append(CHANGING_MESH)
        self._process = program.Process([found, "bake", os.fspath(path), "-o", os.fspath(self._folder), "--progress", "json", *words])
        self._state = BAKE

    def _bake(self):
        code = self._process.poll()
        if code is None:
            return
        done = code in (0, program.GATE_MISSED)  # also when it had nothing to do: then what is there is the result
        fresh = done or all(now and now != then for now, then in zip((stamp(self._cache()), stamp(self._certificate())), self._before))
        self._end(program.outcome(code, self._process, self._summary() if fresh else {}, fresh))
        if self._is_draft and code == program.GATE_MISSED:
            self._remarks.append(DRAFT_TOLD)
        if self.outcome.loads:
            self._state = LOAD

    def _load(self):
        loaded, remarks = cache.load(self._in_scene(), self._folder, self._stem, self._summary())
        remarks = [*self._remarks, *remarks]
        self.loaded = [thing.name for thing in loaded]
        if remarks:
            level = "ERROR" if self.outcome.level == "ERROR" else "WARNING"
            self.outcome = program.Outcome(level, " ".join([self.outcome.sentence, *remarks]), True, (*self.outcome.told, *remarks))
        self._state = DONE
        messages.write(self.outcome.told or [self.outcome.sentence])

    def _in_scene(self):
        """By name: an undo on the way makes every reference to Blender's data a stray one."""
        scene = bpy.data.scenes.get(self._scene)
        if scene is None:
            raise program.Unusable(f"The scene {self._scene} is gone.")
        return scene

    def _cache(self):
        return self._folder / f"{self._stem}.abc"

    def _certificate(self):
        return self._folder / "cert" / "summary.json"

    def _summary(self):
        return json.loads(self._certificate().read_text(encoding="utf-8"))
