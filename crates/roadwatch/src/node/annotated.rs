//! Annotated images for viewers, drawn while somebody looks.

use roadwatch_core::{Output, Perceived, Rig, Sink, SinkError};
use roadwatch_picture::camera_view;
use roadwatch_ros::{
    Outlet, RosError, RosNode,
    msg::{sensor_msgs::CompressedImage, std_msgs::Header},
    node::reliable,
    surface::annotated_topic,
};
use std::sync::Arc;

/// A viewer's window shows no more, pixels.
const WIDEST_PX: u32 = 640;
/// Messages of 60 kB reach every reader at its default settings; many of 200 kB are lost to those of Fast DDS, whose
/// receive buffer is the kernel's default.
const MOST_BYTES: usize = 56_000;
/// The newest image is the one to look at.
const DEPTH: usize = 1;

/// Publishes each camera's image with what was found in it.
#[derive(Debug)]
pub struct AnnotatedImages {
    rig: Arc<Rig>,
    /// One per camera.
    outlets: Vec<Outlet<CompressedImage>>,
}

impl AnnotatedImages {
    /// # Errors
    /// When the middleware refuses.
    pub(super) fn announce(node: &RosNode, rig: Arc<Rig>) -> Result<Self, RosError> {
        let outlets = rig.cameras().iter().map(|camera| {
            let topic = annotated_topic(node.surface(), camera.name.as_str());
            node.outlet(&topic, "sensor_msgs/CompressedImage", &reliable(DEPTH))
        });
        Ok(Self {
            outlets: outlets.collect::<Result<_, _>>()?,
            rig,
        })
    }

    fn draw(&self, perceived: &Perceived) -> Result<CompressedImage, roadwatch_picture::DrawError> {
        let frame = &perceived.tracks.frame;
        let camera = self.rig.camera(frame.camera);
        let canvas = camera_view(camera, perceived)?;
        Ok(CompressedImage {
            header: Header::new(frame.captured_at, camera.name.optical_frame()),
            format: "jpeg".to_owned(),
            data: canvas.jpeg_within(WIDEST_PX, MOST_BYTES)?,
        })
    }
}

impl Sink for AnnotatedImages {
    fn publish(&mut self, output: &Output) -> Result<(), SinkError> {
        let Output::Camera(perceived) = output else {
            return Ok(());
        };
        let outlet = &self.outlets[perceived.tracks.frame.camera.index()];
        if !outlet.has_readers() {
            return Ok(());
        }
        let drawn = self.draw(perceived);
        let image = drawn.map_err(|error| SinkError::new("no annotated image", error))?;
        outlet
            .publish(image)
            .map_err(|error| SinkError::new("annotated image not published", error))
    }
}
