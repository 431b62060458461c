//! What libinput's own tests know of real devices: read from their C sources, which `fetch-devices.sh` fetches.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::guest::{cache, host_folder};

use evdev::{
    AbsInfo, AbsoluteAxisCode, BusType, EventType, InputId, KeyCode, MiscCode, PropType, RelativeAxisCode,
};

/// What makes the sources.
pub(crate) const FETCH: &str = "tests/kernel/fetch-devices.sh";

/// A value that the stroke decides.
const AUTO: &str = "LITEST_AUTO_ASSIGN";

/// A tool that the stroke decides.
const TOOL: &str = "LITEST_BTN_TOOL_AUTO";

/// An event as a device sends it: what it is of, and its value, where the stroke does not decide it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Told {
    pub(crate) kind: EventType,
    /// `None` is the tool at hand.
    pub(crate) code: Option<u16>,
    pub(crate) value: Option<i32>,
}

/// A real device.
#[derive(Clone, Debug)]
pub(crate) struct RealDevice {
    pub(crate) name: String,
    pub(crate) id: InputId,
    pub(crate) axes: Vec<(AbsoluteAxisCode, AbsInfo)>,
    pub(crate) keys: Vec<KeyCode>,
    pub(crate) relative: Vec<RelativeAxisCode>,
    pub(crate) misc: Vec<MiscCode>,
    pub(crate) properties: Vec<PropType>,
    /// Whole reports by the name of their table, as `proximity_in`.
    pub(crate) reports: BTreeMap<String, Vec<Told>>,
}

/// The newest sources that were fetched; `None` without any.
pub(crate) fn folder() -> Option<PathBuf> {
    host_folder("libinput", fetched)
}

fn fetched() -> Option<PathBuf> {
    let entries = fs::read_dir(cache()?).ok()?;
    let found = entries.filter_map(|entry| {
        let path = entry.ok()?.path();
        let version = path.file_name()?.to_str()?.strip_prefix("libinput-")?;
        let numbers: Vec<u32> = version.split('.').map_while(|part| part.parse().ok()).collect();
        Some((numbers, path))
    });
    found.max().map(|(_, path)| path)
}

/// The device that a source of this name is about.
pub(crate) fn device(folder: &Path, name: &str) -> RealDevice {
    let path = folder.join("test").join(format!("litest-device-{name}.c"));
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    read(&text).unwrap_or_else(|what| panic!("{}: {what} is not as this reader knows it", path.display()))
}

/// Vendor, product and the size in mm of what a section of the quirks is about.
pub(crate) fn quirk(folder: &Path, section: &str) -> (u16, u16, [f64; 2]) {
    let path = folder.join("quirks/50-system-apple.quirks");
    let text = fs::read_to_string(path).expect("the quirks of Apple's devices");
    let lines = text.lines().skip_while(|line| *line != format!("[{section}]")).skip(1);
    let keys: BTreeMap<&str, &str> =
        lines.take_while(|line| !line.starts_with('[')).filter_map(|line| line.split_once('=')).collect();
    let number = |key: &str| number(keys[key]).and_then(|number| u16::try_from(number).ok());
    let (width, height) = keys["AttrSizeHint"].split_once('x').expect("a size");
    let size_mm = [width, height].map(|mm| mm.parse().expect("mm"));
    (number("MatchVendor").expect("a vendor"), number("MatchProduct").expect("a product"), size_mm)
}

/// Reads a source; the error is the part that is not understood.
fn read(text: &str) -> Result<RealDevice, String> {
    let text = without_comments(text);
    let name = text.split(".name = \"").nth(1).and_then(|rest| rest.split('"').next()).ok_or(".name")?;
    let id = body(&text, "input_id input_id = {").ok_or("input_id")?;
    let field = |key: &str| {
        let value =
            id.split(key).nth(1).and_then(|rest| rest.trim_start_matches([' ', '=']).split(',').next());
        value.and_then(number).and_then(|number| u16::try_from(number).ok()).ok_or(key.to_owned())
    };
    let bus = BusType(field(".bustype")?);
    let version = field(".version").unwrap_or(0);
    let mut device = RealDevice {
        name: name.to_owned(),
        id: InputId::new(bus, field(".vendor")?, field(".product")?, version),
        axes: Vec::new(),
        keys: Vec::new(),
        relative: Vec::new(),
        misc: Vec::new(),
        properties: Vec::new(),
        reports: BTreeMap::new(),
    };
    for row in rows(body(&text, "input_absinfo absinfo[] = {").unwrap_or_default()) {
        let fields: Vec<&str> = row.split(',').map(str::trim).filter(|field| !field.is_empty()).collect();
        let [axis, ranges @ ..] = &fields[..] else { continue };
        if axis.starts_with('.') {
            break;
        }
        let axis = AbsoluteAxisCode::from_str(axis).map_err(|_| (*axis).to_owned())?;
        let numbers: Vec<i32> = ranges.iter().map_while(|field| number(field)).collect();
        let [minimum, maximum, fuzz, flat, resolution] = numbers[..] else { return Err(row.to_owned()) };
        device.axes.push((axis, AbsInfo::new(0, minimum, maximum, fuzz, flat, resolution)));
    }
    let events: Vec<&str> = body(&text, "int events[] = {")
        .unwrap_or_default()
        .split(',')
        .map(str::trim)
        .filter(|word| !word.is_empty())
        .collect();
    for pair in events.chunks(2) {
        let wrong = || pair.join(", ");
        match *pair {
            ["-1", ..] => break,
            ["EV_KEY", key] => device.keys.push(self::key(key).ok_or_else(wrong)?),
            ["EV_REL", axis] => device.relative.push(RelativeAxisCode::from_str(axis).map_err(|_| wrong())?),
            ["EV_MSC", misc] => device.misc.push(MiscCode::from_str(misc).map_err(|_| wrong())?),
            ["INPUT_PROP_MAX", property] => {
                device.properties.push(self::property(property).ok_or_else(wrong)?);
            }
            _ => {}
        }
    }
    for table in text.split("static struct input_event ").skip(1) {
        let name = table.split("[]").next().unwrap_or_default();
        let mut report = Vec::new();
        for row in rows(body(table, "[] = {").unwrap_or_default()) {
            report.extend(told(row)?);
        }
        device.reports.insert(name.to_owned(), report);
    }
    Ok(device)
}

