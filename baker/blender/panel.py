"""The panel: View3D > Sidebar > Paper."""

import textwrap

import bpy

from . import baking, messages, names, properties, scene_export

MESSAGE_WIDTH = 42  # letters a line
PICTURE_SCALE = 5  # of an icon: a grade's picture
COLLIDER_TEXT = "Solid where it is closed; its motion, bones and shape keys are followed."


class Panel:
    bl_space_type, bl_region_type, bl_category = "VIEW_3D", "UI", "Paper"


class SheetPanel(Panel, bpy.types.Panel):
    bl_idname, bl_label = "PAPERBAKE_PT_sheet", "Sheet and Handles"

    def draw(self, context):
        column = self.layout.column(align=True)
        column.operator("paperbake.mark_sheet", icon="MESH_PLANE")
        column.operator("paperbake.add_handles", icon="EMPTY_AXIS")
        column.operator("paperbake.mark_handles", icon="PINNED")
        column.operator("paperbake.mark_collider", icon="MESH_CUBE")
        column.operator("paperbake.mark_creases", icon="MOD_BEVEL")
        column.operator("paperbake.mark_wind", icon="FORCE_WIND")
        column.operator("paperbake.unmark", icon="X")
        counts = {role: len(names.of_role(context.scene, role)) for role in names.ROLES}
        self.layout.label(text=f"{counts[names.SHEET]} sheet(s), {counts[names.HANDLE]} handle(s), {counts[names.COLLIDER]} collider(s), {counts[names.CREASE]} crease(s), {counts[names.WIND]} wind(s)")
        thing = context.object
        role = names.role(thing) if thing else None
        if role == names.SHEET:
            self.draw_sheet(thing)
        elif role == names.HANDLE:
            self.draw_handle(thing)
        elif role == names.CREASE:
            box = self.layout.box()
            box.label(text=thing.name, icon="MOD_BEVEL")
            if "paper_crease" in thing:
                box.prop(thing, '["paper_crease"]', text="Rest angle")
        elif role == names.COLLIDER:
            self.draw_collider(context.scene, thing)
        elif role == names.WIND:
            box = self.layout.box()
            box.label(text=thing.name, icon="FORCE_WIND")
            for key, (label, _) in properties.WIND.items():
                if key in thing:
                    box.prop(thing, f'["{key}"]', text=label)

    def draw_sheet(self, thing):
        box = self.layout.box()
        box.label(text=thing.name, icon="MESH_PLANE")
        large = names.is_large(bpy.context.scene, thing)
        box.label(text=names.size_text(bpy.context.scene, thing) + (": paper that large?" if large else ""), icon="ERROR" if large else "NONE")
        box.prop(thing.paperbake, "preset")
        picture = properties.picture_of(thing.paperbake.preset)
        if picture:
            box.template_icon(icon_value=picture, scale=PICTURE_SCALE)
        box.prop(thing.paperbake, "seed")

    def draw_collider(self, scene, thing):
        box = self.layout.box()
        box.label(text=thing.name, icon="MESH_CUBE")
        for line in textwrap.wrap(scene_export.not_followed(thing, not scene_export.has_shapes(scene)) or COLLIDER_TEXT, MESSAGE_WIDTH):
            box.label(text=line)

    def draw_handle(self, thing):
        box = self.layout.box()
        box.label(text=thing.name, icon="PINNED")
        box.prop(thing.paperbake, "mode")
        for key, (label, without, _) in properties.SETTINGS.items():
            row = box.row(align=True)
            if key in thing:
                row.prop(thing, f'["{key}"]', text=label)
            else:
                row.label(text=f"{label}: {without}")
            change = row.operator("paperbake.set_handle", text="", icon="X" if key in thing else "ADD")
            change.name, change.remove = key, key in thing
        box.operator("paperbake.copy_to_handles", icon="DUPLICATE")


class BakePanel(Panel, bpy.types.Panel):
    bl_idname, bl_label = "PAPERBAKE_PT_bake", "Bake"

    def draw(self, context):
        layout, settings = self.layout, context.scene.paperbake
        layout.use_property_split, layout.use_property_decorate = True, False
        for name in ("quality", "method", "gravity", "folder", "options", "own_frames"):
            layout.prop(settings, name)
            if name == "gravity" and not settings.gravity:
                value, origin = scene_export.gravity_of(context.scene)
                if value:
                    layout.label(text=f"{value:g} m/s\u00b2, from {origin}")
        if settings.own_frames:
            column = layout.column(align=True)
            column.prop(settings, "first")
            column.prop(settings, "last")
        if baking.running:
            layout.progress(factor=baking.running.fraction(), text=baking.running.text())
            layout.operator("paperbake.cancel", icon="CANCEL")
        else:
            layout.operator("paperbake.bake", icon="RENDER_ANIMATION")
            layout.operator("paperbake.draft", icon="PLAY")
            layout.operator("paperbake.delete_cache", icon="TRASH")
        self.draw_outcome(layout)

    def draw_outcome(self, layout):
        if baking.last is None or baking.running:
            return
        outcome, page, box = baking.last.outcome, baking.last.report(), layout.box()
        for i, line in enumerate(textwrap.wrap(outcome.sentence, MESSAGE_WIDTH)):
            box.label(text=line, icon=("NONE" if i else outcome.level if outcome.level != "WARNING" else "ERROR"))
        box.label(text=f"Text block: {messages.NAME}", icon="TEXT")
        if page:
            box.operator("wm.url_open", text="Report", icon="URL").url = page.as_uri()


CLASSES = (SheetPanel, BakePanel)
