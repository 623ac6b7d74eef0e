"""Judges a binary USD layer with OpenUSD: it holds the same as the text beside it, to the last bit, in less room.

    usd_encodings_judge.py FILE.usda FILE.usdc LARGEST_SHARE

LARGEST_SHARE is what the size of the binary file may be of the text's. Prints one line for each check that failed and exits
with 1, or what was compared and exits with 0.
"""

import os
import sys

from pxr import Sdf, Usd, UsdValidation

from judgement import Judgement


def same_value(a, b):
    return a == b and type(a) is type(b)


def judge_spec(judgement, text, binary):
    where = str(text.path)
    keys = set(text.ListInfoKeys()) | set(binary.ListInfoKeys())
    for key in sorted(keys - {"timeSamples"}):
        a, b = text.GetInfo(key), binary.GetInfo(key)
        judgement.check(same_value(a, b), f"{where}: {key} is {a} in the text, {b} in the binary file")
    judgement.count("fields", len(keys))


def judge_samples(judgement, text, binary, path):
    times = text.ListTimeSamplesForPath(path)
    judgement.check(times == binary.ListTimeSamplesForPath(path), f"{path}: other times")
    for time in times:
        judgement.check(same_value(text.QueryTimeSample(path, time), binary.QueryTimeSample(path, time)),
                        f"{path}: the values at {time} differ")
    judgement.count("time samples", len(times))


def judge_layers(judgement, text, binary):
    paths = [[], []]
    for layer, found in zip((text, binary), paths):
        layer.Traverse("/", found.append)
    other = sorted(set(paths[0]) ^ set(paths[1]))
    if not judgement.check(not other, f"only one of them has {other}"):
        return
    for path in paths[0]:
        spec, same = text.GetObjectAtPath(path), binary.GetObjectAtPath(path)
        if spec is None:  # a target of a relationship
            continue
        judge_spec(judgement, spec, same)
        if isinstance(spec, Sdf.PrimSpec):
            for order in ("nameChildren", "properties"):
                names = [[child.name for child in getattr(prim, order)] for prim in (spec, same)]
                judgement.check(names[0] == names[1], f"{path}: {order} are {names[1]}, in the text {names[0]}")
        if path.IsPropertyPath():
            judge_samples(judgement, text, binary, path)


def main(arguments):
    if len(arguments) != 3:
        print("usage: usd_encodings_judge.py FILE.usda FILE.usdc LARGEST_SHARE")
        return 2
    judgement = Judgement()
    judge_layers(judgement, *(Sdf.Layer.FindOrOpen(file) for file in arguments[:2]))
    context = UsdValidation.ValidationContext(UsdValidation.ValidationRegistry().GetOrLoadAllValidators())
    for error in context.Validate(Usd.Stage.Open(arguments[1])):
        judgement.check(False, f"validator: {error.GetName()}: {error.GetMessage()}")
    share = os.path.getsize(arguments[1]) / os.path.getsize(arguments[0])
    judgement.check(share <= float(arguments[2]), f"the binary file has {share:.3f} of the text's size")
    with open(arguments[1], "rb") as file:
        head = file.read(11)
    judgement.check(head == b"PXR-USDC\0\x08\0", f"the file begins with {head}")
    return judgement.conclude(f"OpenUSD {'.'.join(map(str, Usd.GetVersion()))}, {share:.3f} of the size,", ("fields", "time samples"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
