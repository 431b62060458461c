//! Points inside the pipeline that can be timed.

/// A point inside the pipeline that a [`Probe`] can time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PipelineStage {
    /// A sample was unpacked from the bytes.
    Sample,
    /// Its contact was decoded.
    Contact,
    /// Its events were decided.
    Events,
}

/// Is told when a sample passes a stage. The live build passes [`NoProbe`], which costs nothing.
pub trait Probe {
    /// The sample at hand has passed `stage`.
    fn mark(&mut self, stage: PipelineStage);
}

/// A probe that looks away.
#[derive(Clone, Copy, Debug)]
pub struct NoProbe;

impl Probe for NoProbe {
    fn mark(&mut self, _stage: PipelineStage) {}
}
