//! Fitting a network to examples: mini-batches, Adam, the weights that do best on examples that are not learnt from.
//!
//! Two threads share each batch, in the same way on every machine: nothing depends on the number of processors.

mod adam;
mod gradient;
mod parameters;
mod product;
pub mod score;

use self::adam::Adam;
use self::gradient::{Batch, Pass};
use self::parameters::Shape;
use self::score::Score;
use super::{Example, Network, OUTPUTS};
use tactpad_numeric::random::SplitMix64;
use tactpad_numeric::statistics;

/// Hyperparameters of training.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Schedule {
    /// Adam's step.
    pub rate: f32,
    /// Examples between two steps.
    pub batch: usize,
    /// Most times that all examples are seen.
    pub epochs_max: usize,
    /// Epochs without a better one after which training stops.
    pub patience: usize,
    /// The paper's β: each parameter is drawn to where it began, by β times the squared distance (L2-SP). Zero lets it go.
    pub beta: f32,
    /// Draws the order of the examples.
    pub seed: u64,
}

/// Losses after an epoch: means over the five standardised numbers.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Epoch {
    /// From 1.
    pub number: usize,
    /// Mean squared error on the examples that are learnt from, while they are.
    pub training_mse: f64,
    /// On those that are not, after it.
    pub validation_mse: f64,
    /// Mean magnitude of the errors there.
    pub validation_mae: f64,
    /// R² there, the mean of the five numbers'. Without a number where one of them is the same in all examples.
    pub validation_r2: f64,
}

/// A trained network.
#[derive(Clone, Debug, PartialEq)]
pub struct Trained {
    /// With the weights that did best on the validation's examples: those of an epoch, or the ones before the first.
    pub network: Network,
    /// Its mean squared error there.
    pub validation_mse: f64,
    /// All epochs.
    pub curve: Vec<Epoch>,
}

/// Trains `start`, whose scalers stay. `report` hears of each epoch.
///
/// The same call gives the same network, bit by bit, on every machine. Without examples on either side nothing is learnt.
pub fn train(
    start: &Network,
    training: &[Example],
    validation: &[Example],
    schedule: &Schedule,
    mut report: impl FnMut(&Epoch),
) -> Trained {
    let shape = Shape::of(start);
    let anchor = shape.pack(start);
    let mut trainer = Trainer::new(&shape, &anchor, schedule);
    let (training, validation) = (standardised(start, training), standardised(start, validation));
    let variances = std::array::from_fn(|k| {
        let values: Vec<f64> = validation.iter().map(|example| f64::from(example.contact[k])).collect();
        statistics::population_deviation(&values).powi(2)
    });
    let mut best = (trainer.score(&validation, &variances).mse, anchor.clone(), 0);
    let mut curve = Vec::new();
    for number in 1..=schedule.epochs_max {
        if training.is_empty() || validation.is_empty() || number > best.2 + schedule.patience {
            break;
        }
        let training_mse = trainer.epoch(&training, &anchor);
        let Score { mse: validation_mse, mae: validation_mae, r2: validation_r2 } =
            trainer.score(&validation, &variances);
        let epoch = Epoch { number, training_mse, validation_mse, validation_mae, validation_r2 };
        if epoch.validation_mse < best.0 {
            best = (epoch.validation_mse, trainer.parameters.clone(), number);
        }
        report(&epoch);
        curve.push(epoch);
    }
    Trained { network: shape.unpack(&best.1, start), validation_mse: best.0, curve }
}

/// Divides examples by chance: the first has a `part`-th of them, rounded down.
pub fn split(mut examples: Vec<Example>, part: usize, seed: u64) -> [Vec<Example>; 2] {
    SplitMix64::named(seed, "split").shuffle(&mut examples);
    let rest = examples.split_off(examples.len() / part.max(1));
    [examples, rest]
}

fn standardised(network: &Network, examples: &[Example]) -> Vec<Example> {
    let scaled = |example: &Example| Example {
        uv: network.input.scaled(&example.uv),
        contact: network.output.scaled(&example.contact),
    };
    examples.iter().map(scaled).collect()
}

/// Parts of a batch that are worked on at once, each by a thread if there are enough. Their number is fixed, so that
/// sums are taken in one order whatever the machine has.
const LANES: usize = 2;

/// The parameters θ while they are learnt.
struct Trainer {
    schedule: Schedule,
    parameters: Vec<f32>,
    adam: Adam,
    lanes: [Lane; LANES],
    random: SplitMix64,
}

/// One part of a batch.
#[derive(Clone)]
struct Lane {
    batch: Batch,
    pass: Pass,
    /// Of the sum of the part's squared errors.
    gradient: Vec<f32>,
    square: f64,
    errors: Errors,
}

/// Sums of errors, number by number.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    squares: [f64; OUTPUTS],
    magnitudes: [f64; OUTPUTS],
}

