//! Decode heads: from a network's raw output to boxes in the network's input.

use roadwatch_core::ImageSize;
use std::fmt;

/// Cell sizes of the three feature maps that every family here has, pixels of the input.
const STRIDES: [u32; 3] = [8, 16, 32];
/// YOLOv5 predicts this many boxes per cell.
const V5_ANCHORS: usize = 3;
/// Box (4) and objectness in front of the class scores.
const WITH_OBJECTNESS: usize = 5;
/// Box in front of the class scores.
const BOX_ONLY: usize = 4;

/// The families of detectors by their output, in the words of the configuration.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// `[N, 3 * cells, 5 + classes]`, decoded boxes, score = objectness * class.
    YoloV5,
    /// `[N, 4 + classes, cells]`, decoded boxes, score = class (YOLOv8 and YOLO11).
    YoloV8,
    /// `[N, cells, 5 + classes]`, raw grid offsets, score = objectness * class.
    YoloX,
}

impl Family {
    /// Every family.
    pub const ALL: [Self; 3] = [Self::YoloV5, Self::YoloV8, Self::YoloX];

    /// The family's name in configuration and reports.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::YoloV5 => "yolov5",
            Self::YoloV8 => "yolov8",
            Self::YoloX => "yolox",
        }
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// A recognised output: its family, and how many boxes and classes it has.
#[derive(Clone, Debug, PartialEq)]
pub struct Head {
    family: Family,
    boxes: usize,
    classes: usize,
    cells: Vec<Cell>,
}

/// A cell of a feature map: its corner in cells, and its side in pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cell {
    column: f32,
    row: f32,
    stride: f32,
}

/// A box before non-maximum suppression: corners in the network's input, pixels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RawBox {
    /// `x_min, y_min, x_max, y_max`.
    pub corners: [f32; 4],
    /// `0.0..=1.0`.
    pub score: f32,
    /// The network's class number.
    pub class: u16,
}

/// The output's shape is none of the families'.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "output {shape:?} for input {input} is no YOLO head known here: expected [N, {v5}, 5+classes] (yolov5), \
     [N, 4+classes, {cells}] (yolov8) or [N, {cells}, 5+classes] (yolox)"
)]
pub struct UnknownHead {
    shape: Vec<i64>,
    input: ImageSize,
    v5: usize,
    cells: usize,
}

impl Head {
    /// Recognises the family from the shape of a real output for an input of size `input`.
    ///
    /// # Errors
    /// When the shape is none of the families'.
    pub fn recognise(shape: &[i64], input: ImageSize) -> Result<Self, UnknownHead> {
        let cells = cells(input);
        let found = match *shape {
            [_, boxes, values] => {
                let (boxes, values) = (boxes.max(0) as usize, values.max(0) as usize);
                if boxes == V5_ANCHORS * cells.len() && values > WITH_OBJECTNESS {
                    Some((Family::YoloV5, boxes, values - WITH_OBJECTNESS))
                } else if boxes == cells.len() && values > WITH_OBJECTNESS {
                    Some((Family::YoloX, boxes, values - WITH_OBJECTNESS))
                } else if values == cells.len() && boxes > BOX_ONLY {
                    Some((Family::YoloV8, values, boxes - BOX_ONLY))
                } else {
                    None
                }
            }
            _ => None,
        };
        let Some((family, boxes, classes)) = found else {
            return Err(UnknownHead {
                shape: shape.to_vec(),
                input,
                v5: V5_ANCHORS * cells.len(),
                cells: cells.len(),
            });
        };
        Ok(Self {
            family,
            boxes,
            classes,
            cells: if family == Family::YoloX {
                cells
            } else {
                Vec::new()
            },
        })
    }

    /// The family.
    #[must_use]
    pub fn family(&self) -> Family {
        self.family
    }

    /// Number of classes.
    #[must_use]
    pub fn classes(&self) -> usize {
        self.classes
    }

