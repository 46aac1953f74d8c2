//! Every configuration that is shipped has no mistakes.

mod support;

use std::fs;
use support::{root, run, runtime_library, shared, stderr};

#[test]
fn shipped_configurations_have_no_mistakes() {
    if runtime_library().is_none() {
        return;
    }
    let mut checked = 0;
    for file in fs::read_dir(root().join("config")).expect("config/") {
        let path = file.expect("a file").path();
        let text = fs::read_to_string(&path).expect("a text file");
        if text.contains("ROADWATCH_SHARED") && shared().is_none() {
            continue;
        }
        let output = run(&["check", &path.display().to_string()]);
        assert!(output.status.success(), "{}", stderr(&output));
        checked += 1;
    }
    assert!(checked > 0, "no configuration is shipped");
}
