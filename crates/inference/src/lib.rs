//! Inference: which causes explain what a model of channels gets wrong.
//!
//! It knows rows and columns, whatever sensor they are of. A study says what may be wrong as [`Hypothesis`](hypothesis::Hypothesis)es
//! with names of its own, and hands over a [`Model`](model::Model) that computes readings and their derivatives.
//!
//! The way of the data, module by module:
//!
//! | module | stage |
//! |---|---|
//! | [`observations`], [`noise`] | readings with their labels, and how far each channel scatters |
//! | [`hypothesis`], [`model`] | what may be wrong, and the model that computes readings where it is |
//! | [`covariance`] | what no cause explains: noise, a smooth background, known errors of the model |
//! | [`search`] | group score tests with a cluster bootstrap choose causes; rivals, constancy, zeros and intervals of those that are found |
//! | [`regression`] | readings as a function of labels, where there is no model |
//! | [`policy`], [`error`] | how sure all studies are; why one ends without an answer |
//!
//! Sources: M. C. Kennedy, A. O'Hagan, J. R. Statist. Soc. B 63 (2001) 425 (a discrepancy beside the parameters); J.
//! Brynjarsdottir, A. O'Hagan, Inverse Problems 30 (2014) 114007 (without it parameters are wrong and too sure).

pub mod covariance;
pub mod error;
pub mod hypothesis;
pub mod model;
pub mod noise;
pub mod observations;
pub mod policy;
pub mod regression;
pub mod search;
