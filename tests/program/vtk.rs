//! ParaView's files, read by a reader that others wrote.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::support::{leave_out, require};
use tactpad::plot::vtk::{Cell, CellKind, Field, HEXAHEDRON_EDGES, UnstructuredGrid, Values};

/// A brick of 2 × 3 × 4 mm, then a vertex, a triangle and a quadrilateral of its corners.
fn mixed() -> UnstructuredGrid {
    let [a, b, c] = [2.0, 3.0, 4.0];
    let corners = [[0.0, 0.0], [a, 0.0], [a, b], [0.0, b]];
    let mut nodes_mm: Vec<[f64; 3]> =
        [0.0, c].iter().flat_map(|&z| corners.map(|[x, y]| [x, y, z])).collect();
    let middle = |[p, q]: [usize; 2]| [0, 1, 2].map(|axis| 0.5 * (nodes_mm[p][axis] + nodes_mm[q][axis]));
    let middles = HEXAHEDRON_EDGES.map(middle);
    nodes_mm.extend(middles);
    let squares = nodes_mm.iter().map(|[x, y, z]| x * x + y - z).collect();
    let cell = |kind, nodes: &[usize]| Cell { kind, nodes: nodes.to_vec() };
    UnstructuredGrid {
        cells: vec![
            cell(CellKind::Hexahedron20, &(0..20).collect::<Vec<_>>()),
            cell(CellKind::Vertex, &[6]),
            cell(CellKind::Triangle, &[4, 5, 6]),
            cell(CellKind::Quad, &[0, 1, 2, 3]),
        ],
        node_fields: vec![
            Field { name: "square_mm2".to_owned(), values: Values::Scalars(squares) },
            Field { name: "place_mm".to_owned(), values: Values::Vectors(nodes_mm.clone()) },
        ],
        cell_fields: vec![
            Field { name: "kind".to_owned(), values: Values::Scalars(vec![25.0, 1.0, 5.0, f64::NAN]) },
            Field {
                name: "force_n".to_owned(),
                values: Values::Vectors((0..4).map(|k| [f64::from(k), 0.5, -1.0]).collect()),
            },
        ],
        nodes_mm,
    }
}

/// A Python that has meshio: the first one in the path, or the system's.
fn python() -> Option<&'static str> {
    if !require("python3", "apt-get install python3-meshio") {
        return None;
    }
    let has_meshio = |python: &&str| {
        let output = Command::new(python).args(["-c", "import meshio"]).output();
        output.is_ok_and(|output| output.status.success())
    };
    let found = ["python3", "/usr/bin/python3"].into_iter().find(has_meshio);
    if found.is_none() {
        leave_out("meshio", "apt-get install python3-meshio");
    }
    found
}

/// What `vtk/read.py` prints for a grid.
fn expected(grid: &UnstructuredGrid) -> String {
    let mut text = String::new();
    let mut line = |name: &str, values: &[f64]| {
        let values: Vec<String> = values.iter().map(|value| format!("{value:.6}").to_lowercase()).collect();
        text += &format!("{name} {}\n", values.join(" "));
    };
    grid.nodes_mm.iter().for_each(|node| line("node", node));
    for cell in &grid.cells {
        let kind = match cell.kind {
            CellKind::Vertex => "vertex",
            CellKind::Triangle => "triangle",
            CellKind::Quad => "quad",
            CellKind::Hexahedron20 => "hexahedron20",
        };
        line(kind, &cell.nodes.iter().map(|&node| node as f64).collect::<Vec<_>>());
    }
    for field in grid.node_fields.iter().chain(&grid.cell_fields) {
        match &field.values {
            Values::Scalars(values) => line(&field.name, values),
            Values::Vectors(values) => line(&field.name, values.as_flattened()),
        }
    }
    text
}

#[test]
fn meshio_reads_what_was_written() {
    let Some(python) = python() else { return };
    let file = Path::new(env!("CARGO_TARGET_TMPDIR")).join("mixed.vtu");
    fs::write(&file, mixed().vtu().unwrap()).unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/program/vtk/read.py");
    let output = Command::new(python).arg(script).arg(&file).output().unwrap();
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{errors}");
    assert_eq!(String::from_utf8_lossy(&output.stdout), expected(&mixed()));
}
