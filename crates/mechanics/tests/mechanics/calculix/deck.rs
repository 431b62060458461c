//! What CalculiX is asked: its input file, line by line, and the run.
//!
//! Source of the keywords: G. Dhondt, CalculiX CrunchiX User's Manual, version 2.20. Nodes and elements count from 1
//! there and from 0 here.

use std::fmt::{Display, Write as _};
use std::fs;
use std::process::Command;

use tactpad_core::pad::device::Material;
use tactpad_mechanics::brick::TONNES_PER_MM3;

use super::results::{Results, frequencies_hz};

/// An input file under construction.
#[derive(Default)]
pub(crate) struct Deck {
    text: String,
    nodes: usize,
    elements: usize,
}

impl Deck {
    fn line(&mut self, line: impl Display) {
        writeln!(self.text, "{line}").unwrap();
    }

    /// Adds nodes; returns the first one's number.
    pub(crate) fn nodes(&mut self, places_mm: impl IntoIterator<Item = [f64; 3]>) -> usize {
        let first = self.nodes;
        self.line("*NODE, NSET=EVERY");
        for [x, y, z] in places_mm {
            self.nodes += 1;
            let number = self.nodes;
            self.line(format_args!("{number}, {x:.12e}, {y:.12e}, {z:.12e}"));
        }
        first
    }

    /// Adds elements of a type ("C3D20") to a set, made of one material; returns the first one's number.
    pub(crate) fn elements<N: AsRef<[usize]>>(
        &mut self,
        kind: &str,
        set: &str,
        material: Material,
        elements: impl IntoIterator<Item = N>,
    ) -> usize {
        let first = self.elements;
        self.line(format_args!("*ELEMENT, TYPE={kind}, ELSET={set}"));
        for nodes in elements {
            self.elements += 1;
            let numbers: Vec<String> = [self.elements]
                .into_iter()
                .chain(nodes.as_ref().iter().map(|node| node + 1))
                .map(|n| n.to_string())
                .collect();
            // A line holds sixteen entries; a comma at its end calls for another.
            let lines: Vec<String> = numbers.chunks(16).map(|line| line.join(", ")).collect();
            self.line(lines.join(",\n"));
        }
        self.line(format_args!(
            "*MATERIAL, NAME={set}\n*ELASTIC\n{:.12e}, {:.12e}\n*DENSITY\n{:.12e}",
            material.e_mpa,
            material.nu,
            TONNES_PER_MM3 * material.density_kg_m3
        ));
        self.line(format_args!("*SOLID SECTION, ELSET={set}, MATERIAL={set}"));
        first
    }

    /// Names a set of nodes.
    pub(crate) fn node_set(&mut self, name: &str, nodes: impl IntoIterator<Item = usize>) {
        self.line(format_args!("*NSET, NSET={name}"));
        nodes.into_iter().for_each(|node| self.line(node + 1));
    }

    /// Names a set of elements.
    pub(crate) fn element_set(&mut self, name: &str, elements: impl IntoIterator<Item = usize>) {
        self.line(format_args!("*ELSET, ELSET={name}"));
        elements.into_iter().for_each(|element| self.line(element + 1));
    }

    /// Fixes a set of nodes in all three directions.
    pub(crate) fn fix(&mut self, set: &str) {
        self.line(format_args!("*BOUNDARY\n{set}, 1, 3, 0."));
    }

    /// Makes displacements of one node follow others: u = Σ weight · u of each, along all three axes.
    pub(crate) fn tie(&mut self, node: usize, others: &[(usize, f64)]) {
        for axis in 1..=3 {
            self.line(format_args!("*EQUATION\n{}", others.len() + 1));
            self.line(format_args!("{}, {axis}, 1.", node + 1));
            for (other, weight) in others {
                self.line(format_args!("{}, {axis}, {:.12e}", other + 1, -weight));
            }
        }
    }

    /// Begins a linear static step, in which nothing acts yet but what is fixed.
    pub(crate) fn begin_step(&mut self) {
        self.line("*STEP\n*STATIC");
    }

    /// Gives displacements, mm.
    pub(crate) fn displace(&mut self, given: &[(usize, [f64; 3])]) {
        self.line("*BOUNDARY");
        for (node, axis, value) in components(given) {
            self.line(format_args!("{node}, {axis}, {axis}, {value:.12e}"));
        }
    }

    /// Applies forces, N, and takes away those of the step before.
    pub(crate) fn load(&mut self, given: &[(usize, [f64; 3])]) {
        self.line("*CLOAD, OP=NEW");
        for (node, axis, value) in components(given) {
            self.line(format_args!("{node}, {axis}, {value:.12e}"));
        }
    }

    /// Ends the step with what is printed of it.
    pub(crate) fn end_step(&mut self, prints: &[Print]) {
        for print in prints {
            match print {
                Print::Displacements(set) => self.line(format_args!("*NODE PRINT, NSET={set}\nU")),
                Print::Reactions(set) => self.line(format_args!("*NODE PRINT, NSET={set}\nRF")),
                Print::Strains(set) => self.line(format_args!("*EL PRINT, ELSET={set}\nE")),
            }
        }
        self.line("*END STEP");
    }

    /// Has CalculiX look for the lowest natural frequencies, Hz, from the lowest on.
    ///
    /// # Panics
    /// It does not run to its end, or finds fewer.
    pub(crate) fn frequencies_hz(&mut self, wanted: usize) -> Vec<f64> {
        self.line(format_args!("*STEP\n*FREQUENCY\n{wanted}\n*END STEP"));
        let found = frequencies_hz(&self.run());
        assert_eq!(found.len(), wanted);
        found
    }

    /// Has CalculiX solve it.
    ///
    /// # Panics
    /// It does not run to its end.
    pub(crate) fn solve(&self) -> Results {
        Results::read(&self.run(), self.nodes)
    }

    /// What CalculiX prints.
    fn run(&self) -> String {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("job.inp"), &self.text).unwrap();
        let mut command = Command::new("ccx");
        let output = command
            .args(["-i", "job"])
            .current_dir(folder.path())
            .output()
            .expect("ccx: apt-get install calculix-ccx");
        let said = String::from_utf8_lossy(&output.stdout);
        let end = &said[said.floor_char_boundary(said.len().saturating_sub(2_000))..];
        assert!(output.status.success() && said.contains("Job finished"), "ccx ended early: {end}");
        fs::read_to_string(folder.path().join("job.dat")).unwrap()
    }
}

/// What is printed, for which set.
pub(crate) enum Print {
    /// Displacements of nodes.
    Displacements(&'static str),
    /// Reactions of nodes.
    Reactions(&'static str),
    /// Strains at the integration points of elements.
    Strains(&'static str),
}

/// Numbers of node and axis as CalculiX counts them, with the value.
fn components(given: &[(usize, [f64; 3])]) -> impl Iterator<Item = (usize, usize, f64)> {
    given.iter().flat_map(|(node, values)| (0..3).map(move |axis| (node + 1, axis + 1, values[axis])))
}