/// The event of a row; nothing for the end of a report and of a table.
fn told(row: &str) -> Result<Option<Told>, String> {
    let field = |key: &str| {
        let value = row.split(key).nth(1)?.trim_start_matches([' ', '=']);
        value.split(',').next().map(str::trim)
    };
    let (kind, code) = (field(".type").unwrap_or_default(), field(".code").unwrap_or_default());
    let value = field(".value").unwrap_or_default();
    let value = if value == AUTO { None } else { Some(number(value).unwrap_or_default()) };
    let wrong = |_| row.to_owned();
    let (kind, code) = match kind {
        "EV_ABS" => (EventType::ABSOLUTE, Some(AbsoluteAxisCode::from_str(code).map_err(wrong)?.0)),
        "EV_KEY" if code == TOOL => (EventType::KEY, None),
        "EV_KEY" => (EventType::KEY, Some(KeyCode::from_str(code).map_err(wrong)?.0)),
        "EV_MSC" => (EventType::MISC, Some(MiscCode::from_str(code).map_err(wrong)?.0)),
        _ => return Ok(None),
    };
    Ok(Some(Told { kind, code, value }))
}

fn key(name: &str) -> Option<KeyCode> {
    // The evdev crate has no name for it.
    if name == "BTN_STYLUS3" { Some(KeyCode(0x149)) } else { KeyCode::from_str(name).ok() }
}

fn property(name: &str) -> Option<PropType> {
    PropType::from_str(name.strip_prefix("INPUT_PROP_")?).or_else(|_| PropType::from_str(name)).ok()
}

/// A number of C: decimal or hexadecimal.
fn number(word: &str) -> Option<i32> {
    let word = word.trim();
    match word.strip_prefix("0x") {
        Some(digits) => i32::from_str_radix(digits, 16).ok(),
        None => word.parse().ok(),
    }
}

/// What stands between `before` and the end of its braces.
fn body<'a>(text: &'a str, before: &str) -> Option<&'a str> {
    text.split(before).nth(1)?.split("};").next()
}

/// What stands in each pair of braces.
fn rows(body: &str) -> impl Iterator<Item = &str> {
    body.split('{').skip(1).filter_map(|row| row.split('}').next())
}

fn without_comments(text: &str) -> String {
    let mut parts = text.split("/*");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |text, part| text + part.split_once("*/").map_or("", |(_, rest)| rest))
}

/// A source of our own is read as it is meant.
pub(crate) fn sources_are_read_as_they_say() {
    let text = "/* { ABS_Z, 1, 2, 3, 4, 5 } */\nstatic struct input_event proximity_in[] = {\n\
        { .type = EV_ABS, .code = ABS_X, .value = LITEST_AUTO_ASSIGN },\n{ .type = EV_KEY, .code = LITEST_BTN_TOOL_AUTO, .value = 1 },\n\
        { .type = EV_MSC, .code = MSC_SERIAL, .value = 17 },\n{ .type = EV_SYN, .code = SYN_REPORT, .value = 0 },\n\
        { .type = -1, .code = -1 },\n};\nstatic struct input_absinfo absinfo[] = {\n{ ABS_X, -5, 0x10, 4, 0, 200 }, /* why */\n\
        { .value = -1 },\n};\nstatic struct input_id input_id = {\n.bustype = 0x3,\n.vendor = 0x56a,\n.product = 27,\n};\n\
        static int events[] = {\nEV_KEY, BTN_TOOL_PEN,\nEV_MSC, MSC_SERIAL,\nINPUT_PROP_MAX, INPUT_PROP_DIRECT,\n-1, -1,\n};\n\
        TEST_DEVICE(X, .name = \"A pen\", )\n";
    let device = read(text).expect("a source");
    assert_eq!(device.name, "A pen");
    assert_eq!(
        (device.id.vendor(), device.id.product(), device.id.bus_type()),
        (0x56a, 27, BusType::BUS_USB)
    );
    let [(axis, info)] = device.axes[..] else { panic!("{:?}", device.axes) };
    assert_eq!(
        (axis, info.minimum(), info.maximum(), info.fuzz(), info.resolution()),
        (AbsoluteAxisCode::ABS_X, -5, 16, 4, 200)
    );
    assert_eq!(
        (&device.keys[..], &device.properties[..]),
        (&[KeyCode::BTN_TOOL_PEN][..], &[PropType::DIRECT][..])
    );
    let told = |kind, code, value| Told { kind, code, value };
    let wanted = [
        told(EventType::ABSOLUTE, Some(0), None),
        told(EventType::KEY, None, Some(1)),
        told(EventType::MISC, Some(0), Some(17)),
    ];
    assert_eq!(device.reports["proximity_in"], wanted);
    assert!(read("nothing").is_err());
}
