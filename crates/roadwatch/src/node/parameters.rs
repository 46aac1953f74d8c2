//! The daemon's parameters: keys of its configuration, and which of them can be changed while it runs.

use crate::session::{Controls, Session};
use roadwatch_detect::{ClassFilter, YoloDetector};
use roadwatch_ros::{Parameter, ParameterValue, Parameters, parameters::ParameterEvents};
use std::sync::{Arc, atomic::Ordering};

const READ_AT_START: &str =
    "it is read at start; change the configuration, or pass it with -p, and start anew";
/// More objects than any image shows.
const MOST_CROPS: f64 = 255.0;

/// All of them.
pub(super) fn of(session: &Session, events: ParameterEvents) -> Arc<Parameters> {
    let Controls {
        detector,
        crops_per_frame,
        switches,
    } = session.controls.clone();
    let mut list = vec![score_threshold(&detector), classes(&detector)];
    list.extend(crops_per_frame.map(|crops| {
        let read = Arc::clone(&crops);
        Parameter::live(
            "rotation.crops_per_frame",
            "most objects of an image that are looked at for their headings",
            move || ParameterValue::Integer(read.load(Ordering::Relaxed) as i64),
            move |value| {
                if let ParameterValue::Integer(number) = value {
                    crops.store(usize::try_from(*number).unwrap_or(0), Ordering::Relaxed);
                }
                Ok(())
            },
        )
        .within(1.0, MOST_CROPS)
    }));
    for id in session.rig.ids() {
        let (read, write) = (switches.clone(), switches.clone());
        let name = &session.rig.camera(id).name;
        list.push(Parameter::live(
            format!("enabled.{}", name.as_str()),
            "whether this camera is looked at",
            move || ParameterValue::Boolean(read.is_enabled(id)),
            move |value| {
                write.set_enabled(id, *value == ParameterValue::Boolean(true));
                Ok(())
            },
        ));
    }
    list.extend(fixed(session));
    let on_change = move |name: &str, value| events.changed(name, value);
    Arc::new(Parameters::new(list, Box::new(on_change)))
}

fn score_threshold(detector: &Arc<YoloDetector>) -> Parameter {
    let (read, write) = (Arc::clone(detector), Arc::clone(detector));
    Parameter::live(
        "detector.score_threshold",
        "least score of a detection, of classes without a threshold of their own",
        move || ParameterValue::Double(shortest(read.filter().score_threshold)),
        move |value| {
            let ParameterValue::Double(number) = value else {
                return Ok(());
            };
            set_filter(
                &write,
                ClassFilter {
                    score_threshold: *number as f32,
                    ..write.filter()
                },
            )
        },
    )
    .within(0.0, 1.0)
}

/// A list of text; without any class, all classes.
fn classes(detector: &Arc<YoloDetector>) -> Parameter {
    let (read, write) = (Arc::clone(detector), Arc::clone(detector));
    Parameter::live(
        "detector.classes",
        "classes that are kept; an empty list keeps all",
        move || ParameterValue::StringArray(read.filter().allowed.unwrap_or_default()),
        move |value| {
            let ParameterValue::StringArray(classes) = value else {
                return Ok(());
            };
            set_filter(
                &write,
                ClassFilter {
                    allowed: Some(classes.clone()).filter(|classes| !classes.is_empty()),
                    ..write.filter()
                },
            )
        },
    )
}

fn set_filter(detector: &YoloDetector, filter: ClassFilter) -> Result<(), String> {
    detector
        .set_filter(filter)
        .map_err(|error| error.to_string())
}

/// The number as it was written: 0.4, and not what 0.4 becomes on its way through 32 bits.
fn shortest(number: f32) -> f64 {
    number.to_string().parse().unwrap_or(f64::from(number))
}

/// What everybody may ask for and nobody can change.
fn fixed(session: &Session) -> Vec<Parameter> {
    let config = &session.config;
    let text = |name: &str, description: &str, value: String| {
        Parameter::fixed(
            name,
            description,
            ParameterValue::String(value),
            READ_AT_START,
        )
    };
    let flag = |name: &str, description: &str, value| {
        Parameter::fixed(
            name,
            description,
            ParameterValue::Boolean(value),
            READ_AT_START,
        )
    };
    let node = &config.node;
    let model = config
        .detector
        .as_ref()
        .map(|detector| &detector.options.model);
    let model = model.map_or_else(String::new, |model| model.display().to_string());
    let base_frame = node.options.surface.base_frame.clone();
    vec![
        flag(
            "use_sim_time",
            "whether \"now\" is what /clock says; stamps of outputs are those of images in any case",
            node.use_sim_time,
        ),
        text(
            "node.base_frame",
            "tf frame that positions are given in",
            base_frame,
        ),
        flag(
            "node.publish_tf",
            "whether the cameras' places are on /tf_static",
            node.publishing.tf,
        ),
        flag(
            "node.publish_unread",
            "whether messages are made for topics that nobody reads",
            node.publishing.unread,
        ),
        text("detector.model", "the network", model),
        text(
            "locate.method",
            "how objects are placed, by cameras without a method of their own",
            config.locate.method.to_string(),
        ),
    ]
}
