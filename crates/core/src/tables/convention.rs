//! How the labels of a table are meant: their frame, their signs, and their units.
//!
//! The contact in the pad's frame, in millimetres and newtons, is s; what somebody wrote down is w. With a map M of the plane
//! (turned, and perhaps mirrored) wₓᵧ = M sₓᵧ/u for places in units of u millimetres, and with a further map S of the forces, which turns signs,
//! w_F = S M s_F/v for forces in units of v newtons. A force out of the plate knows its sign alone.

use std::fmt;
use std::str::FromStr;

use super::measured::{Label, Row, Table};
use super::units::Units;

/// A map of the plane that keeps lengths: y is mirrored or not, then all is turned.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PlaneMap {
    /// By how much it turns, counter-clockwise, from −180 (not included) to 180.
    turn_deg: f64,
    /// Whether y is mirrored before.
    is_mirrored: bool,
}

/// Angles that are written as names of axes are this close to a right angle.
const RIGHT_ANGLE_TOLERANCE_DEG: f64 = 1e-9;

impl PlaneMap {
    /// Nothing is changed.
    pub const IDENTITY: Self = Self { turn_deg: 0.0, is_mirrored: false };

    /// Mirrors y, or not, and turns counter-clockwise.
    pub fn new(turn_deg: f64, is_mirrored: bool) -> Self {
        let turn_deg = turn_deg.rem_euclid(360.0);
        Self { turn_deg: if turn_deg > 180.0 { turn_deg - 360.0 } else { turn_deg }, is_mirrored }
    }

    /// By how much it turns, counter-clockwise, from −180 (not included) to 180.
    pub const fn turn_deg(&self) -> f64 {
        self.turn_deg
    }

    /// Whether it mirrors.
    pub const fn is_mirrored(&self) -> bool {
        self.is_mirrored
    }

    /// Its image of a point or a vector.
    pub fn of(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let y = if self.is_mirrored { -y } else { y };
        let [cos, sin] = self.cos_sin();
        [cos * x - sin * y, sin * x + cos * y]
    }

    /// Exact for right angles.
    fn cos_sin(&self) -> [f64; 2] {
        match self.right_angles() {
            Some(0) => [1.0, 0.0],
            Some(1) => [0.0, 1.0],
            Some(2) => [-1.0, 0.0],
            Some(3) => [0.0, -1.0],
            _ => [libm::cos(self.turn_deg.to_radians()), libm::sin(self.turn_deg.to_radians())],
        }
    }

    /// By how many right angles it turns, if it turns by such.
    fn right_angles(&self) -> Option<i64> {
        let angles = self.turn_deg / 90.0;
        let whole = libm::round(angles);
        ((angles - whole).abs() * 90.0 < RIGHT_ANGLE_TOLERANCE_DEG).then_some((whole as i64).rem_euclid(4))
    }

    /// The map that undoes it. A mirror image undoes itself.
    #[must_use]
    pub fn inverse(&self) -> Self {
        if self.is_mirrored { *self } else { Self::new(-self.turn_deg, false) }
    }

    /// This map after another one.
    #[must_use]
    pub fn after(&self, first: &Self) -> Self {
        // R(a) K R(b) = R(a − b) K with the mirror image K.
        let turn_deg = self.turn_deg + if self.is_mirrored { -first.turn_deg } else { first.turn_deg };
        Self::new(turn_deg, self.is_mirrored != first.is_mirrored)
    }

    /// Reads two axes, an angle, or both: `x,-y`, `turn=120`, `x,-y,turn=30`. A frame that is turned by an angle turns what is written in it
    /// back by that.
    fn parsed(text: &str, axes: [&str; 2]) -> Option<Self> {
        let parts: Vec<&str> = text.split(',').map(str::trim).collect();
        let (turn, named) = match parts.split_last()? {
            (last, before) if last.starts_with("turn=") => {
                (last["turn=".len()..].trim().parse().ok().filter(|angle: &f64| angle.is_finite())?, before)
            }
            _ => (0.0, parts.as_slice()),
        };
        let turned = Self::new(-turn, false);
        match *named {
            [] => Some(turned),
            [first, second] => {
                let [first, second] = [signed(first, axes)?, signed(second, axes)?];
                let map = (0..8).map(|at| Self::new(90.0 * f64::from(at % 4), at >= 4));
                let is_named = |map: &Self| {
                    let rows = [map.of([1.0, 0.0]), map.of([0.0, 1.0])];
                    [first, second].iter().enumerate().all(|(row, (axis, sign))| rows[*axis][row] == *sign)
                };
                Some(turned.after(&map.into_iter().find(is_named)?))
            }
            _ => None,
        }
    }

