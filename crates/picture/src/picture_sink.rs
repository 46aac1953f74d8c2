//! A sink that keeps the fullest round of a run and draws it at the end.

use crate::{
    camera_view::camera_view,
    canvas::{Canvas, DrawError},
    contact_sheet::contact_sheet,
    scene_view::scene_view,
};
use roadwatch_core::{Output, Perceived, Rig, Scene, Sink, SinkError};
use std::{
    fs,
    path::{Path, PathBuf},
    sync::Arc,
};

/// The picture of all camera views.
pub const VIEWS_FILE: &str = "views.png";
/// The picture of the scene from above.
pub const SCENE_FILE: &str = "scene.png";

/// Draws the round in which the most objects were seen, the first of such rounds, into a folder.
pub struct PictureSink {
    folder: PathBuf,
    rig: Arc<Rig>,
    newest: Vec<Option<Arc<Perceived>>>,
    fullest: Option<Round>,
}

struct Round {
    scene: Arc<Scene>,
    views: Vec<Option<Arc<Perceived>>>,
}

impl PictureSink {
    /// A sink that writes [`VIEWS_FILE`] and [`SCENE_FILE`] into `folder`, which is made if need be.
    ///
    /// # Errors
    /// When the folder cannot be made.
    pub fn create(folder: &Path, rig: Arc<Rig>) -> std::io::Result<Self> {
        fs::create_dir_all(folder)?;
        Ok(Self {
            folder: folder.to_owned(),
            newest: vec![None; rig.cameras().len()],
            rig,
            fullest: None,
        })
    }

    fn draw(&self, round: &Round) -> Result<(), DrawError> {
        let cameras = self.rig.cameras().iter().zip(&round.views);
        let views = cameras.map(|(camera, perceived)| {
            let view = perceived
                .as_ref()
                .map(|perceived| camera_view(camera, perceived));
            view.transpose()
        });
        let views = views.collect::<Result<Vec<Option<Canvas>>, _>>()?;
        contact_sheet(&self.rig, &views)?.write(&self.folder.join(VIEWS_FILE))?;
        scene_view(&self.rig, &round.scene)?.write(&self.folder.join(SCENE_FILE))
    }
}

impl Sink for PictureSink {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        match output {
            Output::Camera(perceived) => {
                let camera = perceived.tracks.frame.camera.index();
                self.newest[camera] = Some(Arc::clone(perceived));
            }
            Output::Scene(scene) => {
                let most = self.fullest.as_ref().map(|round| round.scene.objects.len());
                if most.is_none_or(|most| scene.objects.len() > most) {
                    self.fullest = Some(Round {
                        scene: Arc::clone(scene),
                        views: self.newest.clone(),
                    });
                }
            }
        }
        Ok(())
    }

    fn finish(&mut self) -> Result<(), SinkError> {
        let Some(round) = &self.fullest else {
            tracing::warn!("no picture: no round of the cameras was completed");
            return Ok(());
        };
        self.draw(round)
            .map_err(|error| SinkError::new("the pictures of the run", error))
    }
}
