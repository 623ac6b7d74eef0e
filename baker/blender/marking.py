"""Operators that say what an object is to paperbake. They rename it: the name is what the program goes by, in this file and in every
export made without this add-on; Blender's own links, drivers and constraints follow a name. Unmark gives the old name back."""

import math

import bmesh
import bpy

from . import names, properties

HANDLE_SIZE = 0.03  # of the longest side of a sheet: how large a new handle is drawn


def rename(operator, thing, name):
    """False, and why in the report, where Blender lets nobody rename it."""
    if thing.library or thing.override_library:
        operator.report({"ERROR"}, f"{thing.name} is linked from another file and cannot be renamed: make it local first, or mark it there.")
        return False
    thing.name = name
    return True


class MarkSheet(bpy.types.Operator):
    """The active mesh is a sheet of paper. Its outline is the pattern; its shape at the first frame is the start"""

    bl_idname, bl_label, bl_options = "paperbake.mark_sheet", "Mark Sheet", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and context.object.type == "MESH"

    def execute(self, context):
        thing = context.object
        if not thing.data.polygons:
            self.report({"ERROR"}, f"{thing.name} has no faces: a sheet is a flat mesh such as a plane.")
            return {"CANCELLED"}
        was = thing.name
        if not rename(self, thing, names.with_prefix(was, names.SHEET)):
            return {"CANCELLED"}
        said = f"{was} is the sheet {thing.name} now" if was != thing.name else f"{was} is a sheet"
        large = names.is_large(context.scene, thing)
        self.report({"WARNING"} if large else {"INFO"}, f"{said}, {names.size_text(context.scene, thing)}{': is it meant that large?' if large else '.'}")
        return {"FINISHED"}


class MarkHandles(bpy.types.Operator):
    """The selected objects are handles: each holds the sheet point that is nearest to it at the first frame"""

    bl_idname, bl_label, bl_options = "paperbake.mark_handles", "Mark Handles", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(names.role(thing) != names.SHEET for thing in context.selected_objects)

    def execute(self, context):
        marked = [thing for thing in context.selected_objects if names.role(thing) != names.SHEET]
        if not all(rename(self, thing, names.with_prefix(thing.name, names.HANDLE)) for thing in marked):
            return {"CANCELLED"}
        self.report({"INFO"}, f"{len(marked)} handle(s): {', '.join(thing.name for thing in marked)}")
        return {"FINISHED"}


class MarkCollider(bpy.types.Operator):
    """The selected meshes are obstacles"""

    bl_idname, bl_label, bl_options = "paperbake.mark_collider", "Mark Colliders", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(thing.type == "MESH" for thing in context.selected_objects)

    def execute(self, context):
        for thing in context.selected_objects:
            if thing.type == "MESH":
                thing["paper_collider"] = True
        return {"FINISHED"}


MOST = 170  # [degrees] a crease of a larger rest angle is none that the program takes


def crease_angles(mesh, modelled, angle):
    """{rest angle in whole degrees: [(place, place)]} of the selected edges of an edit mesh.

    modelled  each has the angle that it is modelled with: positive where the fold points to the side of the normals
    """
    found = {}
    for edge in mesh.edges:
        if edge.select and len(edge.link_faces) == 2:
            own = math.degrees(edge.calc_face_angle_signed(0.0)) if modelled else angle
            found.setdefault(max(-MOST, min(MOST, round(own))), []).append(tuple(v.co.copy() for v in edge.verts))
    return found


def crease_object(sheet, angle, edges):
    """An object of these edges alone, on the sheet and moving with it. Returns it."""
    mesh = bpy.data.meshes.new(names.CREASE)
    mesh.from_pydata([place for edge in edges for place in edge], [(2 * i, 2 * i + 1) for i in range(len(edges))], [])
    thing = bpy.data.objects.new(f"{names.CREASE}.{angle:+d}", mesh)
    thing["paper_crease"], thing["paper_target"] = float(angle), sheet.name
    thing.parent, thing.show_in_front, thing.hide_render = sheet, True, True
    for collection in sheet.users_collection:
        collection.objects.link(thing)
    return thing


class MarkCreases(bpy.types.Operator):
    """The selected edges of the sheet (edit mode) are folds that are there from the start. Each springs back to its rest angle"""

    bl_idname, bl_label, bl_options = "paperbake.mark_creases", "Mark Creases", {"REGISTER", "UNDO"}

    modelled: bpy.props.BoolProperty(name="As Modelled", default=True, description="Each edge has the angle that it has in the mesh")
    angle: bpy.props.FloatProperty(name="Angle", default=0.0, min=-MOST, max=MOST,
                                   description="Rest angle of all of them in degrees: 0 is flat, 150 is folded nearly shut. "
                                               "Positive: the fold points to the side of the normals")

    @classmethod
    def poll(cls, context):
        thing = context.object
        return thing is not None and thing.mode == "EDIT" and names.role(thing) == names.SHEET

    def execute(self, context):
        sheet = context.object
        found = crease_angles(bmesh.from_edit_mesh(sheet.data), self.modelled, self.angle)
        if not found:
            self.report({"ERROR"}, "No edge between two faces is selected.")
            return {"CANCELLED"}
        for angle, edges in sorted(found.items()):
            crease_object(sheet, angle, edges)
        self.report({"INFO"}, "Creases of " + ", ".join(f"{angle} degrees ({len(edges)} edges)" for angle, edges in sorted(found.items())))
        return {"FINISHED"}


