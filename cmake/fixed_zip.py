"""Zips that depend on nothing but what is in them: names in order, one time for all, no owner."""

import os
import pathlib
import stat
import zipfile

EARLIEST = (1980, 1, 1, 0, 0, 0)  # of the format


def files_under(folder, name):
    """{name in the zip: path} of all files of the folder, as if it were called `name`."""
    folder = pathlib.Path(folder)
    files = (path for path in folder.rglob("*") if path.is_file())
    return {f"{name}/{path.relative_to(folder).as_posix()}": path for path in files
            if "__pycache__" not in path.parts}


def write_zip(path, entries, last=()):
    """The same entries give the same bytes, with the same zlib.

    entries   {name in the zip: path of the file, or its bytes}
    last      names that come at the end
    """
    path.parent.mkdir(parents=True, exist_ok=True)
    part = path.with_name(path.name + ".part")
    with zipfile.ZipFile(part, "w") as archive:
        for name in sorted(entries, key=lambda name: (name in last, name)):
            source = entries[name]
            runs = isinstance(source, pathlib.Path) and os.access(source, os.X_OK)
            entry = zipfile.ZipInfo(name, EARLIEST)
            entry.external_attr = (stat.S_IFREG | (0o755 if runs else 0o644)) << 16
            data = source if isinstance(source, bytes) else source.read_bytes()
            archive.writestr(entry, data, zipfile.ZIP_DEFLATED)
    part.replace(path)
