//! The key-component model: a small head over the frozen features of a detector, run on the crops of a frame.

use crate::{
    crop::{ChannelOrder, Crop, Values},
    row::Component,
};
use ort::{session::Session, value::TensorRef};
use roadwatch_core::{ImageSize, camera_model::Pixel};
use roadwatch_onnx::{CutError, Runtime, SessionOptions, cut, open_bytes, open_file};
use sha2::{Digest as _, Sha256};
use std::{
    fmt::Write as _,
    fs, io,
    path::{Path, PathBuf},
};

/// Names of a head's outputs.
const HEAT: &str = "heat";
const FACING: &str = "facing";
/// A crop much larger than this costs seconds.
const LARGEST_SIDE_PX: u32 = 2048;

/// A head that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ComponentModelError {
    /// A file that cannot be read.
    #[error("cannot read `{}`", file.display())]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// Not a head of key components.
    #[error("`{}` is no key-component model: {reason}", file.display())]
    NotAHead {
        /// The file.
        file: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// The features it needs are not this detector's.
    #[error(
        "`{}` reads the features of another detector than `{}` (its SHA-256 begins with {expected}, this one's with \
         {found}): set rotation.features to the detector it was trained on",
        head.display(), detector.display()
    )]
    OtherDetector {
        /// The head.
        head: PathBuf,
        /// The detector.
        detector: PathBuf,
        /// What the head says.
        expected: String,
        /// What there is.
        found: String,
    },
    /// The detector's graph cannot be cut.
    #[error("`{}`: {cause}", detector.display())]
    Features {
        /// The detector.
        detector: PathBuf,
        /// Why.
        #[source]
        cause: CutError,
    },
}

/// What a head's file says of itself.
#[derive(Clone, Debug, PartialEq)]
struct Notes {
    components: Vec<String>,
    thresholds: Vec<f32>,
    side_px: u32,
    cell_px: u32,
    tensors: Vec<String>,
    detector_sha256: String,
    values: Values,
}

/// The opened model.
pub struct ComponentNetwork {
    features: Session,
    image: String,
    head: Session,
    notes: Notes,
    facing_bins: usize,
    peaks: Vec<Component>,
}

impl ComponentNetwork {
    /// Opens a head and the detector whose features it reads, and runs both once on an empty crop.
    ///
    /// # Errors
    /// See [`ComponentModelError`].
    pub fn open(
        runtime: &Runtime,
        (head, detector): (&Path, &Path),
        options: SessionOptions,
    ) -> Result<Self, ComponentModelError> {
        let not_a_head = |reason: String| ComponentModelError::NotAHead {
            file: head.to_owned(),
            reason,
        };
        read(head)?;
        let session = open_file(runtime, head, options).map_err(not_a_head)?;
        let notes = Notes::of(&session).map_err(not_a_head)?;
        let content = read(detector)?;
        let found = hexadecimal(&Sha256::digest(&content));
        if found != notes.detector_sha256 {
            let start = |hash: &str| hash.chars().take(8).collect();
            return Err(ComponentModelError::OtherDetector {
                head: head.to_owned(),
                detector: detector.to_owned(),
                expected: start(&notes.detector_sha256),
                found: start(&found),
            });
        }
        let first = cut(&content, &notes.tensors);
        let first = first.map_err(|cause| ComponentModelError::Features {
            detector: detector.to_owned(),
            cause,
        })?;
        let features = open_bytes(runtime, &first, options).map_err(not_a_head)?;
        let image = features
            .inputs()
            .first()
            .map(|input| input.name().to_owned());
        let mut opened = Self {
            image: image.ok_or_else(|| not_a_head("its detector has no input".to_owned()))?,
            features,
            head: session,
            notes,
            facing_bins: 0,
            peaks: Vec::new(),
        };
        let empty = vec![0.0; Crop::input_len(opened.crop_size())];
        let mut bins = 0;
        let tried = opened.find(&empty, 1, |_, _, facing| bins = facing.len());
        tried.map_err(not_a_head)?;
        opened.facing_bins = bins;
        Ok(opened)
    }

    /// Width and height of the crops it takes.
    #[must_use]
    pub fn crop_size(&self) -> ImageSize {
        ImageSize {
            width_px: self.notes.side_px,
            height_px: self.notes.side_px,
        }
    }

    /// What it takes for pixels.
    #[must_use]
    pub fn values(&self) -> Values {
        self.notes.values
    }

    /// Names of the components, in the order in which they are found.
    #[must_use]
    pub fn components(&self) -> &[String] {
        &self.notes.components
    }

    /// Directions of the observation angle that it tells apart, evenly over a full turn from 0.
    #[must_use]
    pub fn facing_bins(&self) -> usize {
        self.facing_bins
    }

