//! Every number of a device as a named parameter, to be looked at, varied and written about.

use std::fmt;
use std::str::FromStr;
use std::sync::LazyLock;

use super::behaviour::Behaviour;
use super::reading::parameter_name;
use super::schema::behaviour::BEHAVIOUR;
use super::schema::{Effect, GAUGE, GAUGE_NAMES, Key, MATERIALS, MODULE, TABLES};
use super::unit::Unit;
use super::{Device, Gauge, Module};
use crate::quantity::MODULES;
use crate::toml_text::spelling;

/// One number of a [`Device`].
///
/// Its name is the way to it in the device file: `plate.thickness_mm`, `material.pick.e_mpa`, `gauge.R1.x`. Modules
/// are counted by their `index`, as `module.0.radial_mm`; in a list each number is one: `modules.angles_deg.1` and
/// `module.2.gain.z`, and by channel where there is one for each: `noise.additive_uv.m0x`. The order is that of
/// [`Parameter::all`]. The figures under `[reported]` and those in lists of any length, as `[[creep]]`, are no parameters.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Parameter(usize);

/// A name that no parameter has.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnknownParameter {
    name: String,
}

struct Listed {
    name: String,
    home: Home,
    element: usize,
}

/// The record that holds the number, and its key there.
#[derive(Clone, Copy)]
enum Home {
    Pad(&'static Key<Device>),
    Gauge(usize, &'static Key<Gauge>),
    Module(usize, &'static Key<Module>),
    Behaviour(&'static Key<Behaviour>),
}

static LISTED: LazyLock<Vec<Listed>> = LazyLock::new(|| {
    let mut list = Vec::new();
    for table in TABLES.iter().chain(&MATERIALS) {
        table.keys.iter().for_each(|key| add(&mut list, table.path, key, Home::Pad(key)));
    }
    for (index, name) in GAUGE_NAMES.iter().enumerate() {
        GAUGE.iter().for_each(|key| add(&mut list, &format!("gauge.{name}"), key, Home::Gauge(index, key)));
    }
    for index in 0..MODULES {
        MODULE
            .iter()
            .for_each(|key| add(&mut list, &format!("module.{index}"), key, Home::Module(index, key)));
    }
    for table in &BEHAVIOUR {
        table.keys.iter().for_each(|key| add(&mut list, table.path, key, Home::Behaviour(key)));
    }
    list
});

fn add<T>(list: &mut Vec<Listed>, path: &str, key: &Key<T>, home: Home) {
    list.extend(key.elements.iter().enumerate().map(|(element, element_name)| Listed {
        name: parameter_name(path, key.name, element_name),
        home,
        element,
    }));
}

/// Traits of a key's number, whichever table it is in.
struct Traits {
    unit: Unit,
    range: (f64, f64),
    effect: Effect,
}

impl<T> Key<T> {
    const fn traits(&self) -> Traits {
        Traits { unit: self.unit, range: self.range, effect: self.effect }
    }
}

impl Parameter {
    /// Every parameter, in the order of the device file.
    pub fn all() -> impl Iterator<Item = Self> {
        (0..LISTED.len()).map(Self)
    }

    fn listed(self) -> &'static Listed {
        // Only `all` makes parameters, so each is one of the list's.
        &LISTED[self.0]
    }

    /// Its name.
    pub fn name(self) -> &'static str {
        &self.listed().name
    }

    /// Its value in `device`, in [`Self::unit`].
    pub fn get(self, device: &Device) -> f64 {
        let Listed { home, element, .. } = *self.listed();
        match home {
            Home::Pad(key) => (key.access.get)(device)[element],
            Home::Gauge(index, key) => (key.access.get)(&device.gauges[index])[element],
            Home::Module(index, key) => (key.access.get)(&device.modules[index])[element],
            Home::Behaviour(key) => (key.access.get)(&device.behaviour)[element],
        }
    }

    /// Changes it in `device`, to any value. Whether such a device can be is not looked at: what
    /// [`Device::to_toml`] writes of it tells, read again.
    pub fn set(self, device: &mut Device, value: f64) {
        let Listed { home, element, .. } = *self.listed();
        match home {
            Home::Pad(key) => (key.access.get_mut)(device)[element] = value,
            Home::Gauge(index, key) => (key.access.get_mut)(&mut device.gauges[index])[element] = value,
            Home::Module(index, key) => (key.access.get_mut)(&mut device.modules[index])[element] = value,
            Home::Behaviour(key) => (key.access.get_mut)(&mut device.behaviour)[element] = value,
        }
    }

    /// Unit of the number.
    pub fn unit(self) -> Unit {
        self.traits().unit
    }

    /// The least and the greatest value that a device file may give it.
    pub fn range(self) -> (f64, f64) {
        self.traits().range
    }

    /// Part of the pad that it changes.
    pub fn effect(self) -> Effect {
        self.traits().effect
    }

    /// The module that it is a number of, if it is one of a `[[module]]` table.
    pub fn module(self) -> Option<usize> {
        match self.listed().home {
            Home::Module(index, _) => Some(index),
            Home::Pad(_) | Home::Gauge(..) | Home::Behaviour(_) => None,
        }
    }

    fn traits(self) -> Traits {
        match self.listed().home {
            Home::Pad(key) => key.traits(),
            Home::Gauge(_, key) => key.traits(),
            Home::Module(_, key) => key.traits(),
            Home::Behaviour(key) => key.traits(),
        }
    }
}

impl fmt::Debug for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for Parameter {
    type Err = UnknownParameter;

    fn from_str(name: &str) -> Result<Self, UnknownParameter> {
        let found = Self::all().find(|parameter| parameter.name() == name);
        found.ok_or_else(|| UnknownParameter { name: name.to_owned() })
    }
}

impl fmt::Display for UnknownParameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a device has no number {:?}", self.name)?;
        match spelling::nearest(&self.name, Parameter::all().map(Parameter::name)) {
            Some(near) => write!(f, "; did you mean {near:?}?"),
            None => write!(f, "; numbers are named as plate.thickness_mm or module.0.radial_mm"),
        }
    }
}

