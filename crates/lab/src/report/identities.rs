//! Identities and velocities, for people.

use super::{
    Report,
    markdown::{metres, percent, row},
};
use crate::identity::MIN_TIMES_FOUND;

impl Report {
    pub(super) fn identities(&self) -> String {
        let identity = &self.identity;
        if identity.per_camera.object_frames == 0 {
            return String::new();
        }
        let mut text = format!(
            "## Identities\n\nOf objects that were found at least {MIN_TIMES_FOUND} times; false alarms are counted above. Found under more than one identity \
             at once: {}.\n\n\
             | | objects in all moments | IDF1 | HOTA | DetA | AssA | MOTA | switches | fragmentations |\n\
             |---|---|---|---|---|---|---|---|---|\n",
            percent(identity.duplicate_share)
        );
        let mut rows = vec![
            ("rig".to_owned(), &identity.rig),
            ("per camera".to_owned(), &identity.per_camera),
        ];
        let scene = identity.scene.iter();
        rows.extend(scene.map(|scene| ("published scenes".to_owned(), scene)));
        for (name, baseline) in &self.identity_baselines {
            rows.push((format!("{name}, rig"), &baseline.rig));
            rows.push((format!("{name}, per camera"), &baseline.per_camera));
        }
        for (name, score) in rows {
            let shares = [score.idf1, score.hota, score.deta, score.assa, score.mota];
            let [idf1, hota, deta, assa, mota] = shares.map(percent);
            let counts = [score.object_frames, score.switches, score.fragmentations];
            let [objects, switches, fragmentations] = counts.map(|count| count.to_string());
            text.push_str(&row([
                name,
                objects,
                idf1,
                hota,
                deta,
                assa,
                mota,
                switches,
                fragmentations,
            ]));
        }
        text.push('\n');
        text.push_str(&self.velocities());
        text
    }

    fn velocities(&self) -> String {
        let kinds = [
            ("moving", self.motion.moving),
            ("standing", self.motion.standing),
        ];
        if kinds.iter().all(|(_, score)| score.n == 0) {
            return String::new();
        }
        let mut text = "## Velocities\n\nOver ground, of tracked objects; moving is faster than 1 m/s by the labels.\n\n\
             | | sights | error p50, m/s | p90, m/s | NEES |\n|---|---|---|---|---|\n"
            .to_owned();
        for (name, score) in kinds {
            let nees = score
                .nees
                .map_or("-".to_owned(), |nees| format!("{nees:.2}"));
            text.push_str(&row([
                name.to_owned(),
                score.n.to_string(),
                metres(score.p50_m_s),
                metres(score.p90_m_s),
                nees,
            ]));
        }
        text.push('\n');
        text
    }
}
