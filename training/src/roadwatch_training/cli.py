"""`python -m roadwatch_training`: train, export, score."""

from __future__ import annotations

import argparse
import sys
from pathlib import Path

from .commands import run_detector, run_export, run_score
from .errors import TrainingError
from .inference import DEFAULT_SCORE_THRESHOLD
from .network import SHAPES
from .parts.commands import add_commands
from .settings import Settings


def main(arguments: list[str] | None = None) -> int:
    """Runs a command; 1 when the user must put something right."""
    args = _parser().parse_args(arguments)
    try:
        args.run(args)
    except TrainingError as error:
        print(f"error: {error}", file=sys.stderr)
        return 1
    except KeyboardInterrupt:
        print("interrupted; go on with --resume", file=sys.stderr)
        return 130
    return 0


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="roadwatch_training", description=__doc__)
    commands = parser.add_subparsers(required=True, metavar="COMMAND")
    _add_detector(commands)
    export = commands.add_parser("export", help="write the ONNX file of a training's checkpoint")
    export.add_argument("--run", dest="folder", type=Path, required=True, help="folder with checkpoint.pt")
    export.add_argument("--onnx", type=Path, required=True, help="file to write")
    export.set_defaults(run=run_export)
    score = commands.add_parser("score", help="recall and precision on labelled pictures")
    add = score.add_argument
    add("--model", type=Path, required=True, help="ONNX file")
    add("--data", type=Path, required=True, action="append", help="folder with labels.jsonl; repeatable")
    add("--threshold", type=float, default=DEFAULT_SCORE_THRESHOLD, help="least score (%(default)s)")
    add("--min-height-px", type=float, default=24.0, help="least height of an object (%(default)s)")
    score.set_defaults(run=run_score)
    add_commands(commands)
    return parser


def _add_detector(commands: argparse._SubParsersAction) -> None:
    default = Settings()
    train = commands.add_parser("detector", help="train the detector and export it")
    add = train.add_argument
    add("--data", type=Path, required=True, action="append", help="folder with labels.jsonl; repeatable")
    add("--simulate", type=int, metavar="COUNT", help="pictures of a --data folder that is missing")
    add("--out", type=Path, required=True, help="folder for the checkpoint and detector.onnx")
    begin = train.add_mutually_exclusive_group()
    begin.add_argument(
        "--resume", action="store_true", help="go on from the checkpoint in --out, with its settings"
    )
    begin.add_argument(
        "--start-from",
        type=Path,
        metavar="RUN",
        help="begin with the weights of another --out, or of an exported .onnx file, not with random ones",
    )
    add("--width", choices=SHAPES, default=default.width, help="channels of the network (%(default)s)")
    window = (default.width_px, default.height_px)
    add("--window", type=_size, default=window, metavar="WxH", help="cut out for training (416x256)")
    add("--batch", type=int, default=default.batch_size, help="examples per step (%(default)s)")
    add("--images", type=int, default=default.images, help="examples in all (%(default)s)")
    add("--minutes", type=float, help="end by then, whatever --images says")
    add("--seed", type=int, default=default.seed, help="of weights, examples, simulation (%(default)s)")
    add("--learning-rate", type=float, default=default.learning_rate, help="at its highest (%(default)s)")
    add("--workers", type=int, default=default.workers, help="processes that make examples (%(default)s)")
    add("--threads", type=int, default=default.threads, help="of the network's steps; 0 for all cores")
    add("--compile", action="store_true", help="starts minutes later, then a third faster (needs g++)")
    train.set_defaults(run=run_detector)


def _size(text: str) -> tuple[int, int]:
    width, _, height = text.partition("x")
    if not (width.isdigit() and height.isdigit()):
        raise argparse.ArgumentTypeError(f"`{text}` is no size such as 416x256")
    return int(width), int(height)
