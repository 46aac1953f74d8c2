//! The detector of the pipeline: decode, letterbox, network, head, suppression.

use crate::{
    head::Family,
    letterbox::{Letterbox, Placement, Values},
    network::Network,
    nms::{Candidate, suppress},
    options::{ClassFilter, DetectorError, DetectorOptions, class_names, kinds, thresholds},
    rhythm::Rhythm,
    workspace::{Workspace, Workspaces},
};
use roadwatch_core::{
    DetectError, Detection, Detector, Frame, ImageSize, ObjectClass, PerFrame, Score,
};
use roadwatch_onnx::Runtime;
use std::{
    sync::{Arc, Mutex, PoisonError, RwLock},
    time::{Duration, Instant},
};

/// A YOLO network as a [`Detector`]. Calls may overlap: one prepares images while another runs the network.
pub struct YoloDetector {
    network: Mutex<Network>,
    input_size: ImageSize,
    batch: usize,
    placement: Placement,
    values: Values,
    classes: Vec<ObjectClass>,
    filter: RwLock<Arc<Filter>>,
    /// Per class: what suppression takes for it.
    kinds: Vec<u16>,
    iou_threshold: f32,
    max_detections: usize,
    letterboxes: RwLock<Vec<Arc<Letterbox>>>,
    workspaces: Workspaces,
    rhythm: Rhythm,
}

/// What is kept of the network's answers.
struct Filter {
    wanted: ClassFilter,
    /// Per class; infinite for classes nobody wants.
    thresholds: Vec<f32>,
}

impl YoloDetector {
    /// Which detections are wanted now.
    #[must_use]
    pub fn filter(&self) -> ClassFilter {
        self.kept().wanted.clone()
    }

    /// Wants others from the next image on.
    ///
    /// # Errors
    /// [`DetectorError::UnknownClasses`]; then all stays as it was.
    pub fn set_filter(&self, wanted: ClassFilter) -> Result<(), DetectorError> {
        let thresholds = thresholds(&self.classes, &wanted)?;
        let filter = Arc::new(Filter { wanted, thresholds });
        *self.filter.write().unwrap_or_else(PoisonError::into_inner) = filter;
        Ok(())
    }

