//! A forest's file: little-endian, `RWFOREST`, version, a JSON header, roots, nodes, SHA-256 of all before it.

use super::{Forest, LEAF, Node};
use crate::recipe::Recipe;
use serde::{Deserialize, Serialize};
use sha2::{Digest as _, Sha256};
use std::{
    fs, io,
    path::{Path, PathBuf},
};

const MAGIC: &[u8; 8] = b"RWFOREST";
const VERSION: u32 = 2;
const NODE_LEN: usize = 10;
const ROOTS_LEN: usize = 8;
const DIGEST_LEN: usize = 32;
/// Larger headers are no headers.
const LONGEST_HEADER: usize = 1 << 20;

#[derive(Serialize, Deserialize)]
struct Header {
    recipe: String,
    components: Vec<String>,
    facing_bins: usize,
    deviation_scale: f64,
    trees: usize,
    nodes: usize,
}

/// A file that holds no forest of this version.
#[derive(Debug, thiserror::Error)]
pub enum ForestFileError {
    /// The disk.
    #[error("cannot read or write the forest `{}`", file.display())]
    Disk {
        /// The file.
        file: PathBuf,
        /// Why.
        #[source]
        cause: io::Error,
    },
    /// What is wrong with the content.
    #[error("`{}` is not a forest that can be used: {what}", file.display())]
    Content {
        /// The file.
        file: PathBuf,
        /// What.
        what: &'static str,
    },
}

impl Forest {
    /// Writes the forest.
    ///
    /// # Errors
    /// When the disk does not take it.
    pub fn write(&self, file: &Path) -> Result<(), ForestFileError> {
        fs::write(file, self.to_bytes()).map_err(|cause| ForestFileError::Disk {
            file: file.to_owned(),
            cause,
        })
    }

    /// Reads a forest.
    ///
    /// # Errors
    /// When the file is absent, damaged, or of another version.
    pub fn read(file: &Path) -> Result<Self, ForestFileError> {
        let bytes = fs::read(file).map_err(|cause| ForestFileError::Disk {
            file: file.to_owned(),
            cause,
        })?;
        Self::from_bytes(&bytes).map_err(|what| ForestFileError::Content {
            file: file.to_owned(),
            what,
        })
    }

    fn to_bytes(&self) -> Vec<u8> {
        let header = serde_json::json!(Header {
            recipe: self.recipe.to_string(),
            components: self.components.clone(),
            facing_bins: self.facing_bins,
            deviation_scale: self.deviation_scale,
            trees: self.roots.len(),
            nodes: self.nodes.len(),
        });
        let header = header.to_string();
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        bytes.extend((header.len() as u32).to_le_bytes());
        bytes.extend(header.as_bytes());
        bytes.extend(
            self.roots
                .iter()
                .flatten()
                .flat_map(|root| root.to_le_bytes()),
        );
        for node in &self.nodes {
            bytes.extend(node.feature.to_le_bytes());
            bytes.extend(node.value.to_le_bytes());
            bytes.extend(node.next.to_le_bytes());
        }
        let digest = Sha256::digest(&bytes);
        bytes.extend(digest);
        bytes
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, &'static str> {
        let mut rest = bytes
            .strip_prefix(MAGIC)
            .ok_or("it does not begin with RWFOREST")?;
        if number(&mut rest)? != VERSION {
            return Err("it is of another version; train it again");
        }
        let content_len = bytes.len().checked_sub(DIGEST_LEN).ok_or("it is cut off")?;
        let (content, digest) = bytes.split_at(content_len);
        if Sha256::digest(content).as_slice() != digest {
            return Err("it is damaged or cut off: its checksum does not fit");
        }
        let header_len = number(&mut rest)? as usize;
        if header_len > LONGEST_HEADER {
            return Err("its header is malformed");
        }
        let header = take(&mut rest, header_len)?;
        let header: Header =
            serde_json::from_slice(header).map_err(|_| "its header is malformed")?;
        let recipe = Recipe::from_name(&header.recipe).ok_or("its recipe is unknown")?;
        if rest.len() != header.trees * ROOTS_LEN + header.nodes * NODE_LEN + DIGEST_LEN {
            return Err("it holds another number of nodes than it says");
        }
        let mut forest = Self {
            recipe,
            components: header.components,
            facing_bins: header.facing_bins,
            nodes: Vec::with_capacity(header.nodes),
            roots: Vec::with_capacity(header.trees),
            deviation_scale: header.deviation_scale,
        };
        for _ in 0..header.trees {
            forest.roots.push([number(&mut rest)?, number(&mut rest)?]);
        }
        for _ in 0..header.nodes {
            let feature = take(&mut rest, 2)?;
            forest.nodes.push(Node {
                feature: u16::from_le_bytes([feature[0], feature[1]]),
                value: f32::from_bits(number(&mut rest)?),
                next: number(&mut rest)?,
            });
        }
        forest.check()?;
        Ok(forest)
    }

