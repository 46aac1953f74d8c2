//! A glTF 2.0 document in the making, and its binary form (GLB): nodes and meshes as JSON, numbers in one buffer.

use serde_json::{Value, json};
use std::io::{self, Write};

const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";
/// Chunks begin at multiples of this, and so do our numbers.
const ALIGNMENT: usize = 4;
/// Of components in `accessors`: single-precision numbers, and whole ones of 16 bits.
/// What a view is for, where it is for vertices or indices.
const ARRAY_BUFFER: u32 = 34962;
const ELEMENT_ARRAY_BUFFER: u32 = 34963;
const FLOAT: u32 = 5126;
const UNSIGNED_SHORT: u32 = 5123;

/// How a mesh's indices are read.
#[derive(Debug, Clone, Copy)]
pub(super) enum Mode {
    Lines = 1,
    Triangles = 4,
}

/// What of a node moves.
#[derive(Debug, Clone, Copy)]
pub(super) enum Moves {
    Translation,
    Rotation,
    /// Changes at once, not evenly.
    Scale,
}

#[derive(Debug, Default)]
pub(super) struct Document {
    binary: Vec<u8>,
    views: Vec<Value>,
    accessors: Vec<Value>,
    materials: Vec<Value>,
    meshes: Vec<Value>,
    cameras: Vec<Value>,
    nodes: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
}

impl Document {
    /// A surface of one colour, linear RGB, that is seen from both sides.
    pub(super) fn material(&mut self, name: &str, [r, g, b]: [f32; 3]) -> usize {
        push(
            &mut self.materials,
            json!({
                "name": name,
                "doubleSided": true,
                "pbrMetallicRoughness": {
                    "baseColorFactor": [r, g, b, 1.0], "metallicFactor": 0.0, "roughnessFactor": 0.8,
                },
            }),
        )
    }

    /// A mesh of points, metres, joined by indices. Without normals: every viewer shades it flat.
    pub(super) fn mesh(
        &mut self,
        name: &str,
        (points, indices, mode): (&[[f32; 3]], &[u16], Mode),
        material: usize,
    ) -> usize {
        let numbers: Vec<f32> = points.iter().flatten().copied().collect();
        let bound = |pick: fn(f32, f32) -> f32, from: f32| -> [f32; 3] {
            std::array::from_fn(|axis| points.iter().map(|point| point[axis]).fold(from, pick))
        };
        let (least, most) = (
            bound(f32::min, f32::INFINITY),
            bound(f32::max, f32::NEG_INFINITY),
        );
        let positions = self.floats(&numbers, "VEC3", 3);
        self.accessors[positions]["min"] = json!(least);
        self.accessors[positions]["max"] = json!(most);
        self.last_view_is(ARRAY_BUFFER);
        let bytes: Vec<u8> = indices
            .iter()
            .flat_map(|index| index.to_le_bytes())
            .collect();
        let view = self.view(&bytes);
        self.last_view_is(ELEMENT_ARRAY_BUFFER);
        let indices = push(
            &mut self.accessors,
            json!({"bufferView": view, "componentType": UNSIGNED_SHORT, "count": indices.len(), "type": "SCALAR"}),
        );
        push(
            &mut self.meshes,
            json!({"name": name, "primitives": [{
                "attributes": {"POSITION": positions},
                "indices": indices, "material": material, "mode": mode as u32,
            }]}),
        )
    }

    /// A camera that looks along its node's -z.
    pub(super) fn camera(&mut self, name: &str, yfov_rad: f64, aspect_ratio: f64) -> usize {
        push(
            &mut self.cameras,
            json!({"name": name, "type": "perspective", "perspective": {
                "yfov": yfov_rad, "aspectRatio": aspect_ratio, "znear": 0.1, "zfar": 1000.0,
            }}),
        )
    }

    /// A node; its children must be there already.
    pub(super) fn node(&mut self, node: Value) -> usize {
        push(&mut self.nodes, node)
    }

