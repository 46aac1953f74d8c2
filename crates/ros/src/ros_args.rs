//! What comes behind `--ros-args`: other names for the node and its topics, and a log level (ROS 2 design, "ROS command
//! line arguments").

use crate::surface::{is_namespace, is_token};
use std::path::PathBuf;

/// What was asked for behind `--ros-args`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RosArgs {
    /// Rules, in order; of those that fit a name the first counts.
    pub rules: Vec<RemapRule>,
    /// `--log-level`; the last one given for everything.
    pub log_level: Option<LogLevel>,
    /// Files of parameters, and parameters; what stands later counts.
    pub parameters: Vec<ParameterRule>,
}

/// Values for parameters, of one node or of any.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ParameterRule {
    /// `-p`: one parameter.
    Value {
        /// The node it is for, by the name it has without rules; `None` for any.
        node: Option<String>,
        /// The parameter.
        name: String,
        /// Its value, as YAML.
        yaml: String,
    },
    /// `--params-file`: a YAML file.
    File(PathBuf),
}

/// `from:=to`, for one node or for any.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RemapRule {
    /// The node it is for, by the name it has without rules; `None` for any.
    pub node: Option<String>,
    /// What gets another name.
    pub what: Renamed,
    /// The other name.
    pub to: String,
}

/// What a rule gives another name to.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Renamed {
    /// `__node`.
    Node,
    /// `__ns`.
    Namespace,
    /// A topic: absolute, relative to the namespace, or private (`~/…`).
    Topic(String),
}

/// Levels of ROS 2's loggers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LogLevel {
    /// And everything below.
    Debug,
    /// And everything below.
    Info,
    /// And everything below.
    Warn,
    /// And fatal ones, which are errors here.
    Error,
}

impl LogLevel {
    const NAMES: [(&'static str, Self); 6] = [
        ("debug", Self::Debug),
        ("info", Self::Info),
        ("warn", Self::Warn),
        ("warning", Self::Warn),
        ("error", Self::Error),
        ("fatal", Self::Error),
    ];

    /// Its name in filters of `tracing`.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Debug => "debug",
            Self::Info => "info",
            Self::Warn => "warn",
            Self::Error => "error",
        }
    }

    fn from_name(text: &str) -> Option<Self> {
        let lower = text.to_ascii_lowercase();
        let mut names = Self::NAMES.into_iter();
        names
            .find(|(name, _)| *name == lower)
            .map(|(_, level)| level)
    }
}

/// Arguments behind `--ros-args` that cannot be followed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RosArgsError {
    /// Nothing behind an option.
    #[error("`{0}` wants a value behind it")]
    NoValue(String),
    /// Not `from:=to`.
    #[error(
        "`{0}` is no remapping: expected FROM:=TO, such as __node:=front or scene/objects:=/objects"
    )]
    Rule(String),
    /// Not `name:=value`.
    #[error("`{0}` is no parameter: expected NAME:=VALUE, such as detector.score_threshold:=0.4")]
    Parameter(String),
    /// A name that ROS 2 would refuse.
    #[error("`{rule}`: `{name}` is not {expected}")]
    Name {
        /// The whole rule.
        rule: String,
        /// The name in it.
        name: String,
        /// What would be one.
        expected: &'static str,
    },
    /// No level.
    #[error("`{0}` is no log level: expected debug, info, warn, error or fatal")]
    Level(String),
    /// Something that this node does not do.
    #[error("`{0}` cannot be followed: {1}")]
    Unsupported(String, &'static str),
}

const NO_SECURITY: &str = "DDS security is not supported";
const NO_LOGGER: &str =
    "levels are of the whole program, and its log goes to standard error; give a filter with --log";

impl RosArgs {
    /// Reads what stands between `--ros-args` and `--`, or the end.
    ///
    /// # Errors
    /// The first argument that cannot be followed.
    pub fn parse(tokens: &[String]) -> Result<Self, RosArgsError> {
        let mut read = Self::default();
        let mut tokens = tokens.iter();
        while let Some(token) = tokens.next() {
            let mut value = || tokens.next().ok_or(RosArgsError::NoValue(token.clone()));
            let unsupported = |why| Err(RosArgsError::Unsupported(token.clone(), why));
            match token.as_str() {
                "-r" | "--remap" => read.rules.push(RemapRule::parse(value()?)?),
                "-p" | "--param" => read.parameters.push(ParameterRule::parse(value()?)?),
                "--params-file" => {
                    let file = ParameterRule::File(PathBuf::from(value()?));
                    read.parameters.push(file);
                }
                "--log-level" => read.log_level = Some(log_level(value()?)?),
                // There are none to disable; launch files pass these anyway.
                "--disable-external-lib-logs" | "--disable-rosout-logs" | "--ros-args" => {}
                "-e" | "--enclave" => return unsupported(NO_SECURITY),
                "--log-config-file" => return unsupported(NO_LOGGER),
                _ => return unsupported("nothing of that name is known behind --ros-args"),
            }
        }
        Ok(read)
    }

