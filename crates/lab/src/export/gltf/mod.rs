//! The scenes of a recording as one animated glTF file, for any viewer.
//!
//! A node for each identity, at the centre of its box, in the colour of the identity; below it its body, the edges of its
//! box and, where the heading is known, an arrow. The vehicle is a node `base_link` with the rig's cameras below it.
//! Axes: glTF has y up, so the scene's root turns ours (x forward, y left, z up) over.

mod document;
mod shapes;

use document::{Document, Mode, Moves};
use nalgebra::{Isometry3, Point3, UnitQuaternion, Vector3};
use roadwatch_core::{ObjectClass, SizeLwh};
use roadwatch_ros::{
    msg::{
        builtin_interfaces::Time,
        roadwatch_msgs::{Object, ObjectArray},
    },
    scene_lines::{LineCamera, LineRig},
};
use serde_json::{Value, json};
use std::{
    collections::BTreeMap,
    f64::consts::{FRAC_PI_2, PI},
    io::{self, Write},
};

/// The vehicle is drawn as a block of this size over base_link, metres: what it really looks like, nobody says.
const EGO: SizeLwh = SizeLwh {
    length_m: 4.5,
    width_m: 1.8,
    height_m: 1.5,
};
const GREY: [f32; 3] = [0.25, 0.25, 0.28];
const GRID: [f32; 3] = [0.08, 0.08, 0.08];
/// Ground around the vehicle's way, metres.
const AROUND_M: f32 = 80.0;

/// Scenes on their way to a file.
#[derive(Debug)]
pub struct GltfScenes {
    rig: LineRig,
    range_m: f64,
    /// The first stamp, and the vehicle's first known place: glTF counts in single precision.
    begin: Option<Time>,
    origin: Option<Vector3<f64>>,
    /// Seconds since the first scene.
    times: Vec<f32>,
    ego: Keys,
    tracks: BTreeMap<u64, Track>,
}

/// Where something was at some of the times.
#[derive(Debug, Default)]
struct Keys {
    at: Vec<usize>,
    places: Vec<f32>,
    turns: Vec<f32>,
    last_turn: Option<UnitQuaternion<f64>>,
}

#[derive(Debug)]
struct Track {
    class: ObjectClass,
    size: SizeLwh,
    keys: Keys,
    /// At which of its keys the heading is known.
    pointed: Vec<bool>,
    nearest_m: f64,
}

impl GltfScenes {
    /// Nothing yet. What never comes within `range_m` of the vehicle is left out.
    #[must_use]
    pub fn new(rig: LineRig, range_m: f64) -> Self {
        Self {
            rig,
            range_m,
            begin: None,
            origin: None,
            times: Vec::new(),
            ego: Keys::default(),
            tracks: BTreeMap::new(),
        }
    }

    /// Takes the next scene; one that is not later than the last is left out.
    pub fn add(&mut self, scene: &ObjectArray) {
        let stamp = scene.header.stamp;
        let begin = *self.begin.get_or_insert(stamp);
        let time = (f64::from(stamp.sec) - f64::from(begin.sec)
            + (f64::from(stamp.nanosec) - f64::from(begin.nanosec)) / 1e9)
            as f32;
        if self.times.last().is_some_and(|&last| time <= last) {
            return;
        }
        let at = self.times.len();
        self.times.push(time);
        let told = scene.odom_from_base();
        let ego = told.unwrap_or_default();
        if told.is_some() {
            self.origin.get_or_insert(ego.translation.vector);
        }
        let origin = self.origin.unwrap_or_default();
        let from_base = match scene.header.frame_id == self.rig.base_frame {
            true => ego,
            false => Isometry3::identity(),
        };
        let place = |from: &Isometry3<f64>, point: Point3<f64>| (from * point).coords - origin;
        self.ego
            .push(at, place(&ego, Point3::origin()), ego.rotation);
        for object in &scene.objects {
            let center = Point3::new(object.position.x, object.position.y, object.position.z);
            let center = place(&from_base, center);
            let away_m = (center - place(&ego, Point3::origin())).xy().norm();
            let track = self
                .tracks
                .entry(object.track_id)
                .or_insert_with(|| Track::new(object));
            track.add(object, at, (center, from_base.rotation), away_m);
        }
    }

