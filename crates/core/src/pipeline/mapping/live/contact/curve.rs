//! How far an axis or the pointer's speed goes.

/// ((x − a)/(b − a))ᶜ, 0 below a and 1 above b.
pub(crate) fn share(at: f32, [rest, full]: [f32; 2], curve: f32) -> f32 {
    libm::powf(((at - rest) / (full - rest)).clamp(0.0, 1.0), curve)
}
