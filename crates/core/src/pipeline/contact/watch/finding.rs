//! What a stretch of a touch shows by itself: one finger, a channel that cannot be believed, or neither.

use super::super::Decoder;
use super::super::inverse::{ContactFit, FitWithout, Inverse};
use super::super::uncertainty::Noise;
use crate::pipeline::signal::lone::lone_channel;
use crate::quantity::{CHANNELS, Contact, Strain};

/// Chi-square of four numbers that a ten-thousandth exceeds. Ten minutes of play are about 600 presses, and noise that is
/// forgotten after 3 s is drawn anew a few hundred times in them: one false warning in ten such plays.
const MISFIT_MAX: f64 = 23.51;

/// Chi-square of three numbers that a hundredth exceeds: what is left without a channel explains the rest.
const REST_MAX: f64 = 11.34;

/// It does so, too, if it is less than this share of what is left with the channel: no pad is quite as it was calibrated. Two fingers
/// leave as little in one pair of fifty.
const REST_SHARE: f64 = 0.03;

/// The same where nobody presses and a zero is sought: there a finger that has left is held if a channel that is off is not seen, and
/// no second one is lost.
const REST_SHARE_AT_REST: f64 = 0.1;

/// A channel is named if without it the rest is a hundred times as likely as without any other: χ² is lower by 2 ln 100.
const NAMED: f64 = 9.21;

/// A silent channel is named even so, if without another one χ² is lower by less than this: that other one would be off by any amount,
/// which is one number more to choose. (Akaike's 2 for each.)
const SILENCE: f64 = 2.0;

/// A silent channel reads less than so many standard deviations.
const SILENT: f64 = 3.0;

/// One that was thought to be silent and reads more than so many is not: what leaks from other channels is less.
pub(super) const ANSWERS: f64 = 10.0;

/// A channel that is off by more standard deviations than this, …
const STRAY: f64 = 30.0;

/// … and by more than this share of what the others read at the most, reads no finger. Hysteresis, creep and a field that is not quite
/// the pad's are smaller shares of the load; of two fingers, which at times look like one and a channel that is off, less than a
/// hundredth are so far from one.
const STRAY_SHARE: f64 = 0.25;

/// Means over a stretch of time.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mean {
    /// The channels as they were decoded: compensated.
    pub(super) uv: [f64; CHANNELS],
    /// Residual of the contact, µV.
    pub(super) left_uv: [f64; CHANNELS],
    /// The force's magnitude.
    pub(super) force_n: f64,
}

impl Mean {
    /// That of one reading and what was made of it.
    pub(super) fn of(strain: &Strain, fit: &ContactFit) -> Self {
        let Contact { fx_n, fy_n, fz_n, .. } = fit.contact;
        Self {
            uv: strain.uv.map(f64::from),
            left_uv: fit.left_uv,
            force_n: f64::from(libm::hypotf(libm::hypotf(fx_n, fy_n), fz_n)),
        }
    }
}

/// Finding about a stretch of a touch by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Finding {
    /// One finger.
    Fine,
    /// One finger by the other channels, of which this one reads nothing.
    Silent(usize),
    /// One finger by the other channels, and this one is far from what that makes it read.
    Stray(usize),
    /// Not one finger. No channel is the reason, or it does not show which.
    Unexplained,
}

/// One over each channel's variance, if the untouched pad scatters by `scatter_uv2`. What the calibration found at rest holds
/// the scatter of its own readings, so the larger of the two counts.
pub(super) fn weights(inverse: &Inverse, mean: &Mean, scatter_uv2: &[f64; CHANNELS]) -> [f64; CHANNELS] {
    // a ← max(a, √v) in the noise σ² = a² + (b u)² + (c F)² of a channel
    let Noise { additive_uv, .. } = inverse.noise();
    let additive_uv = std::array::from_fn(|k| additive_uv[k].max(libm::sqrt(scatter_uv2[k])));
    Noise { additive_uv, ..*inverse.noise() }.variances(&mean.uv, mean.force_n).weights()
}

/// χ² = Σₖ rₖ² / σₖ²
fn chi_square(left_uv: &[f64; CHANNELS], weights: &[f64; CHANNELS]) -> f64 {
    left_uv.iter().zip(weights).map(|(uv, weight)| weight * uv * uv).sum()
}

/// What the means over a stretch show, with one over each channel's variance.
pub(super) fn judge(inverse: &Inverse, mean: &Mean, weights: &[f64; CHANNELS]) -> Finding {
    if chi_square(&mean.left_uv, weights) <= MISFIT_MAX {
        return Finding::Fine;
    }
    let Some((channel, fit)) = odd_one_out(inverse, mean, weights, REST_SHARE) else {
        return Finding::Unexplained;
    };
    if reads(channel, &mean.uv, weights) < SILENT {
        Finding::Silent(channel)
    } else if is_far_off(inverse, channel, mean, &fit) {
        Finding::Stray(channel)
    } else {
        Finding::Unexplained
    }
}

