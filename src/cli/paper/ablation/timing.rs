//! How long a decode takes. The clock belongs to the live bridge.

use tactpad::lab::ablation::unseen::Unseen;
use tactpad::pipeline::contact::Decoder;

/// Median time of one decode over all unseen contacts, in microseconds.
#[cfg(target_os = "linux")]
pub(super) fn median_us(decoder: &Decoder, unseen: &[Unseen]) -> Option<f64> {
    use tactpad::bridge::clock::Clock;
    use tactpad::bridge::latency::Durations;

    let mut durations = Durations::new();
    let clock = Clock::start();
    for strain in unseen.iter().flat_map(|table| table.strains(decoder)) {
        let begun = clock.now();
        std::hint::black_box(decoder.decode(std::hint::black_box(&strain)));
        durations.record_ns(clock.now().as_ns() - begun.as_ns());
    }
    (!durations.is_empty()).then(|| durations.percentiles().p50)
}

#[cfg(not(target_os = "linux"))]
pub(super) fn median_us(_decoder: &Decoder, _unseen: &[Unseen]) -> Option<f64> {
    None
}
