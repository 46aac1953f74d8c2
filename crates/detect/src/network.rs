//! One ONNX model, opened and tried: input and output checked before the first frame.

use crate::{
    class_names,
    head::{Head, UnknownHead},
    letterbox::Letterbox,
};
use ort::{
    session::Session,
    value::{TensorElementType, TensorRef, ValueType},
};
use roadwatch_core::ImageSize;
use roadwatch_onnx::{Runtime, SessionOptions, open_file};
use std::path::{Path, PathBuf};

const CHANNELS: i64 = 3;
/// A feature map of the coarsest stride has whole cells only in multiples of this, pixels.
const SIDE_MULTIPLE_PX: u32 = 32;

/// How a model is run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct NetworkOptions {
    /// Threads inside one run.
    pub threads: usize,
    /// Busy-wait between runs: a little faster alone, and burns every core beside other work.
    pub spinning: bool,
    /// Input size for models that leave theirs open; `None` when the model fixes it.
    pub input_size: Option<ImageSize>,
    /// Frames per run for models that leave their batch axis open.
    pub max_batch: usize,
}

/// A model that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum NetworkError {
    /// No such file.
    #[error("model `{0}` does not exist: set detector.model to an ONNX file")]
    Absent(PathBuf),
    /// ONNX Runtime refuses the file: truncated, text, another format.
    #[error("`{path}` is not an ONNX model that ONNX Runtime can open: {reason}")]
    NotAModel {
        /// The file.
        path: PathBuf,
        /// What ONNX Runtime said.
        reason: String,
    },
    /// Not one image tensor in, or not one float tensor out.
    #[error("`{path}` is not a detector: {reason}")]
    WrongInterface {
        /// The file.
        path: PathBuf,
        /// What does not fit.
        reason: String,
    },
    /// The output is no known head's.
    #[error("`{path}`: {cause}")]
    UnknownHead {
        /// The file.
        path: PathBuf,
        /// The shape that did not fit.
        #[source]
        cause: UnknownHead,
    },
}

/// An opened model.
pub struct Network {
    session: Session,
    input_name: String,
    input_size: ImageSize,
    batch: Batch,
    head: Head,
    class_names: Option<Vec<String>>,
}

/// How many images one run takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Batch {
    /// Always this many; unused places are run along.
    Fixed(usize),
    /// Any number up to this.
    UpTo(usize),
}

impl Batch {
    /// The most images one run takes.
    #[must_use]
    pub fn max(self) -> usize {
        match self {
            Self::Fixed(count) | Self::UpTo(count) => count,
        }
    }

    fn run_size(self, images: usize) -> usize {
        match self {
            Self::Fixed(count) => count,
            Self::UpTo(_) => images,
        }
    }
}

impl Network {
    /// Opens a model and runs it once on an empty image, which also tells the true output shape.
    ///
    /// # Errors
    /// See [`NetworkError`].
    pub fn open(
        runtime: &Runtime,
        path: &Path,
        options: &NetworkOptions,
    ) -> Result<Self, NetworkError> {
        if !path.is_file() {
            return Err(NetworkError::Absent(path.to_owned()));
        }
        let how = SessionOptions {
            threads: options.threads,
            spinning: options.spinning,
        };
        let session = open_file(runtime, path, how).map_err(|reason| NetworkError::NotAModel {
            path: path.to_owned(),
            reason,
        })?;
        let wrong = |reason: String| NetworkError::WrongInterface {
            path: path.to_owned(),
            reason,
        };
        let (input_name, batch, input_size) = input_of(&session, options).map_err(wrong)?;
        let class_names = session
            .metadata()
            .ok()
            .and_then(|metadata| metadata.custom("names"))
            .and_then(|names| class_names::from_metadata(&names));
        let mut opened = Unchecked {
            session,
            input_name,
            input_size,
            batch,
        };
        let shape = opened.output_shape().map_err(wrong)?;
        let head =
            Head::recognise(&shape, input_size).map_err(|cause| NetworkError::UnknownHead {
                path: path.to_owned(),
                cause,
            })?;
        Ok(Self {
            session: opened.session,
            input_name: opened.input_name,
            input_size,
            batch,
            head,
            class_names,
        })
    }

    /// Width and height the network takes.
    #[must_use]
    pub fn input_size(&self) -> ImageSize {
        self.input_size
    }

    /// Images per run.
    #[must_use]
    pub fn batch(&self) -> Batch {
        self.batch
    }

    /// The recognised output.
    #[must_use]
    pub fn head(&self) -> &Head {
        &self.head
    }

    /// Class names from the model's own metadata; `None` when it has none.
    #[must_use]
    pub fn class_names(&self) -> Option<&[String]> {
        self.class_names.as_deref()
    }

