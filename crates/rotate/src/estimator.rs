//! Headings of a frame's objects: crops, one run of the network, rows, forest, decision.

use crate::{
    angle::RayAngle,
    crop::{Crop, Scratch},
    decision::decide,
    forest::Forest,
    network::ComponentNetwork,
    row::Row,
};
use roadwatch_core::{
    BoxPx, Frame, Heading, Located, ObjectClass, Pixels, Rig, Rotation, RotationError,
    RotationEstimator, SeenComponent,
    space::{BaseLink, Point},
};
use std::sync::Arc;

/// Which objects get headings.
#[derive(Clone, Debug, PartialEq)]
pub struct RotationOptions {
    /// Their classes.
    pub classes: Vec<ObjectClass>,
    /// Least height of the box, pixels.
    pub min_height_px: f32,
}

/// A forest that does not go with a model.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ForestMismatch {
    /// It was grown on other components.
    #[error(
        "the forest was grown on components {forest}, the model finds {model}: train it again on rows of this model"
    )]
    Components {
        /// The forest's.
        forest: String,
        /// The model's.
        model: String,
    },
    /// It expects another number of directions.
    #[error(
        "the forest was grown on {forest} directions, the model tells {model} apart: train it again on rows of this model"
    )]
    Facing {
        /// The forest's.
        forest: usize,
        /// The model's.
        model: usize,
    },
}

/// What a crop shows, before it is turned into a heading.
pub struct SeenCrop {
    /// Where it lies in the image.
    pub crop: Crop,
    /// Its row.
    pub row: Row,
    /// The components that were found, in the image.
    pub components: Vec<SeenComponent>,
}

/// Sees rows in crops; room for a frame's crops is used again.
pub struct RowReader {
    network: ComponentNetwork,
    names: Vec<Arc<str>>,
    input: Vec<f32>,
    scratch: Scratch,
}

impl RowReader {
    /// A reader of a model's rows.
    #[must_use]
    pub fn new(network: ComponentNetwork) -> Self {
        let names = network.components().iter();
        Self {
            names: names.map(|name| name.as_str().into()).collect(),
            network,
            input: Vec::new(),
            scratch: Scratch::default(),
        }
    }

    /// The model.
    #[must_use]
    pub fn network(&self) -> &ComponentNetwork {
        &self.network
    }

    /// What each box of an image shows, in one run; `None` for a box without a pixel in the image.
    ///
    /// # Errors
    /// What ONNX Runtime says.
    pub fn read(
        &mut self,
        pixels: &Pixels,
        boxes: &[BoxPx],
    ) -> Result<Vec<Option<SeenCrop>>, String> {
        let size = self.network.crop_size();
        let len = Crop::input_len(size);
        let crops: Vec<Option<Crop>> = boxes
            .iter()
            .map(|box_px| Crop::new(box_px, pixels.size(), size))
            .collect();
        let kept: Vec<Crop> = crops.iter().copied().flatten().collect();
        if kept.is_empty() {
            return Ok(crops.iter().map(|_| None).collect());
        }
        self.input
            .resize((kept.len() * len).max(self.input.len()), 0.0);
        for (crop, input) in kept.iter().zip(self.input.chunks_exact_mut(len)) {
            crop.fill(pixels, self.network.values(), input, &mut self.scratch);
        }
        let mut seen = Vec::with_capacity(kept.len());
        let input = &self.input[..kept.len() * len];
        self.network.find(input, kept.len(), |at, found, facing| {
            let crop = kept[at];
            let in_image = found.iter().zip(&self.names).filter(|(one, _)| one.found);
            let in_image = in_image.map(|(one, name)| SeenComponent {
                name: Arc::clone(name),
                position_px: crop.to_image(one.position_px),
                score: one.score,
            });
            seen.push(SeenCrop {
                crop,
                row: Row::new(crop.aspect(), size.width_px, found, facing),
                components: in_image.collect(),
            });
        })?;
        let mut seen = seen.into_iter();
        Ok(crops
            .iter()
            .map(|crop| crop.and_then(|_| seen.next()))
            .collect())
    }
}

/// Estimates headings from key components. One for the rig; remembers nothing.
pub struct KeyComponentEstimator {
    reader: RowReader,
    forest: Forest,
    /// Where each camera is, by its number.
    eyes: Vec<Point<BaseLink>>,
    options: RotationOptions,
    features: Vec<f64>,
}

impl KeyComponentEstimator {
    /// An estimator for the cameras of a rig.
    ///
    /// # Errors
    /// When the forest was grown on what another model finds.
    pub fn new(
        rig: &Rig,
        network: ComponentNetwork,
        forest: Forest,
        options: RotationOptions,
    ) -> Result<Self, ForestMismatch> {
        if forest.components() != network.components() {
            return Err(ForestMismatch::Components {
                forest: forest.components().join(", "),
                model: network.components().join(", "),
            });
        }
        if forest.facing_bins() != network.facing_bins() {
            return Err(ForestMismatch::Facing {
                forest: forest.facing_bins(),
                model: network.facing_bins(),
            });
        }
        let cameras = rig.cameras().iter();
        Ok(Self {
            reader: RowReader::new(network),
            forest,
            eyes: cameras
                .map(|camera| camera.base_from_optical.origin())
                .collect(),
            options,
            features: Vec::new(),
        })
    }
}

impl RotationEstimator for KeyComponentEstimator {
    fn wants(&self, located: &Located) -> bool {
        let detection = &located.detection;
        self.options.classes.contains(&detection.class)
            && detection.box_px.height_px() >= self.options.min_height_px
            && !located.location.held
    }

    fn estimate(
        &mut self,
        frame: &Frame,
        objects: &[(&Located, Option<Heading>)],
    ) -> Result<Vec<Option<Rotation>>, RotationError> {
        let pixels = frame.image.pixels();
        let pixels = pixels.map_err(|error| RotationError::new(error.to_string()))?;
        let boxes: Vec<BoxPx> = objects
            .iter()
            .map(|(located, _)| located.detection.box_px)
            .collect();
        let seen = self
            .reader
            .read(pixels, &boxes)
            .map_err(RotationError::new)?;
        let eye = self.eyes[frame.camera.index()];
        let mut rotations = Vec::with_capacity(objects.len());
        for (seen, (located, before)) in seen.into_iter().zip(objects) {
            rotations.push(seen.map(|seen| {
                let location = &located.location;
                let away = location.position.coords - eye.coords;
                let ray = RayAngle::towards(away.x, away.y);
                let turned = self.forest.turn(&seen.row, &mut self.features);
                Rotation {
                    heading: decide(location, ray, (&seen.row, &turned), before.as_ref()),
                    components: seen.components,
                }
            }));
        }
        Ok(rotations)
    }
}
