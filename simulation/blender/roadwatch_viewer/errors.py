"""What this package raises for anything its user can put right."""

from __future__ import annotations

from pathlib import Path


class ViewerError(Exception):
    """A mistake in the input or a missing part: the message says what, where and what to do."""


class MalformedLine(Exception):
    """A line that is not what docs/scene-stream.md says: it is counted and left out."""


class NewerVersion(ViewerError):
    """The stream speaks a newer schema than this viewer knows: reading on would show wrong things."""


def make_folder_of(path: Path) -> None:
    """Makes the folder that a file is to be written to. Raises ViewerError where that cannot be."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise ViewerError(f"cannot write {path}: {error.filename}: {error.strerror}") from error
