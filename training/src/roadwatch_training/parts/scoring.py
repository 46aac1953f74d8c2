"""How many components a head finds, how many it names are there, and whether it tells front from back."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from .angles import likely_angle, mean_angle, probability_at, wrapped
from .components import MIRRORED
from .inference import FoundParts, PartsModel
from .recipe import PartsExample

# A component counts as found within one heat-map cell of its place.
NEAR_PX = 8.0
NEAR_ANGLE_RAD, FLIPPED_RAD = math.radians(45), math.radians(135)
# Mirror images no further apart than this are one heading.
SAME_RAD = math.radians(30)
CROPS_AT_ONCE = 32
THRESHOLDS = np.linspace(0.1, 0.9, 33)


@dataclass(frozen=True)
class ComponentScore:
    """Of the components seen, the share found; of those named, the share that is there; pixels off."""

    name: str
    seen: int
    recall: float
    precision: float
    median_off_px: float


@dataclass(frozen=True)
class FacingScore:
    """Shares of vehicles: likely bin within 45 degrees and beyond 135, and choices among given headings.

    `median_off_rad` is of the mean angle, finer than bins. `front_or_back` chooses between the true angle and
    its opposite, `of_four` among these and their mirror images about the ray, each by the probability there.
    """

    count: int
    median_off_rad: float
    near: float
    flipped: float
    front_or_back: float
    of_four: float


def find_all(model: PartsModel, examples: list[PartsExample]) -> FoundParts:
    """What the model finds in examples of its side."""
    starts = range(0, len(examples), CROPS_AT_ONCE)
    found = [model.find(np.stack([e.crop for e in examples[at : at + CROPS_AT_ONCE]])) for at in starts]
    return FoundParts(
        *(np.concatenate([getattr(f, k) for f in found]) for k in ("points_px", "scores", "facing"))
    )


def component_scores(
    found: FoundParts, examples: list[PartsExample], names: Iterable[str], thresholds: np.ndarray
) -> list[ComponentScore]:
    """One score per component, in order; a component is named where its score reaches its threshold."""
    visible, off = _truth(found, examples)
    named = found.scores >= thresholds
    right = named & visible & (off <= NEAR_PX)
    scores = []
    for at, name in enumerate(names):
        seen, hits = int(visible[:, at].sum()), int(right[:, at].sum())
        median = float(np.median(off[right[:, at], at])) if hits else math.nan
        precision = hits / max(int(named[:, at].sum()), 1)
        scores.append(ComponentScore(name, seen, hits / max(seen, 1), precision, median))
    return scores


def best_thresholds(found: FoundParts, examples: list[PartsExample]) -> np.ndarray:
    """For each component the threshold of the best balance (F1) of recall and precision: (components,).

    Left and right have one in common: twice as many components decide it.
    """
    visible, off = _truth(found, examples)
    there = visible & (off <= NEAR_PX)
    named = found.scores[None] >= THRESHOLDS[:, None, None]
    hits, total = (named & there).sum(1), named.sum(1) + visible.sum(0)
    balance = (hits + hits[:, MIRRORED]) / np.maximum(total + total[:, MIRRORED], 1)
    return THRESHOLDS[balance.argmax(0)]


def facing_score(facing: np.ndarray, angles_rad: np.ndarray) -> FacingScore:
    """`facing` (n, bins) against the true observation angles (n,)."""
    off = np.abs(wrapped(likely_angle(facing) - angles_rad))
    candidates = (angles_rad, angles_rad + math.pi, -angles_rad, math.pi - angles_rad)
    chances = np.stack([probability_at(facing, angle) for angle in candidates])
    # Seen straight from behind or the side, a mirror image is the same heading and its choice no mistake.
    distance = np.abs(wrapped(np.stack(candidates) - angles_rad))
    chosen = np.take_along_axis(distance, chances.argmax(0)[None], 0)[0]
    return FacingScore(
        count=len(angles_rad),
        median_off_rad=float(np.median(np.abs(wrapped(mean_angle(facing) - angles_rad)))),
        near=float((off <= NEAR_ANGLE_RAD).mean()),
        flipped=float((off > FLIPPED_RAD).mean()),
        front_or_back=float((chances[0] > chances[1]).mean()),
        of_four=float((chosen <= SAME_RAD).mean()),
    )


def component_table(scores: list[ComponentScore]) -> str:
    """Markdown."""
    lines = [f"within {NEAR_PX:.0f} px of the crop", ""]
    lines += ["| component | seen | recall | precision | median px off |", "|---|---|---|---|---|"]
    for one in scores:
        numbers = f"{one.recall:.3f} | {one.precision:.3f} | {one.median_off_px:.1f}"
        lines.append(f"| {one.name} | {one.seen} | {numbers} |")
    return "\n".join(lines)


def facing_table(scores: dict[str, FacingScore]) -> str:
    """Markdown, a row a set of vehicles."""
    columns = ("vehicles", "count", "median off", "within 45 degrees", "flipped", "front or back", "of four")
    lines = [f"| {' | '.join(columns)} |", "|---" * len(columns) + "|"]
    for name, one in scores.items():
        shares = " | ".join(f"{v:.3f}" for v in (one.near, one.flipped, one.front_or_back, one.of_four))
        lines.append(f"| {name} | {one.count} | {math.degrees(one.median_off_rad):.1f} | {shares} |")
    return "\n".join(lines)


def _truth(found: FoundParts, examples: list[PartsExample]) -> tuple[np.ndarray, np.ndarray]:
    """Whether components are seen, and how far what was found is off, pixels: both (n, components)."""
    points = np.stack([made.points_px for made in examples])
    visible = np.stack([made.visible for made in examples])
    return visible, np.linalg.norm(found.points_px - points, axis=-1)
