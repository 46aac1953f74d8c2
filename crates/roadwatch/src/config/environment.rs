//! The environment: read here and nowhere else.

use std::{collections::BTreeMap, path::PathBuf};

/// The variables the process was started with, and where.
#[derive(Debug, Clone, Default)]
pub struct Environment {
    variables: BTreeMap<String, String>,
    working_folder: PathBuf,
    program: Option<PathBuf>,
}

impl Environment {
    /// The process's own. Variables that are not text are left out.
    #[must_use]
    pub fn of_process() -> Self {
        let text = |(name, value): (std::ffi::OsString, std::ffi::OsString)| {
            Some((name.into_string().ok()?, value.into_string().ok()?))
        };
        Self {
            variables: std::env::vars_os().filter_map(text).collect(),
            working_folder: std::env::current_dir().unwrap_or_default(),
            program: std::env::current_exe().ok(),
        }
    }

    /// An environment for tests.
    #[must_use]
    pub fn new(variables: &[(&str, &str)], working_folder: PathBuf) -> Self {
        let owned = |(name, value): &(&str, &str)| ((*name).to_owned(), (*value).to_owned());
        Self {
            variables: variables.iter().map(owned).collect(),
            working_folder,
            program: None,
        }
    }

    /// A variable's value; `None` when unset or empty.
    #[must_use]
    pub fn get(&self, name: &str) -> Option<&str> {
        self.variables
            .get(name)
            .map(String::as_str)
            .filter(|value| !value.is_empty())
    }

    /// The checkout that the running program was built in; `None` when it was installed elsewhere.
    #[must_use]
    pub fn checkout(&self) -> Option<PathBuf> {
        let mut above = self.program.as_ref()?.ancestors();
        let folder = above.find(|folder| folder.join("Cargo.lock").is_file())?;
        Some(folder.to_owned())
    }

    /// A path as written in a configuration, with one `${NAME}` or `${NAME:-default}` at its front replaced.
    ///
    /// What a variable gives is relative to the working folder, as everywhere in a shell; what the file
    /// itself says is relative to the file's own folder.
    ///
    /// # Errors
    /// When the variable is unset and has no default, or the braces are not closed.
    pub fn expand_path(
        &self,
        text: &str,
        file_folder: &std::path::Path,
    ) -> Result<PathBuf, String> {
        let Some(rest) = text.strip_prefix("${") else {
            return Ok(file_folder.join(text));
        };
        let (inside, rest) = rest
            .split_once('}')
            .ok_or_else(|| format!("`{text}` has no closing brace"))?;
        let (name, default) = match inside.split_once(":-") {
            Some((name, default)) => (name, Some(default)),
            None => (inside, None),
        };
        match (self.get(name), default) {
            (Some(value), _) => Ok(self.working_folder.join(format!("{value}{rest}"))),
            (None, Some(default)) => Ok(file_folder.join(format!("{default}{rest}"))),
            (None, None) => Err(format!("the environment variable {name} is not set")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    #[test]
    fn a_variable_counts_from_the_working_folder_and_a_default_from_the_file() {
        let set = Environment::new(&[("DATA", "../d")], PathBuf::from("/home/me"));
        let unset = Environment::new(&[], PathBuf::from("/home/me"));
        let folder = Path::new("/etc/rw");
        let text = "${DATA:-../x}/a.onnx";
        assert_eq!(
            set.expand_path(text, folder),
            Ok(PathBuf::from("/home/me/../d/a.onnx"))
        );
        assert_eq!(
            unset.expand_path(text, folder),
            Ok(PathBuf::from("/etc/rw/../x/a.onnx"))
        );
        assert_eq!(
            unset.expand_path("b.toml", folder),
            Ok(PathBuf::from("/etc/rw/b.toml"))
        );
        assert!(unset.expand_path("${DATA}/a", folder).is_err());
        assert!(unset.expand_path("${DATA", folder).is_err());
    }
}
