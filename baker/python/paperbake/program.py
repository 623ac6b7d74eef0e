"""The program: where it is, how it is started, and what its errors say."""

from __future__ import annotations

import os
import pathlib
import shutil
import signal
import sys
from typing import NoReturn

BUNDLED = pathlib.Path(__file__).resolve().parent / "bundled" / "bin" / "paperbake"
PREFIX = "paperbake: "  # of what the program says when it fails
WHY_SIGNAL = {
    int(signal.SIGKILL): "Is memory short?",
    int(signal.SIGILL): "This build is for newer processors: its version, or docs/packages.md, "
                        "says for which. Build paperbake on this machine.",
}


class Error(Exception):
    """A bake that failed, in the program's own words: str() is what it printed.

    exit_code   1 the simulation failed, 2 an option or a job file is wrong, 3 the scene cannot be
                used, 5 somebody stopped it, 6 the output folder is busy or not writable;
                below 0: a signal ended the program
    place       file, node or frame; may be empty
    cause       what is wrong
    remedy      what to try; may be empty
    """

    def __init__(self, exit_code: int, text: str) -> None:
        super().__init__(text)
        self.exit_code = exit_code
        place, _, rest = text.partition("\n  ")
        if not rest:
            place, rest = "", place
        self.place = place
        self.cause, _, self.remedy = rest.partition("\n  ")

    def __reduce__(self) -> tuple[type[Error], tuple[int, str]]:
        """An error comes whole from another process, as those of a pool."""
        return Error, (self.exit_code, str(self))


def program() -> str:
    """Path of the program: the one in this package; on PATH where there is none in it."""
    if not BUNDLED.exists():
        found = shutil.which("paperbake")
        if found:
            return found
        raise Error(2, f"{BUNDLED}\n  The program is neither in this package nor on PATH.\n"
                       "  Install the wheel of paperbake with pip.")
    if not os.access(BUNDLED, os.X_OK):  # some installers lose the permission
        try:
            BUNDLED.chmod(0o755)
        except OSError as error:
            raise Error(2, f"{BUNDLED}\n  It may not be run: {error.strerror}.\n"
                           "  Ask its owner to make it executable.") from error
    return str(BUNDLED)


def environment() -> dict[str, str]:
    """Of the program when another one runs it: the libraries that a DCC has put on the loader's
    path are not for it."""
    left_out = ("LD_LIBRARY_PATH", "LD_PRELOAD")
    return {name: value for name, value in os.environ.items() if name not in left_out}


def ending(exit_code: int, said: str) -> Error:
    """What a program that failed has said on stderr, as an error."""
    text = said[said.rfind(PREFIX) + len(PREFIX):] if PREFIX in said else said
    text = text.strip()
    if exit_code < 0:
        why = WHY_SIGNAL.get(-exit_code, text)
        said = f"paperbake\n  It was ended by signal {-exit_code}.\n  {why}"
        return Error(exit_code, said.rstrip())
    silent = f"paperbake\n  It ended with code {exit_code} and said nothing."
    return Error(exit_code, text or silent)


def main() -> NoReturn:
    """The command `paperbake`: this process becomes the program."""
    try:
        path = program()
    except Error as error:
        print(PREFIX + str(error), file=sys.stderr)
        sys.exit(error.exit_code)
    os.execv(path, [path, *sys.argv[1:]])
