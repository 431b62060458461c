//! The list of all guides, and their statuses.

use std::sync::Arc;

use super::at_home::AtHome;
use super::cues::Cues;
use super::first_run::FirstRun;
use super::force_range::ForceRange;
use super::guide::{GuideContext, GuideStatus, PageGuide};
use tactpad_bridge::request::Request;

/// All guides, and the status of each that was sent last.
pub(in crate::dashboard) struct Guides {
    all: Vec<Box<dyn PageGuide>>,
    sent: Vec<Arc<str>>,
    /// Counts what changed.
    changes: u64,
}

impl Guides {
    /// None has begun.
    pub(in crate::dashboard) fn new() -> Self {
        let all: Vec<Box<dyn PageGuide>> = vec![
            Box::<FirstRun>::default(),
            Box::<ForceRange>::default(),
            Box::<Cues>::default(),
            Box::<AtHome>::default(),
        ];
        let sent = vec![Arc::from(""); all.len()];
        Self { all, sent, changes: 0 }
    }

    /// How all of them stand.
    pub(in crate::dashboard) fn statuses(&self) -> Vec<GuideStatus> {
        self.all.iter().map(|guide| guide.status()).collect()
    }

    /// Lets all of them look. A status that has changed is sent to each page that asks with its last number of changes.
    pub(in crate::dashboard) fn update(&mut self, context: &GuideContext<'_>) {
        for (guide, sent) in self.all.iter_mut().zip(&mut self.sent) {
            guide.update(context);
            let now = crate::dashboard::frame::json(&guide.status());
            if now.as_str() != &**sent {
                *sent = now.into();
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
        let sent = self.sent.iter().filter(|status| !status.is_empty());
        sent.map(|status| format!(r#"{{"kind":"guide","guide":{status}}}"#)).collect()
    }

    /// Nobody looks any more.
    pub(in crate::dashboard) fn on_page_closed(&mut self, context: &GuideContext<'_>) {
        self.all.iter_mut().for_each(|guide| guide.on_page_closed(context));
    }

    /// Does what people ask of a guide: `start`, `stop`, or an action of a step. `None` if there is no such guide.
    pub(in crate::dashboard) fn act(
        &mut self,
        id: &str,
        action: &str,
        number: Option<f64>,
        context: &GuideContext<'_>,
    ) -> Option<Result<ActionResult, String>> {
        let guide = self.all.iter_mut().find(|guide| guide.id() == id)?;
        let result = match action {
            "start" => guide.start(context).map(|()| None),
            "stop" => {
                guide.stop(context);
                Ok(None)
            }
            action => guide.act(action, number, context),
        };
        guide.update(context);
        Some(result.map(|request| ActionResult { status: guide.status(), request }))
    }
}

/// The result of an action.
pub(in crate::dashboard) struct ActionResult {
    pub(in crate::dashboard) status: GuideStatus,
    /// The request to send to the bridge.
    pub(in crate::dashboard) request: Option<Request>,
}
