"""The commands `parts` and `score-parts`."""

from __future__ import annotations

import sys
from argparse import ArgumentParser, ArgumentTypeError, Namespace, _SubParsersAction
from pathlib import Path

import numpy as np

from ..errors import TrainingError
from .components import COMPONENTS
from .export import HeadNotes, export
from .features import FeatureSource, FrozenFeatures, InputFormat
from .inference import PartsModel
from .recipe import PartsExample, Recipe, example, plain_example
from .rig import rig_examples
from .scoring import best_thresholds, component_scores, component_table, facing_score, facing_table, find_all
from .settings import PartsSettings
from .trainer import PartsTraining
from .vehicles import Vehicle, VehicleSets, read_vehicles

MODEL_NAME = "head.onnx"
# Of a component, where there are no held-out vehicles to choose by.
DEFAULT_THRESHOLD = 0.4
THRESHOLD_SEED, THRESHOLD_CROPS = 4711, 1500
PROGRESS_PICTURES = 100
INPUT_FORMATS = {"rgb-1": InputFormat("rgb", 1 / 255), "bgr-255": InputFormat("bgr", 1.0)}


def add_commands(commands: _SubParsersAction) -> None:
    """Declares both."""
    _add_parts(commands.add_parser("parts", help="train the key-component head and export it"))
    _add_score(commands.add_parser("score-parts", help="what a key-component head finds"))


def _add_parts(parser: ArgumentParser) -> None:
    default, add = PartsSettings(), parser.add_argument
    add("--detector", type=Path, required=True, help="ONNX file whose features are used")
    add("--data", type=Path, required=True, action="append", help="folder with labels.jsonl; repeatable")
    add("--out", type=Path, required=True, help=f"folder for {MODEL_NAME}")
    add("--side", type=int, default=default.side_px, help="of a crop, pixels (%(default)s)")
    add("--batch", type=int, default=default.batch_size, help="crops per step (%(default)s)")
    add("--crops", type=int, default=default.crops, help="crops in all (%(default)s)")
    add("--minutes", type=float, help="end by then, whatever --crops says")
    add("--seed", type=int, default=default.seed, help="of weights and crops (%(default)s)")
    add("--learning-rate", type=float, default=default.learning_rate, help="at its highest (%(default)s)")
    add("--workers", type=int, default=default.workers, help="processes that make crops (%(default)s)")
    add("--threads", type=int, default=default.threads, help="of features and steps (%(default)s)")
    maps = "feature maps of strides 8, 16, 32 of a detector that is not known"
    add("--tensors", type=_three_names, metavar="A,B,C", help=maps)
    add("--input", choices=INPUT_FORMATS, help="that detector's pixels: order and range")
    parser.set_defaults(run=run_parts)


def _add_score(parser: ArgumentParser) -> None:
    add = parser.add_argument
    add("--detector", type=Path, required=True, help="ONNX file that the head belongs to")
    add("--head", type=Path, required=True, help="ONNX file of the head")
    unseen = "folder of pictures that were not trained on; repeatable"
    add("--data", type=Path, action="append", default=[], help=unseen)
    add("--rig", type=Path, action="append", default=[], help="rig dataset with truth; repeatable")
    parser.set_defaults(run=run_score_parts)


def run_parts(args: Namespace) -> None:
    """Trains, exports and scores on the held-out pictures."""
    settings = _settings(args)
    features = FrozenFeatures(args.detector, _source(args), settings.threads)
    sets = _read_all(args.data)
    training = PartsTraining(settings, features, _say)
    parameters = sum(p.numel() for p in training.head.parameters())
    _say(f"training {parameters / 1e3:.0f} k parameters on {len(sets.trained_on)} vehicles: {settings}")
    trained = training.run(sets.trained_on)
    path = args.out / MODEL_NAME
    summary = f"{trained.crops} crops of {len(sets.trained_on)} simulated vehicles, seed {settings.seed}"
    thresholds = (DEFAULT_THRESHOLD,) * len(COMPONENTS)
    export(trained.head, features, settings.side_px, path, HeadNotes(thresholds, summary))
    if sets.held_out:
        thresholds = _thresholds(PartsModel(args.detector, path), sets.held_out)
        export(trained.head, features, settings.side_px, path, HeadNotes(thresholds, summary))
    _say(f"written: {path} ({path.stat().st_size // 1000} kB) in {trained.seconds / 60:.1f} min")
    print(_report(PartsModel(args.detector, path), sets.held_out))


def run_score_parts(args: Namespace) -> None:
    """Prints what the head finds in simulated pictures and in rig datasets."""
    if not args.data and not args.rig:
        raise TrainingError("nothing to score on: give --data or --rig")
    model = PartsModel(args.detector, args.head)
    if args.data:
        sets = _read_all(args.data)
        print(_report(model, sets.trained_on + sets.held_out))
    scores = {}
    for folder in args.rig:
        examples = list(rig_examples(folder, model.side_px))
        if not examples:
            raise TrainingError(f"`{folder}` has no vehicle that counts")
        scores[folder.name] = facing_score(find_all(model, examples).facing, _angles(examples))
    if scores:
        print(facing_table(scores))


def _thresholds(model: PartsModel, vehicles: list[Vehicle]) -> tuple[float, ...]:
    """Set on crops changed as in training: what suits clean ones is too low for the street."""
    changed = [
        example(
            vehicles[n % len(vehicles)], model.side_px, Recipe(), np.random.default_rng((THRESHOLD_SEED, n))
        )
        for n in range(THRESHOLD_CROPS)
    ]
    return tuple(float(t) for t in best_thresholds(find_all(model, changed), changed).round(3))


def _report(model: PartsModel, vehicles: list[Vehicle]) -> str:
    framed = (plain_example(vehicle, model.side_px) for vehicle in vehicles if vehicle.is_clean_car)
    examples = [made for made in framed if made is not None]
    if not examples:
        return "no clean car to score on"
    found = find_all(model, examples)
    components = component_scores(found, examples, model.components, model.thresholds)
    facing = facing_score(found.facing, _angles(examples))
    return f"{component_table(components)}\n\n{facing_table({'simulated': facing})}\n"


def _angles(examples: list[PartsExample]) -> np.ndarray:
    return np.array([made.angle_rad for made in examples])


def _settings(args: Namespace) -> PartsSettings:
    return PartsSettings(
        side_px=args.side,
        batch_size=args.batch,
        crops=args.crops,
        minutes=args.minutes,
        seed=args.seed,
        learning_rate=args.learning_rate,
        workers=args.workers,
        threads=args.threads,
    )


def _source(args: Namespace) -> FeatureSource | None:
    if (args.tensors is None) != (args.input is None):
        raise TrainingError("--tensors and --input belong together: give both or neither")
    return FeatureSource(args.tensors, INPUT_FORMATS[args.input]) if args.tensors else None


def _three_names(text: str) -> tuple[str, str, str]:
    names = text.split(",")
    if len(names) != 3:
        raise ArgumentTypeError(f"`{text}` is no list of three tensors, A,B,C")
    return names[0], names[1], names[2]


def _read_all(folders: list[Path]) -> VehicleSets:
    sets = VehicleSets([], [])
    for folder in folders:
        read = read_vehicles(folder, _progress)
        sets.trained_on.extend(read.trained_on)
        sets.held_out.extend(read.held_out)
    if not sets.trained_on:
        raise TrainingError(f"no vehicle can be used in {', '.join(map(str, folders))}")
    return sets


def _progress(done: int, of: int) -> None:
    if done % PROGRESS_PICTURES == 0 or done == of:
        _say(f"read {done} of {of} pictures")


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
