//! Frame sources: image sequences, video files and rig datasets.
