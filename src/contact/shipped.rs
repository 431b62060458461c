//! The decoders that are inside the program.

use super::Decoder;
use super::statics::{NOMINAL, Statics};

/// Plays unless another one is asked for.
pub const STATICS: &str = "statics";

/// The paper's network after its stage I.
const SCDF: &str = "scdf";

impl Decoder {
    /// The decoder that plays unless another one is asked for.
    pub fn shipped() -> Self {
        Self::Statics(Statics::nominal())
    }
}

/// The file of the shipped decoder `name`, or `None` if there is none of that name.
pub fn bytes(name: &str) -> Option<&'static [u8]> {
    match name {
        STATICS => Some(NOMINAL.as_bytes()),
        SCDF => Some(include_bytes!("../../models/scdf.onnx")),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::read;
    use crate::quantity::Strain;

    #[test]
    fn each_plays_and_statics_is_the_one_that_is_not_asked_for() {
        let strain = Strain { uv: std::array::from_fn(|k| 300.0 - 55.0 * k as f32) };
        let decoded = |name: &str| {
            let decoder = read::playing(bytes(name).unwrap()).unwrap();
            (decoder.name(), decoder.decode(&strain))
        };
        assert_eq!(decoded(STATICS), ("statics", Decoder::shipped().decode(&strain)));
        assert_eq!(decoded(SCDF).0, "network");
        assert_eq!(bytes("nope"), None);
    }
}