impl std::error::Error for UnknownParameter {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_lead_to_the_numbers_that_they_name() {
        let device = Device::nominal();
        let value = |name: &str| name.parse::<Parameter>().unwrap().get(&device);
        assert_eq!(value("plate.diameter_mm"), 60.0);
        assert_eq!(value("modules.angles_deg.2"), 240.0);
        assert_eq!(value("stack.frame_width_mm"), 0.8);
        assert_eq!(value("material.pick.e_mpa"), 19_000.0);
        assert_eq!(value("material.adh.nu"), 0.4);
        assert_eq!(value("gauge_law.gauge_factor"), 2.0);
        assert_eq!(value("gauge.R1.x"), -3.3);
        assert_eq!(value("gauge.R6.resistance_ratio"), 0.5);
        assert_eq!(value("circuit.excitation_v"), 2.8);
        assert_eq!(value("contact.full_scale_n"), 5.0);
        assert_eq!(value("module.2.frame_e_factor"), 1.0);
        assert_eq!(value("module.0.offset_uv.z"), 0.0);
        assert_eq!(value("thermal.reference_c"), 25.0);
        assert_eq!(value("ageing.cycles"), 50_000.0);
        assert_eq!(value("noise.walk_uv.m2z"), 0.0);
        assert_eq!(value("rig.reference_zero_n.z"), 0.0);
    }

    #[test]
    fn each_parameter_is_a_number_of_its_own() {
        let nominal = Device::nominal();
        let count = Parameter::all().count();
        // Of the pad: 2 + 4 + 11 + 2 + 1 + 3 and seven materials' 3; seven gauges' 5; three modules' 9 and two lists.
        // Of its behaviour, by table: some numbers, and nine for each list of channels.
        let behaviour = (3 + 27) + (2 + 9) + (1 + 36) + (1 + 9) + (2 + 9) + 4 + 14;
        assert_eq!(count, 23 + 21 + 35 + 45 + behaviour);
        for changed in Parameter::all() {
            assert_eq!(changed.name().parse(), Ok(changed));
            let mut device = nominal.clone();
            changed.set(&mut device, 0.123);
            for parameter in Parameter::all() {
                let expected = if parameter == changed { 0.123 } else { parameter.get(&nominal) };
                assert_eq!(parameter.get(&device), expected, "{changed} changes {parameter}");
            }
        }
    }

    #[test]
    fn only_readout_behaviour_and_labels_leave_the_field_alone() {
        let idle: Vec<_> = Parameter::all().filter(|it| it.effect() != Effect::Field).collect();
        let with =
            |effect| idle.iter().filter(|it| it.effect() == effect).map(|it| it.name()).collect::<Vec<_>>();
        assert_eq!(
            with(Effect::Nothing),
            [
                "contact.full_scale_n",
                "material.gauge.e_mpa",
                "material.gauge.nu",
                "material.gauge.density_kg_m3"
            ]
        );
        let dynamics = with(Effect::Dynamics);
        assert_eq!(dynamics.len(), 6);
        assert!(dynamics.iter().all(|name| name.ends_with(".density_kg_m3")), "{dynamics:?}");
        let behaviour = with(Effect::Behaviour);
        assert_eq!(behaviour.len(), 117);
        assert!(behaviour.contains(&"sampling.skew_us.m0x") && behaviour.contains(&"finger.wander_mm"));
        let readout = with(Effect::Readout);
        assert_eq!(readout.len(), 18);
        assert!(
            readout.iter().all(|name| name.contains(".gain.") || name.contains(".offset_uv.")),
            "{readout:?}"
        );
    }

    #[test]
    fn unknown_names_find_their_neighbour() {
        let said = |name: &str| name.parse::<Parameter>().unwrap_err().to_string();
        assert!(said("plate.thicknes_mm").ends_with("did you mean \"plate.thickness_mm\"?"));
        assert!(said("colour").ends_with("as plate.thickness_mm or module.0.radial_mm"));
    }
}
