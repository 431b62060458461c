//! The whole pad in 3-D, solved by CalculiX, beside ours: proofs.
//!
//! The modules are meshed as ours, so that their discretisation error cancels. What is left is what we make of the
//! plate: Mindlin's equations instead of 3-D elasticity, polynomials instead of elements, and feet that move in 18
//! modes.

use std::f64::consts::TAU;
use std::io::{Write as _, stderr};

use serde_json::{Value, json};
use tactpad_core::pad::device::pose::Pose;
use tactpad_core::pad::device::{Device, GAUGES, Side};
use tactpad_core::quantity::{CHANNEL_NAMES, CHANNELS, MODULES};
use tactpad_mechanics::grid::Sizing;
use tactpad_mechanics::mesh::{Fineness, Layer, Mesh};
use tactpad_mechanics::simulator::{PLATE_DEGREE, Simulator};
use tactpad_mechanics::superelement::STRAINS;
use tactpad_numeric::zernike::jets;

use super::deck::{Deck, Print};
use super::gauges::Gauges;
use super::plate::{Face, PlateMesh};
use super::results::{Results, Step};
use crate::proof;

/// How much coarser than the program's mesh the modules are, in both solutions.
const COARSER: f64 = 2.0;

/// Sizes of the plate's elements. From 0.4 to 0.2 mm at the feet's edges, the channels of a force along x move by less
/// than 0.2 %.
const PLATE: Sizing = Sizing { finest_mm: 0.3, growth: 0.4, coarsest_mm: 2.5 };

/// Centre of the contact: no line of symmetry goes through it.
const CONTACT_MM: [f64; 2] = [10.0, 7.0];

/// Forces on the plate along the pad's axes, N: along x, along y, pressing.
const LOADS_N: [[f64; 3]; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, -1.0]];

/// The largest rms of the differences, as a share of the channels' rms, for each of the three kinds of channel.
const DEVIATION_MAX: f64 = 0.015;

/// µV of each channel for each load.
type Channels = [[f64; CHANNELS]; LOADS_N.len()];

#[test]
#[ignore = "proof: 180 s: another program's solution of the whole pad in 3-D, as drawn and with unequal modules"]
fn assembly_in_three_dimensions() {
    let results = [("as drawn", Device::nominal()), ("unequal modules", unequal())]
        .map(|(name, device)| compare(name, &device));
    proof::write("assembly", &json!({ "fineness_factor": COARSER, "devices": results }));
    for result in &results {
        let shares = result["deviation_of_xyz"].as_array().unwrap();
        assert!(shares.iter().all(|share| share.as_f64().unwrap() < DEVIATION_MAX), "{result:#}");
    }
}

/// Sizes for natural frequencies: they follow from the whole pad's stiffness, which coarse elements give within a percent.
const COARSER_IN_MOTION: f64 = 2.8;
const PLATE_IN_MOTION: Sizing = Sizing { finest_mm: 0.6, growth: 0.6, coarsest_mm: 4.0 };

/// Natural frequencies that are compared, and the largest difference as a share of each.
const FREQUENCIES: usize = 8;
const FREQUENCY_DEVIATION_MAX: f64 = 0.03;

#[test]
#[ignore = "proof: 75 s: another program's eight slowest natural frequencies of two pads"]
fn natural_frequencies_of_the_assembly() {
    for (name, device) in [("as drawn", Device::nominal()), ("unequal modules", unequal())] {
        let fineness = Fineness::STANDARD.scaled(COARSER_IN_MOTION);
        let plate = PlateMesh::of(&device, PLATE_IN_MOTION);
        let mut assembly = Assembly::of(&device, &plate, fineness);
        let theirs_hz = assembly.deck.frequencies_hz(FREQUENCIES);
        let ours = Simulator::new(fineness).natural_motions(&device).unwrap();
        let ours_hz: Vec<f64> = ours.iter().map(|motion| motion.frequency_hz).take(FREQUENCIES).collect();
        writeln!(
            stderr(),
            "{name}, {} nodes: CalculiX {theirs_hz:.1?} Hz, ours {ours_hz:.1?} Hz",
            assembly.nodes
        )
        .unwrap();
        for (ours, theirs) in ours_hz.iter().zip(&theirs_hz) {
            assert!((ours / theirs - 1.0).abs() < FREQUENCY_DEVIATION_MAX, "{name}: {ours} for {theirs} Hz");
        }
    }
}

/// A pad whose modules differ in place, turn, modulus and frame.
fn unequal() -> Device {
    let mut device = Device::nominal();
    device.modules[0].radial_mm = -0.7;
    device.modules[0].tangential_mm = 0.9;
    device.modules[1].rotation_deg = 8.0;
    device.modules[1].frame_e_factor = 0.5;
    device.modules[2].frame_open = Some(Side::PlusX);
    device
}

