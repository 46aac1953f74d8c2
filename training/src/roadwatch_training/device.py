"""Where networks are trained: on the GPU where PyTorch sees one, else on the CPU."""

from __future__ import annotations

import torch


def training_device() -> torch.device:
    """The first GPU, or the CPU. On a GPU matrix products may round like TF32, which training does not notice."""
    if not torch.cuda.is_available():
        return torch.device("cpu")
    torch.set_float32_matmul_precision("high")
    torch.backends.cudnn.benchmark = True
    return torch.device("cuda")