    /// Writes a .glb file; gives the number of tracks in it.
    ///
    /// # Errors
    /// When it cannot be written, or would be longer than a .glb can be.
    pub fn write(self, to: &mut impl Write) -> io::Result<usize> {
        let mut document = Document::default();
        let mut nodes = vec![self.grid(&mut document), self.vehicle(&mut document)];
        let near = self
            .tracks
            .iter()
            .filter(|(_, track)| track.nearest_m <= self.range_m);
        for (&id, track) in near {
            nodes.push(track.node(id, &self.times, &mut document));
        }
        let count = nodes.len() - 2;
        let y_up = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), -FRAC_PI_2);
        let root = json!({"name": "odom", "rotation": quaternion(&y_up), "children": nodes});
        let root = document.node(root);
        document.write(root, to)?;
        Ok(count)
    }

    fn grid(&self, document: &mut Document) -> usize {
        let along = |axis: usize, pick: fn(f32, f32) -> f32| {
            let all = self.ego.places.chunks(3).map(|place| place[axis]);
            all.reduce(pick).unwrap_or_default()
        };
        let least = [0, 1].map(|axis| along(axis, f32::min) - AROUND_M);
        let most = [0, 1].map(|axis| along(axis, f32::max) + AROUND_M);
        let ground = self.ego.places.get(2).copied().unwrap_or_default();
        let (points, indices) = shapes::grid((least, most), ground);
        let material = document.material("grid", GRID);
        let mesh = document.mesh("grid", (&points, &indices, Mode::Lines), material);
        document.node(json!({"name": "ground", "mesh": mesh}))
    }

    /// The vehicle and its cameras.
    fn vehicle(&self, document: &mut Document) -> usize {
        let (points, indices) = shapes::body(&ObjectClass::new("car"), EGO);
        let material = document.material("vehicle", GREY);
        let mesh = document.mesh("vehicle", (&points, &indices, Mode::Triangles), material);
        let up = [0.0, 0.0, EGO.height_m / 2.0];
        let mut below =
            vec![document.node(json!({"name": "vehicle", "mesh": mesh, "translation": up}))];
        below.extend(
            self.rig
                .cameras
                .iter()
                .map(|camera| camera_node(camera, document)),
        );
        let node = document.node(json!({"name": self.rig.base_frame, "children": below}));
        self.ego.animate(node, &self.times, document);
        node
    }
}

impl Track {
    fn new(object: &Object) -> Self {
        Self {
            class: ObjectClass::new(&object.class_id),
            size: SizeLwh {
                length_m: 0.0,
                width_m: 0.0,
                height_m: 0.0,
            },
            keys: Keys::default(),
            pointed: Vec::new(),
            nearest_m: f64::INFINITY,
        }
    }

    fn add(
        &mut self,
        object: &Object,
        at: usize,
        place: (Vector3<f64>, UnitQuaternion<f64>),
        away_m: f64,
    ) {
        // Without tracking two of one scene may have one number: the first has it.
        if self.keys.at.last() == Some(&at) {
            return;
        }
        // Class and size settle: the last is the best.
        self.class = ObjectClass::new(&object.class_id);
        self.size = SizeLwh {
            length_m: object.size.x,
            width_m: object.size.y,
            height_m: object.size.z,
        };
        let (center, rotation) = place;
        let yaw = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), object.yaw_rad);
        let turn = match object.heading_known {
            true => rotation * yaw,
            // As it stood before; at first square to the axes.
            false => self.keys.last_turn.unwrap_or(rotation),
        };
        self.keys.push(at, center, turn);
        self.pointed.push(object.heading_known);
        self.nearest_m = self.nearest_m.min(away_m);
    }

    fn node(&self, id: u64, times: &[f32], document: &mut Document) -> usize {
        let material = document.material(&format!("track {id}"), colour(id));
        let name = format!("{} {id}", self.class.as_str());
        let mut child = |what: &str, mesh: &shapes::Mesh, mode: Mode| {
            let mesh = document.mesh(
                &format!("{name} {what}"),
                (&mesh.0, &mesh.1, mode),
                material,
            );
            document.node(json!({"name": format!("{name} {what}"), "mesh": mesh}))
        };
        let below = [
            child(
                "body",
                &shapes::body(&self.class, self.size),
                Mode::Triangles,
            ),
            child("box", &shapes::edges(self.size), Mode::Lines),
            child("heading", &shapes::arrow(self.size), Mode::Triangles),
        ];
        let node = document.node(json!({"name": name, "children": below}));
        self.keys.animate(node, times, document);
        let there: Vec<usize> = self.keys.at.clone();
        show(node, &there, times, document);
        let pointed = there.iter().zip(&self.pointed).filter(|(_, known)| **known);
        let pointed: Vec<usize> = pointed.map(|(&at, _)| at).collect();
        if pointed.len() < there.len() {
            show(below[2], &pointed, times, document);
        }
        node
    }
}