/// Both answers and how they differ, for each kind of channel over all loads and by load.
fn compare(name: &str, device: &Device) -> Value {
    let plate = PlateMesh::of(device, PLATE);
    let fineness = Fineness::STANDARD.scaled(COARSER);
    let mut assembly = Assembly::of(device, &plate, fineness);
    let results = assembly.solve();
    let theirs = assembly.channels_uv(&results);
    let ours = ours_uv(device, fineness);
    let share = |kind: usize, loads: &[usize]| {
        deviation(&ours, &theirs, |channel, load| channel % 3 == kind && loads.contains(&load))
    };
    let over_all = [0, 1, 2].map(|kind| share(kind, &[0, 1, 2]));
    let by_load = [0, 1, 2].map(|kind| [0, 1, 2].map(|load| share(kind, &[load])));
    json!({
        "device": name, "nodes": assembly.nodes, "contact_mm": CONTACT_MM, "loads_n": LOADS_N,
        "channels": CHANNEL_NAMES, "calculix_uv": theirs, "ours_uv": ours,
        "deviation_of_xyz": over_all, "deviation_of_xyz_by_load": by_load,
    })
}

/// The rms of the differences over the chosen channels and loads, as a share of the rms of theirs.
fn deviation(ours: &Channels, theirs: &Channels, chosen: impl Fn(usize, usize) -> bool) -> f64 {
    let (mut difference, mut size) = (0.0, 0.0);
    for (load, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
        for (channel, (ours, theirs)) in ours.iter().zip(theirs).enumerate() {
            if chosen(channel, load) {
                difference += (ours - theirs).powi(2);
                size += theirs.powi(2);
            }
        }
    }
    (difference / size).sqrt()
}

/// Our answer.
fn ours_uv(device: &Device, fineness: Fineness) -> Channels {
    let signals = Simulator::new(fineness).pad(device).unwrap().signals();
    let here = jets(PLATE_DEGREE, CONTACT_MM.map(|mm| mm / device.plate.radius_mm()));
    std::array::from_fn(|axis| signals.each_ref().map(|maps| maps[axis].value(&here)))
}

/// A module's mesh in the assembly.
struct Standing {
    mesh: Mesh,
    pose: Pose,
    /// Number of its first node.
    first: usize,
}

impl Standing {
    /// A node's place in the pad frame: the module hangs from the plate's underside.
    fn place_mm(&self, node: usize, thickness_mm: f64) -> [f64; 3] {
        let [x, y, z] = self.mesh.place_mm(node);
        let top = self.mesh.lines_mm[2].last().unwrap();
        let Pose { centre_mm, along_x, along_y } = self.pose;
        let [px, py] = [0, 1].map(|a| centre_mm[a] + x * along_x[a] + y * along_y[a]);
        [px, py, z - top - thickness_mm]
    }

    /// A displacement along the module's axes.
    fn along_axes(&self, [x, y, z]: [f64; 3]) -> [f64; 3] {
        let along = |axis: [f64; 2]| x * axis[0] + y * axis[1];
        [along(self.pose.along_x), along(self.pose.along_y), z]
    }

    fn nodes(&self, wanted: impl Fn(usize) -> bool) -> impl Iterator<Item = usize> {
        (0..self.mesh.lattice.len()).filter(move |node| wanted(*node))
    }
}

/// A module's frame is left-handed, so its bricks are seen in a mirror: corners and edges run the other way round.
const MIRRORED: [usize; 20] = [0, 3, 2, 1, 4, 7, 6, 5, 11, 10, 9, 8, 15, 14, 13, 12, 16, 19, 18, 17];

/// The plate on its modules, as CalculiX gets it.
struct Assembly<'d> {
    device: &'d Device,
    plate: &'d PlateMesh,
    modules: Vec<Standing>,
    deck: Deck,
    nodes: usize,
}

impl<'d> Assembly<'d> {
    fn of(device: &'d Device, plate: &'d PlateMesh, fineness: Fineness) -> Self {
        let mut deck = Deck::default();
        deck.nodes(plate.places_mm.iter().copied());
        deck.elements("C3D20", "PLATE", device.material.plate, &plate.bricks);
        deck.elements("C3D15", "CENTRE", device.material.plate, &plate.wedges);
        let mut assembly = Self { device, plate, modules: Vec::new(), deck, nodes: plate.places_mm.len() };
        for (index, pose) in device.poses().into_iter().enumerate() {
            assembly.stand(index, pose, fineness);
        }
        let base = assembly.modules.iter().flat_map(|module| {
            let fixed = module.nodes(|node| module.mesh.is_fixed(node));
            fixed.map(|node| module.first + node)
        });
        assembly.deck.node_set("BASE", base);
        assembly.deck.fix("BASE");
        assembly
    }

