//! Networks of others that are more than a chain of layers: run by tract, with its plan and its tensors kept.
//!
//! tract allocates while it runs, chooses its arithmetic by the processor, and believes the file it is given: what the
//! live core promises of its own decoders does not hold here. So it is a feature that is asked for.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Arc, Mutex};

use tract_onnx::prelude::{
    DatumExt, Framework, InferenceModelExt, IntoRunnable, TValue, Tensor, TractResult, TypedSimpleState, tvec,
};

use super::onnx;
use super::onnx::error::OnnxError;
use super::{OUTPUTS, Zero};
use crate::quantity::CHANNELS;

/// Longest part of an error's text: tract prints whole graphs.
const TOLD_CHARACTERS: usize = 200;

/// A network that tract runs. Clones share its state.
#[derive(Clone)]
pub struct Foreign {
    /// What it takes.
    pub zero: Zero,
    /// Behind a lock because tract writes in it. A run that panics leaves the lock broken, and is the last one.
    running: Arc<Mutex<RunnablePlan>>,
}

/// A plan with all that it needs to run.
struct RunnablePlan {
    state: TypedSimpleState,
    channels: Arc<Tensor>,
}

impl fmt::Debug for Foreign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Foreign").field("zero", &self.zero).finish_non_exhaustive()
    }
}

impl Foreign {
    /// Reads any model that takes `[1, 9]` floats and gives five.
    ///
    /// # Errors
    /// Bytes that are no model, one with another signature, or one that tract does not run.
    pub fn read(bytes: &[u8]) -> Result<Self, OnnxError> {
        let zero = onnx::zero(bytes)?;
        let running = catch_unwind(|| RunnablePlan::read(bytes)).map_err(|_| refused("it panicked"))?;
        let mut running = running.map_err(|error| refused(&format!("{error:#}")))?;
        match running.run(&[0.0; CHANNELS]) {
            Ok(Some(_)) => Ok(Self { zero, running: Arc::new(Mutex::new(running)) }),
            Ok(None) => Err(OnnxError::Shape(format!("it does not give {OUTPUTS} numbers"))),
            Err(error) => Err(refused(&format!("{error:#}"))),
        }
    }

    /// The contact for these channels, in microvolts: see [`Self::zero`] for what they are,
    /// [`numbers`](super::numbers) for the order. Where the network fails, no number is one.
    pub fn decode(&self, uv: &[f32; CHANNELS]) -> [f32; OUTPUTS] {
        let run = AssertUnwindSafe(|| self.running.lock().ok()?.run(uv).ok()?);
        catch_unwind(run).ok().flatten().unwrap_or([f32::NAN; OUTPUTS])
    }
}

impl RunnablePlan {
    fn read(mut bytes: &[u8]) -> TractResult<Self> {
        let model = tract_onnx::onnx().model_for_read(&mut bytes)?;
        let row = f32::fact([1, CHANNELS]);
        let state = model.with_input_fact(0, row.into())?.into_optimized()?.into_runnable()?.spawn()?;
        Ok(Self { state, channels: Arc::new(Tensor::zero::<f32>(&[1, CHANNELS])?) })
    }

    /// The five numbers, or `None` where the model gives something else.
    fn run(&mut self, uv: &[f32; CHANNELS]) -> TractResult<Option<[f32; OUTPUTS]>> {
        match Arc::get_mut(&mut self.channels) {
            Some(channels) => channels.try_as_plain_ram_mut()?.as_slice_mut()?.copy_from_slice(uv),
            None => self.channels = Arc::new(Tensor::from_shape(&[1, CHANNELS], uv)?),
        }
        let given = self.state.run(tvec![TValue::from_const(Arc::clone(&self.channels))])?;
        let [contact] = given.as_slice() else { return Ok(None) };
        Ok(contact.try_as_plain_ram()?.as_slice::<f32>()?.try_into().ok())
    }
}

fn refused(why: &str) -> OnnxError {
    let line: String = why.split_whitespace().collect::<Vec<_>>().join(" ");
    // Names in it may hold what a terminal obeys.
    OnnxError::Foreign(line.chars().take(TOLD_CHARACTERS).collect::<String>().escape_debug().to_string())
}