impl Trainer {
    fn new(shape: &Shape, anchor: &[f32], schedule: &Schedule) -> Self {
        let lane = Lane {
            batch: Batch::empty(shape),
            pass: Pass::new(shape),
            gradient: vec![0.0; anchor.len()],
            square: 0.0,
            errors: Errors::default(),
        };
        Self {
            schedule: Schedule { batch: schedule.batch.max(1), ..*schedule },
            parameters: anchor.to_vec(),
            adam: Adam::new(schedule.rate, anchor.len()),
            lanes: std::array::from_fn(|_| lane.clone()),
            random: SplitMix64::named(schedule.seed, "order"),
        }
    }

    /// Learns once from every example, in an order of its own; gives the mean squared error meanwhile.
    fn epoch(&mut self, examples: &[Example], anchor: &[f32]) -> f64 {
        let mut order: Vec<&Example> = examples.iter().collect();
        self.random.shuffle(&mut order);
        let mut square = 0.0;
        for examples in order.chunks(self.schedule.batch) {
            square += self.spread(examples, Lane::learn);
            self.descend(anchor, examples.len());
        }
        // Mean over examples and outputs.
        square / (examples.len() * OUTPUTS) as f64
    }

    /// Gives each lane its part of the examples and some work; the sum of their squared errors comes back.
    fn spread(&mut self, examples: &[&Example], work: impl Fn(&mut Lane, &[f32], &[&Example]) + Sync) -> f64 {
        let (left, right) = examples.split_at(examples.len().div_ceil(LANES));
        let [one, other] = &mut self.lanes;
        let parameters = &self.parameters;
        rayon::join(|| work(one, parameters, left), || work(other, parameters, right));
        self.lanes.iter().map(|lane| lane.square).sum()
    }

    /// Steps against the gradient of the batch's loss, (1/n) Σ |error|² + β |θ − θ₀|², with `anchor` θ₀ (L2-SP).
    fn descend(&mut self, anchor: &[f32], count: usize) {
        // g ← (1/n) (g₁ + g₂) + 2β (θ − θ₀), with the lanes' gradients g₁ and g₂.
        let (share, pull) = (1.0 / count as f32, 2.0 * self.schedule.beta);
        let [one, other] = &mut self.lanes;
        let distances = self.parameters.iter().zip(anchor).map(|(parameter, anchor)| parameter - anchor);
        for ((slope, other), distance) in one.gradient.iter_mut().zip(&other.gradient).zip(distances) {
            *slope = share * (*slope + other) + pull * distance;
        }
        self.adam.step(&mut self.parameters, &one.gradient);
    }

    /// Errors on examples whose numbers have these variances; without examples the mean square is infinite.
    fn score(&mut self, examples: &[Example], variances: &[f64; OUTPUTS]) -> Score {
        let examples: Vec<&Example> = examples.iter().collect();
        self.lanes.iter_mut().for_each(|lane| lane.errors = Errors::default());
        let parts = examples.chunks(self.schedule.batch);
        let square: f64 = parts.map(|examples| self.spread(examples, Lane::judge)).sum();
        let sums = |of: fn(&Errors) -> [f64; OUTPUTS]| -> [f64; OUTPUTS] {
            let [one, other] = self.lanes.each_ref().map(|lane| of(&lane.errors));
            std::array::from_fn(|k| one[k] + other[k])
        };
        let (count, values) = (examples.len() as f64, (examples.len() * OUTPUTS) as f64);
        // R² = 1 − mean squared error/variance, of each number.
        let explained = sums(|errors| errors.squares).into_iter().zip(variances);
        let r2 = statistics::mean(explained.map(|(square, variance)| 1.0 - square / count / variance));
        let mae = sums(|errors| errors.magnitudes).iter().sum::<f64>() / values;
        Score { mse: if examples.is_empty() { f64::INFINITY } else { square / values }, mae, r2 }
    }
}

impl Lane {
    fn compare(&mut self, parameters: &[f32], examples: &[&Example]) {
        self.batch.fill(examples);
        self.square = self.pass.forward(parameters, &self.batch);
    }

    /// Compares, and adds up the errors of each number.
    fn judge(&mut self, parameters: &[f32], examples: &[&Example]) {
        self.compare(parameters, examples);
        for row in self.pass.errors(&self.batch) {
            for (k, error) in row.iter().take(OUTPUTS).map(|error| f64::from(*error)).enumerate() {
                self.errors.squares[k] += error * error;
                self.errors.magnitudes[k] += error.abs();
            }
        }
    }

