"""The program: `python -m roadwatch_viewer`, and the same from within Blender."""

from __future__ import annotations

import argparse
import dataclasses
import os
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import NoReturn

from .errors import ViewerError
from .settings import Settings, load_settings

DESCRIPTION = """\
Roadwatch's scene in Blender: vehicles and people with their boxes, headings and identities, around the rig.

  replay         a recording (roadwatch export scene --bag DIR -o scene.jsonl): stills, clips, a .blend
  follow         a running daemon ([scene_stream] in its configuration)
  side-by-side   one picture: a camera's image with boxes over it, and the scene from behind and above
"""
EXAMPLES = """\
examples:
  python -m roadwatch_viewer replay scene.jsonl --still at3.png --at 3
  python -m roadwatch_viewer replay scene.jsonl --images DATA --view front --clip a.mp4 --from 2 --seconds 3
  python -m roadwatch_viewer replay scene.jsonl --save scene.blend        # then open it and press play
  python -m roadwatch_viewer follow 127.0.0.1:7600 --settings viewer.toml # change the file while it runs
  python -m roadwatch_viewer side-by-side scene.jsonl --images DATA --camera front --at 3 -o picture.png
  blender --background --command roadwatch_viewer replay scene.jsonl --still a.png   # with the add-on
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs a command; the exit status: 0 done, 1 with a message that says what to do, 2 wrong usage."""
    typed = _parser().parse_args(arguments)
    try:
        typed.run(typed)
    except ViewerError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    return 0


def program(arguments: Sequence[str] | None = None) -> NoReturn:
    """`main` as a process of its own."""
    status = main(arguments)
    sys.stdout.flush()
    if threading.active_count() > 1:
        # A connection attempt may still run, and Blender's Python module waits for ever for such a thread.
        os._exit(status)
    sys.exit(status)


def _parser() -> argparse.ArgumentParser:
    raw = argparse.RawDescriptionHelpFormatter
    parser = argparse.ArgumentParser(
        prog="roadwatch_viewer", description=DESCRIPTION, epilog=EXAMPLES, formatter_class=raw
    )
    commands = parser.add_subparsers(required=True, metavar="replay|follow|side-by-side")
    replay = commands.add_parser(
        "replay", help="put a recorded scene into Blender", epilog=EXAMPLES, formatter_class=raw
    )
    replay.add_argument("recording", type=Path, help="scene.jsonl, as `roadwatch export scene` writes it")
    replay.add_argument(
        "--images", type=Path, metavar="DATASET", help="rig dataset whose images stand behind the cameras"
    )
    _add_outputs(replay)
    replay.add_argument(
        "--at", type=float, default=0.0, metavar="S", help="time of the still, s since the first scene (0)"
    )
    replay.add_argument("--clip", type=Path, metavar="MP4", help="render an H.264 clip")
    replay.add_argument(
        "--from", type=float, default=0.0, dest="from_s", metavar="S", help="where the clip begins (0)"
    )
    replay.add_argument(
        "--seconds", type=float, default=1e9, metavar="S", help="how long the clip is (to the end)"
    )
    replay.set_defaults(run=_replay)
    follow = commands.add_parser(
        "follow", help="show a running daemon's scene", epilog=EXAMPLES, formatter_class=raw
    )
    follow.add_argument("address", metavar="HOST:PORT", help="where the daemon's scene stream listens")
    follow.add_argument("--seconds", type=float, metavar="S", help="stop after so long (at Ctrl-C)")
    follow.add_argument("--report", type=Path, metavar="JSON", help="write how long scenes took, in ms")
    _add_outputs(follow)
    follow.set_defaults(run=_follow)
    _add_side_by_side(commands)
    return parser


def _add_side_by_side(commands: argparse._SubParsersAction) -> None:
    command = commands.add_parser(
        "side-by-side",
        help="a picture of what a camera saw, and of the scene beside it",
        epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )
    command.add_argument("recording", type=Path, help="scene.jsonl, as `roadwatch export scene` writes it")
    command.add_argument(
        "--images", type=Path, metavar="DATASET", required=True, help="rig dataset with the images"
    )
    command.add_argument("--camera", required=True, help="whose image is on the left")
    command.add_argument(
        "--at",
        type=float,
        default=0.0,
        metavar="S",
        help="its image nearest to this time, s since the first scene (0)",
    )
    command.add_argument(
        "-o", "--output", type=Path, metavar="FILE", required=True, help="the picture, .png or .jpg"
    )
    _add_look(command)
    command.set_defaults(run=_side_by_side, fps=None)


def _add_look(command: argparse.ArgumentParser) -> None:
    command.add_argument(
        "--settings", type=Path, metavar="TOML", help="what is drawn, how finely: see viewer.toml"
    )
    command.add_argument(
        "--view", default="overview", help="overview, top, or a camera of the rig (overview)"
    )


def _add_outputs(command: argparse.ArgumentParser) -> None:
    _add_look(command)
    command.add_argument("--still", type=Path, metavar="PNG", help="render a picture")
    command.add_argument("--save", type=Path, metavar="BLEND", help="save as a file of Blender's")
    command.add_argument("--fps", type=int, help="frames a second of Blender's clock (settings, 30)")


def _replay(typed: argparse.Namespace) -> None:
    from .commands import Clip, Outputs, Still, run_replay

    if not (typed.still or typed.clip or typed.save):
        raise ViewerError("nothing to make: say --still PNG, --clip MP4 or --save BLEND")
    outputs = Outputs(
        typed.view,
        Still(typed.still, typed.at) if typed.still else None,
        Clip(typed.clip, typed.from_s, typed.seconds) if typed.clip else None,
        typed.save,
    )
    run_replay(typed.recording, typed.images, _settings(typed), outputs)


def _follow(typed: argparse.Namespace) -> None:
    from .commands import LiveSettings, Outputs, Still, run_follow
    from .follower import Address

    outputs = Outputs(typed.view, Still(typed.still, 0.0) if typed.still else None, None, typed.save)
    settings = LiveSettings(typed.settings, _settings(typed))
    run_follow(Address.parse(typed.address), typed.seconds, typed.report, settings, outputs)


def _side_by_side(typed: argparse.Namespace) -> None:
    from .commands import Still, run_side_by_side

    picture = Still(typed.output, typed.at)
    run_side_by_side(typed.recording, typed.images, typed.camera, typed.view, _settings(typed), picture)


def _settings(typed: argparse.Namespace) -> Settings:
    read = load_settings(typed.settings) if typed.settings else Settings()
    return dataclasses.replace(read, fps=typed.fps) if typed.fps else read
