//! Offline work on labelled data: what the pipeline said, matched to the truth and scored.
//!
//! There is one matcher ([`matching`]), one scorer ([`score`]) and one table of samples ([`sample_table`]); every
//! report, group and plot is made of them.

pub mod baseline;
pub mod bootstrap;
pub mod collect;
pub mod dataset_format;
pub mod evaluate;
pub mod export;
pub mod footprint;
pub mod grouping;
pub mod heading_score;
pub mod honesty;
pub mod identity;
pub mod kitti;
pub mod labelled_table;
#[cfg(test)]
mod made;
pub mod matching;
pub mod motion;
pub mod plots;
pub mod recorder;
pub mod report;
pub mod rotation;
pub mod sample;
pub mod sample_table;
pub mod score;
pub mod study;
pub mod truth;

pub use baseline::Baseline;
pub use bootstrap::Intervals;
pub use dataset_format::{DatasetFormat, OpenDatasetError};
pub use evaluate::{Evaluation, LostImages, MethodUnderTest, evaluate};
pub use identity::{IdentityReport, IdentityScore, Moment, PublishedScene};
pub use labelled_table::{LabelCounts, LabelledTableError, LabelledTableSpec, table_from_labels};
pub use matching::TruthFilter;
pub use plots::draw_position_curve;
pub use recorder::{Recorded, Recorder, Recording};
pub use report::{LatencyMs, Report, ReportError};
pub use rotation::{RotationReport, RowFilter, RowsFrom};
pub use sample::{Estimator, Sample, Target};
pub use sample_table::SampleTable;
pub use score::Figures;
pub use study::{Study, StudyScene};
pub use truth::{Truth, TruthError, TruthObject};
