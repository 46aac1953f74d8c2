"""Everything about a training that is a choice."""

from __future__ import annotations

from dataclasses import asdict, dataclass

from .errors import TrainingError
from .network import SHAPES, STRIDES


@dataclass(frozen=True)
class Settings:
    """`images` counts presentations, not different pictures. `minutes` ends the training earlier, None never.

    The learning rate follows whichever of the two is further along. Training windows are
    `width_px` x `height_px`, cut from pictures at `scale_range` output pixels per picture pixel;
    the daemon's own scale for 960x540 is 0.667.
    """

    width: str = "medium"
    width_px: int = 416
    height_px: int = 256
    scale_range: tuple[float, float] = (0.42, 1.15)
    batch_size: int = 8
    images: int = 48_000
    minutes: float | None = None
    seed: int = 1
    learning_rate: float = 2e-3
    weight_decay: float = 0.02
    warm_up_batches: int = 150
    workers: int = 1
    threads: int = 0
    compiled: bool = False

    def __post_init__(self) -> None:
        if self.width not in SHAPES:
            raise TrainingError(f"--width is `{self.width}`; known are {', '.join(SHAPES)}")
        if self.width_px % STRIDES[-1] or self.height_px % STRIDES[-1]:
            raise TrainingError(
                f"--window is {self.width_px}x{self.height_px}; both sides must be multiples of {STRIDES[-1]}"
            )
        if self.batch_size < 2 or self.images < self.batch_size:
            raise TrainingError("--batch must be 2 or more (batch normalisation), --images at least as many")
        if self.minutes is not None and self.minutes <= 0:
            raise TrainingError("--minutes must be more than 0")

    @property
    def batches(self) -> int:
        return self.images // self.batch_size

    def as_dict(self) -> dict:
        return asdict(self)

    @classmethod
    def from_dict(cls, values: dict) -> Settings:
        return cls(**{**values, "scale_range": tuple(values["scale_range"])})