    /// Finds the components of `crops` crops that lie one after another in `input`, in one run, and hands those of
    /// each to `read` with its number and the probabilities of its directions.
    ///
    /// # Errors
    /// What ONNX Runtime says.
    pub fn find(
        &mut self,
        input: &[f32],
        crops: usize,
        mut read: impl FnMut(usize, &[Component], &[f32]),
    ) -> Result<(), String> {
        let side = i64::from(self.notes.side_px);
        let run = || -> Result<(), ort::Error> {
            let len = crops * input.len() / crops.max(1);
            let shape = [crops as i64, 3, side, side];
            let image = TensorRef::from_array_view((shape, &input[..len]))?;
            let maps = self
                .features
                .run(ort::inputs![self.image.as_str() => image])?;
            let mut inputs = Vec::with_capacity(self.notes.tensors.len());
            for name in &self.notes.tensors {
                let (shape, map) = maps[name.as_str()].try_extract_tensor::<f32>()?;
                let map = TensorRef::from_array_view((shape.clone(), map))?;
                inputs.push((name.as_str(), ort::session::SessionInputValue::from(map)));
            }
            let found = self.head.run(inputs)?;
            let (shape, heat) = found[HEAT].try_extract_tensor::<f32>()?;
            let (_, facing) = found[FACING].try_extract_tensor::<f32>()?;
            let columns = shape.last().map_or(1, |&side| side.max(1) as usize);
            let (maps, bins) = (heat.len() / crops, facing.len() / crops);
            for at in 0..crops {
                let heat = &heat[at * maps..][..maps];
                self.notes.peaks(heat, columns, &mut self.peaks);
                read(at, &self.peaks, &facing[at * bins..][..bins]);
            }
            Ok(())
        };
        run_reported(run)
    }
}

fn run_reported(run: impl FnOnce() -> Result<(), ort::Error>) -> Result<(), String> {
    run().map_err(|error| error.to_string())
}

impl Notes {
    fn of(session: &Session) -> Result<Self, String> {
        let metadata = session.metadata().map_err(|error| error.to_string())?;
        let text = |key: &str| {
            let absent = || format!("its metadata has no `{key}`");
            metadata.custom(key).ok_or_else(absent)
        };
        let malformed = |key: &str| format!("`{key}` of its metadata is malformed");
        let number = |key: &str, most: u32| {
            let number = text(key)?.parse().ok();
            number
                .filter(|number| (1..=most).contains(number))
                .ok_or_else(|| malformed(key))
        };
        let components: Vec<String> =
            serde_json::from_str(&text("components")?).map_err(|_| malformed("components"))?;
        let thresholds: Vec<f32> = serde_json::from_str(&text("component_thresholds")?)
            .map_err(|_| malformed("component_thresholds"))?;
        if thresholds.len() != components.len() || components.is_empty() {
            return Err(malformed("component_thresholds"));
        }
        let order = match text("detector_channels")?.as_str() {
            "rgb" => ChannelOrder::Rgb,
            "bgr" => ChannelOrder::Bgr,
            _ => return Err(malformed("detector_channels")),
        };
        let scale = text("detector_scale")?.parse();
        Ok(Self {
            thresholds,
            components,
            side_px: number("crop_side_px", LARGEST_SIDE_PX)?,
            cell_px: number("cell_px", LARGEST_SIDE_PX)?,
            tensors: serde_json::from_str(&text("feature_tensors")?)
                .map_err(|_| malformed("feature_tensors"))?,
            detector_sha256: text("detector_sha256")?,
            values: Values {
                order,
                scale: scale.map_err(|_| malformed("detector_scale"))?,
            },
        })
    }

    /// The highest cell of every component's map, moved to the centroid of its 3x3 neighbourhood.
    fn peaks(&self, heat: &[f32], columns: usize, peaks: &mut Vec<Component>) {
        peaks.clear();
        let cells = heat.len() / self.components.len();
        for (map, &threshold) in heat.chunks_exact(cells.max(1)).zip(&self.thresholds) {
            let best = (0..cells).max_by(|&a, &b| map[a].total_cmp(&map[b]).then(b.cmp(&a)));
            let best = best.unwrap_or(0);
            let (column, row) = centroid(map, columns, best);
            let cell = f64::from(self.cell_px);
            let position = |cells: f64| cells * cell + (cell - 1.0) / 2.0;
            peaks.push(Component {
                position_px: Pixel::new(position(column), position(row)),
                score: map[best],
                found: map[best] >= threshold,
            });
        }
    }
}

/// Column and row of a peak, in cells.
fn centroid(map: &[f32], columns: usize, best: usize) -> (f64, f64) {
    let rows = map.len() / columns;
    let (row, column) = (best / columns, best % columns);
    let (mut sum, mut x, mut y) = (0.0, 0.0, 0.0);
    for near_row in row.saturating_sub(1)..(row + 2).min(rows) {
        for near_column in column.saturating_sub(1)..(column + 2).min(columns) {
            let weight = f64::from(map[near_row * columns + near_column]);
            sum += weight;
            x += weight * near_column as f64;
            y += weight * near_row as f64;
        }
    }
    if sum > 0.0 {
        (x / sum, y / sum)
    } else {
        (column as f64, row as f64)
    }
}

fn read(file: &Path) -> Result<Vec<u8>, ComponentModelError> {
    fs::read(file).map_err(|cause| ComponentModelError::Unreadable {
        file: file.to_owned(),
        cause,
    })
}

fn hexadecimal(bytes: &[u8]) -> String {
    let mut text = String::with_capacity(2 * bytes.len());
    for byte in bytes {
        // Writing to a string cannot fail.
        write!(text, "{byte:02x}").unwrap_or_default();
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_peak_lies_between_its_cells_by_their_weight() {
        let mut map = [0.0; 16];
        (map[5], map[6]) = (0.6, 0.2);
        let (column, row) = centroid(&map, 4, 5);
        assert!((column - 1.25).abs() < 1e-6 && (row - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_peak_in_the_corner_stays_in_the_map() {
        let mut map = [0.0; 9];
        map[8] = 1.0;
        assert_eq!(centroid(&map, 3, 8), (2.0, 2.0));
    }
}
