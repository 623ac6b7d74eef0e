#!/usr/bin/env python3
"""Writes docs/command_line.md from what the program says of itself.

    python3 docs/make_command_line.py [PROGRAM]        PROGRAM: build/paperbake

The text of every row is the help text of the option, so the page can only be wrong where `--help`
is.
"""

import os
import pathlib
import re
import subprocess
import sys

FOLDER = pathlib.Path(
    os.path.abspath(__file__)
).parent  # not resolved: the docs test works in a folder of links
PAGE = FOLDER / "command_line.md"

HEAD = """# Command line

<!-- Written by docs/make_command_line.py from the help texts of the program. Do not edit. -->

The form is `paperbake`, a command, its options, and a scene, a job file or a folder. `--help`
after a command prints what this page says of it.

Requested data goes to stdout; messages and progress go to stderr. There are no prompts.
Options of `bake` are also keys of a [job file](job_files.md), with `_` in place of `-`, but for
those that concern one call alone: `--log`, `--dry-run`, `--write-job`, `--force`, and `--set`, which
is the section `[paper]` there.
The command line takes precedence over the job file, the job file over properties of the scene, and
those over the paper preset.

| command | purpose |
|---|---|
"""

EXIT_CODES = """## Exit codes

| code | meaning |
|---|---|
| 0 | done |
| 1 | the simulation failed; frames before the failure are kept in every file |
| 2 | wrong command line, job file or preset |
| 3 | the scene cannot be used |
| 4 | baked, but a [quality gate](output_files.md#gates) was missed; `verify`: files differ, or there is no cache |
| 5 | stopped by a signal; the same command resumes |
| 6 | the output folder is in use by another bake, or is not writable |
"""


def help_of(program, *command):
    done = subprocess.run([program, *command, "--help"], capture_output=True, text=True)
    if done.returncode != 0:
        sys.exit(f"{' '.join(done.args)} ends with {done.returncode}: {done.stderr.strip()}")
    return done.stdout


def entries(text, section):
    """(name, meaning) of each entry of a section of a help text.

    Meanings begin at column 30, those of long names on the next line.
    """
    body = re.search(rf"^{section}:\n(.*?)(?:\n\n|\Z)", text, re.M | re.S)
    lines = re.sub(r"\n {30}", "\t", body[1]).split("\n") if body else []
    found = []
    for line in filter(str.strip, lines):
        name, _, meaning = line.partition("\t") if "\t" in line else (line[:30], "", line[30:])
        found.append((name.strip(), meaning.strip()))
    return found


def row(name, meaning):
    """| `--mesh` | render, simulation | `render` | ... |"""
    flags, _, rest = name.partition(" ")
    value, _, default = rest.rpartition("=") if "=" in rest else (rest, "", "")
    value = re.sub(r"^(?:INT|TEXT):", "", value).translate(str.maketrans("|", "/", "{}"))
    value = value.replace(" REQUIRED", ", required").replace(" Excludes: ", ", not with ")
    cells = [
        ", ".join(f"`{flag}`" for flag in flags.split(",")),
        value,
        f"`{default}`" if default else "",
        meaning,
    ]
    return "| " + " | ".join(cell.replace("|", "\\|") for cell in cells) + " |\n"


def table(rows):
    return (
        "| option | value | default | meaning |\n|---|---|---|---|\n"
        + "".join(row(*entry) for entry in rows)
        + "\n"
    )


def without_help(rows):
    return [entry for entry in rows if not entry[0].startswith("-h,")]


def section(program, command, purpose, of_bake):
    text = help_of(program, command)
    usage = re.search(r"^Usage: (.*)$", text, re.M)[1]
    rows = entries(text, "Positionals") + without_help(entries(text, "Options"))
    shared = [] if command == "bake" else [entry for entry in rows if entry in of_bake]
    page = f"## {command}\n\n{purpose}.\n\n```text\n{usage}\n```\n\n"
    page += table([entry for entry in rows if entry not in shared])
    if len(shared) > 20:
        page += "It also takes a scene or a job file, and the options of `bake` "
        page += "but `--dry-run`,\n`--write-job`, `--force` and `--log`.\n\n"
    elif shared:
        names = ", ".join(f"`{entry[0].split()[0].split(',')[-1]}`" for entry in shared)
        page += f"It also takes these options of `bake`: {names}.\n\n"
    return page


def page(program):
    commands = entries(help_of(program), "Subcommands")
    text = (
        HEAD + "".join(f"| [{name}](#{name}) | {purpose} |\n" for name, purpose in commands) + "\n"
    )
    bake = help_of(program, "bake")
    of_bake = entries(bake, "Positionals") + without_help(entries(bake, "Options"))
    for name, purpose in commands:
        text += section(program, name, purpose, of_bake)
    return text + EXIT_CODES


def main():
    program = sys.argv[1] if len(sys.argv) > 1 else str(FOLDER.parent / "build" / "paperbake")
    beside = PAGE.with_suffix(".md.part")
    beside.write_text(page(program))
    beside.replace(PAGE)
    print(PAGE)


if __name__ == "__main__":
    main()
