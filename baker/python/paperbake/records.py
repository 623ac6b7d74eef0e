"""What a bake tells: how far it is, and what came out."""

from __future__ import annotations

import dataclasses
import pathlib
from typing import Any, Dict, Literal


@dataclasses.dataclass(frozen=True)
class Progress:
    """A frame of a sheet is done with a stage: first all frames are simulated, then they are
    rendered, that is, put on the mesh of the whole shot."""

    sheet: str
    frame: int
    stage: Literal["simulated", "rendered"]
    done: int                  # frames that are done with this stage, over all sheets
    frames: int                # of how many
    seconds_left: float        # of the stages that have begun
    stretch_mean_pct: float    # c_m, the mean change of an edge's length [%]
    triangles: int
    singular: int              # singular points so far
    messages: tuple[str, ...]  # warnings since the record before


class Summary(Dict[str, Any]):
    """cert/summary.json of a bake as a dictionary, which is empty without the format "cert"; and
    what the program said besides."""

    exit_code: int                   # 0, or 4: baked, but a gate was missed
    gates_missed: tuple[str, ...]    # sentences; empty: all were kept
    messages: tuple[str, ...]        # all warnings, and the missed gates
    files: tuple[pathlib.Path, ...]  # what was written
