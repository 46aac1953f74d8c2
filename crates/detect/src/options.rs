//! What a detector is told to do, and whether the model can.

use crate::{
    class_names::COCO_CLASSES,
    head::Family,
    network::{Network, NetworkError, NetworkOptions},
};
use roadwatch_core::ObjectClass;
use std::path::PathBuf;

/// Which detections are wanted.
#[derive(Debug, Clone, PartialEq)]
pub struct ClassFilter {
    /// Least score, `0.0..=1.0`, of classes without one of their own.
    pub score_threshold: f32,
    /// Least scores of single classes.
    pub class_thresholds: Vec<(String, f32)>,
    /// The classes wanted; `None` for all.
    pub allowed: Option<Vec<String>>,
}

/// Everything about a detector that is a choice.
#[derive(Debug, Clone, PartialEq)]
pub struct DetectorOptions {
    /// The ONNX file.
    pub model: PathBuf,
    /// The family it must be; `None` to take what its output says.
    pub family: Option<Family>,
    /// Names of its classes; `None` for those in the model's metadata, or COCO's when it has 80.
    pub class_names: Option<Vec<String>>,
    /// How it is run.
    pub network: NetworkOptions,
    /// What is kept.
    pub filter: ClassFilter,
    /// Overlap above which the weaker of two boxes of a class is dropped, `0.0..=1.0`.
    pub iou_threshold: f32,
    /// Classes that one object is only one of: the weaker of two boxes is dropped among them, too.
    pub exclusive_classes: Vec<String>,
    /// Most detections per frame.
    pub max_detections: usize,
}

/// A detector that cannot be built.
#[derive(Debug, thiserror::Error)]
pub enum DetectorError {
    /// The model.
    #[error(transparent)]
    Network(#[from] NetworkError),
    /// The model is of another family than the configuration says.
    #[error("`{path}` has a {found} head; detector.family says {expected}")]
    WrongFamily {
        /// The file.
        path: PathBuf,
        /// What the configuration says.
        expected: Family,
        /// What the output says.
        found: Family,
    },
    /// Class names are missing or too many.
    #[error("`{path}` has {classes} classes and {names} names are given: set detector.class_names")]
    ClassNames {
        /// The file.
        path: PathBuf,
        /// Classes of the output.
        classes: usize,
        /// Names known.
        names: usize,
    },
    /// Classes in the configuration that the model does not know.
    #[error(
        "{} of the model; it knows: {known}",
        not_classes(&[allowed, with_thresholds, exclusive])
    )]
    UnknownClasses {
        /// Those wanted.
        allowed: Vec<String>,
        /// Those with thresholds of their own.
        with_thresholds: Vec<String>,
        /// Those that exclude each other.
        exclusive: Vec<String>,
        /// The model's classes.
        known: String,
    },
}

fn not_classes(unknown: &[&[String]]) -> String {
    let names = unknown.iter().copied().flatten();
    let names: Vec<_> = names.map(|name| format!("`{name}`")).collect();
    let are = if names.len() == 1 {
        "is no class"
    } else {
        "are no classes"
    };
    format!("{} {are}", names.join(", "))
}

/// Names of the model's classes, in the order of their numbers.
pub(crate) fn class_names(
    network: &Network,
    options: &DetectorOptions,
) -> Result<Vec<ObjectClass>, DetectorError> {
    let classes = network.head().classes();
    let named = |names: &[String]| names.iter().map(|name| ObjectClass::new(name)).collect();
    let names: Vec<ObjectClass> = match (&options.class_names, network.class_names()) {
        (Some(names), _) => named(names),
        (None, Some(names)) => named(names),
        (None, None) if classes == COCO_CLASSES.len() => COCO_CLASSES
            .iter()
            .map(|name| ObjectClass::new(name))
            .collect(),
        (None, None) => Vec::new(),
    };
    if names.len() == classes {
        Ok(names)
    } else {
        Err(DetectorError::ClassNames {
            path: options.model.clone(),
            classes,
            names: names.len(),
        })
    }
}

/// Least score of each class, infinite for those nobody wants.
pub(crate) fn thresholds(
    classes: &[ObjectClass],
    filter: &ClassFilter,
) -> Result<Vec<f32>, DetectorError> {
    let number = |name: &str| classes.iter().position(|class| class.as_str() == name);
    let unknown = |names: &mut dyn Iterator<Item = &String>| -> Vec<String> {
        names
            .filter(|name| number(name).is_none())
            .cloned()
            .collect()
    };
    let allowed = unknown(&mut filter.allowed.iter().flatten());
    let with_thresholds = unknown(&mut filter.class_thresholds.iter().map(|(name, _)| name));
    if !(allowed.is_empty() && with_thresholds.is_empty()) {
        return Err(DetectorError::UnknownClasses {
            allowed,
            with_thresholds,
            exclusive: Vec::new(),
            known: listed(classes),
        });
    }
    let least = |class: &ObjectClass| {
        let name = class.as_str();
        let wanted = filter
            .allowed
            .as_ref()
            .is_none_or(|allowed| allowed.iter().any(|one| one == name));
        let own = filter.class_thresholds.iter().find(|(one, _)| one == name);
        match (wanted, own) {
            (false, _) => f32::INFINITY,
            (true, Some(&(_, own))) => own,
            (true, None) => filter.score_threshold,
        }
    };
    Ok(classes.iter().map(least).collect())
}

/// What suppression takes for each class: itself, and for those that exclude each other the first of them.
pub(crate) fn kinds(
    classes: &[ObjectClass],
    exclusive: &[String],
) -> Result<Vec<u16>, DetectorError> {
    let is_named = |name: &String| classes.iter().any(|class| class.as_str() == name);
    let unknown: Vec<_> = exclusive
        .iter()
        .filter(|name| !is_named(name))
        .cloned()
        .collect();
    if !unknown.is_empty() {
        return Err(DetectorError::UnknownClasses {
            allowed: Vec::new(),
            with_thresholds: Vec::new(),
            exclusive: unknown,
            known: listed(classes),
        });
    }
    let excludes = |class: &ObjectClass| exclusive.iter().any(|name| name == class.as_str());
    let first = classes.iter().position(excludes);
    let kind = |(at, class): (usize, &ObjectClass)| match first {
        Some(first) if excludes(class) => first as u16,
        _ => at as u16,
    };
    Ok(classes.iter().enumerate().map(kind).collect())
}

fn listed(classes: &[ObjectClass]) -> String {
    let names: Vec<_> = classes.iter().map(ObjectClass::as_str).collect();
    names.join(", ")
}