    /// Whether every path ends in a leaf: children lie behind their parents, and features exist.
    fn check(&self) -> Result<(), &'static str> {
        let mut features = Vec::new();
        let empty = crate::row::Row {
            components: vec![(None, 0.0); self.components.len()],
            facing: vec![0.0; self.facing_bins],
            aspect: 0.0,
        };
        self.recipe
            .features(&empty, &self.components, &mut features);
        let count = self.nodes.len();
        let sound = |(at, node): (usize, &Node)| {
            let next = node.next as usize;
            let child = next > at && next + 1 < count;
            node.feature == LEAF || (child && usize::from(node.feature) < features.len())
        };
        let rooted = self
            .roots
            .iter()
            .flatten()
            .all(|&root| (root as usize) < count);
        let scaled = self.deviation_scale > 0.0 && self.deviation_scale.is_finite();
        if self.roots.is_empty() || !rooted || !scaled || !self.nodes.iter().enumerate().all(sound)
        {
            return Err("its trees are malformed");
        }
        Ok(())
    }
}

fn take<'a>(rest: &mut &'a [u8], len: usize) -> Result<&'a [u8], &'static str> {
    let (taken, left) = rest.split_at_checked(len).ok_or("it is cut off")?;
    *rest = left;
    Ok(taken)
}

fn number(rest: &mut &[u8]) -> Result<u32, &'static str> {
    let bytes = take(rest, 4)?;
    Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        angle::ObservationAngle,
        forest::ForestOptions,
        row::{LabelledRow, Row, RowTable},
    };
    use roadwatch_core::space::Point;
    use std::f64::consts::TAU;

    /// Components that go round with the angle, as those of a turntable do.
    fn rows(count: usize, seed: u64) -> RowTable {
        let mut random = fastrand::Rng::with_seed(seed);
        let mut one = || {
            let angle = random.f64() * TAU;
            let column = |phase: f64| {
                let depth = (angle + phase).cos();
                let x = 0.5 + 0.45 * (angle + phase).sin();
                ((depth > 0.0).then_some(x), depth.max(0.0) as f32)
            };
            LabelledRow {
                row: Row {
                    aspect: 0.5 + 0.3 * angle.sin().abs(),
                    components: (0..4).map(|n| column(f64::from(n) * TAU / 4.0)).collect(),
                    facing: Vec::new(),
                },
                angle: ObservationAngle::new(angle),
                place: Point::new(10.0, 0.0, 0.0),
                box_height_px: 80.0,
            }
        };
        RowTable {
            components: ["tyre_a", "tyre_b", "plate_front", "plate_rear"]
                .map(str::to_owned)
                .to_vec(),
            facing_bins: 0,
            rows: (0..count).map(|_| one()).collect(),
        }
    }

    fn forest() -> Forest {
        let options = ForestOptions {
            trees: 10,
            ..ForestOptions::default()
        };
        Forest::grow(&rows(1500, 1), options, |_, _| ()).expect("a forest")
    }

    #[test]
    fn unseen_rows_are_turned_within_a_few_degrees_all_round() {
        let (forest, mut features) = (forest(), Vec::new());
        let mut off: Vec<f64> = rows(300, 2)
            .rows
            .iter()
            .map(|one| {
                let turned = forest.turn(&one.row, &mut features);
                turned.angle.apart_rad(one.angle).to_degrees()
            })
            .collect();
        off.sort_by(f64::total_cmp);
        assert!(
            off[150] < 2.0 && off[285] < 10.0,
            "{} {}",
            off[150],
            off[285]
        );
    }

    #[test]
    fn the_same_seed_grows_the_same_forest_and_a_file_keeps_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join("forest");
        let first = forest();
        assert_eq!(first, forest());
        first.write(&file).expect("written");
        assert_eq!(Forest::read(&file).expect("a forest"), first);
    }

    #[test]
    fn damaged_cut_off_and_foreign_files_are_refused() {
        let whole = forest().to_bytes();
        let what = |bytes: &[u8]| Forest::from_bytes(bytes).expect_err("no forest");
        assert!(what(b"text").contains("RWFOREST"));
        assert!(what(&whole[..whole.len() / 2]).contains("checksum"));
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        assert!(what(&flipped).contains("checksum"));
        let mut newer = whole;
        newer[8] = 9;
        assert!(what(&newer).contains("version"));
    }
}
