"""Paperbake in Blender: mark a sheet and its handles, bake, and get the cache back in the scene. README.md is the guide."""

import bpy

from . import baking, marking, panel, properties

CLASSES = (*marking.CLASSES, *baking.CLASSES, *panel.CLASSES)


def register():
    properties.register()
    for kind in CLASSES:
        bpy.utils.register_class(kind)


def unregister():
    baking.abandon()
    for kind in reversed(CLASSES):
        bpy.utils.unregister_class(kind)
    properties.unregister()