impl Keys {
    fn push(&mut self, at: usize, place: Vector3<f64>, turn: UnitQuaternion<f64>) {
        // The nearer of a rotation's two quaternions: viewers go from one to the next the short way.
        let near = match self.last_turn {
            Some(last) if last.coords.dot(&turn.coords) < 0.0 => {
                UnitQuaternion::new_unchecked(-turn.into_inner())
            }
            _ => turn,
        };
        self.at.push(at);
        self.places
            .extend(place.iter().map(|number| *number as f32));
        self.turns.extend(quaternion(&near));
        self.last_turn = Some(near);
    }

    fn animate(&self, node: usize, times: &[f32], document: &mut Document) {
        if self.at.is_empty() {
            return;
        }
        let own: Vec<f32> = self.at.iter().map(|&at| times[at]).collect();
        let own = document.times(&own);
        document.animate(node, Moves::Translation, own, &self.places);
        document.animate(node, Moves::Rotation, own, &self.turns);
    }
}

/// Shows a node at some of the times and hides it at the others.
fn show(node: usize, there: &[usize], times: &[f32], document: &mut Document) {
    let mut keys: Vec<(f32, f32)> = Vec::new();
    let mut expected = there.iter().copied().peekable();
    for (at, &time) in times.iter().enumerate() {
        let shown = f32::from(u8::from(expected.next_if_eq(&at).is_some()));
        if keys.last().is_none_or(|&(_, before)| before != shown) {
            keys.push((time, shown));
        }
    }
    let own: Vec<f32> = keys.iter().map(|&(time, _)| time).collect();
    let own = document.times(&own);
    let scales: Vec<f32> = keys.iter().flat_map(|&(_, shown)| [shown; 3]).collect();
    document.animate(node, Moves::Scale, own, &scales);
}

fn camera_node(camera: &LineCamera, document: &mut Document) -> usize {
    let info = &camera.camera_info;
    let (width, height) = (f64::from(info.width), f64::from(info.height));
    let yfov_rad = 2.0 * (height / 2.0 / info.k[4]).atan();
    let number = document.camera(&camera.name, yfov_rad, width / height);
    let base_from_optical = Isometry3::from(&camera.base_from_optical);
    // Optical frames look along z with y down, glTF's cameras along -z with y up.
    let over = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI);
    let place: Vec<f64> = base_from_optical
        .translation
        .vector
        .iter()
        .copied()
        .collect();
    let node: Value = json!({
        "name": camera.name, "camera": number,
        "translation": place, "rotation": quaternion(&(base_from_optical.rotation * over)),
    });
    document.node(node)
}

fn quaternion(rotation: &UnitQuaternion<f64>) -> [f32; 4] {
    let [x, y, z, w] = rotation.coords.data.0[0];
    [x, y, z, w].map(|number| number as f32)
}

/// The colour of an identity, linear RGB: another hue for each, all as strong.
fn colour(id: u64) -> [f32; 3] {
    let hue = (id as f64 * crate::plots::HUE_STEP).fract() * 6.0;
    let channel = |offset: f64| {
        let distance = ((hue + offset).rem_euclid(6.0) - 3.0).abs() - 1.0;
        (0.05 + 0.75 * distance.clamp(0.0, 1.0)) as f32
    };
    [channel(0.0), channel(4.0), channel(2.0)]
}

#[cfg(test)]
mod tests;