/// The normal force of a difference of two readings, N, of which one channel may have moved by itself. If it is one finger's but
/// for that channel, then that finger's; else that of all channels, unless a channel moved alone. Decoders that explain nothing know only
/// that.
pub fn load_without_stray_n(decoder: &Decoder, strain: &Strain) -> f32 {
    let plain_n = || {
        // A load above one of four cells reads there alone.
        let is_lone = decoder.channels() == CHANNELS && lone_channel(&strain.uv.map(f64::from)).is_some();
        if is_lone { 0.0 } else { decoder.load_n(strain) }
    };
    let Some(inverse) = decoder.inverse() else { return plain_n() };
    let fit_without_stray = || {
        let mean = Mean::of(strain, &inverse.explain(strain)?);
        let weights = weights(inverse, &mean, &[0.0; CHANNELS]);
        let is_one_finger = chi_square(&mean.left_uv, &weights) <= MISFIT_MAX;
        odd_one_out(inverse, &mean, &weights, REST_SHARE_AT_REST).filter(|_| !is_one_finger)
    };
    fit_without_stray().map_or_else(plain_n, |(_, fit)| fit.force_n[2] as f32)
}

/// Whether so much of the load is left over that it is no finger on a pad that is only not quite as it was calibrated.
pub(super) fn is_far_from_a_finger(mean: &Mean) -> bool {
    let most = |uv: &[f64; CHANNELS]| uv.iter().fold(0.0, |most: f64, uv| most.max(uv.abs()));
    most(&mean.left_uv) > STRAY_SHARE * most(&mean.uv)
}

/// The channel without which one finger explains the others but for `rest_share` of what is left with it, and what that finger is; if it
/// shows which channel that is.
fn odd_one_out(
    inverse: &Inverse,
    mean: &Mean,
    weights: &[f64; CHANNELS],
    rest_share: f64,
) -> Option<(usize, FitWithout)> {
    let Mean { uv, left_uv, .. } = mean;
    // χ² of the others at their own best contact, which has one degree of freedom less.
    let fits: [_; CHANNELS] = std::array::from_fn(|channel| inverse.without(channel, uv, weights));
    let misfit = |channel: usize| fits[channel].map_or(f64::INFINITY, |fit| fit.misfit);
    let least = |is_asked: &dyn Fn(usize) -> bool| {
        let channels = (0..CHANNELS).filter(|channel| is_asked(*channel));
        channels.min_by(|one, other| misfit(*one).total_cmp(&misfit(*other)))
    };
    let rest_max = REST_MAX.max(rest_share * chi_square(left_uv, weights));
    let best = least(&|_| true).filter(|channel| misfit(*channel) < rest_max)?;
    let silent = least(&|channel| reads(channel, uv, weights) < SILENT)
        .filter(|channel| misfit(*channel) < REST_MAX.min(misfit(best) + SILENCE));
    let next = least(&|channel| channel != best)?;
    // By so much as the rest is more than noise, differences say less.
    let excess = (misfit(best) / REST_MAX).max(1.0);
    let named = silent.or((misfit(next) - misfit(best) > NAMED * excess).then_some(best))?;
    Some((named, fits[named]?))
}

/// Whether the channel is far from what the others' contact makes it read.
fn is_far_off(inverse: &Inverse, channel: usize, mean: &Mean, fit: &FitWithout) -> bool {
    // By the variance that it would have: its own share would hide how far off it is.
    let mut expected_uv = mean.uv;
    expected_uv[channel] = fit.expected_uv;
    let [fx_n, fy_n, fz_n] = fit.force_n;
    let force_n = libm::hypot(libm::hypot(fx_n, fy_n), fz_n);
    let weights = inverse.noise().variances(&expected_uv, force_n).weights();
    let most_uv = expected_uv.iter().fold(0.0, |most: f64, uv| most.max(uv.abs()));
    let off_uv = (mean.uv[channel] - fit.expected_uv).abs();
    off_uv * libm::sqrt(weights[channel]) > STRAY && off_uv > STRAY_SHARE * most_uv
}

