//! Every configuration that is shipped has no mistakes.

mod support;

use std::{fs, path::Path};
use support::{daemon, root, runtime_library, shared, stderr};

#[test]
fn shipped_configurations_have_no_mistakes() {
    if runtime_library().is_none() {
        return;
    }
    let kitti = tempfile::tempdir().expect("a folder");
    write_kitti(kitti.path());
    let mut checked = 0;
    for file in fs::read_dir(root().join("config")).expect("config/") {
        let path = file.expect("a file").path();
        let text = fs::read_to_string(&path).expect("a text file");
        if text.contains("ROADWATCH_SHARED") && shared().is_none() {
            continue;
        }
        let output = daemon(&["check", &path.display().to_string()])
            .env("ROADWATCH_KITTI", kitti.path())
            .output()
            .expect("the daemon starts");
        assert!(output.status.success(), "{}", stderr(&output));
        checked += 1;
    }
    assert!(checked > 0, "no configuration is shipped");
}

/// As little of KITTI's layout as a check looks at: one image's header and its calibration.
fn write_kitti(folder: &Path) {
    let png = b"\x89PNG\r\n\x1a\n\0\0\0\x0dIHDR\0\0\x04\xda\0\0\x01\x77\x08\x02\0\0\0\0\0\0\0";
    let calibration = "P2: 721.5 0 609.6 44.9 0 721.5 172.9 0.2 0 0 1 0.003\n";
    for (part, bytes) in [
        ("image_2/000000.png", png.as_slice()),
        ("calib/000000.txt", calibration.as_bytes()),
    ] {
        let file = folder.join(part);
        fs::create_dir_all(file.parent().expect("a folder")).expect("made");
        fs::write(file, bytes).expect("written");
    }
}
