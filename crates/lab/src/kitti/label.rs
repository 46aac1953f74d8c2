//! A file of `label_2`: what is in one image.

use super::error::{KittiError, LabelProblem};
use crate::truth::{ImageLabels, TruthObject};
use roadwatch_core::{BoxPx, Mount, SizeLwh, camera_model::Pixel, space::Point};
use std::{f64::consts::FRAC_PI_2, fs, path::Path};

/// The fields of a line, in order; a sixteenth, the score of a result, is not looked at.
const FIELDS: [&str; 15] = [
    "type",
    "truncated",
    "occluded",
    "alpha",
    "left",
    "top",
    "right",
    "bottom",
    "height",
    "width",
    "length",
    "x",
    "y",
    "z",
    "rotation_y",
];
/// A region that nobody labelled.
const UNLABELLED: &str = "DontCare";

/// KITTI's kinds and the classes that detectors know. COCO has no van and calls most of them cars. Others keep their
/// own name in lower case.
const CLASSES: [(&str, &str); 6] = [
    ("Van", "car"),
    ("Pedestrian", "person"),
    ("Person_sitting", "person"),
    ("Cyclist", "bicycle"),
    ("Tram", "train"),
    ("Misc", "other"),
];

/// KITTI's occlusion as a share: fully visible, partly, largely occluded, unknown. The annotators' instructions draw no
/// exact lines; these are the middles of "up to half" rounded up past *clean*, of "more than half", and the worst that
/// unknown may be.
const OCCLUDED_SHARES: [f64; 4] = [0.0, 0.4, 0.8, 1.0];

/// One line, its numbers read.
struct Line<'a> {
    kind: &'a str,
    /// Those after the kind, in order of [`FIELDS`].
    numbers: [f64; FIELDS.len() - 1],
}

/// Reads the labels of the image of that name.
///
/// # Errors
/// When the file cannot be read or a line is wrong, with its number.
pub(super) fn read(file: &Path, image: &str) -> Result<ImageLabels, KittiError> {
    let text = fs::read_to_string(file).map_err(|cause| KittiError::Unreadable {
        file: file.to_owned(),
        cause,
    })?;
    let mut labels = ImageLabels::default();
    for (number, text) in (1..).zip(text.lines()) {
        if text.trim().is_empty() {
            continue;
        }
        let added = Line::parse(text)
            .and_then(|line| line.add_to(&mut labels, format!("{image}/{number}")));
        added.map_err(|problem| KittiError::Label {
            file: file.to_owned(),
            line: number,
            problem,
        })?;
    }
    Ok(labels)
}

impl<'a> Line<'a> {
    fn parse(text: &'a str) -> Result<Self, LabelProblem> {
        let words: Vec<&str> = text.split_whitespace().collect();
        if let Some(missing) = FIELDS.get(words.len()) {
            return Err(LabelProblem::Missing {
                found: words.len(),
                field: missing,
            });
        }
        let mut numbers = [0.0; FIELDS.len() - 1];
        for (at, number) in numbers.iter_mut().enumerate() {
            let (field, word) = (FIELDS[at + 1], words[at + 1]);
            let read: Option<f64> = word.parse().ok();
            let finite = read.filter(|number| number.is_finite());
            *number = finite.ok_or_else(|| LabelProblem::Number {
                field,
                word: word.to_owned(),
            })?;
        }
        Ok(Self {
            kind: words[0],
            numbers,
        })
    }

    fn add_to(&self, labels: &mut ImageLabels, id: String) -> Result<(), LabelProblem> {
        if self.kind == UNLABELLED {
            labels.unlabelled_px.push(self.box_px()?);
        } else {
            labels.objects.push(self.object(id)?);
        }
        Ok(())
    }

    fn object(&self, id: String) -> Result<TruthObject, LabelProblem> {
        let [
            truncated,
            occluded,
            _alpha,
            _,
            _,
            _,
            _,
            height_m,
            width_m,
            length_m,
            x,
            y,
            z,
            rotation_y,
        ] = self.numbers;
        for (field, size) in [
            ("height", height_m),
            ("width", width_m),
            ("length", length_m),
        ] {
            if size <= 0.0 {
                return Err(LabelProblem::Size { field, size });
            }
        }
        if !(0.0..=1.0).contains(&truncated) {
            return Err(LabelProblem::Truncated(truncated));
        }
        // The rectified frame has base_link's origin: only axes turn. Labels give the middle of the bottom.
        let center =
            Mount::ahead([0.0; 3]).base_from_optical() * Point::new(x, y - height_m / 2.0, z);
        let known = CLASSES.into_iter().find(|(kind, _)| *kind == self.kind);
        Ok(TruthObject {
            id,
            class: known.map_or_else(|| self.kind.to_lowercase(), |(_, class)| class.to_owned()),
            label: Some(self.kind.to_owned()),
            box_px: Some(self.box_px()?),
            silhouette_px: None,
            visible_px: None,
            truncated,
            occluded: occluded_share(occluded)?,
            center,
            size: Some(SizeLwh {
                length_m,
                width_m,
                height_m,
            }),
            // About the optical y axis, which points down, and zero along x, which points right.
            yaw_rad: Some(-rotation_y - FRAC_PI_2),
        })
    }

    /// KITTI's boxes go from pixel to pixel, ours from edge to edge.
    fn box_px(&self) -> Result<BoxPx, LabelProblem> {
        let [_, _, _, left, top, right, bottom, ..] = self.numbers;
        let box_px = BoxPx::between(Pixel::new(left, top), Pixel::new(right, bottom));
        box_px.ok_or(LabelProblem::EmptyBox {
            left,
            top,
            right,
            bottom,
        })
    }
}

fn occluded_share(level: f64) -> Result<f64, LabelProblem> {
    let levels = OCCLUDED_SHARES.iter().enumerate();
    let mut shares = levels.filter(|(at, _)| *at as f64 == level);
    let (_, share) = shares.next().ok_or(LabelProblem::Occluded(level))?;
    Ok(*share)
}
