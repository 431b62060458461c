//! All guides, and what is told of them.

use std::sync::Arc;

use super::at_home::AtHome;
use super::cues::Cues;
use super::first_run::FirstRun;
use super::force_range::ForceRange;
use super::guide::{Guide, Scene, Told};
use tactpad_bridge::request::Request;

/// All guides, and what was told of each.
pub(in crate::dashboard) struct Guides {
    all: Vec<Box<dyn Guide>>,
    told: Vec<Arc<str>>,
    /// Counts what changed.
    changes: u64,
}

impl Guides {
    /// None has begun.
    pub(in crate::dashboard) fn new() -> Self {
        let all: Vec<Box<dyn Guide>> = vec![
            Box::<FirstRun>::default(),
            Box::<ForceRange>::default(),
            Box::<Cues>::default(),
            Box::<AtHome>::default(),
        ];
        let told = vec![Arc::from(""); all.len()];
        Self { all, told, changes: 0 }
    }

    /// How all of them stand.
    pub(in crate::dashboard) fn told(&self) -> Vec<Told> {
        self.all.iter().map(|guide| guide.told()).collect()
    }

    /// Lets all of them look. What has changed is told to each page that asks with the number that it had before.
    pub(in crate::dashboard) fn look(&mut self, scene: &Scene<'_>) {
        for (guide, told) in self.all.iter_mut().zip(&mut self.told) {
            guide.look(scene);
            let now = crate::dashboard::frame::json(&guide.told());
            if now.as_str() != &**told {
                *told = now.into();
                self.changes += 1;
            }
        }
    }

    /// How often anything changed.
    pub(in crate::dashboard) fn changes(&self) -> u64 {
        self.changes
    }

    /// All guides as messages.
    pub(in crate::dashboard) fn messages(&self) -> Vec<String> {
        let told = self.told.iter().filter(|told| !told.is_empty());
        told.map(|told| format!(r#"{{"kind":"guide","guide":{told}}}"#)).collect()
    }

    /// Nobody looks any more.
    pub(in crate::dashboard) fn leave(&mut self, scene: &Scene<'_>) {
        self.all.iter_mut().for_each(|guide| guide.leave(scene));
    }

    /// Does what people ask of a guide: `start`, `stop`, or an action of a step. `None` if there is no such guide.
    pub(in crate::dashboard) fn act(
        &mut self,
        id: &str,
        (action, number): (&str, Option<f64>),
        scene: &Scene<'_>,
    ) -> Option<Result<Done, String>> {
        let guide = self.all.iter_mut().find(|guide| guide.id() == id)?;
        let asked = match action {
            "start" => guide.start(scene).map(|()| None),
            "stop" => {
                guide.stop(scene);
                Ok(None)
            }
            action => guide.act(action, number, scene),
        };
        guide.look(scene);
        Some(asked.map(|request| Done { told: guide.told(), request }))
    }
}

/// What came of an action.
pub(in crate::dashboard) struct Done {
    pub(in crate::dashboard) told: Told,
    /// What is to be asked of the bridge.
    pub(in crate::dashboard) request: Option<Request>,
}
