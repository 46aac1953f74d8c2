"""`python -m roadwatch_viewer`; or `blender --background --python roadwatch_viewer/__main__.py -- ...`."""

import sys
from pathlib import Path

if not __package__:
    # Blender runs this file by its path: then the package's folder is not where Python looks.
    sys.path.insert(0, str(Path(__file__).resolve().parent.parent))

from roadwatch_viewer.cli import program

arguments = sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv and not __package__ else sys.argv[1:]
program(arguments)