    /// The name that a rule gives to `what` of a node that is called `node`.
    pub(crate) fn renamed(&self, node: &str, fits: impl Fn(&Renamed) -> bool) -> Option<&str> {
        let of_node = |rule: &&RemapRule| rule.node.as_deref().is_none_or(|name| name == node);
        let rules = self.rules.iter().filter(of_node);
        let mut fitting = rules.filter(|rule| fits(&rule.what));
        fitting.next().map(|rule| rule.to.as_str())
    }
}

fn log_level(text: &str) -> Result<LogLevel, RosArgsError> {
    if text.contains(":=") {
        return Err(RosArgsError::Unsupported(text.to_owned(), NO_LOGGER));
    }
    LogLevel::from_name(text).ok_or_else(|| RosArgsError::Level(text.to_owned()))
}

impl ParameterRule {
    fn parse(text: &str) -> Result<Self, RosArgsError> {
        let malformed = || RosArgsError::Parameter(text.to_owned());
        let (name, yaml) = text.split_once(":=").ok_or_else(malformed)?;
        let (node, name) = match name.split_once(':') {
            Some((node, name)) => (Some(node.to_owned()), name),
            None => (None, name),
        };
        if name.is_empty() || name.contains(char::is_whitespace) {
            return Err(malformed());
        }
        Ok(Self::Value {
            node,
            name: name.to_owned(),
            yaml: yaml.to_owned(),
        })
    }
}

impl RemapRule {
    fn parse(text: &str) -> Result<Self, RosArgsError> {
        let malformed = || RosArgsError::Rule(text.to_owned());
        let (from, to) = text.split_once(":=").ok_or_else(malformed)?;
        let (node, from) = match from.split_once(':') {
            Some((node, from)) => (Some(node.to_owned()), from),
            None => (None, from),
        };
        let refused = |name: &str, expected| RosArgsError::Name {
            rule: text.to_owned(),
            name: name.to_owned(),
            expected,
        };
        let expect = |holds: bool, name: &str, expected| match holds {
            true => Ok(()),
            false => Err(refused(name, expected)),
        };
        if let Some(node) = &node {
            expect(is_token(node), node, "a node's name")?;
        }
        let what = match from {
            "__node" | "__name" => {
                expect(is_token(to), to, "a node's name")?;
                Renamed::Node
            }
            "__ns" => {
                expect(is_namespace(to), to, "a namespace, such as /vehicle/front")?;
                Renamed::Namespace
            }
            topic => {
                for name in [topic, to] {
                    let expected =
                        "a topic's name: tokens joined by slashes, led by / or ~/ if need be";
                    expect(is_topic(name), name, expected)?;
                }
                Renamed::Topic(topic.to_owned())
            }
        };
        Ok(Self {
            node,
            what,
            to: to.to_owned(),
        })
    }
}

/// Tokens joined by slashes, absolute, relative or private.
fn is_topic(name: &str) -> bool {
    let path = name.strip_prefix("~/").or_else(|| name.strip_prefix('/'));
    path.unwrap_or(name).split('/').all(is_token)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> Result<RosArgs, RosArgsError> {
        let tokens: Vec<String> = text.split_whitespace().map(str::to_owned).collect();
        RosArgs::parse(&tokens)
    }

    #[test]
    fn the_first_rule_that_fits_counts_and_rules_may_be_for_one_node() {
        let args = parsed("-r other:__node:=a --remap __node:=b -r __name:=c --log-level WARN");
        let args = args.expect("good");
        let node = |what: &Renamed| *what == Renamed::Node;
        assert_eq!(args.renamed("roadwatch", node), Some("b"));
        assert_eq!(args.renamed("other", node), Some("a"));
        assert_eq!(args.log_level, Some(LogLevel::Warn));
    }

    #[test]
    fn parameters_stay_in_order_and_may_be_for_one_node() {
        let args = parsed("-p a.b:=[x] --params-file p.yaml --param eyes:c:=1").expect("good");
        let value = |node: Option<&str>, name: &str, yaml: &str| ParameterRule::Value {
            node: node.map(str::to_owned),
            name: name.to_owned(),
            yaml: yaml.to_owned(),
        };
        assert_eq!(
            args.parameters,
            [
                value(None, "a.b", "[x]"),
                ParameterRule::File("p.yaml".into()),
                value(Some("eyes"), "c", "1"),
            ]
        );
    }

    #[test]
    fn what_cannot_be_followed_says_why() {
        for (text, expected) in [
            ("-r", "`-r` wants a value"),
            ("-r a=b", "expected FROM:=TO"),
            ("-r __node:=a/b", "`a/b` is not a node's name"),
            ("-r __ns:=front", "`front` is not a namespace"),
            ("-r a//b:=c", "`a//b` is not a topic's name"),
            ("--log-level loud", "expected debug, info"),
            ("--log-level rcl:=debug", "give a filter with --log"),
            ("-p use_sim_time", "expected NAME:=VALUE"),
            ("--params-file", "wants a value"),
            ("--enclave /a", "DDS security"),
            ("--what", "nothing of that name"),
        ] {
            let said = parsed(text).expect_err(text).to_string();
            assert!(said.contains(expected), "{text}: {said}");
        }
        assert_eq!(parsed("--disable-rosout-logs"), Ok(RosArgs::default()));
    }
}
