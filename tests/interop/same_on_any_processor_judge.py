"""Bakes a scene as different processors would: with the kernels that OpenBLAS has for each of them, and with the C library kept
from the instructions that older ones lack. All give the same bytes. And the program asks neither a BLAS nor the C library for
anything that they compute in another way on another processor.

    same_on_any_processor_judge.py PAPERBAKE FOLDER SCENE [OPTION of paperbake bake]...

Prints one line for each check that failed and exits with 1, or what was compared and exits with 0.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

from judgement import Judgement

PROCESSORS = {
    "as it is": {},
    "Sandy Bridge": {"OPENBLAS_CORETYPE": "Sandybridge", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX2,-FMA,-FMA4,-AVX512F"},
    "Haswell": {"OPENBLAS_CORETYPE": "Haswell", "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F"},
    "Skylake": {"OPENBLAS_CORETYPE": "SkylakeX"},
}
# what the C library has in several versions, of which it takes one when the program starts: with and without FMA
OF_SEVERAL_VERSIONS = set("sin cos sincos tan asin acos atan atan2 exp log pow sinf cosf sincosf expf exp2f logf log2f powf".split())
BLAS = re.compile(r"(cblas_)?[sd](gemm|syrk|trsm|potrf|gemv|trsv|dot|axpy|nrm2|scal)_?")


def bake(judgement, program, folder, words, environment):
    shutil.rmtree(folder, ignore_errors=True)
    done = subprocess.run([program, "bake", *words, "-o", str(folder), "--progress", "none"], stdout=subprocess.DEVNULL,
                          env={**os.environ, **environment}, check=False)
    judgement.check(done.returncode in (0, 4), f"{folder}: paperbake ended with {done.returncode}")
    files = [*folder.glob("*.abc"), *folder.glob("maps/*"), *folder.glob("singular.csv")]
    return {str(path.relative_to(folder)): path.read_bytes() for path in files}


def judge_calls(judgement, program):
    """The names that the program asks of shared libraries."""
    symbols = subprocess.run(["nm", "--dynamic", "--undefined-only", program], capture_output=True, text=True, check=True).stdout
    names = {line.split()[-1].split("@")[0] for line in symbols.splitlines()}
    judgement.check(len(names) > 100, f"{program} asks for {len(names)} names only")
    found = sorted(name for name in names if name in OF_SEVERAL_VERSIONS or BLAS.fullmatch(name))
    judgement.check(not found, f"the program calls {', '.join(found)}, which differ by processor")


def main(arguments):
    program, folder, *words = arguments
    folder = pathlib.Path(folder).resolve()
    judgement = Judgement()
    judge_calls(judgement, program)
    baked = {name: bake(judgement, program, folder / name.replace(" ", "_"), words, environment)
             for name, environment in PROCESSORS.items()}
    first, *others = baked
    judgement.check(len(baked[first]) >= 3, f"files are {sorted(baked[first])}")
    for name in others:
        judgement.check(sorted(baked[name]) == sorted(baked[first]), f"{name}: files are {sorted(baked[name])}")
        for file in set(baked[name]) & set(baked[first]):
            judgement.check(baked[name][file] == baked[first][file], f"{file} depends on the processor: {name}")
            judgement.count("files", 1)
            judgement.count("bytes", len(baked[name][file]))
    return judgement.conclude("The bake on other processors", ("files", "bytes"))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
