"""What every judge does: note what is wrong, count what was compared, and not pass when nothing was."""

import math

import numpy

TOLERANCE = 1e-6  # relative to values over 1: the cache holds 32-bit floats, whose step is 1.2e-7


class Judgement:
    def __init__(self):
        self.failures, self.compared, self.largest_error = [], {}, {}

    def check(self, right, what):
        if not right:
            self.failures.append(what)
        return bool(right)

    def count(self, kind, number):
        self.compared[kind] = self.compared.get(kind, 0) + number

    def near(self, found, expected, kind, where, tolerance=TOLERANCE):
        """Compares rows of numbers; counts them under `kind`."""
        found, expected = numpy.asarray(found, dtype=float), numpy.asarray(expected, dtype=float)
        if not self.check(found.shape == expected.shape, f"{where}: {len(found)} {kind}, expected {len(expected)}"):
            return
        error = numpy.nan_to_num(abs(found - expected) / numpy.maximum(1, abs(expected)), nan=math.inf)
        worst = float(error.max(initial=0))
        at = numpy.unravel_index(error.argmax(), error.shape)[0] if error.size else None
        self.check(worst <= tolerance, f"{where}: {kind} {at} is off by {worst:.3g}")
        self.largest_error[kind] = max(self.largest_error.get(kind, 0), worst)
        self.count(kind, len(found))

    def conclude(self, judge, needed):
        """Prints the verdict. Returns the exit code: 0 only when nothing failed and every kind in `needed` was compared."""
        for kind in needed:
            self.check(self.compared.get(kind, 0) > 0, f"no {kind} were compared")
        for failure in self.failures:
            print(failure)
        if not self.failures:
            print(f"{judge} agrees on " + ", ".join(
                f"{count} {kind}" + (f" (largest error {self.largest_error[kind]:.2g})" if kind in self.largest_error else "")
                for kind, count in self.compared.items()))
        return 1 if self.failures else 0
