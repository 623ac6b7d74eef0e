"""The program paperbake as a process: where it is, what it can do, how far it is, and what its end means. Knows nothing of Blender."""

import collections
import json
import os
import pathlib
import queue
import re
import shutil
import subprocess
import threading
import time

BUNDLED = pathlib.Path(__file__).resolve().parent / "bundled" / "bin" / "paperbake"  # of the zip that brings the program
PREFERENCES = "Edit > Preferences > Add-ons > Paperbake"
KILL_AFTER = 3.0  # [s] without an answer to SIGTERM
GATE_MISSED, STOPPED = 4, 5

Grade = collections.namedtuple("Grade", "name description")
# level: INFO, WARNING or ERROR; loads: there is a cache to look at; told: what the sentence is made of, one by one
Outcome = collections.namedtuple("Outcome", "level sentence loads told", defaults=((),))


class Unusable(Exception):
    """What stops a bake before it begins, in words for the artist."""


def bundled():
    """The program that came with the add-on. Throws Unusable."""
    if not os.access(BUNDLED, os.X_OK):  # Blender installs no file with the permission to run
        try:
            BUNDLED.chmod(0o755)
        except OSError as error:
            raise Unusable(f"{BUNDLED} may not be run: {error.strerror}. Install the add-on anew, "
                           f"or give the place of another paperbake in {PREFERENCES}.") from error
    return os.fspath(BUNDLED)


def located(path):
    """The program at `path`; when that is empty the one that came with the add-on, else the one on
    PATH. Throws Unusable."""
    if not path and BUNDLED.exists():
        return bundled()
    found = shutil.which(path or "paperbake")
    if found:
        return found
    if not path:
        raise Unusable(f"There is no paperbake on PATH. Give its place in {PREFERENCES}.")
    why = "is no program that may be run" if os.path.exists(path) else "is not there"
    raise Unusable(f"{path} {why}. Give the place of paperbake in {PREFERENCES}.")


def environment(program):
    """Of the process. The bundled program has libraries of its own: what a script that starts Blender
    has put on the loader's path is not for it."""
    left_out = ("LD_LIBRARY_PATH", "LD_PRELOAD") if program == os.fspath(BUNDLED) else ()
    return {name: value for name, value in os.environ.items() if name not in left_out}


def answer(program, *words):
    """What the program prints on stdout. Throws Unusable."""
    try:
        done = subprocess.run([program, *words], capture_output=True, text=True, timeout=20, check=False,
                              env=environment(program))
    except (OSError, subprocess.TimeoutExpired) as error:
        raise Unusable(f"{program} does not run: {error}.") from error
    if done.returncode:
        said = one_line(done.stderr) or ended_by(done.returncode)
        raise Unusable(f"{program} {' '.join(words)}: {said}")
    return done.stdout


def grades(program):
    """The paper grades that it knows. Throws Unusable."""
    try:
        listed = json.loads(answer(program, "presets", "--json"))
        values = [(g["name"], g["values"]["area_density"]["value"], g["values"]["thickness"]["value"]) for g in listed]
        return [Grade(name, f"{1e3 * density:g} g/m\u00b2, {1e6 * thickness:.0f} \u00b5m") for name, density, thickness in values]
    except (ValueError, KeyError, TypeError) as error:
        raise Unusable(f"{program} lists no paper grades as paperbake does: is it another program?") from error


def one_line(text):
    """place, cause and remedy of an error message as one sentence after the other."""
    return " ".join(line.strip() + (":" if i == 0 and line.startswith("paperbake: ") else "")
                    for i, line in enumerate(text.strip().splitlines())).removeprefix("paperbake: ")


def ended_by(code):
    """A signal in words for the artist."""
    why = {9: " (is memory short?)", 4: " (this build is for newer processors)"}
    return f"paperbake was ended by signal {-code}{why.get(-code, '')}." if code < 0 else ""


