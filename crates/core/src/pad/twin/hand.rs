//! Finger or indenter that holds the contact, that does not stay quite where it was put.

use super::noise::Lasting;
use crate::pad::device::behaviour::Finger;
use crate::quantity::Contact;
use tactpad_numeric::random::SplitMix64;

/// A finger in time.
#[derive(Clone, Debug)]
pub struct Hand {
    finger: Finger,
    place: [Lasting; 2],
    force: Lasting,
}

impl Hand {
    /// The finger of this seed.
    pub fn new(finger: Finger, seed: u64) -> Self {
        let place = |axis: &str| Lasting::new(SplitMix64::named(seed, axis), finger.wander_time_s);
        let force = Lasting::new(SplitMix64::named(seed, "tremor"), finger.tremor_time_s);
        Self { finger, place: [place("hand x"), place("hand y")], force }
    }

    /// The contact that comes of the meant one, `after_s` after the last. No force stays no force.
    pub fn hold(&mut self, after_s: f64, meant: &Contact) -> Contact {
        let [x_mm, y_mm] =
            self.place.each_mut().map(|axis| (self.finger.wander_mm * axis.next(after_s)) as f32);
        let force = (1.0 + self.finger.tremor_share * self.force.next(after_s)) as f32;
        Contact {
            x_mm: meant.x_mm + x_mm,
            y_mm: meant.y_mm + y_mm,
            fx_n: meant.fx_n * force,
            fy_n: meant.fy_n * force,
            fz_n: meant.fz_n * force,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_wanders_and_trembles_by_as_much_as_is_said() {
        let finger = Finger { wander_mm: 0.4, wander_time_s: 0.5, tremor_share: 0.03, tremor_time_s: 0.2 };
        let meant = Contact { x_mm: 10.0, y_mm: -5.0, fx_n: 1.0, fy_n: 0.0, fz_n: 2.0 };
        let mut hand = Hand::new(finger, 1);
        let held: Vec<Contact> = (0..100_000).map(|_| hand.hold(0.1, &meant)).collect();
        let spread = |of: fn(&Contact) -> f32, mean: f64| {
            (held.iter().map(|contact| (f64::from(of(contact)) - mean).powi(2)).sum::<f64>() / 1e5).sqrt()
        };
        assert!((spread(|contact| contact.x_mm, 10.0) - 0.4).abs() < 0.01);
        assert!((spread(|contact| contact.y_mm, -5.0) - 0.4).abs() < 0.01);
        assert!((spread(|contact| contact.fz_n, 2.0) - 0.06).abs() < 0.002);
        assert!(
            held.iter()
                .all(|contact| contact.fy_n == 0.0 && (contact.fz_n - 2.0 * contact.fx_n).abs() < 1e-6)
        );
    }
}
