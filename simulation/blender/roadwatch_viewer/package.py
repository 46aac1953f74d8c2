"""Makes the add-on's zip: `python -m roadwatch_viewer.package -o roadwatch_viewer.zip`.

It is an extension for Blender 4.2 and newer, and has all it needs: this package, and the meshes of
roadwatch_simulation's models as one file, for Blender's Python lacks what is needed to build them.
"""

from __future__ import annotations

import argparse
import sys
import tempfile
import zipfile
from pathlib import Path

from .errors import ViewerError, make_folder_of
from .kinds import MODELS
from .library import FILE, write_meshes
from .models import build_model

PACKAGE = Path(__file__).parent
LEFT_OUT = (Path(__file__).name, "models.py")
MANIFEST = "blender_manifest.toml"
EPOCH = (2020, 1, 1, 0, 0, 0)
"""Every file's time in the zip: the same sources make the same bytes."""


def build_zip(path: Path) -> None:
    """Writes the zip. Raises ViewerError where roadwatch_simulation or the place to write is missing."""
    meshes = {(kind, detail): build_model(kind, detail) for kind in MODELS for detail in ("full", "simple")}
    make_folder_of(path)
    with tempfile.TemporaryDirectory() as folder, zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as made:
        for source in sorted(PACKAGE.rglob("*.py")) + [PACKAGE / MANIFEST]:
            inside = source.relative_to(PACKAGE)
            if str(inside) not in LEFT_OUT:
                _add(made, inside, source.read_bytes())
        baked = Path(folder) / FILE.name
        write_meshes(baked, meshes)
        _add(made, Path(FILE.name), baked.read_bytes())


def _add(made: zipfile.ZipFile, inside: Path, content: bytes) -> None:
    entry = zipfile.ZipInfo(str(Path(PACKAGE.name) / inside), EPOCH)
    entry.compress_type = zipfile.ZIP_DEFLATED
    entry.external_attr = 0o644 << 16
    made.writestr(entry, content)


def main() -> int:
    """The exit status: 0 written, 1 with a message."""
    parser = argparse.ArgumentParser(
        prog="python -m roadwatch_viewer.package",
        description="Makes the add-on's zip for Blender 4.2 and newer: "
        "install it with Edit > Preferences > Get Extensions > Install from Disk.",
    )
    parser.add_argument(
        "-o", "--output", type=Path, default=Path("roadwatch_viewer.zip"), help="roadwatch_viewer.zip"
    )
    output = parser.parse_args().output
    try:
        build_zip(output)
    except (ViewerError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    print(output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
