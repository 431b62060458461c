//! Detection limits: the sizes from which on causes are found, and the causes that could not be tested.

use super::super::numbers::{decimals, parts, rounded, with_unit};
use super::drawing::escaped;
use super::subject::Subject;
use super::words::{capital, cause};
use tactpad::lab::diagnosis::report::{NotDetected, NotTestable};
use tactpad::lab::effect::Effect;

/// A cause that another one reproduces to this part would hardly have been named alone.
const LIKE: f64 = 0.8;

/// The section of the sizes.
pub(super) fn sizes(subject: &Subject<'_>) -> String {
    let all = &subject.diagnosis.not_detected;
    let head = "<section id=\"limits\"><h2>What could not have been seen</h2>";
    if all.is_empty() {
        return format!("{head}<p>Every cause that was asked for was found.</p></section>");
    }
    let rows: String = groups(all).iter().map(|group| group.row()).collect();
    format!(
        "{head}<p>These causes were asked for and not found. From the size in the table on, nine of ten such measurements would have \
         found them; what is smaller may be there.</p><table class=\"sizes\"><thead><tr><th scope=\"col\">cause</th><th \
         scope=\"col\">size</th><th scope=\"col\" class=\"number\">where it is seen best</th><th scope=\"col\" \
         class=\"number\">where worst</th><th scope=\"col\" class=\"number\">places</th></tr></thead><tbody>{rows}</tbody></table>{}</section>",
        list(subject)
    )
}

/// One number of a cause over all its targets.
struct Group {
    effect: Effect,
    name: &'static str,
    /// Sizes that are any.
    sizes: Vec<f64>,
    places: usize,
}

fn groups(all: &[NotDetected]) -> Vec<Group> {
    let mut groups: Vec<Group> = Vec::new();
    for (it, (name, size)) in
        all.iter().flat_map(|it| it.minimum_detectable.iter().map(move |size| (it, *size)))
    {
        let known = groups.iter().position(|group| group.effect == it.effect && group.name == name);
        let at = known.unwrap_or(groups.len());
        if known.is_none() {
            groups.push(Group { effect: it.effect, name, sizes: Vec::new(), places: 0 });
        }
        groups[at].places += 1;
        groups[at].sizes.extend(Some(size).filter(|size| size.is_finite()));
    }
    groups.sort_by_key(|group| all.iter().position(|it| it.effect == group.effect));
    groups
}

impl Group {
    fn row(&self) -> String {
        let least = self.sizes.iter().copied().fold(f64::INFINITY, f64::min);
        let greatest = if self.sizes.len() < self.places {
            f64::INFINITY
        } else {
            self.sizes.iter().copied().fold(0.0, f64::max)
        };
        let places = if self.places == 1 { String::new() } else { self.places.to_string() };
        let worst = if self.places == 1 { String::new() } else { size(self.name, greatest) };
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"number\">{}</td><td class=\"number\">{worst}</td><td \
             class=\"number\">{places}</td></tr>",
            escaped(self.effect.title()),
            escaped(&what(self.name)),
            size(self.name, least)
        )
    }
}

/// The name of a number.
fn what(name: &str) -> String {
    let (what, _) = parts(name);
    if what.is_empty() { "size".to_owned() } else { what }
}

/// A deviation from none, with its unit: without one, in per cent.
fn size(name: &str, size: f64) -> String {
    if !size.is_finite() {
        return "at no size".to_owned();
    }
    let (value, unit) = match parts(name).1 {
        unit @ ("" | "/°C") => (100.0 * size, format!("%{unit}")),
        unit => (size, unit.to_owned()),
    };
    with_unit(&rounded(value, decimals(value)), &unit)
}

/// All of them, one by one.
fn list(subject: &Subject<'_>) -> String {
    let all = &subject.diagnosis.not_detected;
    let row = |it: &NotDetected| {
        let sizes = it
            .minimum_detectable
            .iter()
            .map(|(name, value)| format!("{} {}", what(name), size(name, *value)));
        let sizes: Vec<String> = sizes.collect();
        let sizes = if sizes.is_empty() { "at no size".to_owned() } else { sizes.join(", ") };
        let like = if it.rival_share >= LIKE { " hardly" } else { "" };
        format!(
            "<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"number\">{:.0} %{like}</td></tr>",
            escaped(&capital(&cause(it.effect, &it.target, &subject.diagnosis.channels))),
            escaped(&sizes),
            100.0 * it.rival_share
        )
    };
    let rows: String = all.iter().map(row).collect();
    format!(
        "<details><summary>All {} causes and places</summary><p>The last column says how much of the cause’s signature the most similar \
         other cause has. From 80 % on the two are hardly told apart.</p><table><thead><tr><th scope=\"col\">cause</th><th \
         scope=\"col\">found from</th><th scope=\"col\" class=\"number\">like another</th></tr></thead><tbody>{rows}</tbody></table></details>",
        all.len()
    )
}

/// The causes that could not be tested, by the columns that they need.
pub(super) fn untested(subject: &Subject<'_>) -> String {
    let all = &subject.diagnosis.not_testable;
    let head = "<section id=\"untested\"><h2>What could not be tested</h2>";
    if all.is_empty() {
        return format!(
            "{head}<p>Nothing: the table has what every cause of the catalogue needs.</p></section>"
        );
    }
    let mut needs: Vec<&str> = all.iter().map(|it| it.needs).collect();
    needs.sort_unstable();
    needs.dedup();
    let row = |column: &&str| {
        let effects = all.iter().filter(|it| it.needs == *column).map(|it| it.effect.title());
        let effects: Vec<&str> = effects.collect();
        let effects = escaped(&effects.join(", "));
        if NotTestable::needs_column(column) {
            format!("<li>Without <code>{}</code> that varies: {effects}.</li>", escaped(column))
        } else {
            format!("<li>Without {}: {effects}.</li>", escaped(column))
        }
    };
    format!("{head}<ul>{}</ul></section>", needs.iter().map(row).collect::<String>())
}
