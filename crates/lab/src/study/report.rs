//! `study.json`, `study.md` and the plots.

use super::{FocalStudy, PathFigures, Shape, Study, StudyScene, path_figures};
use crate::plots::{self, PlotError};
use serde_json::{Map, Value, json};
use std::{
    fs, io,
    path::{Path, PathBuf},
};

/// A report that could not be written.
#[derive(Debug, thiserror::Error)]
pub enum StudyReportError {
    /// The folder or a file.
    #[error("cannot write `{}`", file.display())]
    Unwritable {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// A plot.
    #[error(transparent)]
    Plot(#[from] PlotError),
}

impl Study {
    /// Writes `study.json`, `study.md` and the plots into a folder, which is made if need be. Gives the names of the
    /// files.
    ///
    /// # Errors
    /// When the folder or a file cannot be written.
    pub fn write(&self, folder: &Path) -> Result<Vec<&'static str>, StudyReportError> {
        const JSON: &str = "study.json";
        const MARKDOWN: &str = "study.md";
        let write = |name: &str, text: String| {
            let file = folder.join(name);
            fs::write(&file, text).map_err(|cause| StudyReportError::Unwritable { file, cause })
        };
        fs::create_dir_all(folder).map_err(|cause| StudyReportError::Unwritable {
            file: folder.to_owned(),
            cause,
        })?;
        write(JSON, format!("{:#}\n", self.to_json()))?;
        let drawn = plots::draw_study(self, folder)?;
        let links = drawn
            .iter()
            .map(|plot| format!("\n![{}]({})\n", plot.title, plot.file));
        write(
            MARKDOWN,
            format!("{}{}", self.to_markdown(), links.collect::<String>()),
        )?;
        let plots = drawn.into_iter().map(|plot| plot.file);
        Ok([JSON, MARKDOWN].into_iter().chain(plots).collect())
    }

    /// Figures of each path, of all drives along it together, and of all paths.
    pub(super) fn path_groups(&self) -> Vec<(&'static str, Vec<(&'static str, PathFigures)>)> {
        let of = |shape| path_figures(self.paths.iter().filter(move |path| path.shape == shape));
        let groups = [
            (Shape::XPath.as_str(), of(Shape::XPath)),
            (Shape::YPath.as_str(), of(Shape::YPath)),
            ("all", path_figures(self.paths.iter())),
        ];
        let groups = groups.into_iter();
        groups.filter(|(_, figures)| !figures.is_empty()).collect()
    }

    /// Everything as JSON; what was not studied is null.
    #[must_use]
    pub fn to_json(&self) -> Value {
        json!({
            "boxes": self.boxes,
            "scenes": self.scenes.iter().map(scene_json).collect::<Vec<_>>(),
            "measured_focal": self.measured.map(|measured| json!({
                "focal_px": measured.focal.focal_px,
                "image_height_px": measured.focal.image_height_px,
                "height_px": measured.height_px,
                "depth_m": measured.depth_m,
                "size_m": measured.size_m,
            })),
            "paths": object(self.path_groups().into_iter().map(|(name, figures)| {
                let figures = figures.into_iter();
                (name, object(figures.map(|(method, figures)| (method, json!(figures)))))
            })),
            "drives": self.paths.iter().map(|drive| {
                let figures = path_figures(std::iter::once(drive)).into_iter();
                let figures = figures.map(|(method, figures)| (method, json!(figures)));
                json!({"shape": drive.shape, "vehicle": drive.vehicle, "methods": object(figures)})
            }).collect::<Vec<_>>(),
            "focal": self.focal.as_ref().map(focal_json),
            "table_weight": self.weights.as_ref().map(|weights| json!({
                "fitted": weights.fitted,
                "literal": weights.literal,
            })),
            "vehicles": self.vehicles.as_ref().map(|vehicles| json!(vehicles.groups)),
        })
    }
}

fn scene_json(scene: &StudyScene) -> Value {
    json!({
        "folder": scene.folder,
        "shape": scene.shape,
        "positions": scene.positions,
        "seen": scene.seen.len(),
    })
}

fn focal_json(focal: &FocalStudy) -> Value {
    let published = focal.published.iter().map(|published| {
        json!({
            "size_m": published.size_m,
            "focal_px": published.focal.focal_px,
            "accuracy": published.point.accuracy,
            "coverage_90": published.point.coverage_90,
        })
    });
    json!({
        "right_focal_px": focal.right.focal_px,
        "published": published.collect::<Vec<_>>(),
        "over_focal_px": focal.over_focal,
        "height_error_m_in_eq_2": focal.in_distance,
        "height_error_m_in_eq_1": focal.in_focal,
    })
}

fn object(entries: impl Iterator<Item = (&'static str, Value)>) -> Value {
    let entries = entries.map(|(key, value)| (key.to_owned(), value));
    Value::Object(entries.collect::<Map<_, _>>())
}
