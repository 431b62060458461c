//! The balance of forces on a plate that stands on load cells, or on one sensor of six axes.
//!
//! Each channel is one linear measure of the load, so the force and its moments are sums of channels: `Fz = Σ g u`,
//! `x Fz = Σ g x u` over cells at places x with gains g. The place is a moment over the force. There is nothing to train.
//! With cells that are stiff beside the plate this is exact, whatever the plate is made of.

use super::statics::FORCE_RESOLUTION_N;
use super::uncertainty::{Covariance, Estimate, UNKNOWNS};
use crate::pipeline::signal::Scale;
use crate::quantity::{CHANNELS, Contact, Strain};

/// Radius of the plate that profiles are made for, mm. No contact is farther out.
pub const PLATE_RADIUS_MM: f64 = 30.0;

/// What a channel reads for a newton on the plate, µV: about what the disc's normal channels read, so that what is known of
/// rest, drift and faults of channels holds here, too.
pub const UV_PER_N: f64 = 1_000.0;

/// Balance of forces of a pad with fewer than nine channels.
#[derive(Clone, Debug, PartialEq)]
pub struct Balance {
    channels: usize,
    scale: Scale,
    /// Fx, Fy, Fz in N and x Fz, y Fz in N mm, each by the channels in µV.
    rows: [[f64; CHANNELS]; ROWS],
    /// Standard deviation of each channel, µV.
    noise_uv: f64,
    has_shear: bool,
    is_clamped: bool,
    standing_n: Option<f32>,
}

const ROWS: usize = 5;
const FZ: usize = 2;

/// What the channels of a pad measure.
#[derive(Clone, Debug, PartialEq)]
pub struct BalanceNumbers {
    /// Newtons on the plate per count, of a channel with gain 1.
    pub n_per_count: f64,
    /// Bits of a count.
    pub count_bits: u8,
    /// For each channel by how much Fx, Fy, Fz (in N) and x Fz, y Fz (in N mm) grow per newton that it reads.
    pub channels: Vec<[f64; ROWS]>,
    /// Standard deviation of a channel, N on the plate.
    pub noise_n: f64,
    /// Whether 0 is the least that a channel tells, whatever it would read below.
    pub is_clamped: bool,
    /// What the weight of who stands on the pad is for a profile, N; `None` where forces are absolute.
    pub standing_n: Option<f64>,
}

impl Balance {
    /// A decoder of one to eight channels; `None` for another number of them, and for numbers that are not finite.
    pub fn new(numbers: &BalanceNumbers) -> Option<Self> {
        let BalanceNumbers { n_per_count, count_bits, channels, noise_n, is_clamped, standing_n } = numbers;
        let all = channels.as_flattened().iter().chain([n_per_count, noise_n]).chain(standing_n);
        let is_sound = (1..CHANNELS).contains(&channels.len()) && { all }.all(|number| number.is_finite());
        let mut rows = [[0.0; CHANNELS]; ROWS];
        for (k, channel) in channels.iter().enumerate().take(CHANNELS) {
            for (row, per_n) in rows.iter_mut().zip(channel) {
                row[k] = per_n / UV_PER_N;
            }
        }
        is_sound.then(|| Self {
            channels: channels.len(),
            scale: Scale { uv_per_count: n_per_count * UV_PER_N, count_bits: *count_bits },
            noise_uv: noise_n * UV_PER_N,
            has_shear: rows.iter().take(FZ).flatten().any(|per_uv| *per_uv != 0.0),
            is_clamped: *is_clamped,
            standing_n: standing_n.map(|n| n as f32),
            rows,
        })
    }

    /// Whether 0 is the least that a channel tells, whatever it would read below.
    pub const fn is_clamped(&self) -> bool {
        self.is_clamped
    }

    /// Number of channels.
    pub const fn channels(&self) -> usize {
        self.channels
    }

    /// Scale of a count.
    pub const fn scale(&self) -> Scale {
        self.scale
    }

    /// Whether it measures forces along the plate.
    pub const fn has_shear(&self) -> bool {
        self.has_shear
    }

    /// What the weight of who stands on the pad is for a profile, N, where forces are relative to it.
    pub const fn standing_n(&self) -> Option<f32> {
        self.standing_n
    }

    /// The force into the plate, N; negative for a pull.
    pub fn load_n(&self, strain: &Strain) -> f32 {
        self.sums(strain)[FZ] as f32
    }

    /// The contact that balances the channels. A force into the plate within ±[`FORCE_RESOLUTION_N`] has no place and reads as the
    /// centre; a place beyond the plate is moved to its rim. Strain that is not finite is no contact (all zero).
    pub fn decode(&self, strain: &Strain) -> Contact {
        let [fx_n, fy_n, fz_n, x_fz, y_fz] = self.sums(strain);
        let [x_mm, y_mm] = place_mm(x_fz, y_fz, fz_n);
        let contact = [x_mm, y_mm, fx_n, fy_n, fz_n].map(|number| number as f32);
        match contact {
            [x_mm, y_mm, fx_n, fy_n, fz_n] if contact.iter().all(|number| number.is_finite()) => {
                Contact { x_mm, y_mm, fx_n, fy_n, fz_n }
            }
            _ => Contact::default(),
        }
    }