/// How far a channel is from reading nothing, in standard deviations.
pub(super) fn reads(channel: usize, uv: &[f64; CHANNELS], weights: &[f64; CHANNELS]) -> f64 {
    // |u| / σ
    uv[channel].abs() * libm::sqrt(weights[channel])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pad::field::PadField;
    use crate::pad::influence::InfluenceField;
    use crate::pipeline::shipped;
    use tactpad_numeric::random::SplitMix64;

    /// Contacts of so many fingers anywhere, as the channels read them.
    fn pressed(field: &InfluenceField, random: &mut SplitMix64, fingers: usize) -> [f64; CHANNELS] {
        let mut between = |low: f32, high: f32| low + (high - low) * random.fraction();
        let mut uv = [0.0; CHANNELS];
        for _ in 0..fingers {
            let (radius_mm, turn) = (25.0 * between(0.0, 1.0).sqrt(), between(0.0, std::f32::consts::TAU));
            let fz_n = between(0.5, 3.0);
            let contact = Contact {
                x_mm: radius_mm * libm::cosf(turn),
                y_mm: radius_mm * libm::sinf(turn),
                fx_n: fz_n * between(-0.3, 0.3),
                fy_n: fz_n * between(-0.3, 0.3),
                fz_n,
            };
            uv.iter_mut().zip(field.strain_uv(&contact).uv).for_each(|(sum, uv)| *sum += f64::from(uv));
        }
        uv
    }

    fn found(inverse: &Inverse, uv: &[f64; CHANNELS]) -> Finding {
        let strain = Strain { uv: uv.map(|uv| uv as f32) };
        let mean = Mean::of(&strain, &inverse.explain(&strain).unwrap());
        judge(inverse, &mean, &weights(inverse, &mean, &[0.0; CHANNELS]))
    }

    fn decoders() -> [Inverse; 2] {
        let noise = Noise::of_channels([5.0; CHANNELS], [0.02; CHANNELS]);
        let calibrated = Inverse::new(PadField::nominal().signals, noise);
        [calibrated, shipped::decoder().inverse().unwrap().clone()]
    }

    /// How many of so many contacts of `fingers`, changed so, are found to be `is_it`.
    fn share(
        inverse: &Inverse,
        fingers: usize,
        change: impl Fn(&mut [f64; CHANNELS], usize),
        is_it: impl Fn(Finding, usize) -> bool,
    ) -> f64 {
        let (mut random, count) = (SplitMix64::new(77), 450);
        let found = (0..count).filter(|number| {
            let mut uv = pressed(inverse.field(), &mut random, fingers);
            change(&mut uv, number % CHANNELS);
            is_it(found(inverse, &uv), number % CHANNELS)
        });
        found.count() as f64 / f64::from(count as u32)
    }

    #[test]
    fn two_fingers_seldom_pass_for_a_channel_that_is_off() {
        for inverse in decoders() {
            let is_off = |finding, _| matches!(finding, Finding::Stray(_) | Finding::Silent(_));
            let lost = share(&inverse, 2, |_, _| (), |finding, _| matches!(finding, Finding::Stray(_)));
            let named = share(&inverse, 2, |_, _| (), is_off);
            assert!(lost <= 0.02 && named <= 0.03, "{lost} {named}");
        }
    }

    #[test]
    fn fingers_are_no_pull_even_on_channels_of_other_gains() {
        for inverse in decoders() {
            let (decoder, mut random) = (Decoder::from(inverse.clone()), SplitMix64::new(9));
            for number in 0..3_000 {
                let uv = pressed(inverse.field(), &mut random, 1 + number % 3);
                let strain = Strain { uv: uv.map(|uv| uv as f32 * (1.0 + 0.5 * random.uniform())) };
                let load_n = load_without_stray_n(&decoder, &strain);
                assert!(load_n > -0.1, "{load_n} N by {strain:?}");
            }
        }
    }

    #[test]
    fn a_load_is_known_whatever_one_channel_reads() {
        for inverse in decoders() {
            let (decoder, mut random) = (Decoder::from(inverse.clone()), SplitMix64::new(3));
            let (count, sign) = (1_000, |number: usize| if number.is_multiple_of(2) { 1.0 } else { -1.0 });
            let known = (0..count).filter(|&number| {
                let uv = pressed(inverse.field(), &mut random, 1);
                let mut strain = Strain { uv: uv.map(|uv| sign(number) * uv as f32) };
                let load_n = decoder.load_n(&strain);
                strain.uv[number % CHANNELS] = 20_000.0 * random.uniform();
                (load_without_stray_n(&decoder, &strain) - load_n).abs() < 0.3 * load_n.abs()
            });
            let known = known.count();
            assert!(known > count * 95 / 100, "{known} of {count}");
        }
    }

    #[test]
    fn a_channel_at_a_rail_is_found_under_a_finger() {
        for inverse in decoders() {
            for rail_uv in [15_000.0, -15_000.0] {
                let rail = |uv: &mut [f64; CHANNELS], channel: usize| uv[channel] = rail_uv;
                let pressed = share(&inverse, 1, rail, |finding, channel| finding == Finding::Stray(channel));
                assert!(pressed > 0.95, "{pressed}");
            }
        }
    }
}
