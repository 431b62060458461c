//! Sums over contacts of what channels read, of the strains that they should have, and of all products.

use tactpad_core::quantity::CHANNELS;
use tactpad_numeric::linear::Factor;

/// Strains first, then readings.
const VARIABLES: usize = 2 * CHANNELS;

/// Makes correlations of strains that go together have a factor.
const RIDGE: f64 = 1e-6;

/// First and second moments of strains and readings.
#[derive(Clone, Debug)]
pub(crate) struct Moments {
    count: f64,
    /// The first contact's values: sums are of the differences to it, so that no offset takes their digits.
    origin: [f64; VARIABLES],
    sums: [f64; VARIABLES],
    products: [[f64; VARIABLES]; VARIABLES],
}

impl Default for Moments {
    fn default() -> Self {
        let zeros = [0.0; VARIABLES];
        Self { count: 0.0, origin: zeros, sums: zeros, products: [zeros; VARIABLES] }
    }
}

impl Moments {
    /// Takes a contact.
    pub(crate) fn add(&mut self, strain_uv: [f64; CHANNELS], read_uv: [f64; CHANNELS]) {
        let at = |variable: usize| {
            if variable < CHANNELS { strain_uv[variable] } else { read_uv[variable - CHANNELS] }
        };
        if self.count == 0.0 {
            self.origin = std::array::from_fn(at);
        }
        self.count += 1.0;
        let values: [f64; VARIABLES] = std::array::from_fn(|variable| at(variable) - self.origin[variable]);
        for (value, (sum, products)) in values.iter().zip(self.sums.iter_mut().zip(&mut self.products)) {
            *sum += value;
            products.iter_mut().zip(&values).for_each(|(product, other)| *product += value * other);
        }
    }

    pub(crate) const fn count(&self) -> f64 {
        self.count
    }

    fn covariance(&self, one: usize, other: usize) -> f64 {
        let count = self.count.max(1.0);
        self.products[one][other] / count - self.sums[one] / count * (self.sums[other] / count)
    }

    fn variance(&self, variable: usize) -> f64 {
        self.covariance(variable, variable).max(0.0)
    }

    /// 0 where one of them never changes.
    fn correlation_of(&self, one: usize, other: usize) -> f64 {
        let scale = (self.variance(one) * self.variance(other)).sqrt();
        if scale > 0.0 { (self.covariance(one, other) / scale).clamp(-1.0, 1.0) } else { 0.0 }
    }

    /// Of a channel's strains, µV².
    pub(crate) fn strain_variance(&self, channel: usize) -> f64 {
        self.variance(channel)
    }

    /// Of what a channel reads, µV².
    pub(crate) fn reading_variance(&self, channel: usize) -> f64 {
        self.variance(CHANNELS + channel)
    }

    /// Between what a channel reads and the strains of one.
    pub(crate) fn correlation(&self, channel: usize, strain: usize) -> f64 {
        self.correlation_of(CHANNELS + channel, strain)
    }

    /// Share of a channel's variance that a linear function of all nine strains explains, R² = rᵀ ρ⁻¹ r.
    pub(crate) fn explained(&self, channel: usize) -> f64 {
        let strains: [[f64; CHANNELS]; CHANNELS] = std::array::from_fn(|k| {
            std::array::from_fn(|l| if k == l { 1.0 + RIDGE } else { self.correlation_of_strains(k, l) })
        });
        let half = Factor::of(&strains).map(|factor| {
            factor.solve_lower(&std::array::from_fn(|strain| self.correlation(channel, strain)))
        });
        half.map_or(0.0, |half| half.iter().map(|it| it * it).sum::<f64>().min(1.0))
    }

    /// Between the strains of two channels.
    pub(crate) fn correlation_of_strains(&self, one: usize, other: usize) -> f64 {
        self.correlation_of(one, other)
    }

    /// Between what two channels read.
    pub(crate) fn correlation_of_readings(&self, one: usize, other: usize) -> f64 {
        self.correlation_of(CHANNELS + one, CHANNELS + other)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlations_survive_offsets_and_constants_have_none() {
        let mut moments = Moments::default();
        for step in 0..50 {
            let value = f64::from(step % 7);
            let read_uv = std::array::from_fn(|k| if k == 0 { 1e8 - 2.0 * value } else { 1e8 });
            moments.add([value; CHANNELS], read_uv);
        }
        assert!((moments.explained(0) - 1.0).abs() < 1e-3 && moments.explained(1) == 0.0);
        assert!((moments.correlation(0, 4) + 1.0).abs() < 1e-9);
        assert!((moments.reading_variance(0) / moments.strain_variance(0) - 4.0).abs() < 1e-9);
        assert_eq!((moments.reading_variance(1), moments.correlation(1, 4)), (0.0, 0.0));
        assert_eq!(moments.correlation_of_readings(0, 1), 0.0);
        assert!((moments.correlation_of_strains(0, 8) - 1.0).abs() < 1e-9);
    }
}
