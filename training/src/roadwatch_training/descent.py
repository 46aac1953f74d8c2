"""One step of a training downhill: what a detector's and a head's have in common."""

from __future__ import annotations

import math

import torch
from torch import nn

# The learning rate ends at this share of its peak.
FINAL_RATE_SHARE = 0.02
ADAM_BETAS = (0.9, 0.99)


def learning_rate(peak: float, warm_up_batches: int, batches_done: int, progress: float) -> float:
    """Rises over the warm-up, then falls along half a cosine; `progress` is 0 at the start and 1 when done."""
    rise = min(1.0, (batches_done + 1) / warm_up_batches)
    fall = (1 + math.cos(math.pi * min(1.0, progress))) / 2
    return peak * rise * (FINAL_RATE_SHARE + (1 - FINAL_RATE_SHARE) * fall)


def optimiser_of(network: nn.Module, peak: float, weight_decay: float) -> torch.optim.AdamW:
    """AdamW; only filters decay, biases and normalisation do not."""
    filters = [p for p in network.parameters() if p.ndim > 1]
    others = [p for p in network.parameters() if p.ndim <= 1]
    groups = [{"params": filters, "weight_decay": weight_decay}, {"params": others, "weight_decay": 0.0}]
    return torch.optim.AdamW(groups, peak, ADAM_BETAS)


def descend(
    network: nn.Module, optimiser: torch.optim.Optimizer, loss: torch.Tensor, rate: float, greatest_norm: float
) -> None:
    """Moves the network against the loss, by a gradient no longer than `greatest_norm`."""
    for group in optimiser.param_groups:
        group["lr"] = rate
    optimiser.zero_grad(set_to_none=True)
    loss.backward()
    nn.utils.clip_grad_norm_(network.parameters(), greatest_norm)
    optimiser.step()
