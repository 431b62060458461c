//! Figures: maps over the plate, maps over a film, line charts and layouts, as SVG or PNG.
//!
//! Values go in, a [`figure::Figure`] comes out: a list of marks on a white page, the same for both formats.
//! [`svg::text`] and [`png::bytes`] write it. Nothing here reads a file, a font or a clock, so equal values give
//! equal bytes on every machine. Text is drawn as outlines of a font that is inside the program.
//!
//! | to show | use |
//! |---|---|
//! | a function over the plate or a film | [`grid::Grid`], [`bands::Bands`], [`plan::Plan`] |
//! | many of them side by side | [`multiples::Multiples`] |
//! | modules, regions, gauges, contact points | [`shape::Shape`] in a [`plan::Plan`] |
//! | curves, points, error bars | [`chart::Chart`] |
//! | a few numbers beside each other | [`columns::Columns`] |
//!
//! `tests/program/plot.rs` makes one of each kind.
//!
//! What cannot be drawn (values that are not finite, or not positive on a logarithmic axis) is left out; an empty
//! figure is a frame with axes.

pub mod bands;
pub mod chart;
pub mod colour;
pub mod columns;
pub mod figure;
pub mod grid;
pub mod isoline;
pub mod multiples;
pub mod plan;
pub mod png;
pub mod scale;
pub mod shape;
pub mod svg;
pub mod vtk;

mod colour_bar;
mod contour;
mod font;
mod legend;
mod style;