    /// The same in words that [`Self::parsed`] reads.
    fn text(&self, axes: [&str; 2]) -> String {
        let by_axes = |map: &Self| {
            let columns = [map.of([1.0, 0.0]), map.of([0.0, 1.0])];
            let axis = |row: usize| {
                let from = usize::from(columns[1][row] != 0.0);
                let sign = if columns[from][row] < 0.0 { "-" } else { "" };
                format!("{sign}{}", axes[from])
            };
            format!("{},{}", axis(0), axis(1))
        };
        let turn = rounded(-self.turn_deg);
        match (self.right_angles(), self.is_mirrored) {
            (Some(_), _) => by_axes(self),
            (None, false) => format!("turn={turn}"),
            (None, true) => format!("{},turn={turn}", by_axes(&Self::new(0.0, true))),
        }
    }
}

/// To a hundredth.
fn rounded(value: f64) -> f64 {
    libm::round(100.0 * value) / 100.0 + 0.0
}

/// An axis with its sign: its place among these, and 1 or −1.
fn signed(text: &str, axes: [&str; 2]) -> Option<(usize, f64)> {
    let (name, sign) = text.strip_prefix('-').map_or((text, 1.0), |name| (name.trim(), -1.0));
    let name = name.strip_prefix('+').unwrap_or(name);
    Some((axes.iter().position(|axis| axis.eq_ignore_ascii_case(name))?, sign))
}

/// Frame of the written places and forces.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frame(pub PlaneMap);

impl FromStr for Frame {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        PlaneMap::parsed(text, ["x", "y"]).map(Self).ok_or_else(|| {
            "write what the columns x and y hold of the pad's axes, as \"x,-y\" or \"y,x\", or by how many degrees the frame is turned \
             counter-clockwise, as \"turn=120\""
                .into()
        })
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0.text(["x", "y"]))
    }
}

/// What written forces are beside their frame.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sign {
    /// Of Fx and Fy.
    pub plane: PlaneMap,
    /// Whether Fz is written with the other sign: out of the plate, where a finger presses into it.
    pub is_fz_reversed: bool,
}

impl FromStr for Sign {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parsed = || {
            let (plane, fz) = match text.rsplit_once(',') {
                Some((before, last)) if last.trim().starts_with("turn=") => {
                    let (before, fz) = before.rsplit_once(',')?;
                    (format!("{before},{last}"), fz)
                }
                _ => {
                    let (before, fz) = text.rsplit_once(',')?;
                    (before.to_owned(), fz)
                }
            };
            let (_, sign) = signed(fz.trim(), ["fz", "fz"])?;
            Some(Self { plane: PlaneMap::parsed(&plane, ["fx", "fy"])?, is_fz_reversed: sign < 0.0 })
        };
        parsed().ok_or_else(|| {
            "write what the columns fx, fy and fz hold, as \"fx,fy,-fz\" where fz is written with the other sign".into()
        })
    }
}

impl fmt::Display for Sign {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let sign = if self.is_fz_reversed { "-" } else { "" };
        let plane = match self.plane.right_angles() {
            Some(_) => self.plane,
            None => PlaneMap::new(0.0, self.plane.is_mirrored),
        };
        write!(f, "{},{sign}fz", plane.text(["fx", "fy"]))?;
        match self.plane.right_angles() {
            Some(_) => Ok(()),
            None => write!(f, ",turn={}", rounded(-self.plane.turn_deg)),
        }
    }
}

/// How a table is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LabelConvention {
    /// Frame of places and forces.
    pub frame: Frame,
    /// What forces are beside it.
    pub sign: Sign,
    /// Units of all.
    pub units: Units,
}

impl LabelConvention {
    /// Whether it changes nothing.
    pub fn is_default(&self) -> bool {
        *self == Self::default()
    }

    /// The label in the pad's frame, mm and N, of one that was written so.
    pub fn meant(&self, written: &Label) -> Label {
        let Self { frame, sign, units } = self;
        let [x_mm, y_mm] = frame.0.inverse().of([units.mm * written.x_mm, units.mm * written.y_mm]);
        let of_forces = sign.plane.after(&frame.0).inverse();
        let [fx_n, fy_n] = of_forces.of([units.n * written.fx_n, units.n * written.fy_n]);
        let fz_n = if sign.is_fz_reversed { -units.n * written.fz_n } else { units.n * written.fz_n };
        Label { x_mm, y_mm, fx_n, fy_n, fz_n }
    }

    /// The same of a row's label. The force of a known weight is nobody's to write.
    pub fn meant_of(&self, row: &Row) -> Label {
        let meant = self.meant(&row.label);
        row.weight_g.map_or(meant, |weight_g| meant.under_weight(weight_g))
    }

    /// What is written so of a label in the pad's frame.
    pub fn written(&self, meant: &Label) -> Label {
        let Self { frame, sign, units } = self;
        let [x_mm, y_mm] = frame.0.of([meant.x_mm, meant.y_mm]).map(|mm| mm / units.mm);
        let [fx_n, fy_n] = sign.plane.after(&frame.0).of([meant.fx_n, meant.fy_n]).map(|n| n / units.n);
        let fz_n = if sign.is_fz_reversed { -meant.fz_n / units.n } else { meant.fz_n / units.n };
        Label { x_mm, y_mm, fx_n, fy_n, fz_n }
    }

