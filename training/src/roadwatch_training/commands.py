"""What the commands do."""

from __future__ import annotations

import subprocess
import sys
from argparse import Namespace
from pathlib import Path

from .averaging import AveragedWeights
from .checkpoint import Checkpoint
from .errors import TrainingError
from .export import export
from .images import ImageStore
from .inference import Detector
from .labels import LabelledImage, read_folder
from .network import SHAPES, DetectorNetwork
from .scoring import Scored, score, table
from .settings import Settings
from .trainer import Training

MODEL_NAME = "detector.onnx"
PROGRESS_IMAGES = 50


def run_detector(args: Namespace) -> None:
    """Trains and exports."""
    settings = Settings.from_dict(Checkpoint.read(args.out).settings) if args.resume else _settings(args)
    if not args.resume and args.out.exists() and any(args.out.iterdir()):
        raise TrainingError(f"`{args.out}` is not empty: give --resume to go on, or another --out")
    for folder in args.data:
        if args.simulate and not folder.exists():
            _simulate(folder, args.simulate, settings.seed)
    images = _all_images(args.data)
    _say(f"decoding {len(images)} images")
    training = Training(settings, ImageStore.load(images), args.out, _say)
    if args.resume:
        training.resume()
    elif args.start_from:
        training.start_from(args.start_from)
    parameters = sum(p.numel() for p in training.network.parameters())
    _say(f"training {parameters / 1e6:.2f} M parameters on {len(images)} images: {settings}")
    trained = training.run()
    path = args.out / MODEL_NAME
    export(trained.network, path, _metadata(settings, trained.images))
    _say(f"written: {path} after {trained.images} presentations in {trained.seconds / 60:.1f} min")


def run_export(args: Namespace) -> None:
    """Exports the averaged network of a checkpoint, finished or not."""
    state = Checkpoint.read(args.folder)
    settings = Settings.from_dict(state.settings)
    average = AveragedWeights(DetectorNetwork(SHAPES[settings.width]))
    average.load_state_dict(state.average)
    export(average.network, args.onnx, _metadata(settings, state.batches_done * settings.batch_size))
    _say(f"written: {args.onnx}")


def run_score(args: Namespace) -> None:
    """Prints recall and precision."""
    scored = Scored(min_height_px=args.min_height_px)
    tally = score(Detector(args.model), _all_images(args.data), scored, _progress)
    print(table(tally, args.threshold))


def _settings(args: Namespace) -> Settings:
    return Settings(
        width=args.width,
        width_px=args.window[0],
        height_px=args.window[1],
        batch_size=args.batch,
        images=args.images,
        minutes=args.minutes,
        seed=args.seed,
        learning_rate=args.learning_rate,
        workers=args.workers,
        threads=args.threads,
        compiled=args.compile,
    )


def _simulate(folder: Path, count: int, seed: int) -> None:
    words = ["training", "--output", str(folder), "--count", str(count), "--seed", str(seed)]
    finished = subprocess.run([sys.executable, "-m", "roadwatch_simulation.cli", *words], check=False)
    if finished.returncode:
        raise TrainingError(f"`roadwatch-simulate {' '.join(words)}` failed (its own message is above)")


def _all_images(folders: list[Path]) -> list[LabelledImage]:
    return [image for folder in folders for image in read_folder(folder)]


def _metadata(settings: Settings, images: int) -> dict[str, str]:
    summary = f"{images} presentations, seed {settings.seed}, width {settings.width}"
    return {"author": "Roadwatch", "training": summary}


def _progress(done: int, of: int) -> None:
    if done % PROGRESS_IMAGES == 0 or done == of:
        print(f"{done} of {of} images", file=sys.stderr, flush=True)


def _say(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
