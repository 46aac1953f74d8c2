"""The command line: `roadwatch-simulate`."""

from __future__ import annotations

import argparse
import sys
from collections.abc import Sequence
from pathlib import Path

from .errors import SimulationError
from .progress import Progress

DESCRIPTION = """\
Renders simulated streets with exact truth, as rig datasets that `roadwatch` plays and evaluates.

A scene is a TOML or JSON file, or a named scenario with a seed. The same scene gives the same pictures.
"""
EXAMPLES = """\
examples:
  roadwatch-simulate check street.toml                          is the scene sound? every mistake
  roadwatch-simulate picture street.toml --frame 3 -o look.png  one picture, to see what it looks like
  roadwatch-simulate render street.toml -o made/street          all frames, all cameras, with truth
  roadwatch-simulate scenario traffic --seed 4 --clips -o demo  a scenario by name, as H.264 clips
  roadwatch-simulate training --seed 1 --count 500 -o made/a    labelled single pictures for a detector
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Runs one command; gives the exit status: 0, 1 for a mistake of the input, 130 when interrupted."""
    options = _parser().parse_args(arguments)
    try:
        options.run(options)
    except SimulationError as error:
        print(f"roadwatch-simulate: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("roadwatch-simulate: interrupted", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(
        prog="roadwatch-simulate", description=DESCRIPTION, epilog=EXAMPLES,
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    commands = parser.add_subparsers(title="commands", required=True, metavar="COMMAND")
    _add_render(commands)
    _add_scenario(commands)
    _add_training(commands)
    _add_check(commands)
    _add_picture(commands)
    return parser


def _add_render(commands) -> None:
    command = commands.add_parser("render", help="render a scene file into a rig dataset")
    command.add_argument("scene", type=Path, metavar="SCENE", help="scene description, .toml or .json")
    _add_output_options(command)
    command.set_defaults(run=_render)


def _add_scenario(commands) -> None:
    from .scenarios import SCENARIOS

    names = "\n".join(f"  {name:19} {scenario.about}" for name, scenario in SCENARIOS.items())
    command = commands.add_parser(
        "scenario", help="render a scenario by name", description=f"Renders one of these scenarios:\n{names}",
        formatter_class=argparse.RawDescriptionHelpFormatter,
    )  # fmt: skip
    command.add_argument("name", choices=list(SCENARIOS), metavar="NAME", help=", ".join(SCENARIOS))
    command.add_argument("--seed", type=int, default=0, help="what varies: places, models, light (default 0)")
    command.add_argument("--frames", type=int, help="how many frames (default: the scenario's own)")
    _add_output_options(command)
    command.set_defaults(run=_scenario)


def _add_output_options(command) -> None:
    command.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FOLDER", help="new folder to write"
    )
    command.add_argument(
        "--renderer", choices=["light", "blender"], default="light",
        help="light: OpenGL, fast; blender: Cycles, slow and convincing (default light)",
    )  # fmt: skip
    command.add_argument("--jpeg-quality", type=int, help="1 to 100 (default: the scene's imaging)")
    command.add_argument("--clips", action="store_true", help="H.264 clips instead of images, one per camera")
    command.add_argument("--crf", type=int, default=23, help="quality of clips, 0 best to 51 (default 23)")


def _add_training(commands) -> None:
    command = commands.add_parser(
        "training", help="render labelled single pictures for training a detector",
        description="Writes images/000000.jpg and labels.jsonl. "
        "An interrupted run is taken up by the same command.",
    )  # fmt: skip
    command.add_argument("--seed", type=int, default=0, help="which training set (default 0)")
    command.add_argument("--first", type=int, default=0, help="number of the first picture (default 0)")
    command.add_argument("--count", type=int, required=True, help="how many pictures")
    command.add_argument(
        "-o", "--output", type=Path, required=True, metavar="FOLDER", help="new folder to write"
    )
    command.add_argument("--renderer", choices=["light", "blender"], default="light")
    command.set_defaults(run=_training)


def _add_check(commands) -> None:
    command = commands.add_parser("check", help="read a scene file and report every mistake in it")
    command.add_argument("scene", type=Path, metavar="SCENE")
    command.set_defaults(run=_check)


def _add_picture(commands) -> None:
    command = commands.add_parser("picture", help="render one picture of a scene file")
    command.add_argument("scene", type=Path, metavar="SCENE")
    command.add_argument("--frame", type=int, default=0, help="which frame (default 0)")
    command.add_argument("--camera", help="which camera (default: the first)")
    command.add_argument("--renderer", choices=["light", "blender"], default="light")
    command.add_argument(
        "-o", "--output", type=Path, required=True, metavar="IMAGE", help="a .png or .jpg to write"
    )
    command.set_defaults(run=_picture)


def _render(options: argparse.Namespace) -> None:
    from .scene_file import read_scene

    _write(read_scene(options.scene), options)


def _scenario(options: argparse.Namespace) -> None:
    from .scenarios import build_scenario

    _write(build_scenario(options.name, options.seed, options.frames), options)


def _write(scene, options: argparse.Namespace) -> None:
    from .clips import write_clips_dataset
    from .dataset import write_dataset

    if options.jpeg_quality is not None and not 1 <= options.jpeg_quality <= 100:
        raise SimulationError(f"--jpeg-quality {options.jpeg_quality} has to be 1 to 100")
    common = {"renderer": options.renderer, "progress": Progress("pictures")}
    if options.clips:
        write_clips_dataset(scene, options.output, crf=options.crf, **common)
    else:
        write_dataset(scene, options.output, jpeg_quality=options.jpeg_quality, **common)


def _training(options: argparse.Namespace) -> None:
    from .training_set import TrainingRange, write_training_set

    wanted = TrainingRange(options.seed, options.first, options.count)
    write_training_set(wanted, options.output, renderer=options.renderer, progress=Progress("pictures"))


def _check(options: argparse.Namespace) -> None:
    from .scene_file import read_scene

    scene = read_scene(options.scene)
    print(f"{options.scene}: {scene.frames} frames at {scene.rate_hz:g} Hz, {len(scene.cameras)} cameras, "
          f"{len(scene.objects)} objects; nothing wrong")  # fmt: skip


def _picture(options: argparse.Namespace) -> None:
    from .picture import write_picture
    from .scene_file import read_scene

    write_picture(read_scene(options.scene), options.frame, options.camera, options.output, options.renderer)


if __name__ == "__main__":
    sys.exit(main())
