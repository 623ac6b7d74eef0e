"""Paperbake in Blender: mark a sheet and its handles, bake, and get the cache back in the scene. README.md is the guide."""

import bpy

from . import baking, marking, panel, properties

CLASSES = (*marking.CLASSES, *baking.CLASSES, *panel.CLASSES)


_keys = []  # (keymap, its item): what is to be taken away again


def register():
    properties.register()
    for kind in CLASSES:
        bpy.utils.register_class(kind)
    keys = bpy.context.window_manager.keyconfigs.addon
    if keys:  # there are none in the background
        keymap = keys.keymaps.new(name="Object Mode", space_type="EMPTY")
        _keys.append((keymap, keymap.keymap_items.new("paperbake.draft", "B", "PRESS", ctrl=True, shift=True)))


def unregister():
    baking.abandon()
    for keymap, item in _keys:
        keymap.keymap_items.remove(item)
    _keys.clear()
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
    properties.unregister()
