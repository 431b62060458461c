//! The way out.

use super::checksum;
use super::graph::CHANNELS_KEY;
use super::wire::{push_bytes, push_number};
use crate::network::{Network, OUTPUTS, Zero};
use crate::quantity::CHANNELS;

const IR_VERSION: u64 = 8;
const OPERATOR_SET: u64 = 13;
const FLOAT: u64 = 1;

/// A graph while its nodes are added, one behind the other.
struct Graph {
    nodes: Vec<u8>,
    initializers: Vec<u8>,
    /// Output name of the last node.
    last: String,
    count: usize,
}

pub(super) fn model(network: &Network) -> Vec<u8> {
    let mut model = Vec::new();
    push_number(&mut model, 1, IR_VERSION);
    push_bytes(&mut model, 2, b"tactpad");
    push_bytes(&mut model, 7, &graph(network));
    let mut operators = Vec::new();
    push_bytes(&mut operators, 1, b"");
    push_number(&mut operators, 2, OPERATOR_SET);
    push_bytes(&mut model, 8, &operators);
    checksum::push_property(&mut model, CHANNELS_KEY, network.zero.name());
    checksum::push(&mut model);
    model
}

fn graph(network: &Network) -> Vec<u8> {
    let mut graph = Graph { nodes: Vec::new(), initializers: Vec::new(), last: "channels".into(), count: 0 };
    graph.add("Sub", &[("channel_mean", &[CHANNELS], &network.input.mean)]);
    graph.add("Div", &[("channel_deviation", &[CHANNELS], &network.input.deviation)]);
    for (index, layer) in network.layers.iter().enumerate() {
        if index > 0 {
            graph.add("Relu", &[]);
        }
        let sides = [layer.inputs(), layer.biases.len()];
        let [weights, biases] = ["weights", "biases"].map(|name| format!("{name}_{index}"));
        graph.add("Gemm", &[(&weights, &sides, &layer.weights), (&biases, &sides[1..], &layer.biases)]);
    }
    graph.add("Mul", &[("contact_deviation", &[OUTPUTS], &network.output.deviation)]);
    graph.add("Add", &[("contact_mean", &[OUTPUTS], &network.output.mean)]);
    graph.end()
}

impl Graph {
    /// Adds a node that takes the last value and these tensors: name, sides, numbers.
    fn add(&mut self, operator: &str, tensors: &[(&str, &[usize], &[f32])]) {
        let mut node = Vec::new();
        push_bytes(&mut node, 1, self.last.as_bytes());
        for (name, sides, numbers) in tensors {
            push_bytes(&mut node, 1, name.as_bytes());
            push_bytes(&mut self.initializers, 5, &tensor(name, sides, numbers));
        }
        self.count += 1;
        self.last = if operator == "Add" { "contact".into() } else { format!("value_{}", self.count) };
        push_bytes(&mut node, 2, self.last.as_bytes());
        push_bytes(&mut node, 4, operator.as_bytes());
        push_bytes(&mut self.nodes, 1, &node);
    }

    fn end(self) -> Vec<u8> {
        let mut graph = self.nodes;
        push_bytes(&mut graph, 2, b"scdf");
        graph.extend(self.initializers);
        push_bytes(&mut graph, 11, &value("channels", CHANNELS));
        push_bytes(&mut graph, 12, &value(&self.last, OUTPUTS));
        graph
    }
}

fn tensor(name: &str, sides: &[usize], numbers: &[f32]) -> Vec<u8> {
    let mut tensor = Vec::new();
    sides.iter().for_each(|side| push_number(&mut tensor, 1, *side as u64));
    push_number(&mut tensor, 2, FLOAT);
    push_bytes(&mut tensor, 8, name.as_bytes());
    let bytes: Vec<u8> = numbers.iter().flat_map(|number| number.to_le_bytes()).collect();
    push_bytes(&mut tensor, 9, &bytes);
    tensor
}

/// The type of an end of the graph: any number of rows of `width` numbers.
fn value(name: &str, width: usize) -> Vec<u8> {
    let mut rows = Vec::new();
    push_bytes(&mut rows, 2, b"N");
    let mut columns = Vec::new();
    push_number(&mut columns, 1, width as u64);
    let mut sides = Vec::new();
    push_bytes(&mut sides, 1, &rows);
    push_bytes(&mut sides, 1, &columns);
    let mut tensor = Vec::new();
    push_number(&mut tensor, 1, FLOAT);
    push_bytes(&mut tensor, 2, &sides);
    let mut kind = Vec::new();
    push_bytes(&mut kind, 1, &tensor);
    let mut value = Vec::new();
    push_bytes(&mut value, 1, name.as_bytes());
    push_bytes(&mut value, 2, &kind);
    value
}

impl Zero {
    /// As files write it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Tared => "tared",
            Self::Raw => "raw",
        }
    }
}
