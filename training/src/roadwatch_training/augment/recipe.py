"""The whole augmentation: from numbered pictures to training examples, the same for the same seed."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from ..images import ImageStore
from .example import Example, empty_rows, small_unsought
from .geometry import Framing, mirrored, mosaic, random_cut
from .pasting import blended_with_texture, with_blots, with_pasted
from .photometric import photometric
from .textures import texture


@dataclass(frozen=True)
class Recipe:
    """How often each change happens, as a share of examples."""

    mosaic: float = 0.25
    pasted: float = 0.25
    blots: float = 0.25
    blended: float = 0.12
    # Examples without any object: all that is found in them is wrong.
    texture_only: float = 0.03
    # Left as the simulator made them but for cut and mirror.
    untouched: float = 0.05


def example(store: ImageStore, framing: Framing, recipe: Recipe, rng: np.random.Generator) -> Example:
    """A random example; everything about it is decided by `rng`."""
    if rng.random() < recipe.texture_only:
        image = photometric(texture(framing.width_px, framing.height_px, rng), rng)
        return Example(image, empty_rows())
    made = _composed(store, framing, recipe, rng)
    if rng.random() < 0.5:
        made = mirrored(made)
    if rng.random() >= recipe.untouched:
        made = _changed(made, recipe, rng)
    return Example(made.image, small_unsought(made.rows))


def _composed(store: ImageStore, framing: Framing, recipe: Recipe, rng: np.random.Generator) -> Example:
    if rng.random() < recipe.mosaic:
        return mosaic([_cut(store, framing, rng) for _ in range(4)], rng)
    made = _cut(store, framing, rng)
    if rng.random() < recipe.pasted:
        made = with_pasted(made, _cut(store, framing, rng), rng)
    return made


def _cut(store: ImageStore, framing: Framing, rng: np.random.Generator) -> Example:
    at = int(rng.integers(len(store)))
    return random_cut(store.pixels[at], store.targets[at], framing, rng)


def _changed(made: Example, recipe: Recipe, rng: np.random.Generator) -> Example:
    image = made.image
    if rng.random() < recipe.blended:
        image = blended_with_texture(image, rng)
    made = made.with_image(photometric(image, rng))
    return with_blots(made, rng) if rng.random() < recipe.blots else made