    /// The table in the pad's frame, in mm, N and µV.
    #[must_use]
    pub fn applied(&self, mut table: Table) -> Table {
        for row in &mut table.rows {
            row.label = self.meant_of(row);
            row.uv = row.uv.map(|uv| uv.map(|value| self.units.uv * value));
        }
        table
    }
}

impl fmt::Display for LabelConvention {
    /// The arguments that say it.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let default = Self::default();
        let arguments = [
            (self.frame != default.frame).then(|| format!("--frame \"{}\"", self.frame)),
            (self.sign != default.sign).then(|| format!("--sign \"{}\"", self.sign)),
            (self.units != default.units).then(|| format!("--units \"{}\"", self.units)),
        ];
        f.write_str(&arguments.into_iter().flatten().collect::<Vec<_>>().join(" "))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(text: &str) -> PlaneMap {
        text.parse::<Frame>().unwrap().0
    }

    #[test]
    fn axes_and_angles_say_what_the_columns_hold() {
        let point = [3.0, 1.0];
        for (text, written) in [
            ("x,y", [3.0, 1.0]),
            ("x,-y", [3.0, -1.0]),
            ("-x,y", [-3.0, 1.0]),
            ("y,x", [1.0, 3.0]),
            ("-y,x", [-1.0, 3.0]),
            ("y,-x", [1.0, -3.0]),
            ("-y,-x", [-1.0, -3.0]),
            ("turn=90", [1.0, -3.0]),
            ("x,-y,turn=90", [-1.0, -3.0]),
        ] {
            assert_eq!(frame(text).of(point), written, "{text}");
        }
        assert_eq!(frame("turn=120").turn_deg(), -120.0);
        for text in ["x,-y", "y,x", "-y,x", "turn=120", "turn=-33.5", "x,-y,turn=30"] {
            assert_eq!(Frame(frame(text)).to_string(), text);
        }
        assert_eq!(Frame(frame("turn=90")).to_string(), "y,-x");
        for text in ["", "x", "x,x", "x,z", "x,y,z", "turn=", "turn=nan", "fx,fy"] {
            assert!(text.parse::<Frame>().is_err(), "{text}");
        }
    }

    #[test]
    fn maps_follow_each_other_as_their_images_do() {
        let all = [(0.0, false), (120.0, false), (-33.0, true), (180.0, true), (90.0, false)];
        let maps = all.map(|(turn_deg, is_mirrored)| PlaneMap::new(turn_deg, is_mirrored));
        for first in maps {
            for second in maps {
                let [one, other] = [second.after(&first).of([3.0, 1.0]), second.of(first.of([3.0, 1.0]))];
                assert!((one[0] - other[0]).hypot(one[1] - other[1]) < 1e-12, "{first:?} {second:?}");
            }
            let [x, y] = first.inverse().of(first.of([3.0, 1.0]));
            assert!((x - 3.0).hypot(y - 1.0) < 1e-12, "{first:?}");
        }
    }

    #[test]
    fn a_label_comes_back_from_what_is_written_of_it() {
        let convention = LabelConvention {
            frame: "x,-y,turn=30".parse().unwrap(),
            sign: "-fx,-fy,-fz".parse().unwrap(),
            units: "in,lbf,mV".parse().unwrap(),
        };
        assert_eq!(
            convention.to_string(),
            "--frame \"x,-y,turn=30\" --sign \"-fx,-fy,-fz\" --units \"in,lbf,mV\""
        );
        let label = Label { x_mm: 12.0, y_mm: -5.0, fx_n: 0.5, fy_n: 0.25, fz_n: 3.0 };
        let written = convention.written(&label);
        assert!((written.fz_n + 3.0 / 4.448_222).abs() < 1e-12);
        assert!((written.x_mm.hypot(written.y_mm) - 13.0 / 25.4).abs() < 1e-12);
        let back = convention.meant(&written);
        assert!((back.x_mm - label.x_mm).hypot(back.y_mm - label.y_mm) < 1e-12, "{back:?}");
        assert!((back.fx_n - label.fx_n).hypot(back.fy_n - label.fy_n) < 1e-12, "{back:?}");
        assert!((back.fz_n - label.fz_n).abs() < 1e-12);
    }

    #[test]
    fn signs_are_read_as_they_are_written() {
        for text in ["fx,fy,-fz", "-fx,-fy,-fz", "fy,-fx,fz", "fx,fy,fz,turn=30"] {
            assert_eq!(text.parse::<Sign>().unwrap().to_string(), text);
        }
        for text in ["fx,fy", "fx,fx,fz", "x,y,z", "", "fz", ","] {
            assert!(text.parse::<Sign>().is_err(), "{text}");
        }
    }
}
