"""From bytes to scenes: lines cut at any place, lines that are no scene, and whole files."""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

from .errors import MalformedLine, ViewerError
from .schema import Rig, Scene, parse_line

LONGEST_LINE_BYTES = 4 * 1024 * 1024
WARN_EVERY_S = 1.0


class LineBuffer:
    """Puts lines together from pieces."""

    def __init__(self) -> None:
        self._piece = bytearray()

    def push(self, piece: bytes) -> list[bytes]:
        """The lines that this piece completes. Raises MalformedLine for one beyond the schema's limit."""
        *ended, rest = piece.split(b"\n")
        lines = []
        for part in ended:
            self._piece += part
            lines.append(bytes(self._piece))
            self._piece.clear()
        self._piece += rest
        if len(self._piece) > LONGEST_LINE_BYTES:
            raise MalformedLine(f"a line longer than {LONGEST_LINE_BYTES} bytes")
        return lines


class Warnings:
    """Says at most one warning a second on standard error, and how many it kept back."""

    def __init__(self, say: Callable[[str], None] | None = None) -> None:
        self.count = 0
        self._say = say or (lambda text: print(text, file=sys.stderr, flush=True))
        self._unsaid = 0
        self._said_at_s = -WARN_EVERY_S

    def warn(self, text: str) -> None:
        """Counts a warning, and says it if the last one is a second old."""
        self.count += 1
        now_s = time.monotonic()
        if now_s - self._said_at_s < WARN_EVERY_S:
            self._unsaid += 1
            return
        more = f" (and {self._unsaid} more since)" if self._unsaid else ""
        self._say(f"warning: {text}{more}; {self.count} so far")
        self._unsaid, self._said_at_s = 0, now_s


class LineReader:
    """Reads lines of one stream: malformed ones are counted and left out, unknown types ignored."""

    def __init__(self, name: str, warnings: Warnings) -> None:
        self._name, self._warnings = name, warnings
        self._number = 0
        self._has_rig = False

    def read(self, line: bytes) -> Rig | Scene | None:
        """What the line says, None for nothing. Raises NewerVersion."""
        self._number += 1
        if not line.strip():
            return None
        try:
            said = parse_line(line)
            if isinstance(said, Scene) and not self._has_rig:
                raise MalformedLine("a scene before the line that says the schema's version")
        except MalformedLine as error:
            self._warnings.warn(f"{self._name}:{self._number}: line left out: {error}")
            return None
        self._has_rig = self._has_rig or isinstance(said, Rig)
        return said


@dataclass
class Recording:
    """A whole file: its rig, its scenes in order of their stamps, and how many lines were left out."""

    rig: Rig
    scenes: list[Scene] = field(default_factory=list)
    left_out: int = 0

    @property
    def seconds(self) -> float:
        """From the first scene's stamp to the last one's."""
        return (self.scenes[-1].stamp_ns - self.scenes[0].stamp_ns) * 1e-9


def read_recording(path: Path) -> Recording:
    """All scenes of a file. Raises ViewerError when there are none, and NewerVersion."""
    warnings = Warnings()
    reader = LineReader(str(path), warnings)
    rig: Rig | None = None
    scenes: list[Scene] = []
    for line in _lines(path):
        said = reader.read(line)
        if isinstance(said, Rig):
            rig = said
        elif isinstance(said, Scene):
            scenes.append(said)
    if rig is None or not scenes:
        missing = "no rig line" if rig is None else "no scene"
        raise ViewerError(
            f"{path}: {missing} in it ({warnings.count} lines left out): "
            "make one with `roadwatch export scene --bag DIR -o scene.jsonl`"
        )
    scenes.sort(key=lambda scene: scene.stamp_ns)
    return Recording(rig, scenes, warnings.count)


def _lines(path: Path) -> Iterator[bytes]:
    """Lines of a file, one too long for the schema cut so that it counts as malformed."""
    try:
        with path.open("rb") as file:
            while line := file.readline(LONGEST_LINE_BYTES + 1):
                yield line
    except OSError as error:
        raise ViewerError(f"cannot read {path}: {error.strerror}") from error
