//! A disk that fills up while recording: every further output is an error, nothing panics, and what
//! was written before can be read.

mod common;

use roadwatch_core::Sink;
use roadwatch_ros::{BagOptions, BagSink, LogTime, Surface};
use std::io::Write as _;
use std::{fs, path::PathBuf, process::Command, sync::Arc};
use tempfile::TempDir;

/// A real file system of 128 KiB.
struct SmallDisk {
    scratch: TempDir,
}

impl SmallDisk {
    /// `None`, said loudly, where this user may not mount.
    fn mount() -> Option<Self> {
        let scratch = tempfile::tempdir().expect("a scratch folder");
        let mounted = Command::new("mount")
            .args(["-t", "tmpfs", "-o", "size=128k", "tmpfs"])
            .arg(scratch.path())
            .output()
            .is_ok_and(|output| output.status.success());
        if !mounted {
            writeln!(
                std::io::stderr(),
                "SKIPPED: this user cannot mount a small disk to fill"
            )
            .expect("standard error");
            return None;
        }
        Some(Self { scratch })
    }

    fn folder(&self) -> PathBuf {
        self.scratch.path().join("drive")
    }
}

impl Drop for SmallDisk {
    fn drop(&mut self) {
        let unmounted = Command::new("umount").arg(self.scratch.path()).status();
        assert!(
            unmounted.is_ok_and(|status| status.success()),
            "still mounted"
        );
    }
}

#[test]
fn a_full_disk_ends_the_recording_with_an_error_and_keeps_what_was_written() {
    let Some(disk) = SmallDisk::mount() else {
        return;
    };
    let rig = Arc::new(common::two_cameras());
    let mut bag = BagSink::create(
        &disk.folder(),
        rig,
        &Surface::default(),
        BagOptions::new(LogTime::Stamp),
    )
    .expect("room for the beginning");
    let recorded = (0..10_000)
        .flat_map(common::outputs)
        .take_while(|output| bag.publish(output).is_ok())
        .count();
    assert!((100..10_000).contains(&recorded), "{recorded}");
    for output in common::outputs(0) {
        bag.publish(&output).expect_err("still full");
    }
    bag.finish().expect_err("incomplete");
    drop(bag);

    let file = fs::read(disk.folder().join("drive_0.mcap")).expect("still there");
    let readable =
        mcap::MessageStream::new_with_options(&file, mcap::read::Options::IgnoreEndMagic.into())
            .expect("the beginning")
            .take_while(Result::is_ok)
            .count();
    assert!(readable > 500, "{readable}");
}