    /// Number of boxes per image before suppression.
    #[must_use]
    pub fn boxes(&self) -> usize {
        self.boxes
    }

    /// Number of floats of the output for one image.
    #[must_use]
    pub fn output_len(&self) -> usize {
        match self.family {
            Family::YoloV8 => self.boxes * (BOX_ONLY + self.classes),
            Family::YoloV5 | Family::YoloX => self.boxes * (WITH_OBJECTNESS + self.classes),
        }
    }

    /// Appends to `found` every box whose best class reaches that class's threshold.
    ///
    /// `output` is one image's part of the output; `thresholds` has one entry per class, `f32::INFINITY`
    /// for classes nobody wants; `best` is scratch. Each box is looked at once.
    pub fn decode(
        &self,
        output: &[f32],
        thresholds: &[f32],
        best: &mut Vec<(f32, u16)>,
        found: &mut Vec<RawBox>,
    ) {
        let floor = thresholds.iter().copied().fold(f32::INFINITY, f32::min);
        match self.family {
            Family::YoloV5 | Family::YoloX => self.decode_rows(output, thresholds, floor, found),
            Family::YoloV8 => self.decode_columns(output, thresholds, best, found),
        }
    }

    fn decode_rows(&self, output: &[f32], thresholds: &[f32], floor: f32, found: &mut Vec<RawBox>) {
        let rows = output.chunks_exact(WITH_OBJECTNESS + self.classes);
        for (at, row) in rows.enumerate() {
            let objectness = row[4];
            // No class score exceeds 1, so objectness bounds the score. A NaN fails this test too.
            if objectness < floor || objectness.is_nan() {
                continue;
            }
            let (class, best) = best_of(&row[WITH_OBJECTNESS..]);
            let score = objectness * best;
            if score >= thresholds[class] {
                let [x, y, width, height] = [row[0], row[1], row[2], row[3]];
                let corners = match self.cells.get(at) {
                    Some(cell) => corners(
                        (x + cell.column) * cell.stride,
                        (y + cell.row) * cell.stride,
                        width.exp() * cell.stride,
                        height.exp() * cell.stride,
                    ),
                    None => corners(x, y, width, height),
                };
                found.push(raw_box(corners, score, class));
            }
        }
    }

    /// The output is one row per value, so class scores are compared row against row.
    fn decode_columns(
        &self,
        output: &[f32],
        thresholds: &[f32],
        best: &mut Vec<(f32, u16)>,
        found: &mut Vec<RawBox>,
    ) {
        best.clear();
        best.resize(self.boxes, (0.0, 0));
        let scores = output[BOX_ONLY * self.boxes..].chunks_exact(self.boxes);
        for (class, row) in scores.enumerate() {
            for (best, &score) in best.iter_mut().zip(row) {
                if score > best.0 {
                    *best = (score, class as u16);
                }
            }
        }
        for (at, &(score, class)) in best.iter().enumerate() {
            if score >= thresholds[usize::from(class)] {
                let value = |row: usize| output[row * self.boxes + at];
                let corners = corners(value(0), value(1), value(2), value(3));
                found.push(raw_box(corners, score, usize::from(class)));
            }
        }
    }
}

fn raw_box(corners: [f32; 4], score: f32, class: usize) -> RawBox {
    RawBox {
        corners,
        // Quantised networks overshoot 1 by a rounding step.
        score: score.min(1.0),
        class: class as u16,
    }
}

fn corners(x: f32, y: f32, width: f32, height: f32) -> [f32; 4] {
    let (half_width, half_height) = (width / 2.0, height / 2.0);
    [
        x - half_width,
        y - half_height,
        x + half_width,
        y + half_height,
    ]
}

/// The first of the greatest scores.
fn best_of(scores: &[f32]) -> (usize, f32) {
    let mut best = (0, 0.0);
    for (class, &score) in scores.iter().enumerate() {
        if score > best.1 {
            best = (class, score);
        }
    }
    best
}

