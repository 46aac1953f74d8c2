//! Detector: letterbox, ONNX session, YOLO heads, non-maximum suppression.
