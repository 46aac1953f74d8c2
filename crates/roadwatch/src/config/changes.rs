//! What the command line changes in a configuration: another dataset, and ROS's parameters, which are keys of it.

use super::{DatasetChoice, Mistakes};
use roadwatch_ros::{ParameterRule, RosArgs};
use std::{collections::BTreeMap, fs, path::Path};
use toml::{Table, Value};

/// What the command line changes in a configuration.
#[derive(Debug, Clone, Default)]
pub struct Changes {
    /// The dataset in the place of `rig.dataset`.
    pub dataset: Option<DatasetChoice>,
    /// What stands behind `--ros-args`: parameters are keys of the configuration, such as `detector.score_threshold`.
    pub ros: RosArgs,
}

impl From<DatasetChoice> for Changes {
    fn from(dataset: DatasetChoice) -> Self {
        Self {
            dataset: Some(dataset),
            ros: RosArgs::default(),
        }
    }
}

impl From<RosArgs> for Changes {
    fn from(ros: RosArgs) -> Self {
        Self { dataset: None, ros }
    }
}

/// Parameters that every ROS 2 node has, and where the configuration has them.
const USE_SIM_TIME: &str = "use_sim_time";
/// Every node, in files of parameters.
const ANY_NODE: [&str; 2] = ["/**", "/*"];
/// Below a node's name, in files of parameters.
const PARAMETERS: &str = "ros__parameters";

impl Changes {
    /// The node's full name, as parameters for single nodes have it: `/namespace/name`.
    pub(super) fn node_name(&self, file: &Path, text: &str) -> NodeName {
        // Only the names are wanted; all else that may be wrong is said by who reads all of it.
        let table: Table = text.parse().unwrap_or_default();
        let node = table.get("node").and_then(Value::as_table);
        let text = |key: &str| node.and_then(|node| node.get(key)?.as_str().map(str::to_owned));
        let default = roadwatch_ros::Surface::default();
        let configured = text("name").unwrap_or(default.node_name.clone());
        let surface = roadwatch_ros::Surface {
            node_name: configured.clone(),
            namespace: text("namespace").unwrap_or(default.namespace.clone()),
            ..default
        };
        NodeName {
            full: surface.renamed(&self.ros).private_prefix(),
            configured,
            config: file.to_owned(),
        }
    }

    /// The parameters as TOML, to be put over the configuration.
    pub(super) fn overrides(&self, node: &NodeName) -> Result<String, Mistakes> {
        let mut all = Table::new();
        for rule in &self.ros.parameters {
            match rule {
                ParameterRule::Value {
                    node: of,
                    name,
                    yaml,
                } => {
                    if of.as_ref().is_none_or(|of| *of == node.configured) {
                        // What is no YAML is the text that it is, as for ROS.
                        let value = serde_saphyr::from_str(yaml);
                        let value = value.unwrap_or_else(|_| Value::String(yaml.clone()));
                        put(&mut all, name, value);
                    }
                }
                ParameterRule::File(file) => add_file(&mut all, file, node)?,
            }
        }
        toml::to_string(&all)
            .map_err(|error| Mistakes::about_file(&node.config, format!("--ros-args: {error}")))
    }
}

/// What the node is called.
pub(super) struct NodeName {
    /// With its namespace, and as renamed.
    full: String,
    /// As configured.
    configured: String,
    config: std::path::PathBuf,
}

impl NodeName {
    fn is_meant_by(&self, name: &str) -> bool {
        let base = self.full.rsplit('/').next();
        ANY_NODE.contains(&name) || name == self.full || Some(name) == base
    }
}

fn add_file(all: &mut Table, file: &Path, node: &NodeName) -> Result<(), Mistakes> {
    let refused = |what: String| Mistakes::about_file(file, what);
    let text =
        fs::read_to_string(file).map_err(|error| refused(format!("cannot be read: {error}")))?;
    let nodes: BTreeMap<String, Value> = serde_saphyr::from_str(&text)
        .map_err(|error| refused(format!("is no file of parameters: {error}")))?;
    let mut found = false;
    for (name, value) in nodes {
        if !node.is_meant_by(&name) {
            continue;
        }
        let parameters = value.get(PARAMETERS).and_then(Value::as_table);
        let Some(parameters) = parameters else {
            return Err(refused(format!("`{name}` has no {PARAMETERS}")));
        };
        found = true;
        for (name, value) in parameters {
            put_all(all, name, value);
        }
    }
    if !found {
        tracing::warn!(file = %file.display(), "no parameters for {} in this file", node.full);
    }
    Ok(())
}

/// Puts a value, or every value of a table, at a dotted key.
fn put_all(all: &mut Table, name: &str, value: &Value) {
    match value {
        Value::Table(inner) => {
            for (key, value) in inner {
                put_all(all, &format!("{name}.{key}"), value);
            }
        }
        value => put(all, name, value.clone()),
    }
}

fn put(all: &mut Table, name: &str, value: Value) {
    let name = if name == USE_SIM_TIME {
        "node.use_sim_time"
    } else {
        name
    };
    let mut at = all;
    let (path, last) = name.rsplit_once('.').unwrap_or(("", name));
    for part in path.split('.').filter(|part| !part.is_empty()) {
        let inner = at.entry(part).or_insert_with(|| Value::Table(Table::new()));
        if !inner.is_table() {
            *inner = Value::Table(Table::new());
        }
        let Value::Table(inner) = inner else {
            return;
        };
        at = inner;
    }
    at.insert(last.to_owned(), value);
}
