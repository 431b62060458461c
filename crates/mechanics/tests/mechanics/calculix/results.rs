//! What CalculiX answers: the tables of its `.dat` file, seven digits each.

use std::collections::BTreeMap;

/// Everything that was printed in one step.
#[derive(Default)]
pub(crate) struct Step {
    /// Displacement of each node, mm.
    pub(crate) displacement: Vec<[f64; 3]>,
    /// Reactions of the nodes that were asked for, N.
    pub(crate) reaction: BTreeMap<usize, [f64; 3]>,
    /// Strains xx, yy, zz, xy, xz, yz at the integration points of the elements that were asked for.
    pub(crate) strain: BTreeMap<usize, Vec<[f64; 6]>>,
}

/// The steps in their order.
pub(crate) struct Results {
    pub(crate) steps: Vec<Step>,
}

impl Results {
    /// Reads a `.dat` file for a body of so many nodes.
    ///
    /// # Panics
    /// The text is none.
    pub(crate) fn read(text: &str, nodes: usize) -> Self {
        let mut steps: BTreeMap<u32, Step> = BTreeMap::new();
        let (mut table, mut time) = ("", 0);
        for line in text.lines() {
            let mut words = line.split_whitespace();
            let Some(first) = words.next() else { continue };
            let Ok(number) = first.parse::<usize>() else {
                table = first;
                // Each step takes one unit of time.
                time = line.split_whitespace().next_back().unwrap().parse::<f64>().unwrap().round() as u32;
                continue;
            };
            let step = steps.entry(time).or_default();
            step.displacement.resize(nodes, [f64::NAN; 3]);
            step.add(table, number - 1, words);
        }
        Self { steps: steps.into_values().collect() }
    }
}

impl Step {
    fn add<'t>(&mut self, table: &str, number: usize, mut words: impl Iterator<Item = &'t str>) {
        match table {
            "displacements" => self.displacement[number] = numbers(words),
            "forces" => {
                self.reaction.insert(number, numbers(words));
            }
            "strains" => {
                let points = self.strain.entry(number).or_default();
                let point: usize = words.next().unwrap().parse().unwrap();
                points.push(numbers(words));
                assert_eq!(points.len(), point, "points come in their order");
            }
            other => panic!("a table of {other} was not asked for"),
        }
    }
}

fn numbers<'t, const N: usize>(words: impl Iterator<Item = &'t str>) -> [f64; N] {
    let numbers: Vec<f64> = words.map(|word| word.parse().unwrap()).collect();
    numbers.try_into().unwrap()
}

/// The table of eigenvalues: mode, ω², ω, ω/2π, and what is imaginary.
pub(crate) fn frequencies_hz(text: &str) -> Vec<f64> {
    let (_, table) = text.split_once("E I G E N V A L U E   O U T P U T").unwrap();
    let rows =
        table.lines().map(|line| line.split_whitespace().map(str::parse).collect::<Result<Vec<f64>, _>>());
    // Lines of words go before the rows, and after them.
    let rows = rows.skip_while(|row| !matches!(row, Ok(row) if row.len() == 5));
    rows.map_while(|row| row.ok().filter(|row| row.len() == 5)).map(|row| row[3]).collect()
}
