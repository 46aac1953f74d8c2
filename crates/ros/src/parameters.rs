//! Parameters of the node, and the services that ROS's tools read and set them with (`rcl_interfaces`).
//!
//! A parameter keeps no value of its own: it reads and writes what it stands for.

mod events;
mod services;

use ros2_client::{parameters::raw, rcl_interfaces::ListParametersResult};
use std::{collections::BTreeSet, fmt};

pub use events::ParameterEvents;
pub use ros2_client::ParameterValue;
pub use services::services;

type Read = Box<dyn Fn() -> ParameterValue + Send + Sync>;
type Write = Box<dyn Fn(&ParameterValue) -> Result<(), String> + Send + Sync>;
type OnChange = Box<dyn Fn(&str, ParameterValue) + Send + Sync>;

/// Separates the parts of a parameter's name.
const SEPARATOR: char = '.';

/// What the node can be asked for, and perhaps told, while it runs.
pub struct Parameter {
    name: String,
    description: String,
    range: Option<(f64, f64)>,
    read: Read,
    /// Why it cannot be set, or how it is.
    write: Result<Write, String>,
}

impl fmt::Debug for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} = {:?}", self.name, (self.read)())
    }
}

impl Parameter {
    /// One that is fixed while the node runs; `reason` says to who sets it why, and what to do instead.
    pub fn fixed(
        name: impl Into<String>,
        description: impl Into<String>,
        value: ParameterValue,
        reason: impl Into<String>,
    ) -> Self {
        Self {
            name: name.into(),
            description: description.into(),
            range: None,
            read: Box::new(move || value.clone()),
            write: Err(reason.into()),
        }
    }

    /// One that can be set. `write` gets a value of the same type as `read` gives, within the range, and says why when
    /// it refuses.
    pub fn live(
        name: impl Into<String>,
        description: impl Into<String>,
        read: impl Fn() -> ParameterValue + Send + Sync + 'static,
        write: impl Fn(&ParameterValue) -> Result<(), String> + Send + Sync + 'static,
    ) -> Self {
        Self {
            name: name.into(),
            description: description.into(),
            range: None,
            read: Box::new(read),
            write: Ok(Box::new(write)),
        }
    }

    /// A number from `least` to `most`.
    #[must_use]
    pub fn within(mut self, least: f64, most: f64) -> Self {
        self.range = Some((least, most));
        self
    }

    /// Checks a value; gives it as it would be written.
    fn check(&self, value: ParameterValue) -> Result<ParameterValue, String> {
        use ParameterValue::{Double, Integer};
        let name = &self.name;
        if let Err(reason) = &self.write {
            return Err(format!("parameter `{name}` is fixed: {reason}"));
        }
        let value = match ((self.read)(), value) {
            // Who types `1` means the number.
            (Double(_), Integer(number)) => Double(number as f64),
            (before, value) if before.to_parameter_type() == value.to_parameter_type() => value,
            (before, value) => {
                let (expected, found) = (type_name(&before), type_name(&value));
                return Err(format!("parameter `{name}` is a {expected}, not a {found}"));
            }
        };
        let number = match &value {
            Double(number) => Some(*number),
            Integer(number) => Some(*number as f64),
            _ => None,
        };
        match (number, self.range) {
            (Some(number), Some((least, most))) if !(least..=most).contains(&number) => Err(
                format!("parameter `{name}` is {least} to {most}, {number} is out of range"),
            ),
            _ => Ok(value),
        }
    }

    fn write(&self, value: &ParameterValue) -> Result<(), String> {
        let write = self.write.as_ref().map_err(Clone::clone)?;
        write(value)
    }

    fn descriptor(&self) -> raw::ParameterDescriptor {
        let value = (self.read)();
        let mut descriptor = raw::ParameterDescriptor {
            r#type: ParameterValue::to_parameter_type_raw(&value),
            description: self.description.clone(),
            read_only: self.write.is_err(),
            ..unknown(&self.name)
        };
        match (value, self.range) {
            (ParameterValue::Double(_), Some((from_value, to_value))) => {
                let step = 0.0;
                let range = raw::FloatingPointRange {
                    from_value,
                    to_value,
                    step,
                };
                descriptor.floating_point_range.push(range);
            }
            (ParameterValue::Integer(_), Some((least, most))) => {
                let (from_value, to_value, step) = (least as i64, most as i64, 1);
                let range = raw::IntegerRange {
                    from_value,
                    to_value,
                    step,
                };
                descriptor.integer_range.push(range);
            }
            _ => {}
        }
        descriptor
    }
}

