//! A network whose file has no checksum, held against presses of the nominal pad.

use crate::network::OUTPUTS;
use crate::pad::field::PadField;
use crate::quantity::{CHANNELS, Contact};

/// Presses on a spiral over the plate, light and firm, straight and with shear.
const PRESSES: u16 = 60;
/// Far beyond any plate and any finger: what gives more is no decoder, or its file is damaged.
const PLACE_MAX_MM: f32 = 300.0;
const FORCE_MAX_N: f32 = 100.0;
/// Largest unexplained part of the presses' places, and of their forces, as a share of their mean square.
const UNEXPLAINED_MAX: f32 = 0.1;

/// Errors of a network at presses of the nominal pad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PressErrors {
    /// Root mean square distance.
    pub place_mm: f32,
    /// Root mean square of the force's error.
    pub force_n: f32,
    is_large: bool,
}

/// Decodes presses of the nominal pad; `None` where a contact is not finite, or absurd.
pub(super) fn misses(decode: impl Fn(&[f32; CHANNELS]) -> [f32; OUTPUTS]) -> Option<PressErrors> {
    let signals = PadField::nominal().signals;
    let reach_mm = signals.radius_mm();
    // Squares of the places' errors and of the places, of the forces' errors and of the forces.
    let mut squares = [0.0; 4];
    for press in (0..PRESSES).map(|index| press(index, reach_mm)) {
        let [x_mm, y_mm, fx_n, fy_n, fz_n] = decode(&signals.strain_uv(&press).uv);
        let is_sound = [x_mm, y_mm].iter().all(|mm| mm.abs() <= PLACE_MAX_MM)
            && [fx_n, fy_n, fz_n].iter().all(|n| n.abs() <= FORCE_MAX_N);
        if !is_sound {
            return None;
        }
        let off_n = [fx_n - press.fx_n, fy_n - press.fy_n, fz_n - press.fz_n];
        let of = |numbers: &[f32]| numbers.iter().map(|number| number * number).sum::<f32>();
        let all = [
            of(&[x_mm - press.x_mm, y_mm - press.y_mm]),
            of(&[press.x_mm, press.y_mm]),
            of(&off_n),
            of(&[press.fx_n, press.fy_n, press.fz_n]),
        ];
        squares.iter_mut().zip(all).for_each(|(sum, square)| *sum += square / f32::from(PRESSES));
    }
    let [place, places, force, forces] = squares;
    Some(PressErrors {
        place_mm: libm::sqrtf(place),
        force_n: libm::sqrtf(force),
        is_large: place > UNEXPLAINED_MAX * places || force > UNEXPLAINED_MAX * forces,
    })
}

impl PressErrors {
    /// Whether the network is of another pad, or none of a pad.
    pub const fn are_large(&self) -> bool {
        self.is_large
    }
}

/// The press of this index: places by the golden angle, forces in a pattern that does not repeat with them.
fn press(index: u16, reach_mm: f32) -> Contact {
    let turn = f32::from(index) * 2.399_963;
    let radius_mm = reach_mm * libm::sqrtf((f32::from(index) + 0.5) / f32::from(PRESSES));
    let fz_n = 0.5 + f32::from(index % 7) * 0.7;
    let shear_n = 0.4 * fz_n * f32::from(index % 3);
    Contact {
        x_mm: radius_mm * libm::cosf(turn),
        y_mm: radius_mm * libm::sinf(turn),
        fx_n: shear_n * libm::cosf(3.0 * turn),
        fy_n: shear_n * libm::sinf(3.0 * turn),
        fz_n,
    }
}