    fn learn(&mut self, parameters: &[f32], examples: &[&Example]) {
        self.compare(parameters, examples);
        self.pass.backward(parameters, &mut self.gradient);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::network::training::score::Scores;
    use crate::network::{Zero, numbers};
    use crate::quantity::{CHANNELS, Contact};

    const SCHEDULE: Schedule =
        Schedule { rate: 1e-3, batch: 32, epochs_max: 60, patience: 60, beta: 0.0, seed: 3 };

    /// Contacts as a pad would read them whose channels are simple products and sums.
    fn examples(count: usize, seed: u64) -> Vec<Example> {
        let mut random = SplitMix64::new(seed);
        let mut draw = || {
            let [x_mm, y_mm] = [0; 2].map(|_| 20.0 * random.uniform());
            let [fx_n, fy_n, fz_n] = [0; 3].map(|_| 3.0 + 2.0 * random.uniform());
            let contact = Contact { x_mm, y_mm, fx_n, fy_n, fz_n };
            let moments = [x_mm * fz_n, y_mm * fz_n, fx_n - fy_n, fx_n + fz_n];
            let uv: [f32; CHANNELS] =
                [fx_n, fy_n, fz_n, moments[0], moments[1], moments[2], moments[3], x_mm * fx_n, 7.0];
            Example { uv: uv.map(|value| 100.0 * value), contact: numbers(&contact) }
        };
        (0..count).map(|_| draw()).collect()
    }

    fn trained(schedule: &Schedule) -> Trained {
        let [held, training] = split(examples(2_000, 1), 5, 2);
        let start = Network::untrained(&[32, 32], Zero::Tared, &training, 4);
        train(&start, &training, &held, schedule, |_| ())
    }

    #[test]
    fn a_known_function_is_learnt() {
        let scores = Scores::of(&trained(&SCHEDULE).network, &examples(500, 9));
        // A network that always says the mean has 1; the function is smooth, and nothing is noisy.
        assert!(scores.all.mse < 0.01 && scores.all.r2 > 0.99, "{scores:?}");
        assert!(scores.each.iter().all(|score| score.r2 > 0.97), "{scores:?}");
    }

    #[test]
    fn the_best_weights_are_kept_and_training_ends_without_better_ones() {
        let fitted = trained(&Schedule { rate: 0.03, patience: 5, epochs_max: 300, ..SCHEDULE });
        let best = fitted.curve.iter().min_by(|a, b| a.validation_mse.total_cmp(&b.validation_mse)).unwrap();
        assert_eq!(best.validation_mse, fitted.validation_mse);
        assert_eq!(fitted.curve.len(), best.number + 5);
        let [held, _] = split(examples(2_000, 1), 5, 2);
        let again = Scores::of(&fitted.network, &held).all;
        assert!((again.mse - fitted.validation_mse).abs() < 1e-6, "{again:?} {}", fitted.validation_mse);
        let off = [again.mae - best.validation_mae, again.r2 - best.validation_r2];
        assert!(off.iter().all(|off| off.abs() < 1e-5), "{again:?} {best:?}");
    }

    #[test]
    fn a_seed_gives_the_same_network_with_any_number_of_threads() {
        let with = |threads: usize, seed: u64| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| trained(&Schedule { epochs_max: 3, seed, ..SCHEDULE }))
        };
        assert_eq!(with(1, 5), with(2, 5));
        assert_ne!(with(1, 5).network, with(1, 6).network);
    }

    #[test]
    fn a_large_penalty_holds_the_weights_where_they_began() {
        let [held, training] = split(examples(400, 1), 5, 2);
        let start = Network::untrained(&[16], Zero::Tared, &training, 4);
        let farthest = |beta: f32| {
            let schedule = Schedule { beta, epochs_max: 100, ..SCHEDULE };
            let network = train(&start, &training, &held, &schedule, |_| ()).network;
            let shape = Shape::of(&start);
            let moved = shape.pack(&network).into_iter().zip(shape.pack(&start));
            moved.map(|(one, other)| (one - other).abs()).fold(0.0, f32::max)
        };
        // One step of Adam is 0.001, however small the slope; the pull of 10⁴ turns it back.
        let (free, held) = (farthest(0.0), farthest(1e4));
        assert!(free > 0.05 && held < 0.003, "{free} {held}");
    }

    #[test]
    fn without_examples_nothing_is_learnt() {
        let start = Network::untrained(&[8], Zero::Tared, &[], 4);
        for (training, held) in [(examples(9, 1), vec![]), (vec![], examples(9, 1))] {
            let trained = train(&start, &training, &held, &SCHEDULE, |_| ());
            assert_eq!((&trained.network, trained.curve.len()), (&start, 0));
        }
    }

    #[test]
    fn a_split_loses_nothing() {
        let all = examples(103, 1);
        let [held, rest] = split(all.clone(), 10, 7);
        assert_eq!((held.len(), rest.len()), (10, 93));
        assert!(all.iter().all(|example| held.contains(example) != rest.contains(example)));
    }
}