class MarkWind(bpy.types.Operator):
    """The selected empties are winds, which blow along their Z axis everywhere; without one, a wind is added at the 3D cursor"""

    bl_idname, bl_label, bl_options = "paperbake.mark_wind", "Mark Wind", {"REGISTER", "UNDO"}

    def execute(self, context):
        marked = [thing for thing in context.selected_objects if thing.type == "EMPTY" and names.role(thing) in (None, names.WIND)]
        if not all(rename(self, thing, names.with_prefix(thing.name, names.WIND)) for thing in marked):
            return {"CANCELLED"}
        if not marked:
            marked = [bpy.data.objects.new(names.WIND, None)]
            marked[0].location = context.scene.cursor.location
            context.collection.objects.link(marked[0])
        for thing in marked:
            thing.empty_display_type = "SINGLE_ARROW"
            for key, (_, value) in properties.WIND.items():
                if key not in thing:
                    thing[key] = value
                thing.id_properties_ui(key).update(min=0)
        self.report({"INFO"}, f"{len(marked)} wind(s): {', '.join(thing.name for thing in marked)}")
        return {"FINISHED"}


class Unmark(bpy.types.Operator):
    """The selected objects are nothing to paperbake any more: their names lose the prefix, their paper_* properties go"""

    bl_idname, bl_label, bl_options = "paperbake.unmark", "Unmark", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return any(names.role(thing) for thing in context.selected_objects)

    def execute(self, context):
        for thing in context.selected_objects:
            if names.role(thing) and rename(self, thing, names.without_prefix(thing.name)):
                for key in [key for key in thing.keys() if key.startswith("paper_")]:
                    del thing[key]
        return {"FINISHED"}


def places(context):
    """(world positions, sheet): of the selected vertices in edit mode, else of the 3D cursor."""
    thing = context.object
    if thing and thing.type == "MESH" and thing.mode == "EDIT":
        return [thing.matrix_world @ vertex.co for vertex in bmesh.from_edit_mesh(thing.data).verts if vertex.select], thing
    sheets = names.of_role(context.scene, names.SHEET)
    return [context.scene.cursor.location.copy()], sheets[0] if sheets else None


class AddHandles(bpy.types.Operator):
    """An empty that holds the sheet at each selected vertex (edit mode), or at the 3D cursor. Key them, or parent them to a rig"""

    bl_idname, bl_label, bl_options = "paperbake.add_handles", "Add Handles", {"REGISTER", "UNDO"}

    def execute(self, context):
        found, sheet = places(context)
        if not found:
            self.report({"ERROR"}, "No vertex is selected.")
            return {"CANCELLED"}
        size = HANDLE_SIZE * max(sheet.dimensions) if sheet else 0.01
        for place in found:
            handle = bpy.data.objects.new(f"{names.HANDLE}.001", None)
            handle.empty_display_type, handle.empty_display_size, handle.show_in_front = "SPHERE", size, True
            handle.location = place
            context.collection.objects.link(handle)
        self.report({"INFO"}, f"{len(found)} handle(s) added.")
        return {"FINISHED"}


class SetHandle(bpy.types.Operator):
    """Gives all selected handles this setting, or takes it from them"""

    bl_idname, bl_label, bl_options = "paperbake.set_handle", "Set on Selected Handles", {"REGISTER", "UNDO"}

    name: bpy.props.EnumProperty(items=[(key, label, "") for key, (label, _, _) in properties.SETTINGS.items()])
    remove: bpy.props.BoolProperty()

    def execute(self, context):
        start = properties.SETTINGS[self.name][2]
        for thing in [thing for thing in context.selected_objects if names.role(thing) == names.HANDLE]:
            if self.remove:
                thing.pop(self.name, None)
            else:
                thing[self.name] = context.scene.frame_current if start is None else start
                thing.id_properties_ui(self.name).update(min=0)
        return {"FINISHED"}


class CopyToHandles(bpy.types.Operator):
    """Gives the settings of the active handle to all selected ones"""

    bl_idname, bl_label, bl_options = "paperbake.copy_to_handles", "Copy to Selected", {"REGISTER", "UNDO"}

    @classmethod
    def poll(cls, context):
        return context.object is not None and names.role(context.object) == names.HANDLE and len(context.selected_objects) > 1

    def execute(self, context):
        keys = [*properties.SETTINGS, "paper_mode"]
        for thing in context.selected_objects:
            if thing != context.object and names.role(thing) == names.HANDLE:
                for key in keys:
                    if key in context.object:
                        thing[key] = context.object[key]
                    else:
                        thing.pop(key, None)
        return {"FINISHED"}


CLASSES = (MarkSheet, MarkHandles, MarkCollider, MarkCreases, MarkWind, Unmark, AddHandles, SetHandle, CopyToHandles)
