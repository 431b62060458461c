//! Meshes and fields for ParaView: a VTK XML file of an unstructured grid (`.vtu`).
//!
//! The numbers stand behind the XML part as raw little-endian bytes, each array with its length before it. Source:
//! W. Schroeder, K. Martin, B. Lorensen, "The Visualization Toolkit", and Kitware's "VTK XML file formats".

use std::collections::BTreeSet;
use std::fmt::{self, Write};

/// What a cell is. The order of the nodes is VTK's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// One node.
    Vertex,
    /// Three nodes, counter-clockwise.
    Triangle,
    /// Four nodes, counter-clockwise.
    Quad,
    /// A brick with curved edges: corners 0 to 3 counter-clockwise on one face seen from the face opposite, corners
    /// 4 to 7 of that opposite face each over 0 to 3, then nodes 8 to 19 in the middle of [`HEXAHEDRON_EDGES`].
    ///
    /// This is also the order of CalculiX's and Abaqus's C3D20 (counted from 1 there).
    Hexahedron20,
}

/// The corners between which nodes 8, 9, … 19 of a [`CellKind::Hexahedron20`] lie: around the first face, around the
/// opposite one, and from face to face.
pub const HEXAHEDRON_EDGES: [[usize; 2]; 12] =
    [[0, 1], [1, 2], [2, 3], [3, 0], [4, 5], [5, 6], [6, 7], [7, 4], [0, 4], [1, 5], [2, 6], [3, 7]];

/// A cell by its nodes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Cell {
    /// What it is.
    pub kind: CellKind,
    /// Indices of its nodes, in VTK's order.
    pub nodes: Vec<usize>,
}

/// Values at the nodes or in the cells.
#[derive(Clone, Debug, PartialEq)]
pub struct Field {
    /// What ParaView shows; the unit stands last (`deflection_um`). Letters, digits and `_ - .`.
    pub name: String,
    /// One for each node or cell.
    pub values: Values,
}

/// Numbers or vectors. What is not finite is written as it is.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// Numbers.
    Scalars(Vec<f64>),
    /// Vectors in the grid's frame.
    Vectors(Vec<[f64; 3]>),
}

/// A mesh with its fields.
#[derive(Clone, Debug, PartialEq)]
pub struct UnstructuredGrid {
    /// Places of the nodes.
    pub nodes_mm: Vec<[f64; 3]>,
    /// Cells of any kinds.
    pub cells: Vec<Cell>,
    /// Values at the nodes.
    pub node_fields: Vec<Field>,
    /// Values in the cells.
    pub cell_fields: Vec<Field>,
}

/// A grid that no file can hold.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum VtkError {
    /// A cell has too many or too few nodes.
    CellNodes {
        /// Index of the cell.
        cell: usize,
        /// Nodes it has.
        found: usize,
        /// Nodes it needs.
        wanted: usize,
    },
    /// A cell names a node that does not exist.
    NoSuchNode {
        /// Index of the cell.
        cell: usize,
        /// What it names.
        node: usize,
    },
    /// A field has too many or too few values.
    FieldLength {
        /// Its name.
        name: String,
        /// Values it has.
        found: usize,
        /// Values it needs.
        wanted: usize,
    },
    /// A name is empty, taken, or holds other characters than letters, digits and `_ - .`.
    FieldName {
        /// The name.
        name: String,
    },
}

impl fmt::Display for VtkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::CellNodes { cell, found, wanted } => {
                write!(f, "cell {cell} has {found} nodes instead of {wanted}")
            }
            Self::NoSuchNode { cell, node } => {
                write!(f, "cell {cell} names node {node}, which does not exist")
            }
            Self::FieldLength { name, found, wanted } => {
                write!(f, "field {name} has {found} values instead of {wanted}")
            }
            Self::FieldName { name } => {
                write!(f, "field name {name:?} must be new and of letters, digits and _ - . only")
            }
        }
    }
}

impl std::error::Error for VtkError {}

impl CellKind {
    /// How many nodes a cell has.
    pub const fn nodes(self) -> usize {
        match self {
            Self::Vertex => 1,
            Self::Triangle => 3,
            Self::Quad => 4,
            Self::Hexahedron20 => 20,
        }
    }

