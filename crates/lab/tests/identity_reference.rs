//! Identities are scored as the reference implementation scores them.

#[path = "../../ros/tests/common/python.rs"]
mod python;

use roadwatch_lab::{IdentityScore, Moment};
use serde_json::{Value, json};
use std::{
    io::Write as _,
    process::{Command, Stdio},
};

/// Objects that come and go, found with gaps, under identities that change now and then, beside false alarms. No two
/// similarities are equal, because there the two may choose differently.
fn made_up(seed: u64) -> Vec<Moment> {
    let mut random = fastrand::Rng::with_seed(seed);
    let objects = random.u64(1..8);
    let mut names: Vec<u64> = (0..objects).map(|id| 100 + id).collect();
    let mut next = 1000;
    let mut moments = Vec::new();
    for _ in 0..40 {
        let mut truths = Vec::new();
        let mut found = Vec::new();
        for truth in 0..objects {
            if random.f64() < 0.1 {
                continue;
            }
            truths.push(truth);
            if random.f64() < 0.08 {
                next += 1;
                names[truth as usize] = next;
            }
            if random.f64() < 0.8 {
                found.push((names[truth as usize], Some(truth)));
            }
        }
        if random.f64() < 0.3 {
            found.push((random.u64(5000..5005), None));
        }
        let mut row = |truth: &u64| -> Vec<f64> {
            let near = |(_, of): &(u64, Option<u64>)| match *of == Some(*truth) {
                true => 0.3 + 0.7 * random.f64(),
                false => 0.6 * random.f64(),
            };
            found.iter().map(near).collect()
        };
        moments.push(Moment {
            similarity: truths.iter().map(&mut row).collect(),
            truths,
            found: found.into_iter().map(|(id, _)| id).collect(),
        });
    }
    moments
}

fn reference(mut command: Command, moments: &[Moment]) -> Value {
    let as_json =
        |m: &Moment| json!({"truths": m.truths, "found": m.found, "similarity": m.similarity});
    let input: Vec<Value> = moments.iter().map(as_json).collect();
    let mut child = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("python runs");
    let text = Value::Array(input).to_string();
    let mut stdin = child.stdin.take().expect("piped");
    stdin.write_all(text.as_bytes()).expect("written");
    drop(stdin);
    let output = child.wait_with_output().expect("ended");
    let said = String::from_utf8_lossy(&output.stdout);
    serde_json::from_str(said.lines().last().expect("an answer")).expect("JSON")
}

#[test]
fn the_reference_gives_the_same_figures() {
    for seed in 0..12 {
        let Some(command) = python::peer("identity_reference.py", "trackeval") else {
            return;
        };
        let moments = made_up(seed);
        let expected = reference(command, &moments);
        let found = serde_json::to_value(IdentityScore::of(&moments)).expect("JSON");
        for share in ["idf1", "hota", "deta", "assa", "mota"] {
            let [ours, theirs] =
                [&found, &expected].map(|one| one[share].as_f64().expect("a share"));
            assert!(
                (ours - theirs).abs() < 1e-9,
                "{seed} {share}: {ours}, not {theirs}"
            );
        }
        for count in ["switches", "fragmentations"] {
            assert_eq!(found[count], expected[count], "{seed} {count}");
        }
    }
}
