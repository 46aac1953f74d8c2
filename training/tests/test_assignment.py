"""Cells answer for the right objects; losses lead the right way."""

from __future__ import annotations

import pytest
import torch

from roadwatch_training.assignment import Targets, assign
from roadwatch_training.boxes import complete_iou, pairwise_iou
from roadwatch_training.losses import detection_losses
from roadwatch_training.network import INITIAL_REACH_CELLS, Cells, corner_boxes

CELLS = Cells.of_input(128, 96)
COUNT = len(CELLS.strides_px)


def targets(*boxes: tuple[float, ...], sought: tuple[bool, ...] | None = None) -> Targets:
    """One image's cars."""
    flags = torch.tensor([sought or (True,) * len(boxes)])
    classes = torch.full((1, len(boxes)), 2)
    return Targets(torch.tensor([boxes]).float(), classes, flags, ~flags)


def untrained(score: float = 0.1) -> tuple[torch.Tensor, torch.Tensor]:
    raw = torch.zeros(1, 10, COUNT)
    return torch.full((1, 6, COUNT), score), corner_boxes(raw, CELLS)


def test_cells_are_counted_stride_by_stride_row_by_row() -> None:
    assert COUNT == 16 * 12 + 8 * 6 + 4 * 3
    assert CELLS.centres_px[1].tolist() == [12.0, 4.0]
    assert CELLS.centres_px[16 * 12].tolist() == [8.0, 8.0]


def test_an_untrained_network_gives_objects_to_the_stride_of_their_size() -> None:
    for side, stride in ((30, 8), (62, 16)):
        box = (48 - side / 2, 48 - side / 2, 48 + side / 2, 48 + side / 2)
        found = assign(*untrained(), targets(box), CELLS)
        best = found.aims[0].argmax()
        assert CELLS.strides_px[best] == stride


@pytest.mark.parametrize("left", [16.5, 20.0, 23.9])
def test_the_smallest_object_between_cell_centres_has_a_cell(left: float) -> None:
    found = assign(*untrained(), targets((left, 36.5, left + 8, 44.5)), CELLS)
    assert found.positive.any()


def test_a_cell_in_two_objects_answers_for_the_one_it_overlaps_more() -> None:
    wide, narrow = (8.0, 8.0, 120.0, 88.0), (48.0, 32.0, 80.0, 64.0)
    found = assign(*untrained(), targets(wide, narrow), CELLS)
    at = ((CELLS.centres_px - 60).abs().sum(1) + 1000 * (CELLS.strides_px != 8)).argmin()
    assert found.positive[0, at] and found.objects[0, at] == 1


def test_cells_in_objects_that_are_not_sought_are_left_alone() -> None:
    found = assign(*untrained(), targets((16, 16, 64, 64), sought=(False,)), CELLS)
    assert not found.positive.any()
    inside = ((CELLS.centres_px > 16) & (CELLS.centres_px < 64)).all(1)
    assert not found.counted[0, inside].any() and found.counted[0, ~inside].all()


def test_a_perfect_prediction_costs_next_to_nothing() -> None:
    box = torch.tensor([40.0, 24.0, 88.0, 72.0])
    raw = torch.zeros(1, 10, COUNT)
    unit = INITIAL_REACH_CELLS * CELLS.strides_px[:, None]
    reach = torch.cat((CELLS.centres_px - box[:2], box[2:] - CELLS.centres_px), dim=1) / unit
    raw[0, :4] = reach.clamp(min=0.02).log().T
    wanted = targets(tuple(box.tolist()))
    raw[0, 4:] = -12
    found = assign(raw[:, 4:].sigmoid(), corner_boxes(raw, CELLS), wanted, CELLS)
    raw[0, 6, found.positive[0]] = 12
    losses = detection_losses(raw, wanted, CELLS)
    assert losses.total < 0.02


def test_predictions_that_follow_their_losses_end_on_the_objects() -> None:
    raw = torch.zeros(1, 10, COUNT)
    raw[:, 4:] = -3
    raw.requires_grad_()
    boxes = ((20.0, 20.0, 70.0, 60.0), (80.0, 40.0, 110.0, 70.0))
    optimiser = torch.optim.Adam([raw], 0.15)
    for _ in range(50):
        optimiser.zero_grad()
        detection_losses(raw, targets(*boxes), CELLS).total.backward()
        optimiser.step()
    sure = raw[0, 6].sigmoid() > 0.7
    overlaps = pairwise_iou(torch.tensor(boxes), corner_boxes(raw, CELLS)[0, sure].detach())
    assert (overlaps.amax(1) > 0.9).all() and (overlaps.amax(0) > 0.7).all()


def test_an_image_without_objects_has_a_finite_loss() -> None:
    nothing = Targets(torch.zeros(1, 1, 4), torch.zeros(1, 1).long(), *(torch.zeros(1, 1).bool(),) * 2)
    assert detection_losses(torch.zeros(1, 10, COUNT), nothing, CELLS).total.isfinite()


def test_overlaps_of_known_boxes() -> None:
    first = torch.tensor([[0.0, 0.0, 10.0, 10.0]])
    second = torch.tensor([[5.0, 0.0, 15.0, 10.0], [0.0, 0.0, 10.0, 10.0], [20.0, 20.0, 30.0, 30.0]])
    torch.testing.assert_close(pairwise_iou(first, second)[0], torch.tensor([1 / 3, 1.0, 0.0]))
    complete = complete_iou(first.expand(3, 4), second)
    assert complete[1] == pytest.approx(1.0, abs=1e-4) and complete[0] < 1 / 3 and complete[2] < 0
