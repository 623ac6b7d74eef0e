"""What a bake said, as a text block of the .blend: every sentence on a line of its own."""

import bpy

NAME = "Paperbake"


def write(sentences):
    """Replaces what the bake before said."""
    text = bpy.data.texts.get(NAME) or bpy.data.texts.new(NAME)
    text.from_string("\n".join(sentences) + "\n")
