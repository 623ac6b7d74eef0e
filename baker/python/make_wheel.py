"""Packs the wheel for pip, with the program and its libraries: the same files give the same bytes.

    make_wheel.py FOLDER BUNDLE VERSION      FOLDER/paperbake-VERSION-py3-none-PLATFORM.whl

BUNDLE      made by cmake/bundle.py
PLATFORM    manylinux_2_N_x86_64: the oldest C library that has every symbol that the program and
            its libraries ask for

Prints the path of the wheel on stdout and its size on stderr.
"""

import base64
import hashlib
import pathlib
import re
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "cmake"))
from fixed_zip import files_under, write_zip  # noqa: E402

METADATA = """\
Metadata-Version: 2.1
Name: paperbake
Version: {version}
Summary: Bakes paper animation from keyed handles
Author: The authors of paperbake
License: GPL-3.0-or-later
Requires-Python: >=3.9
Description-Content-Type: text/markdown

{readme}"""
WHEEL = """\
Wheel-Version: 1.0
Generator: paperbake
Root-Is-Purelib: false
Tag: {tag}
"""
ENTRY_POINTS = """\
[console_scripts]
paperbake = paperbake.program:main
"""


def platform_of(bundle):
    """The platform tag: N is of the newest symbol of glibc that a file of the bundle names."""
    files = [bundle / "bin" / "paperbake", *(bundle / "lib").iterdir()]
    listed = subprocess.run(["objdump", "-T", *files], check=True, capture_output=True, text=True)
    newest = max(int(minor) for minor in re.findall(r"GLIBC_2[.]([0-9]+)", listed.stdout))
    return f"manylinux_2_{newest}_x86_64"


def record_of(entries, name):
    """RECORD: name, hash and size of every file but itself."""
    lines = []
    for entry, source in sorted(entries.items()):
        data = source if isinstance(source, bytes) else source.read_bytes()
        digest = base64.urlsafe_b64encode(hashlib.sha256(data).digest()).rstrip(b"=").decode()
        lines.append(f"{entry},sha256={digest},{len(data)}\n")
    return "".join([*lines, f"{name},,\n"]).encode()


def entries_of(bundle, version, tag, info):
    """{name in the wheel: path or bytes}; info: the folder of the metadata."""
    program = files_under(bundle, "paperbake/bundled").items()
    readme = (HERE / "README.md").read_text(encoding="utf-8")
    entries = {
        **files_under(HERE / "paperbake", "paperbake"),
        **{name: path for name, path in program if path.parent.name != "licenses"},
        **files_under(bundle / "licenses", f"{info}/licenses"),
        f"{info}/METADATA": METADATA.format(version=version, readme=readme).encode(),
        f"{info}/WHEEL": WHEEL.format(tag=tag).encode(),
        f"{info}/entry_points.txt": ENTRY_POINTS.encode(),
    }
    entries[f"{info}/RECORD"] = record_of(entries, f"{info}/RECORD")
    return entries


def packed(folder, bundle, version):
    """Returns the path of the wheel."""
    tag = f"py3-none-{platform_of(bundle)}"
    info = f"paperbake-{version}.dist-info"
    entries = entries_of(bundle, version, tag, info)
    path = folder / f"paperbake-{version}-{tag}.whl"
    write_zip(path, entries, last={name for name in entries if name.startswith(info)})
    return path


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    made = packed(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]), sys.argv[3])
    print(made)
    print(f"{made.stat().st_size / 1e6:.1f} MB", file=sys.stderr)