fn cells(input: ImageSize) -> Vec<Cell> {
    let mut cells = Vec::new();
    for stride in STRIDES {
        for row in 0..input.height_px / stride {
            for column in 0..input.width_px / stride {
                cells.push(Cell {
                    column: column as f32,
                    row: row as f32,
                    stride: stride as f32,
                });
            }
        }
    }
    cells
}

#[cfg(test)]
mod tests {
    use super::*;

    const INPUT: ImageSize = ImageSize {
        width_px: 64,
        height_px: 64,
    };
    /// 8x8 + 4x4 + 2x2 cells.
    const CELLS: usize = 84;

    fn decoded(head: &Head, output: &[f32], thresholds: &[f32]) -> Vec<RawBox> {
        let mut found = Vec::new();
        head.decode(output, thresholds, &mut Vec::new(), &mut found);
        found
    }

    #[test]
    fn families_are_told_by_the_shape_of_the_output() {
        let family = |shape: &[i64]| Head::recognise(shape, INPUT).map(|head| head.family());
        assert_eq!(family(&[1, 252, 7]), Ok(Family::YoloV5));
        assert_eq!(family(&[1, 84, 7]), Ok(Family::YoloX));
        assert_eq!(family(&[1, 6, 84]), Ok(Family::YoloV8));
        for shape in [&[1, 1000][..], &[1, 83, 7], &[1, 252, 5], &[1, -1, 7]] {
            assert!(family(shape).is_err(), "{shape:?}");
        }
    }

    #[test]
    fn yolov5_multiplies_objectness_and_class() {
        let head = Head::recognise(&[1, 252, 7], INPUT).expect("yolov5");
        let mut output = vec![0.0; 252 * 7];
        output[7..14].copy_from_slice(&[20.0, 30.0, 10.0, 4.0, 0.8, 0.5, 0.9]);
        let found = decoded(&head, &output, &[0.25, 0.25]);
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].corners, [15.0, 28.0, 25.0, 32.0]);
        assert_eq!(found[0].class, 1);
        assert!((found[0].score - 0.72).abs() < 1e-6);
        assert!(decoded(&head, &output, &[0.1, 0.73]).is_empty());
    }

    #[test]
    fn yolov8_reads_columns() {
        let head = Head::recognise(&[1, 6, 84], INPUT).expect("yolov8");
        let mut output = vec![0.0; 6 * CELLS];
        for (row, value) in [20.0, 30.0, 10.0, 4.0, 0.2, 0.7].into_iter().enumerate() {
            output[row * CELLS + 5] = value;
        }
        let found = decoded(&head, &output, &[0.25, 0.25]);
        assert_eq!(found.len(), 1);
        assert_eq!(
            (found[0].corners, found[0].class),
            ([15.0, 28.0, 25.0, 32.0], 1)
        );
    }

    #[test]
    fn yolox_is_decoded_on_its_grid() {
        let head = Head::recognise(&[1, 84, 7], INPUT).expect("yolox");
        let mut output = vec![0.0; 84 * 7];
        // Cell 65 is the second of the 16-pixel map.
        output[65 * 7..66 * 7].copy_from_slice(&[0.5, 0.5, 0.0, 2.0_f32.ln(), 1.0, 0.9, 0.1]);
        let found = decoded(&head, &output, &[0.25, 0.25]);
        assert_eq!(found.len(), 1);
        let expected = [16.0, -8.0, 32.0, 24.0];
        for (value, expected) in found[0].corners.iter().zip(expected) {
            assert!((value - expected).abs() < 1e-4);
        }
    }

    #[test]
    fn nothing_comes_of_a_network_that_says_nan() {
        for shape in [[1, 252, 7], [1, 84, 7], [1, 6, 84]] {
            let head = Head::recognise(&shape, INPUT).expect("a head");
            let output = vec![f32::NAN; head.output_len()];
            assert!(decoded(&head, &output, &[0.25, 0.25]).is_empty());
        }
    }
}
