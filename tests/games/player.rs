//! Somebody of software at a pad: a finger on the twin of the paper's, behind a pseudo-terminal, or a hand on a pad that people own.

use std::sync::{Arc, Mutex};

use tactpad::bridge::transport::virtual_pad::{PadFirmware, VirtualPadPort as Terminal};
use tactpad::lab::field_cache::field_of;
use tactpad::numeric::random::SplitMix64;
use tactpad::pad::device::Device;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::Script;

use crate::clock::monotonic_ns;
use crate::hand::{Hand, Style};
use crate::pads::Owned;
use crate::segment::Segment;

/// When somebody began to play.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Begun {
    /// By the pad's clock; by the host's, where the pad has none.
    pub(crate) pad_us: u64,
    /// By the host's: the sample that is due then is sent at this time or up to a sample's period later.
    pub(crate) host_ns: u64,
}

/// What a player's thread is told, and tells.
pub(crate) struct Cue<T> {
    pub(crate) asked: Option<T>,
    pub(crate) begun: Option<Begun>,
}

impl<T> Cue<T> {
    pub(crate) fn shared() -> Arc<Mutex<Self>> {
        Arc::new(Mutex::new(Self { asked: None, begun: None }))
    }
}

/// The pad on its wire. It rests until it is told to play.
struct OnCue {
    pad: VirtualPad,
    cue: Arc<Mutex<Cue<Script>>>,
}

impl PadFirmware for OnCue {
    fn receive(&mut self, bytes: &[u8]) {
        self.pad.receive(bytes);
    }

    fn due_us(&self) -> u64 {
        self.pad.due_us()
    }

    fn emit(&mut self, now_us: u64, bytes: &mut Vec<u8>) {
        let mut cue = self.cue.lock().unwrap();
        if let Some(script) = cue.asked.take() {
            cue.begun = Some(Begun { host_ns: monotonic_ns(), pad_us: self.pad.play(script) });
        }
        drop(cue);
        self.pad.emit(now_us, bytes);
    }
}

/// What a thumb of this style does for a segment.
pub(crate) fn thumb_script(style: Style, segment: &Segment, seed: u64) -> Script {
    Hand::thumb(style).script(segment, SplitMix64::named(seed, "finger"))
}

/// A player at a pad of its own, both drawn from a seed.
pub(crate) enum Player {
    /// A thumb on the twin of the paper's pad.
    Twin { terminal: Terminal, cue: Arc<Mutex<Cue<Script>>>, style: Style, seed: u64 },
    /// Somebody on a pad that people own.
    Owned(Owned),
}

impl Player {
    pub(crate) fn on_twin(style: Style, seed: u64) -> Self {
        let text = include_str!("../../models/imperfections/paper.toml");
        let device = Device::nominal().with_imperfections(text).0.unwrap();
        let field = field_of(&device, |_| ()).unwrap().known;
        let pad = VirtualPad::of(Script::of(Vec::new()), &device, &field, seed);
        let cue = Cue::shared();
        let terminal = Terminal::start(OnCue { pad, cue: Arc::clone(&cue) }).unwrap();
        Self::Twin { terminal, cue, style, seed }
    }

    /// The pad, as `--pad` takes it.
    pub(crate) fn address(&self) -> String {
        match self {
            Self::Twin { terminal, .. } => format!("serial:{}", terminal.path()),
            Self::Owned(owned) => owned.address.clone(),
        }
    }

    /// After so many samples it is known what rests on the pad.
    pub(crate) const fn resting_samples(&self) -> u64 {
        match self {
            Self::Twin { .. } => 800,
            // The bridge hears their state at least every 5 ms.
            Self::Owned(_) => 160,
        }
    }

    /// Whether the pad has a clock of its own: else it is the bridge's.
    pub(crate) const fn has_clock(&self) -> bool {
        matches!(self, Self::Twin { .. })
    }

    /// Begins now.
    pub(crate) fn play(&self, segment: &Segment) {
        match self {
            Self::Twin { cue, style, seed, .. } => {
                *cue.lock().unwrap() = Cue { asked: Some(thumb_script(*style, segment, *seed)), begun: None };
            }
            Self::Owned(owned) => {
                *owned.cue.lock().unwrap() = Cue { asked: Some(segment.clone()), begun: None };
            }
        }
    }

    /// When the segment began.
    pub(crate) fn begun(&self) -> Option<Begun> {
        match self {
            Self::Twin { cue, .. } => cue.lock().unwrap().begun,
            Self::Owned(owned) => owned.cue.lock().unwrap().begun,
        }
    }
}
