"""Packs the extension for Blender's "Install from Disk": the same files give the same bytes.

    make_zip.py FOLDER                   the add-on alone, for a program that is there already:
                                         FOLDER/paperbake_blender-VERSION.zip
    make_zip.py FOLDER BUNDLE VERSION    with the program and its libraries, which cmake/bundle.py
                                         has put into BUNDLE:
                                         FOLDER/paperbake_blender-VERSION-linux-x64.zip

Prints the path of the zip on stdout and its size on stderr. The second form is what
`cmake --build build --target blender_addon` runs.
"""

import pathlib
import sys
import tomllib

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent.parent / "cmake"))
from fixed_zip import files_under, write_zip  # noqa: E402

LEFT_OUT = {"make_zip.py", "make_icons.py"}
MANIFEST = "blender_manifest.toml"
PLATFORM = "linux-x64"  # Blender's word


def own_files():
    files = (file for kind in ("*.py", "*.toml", "*.md", "icons/*.png") for file in HERE.glob(kind))
    return {str(file.relative_to(HERE)): file for file in files if file.name not in LEFT_OUT}


def manifest_of_platform(text):
    """The manifest of a zip that is for one platform only."""
    return text.replace("\n[permissions]", f'platforms = ["{PLATFORM}"]\n\n[permissions]').encode()


def packed(folder, bundle=None, version=None):
    """Returns the path of the zip."""
    manifest = (HERE / MANIFEST).read_text(encoding="utf-8")
    own_version = tomllib.loads(manifest)["version"]
    if bundle is None:
        path, entries = folder / f"paperbake_blender-{own_version}.zip", own_files()
    else:
        if version.split("+")[0] != own_version:
            sys.exit(f"make_zip.py: {HERE / MANIFEST}\n  The add-on is of version {own_version}, "
                     f"the program of {version}.\n  Give both the same version.")
        path = folder / f"paperbake_blender-{version}-{PLATFORM}.zip"
        entries = {**own_files(), MANIFEST: manifest_of_platform(manifest),
                   **files_under(bundle, "bundled")}
    write_zip(path, entries)
    return path


if __name__ == "__main__":
    if len(sys.argv) not in (2, 4):
        sys.exit(__doc__)
    made = packed(pathlib.Path(sys.argv[1]), *sys.argv[2:])
    print(made)
    print(f"{made.stat().st_size / 1e6:.1f} MB", file=sys.stderr)
