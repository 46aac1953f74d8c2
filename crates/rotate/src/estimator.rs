//! Headings of a frame's objects: crops, one run of the network, rows, forest, decision.

use crate::{
    angle::RayAngle,
    crop::{Crop, Scratch},
    decision::decide,
    forest::Forest,
    network::ComponentNetwork,
    position_curve::PositionCurve,
    row::Row,
};
use nalgebra::Vector3;
use roadwatch_core::{
    BoxPx, CameraName, Frame, Heading, Located, ObjectClass, Pixels, Rig, RigCamera, Rotation,
    RotationError, RotationEstimator, SeenComponent,
    rig::LooksVertical,
    space::{BaseLink, CameraGround, Point, Transform},
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

/// What turns an observation angle into a heading (docs/method.md, section 6).
#[derive(Clone, Debug, PartialEq)]
pub enum Calibration {
    /// The ray to the object, from the camera's pose and the object's place.
    Ray,
    /// The paper's curve of where the object stands across the camera.
    Curve(PositionCurve),
}

/// Parts that do not go together.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EstimatorError {
    /// A curve over the ground before a camera that looks up or down.
    #[error("camera `{camera}` has no ground ahead for a position curve")]
    Pose {
        /// The camera.
        camera: CameraName,
        /// Why.
        source: LooksVertical,
    },
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
    /// How each camera's angles become headings, by its number.
    cameras: Vec<CameraCalibration>,
    options: RotationOptions,
    features: Vec<f64>,
}

impl KeyComponentEstimator {
    /// An estimator for the cameras of a rig.
    ///
    /// # Errors
    /// When the forest was grown on what another model finds, or a camera cannot be calibrated so.
    pub fn new(
        rig: &Rig,
        (network, forest): (ComponentNetwork, Forest),
        calibration: &Calibration,
        options: RotationOptions,
    ) -> Result<Self, EstimatorError> {
        if forest.components() != network.components() {
            return Err(EstimatorError::Components {
                forest: forest.components().join(", "),
                model: network.components().join(", "),
            });
        }
        if forest.facing_bins() != network.facing_bins() {
            return Err(EstimatorError::Facing {
                forest: forest.facing_bins(),
                model: network.facing_bins(),
            });
        }
        let cameras = rig.cameras().iter();
        Ok(Self {
            reader: RowReader::new(network),
            forest,
            cameras: cameras
                .map(|camera| CameraCalibration::new(camera, rig.ground_z_m, calibration))
                .collect::<Result<_, _>>()?,
            options,
            features: Vec::new(),
        })
    }
}

/// One camera's.
enum CameraCalibration {
    Ray {
        eye: Point<BaseLink>,
    },
    Curve {
        curve: PositionCurve,
        ground_from_base: Transform<CameraGround, BaseLink>,
        /// The camera's own direction in base_link, radians.
        azimuth_rad: f64,
    },
}

impl CameraCalibration {
    fn new(
        camera: &RigCamera,
        ground_z_m: f64,
        calibration: &Calibration,
    ) -> Result<Self, EstimatorError> {
        let Calibration::Curve(curve) = calibration else {
            let eye = camera.base_from_optical.origin();
            return Ok(Self::Ray { eye });
        };
        let base_from_ground = camera.base_from_ground(ground_z_m);
        let base_from_ground = base_from_ground.map_err(|source| EstimatorError::Pose {
            camera: camera.name.clone(),
            source,
        })?;
        let ahead = base_from_ground.rotate(Vector3::x());
        Ok(Self::Curve {
            curve: curve.clone(),
            ground_from_base: base_from_ground.inverse(),
            azimuth_rad: ahead.y.atan2(ahead.x),
        })
    }

    /// What is added to the observation angle of an object at that place, to give its yaw in base_link.
    fn ray(&self, place: Point<BaseLink>) -> RayAngle {
        match self {
            Self::Ray { eye } => {
                let away = place.coords - eye.coords;
                RayAngle::towards(away.x, away.y)
            }
            Self::Curve {
                curve,
                ground_from_base,
                azimuth_rad,
            } => {
                let loc_x_m = -(*ground_from_base * place).y();
                RayAngle::new(azimuth_rad + curve.ray(loc_x_m).radians())
            }
        }
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
        let calibration = &self.cameras[frame.camera.index()];
        let mut rotations = Vec::with_capacity(objects.len());
        for (seen, (located, before)) in seen.into_iter().zip(objects) {
            rotations.push(seen.map(|seen| {
                let location = &located.location;
                let ray = calibration.ray(location.position);
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
