"""Packs the add-on for Blender's "Install from Disk": the same files give the same bytes.

    make_zip.py FOLDER        writes FOLDER/paperbake_blender-VERSION.zip and prints its path
"""

import pathlib
import sys
import tomllib
import zipfile

HERE = pathlib.Path(__file__).resolve().parent
LEFT_OUT = {"make_zip.py"}
EARLIEST = (1980, 1, 1, 0, 0, 0)  # of the format


def packed(folder):
    version = tomllib.loads((HERE / "blender_manifest.toml").read_text(encoding="utf-8"))["version"]
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"paperbake_blender-{version}.zip"
    with zipfile.ZipFile(path, "w") as archive:
        for file in sorted(file for kind in ("*.py", "*.toml", "*.md") for file in HERE.glob(kind) if file.name not in LEFT_OUT):
            entry = zipfile.ZipInfo(file.name, EARLIEST)
            entry.external_attr = 0o644 << 16
            archive.writestr(entry, file.read_bytes(), zipfile.ZIP_STORED)  # deflate differs from one zlib to the next
    return path


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: make_zip.py FOLDER")
    print(packed(pathlib.Path(sys.argv[1])))