    /// What runs the network.
    #[must_use]
    pub fn provider(&self) -> &'static str {
        self.network
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .provider()
    }

    fn kept(&self) -> Arc<Filter> {
        let filter = self.filter.read().unwrap_or_else(PoisonError::into_inner);
        Arc::clone(&filter)
    }

    /// Opens the model and checks it against the options.
    ///
    /// # Errors
    /// See [`DetectorError`].
    pub fn open(runtime: &Runtime, options: &DetectorOptions) -> Result<Self, DetectorError> {
        let network = Network::open(runtime, &options.model, &options.network)?;
        let family = network.head().family();
        if let Some(expected) = options.family.filter(|&expected| expected != family) {
            return Err(DetectorError::WrongFamily {
                path: options.model.clone(),
                expected,
                found: family,
            });
        }
        let classes = class_names(&network, options)?;
        let thresholds = thresholds(&classes, &options.filter)?;
        let kinds = kinds(&classes, &options.exclusive_classes)?;
        let (placement, values) = match family {
            Family::YoloV5 | Family::YoloV8 => (Placement::Centred, Values::RgbUnit),
            Family::YoloX => (Placement::TopLeft, Values::BgrByte),
        };
        Ok(Self {
            input_size: network.input_size(),
            batch: network.batch().max(),
            network: Mutex::new(network),
            placement,
            values,
            classes,
            filter: RwLock::new(Arc::new(Filter {
                wanted: options.filter.clone(),
                thresholds,
            })),
            kinds,
            iou_threshold: options.iou_threshold,
            max_detections: options.max_detections,
            letterboxes: RwLock::default(),
            workspaces: Workspaces::default(),
            rhythm: Rhythm::default(),
        })
    }

    fn letterbox(&self, image: ImageSize) -> Arc<Letterbox> {
        let known = |letterboxes: &[Arc<Letterbox>]| {
            letterboxes
                .iter()
                .find(|l| l.image_size() == image)
                .cloned()
        };
        let letterboxes = self
            .letterboxes
            .read()
            .unwrap_or_else(PoisonError::into_inner);
        if let Some(found) = known(&letterboxes) {
            return found;
        }
        drop(letterboxes);
        let new = Arc::new(Letterbox::new(
            image,
            self.input_size,
            self.placement,
            self.values,
        ));
        let mut letterboxes = self
            .letterboxes
            .write()
            .unwrap_or_else(PoisonError::into_inner);
        letterboxes.push(Arc::clone(&new));
        new
    }

    fn prepare(
        &self,
        frame: Frame,
        place: usize,
        work: &mut Workspace,
    ) -> Result<Prepared, DetectError> {
        let pixels = frame
            .image
            .pixels()
            .map_err(|error| DetectError::Decode(error.clone()))?;
        let letterbox = self.letterbox(pixels.size());
        let len = Letterbox::input_len(self.input_size);
        let input = &mut work.input[place * len..(place + 1) * len];
        letterbox.fill(pixels, input, &mut work.scratch);
        Ok(Prepared { frame, letterbox })
    }

    /// Runs the network on the prepared images and leaves the raw boxes of each in `work.raw`.
    fn infer(&self, images: usize, work: &mut Workspace) -> Result<(), String> {
        let Workspace {
            input, raw, best, ..
        } = work;
        raw.resize_with(self.batch, Vec::new);
        raw.iter_mut().for_each(Vec::clear);
        let filter = self.kept();
        let mut network = self.network.lock().unwrap_or_else(PoisonError::into_inner);
        let began = Instant::now();
        self.rhythm.running(began);
        let ran = network.run(input, images, |at, head, output| {
            head.decode(output, &filter.thresholds, best, &mut raw[at]);
        });
        self.rhythm.ran(began.elapsed());
        ran.map_err(|error| error.to_string())
    }

    fn select(
        &self,
        prepared: Prepared,
        place: usize,
        work: &mut Workspace,
    ) -> PerFrame<Detection> {
        let candidates = &mut work.candidates;
        candidates.clear();
        candidates.extend(work.raw[place].iter().filter_map(|raw| {
            Some(Candidate {
                box_px: prepared.letterbox.to_image(raw.corners)?,
                score: raw.score,
                class: raw.class,
                kind: self.kinds[usize::from(raw.class)],
            })
        }));
        suppress(candidates, self.iou_threshold, self.max_detections);
        let items = candidates.iter().filter_map(|candidate| {
            Some(Detection {
                class: self.classes[usize::from(candidate.class)].clone(),
                score: Score::new(candidate.score)?,
                box_px: candidate.box_px,
                input_pixel_px: prepared.letterbox.input_pixel_px(),
            })
        });
        PerFrame {
            items: items.collect(),
            frame: prepared.frame,
        }
    }

    fn detect_batch(
        &self,
        frames: Vec<Frame>,
        work: &mut Workspace,
    ) -> Vec<Result<PerFrame<Detection>, DetectError>> {
        work.input
            .resize(self.batch * Letterbox::input_len(self.input_size), 0.0);
        let began = Instant::now();
        self.rhythm.preparing(began);
        let mut images = 0;
        let prepared: Vec<_> = frames
            .into_iter()
            .map(|frame| {
                let prepared = self.prepare(frame, images, work)?;
                images += 1;
                Ok(prepared)
            })
            .collect();
        self.rhythm.prepared(began.elapsed());
        let inferred = if images > 0 {
            self.infer(images, work)
        } else {
            Ok(())
        };
        let mut place = 0;
        prepared
            .into_iter()
            .map(|prepared| {
                let prepared = prepared?;
                if let Err(reason) = &inferred {
                    return Err(DetectError::Inference(reason.clone().into()));
                }
                place += 1;
                Ok(self.select(prepared, place - 1, work))
            })
            .collect()
    }
}

/// A frame whose image lies in the input.
struct Prepared {
    frame: Frame,
    letterbox: Arc<Letterbox>,
}

impl Detector for YoloDetector {
    fn detect(&self, frames: Vec<Frame>) -> Vec<Result<PerFrame<Detection>, DetectError>> {
        self.workspaces.with(|work| {
            let mut found = Vec::with_capacity(frames.len());
            let mut waiting = frames.into_iter();
            loop {
                let batch: Vec<_> = waiting.by_ref().take(self.batch).collect();
                if batch.is_empty() {
                    return found;
                }
                found.extend(self.detect_batch(batch, work));
            }
        })
    }

    fn max_batch(&self) -> usize {
        self.batch
    }

    fn hold_off(&self) -> Duration {
        self.rhythm.hold_off(Instant::now())
    }
}