class Process:
    """A bake. A thread reads the pipe, so that nobody waits: not the program for a full pipe, not the window for a line."""

    def __init__(self, command):
        """Throws Unusable."""
        try:
            self._process = subprocess.Popen(command, stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                             text=True, encoding="utf-8", errors="replace", env=environment(command[0]))
        except OSError as error:
            raise Unusable(f"{command[0]} does not run: {error}.") from error
        self._lines = queue.SimpleQueue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        self._cancelled_at = None
        self.cancelled = False
        self.last = None      # the newest line of progress: {"frame", "pass", "done", "frames", "seconds_left", ...}
        self.fraction = 0.0   # [0, 1]
        self.messages = []    # warnings and remarks
        self.gates = []       # missed ones
        self.error = ""       # what it said when it failed

    def _read(self):
        for line in self._process.stderr:
            self._lines.put(line)

    def _take(self, line):
        try:
            said = json.loads(line)
        except ValueError:
            self.error += line
            return
        kind = said.get("type")
        if kind == "gate":
            self.gates.append(said["message"])
        elif "message" in said:
            self.messages.append(said["message"])
        elif kind == "frame":
            passes = {"simulated": 0.0, "rendered": 0.5}
            self.last, self.fraction = said, passes.get(said["pass"], 0.0) + 0.5 * said["done"] / said["frames"]

    def poll(self):
        """Takes what was said since. Returns the exit code, None while it runs."""
        code = self._process.poll()
        if code is not None:
            self._reader.join()  # every line is in the queue
        while not self._lines.empty():
            self._take(self._lines.get())
        if code is None and self._cancelled_at is not None and time.monotonic() - self._cancelled_at > KILL_AFTER:
            self._process.kill()
        return code

    def cancel(self):
        """Asks it to stop; who does not answer is killed by a later poll."""
        if self._cancelled_at is None and self._process.poll() is None:
            self._cancelled_at, self.cancelled = time.monotonic(), True
            self._process.terminate()

    def end(self):
        """Stops it and waits: for an end without more polls."""
        self.cancel()
        try:
            self._process.wait(KILL_AFTER)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()


def progress_text(process):
    if process.last is None:
        return "Reading the scene"
    left = int(process.last["seconds_left"] + 0.5)
    verb = "Simulating" if process.last["pass"] == "simulated" else "Meshing"
    return f"{verb} frame {process.last['frame']} ({process.last['done']} of {process.last['frames']}), {left // 60}:{left % 60:02} left"


def named(sentence):
    """The objects and files that a sentence names, in quotes."""
    return set(re.findall(r'"([^"]+)"', sentence))


def explaining(warnings, gates):
    """(those that name what a missed gate names too, the others)"""
    missed = set().union(*(named(gate) for gate in gates))
    return [w for w in warnings if named(w) & missed], [w for w in warnings if not named(w) & missed]


def without(reasons, gates):
    """The gates without the sentences with which they repeat a reason."""
    said = [next((gate[len(reason):].strip() for reason in reasons if gate.startswith(reason)), gate) for gate in gates]
    return [gate for gate in said if gate]


def attempts_last(messages):
    """(what the panel shows, with what was decided about attempts at its end; how these went on, which is for the text block alone)"""
    under_way = [message for message in messages if re.match(r"attempt \d+ of \d+", message)]
    decided = [message for message in messages if message.startswith("attempts: ")]
    return [message for message in messages if message not in under_way + decided] + decided, under_way


# options that messages name as a remedy -> where Blender has them; the others go into Options of the panel
IN_BLENDER = {"--fps": "Output > Frame Rate", "--frames": "Own Frames", "--gravity": "Gravity", "--method": "Method", "--preset": "Paper",
              "--quality": "Quality", "--seed": "Seed", "--unit-scale": "Scene > Units > Unit Scale"}
OPTION = re.compile(r"(?<![\w-])--[a-z][a-z-]+")
OTHERS = "What begins with -- goes into Options of the panel."


def in_blender(sentences):
    """The same, with options by the names that they have in Blender."""
    told = [OPTION.sub(lambda found: IN_BLENDER.get(found[0], found[0]), sentence) for sentence in sentences]
    return (*told, OTHERS) if any(OPTION.search(sentence) for sentence in told) else tuple(told)


def spoken(level, shown, under_way, fresh):
    """shown: sentences for panel and text block; under_way: more for the text block alone"""
    shown = in_blender(shown)
    return Outcome(level, " ".join(shown), fresh, (*shown, *under_way))


def outcome(code, process, summary, fresh):
    """What an exit code means for the artist.

    summary  cert/summary.json of this bake; empty when it wrote none
    fresh    there is a cache of this bake
    """
    if process.cancelled and code not in (0, GATE_MISSED):
        reached = f" at frame {process.last['frame']}" if process.last else ""
        left = "its files end there" if code == STOPPED and fresh else "what was baked before is still there"
        return Outcome("WARNING", f"The bake was cancelled{reached}; {left}.", False)
    shown, under_way = attempts_last(process.messages)
    if code == GATE_MISSED:
        missed = summary.get("gates_missed") or process.gates
        # what was warned of beforehand explains what was missed
        reasons, others = explaining(shown, missed)
        missed = without(reasons, missed)
        return spoken("WARNING", [*reasons, "Baked, but less well than asked for:", *missed, *others], under_way, fresh)
    if code == 0:
        worst = summary.get("stretch_mean_pct", {}).get("max", 0.0)
        first = f"Baked {summary.get('frames', 0)} frames, length error {worst:.2g} %."
        # which attempt was baked is no fault of a bake that is good
        faults = [message for message in shown if not message.startswith("attempts: ")]
        return spoken("WARNING" if faults else "INFO", [first, *shown], under_way, fresh)
    if code < 0:
        return Outcome("ERROR", ended_by(code), False)
    return spoken("ERROR", [one_line(process.error) or f"paperbake ended with code {code} and said nothing."], [], fresh)
