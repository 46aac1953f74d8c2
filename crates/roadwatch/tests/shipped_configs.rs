//! Every configuration that is shipped has no mistakes.

mod support;

use std::fs;
use support::{root, run, runtime_library, shared, stderr};

#[test]
fn shipped_configurations_have_no_mistakes() {
    let (Some(_), Some(_)) = (shared(), runtime_library()) else {
        return;
    };
    let files = fs::read_dir(root().join("config")).expect("config/");
    let mut checked = 0;
    for file in files {
        let path = file.expect("a file").path();
        if path
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            let output = run(&["check", &path.display().to_string()]);
            assert!(output.status.success(), "{}", stderr(&output));
            checked += 1;
        }
    }
    assert!(checked > 0, "no configuration is shipped");
}