    /// The execution provider that runs the model. Builds of Roadwatch carry ONNX Runtime's CPU provider only.
    #[must_use]
    pub fn provider(&self) -> &'static str {
        "CPUExecutionProvider"
    }

    /// Runs `images` inputs that lie one after another in `input`, and hands each image's part of the
    /// output to `read` with its number. `input` must have room for [`Batch::max`] images.
    ///
    /// # Errors
    /// What ONNX Runtime says.
    pub fn run(
        &mut self,
        input: &[f32],
        images: usize,
        mut read: impl FnMut(usize, &Head, &[f32]),
    ) -> Result<(), ort::Error> {
        let run_size = self.batch.run_size(images);
        let len = Letterbox::input_len(self.input_size);
        let shape = input_shape(run_size, self.input_size);
        let tensor = TensorRef::from_array_view((shape, &input[..run_size * len]))?;
        let outputs = self
            .session
            .run(ort::inputs![self.input_name.as_str() => tensor])?;
        let (_, output) = outputs[0].try_extract_tensor::<f32>()?;
        let parts = output.chunks_exact(self.head.output_len());
        if parts.len() < images {
            let found = parts.len();
            return Err(ort::Error::new(format!(
                "outputs for {found} of {images} images"
            )));
        }
        for (at, part) in parts.take(images).enumerate() {
            read(at, &self.head, part);
        }
        Ok(())
    }
}

/// A session whose output nobody has looked at yet.
struct Unchecked {
    session: Session,
    input_name: String,
    input_size: ImageSize,
    batch: Batch,
}

impl Unchecked {
    fn output_shape(&mut self) -> Result<Vec<i64>, String> {
        // As many as a run may ever take: a batch axis can be free in name only.
        let run_size = self.batch.max();
        let input = vec![0.0_f32; run_size * Letterbox::input_len(self.input_size)];
        let shape = input_shape(run_size, self.input_size);
        let text = |error: ort::Error| error.to_string();
        let tensor = TensorRef::from_array_view((shape, &input[..])).map_err(text)?;
        let outputs = self
            .session
            .run(ort::inputs![self.input_name.as_str() => tensor])
            .map_err(text)?;
        let (shape, _) = outputs[0]
            .try_extract_tensor::<f32>()
            .map_err(|error| format!("its output is not a tensor of 32-bit floats ({error})"))?;
        if shape.first() != Some(&(run_size as i64)) {
            return Err(format!(
                "it gives an output of {shape:?} for {run_size} images"
            ));
        }
        Ok(shape.to_vec())
    }
}

fn input_shape(images: usize, size: ImageSize) -> [i64; 4] {
    [
        images as i64,
        CHANNELS,
        i64::from(size.height_px),
        i64::from(size.width_px),
    ]
}

fn input_of(
    session: &Session,
    options: &NetworkOptions,
) -> Result<(String, Batch, ImageSize), String> {
    let [input] = session.inputs() else {
        return Err(format!(
            "it has {} inputs, a detector has one image",
            session.inputs().len()
        ));
    };
    if session.outputs().len() != 1 {
        return Err(format!(
            "it has {} outputs, expected one; export it without post-processing",
            session.outputs().len()
        ));
    }
    let ValueType::Tensor { ty, shape, .. } = input.dtype() else {
        return Err("its input is not a tensor".to_owned());
    };
    if *ty != TensorElementType::Float32 {
        return Err(format!("its input is {ty}, expected 32-bit floats"));
    }
    let &[images, CHANNELS, height, width] = &shape[..] else {
        return Err(format!(
            "its input is {shape:?}, expected [N, 3, height, width]"
        ));
    };
    let batch = match usize::try_from(images) {
        Ok(count) => Batch::Fixed(count.max(1)),
        Err(_) => Batch::UpTo(options.max_batch.max(1)),
    };
    let size = input_size(width, height, options.input_size)?;
    Ok((input.name().to_owned(), batch, size))
}

/// A negative side is one that the model leaves open.
fn input_size(width: i64, height: i64, asked: Option<ImageSize>) -> Result<ImageSize, String> {
    let fixed = |side: i64| u32::try_from(side).ok();
    let size = match (fixed(width), fixed(height), asked) {
        (Some(width_px), Some(height_px), asked) => {
            let size = ImageSize {
                width_px,
                height_px,
            };
            if asked.is_some_and(|asked| asked != size) {
                return Err(format!(
                    "its input is fixed at {size}; remove detector.input_size_px"
                ));
            }
            size
        }
        (_, _, Some(asked)) => asked,
        _ => return Err("it leaves its input size open; set detector.input_size_px".to_owned()),
    };
    let fits = |side: u32| side > 0 && side.is_multiple_of(SIDE_MULTIPLE_PX);
    if fits(size.width_px) && fits(size.height_px) {
        Ok(size)
    } else {
        Err(format!(
            "its input is {size}; both sides must be multiples of {SIDE_MULTIPLE_PX}"
        ))
    }
}
