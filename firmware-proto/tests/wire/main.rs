//! The wire protocol as a stranger meets it: golden frames, damage, reports, and the README's own examples.

#[cfg(test)]
mod damage;
#[cfg(test)]
mod random;
#[cfg(test)]
mod readme;
#[cfg(test)]
mod report;
#[cfg(test)]
mod vectors;
