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
    let output = run(&["check", &config, "--ros-args", "--enclave", "/a"]);
    let said = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(
        said.contains("--ros-args: `--enclave` cannot be followed: DDS security"),
        "{said}"
    );
}

#[test]
fn parameters_are_keys_of_the_configuration() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let file = folder.path().join("parameters.yaml");
    let text = "/**:\n  ros__parameters:\n    node: {domain_id: 7}\n    use_sim_time: true\n\
                /other:\n  ros__parameters:\n    node: {domain_id: 8}\n";
    fs::write(&file, text).expect("written");
    let file = file.display().to_string();
    let graph = |more: &[&str]| {
        let all = [
            &[
                "graph",
                config.as_str(),
                "--ros-args",
                "--params-file",
                &file,
            ][..],
            more,
        ];
        stdout(&run_well(&all.concat()))
    };
    assert!(graph(&[]).contains("node /roadwatch, domain 7"));
    // What comes later counts, unless it is for another node.
    assert!(graph(&["-p", "node.domain_id:=9"]).contains("domain 9"));
    assert!(graph(&["-p", "other:node.domain_id:=9"]).contains("domain 7"));
}

#[test]
fn a_parameter_that_is_no_key_is_refused_like_one() {
    let folder = tempfile::tempdir().expect("a folder");
    let config = demo(folder.path(), |text| text);
    let refused = |parameter: &str| {
        let output = run(&["check", &config, "--ros-args", "-p", parameter]);
        assert_eq!(output.status.code(), Some(78));
        stderr(&output)
    };
    let said = refused("detector.score_treshold:=0.4");
    assert!(
        said.contains("detector.score_treshold: unknown key; did you mean `score_threshold`?"),
        "{said}"
    );
    let said = refused("detector.score_threshold:=[a]");
    assert!(
        said.contains("detector.score_threshold: expected a number, found array"),
        "{said}"
    );
    let output = run(&[
        "check",
        &config,
        "--ros-args",
        "--params-file",
        "nowhere.yaml",
    ]);
    assert!(stderr(&output).contains("nowhere.yaml: cannot be read"));
}
