//! The verb's plots, as files.

use std::path::Path;

use super::Trials;
use crate::ablation::Subject;
use crate::ablation::drawing::{self, Outcome};
use crate::ablation::entries::{ENTRIES, Method};
use crate::ablation::maps;
use crate::ablation::regions::Touches;
use crate::cli::{Failure, pictures};
use crate::plot::figure::Figure;

/// Writes the plots, and says the names of their SVG files.
pub(super) fn write(folder: &Path, subject: &Subject<'_>, trials: &Trials) -> Result<Vec<String>, Failure> {
    let mut figures = vec![("ablation-regions".to_owned(), regions(subject, trials))];
    for (unseen, judged) in trials.unseen.iter().zip(&trials.judged) {
        let outcomes: Vec<Outcome<'_>> = ENTRIES.iter().zip(judged).collect();
        let learnt: Vec<Outcome<'_>> =
            outcomes.iter().copied().filter(|(entry, _)| entry.has_all()).collect();
        let reach_mm = subject.actual.device.contact.max_centre_radius_mm;
        figures.extend([
            (format!("ablation-samples-{}", unseen.plan), drawing::by_samples(unseen, &outcomes)),
            (format!("ablation-force-{}", unseen.plan), drawing::by_force(unseen, &outcomes)),
            (format!("ablation-map-{}", unseen.plan), maps::over_plate(unseen, &learnt, reach_mm)),
        ]);
    }
    let written = figures.iter().map(|(name, figure)| {
        pictures::write(folder, name, figure)?;
        Ok(folder.join(name).with_extension("svg").display().to_string())
    });
    written.collect()
}

/// Figure 11 for the paper's decoder and ours.
fn regions(subject: &Subject<'_>, trials: &Trials) -> Figure {
    let touches = Touches::of(subject);
    let drawn = [Method::Network, Method::Inverse];
    let decoded = ENTRIES.iter().zip(&trials.decoders);
    let decoded = decoded.filter(|(entry, _)| entry.has_all() && drawn.contains(&entry.method));
    let decoded: Vec<_> =
        decoded.map(|(entry, decoder)| (entry.to_string(), touches.decoded(decoder))).collect();
    drawing::by_region(&decoded)
}
