"""Bakes paper animation from handles keyed in a DCC, with the program that comes in this package.

    import paperbake

    summary = paperbake.bake_and_wait("shot.glb", "out", quality="draft", preset="copy90")
    print(summary["frames"], "frames,", len(summary.gates_missed), "gates missed")

`bake` does the same and yields the progress on its way.
"""

from .baking import bake, bake_and_wait
from .program import Error, program
from .records import Progress, Summary

__all__ = ["Error", "Progress", "Summary", "bake", "bake_and_wait", "program"]
