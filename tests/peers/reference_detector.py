#!/usr/bin/env python3
"""The detector as Python users write it, to compare ours with: letterbox, ONNX Runtime, decode, NMS.

usage: reference_detector.py MODEL FAMILY IMAGE_OR_FOLDER... --out FILE.json [--score 0.25] [--iou 0.45]

FAMILY is yolov5, yolov8 or yolox. A folder stands for every .jpg and .png in it and below it. Writes

    {"<path as given>": [[x1, y1, x2, y2, score, class_index], ...], ...}

with boxes in pixels of the image, clipped to it, best score first. It follows what the families'
authors publish (ultralytics/yolov5, ultralytics/ultralytics, Megvii-BaseDetection/YOLOX) and shares
nothing with the Rust code; there is no limit on the number of boxes.
"""

import argparse
import json
import os
import sys

import cv2
import numpy as np
import onnxruntime

GREY = 114
YOLOX_STRIDES = (8, 16, 32)
IMAGE_SUFFIXES = (".jpg", ".jpeg", ".png")


def letterbox_centred(image, height, width):
    """YOLOv5 and YOLOv8: bars on both sides, RGB, 0 to 1. Returns the input, gain and (left, top)."""
    gain = min(height / image.shape[0], width / image.shape[1])
    new_width, new_height = round(image.shape[1] * gain), round(image.shape[0] * gain)
    bar_x, bar_y = (width - new_width) / 2, (height - new_height) / 2
    # The tenths are YOLOv5's way to give an odd pixel to the right and to the bottom.
    left, right = round(bar_x - 0.1), round(bar_x + 0.1)
    top, bottom = round(bar_y - 0.1), round(bar_y + 0.1)
    resized = cv2.resize(image, (new_width, new_height), interpolation=cv2.INTER_LINEAR)
    padded = cv2.copyMakeBorder(resized, top, bottom, left, right, cv2.BORDER_CONSTANT, value=(GREY, GREY, GREY))
    rgb = padded[:, :, ::-1].transpose(2, 0, 1)
    return np.ascontiguousarray(rgb, dtype=np.float32) / np.float32(255), gain, (left, top)


def letterbox_top_left(image, height, width):
    """YOLOX: bars to the right and below, BGR, 0 to 255. Returns the input, gain and (left, top)."""
    gain = min(height / image.shape[0], width / image.shape[1])
    new_width, new_height = int(image.shape[1] * gain), int(image.shape[0] * gain)
    padded = np.full((height, width, 3), GREY, dtype=np.uint8)
    padded[:new_height, :new_width] = cv2.resize(image, (new_width, new_height), interpolation=cv2.INTER_LINEAR)
    return np.ascontiguousarray(padded.transpose(2, 0, 1), dtype=np.float32), gain, (0, 0)


def decode_yolov5(output, _height, _width):
    """Rows of cx, cy, w, h, objectness, class scores."""
    return output[:, :4], output[:, 4:5] * output[:, 5:]


def decode_yolov8(output, _height, _width):
    """Columns of cx, cy, w, h, class scores."""
    rows = output.T
    return rows[:, :4], rows[:, 4:]


