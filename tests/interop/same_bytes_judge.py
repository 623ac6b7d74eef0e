"""Bakes a scene twice, with one thread and with two, into different folders: the same seed gives the same bytes, and nothing in
them tells where, when or on what machine they were made. Another seed gives other bytes.

    same_bytes_judge.py PAPERBAKE FOLDER SCENE [OPTION of paperbake bake]...

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import pathlib
import re
import shutil
import socket
import subprocess
import sys

from judgement import Judgement

DATE = re.compile(rb"\b(19|20)\d\d[-:/.](0[1-9]|1[0-2])[-:/.][0-3]\d|\b[0-2]\d:[0-5]\d:[0-5]\d\b|"
                  rb"\b(Mon|Tue|Wed|Thu|Fri|Sat|Sun)[a-z]*,? +\d?\d? ?(Jan|Feb|Mar|Apr|May|Jun|Jul|Aug|Sep|Oct|Nov|Dec)")


def bake(judgement, program, folder, words):
    shutil.rmtree(folder, ignore_errors=True)
    done = subprocess.run([program, "bake", *words, "-o", str(folder), "--progress", "none"], stdout=subprocess.DEVNULL, check=False)
    judgement.check(done.returncode == 0, f"{folder}: paperbake ended with {done.returncode}")
    files = [*folder.glob("*.abc"), *folder.glob("maps/*"), *folder.glob("singular.csv")]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def judge_contents(judgement, files, folder):
    told = {"the output path": bytes(folder), "the host name": socket.gethostname().encode()}
    told = {what: secret for what, secret in told.items() if len(secret) > 3}  # a shorter one may be there by chance
    for name, content in files.items():
        for what, secret in told.items():
            found = re.search(rb"(?<![A-Za-z0-9])" + re.escape(secret) + rb"(?![A-Za-z0-9])", content)
            judgement.check(not found, f"{name} contains {what}")
        date = DATE.search(content)
        judgement.check(not date, f"{name} contains a date: {date and date.group()}")


def main(arguments):
    program, folder, *words = arguments
    folder = pathlib.Path(folder).resolve()
    judgement = Judgement()
    one = bake(judgement, program, folder / "with_one_thread", [*words, "--threads", "1"])
    two = bake(judgement, program, folder / "with_two_threads", [*words, "--threads", "2"])
    kinds = {pathlib.PurePath(name).suffix for name in one}
    judgement.check(kinds == {".abc", ".exr", ".csv"}, f"files are {sorted(one)}")
    judgement.check(sorted(one) == sorted(two), f"files are {sorted(one)} and {sorted(two)}")
    for name in set(one) & set(two):
        judgement.check(one[name] == two[name], f"{name} depends on the number of threads")
        judgement.count("files", 1)
        judgement.count("bytes", len(one[name]))
    judge_contents(judgement, one, folder / "with_one_thread")
    other = bake(judgement, program, folder / "of_another_seed", [*words, "--seed", "4711"])
    for name in one:
        if name.endswith(".abc"):
            judgement.check(one[name] != other[name], f"{name} does not depend on the seed")
    return judgement.conclude("The second bake", ("files", "bytes"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
