//! The finite elements against what must hold whatever they are used for: exact solutions, closed forms, balance,
//! symmetry, and finer meshes.

#[cfg(test)]
mod body;
#[cfg(test)]
mod clamped_plate;
#[cfg(test)]
mod convergence;
#[cfg(test)]
mod debonding;
#[cfg(test)]
mod manufactured;
#[cfg(test)]
mod module;
#[cfg(test)]
mod patch;
#[cfg(test)]
mod variation;