def decode_yolox(output, height, width):
    """Rows as YOLOv5's, but centres count from a grid cell and sizes are logarithms, both in strides."""
    cells, strides = [], []
    for stride in YOLOX_STRIDES:
        down, across = np.mgrid[: height // stride, : width // stride]
        cells.append(np.stack((across.ravel(), down.ravel()), axis=1))
        strides.append(np.full((down.size, 1), stride))
    cells, strides = np.concatenate(cells), np.concatenate(strides)
    centres = (output[:, 0:2] + cells) * strides
    sizes = np.exp(output[:, 2:4]) * strides
    return np.concatenate((centres, sizes), axis=1), output[:, 4:5] * output[:, 5:]


FAMILIES = {
    "yolov5": (letterbox_centred, decode_yolov5),
    "yolov8": (letterbox_centred, decode_yolov8),
    "yolox": (letterbox_top_left, decode_yolox),
}


def overlap(box, others):
    """Intersection over union of one box with each of the others."""
    width = np.minimum(box[2], others[:, 2]) - np.maximum(box[0], others[:, 0])
    height = np.minimum(box[3], others[:, 3]) - np.maximum(box[1], others[:, 1])
    shared = width.clip(0) * height.clip(0)
    areas = (others[:, 2] - others[:, 0]) * (others[:, 3] - others[:, 1])
    area = (box[2] - box[0]) * (box[3] - box[1])
    return shared / np.maximum(area + areas - shared, 1e-12)


def suppress(boxes, scores, classes, iou):
    """Indices of the kept boxes, best first: greedy, each class by itself."""
    waiting = np.argsort(-scores, kind="stable")
    kept = []
    while waiting.size:
        best, waiting = waiting[0], waiting[1:]
        kept.append(best)
        same_class = classes[waiting] == classes[best]
        waiting = waiting[~(same_class & (overlap(boxes[best], boxes[waiting]) > iou))]
    return kept


def detect(session, family, image, score, iou):
    """The boxes of one BGR image, as rows of x1, y1, x2, y2, score, class index."""
    letterbox, decode = FAMILIES[family]
    model_input = session.get_inputs()[0]
    height, width = model_input.shape[2:]
    tensor, gain, (left, top) = letterbox(image, height, width)
    output = session.run(None, {model_input.name: tensor[None]})[0][0]

    boxes, scores = decode(output, height, width)
    classes = scores.argmax(axis=1)
    scores = scores.max(axis=1)
    sure = scores > score
    boxes, scores, classes = boxes[sure].astype(np.float64), scores[sure], classes[sure]

    centres, halves = boxes[:, :2], boxes[:, 2:] / 2
    corners = np.concatenate((centres - halves, centres + halves), axis=1)
    kept = suppress(corners, scores, classes, iou)
    on_image = (corners[kept] - (left, top, left, top)) / gain
    image_height, image_width = image.shape[:2]
    on_image = on_image.clip(0, (image_width, image_height, image_width, image_height))
    return [
        [*box, float(scores[at]), int(classes[at])]
        for box, at in zip(on_image.tolist(), kept)
        # One that lies wholly in the bars has no area on the image.
        if box[2] > box[0] and box[3] > box[1]
    ]


def image_paths(given):
    """The images of files and folders, each path starting as it was given."""
    for path in given:
        if not os.path.isdir(path):
            yield path
            continue
        for folder, folders, files in os.walk(path):
            folders.sort()
            for name in sorted(files):
                if name.lower().endswith(IMAGE_SUFFIXES):
                    yield os.path.join(folder, name)


def open_model(path):
    options = onnxruntime.SessionOptions()
    # Threads that spin while Python works would only take its core away.
    options.add_session_config_entry("session.intra_op.allow_spinning", "0")
    return onnxruntime.InferenceSession(path, options, providers=["CPUExecutionProvider"])


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("model", metavar="MODEL")
    arguments.add_argument("family", metavar="FAMILY", choices=FAMILIES)
    arguments.add_argument("images", metavar="IMAGE_OR_FOLDER", nargs="+")
    arguments.add_argument("--score", type=float, default=0.25, help="keep boxes above this score (default 0.25)")
    arguments.add_argument("--iou", type=float, default=0.45, help="drop boxes overlapping more (default 0.45)")
    arguments.add_argument("--out", metavar="FILE.json", required=True)
    options = arguments.parse_args()

    session = open_model(options.model)
    found = {}
    for path in image_paths(options.images):
        image = cv2.imread(path, cv2.IMREAD_COLOR)
        if image is None:
            sys.exit(f"reference_detector: {path} is not an image that can be read")
        found[path] = detect(session, options.family, image, options.score, options.iou)
    if not found:
        sys.exit("reference_detector: no images there")
    with open(options.out, "w", encoding="utf-8") as out:
        json.dump(found, out)
    print(f"{options.out}: {sum(map(len, found.values()))} boxes on {len(found)} images")


if __name__ == "__main__":
    main()
