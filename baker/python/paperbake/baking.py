"""A bake as a generator: the program runs, and every frame that it tells of is yielded."""

from __future__ import annotations

import collections.abc
import json
import os
import pathlib
import signal
import subprocess
import tempfile
from typing import IO, Any, Callable, Generator, List, Mapping, Optional, Sequence, Union

from .program import ending, environment, program
from .records import Progress, Summary

Path = Union[str, "os.PathLike[str]"]
Word = Union[str, int, float, "os.PathLike[str]"]
Option = Union[Word, bool, None, Sequence[Word], Mapping[str, Word]]

BAKED = (0, 4)  # 4: but a gate was missed
GATE_MISSED = "gate missed: "
NOT_FOR_BAKE = {
    "output": "it is the second argument",
    "progress": "bake() reads it",
    "write_job": "it bakes nothing: run the program",
    "dry_run": "it bakes nothing: run the program",
}


def bake(scene: Path, output: Path, **options: Option) -> Generator[Progress, None, Summary]:
    """Bakes a scene, or a job file, into the folder `output`. It begins with the first next().

    options   those of the program (`paperbake bake --help`), with _ for -: map_size=512.
              True: the option alone; False, None: not given; a list: its values with commas
              between them; a dictionary: the option once for every key=value, as in
              set={"apex_scatter": 0.003}
    yields    a Progress for every frame that is done, of every sheet and stage
    returns   the Summary: `summary = yield from bake(...)`; or call `bake_and_wait`
    raises    Error in the program's own words; TypeError for an option that is not for bake()

    Closing the generator stops the bake, as Ctrl-C does in a terminal, which takes at most a second.
    The frames until then are kept, and the same call goes on from there.
    """
    for name in options:
        if name in NOT_FOR_BAKE:
            raise TypeError(f"bake() takes no option {name!r}: {NOT_FOR_BAKE[name]}")
    words = [word for name, value in options.items() for word in _words_of(name, value)]
    command = [program(), "bake", os.fspath(scene), "-o", os.fspath(output), "--progress", "json"]
    return _run(command + words)


def bake_and_wait(scene: Path, output: Path,
                  on_progress: Optional[Callable[[Progress], object]] = None,
                  **options: Option) -> Summary:
    """As `bake`, to its end; `on_progress` is called with every record."""
    running = bake(scene, output, **options)
    try:
        while True:
            record = next(running)
            if on_progress is not None:
                on_progress(record)
    except StopIteration as end:
        summary: Summary = end.value
        return summary
    finally:
        running.close()


def _words_of(name: str, value: Option) -> List[str]:
    flag = "--" + name.replace("_", "-")
    if value is None or value is False:
        return []
    if value is True:
        return [flag]
    if isinstance(value, collections.abc.Mapping):
        return [f"{flag}={key}={_text(one)}" for key, one in value.items()]
    if isinstance(value, collections.abc.Sequence) and not isinstance(value, str):
        return [f"{flag}={','.join(map(_text, value))}"]
    return [f"{flag}={_text(value)}"]


def _text(value: Word) -> str:
    return os.fspath(value) if isinstance(value, os.PathLike) else str(value)


# what a sentence begins with, by the type of its record, as the program says it in words
_SAID_BEFORE = {"warning": "warning: ", "gate": GATE_MISSED}


def _run(command: List[str]) -> Generator[Progress, None, Summary]:
    # Apart from the terminal: a Ctrl-C that interrupts Python reaches the program once, through
    # _stop; twice would kill it. What it lists goes into a file: a pipe that nobody reads while
    # frames come would fill up.
    with tempfile.TemporaryFile() as listed, subprocess.Popen(
            command, stdin=subprocess.DEVNULL, stdout=listed, stderr=subprocess.PIPE,
            text=True, encoding="utf-8", errors="replace", env=environment(),
            start_new_session=True) as process:
        messages: List[str] = []
        told = 0
        said = ""
        assert process.stderr is not None
        try:
            for line in process.stderr:
                record = _parsed(line)
                if record is None:
                    said += line
                elif "message" in record:
                    messages.append(_SAID_BEFORE.get(str(record.get("type")), "")
                                    + str(record["message"]))
                elif record.get("type") == "frame":
                    yield _progress(record, messages[told:])
                    told = len(messages)
        except BaseException:  # the generator is closed, or Ctrl-C
            _stop(process)
            raise
        exit_code = process.wait()
        if exit_code not in BAKED:
            raise ending(exit_code, said)
        return _summary(exit_code, messages, listed)


def _stop(process: "subprocess.Popen[str]") -> None:
    """Lets the program end after its frame, and waits for that."""
    try:
        process.send_signal(signal.SIGINT)
        process.communicate()
    except BaseException:  # a second Ctrl-C does not wait
        process.kill()
        raise


def _parsed(line: str) -> Optional[dict[str, Any]]:
    """A line of progress or a message; None: what the program says when it fails."""
    try:
        record = json.loads(line)
    except ValueError:
        return None
    return record if isinstance(record, dict) else None


def _progress(record: Mapping[str, Any], messages: Sequence[str]) -> Progress:
    return Progress(sheet=record["sheet"], frame=record["frame"], stage=record["pass"],
                    done=record["done"], frames=record["frames"],
                    seconds_left=record["seconds_left"],
                    stretch_mean_pct=record["stretch_mean_pct"], triangles=record["triangles"],
                    singular=record["singular"], messages=tuple(messages))


def _summary(exit_code: int, messages: Sequence[str], listed: IO[bytes]) -> Summary:
    listed.seek(0)
    files = [pathlib.Path(os.fsdecode(line)) for line in listed.read().splitlines()]
    certificate = [file for file in files if file.parts[-2:] == ("cert", "summary.json")]
    summary = Summary()
    if certificate:  # only a bake that wrote one: in the folder may lie that of another
        summary.update(json.loads(certificate[0].read_text(encoding="utf-8")))
    summary.exit_code = exit_code
    summary.files = tuple(files)
    summary.messages = tuple(messages)
    summary.gates_missed = tuple(message[len(GATE_MISSED):] for message in messages
                                 if message.startswith(GATE_MISSED))
    return summary
