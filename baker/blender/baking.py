"""Operators that start and stop a bake. In a window a timer steps the job and nothing waits; without one (a script, `blender -b`)
the operator returns when all is done."""

import bpy

from . import cache, properties
from .job import DRAFT, BakeJob, folder_of
from .program import Unusable

TICK = 0.1  # [s]

running = None  # the BakeJob of the window; one at a time
last = None     # the BakeJob that ended


def tell(operator, job):
    """The end of a job as the operator's report. Returns what the operator returns."""
    global last
    last = job
    operator.report({job.outcome.level}, job.outcome.sentence)
    return {"FINISHED"} if job.loaded else {"CANCELLED"}


def redraw():
    for window in bpy.context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "VIEW_3D":
                area.tag_redraw()


class Runs:
    """What operators have in common that bake: a timer in the window, or all at once without one."""

    @classmethod
    def poll(cls, context):
        return running is None

    def new_job(self, context):
        return BakeJob(context.scene, context.scene.paperbake, properties.program_path())

    def execute(self, context):
        job = self.new_job(context)
        job.run()
        return tell(self, job)

    def invoke(self, context, event):
        global running
        running = self.new_job(context)
        self.timer = context.window_manager.event_timer_add(TICK, window=context.window)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        redraw()
        try:
            if running is not None and running.step():
                return {"PASS_THROUGH"}
        except Exception:  # a mistake of ours: Blender shows it, and the next bake can begin
            self.cancel(context)
            raise
        job = self.finish(context)
        if job is None or job.outcome is None:  # abandoned: the add-on goes, or another file comes
            return {"CANCELLED"}
        done = tell(self, job)
        if job.loaded:
            bpy.ops.ed.undo_push(message="Bake Paper")
        return done

    def cancel(self, context):
        """Blender takes the operator away: the window closes, or another file is opened."""
        job = self.finish(context)
        if job:
            job.abandon()

    def finish(self, context):
        global running
        if self.timer:
            context.window_manager.event_timer_remove(self.timer)
            self.timer = None
        job, running = running, None
        return job


class Bake(Runs, bpy.types.Operator):
    """Bake the sheets of this scene, and load what came out in their place"""

    bl_idname, bl_label = "paperbake.bake", "Bake"


class DraftBake(Runs, bpy.types.Operator):
    """Bake a coarse draft of these frames, without maps and report, and show it. The bake before stays in its folder"""

    bl_idname, bl_label = "paperbake.draft", "Draft"

    def new_job(self, context):
        return BakeJob(context.scene, context.scene.paperbake, properties.program_path(), is_draft=True)


class DeleteCache(bpy.types.Operator):
    """Take the baked paper out of the scene, show its sheets again, and delete the files of its bakes. The files cannot be brought back"""

    bl_idname, bl_label, bl_options = "paperbake.delete_cache", "Delete Cache", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return running is None

    def invoke(self, context, event):
        return context.window_manager.invoke_confirm(self, event)

    def execute(self, context):
        try:
            folder = folder_of(context.scene.paperbake)
        except Unusable as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        removed = cache.remove(context.scene)
        files = sum(cache.delete_files(place) for place in (folder / DRAFT, folder))
        self.report({"INFO"}, f"{len(removed)} sheet(s) of baked paper removed, {files} file(s) deleted.")
        return {"FINISHED"}


class CancelBake(bpy.types.Operator):
    """Stop the bake after its frame; its files then end there, and the next bake goes on"""

    bl_idname, bl_label = "paperbake.cancel", "Cancel"

    @classmethod
    def poll(cls, context):
        return running is not None

    def execute(self, context):
        running.cancel()
        return {"FINISHED"}


def abandon():
    global running
    if running:
        running.abandon()
        running = None


CLASSES = (Bake, DraftBake, DeleteCache, CancelBake)
