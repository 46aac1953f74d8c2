//! Offline work on labelled data: what the pipeline said, matched to the truth and scored.
//!
//! There is one matcher ([`matching`]) and one scorer ([`score`]); every report is made of them.

pub mod evaluate;
pub mod labelled_table;
pub mod matching;
pub mod recorder;
pub mod report;
pub mod score;
pub mod truth;

pub use evaluate::{Evaluation, LostImages, MethodUnderTest, evaluate};
pub use labelled_table::{LabelCounts, LabelledTableError, LabelledTableSpec, table_from_labels};
pub use matching::TruthFilter;
pub use recorder::{Recorded, Recorder};
pub use report::{Report, ReportError};
pub use truth::{Truth, TruthError, TruthObject};