/// What is said of a parameter that is not there.
fn unknown(name: &str) -> raw::ParameterDescriptor {
    raw::ParameterDescriptor {
        name: name.to_owned(),
        r#type: raw::ParameterType::NOT_SET,
        description: String::new(),
        additional_constraints: String::new(),
        read_only: false,
        dynamic_typing: false,
        floating_point_range: Vec::new(),
        integer_range: Vec::new(),
    }
}

fn type_name(value: &ParameterValue) -> &'static str {
    match value {
        ParameterValue::NotSet => "value that is not set",
        ParameterValue::Boolean(_) => "bool",
        ParameterValue::Integer(_) => "integer",
        ParameterValue::Double(_) => "double",
        ParameterValue::String(_) => "string",
        ParameterValue::ByteArray(_) => "byte array",
        ParameterValue::BooleanArray(_) => "bool array",
        ParameterValue::IntegerArray(_) => "integer array",
        ParameterValue::DoubleArray(_) => "double array",
        ParameterValue::StringArray(_) => "string array",
    }
}

/// All parameters of a node.
pub struct Parameters {
    list: Vec<Parameter>,
    on_change: OnChange,
}

impl fmt::Debug for Parameters {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_list().entries(&self.list).finish()
    }
}

impl Parameters {
    /// These parameters, of different names. `on_change` hears of every one that was set.
    #[must_use]
    pub fn new(mut list: Vec<Parameter>, on_change: OnChange) -> Self {
        list.sort_by(|a, b| a.name.cmp(&b.name));
        Self { list, on_change }
    }

    /// The names, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.list.iter().map(|parameter| parameter.name.as_str())
    }

    /// A parameter's value; not set when there is none of that name.
    #[must_use]
    pub fn get(&self, name: &str) -> ParameterValue {
        self.find(name)
            .map_or(ParameterValue::NotSet, |parameter| (parameter.read)())
    }

    /// Sets all of these or none.
    ///
    /// # Errors
    /// Why the first that cannot be set cannot.
    pub fn set(&self, values: Vec<(String, ParameterValue)>) -> Result<(), String> {
        let checked = values.into_iter().map(|(name, value)| {
            let undeclared = || format!("parameter `{name}` was not declared");
            let parameter = self.find(&name).ok_or_else(undeclared)?;
            Ok((parameter, parameter.check(value)?))
        });
        let checked: Vec<_> = checked.collect::<Result<_, String>>()?;
        let mut before = Vec::new();
        for (parameter, value) in &checked {
            let value_before = (parameter.read)();
            if let Err(why) = parameter.write(value) {
                for (parameter, value) in before {
                    // It was accepted before.
                    Parameter::write(parameter, &value).ok();
                }
                return Err(format!("parameter `{}`: {why}", parameter.name));
            }
            before.push((*parameter, value_before));
        }
        for (parameter, value) in checked {
            tracing::info!(parameter = parameter.name, ?value, "parameter set");
            (self.on_change)(&parameter.name, value);
        }
        Ok(())
    }

    /// The names below one of `prefixes` (or all, without any), at most `depth` parts down (0: any), with the prefixes
    /// that they have, by the rules of `rclcpp`.
    fn list(&self, prefixes: &[String], depth: u64) -> ListParametersResult {
        let parts = |name: &str| name.matches(SEPARATOR).count() as u64;
        let is_near = |name: &str| depth == 0 || parts(name) < depth;
        let fits = |name: &str| {
            prefixes.is_empty() && is_near(name)
                || prefixes
                    .iter()
                    .any(|prefix| match name.strip_prefix(prefix.as_str()) {
                        Some("") => true,
                        Some(below) => below.strip_prefix(SEPARATOR).is_some_and(is_near),
                        None => false,
                    })
        };
        let names: Vec<String> = self
            .names()
            .filter(|name| fits(name))
            .map(str::to_owned)
            .collect();
        let prefixes: BTreeSet<String> = names
            .iter()
            .filter_map(|name| Some(name.rsplit_once(SEPARATOR)?.0.to_owned()))
            .collect();
        ListParametersResult {
            names,
            prefixes: prefixes.into_iter().collect(),
        }
    }

    fn find(&self, name: &str) -> Option<&Parameter> {
        self.list.iter().find(|parameter| parameter.name == name)
    }
}

#[cfg(test)]
mod tests;
