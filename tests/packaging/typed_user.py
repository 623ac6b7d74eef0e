"""Read by mypy, never run: what it has to say of a line stands behind the line."""

import paperbake

running = paperbake.bake("shot.glb", "out", quality="draft", formats=["abc"], strict=True, seed=3)
for record in running:
    reveal_type(record)  # paperbake.records.Progress
    reveal_type(record.seconds_left)  # builtins.float
    record.frame + "1"  # Unsupported operand types
summary = paperbake.bake_and_wait("shot.glb", "out", set={"friction": 0.4})
reveal_type(summary)  # paperbake.records.Summary
reveal_type(summary.gates_missed)  # builtins.tuple[builtins.str
paperbake.bake("shot.glb", "out", seed=object())  # incompatible type