    /// The same with its covariance by the channels' noise: that of the place grows as the force falls.
    pub fn estimate(&self, strain: &Strain) -> Option<Estimate> {
        let contact = self.decode(strain);
        let fz_n = f64::from(contact.fz_n);
        if fz_n.abs() < f64::from(FORCE_RESOLUTION_N) {
            return None;
        }
        let place_mm = [contact.x_mm, contact.y_mm].map(f64::from);
        // x = (x Fz) / Fz, so dx = (d(x Fz) − x dFz) / Fz.
        let response = |unknown: usize, k: usize| match unknown {
            0 | 1 => (self.rows[3 + unknown][k] - place_mm[unknown] * self.rows[FZ][k]) / fz_n,
            force => self.rows[force - 2][k],
        };
        let covariance: Covariance = std::array::from_fn(|i| {
            std::array::from_fn(|j| {
                let products = (0..self.channels).map(|k| response(i, k) * response(j, k));
                self.noise_uv * self.noise_uv * products.sum::<f64>()
            })
        });
        const { assert!(UNKNOWNS == ROWS) };
        Some(Estimate { contact, covariance, misfit: 0.0 })
    }

    fn sums(&self, strain: &Strain) -> [f64; ROWS] {
        self.rows.map(|row| row.iter().zip(&strain.uv).map(|(per_uv, uv)| per_uv * f64::from(*uv)).sum())
    }
}

/// The place of a force with these moments about the centre.
fn place_mm(x_fz: f64, y_fz: f64, fz_n: f64) -> [f64; 2] {
    if fz_n.abs() < f64::from(FORCE_RESOLUTION_N) {
        return [0.0; 2];
    }
    on_plate([x_fz / fz_n, y_fz / fz_n])
}

/// The nearest place on the plate along the ray from its centre.
pub fn on_plate([x_mm, y_mm]: [f64; 2]) -> [f64; 2] {
    let inward = PLATE_RADIUS_MM / libm::hypot(x_mm, y_mm);
    if inward < 1.0 { [x_mm * inward, y_mm * inward] } else { [x_mm, y_mm] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Cells at the corners of a square of 40 mm.
    const CORNERS_MM: [[f64; 2]; 4] = [[-20.0, 20.0], [20.0, 20.0], [-20.0, -20.0], [20.0, -20.0]];

    fn cells() -> Balance {
        let channels = CORNERS_MM.map(|[x_mm, y_mm]| [0.0, 0.0, 1.0, x_mm, y_mm]).to_vec();
        Balance::new(&BalanceNumbers {
            n_per_count: 1e-3,
            count_bits: 32,
            channels,
            noise_n: 0.01,
            is_clamped: false,
            standing_n: None,
        })
        .unwrap()
    }

    /// What stiff cells read of a force at a place.
    fn read(fz_n: f64, [x_mm, y_mm]: [f64; 2]) -> Strain {
        let mut strain = Strain::default();
        for (uv, [cell_x, cell_y]) in strain.uv.iter_mut().zip(CORNERS_MM) {
            let share = (1.0 + x_mm * cell_x / 400.0 + y_mm * cell_y / 400.0) / 4.0;
            *uv = (share * fz_n * UV_PER_N) as f32;
        }
        strain
    }

    #[test]
    fn a_force_on_four_cells_is_found_where_it_is() {
        for (fz_n, at_mm) in [(2.0, [0.0, 0.0]), (0.5, [12.0, -7.0]), (5.0, [-18.0, 3.0])] {
            let found = cells().decode(&read(fz_n, at_mm));
            let near = |a: f32, b: f64| (f64::from(a) - b).abs() < 1e-3;
            assert!(
                near(found.x_mm, at_mm[0]) && near(found.y_mm, at_mm[1]) && near(found.fz_n, fz_n),
                "{found:?}"
            );
            assert_eq!((found.fx_n, found.fy_n), (0.0, 0.0));
        }
        assert!(!cells().has_shear());
    }

    #[test]
    fn without_force_there_is_no_place_and_nonsense_is_nothing() {
        assert_eq!(cells().decode(&Strain::default()), Contact::default());
        let far = cells().decode(&read(1.0, [90.0, 0.0]));
        assert!((far.x_mm - 30.0).abs() < 1e-3, "{far:?}");
        for uv in [f32::NAN, f32::INFINITY, f32::MAX] {
            let mut strain = read(1.0, [0.0; 2]);
            strain.uv[2] = uv;
            let Contact { x_mm, y_mm, fz_n, .. } = cells().decode(&strain);
            assert!(x_mm.is_finite() && y_mm.is_finite() && fz_n.is_finite(), "{uv}");
        }
        assert_eq!(cells().estimate(&Strain::default()), None);
    }

    #[test]
    fn the_place_is_less_sure_the_less_it_presses() {
        let deviation_mm = |fz_n| cells().estimate(&read(fz_n, [5.0, 0.0])).unwrap().covariance[0][0].sqrt();
        let [light, firm] = [0.5, 5.0].map(deviation_mm);
        assert!((light / firm - 10.0).abs() < 1e-3, "{light} {firm}");
        // Four cells 20 mm from the middle, each off by 0.01 N: 2 · 20 mm · 0.01 N, and 2 · 5 mm · 0.01 N for the sum.
        let by_hand = (0.4_f64.powi(2) + 0.1_f64.powi(2)).sqrt() / 5.0;
        assert!((firm - by_hand).abs() < 1e-3, "{firm} {by_hand}");
    }

    #[test]
    fn numbers_that_give_no_contact_are_refused() {
        let one = BalanceNumbers {
            n_per_count: 1.0,
            count_bits: 32,
            channels: vec![[0.0, 0.0, 1.0, 0.0, 0.0]],
            noise_n: 0.0,
            is_clamped: false,
            standing_n: None,
        };
        assert!(Balance::new(&one).is_some());
        assert!(Balance::new(&BalanceNumbers { n_per_count: f64::NAN, ..one.clone() }).is_none());
        for channels in [Vec::new(), vec![[1.0; 5]; 9]] {
            assert!(Balance::new(&BalanceNumbers { channels, ..one.clone() }).is_none());
        }
    }
}
