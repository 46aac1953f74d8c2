//! The arrows between crates, as they are built.

mod support;

use cargo_metadata::{DependencyKind, MetadataCommand};
use std::collections::BTreeMap;

/// Each crate with the crates of this workspace it may depend on.
const ARROWS: [(&str, &[&str]); 14] = [
    ("roadwatch-core", &[]),
    ("roadwatch-pipeline", &["roadwatch-core"]),
    ("roadwatch-camera", &["roadwatch-core"]),
    ("roadwatch-onnx", &[]),
    ("roadwatch-detect", &["roadwatch-core", "roadwatch-onnx"]),
    ("roadwatch-rotate", &["roadwatch-core", "roadwatch-onnx"]),
    ("roadwatch-locate", &["roadwatch-core"]),
    ("roadwatch-reid", &["roadwatch-core"]),
    ("roadwatch-ros", &["roadwatch-core"]),
    ("roadwatch-picture", &["roadwatch-core"]),
    (
        "roadwatch-calibrate",
        &["roadwatch-core", "roadwatch-locate"],
    ),
    (
        "roadwatch-lab",
        &[
            "roadwatch-core",
            "roadwatch-pipeline",
            "roadwatch-camera",
            "roadwatch-detect",
            "roadwatch-locate",
            "roadwatch-reid",
            "roadwatch-ros",
            "roadwatch-rotate",
        ],
    ),
    (
        "roadwatch",
        &[
            "roadwatch-core",
            "roadwatch-calibrate",
            "roadwatch-pipeline",
            "roadwatch-camera",
            "roadwatch-detect",
            "roadwatch-locate",
            "roadwatch-onnx",
            "roadwatch-reid",
            "roadwatch-rotate",
            "roadwatch-ros",
            "roadwatch-picture",
            "roadwatch-lab",
        ],
    ),
    // The simulated world may see everything; nothing depends on it.
    (
        "roadwatch-tests",
        &[
            "roadwatch-core",
            "roadwatch-pipeline",
            "roadwatch-camera",
            "roadwatch-detect",
            "roadwatch-locate",
            "roadwatch-reid",
            "roadwatch-ros",
            "roadwatch-picture",
            "roadwatch-lab",
            "roadwatch",
        ],
    ),
];

/// What core must never learn: waiting, files, networks, middleware.
const NEVER_IN_CORE: [&str; 6] = ["tokio", "serde", "ros2-client", "rustdds", "opencv", "ort"];

#[test]
fn crates_depend_one_way() {
    let metadata = MetadataCommand::new()
        .manifest_path(support::root().join("Cargo.toml"))
        .no_deps()
        .exec()
        .expect("cargo metadata");
    let arrows: BTreeMap<_, _> = ARROWS.into_iter().collect();
    let members = metadata.workspace_packages();
    assert_eq!(
        members.len(),
        arrows.len(),
        "a crate is missing from this test"
    );
    for package in members {
        let allowed = arrows.get(package.name.as_str()).expect("a known crate");
        for dependency in &package.dependencies {
            let name = dependency.name.as_str();
            let ours = name.starts_with("roadwatch");
            assert!(
                !ours || allowed.contains(&name),
                "{} must not depend on {name}",
                package.name
            );
            let in_core = package.name.as_str() == "roadwatch-core"
                && dependency.kind == DependencyKind::Normal;
            assert!(
                !in_core || !NEVER_IN_CORE.contains(&name),
                "core must not depend on {name}"
            );
        }
    }
}
