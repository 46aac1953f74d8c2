//! A world as a rig dataset, and what was published against it.

use crate::{playing::Played, view::View, world::World};
use nalgebra::{UnitQuaternion, Vector3};
use roadwatch_camera::RigDataset;
use roadwatch_core::{BoxPx, CameraId, Rig, RigCamera};
use roadwatch_lab::{
    Evaluation, LostImages, PublishedScene, Recording, Report, Truth, TruthFilter, TruthObject,
    evaluate,
};
use serde_json::{Value, json};
use std::{fs, path::Path};

/// Scores what was published against the truth: the world is written as a rig dataset, read back as any other
/// one, and evaluated as `roadwatch evaluate` does. Frames that cameras lost count as missing.
///
/// # Panics
/// When the temporary folder cannot be written.
#[must_use]
pub fn score(world: &World, played: &Played, filter: &TruthFilter) -> Report {
    let folder = tempfile::tempdir().expect("a temporary folder");
    write_dataset(world, folder.path());
    let dataset = RigDataset::open(folder.path()).expect("a dataset");
    let truth = Truth::read(folder.path()).expect("labels");
    let ground_z_m = world.scenario().rig.ground_z_m;
    let evaluation = Evaluation {
        rig: &Rig::new(dataset.cameras().to_vec(), ground_z_m).expect("the world's rig"),
        dataset: &dataset,
        truth: &truth,
        filter,
        lost_images: LostImages::Count,
        frame_limit: None,
    };
    let recording = Recording {
        frames: played.cameras.clone(),
        scenes: played.scenes.iter().map(PublishedScene::from).collect(),
    };
    evaluate(&evaluation, &recording, &[], Vec::new())
}

/// Writes `rig.toml`, `frames.jsonl`, `truth.jsonl` and a folder without images for each camera.
///
/// # Panics
/// When the file system refuses.
pub fn write_dataset(world: &World, folder: &Path) {
    let rig = &world.scenario().rig;
    let write = |name: &str, text: String| fs::write(folder.join(name), text).expect("written");
    write("rig.toml", rig.cameras().iter().map(rig_entry).collect());
    let frames = 0..world.scenario().frames;
    write(
        "frames.jsonl",
        frames.map(|frame| frame_line(world, frame)).collect(),
    );
    let truth = world
        .all_views()
        .map(|(camera, view)| truth_line(world, camera, view));
    write("truth.jsonl", truth.collect());
    for camera in rig.cameras() {
        fs::create_dir_all(folder.join(camera.name.as_str())).expect("a folder");
    }
}

fn rig_entry(camera: &RigCamera) -> String {
    let (size, k) = (camera.model.size, camera.model.intrinsics);
    let mount = camera.base_from_optical.isometry;
    let [x, y, z] = mount.translation.vector.into();
    format!(
        "[[camera]]\nname = \"{}\"\nwidth = {}\nheight = {}\nfx = {:?}\nfy = {:?}\ncx = {:?}\ncy = {:?}\n\
         position_m = [{x:?}, {y:?}, {z:?}]\norientation_wxyz = {:?}\n\n",
        camera.name,
        size.width_px,
        size.height_px,
        k.fx,
        k.fy,
        k.cx,
        k.cy,
        wxyz(&mount.rotation),
    )
}

/// Stamps go out as text: a JSON library would make floats of them.
fn frame_line(world: &World, frame: u64) -> String {
    let rig = &world.scenario().rig;
    let stamps = rig.ids().map(|camera| {
        let view = &world.views(camera)[frame as usize];
        format!("\"{}\": {}", rig.camera(camera).name, view.captured_at)
    });
    let moment = world.scenario().moment(0, frame);
    let ego = world.scenario().ego.at(moment);
    let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), ego.rotation.angle());
    format!(
        "{{\"frame\": {frame}, \"stamp\": {{{}}}, \"ego_stamp\": {}, \"ego_position_world_m\": [{:?}, {:?}, 0.0], \
         \"ego_orientation_world_wxyz\": {:?}}}\n",
        stamps.collect::<Vec<_>>().join(", "),
        world.scenario().stamp(moment),
        ego.translation.x,
        ego.translation.y,
        wxyz(&yaw),
    )
}

fn truth_line(world: &World, camera: CameraId, view: &View) -> String {
    let objects = view.objects.iter().map(|seen| object(&seen.truth));
    let line = json!({
        "frame": view.frame,
        "camera": world.scenario().rig.camera(camera).name.as_str(),
        "objects": objects.collect::<Vec<_>>(),
    });
    format!("{line}\n")
}

fn object(truth: &TruthObject) -> Value {
    let corners = |box_px: BoxPx| [box_px.x_min, box_px.y_min, box_px.x_max, box_px.y_max];
    let center = truth.center;
    json!({
        "id": truth.id,
        "class": truth.class,
        "box_px": truth.box_px.map(corners),
        "silhouette_px": truth.silhouette_px.map(corners),
        "truncated": truth.truncated,
        "occluded": truth.occluded,
        "center_base_m": [center.x(), center.y(), center.z()],
        "size_lwh_m": truth.size.map(|size| [size.length_m, size.width_m, size.height_m]),
        "yaw_base_rad": truth.yaw_rad,
    })
}

fn wxyz(rotation: &UnitQuaternion<f64>) -> [f64; 4] {
    let q = rotation.quaternion();
    [q.w, q.i, q.j, q.k]
}
