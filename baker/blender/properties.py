"""What the artist chooses: of the program, of a bake, of a sheet, of a handle. What is of an object lies in its custom properties
`paper_*`, which go with it into every export; the rest is of the scene."""

import pathlib

import bpy
import bpy.utils.previews

from . import program

PACKAGE = __package__
RELATIVE = {"options": {"PATH_SUPPORTS_BLEND_RELATIVE"}} if bpy.app.version >= (4, 5, 0) else {}  # earlier ones do not know the word
FROM_PRESET = "default"  # no paper_preset: the program's own
SETTINGS = {  # of handles, optional: property -> (label, what it is without, value to begin with, None: the current frame)
    "paper_grab_frame": ("Grab", "from the first frame", None),
    "paper_release_frame": ("Release", "never", None),
    "paper_radius": ("Radius [m]", "finger, when alone", 0.01),
    "paper_stiffness": ("Spring [N/m]", "hard", 500.0),
}
WIND = {  # of winds: property -> (label, value to begin with)
    "paper_speed": ("Speed [m/s]", 2.0),
    "paper_gust": ("Gusts [share of it]", 0.0),
}
MODES = [("absolute", "Absolute", "The sheet's point goes where the handle is"),
         ("relative", "Relative", "The sheet's point moves as the handle moves from its grab frame on")]


class Preferences(bpy.types.AddonPreferences):
    bl_idname = PACKAGE

    program: bpy.props.StringProperty(name="paperbake", subtype="FILE_PATH",
                                      description="Another program than the one that came with the add-on; empty: that one, else the one on PATH")

    def draw(self, context):
        self.layout.prop(self, "program")
        try:
            path = program.located(self.program)
            self.layout.label(text=f"{path}: {len(grades_of(path))} paper grades", icon="CHECKMARK")
        except program.Unusable as error:
            self.layout.label(text=str(error), icon="ERROR")


def program_path():
    """As in the preferences."""
    addon = bpy.context.preferences.addons.get(PACKAGE)
    return addon.preferences.program if addon else ""


_grades = {}  # of a program, asked once: {path: [Grade] or Unusable}


def grades_of(path):
    """Throws Unusable."""
    if path not in _grades:
        try:
            _grades[path] = program.grades(path)
        except program.Unusable as error:
            _grades[path] = error
    if isinstance(_grades[path], program.Unusable):
        raise _grades[path]
    return _grades[path]


ICONS = pathlib.Path(__file__).parent / "icons"  # a picture of each grade, which make_icons.py renders
_pictures = None  # as Blender keeps them, from register to unregister


def picture_of(grade):
    """Number of the icon; 0, which is none, for a grade without a picture."""
    path = ICONS / f"{grade}.png"
    if _pictures is None or not path.is_file():
        return 0
    return (_pictures[grade] if grade in _pictures else _pictures.load(grade, str(path), "IMAGE")).icon_id


_items = {}  # Blender keeps no reference to the strings of a list that a function made


def grade_items(self, context):
    """The program's grades, and the one the sheet has when the program does not know it: a preset file, or another version's."""
    try:
        listed = [(g.name, f"{g.name} ({g.description})", g.description) for g in grades_of(program.located(program_path()))]
    except program.Unusable:
        listed = []
    own = self.id_data.get("paper_preset")
    if own and own not in [name for name, _, _ in listed]:
        listed.append((own, own, "Not among the grades of this paperbake"))
    listed.insert(0, (FROM_PRESET, "Default", "The program's own grade"))
    key = tuple((name, label, told, picture_of(name), number) for number, (name, label, told) in enumerate(listed))
    return _items.setdefault(key, list(key))


def get_preset(self):
    keys = [item[0] for item in grade_items(self, bpy.context)]
    return keys.index(self.id_data.get("paper_preset", FROM_PRESET))


def set_preset(self, index):
    key = grade_items(self, bpy.context)[index][0]
    if key == FROM_PRESET:
        self.id_data.pop("paper_preset", None)
    else:
        self.id_data["paper_preset"] = key


def get_mode(self):
    return [key for key, _, _ in MODES].index(self.id_data["paper_mode"]) if self.id_data.get("paper_mode") == "relative" else 0


def set_mode(self, index):
    self.id_data["paper_mode"] = MODES[index][0]


def set_seed(self, seed):
    self.id_data["paper_seed"] = seed


class ObjectSettings(bpy.types.PropertyGroup):
    """A face for the custom properties of an object that are no plain numbers."""

    preset: bpy.props.EnumProperty(name="Paper", items=grade_items, get=get_preset, set=set_preset, description="Paper grade of this sheet")
    seed: bpy.props.IntProperty(name="Seed", min=0, get=lambda self: self.id_data.get("paper_seed", 0), set=set_seed,
                                description="Another seed crumples the same shot in another way")
    mode: bpy.props.EnumProperty(name="Mode", items=MODES, get=get_mode, set=set_mode)


class SceneSettings(bpy.types.PropertyGroup):
    folder: bpy.props.StringProperty(name="Folder", subtype="DIR_PATH", default="//paperbake", **RELATIVE,
                                     description="Where the bake goes; // is beside the .blend")
    quality: bpy.props.EnumProperty(name="Quality", default="draft", items=[
        ("draft", "Draft", "5 mm edges on a sheet of 0.2 m"), ("shot", "Shot", "2 mm edges"), ("hero", "Hero", "1 mm edges, every frame polished")])
    method: bpy.props.EnumProperty(name="Method", default="hybrid", items=[
        ("hybrid", "Hybrid", "Fast; creases where paper would have them"), ("fem", "FEM", "Finite elements on a fixed mesh; elastic paper"),
        ("adaptive", "Adaptive", "Finite elements, the mesh refined where it bends"), ("hybrid+fem", "Hybrid + FEM", "Hybrid, then every frame polished")])
    gravity: bpy.props.FloatProperty(name="Gravity", default=0.0, soft_min=0.0, soft_max=9.81, description="m/s\u00b2, downwards; 0: as the property paper_gravity of an object says")
    options: bpy.props.StringProperty(name="Options", description="Further options of paperbake bake, as on its command line: --base-triangles 240")
    own_frames: bpy.props.BoolProperty(name="Own Frames", description="Other frames than the scene's; it is simulated from the scene's first all the same")
    first: bpy.props.IntProperty(name="First", default=1, min=0)
    last: bpy.props.IntProperty(name="Last", default=24, min=0)


CLASSES = (Preferences, ObjectSettings, SceneSettings)


def register():
    global _pictures
    _pictures = bpy.utils.previews.new()
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    bpy.types.Object.paperbake = bpy.props.PointerProperty(type=ObjectSettings)
    bpy.types.Scene.paperbake = bpy.props.PointerProperty(type=SceneSettings)


def unregister():
    global _pictures
    bpy.utils.previews.remove(_pictures)
    _pictures = None
    del bpy.types.Scene.paperbake, bpy.types.Object.paperbake
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
    _grades.clear()
    _items.clear()