    /// Puts a module under the plate.
    fn stand(&mut self, index: usize, pose: Pose, fineness: Fineness) {
        let module = &self.device.modules[index];
        let mesh = Mesh::of(self.device, module, fineness);
        let standing = Standing { mesh, pose, first: self.nodes };
        let place_mm = |node| standing.place_mm(node, self.device.plate.thickness_mm);
        self.nodes += standing.mesh.lattice.len();
        self.deck.nodes(standing.nodes(|_| true).map(place_mm));
        for layer in Layer::ALL {
            let bricks = standing.mesh.bricks.iter().filter(|brick| brick.layer == layer);
            let mirrored = bricks.map(|brick| MIRRORED.map(|corner| standing.first + brick.nodes[corner]));
            let material = layer.material(self.device, module);
            self.deck.elements("C3D20R", &format!("{layer:?}{index}"), material, mirrored);
        }
        for node in standing.nodes(|node| standing.mesh.is_top(node)) {
            let [x, y, _] = place_mm(node);
            self.deck.tie(standing.first + node, &self.plate.weights(Face::Underside, [x, y]));
        }
        self.modules.push(standing);
    }

    fn solve(&mut self) -> Results {
        for force_n in LOADS_N {
            self.deck.begin_step();
            self.deck.load(&self.contact(force_n));
            self.deck.end_step(&[Print::Displacements("EVERY"), Print::Reactions("BASE")]);
        }
        let results = self.deck.solve();
        for (step, force_n) in results.steps.iter().zip(LOADS_N) {
            for (axis, force) in force_n.iter().enumerate() {
                let reaction: f64 = step.reaction.values().map(|reaction| reaction[axis]).sum();
                assert!((reaction + force).abs() < 1e-4, "the base holds {reaction} N of {force} N");
            }
        }
        results
    }

    /// The nodal forces that do the work of an even traction over the contact's disc.
    fn contact(&self, force_n: [f64; 3]) -> Vec<(usize, [f64; 3])> {
        let mut forces = vec![[0.0; 3]; self.plate.places_mm.len()];
        let points = disc_points();
        for place in &points {
            let at = [0, 1].map(|a| CONTACT_MM[a] + self.device.contact.patch_radius_mm * place[a]);
            for (node, value) in self.plate.weights(Face::Top, at) {
                for axis in 0..3 {
                    forces[node][axis] += force_n[axis] * value / points.len() as f64;
                }
            }
        }
        forces.into_iter().enumerate().filter(|(_, force)| *force != [0.0; 3]).collect()
    }

    fn channels_uv(&self, results: &Results) -> Channels {
        assert_eq!(results.steps.len(), LOADS_N.len());
        std::array::from_fn(|load| {
            let signals = self.modules.iter().map(|module| self.signals_uv(module, &results.steps[load]));
            let signals: [[f64; 3]; MODULES] = signals.collect::<Vec<_>>().try_into().unwrap();
            signals.as_flattened().try_into().unwrap()
        })
    }

    /// The signals x, y, z of a module.
    fn signals_uv(&self, module: &Standing, step: &Step) -> [f64; 3] {
        let gauges = Gauges::of(&module.mesh, &self.device.gauges);
        let strains: [f64; STRAINS] =
            gauges.by_nodes(|node| module.along_axes(step.displacement[module.first + node]));
        let law = self.device.gauge_law;
        let r: [f64; GAUGES] = std::array::from_fn(|gauge| {
            let strain = strains[2 * gauge] + law.transverse_ratio * strains[2 * gauge + 1];
            self.device.gauges[gauge].resistance_ratio * law.gauge_factor * strain
        });
        [r[0] - r[1], r[2] - r[3], r[4] + r[5] - r[6]].map(|d| 1e6 * self.device.circuit.excitation_v * d)
    }
}

/// Points of the unit disc that stand for equal areas. The shape functions are polynomials in pieces: many points.
fn disc_points() -> Vec<[f64; 2]> {
    const RINGS: usize = 20;
    const RAYS: usize = 60;
    let point = |ring: usize, ray: usize| {
        let radius = ((ring as f64 + 0.5) / RINGS as f64).sqrt();
        let (sin, cos) = (TAU * ray as f64 / RAYS as f64).sin_cos();
        [radius * cos, radius * sin]
    };
    (0..RINGS).flat_map(|ring| (0..RAYS).map(move |ray| point(ring, ray))).collect()
}
