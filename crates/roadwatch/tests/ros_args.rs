//! `--ros-args`, as launch files pass them.

mod support;

use std::fs;
use support::{demo, run, run_well, stderr, stdout};

const RULES: [&str; 7] = [
    "--ros-args",
    "-r",
    "__node:=eyes",
    "-r",
    "__ns:=/one",
    "-r",
    "~/scene/objects:=/perception/objects",
];

#[test]
fn the_node_and_its_topics_go_by_the_names_that_were_asked_for() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let said = stdout(&run_well(
        &[&["graph", config.as_str()][..], &RULES].concat(),
    ));
    for expected in [
        "node /one/eyes,",
        "/perception/objects ",
        "/one/eyes/front/objects ",
        "/tf_static ",
    ] {
        assert!(said.contains(expected), "{expected}: {said}");
    }
    assert!(!said.contains("roadwatch/front"), "{said}");
}

#[test]
fn a_bag_has_the_same_names_and_other_options_may_follow() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let bag = folder.path().join("bag").display().to_string();
    let more = ["--", "--pace", "lossless", "--frames", "1", "--bag", &bag];
    run_well(&[&["run", config.as_str()][..], &RULES, &more].concat());
    let metadata = fs::read_to_string(folder.path().join("bag/metadata.yaml")).expect("a bag");
    assert!(metadata.contains("name: /perception/objects"), "{metadata}");
    assert!(
        metadata.contains("name: /one/eyes/back/markers"),
        "{metadata}"
    );
}

#[test]
fn what_cannot_be_followed_is_a_wrong_argument() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let output = run(&["check", &config, "--ros-args", "-p", "use_sim_time:=true"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("--ros-args: `-p` cannot be followed: this node has no parameters"),
        "{said}"
    );
}
