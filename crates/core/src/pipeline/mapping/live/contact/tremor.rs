//! A low-pass for hands that tremble: calm where the finger rests, quick where it moves.
//!
//! ```text
//! v̂ += a(f_v) (Δx/Δt − v̂)        f = f₀ + β |v̂|        x̂ += a(f) (x − x̂)        a(f) = 1/(1 + 1/(2π f Δt))
//! ```
//!
//! Source: G. Casiez, N. Roussel, D. Vogel, "1 € filter", Proc. CHI 2012, 2527.

use crate::pipeline::mapping::profile::Tremor;
use crate::quantity::Contact;
use crate::time::StreamInstant;

/// f_v: cutoff of the speed.
const SPEED_CUTOFF_HZ: f32 = 1.0;

/// The filter's state since a contact began.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TremorFilter {
    t: StreamInstant,
    raw_mm: [f32; 2],
    place_mm: [f32; 2],
    speed_mm_per_s: [f32; 2],
}

impl TremorFilter {
    /// The contact with its place calmed; a new one begins where it is.
    pub(crate) fn step(
        state: &mut Option<Self>,
        tremor: &Tremor,
        t: StreamInstant,
        contact: &Contact,
    ) -> Contact {
        let raw_mm = [contact.x_mm, contact.y_mm];
        let begun = Self { t, raw_mm, place_mm: raw_mm, speed_mm_per_s: [0.0; 2] };
        let mut calm = state.unwrap_or(begun);
        let dt_s = t.us_since(calm.t) as f32 * 1e-6;
        if dt_s > 0.0 {
            calm.follow(tremor, raw_mm, dt_s);
            calm.t = t;
        }
        *state = Some(calm);
        let [x_mm, y_mm] = calm.place_mm;
        Contact { x_mm, y_mm, ..*contact }
    }

    fn follow(&mut self, tremor: &Tremor, raw_mm: [f32; 2], dt_s: f32) {
        let a = share(SPEED_CUTOFF_HZ, dt_s);
        for ((speed, now), before) in self.speed_mm_per_s.iter_mut().zip(raw_mm).zip(self.raw_mm) {
            *speed += a * ((now - before) / dt_s - *speed);
        }
        let [vx, vy] = self.speed_mm_per_s;
        let a = share(tremor.cutoff_hz + tremor.per_mm * libm::hypotf(vx, vy), dt_s);
        for (place, now) in self.place_mm.iter_mut().zip(raw_mm) {
            *place += a * (now - *place);
        }
        self.raw_mm = raw_mm;
    }
}

/// a(f): the share of the way that a low-pass goes within Δt.
fn share(cutoff_hz: f32, dt_s: f32) -> f32 {
    let turns = core::f32::consts::TAU * cutoff_hz * dt_s;
    turns / (turns + 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TREMOR: Tremor = Tremor { cutoff_hz: 1.0, per_mm: 0.05 };

    /// Where the filter is after each millisecond of these places.
    fn calmed(x_mm: impl Fn(f32) -> f32, ms: u64) -> Vec<f32> {
        let mut state = None;
        let at = |ms: u64| Contact { x_mm: x_mm(ms as f32 * 1e-3), ..Contact::default() };
        (0..ms)
            .map(|ms| {
                TremorFilter::step(&mut state, &TREMOR, StreamInstant::from_us(1_000 * ms), &at(ms)).x_mm
            })
            .collect()
    }

    #[test]
    fn a_tremor_of_six_hertz_is_a_third_or_less() {
        // 1.5 mm rms.
        let tremor = |t_s: f32| 2.12 * libm::sinf(core::f32::consts::TAU * 6.0 * t_s);
        let calm = calmed(tremor, 4_000);
        let rms = (calm[2_000..].iter().map(|x| x * x).sum::<f32>() / 2_000.0).sqrt();
        assert!(rms < 0.5, "{rms} mm");
    }

    #[test]
    fn a_swift_move_arrives_soon_and_a_rest_where_it_is() {
        let step = calmed(|t_s| if t_s < 0.1 { 0.0 } else { 20.0 }, 1_500);
        assert_eq!(step[99], 0.0);
        assert!(step[250] > 15.0, "{} mm after 150 ms", step[250]);
        assert!((step[1_499] - 20.0).abs() < 0.1, "{}", step[1_499]);
    }

    #[test]
    fn time_that_stands_still_moves_nothing() {
        let mut state = None;
        let at = |x_mm| Contact { x_mm, ..Contact::default() };
        let t = StreamInstant::from_us(5);
        assert_eq!(TremorFilter::step(&mut state, &TREMOR, t, &at(1.0)).x_mm, 1.0);
        assert_eq!(TremorFilter::step(&mut state, &TREMOR, t, &at(9.0)).x_mm, 1.0);
    }
}