    /// VTK's number for it.
    const fn code(self) -> u8 {
        match self {
            Self::Vertex => 1,
            Self::Triangle => 5,
            Self::Quad => 9,
            Self::Hexahedron20 => 25,
        }
    }
}

impl Values {
    fn len(&self) -> usize {
        match self {
            Self::Scalars(values) => values.len(),
            Self::Vectors(values) => values.len(),
        }
    }

    const fn components(&self) -> usize {
        match self {
            Self::Scalars(_) => 1,
            Self::Vectors(_) => 3,
        }
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Scalars(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Vectors(values) => values.iter().flatten().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }
}

/// The file's XML part and the arrays behind it.
struct File {
    xml: String,
    arrays: Vec<u8>,
}

impl UnstructuredGrid {
    /// The grid as a `.vtu` file. Equal grids give equal bytes.
    ///
    /// # Errors
    /// The first cell or field that does not fit the grid.
    pub fn vtu(&self) -> Result<Vec<u8>, VtkError> {
        self.check()?;
        let mut file = File { xml: String::new(), arrays: Vec::new() };
        let (nodes, cells) = (self.nodes_mm.len(), self.cells.len());
        file.line(format_args!("<?xml version=\"1.0\"?>"));
        file.line(format_args!(
            "<VTKFile type=\"UnstructuredGrid\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">"
        ));
        file.line(format_args!("<UnstructuredGrid>"));
        file.line(format_args!("<Piece NumberOfPoints=\"{nodes}\" NumberOfCells=\"{cells}\">"));
        file.fields("PointData", &self.node_fields);
        file.fields("CellData", &self.cell_fields);
        file.line(format_args!("<Points>"));
        file.array("points_mm", "Float64", 3, &Values::Vectors(self.nodes_mm.clone()).bytes());
        file.line(format_args!("</Points>"));
        self.write_cells(&mut file);
        file.line(format_args!("</Piece>\n</UnstructuredGrid>"));
        Ok(file.bytes())
    }

    fn write_cells(&self, file: &mut File) {
        let connectivity = self.cells.iter().flat_map(|cell| &cell.nodes);
        let ends = self.cells.iter().scan(0, |end, cell| {
            *end += cell.nodes.len();
            Some(*end)
        });
        let kinds: Vec<u8> = self.cells.iter().map(|cell| cell.kind.code()).collect();
        file.line(format_args!("<Cells>"));
        file.array("connectivity", "Int64", 1, &indices(connectivity.copied()));
        file.array("offsets", "Int64", 1, &indices(ends));
        file.array("types", "UInt8", 1, &kinds);
        file.line(format_args!("</Cells>"));
    }

    fn check(&self) -> Result<(), VtkError> {
        self.cells.iter().enumerate().try_for_each(|(index, cell)| self.check_cell(index, cell))?;
        for (fields, wanted) in
            [(&self.node_fields, self.nodes_mm.len()), (&self.cell_fields, self.cells.len())]
        {
            let mut names = BTreeSet::new();
            for Field { name, values } in fields {
                let is_plain = |code: char| code.is_ascii_alphanumeric() || "_-.".contains(code);
                if name.is_empty() || !name.chars().all(is_plain) || !names.insert(name) {
                    return Err(VtkError::FieldName { name: name.clone() });
                }
                if values.len() != wanted {
                    return Err(VtkError::FieldLength { name: name.clone(), found: values.len(), wanted });
                }
            }
        }
        Ok(())
    }

    fn check_cell(&self, index: usize, cell: &Cell) -> Result<(), VtkError> {
        let (found, wanted) = (cell.nodes.len(), cell.kind.nodes());
        if found != wanted {
            return Err(VtkError::CellNodes { cell: index, found, wanted });
        }
        match cell.nodes.iter().find(|&&node| node >= self.nodes_mm.len()) {
            Some(&node) => Err(VtkError::NoSuchNode { cell: index, node }),
            None => Ok(()),
        }
    }
}

fn indices(values: impl Iterator<Item = usize>) -> Vec<u8> {
    values.flat_map(|value| (value as u64).to_le_bytes()).collect()
}

impl File {
    /// Writing to a string cannot fail.
    fn line(&mut self, text: fmt::Arguments) {
        let _ = writeln!(self.xml, "{text}");
    }