    /// Moves a node: for each time in seconds, rising, three or four numbers.
    pub(super) fn animate(&mut self, node: usize, moves: Moves, times: usize, values: &[f32]) {
        let (path, shape, width, interpolation) = match moves {
            Moves::Translation => ("translation", "VEC3", 3, "LINEAR"),
            Moves::Rotation => ("rotation", "VEC4", 4, "LINEAR"),
            Moves::Scale => ("scale", "VEC3", 3, "STEP"),
        };
        let output = self.floats(values, shape, width);
        let sampler = push(
            &mut self.samplers,
            json!({"input": times, "output": output, "interpolation": interpolation}),
        );
        self.channels
            .push(json!({"sampler": sampler, "target": {"node": node, "path": path}}));
    }

    /// Times of keyframes, seconds, rising.
    pub(super) fn times(&mut self, times: &[f32]) -> usize {
        let accessor = self.floats(times, "SCALAR", 1);
        self.accessors[accessor]["min"] = json!([times.first()]);
        self.accessors[accessor]["max"] = json!([times.last()]);
        accessor
    }

    /// Writes the document with `root` as the one node of its scene.
    pub(super) fn write(mut self, root: usize, to: &mut impl Write) -> io::Result<()> {
        let mut json = json!({
            "asset": {"version": "2.0", "generator": concat!("Roadwatch ", env!("CARGO_PKG_VERSION"))},
            "scene": 0,
            "scenes": [{"nodes": [root]}],
            "buffers": [{"byteLength": self.binary.len()}],
        });
        let lists = [
            ("bufferViews", self.views),
            ("accessors", self.accessors),
            ("materials", self.materials),
            ("meshes", self.meshes),
            ("cameras", self.cameras),
            ("nodes", self.nodes),
        ];
        for (name, list) in lists {
            // An empty list is no glTF.
            if !list.is_empty() {
                json[name] = Value::Array(list);
            }
        }
        if !self.channels.is_empty() {
            json["animations"] =
                json!([{"name": "scene", "channels": self.channels, "samplers": self.samplers}]);
        }
        let mut text = json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(ALIGNMENT), b' ');
        self.binary
            .resize(self.binary.len().next_multiple_of(ALIGNMENT), 0);
        let chunks = [(JSON_CHUNK, &text), (BINARY_CHUNK, &self.binary)];
        let total: usize = 12
            + chunks
                .iter()
                .map(|(_, bytes)| 8 + bytes.len())
                .sum::<usize>();
        to.write_all(MAGIC)?;
        to.write_all(&VERSION.to_le_bytes())?;
        to.write_all(&length(total)?)?;
        for (kind, bytes) in chunks {
            to.write_all(&length(bytes.len())?)?;
            to.write_all(kind)?;
            to.write_all(bytes)?;
        }
        Ok(())
    }

    fn floats(&mut self, numbers: &[f32], shape: &str, width: usize) -> usize {
        debug_assert_eq!(numbers.len() % width, 0);
        let bytes: Vec<u8> = numbers
            .iter()
            .flat_map(|number| number.to_le_bytes())
            .collect();
        let view = self.view(&bytes);
        push(
            &mut self.accessors,
            json!({
                "bufferView": view, "componentType": FLOAT, "count": numbers.len() / width, "type": shape,
            }),
        )
    }

    fn last_view_is(&mut self, target: u32) {
        if let Some(view) = self.views.last_mut() {
            view["target"] = json!(target);
        }
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let start = self.binary.len();
        self.binary.extend_from_slice(bytes);
        self.binary
            .resize(self.binary.len().next_multiple_of(ALIGNMENT), 0);
        push(
            &mut self.views,
            json!({"buffer": 0, "byteOffset": start, "byteLength": bytes.len()}),
        )
    }
}

fn push(list: &mut Vec<Value>, value: Value) -> usize {
    list.push(value);
    list.len() - 1
}

/// GLB counts in 32 bits.
fn length(bytes: usize) -> io::Result<[u8; 4]> {
    let length = u32::try_from(bytes).map_err(|_| {
        io::Error::other(
            "longer than the 4 GiB that a .glb file can have: export a shorter recording",
        )
    })?;
    Ok(length.to_le_bytes())
}
