//! What the laboratory finds out about a pad, from measured tables to decoders and figures of merit.

mod ablation;
mod bench;
mod calibration;
mod changes;
mod fingertip;
mod force_range;
#[cfg(feature = "foreign-onnx")]
mod foreign;
mod freehand;
mod guide;
mod home;
mod layout;
mod measurement;
mod metrology;
mod models;
mod network;
mod onnxruntime;
mod scdf;
mod simulation_based;
#[path = "../support/mod.rs"]
mod support;
mod tuning;
mod weighing;