    fn fields(&mut self, place: &str, fields: &[Field]) {
        self.line(format_args!("<{place}>"));
        for Field { name, values } in fields {
            self.array(name, "Float64", values.components(), &values.bytes());
        }
        self.line(format_args!("</{place}>"));
    }

    fn array(&mut self, name: &str, kind: &str, components: usize, bytes: &[u8]) {
        let offset = self.arrays.len();
        self.line(format_args!(
            "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" \
             format=\"appended\" offset=\"{offset}\"/>"
        ));
        self.arrays.extend((bytes.len() as u64).to_le_bytes());
        self.arrays.extend(bytes);
    }

    /// The first byte of the arrays is the one behind the underscore.
    fn bytes(self) -> Vec<u8> {
        let mut bytes = self.xml.into_bytes();
        bytes.extend(b"<AppendedData encoding=\"raw\">\n_");
        bytes.extend(self.arrays);
        bytes.extend(b"\n</AppendedData>\n</VTKFile>\n");
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn triangle() -> UnstructuredGrid {
        UnstructuredGrid {
            nodes_mm: vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.5]],
            cells: vec![Cell { kind: CellKind::Triangle, nodes: vec![0, 1, 2] }],
            node_fields: vec![Field {
                name: "w_um".to_owned(),
                values: Values::Scalars(vec![1.0, -2.0, 0.25]),
            }],
            cell_fields: vec![],
        }
    }

    /// The array of this name, found by its offset.
    fn array(file: &[u8], name: &str) -> Vec<u8> {
        let text = String::from_utf8_lossy(file);
        let rest = text.split(&format!("Name=\"{name}\"")).nth(1).unwrap();
        let offset: usize =
            rest.split("offset=\"").nth(1).unwrap().split('"').next().unwrap().parse().unwrap();
        let marker = b"encoding=\"raw\">\n_";
        let start =
            file.windows(marker.len()).position(|bytes| bytes == marker).unwrap() + marker.len() + offset;
        let length = u64::from_le_bytes(file[start..start + 8].try_into().unwrap()) as usize;
        file[start + 8..start + 8 + length].to_vec()
    }

    #[test]
    fn arrays_are_where_their_offsets_say() {
        let file = triangle().vtu().unwrap();
        let w: Vec<u8> = [1.0_f64, -2.0, 0.25].iter().flat_map(|value| value.to_le_bytes()).collect();
        assert_eq!(array(&file, "w_um"), w);
        assert_eq!(array(&file, "types"), [5]);
        assert_eq!(array(&file, "offsets"), [3, 0, 0, 0, 0, 0, 0, 0]);
        assert_eq!(array(&file, "points_mm").len(), 72);
    }

    #[test]
    fn an_empty_grid_is_a_file() {
        let empty =
            UnstructuredGrid { nodes_mm: vec![], cells: vec![], node_fields: vec![], cell_fields: vec![] };
        assert!(String::from_utf8_lossy(&empty.vtu().unwrap()).contains("NumberOfPoints=\"0\""));
    }

    #[test]
    fn cells_that_do_not_fit_are_refused() {
        let mut grid = triangle();
        grid.cells[0].nodes[2] = 3;
        assert_eq!(grid.vtu(), Err(VtkError::NoSuchNode { cell: 0, node: 3 }));
        grid.cells[0].nodes.pop();
        assert_eq!(grid.vtu(), Err(VtkError::CellNodes { cell: 0, found: 2, wanted: 3 }));
        assert_eq!(grid.vtu().unwrap_err().to_string(), "cell 0 has 2 nodes instead of 3");
    }

    #[test]
    fn fields_that_do_not_fit_are_refused() {
        let field = |name: &str, count: usize| Field {
            name: name.to_owned(),
            values: Values::Scalars(vec![0.0; count]),
        };
        for (node_fields, wanted) in [
            (vec![field("w", 2)], VtkError::FieldLength { name: "w".to_owned(), found: 2, wanted: 3 }),
            (vec![field("", 3)], VtkError::FieldName { name: String::new() }),
            (vec![field("a<b", 3)], VtkError::FieldName { name: "a<b".to_owned() }),
            (vec![field("w", 3), field("w", 3)], VtkError::FieldName { name: "w".to_owned() }),
        ] {
            assert_eq!(UnstructuredGrid { node_fields, ..triangle() }.vtu(), Err(wanted));
        }
    }
}
