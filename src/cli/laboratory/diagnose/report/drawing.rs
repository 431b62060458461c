//! Small drawings inside the page. The style sheet gives them their colours, so that they are light or dark as the page is.

use std::fmt::Write as _;

/// One drawing. Lengths are in units of its view: x right, y down.
pub(super) struct Drawing {
    class: &'static str,
    view: [f64; 4],
    title: String,
    marks: String,
}

impl Drawing {
    /// An empty drawing of this view: left, top, width, height. The title says to everybody what is seen.
    pub(super) fn new(class: &'static str, view: [f64; 4], title: impl Into<String>) -> Self {
        Self { class, view, title: title.into(), marks: String::new() }
    }

    /// A circle.
    pub(super) fn circle(&mut self, class: &str, [x, y]: [f64; 2], radius: f64) {
        self.element("circle", class, &[("cx", x), ("cy", y), ("r", radius)]);
    }

    /// A straight line.
    pub(super) fn line(&mut self, class: &str, [x1, y1]: [f64; 2], [x2, y2]: [f64; 2]) {
        self.element("line", class, &[("x1", x1), ("y1", y1), ("x2", x2), ("y2", y2)]);
    }

    /// A rectangle between two corners.
    pub(super) fn rectangle(&mut self, class: &str, one: [f64; 2], other: [f64; 2]) {
        let [x, y] = [one[0].min(other[0]), one[1].min(other[1])];
        let [width, height] = [(one[0] - other[0]).abs(), (one[1] - other[1]).abs()];
        self.element("rect", class, &[("x", x), ("y", y), ("width", width), ("height", height)]);
    }

    /// Lines from corner to corner; corners that are no numbers are left out.
    pub(super) fn corners(&mut self, class: &str, corners: &[[f64; 2]], is_closed: bool) {
        let finite = corners.iter().filter(|corner| corner.iter().all(|it| it.is_finite()));
        let points: Vec<String> = finite.map(|[x, y]| format!("{},{}", short(*x), short(*y))).collect();
        let element = if is_closed { "polygon" } else { "polyline" };
        if points.len() > 1 {
            let _ = write!(self.marks, "<{element} class=\"{class}\" points=\"{}\"/>", points.join(" "));
        }
    }

    /// A line of text; its class says what of it stands at the place.
    pub(super) fn text(&mut self, class: &str, [x, y]: [f64; 2], text: &str) {
        let text = escaped(text);
        let [x, y] = [x, y].map(short);
        let _ = write!(self.marks, "<text class=\"{class}\" x=\"{x}\" y=\"{y}\">{text}</text>");
    }

    /// The drawing as an element of the page.
    pub(super) fn html(&self) -> String {
        let Self { class, view, title, marks } = self;
        let [left, top, width, height] = view.map(short);
        let title = escaped(title);
        format!(
            "<svg class=\"{class}\" viewBox=\"{left} {top} {width} {height}\" role=\"img\"><title>{title}</title>{marks}</svg>"
        )
    }

    /// An element, unless one of its numbers is none.
    fn element(&mut self, name: &str, class: &str, numbers: &[(&str, f64)]) {
        if numbers.iter().any(|(_, number)| !number.is_finite()) {
            return;
        }
        let class = if class.is_empty() { String::new() } else { format!(" class=\"{class}\"") };
        let numbers: String =
            numbers.iter().map(|(key, value)| format!(" {key}=\"{}\"", short(*value))).collect();
        let _ = write!(self.marks, "<{name}{class}{numbers}/>");
    }
}

/// The text as it may stand between tags and in attributes: names in it come from files.
pub(super) fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in text.chars() {
        match letter {
            '&' => safe.push_str("&amp;"),
            '<' => safe.push_str("&lt;"),
            '>' => safe.push_str("&gt;"),
            '"' => safe.push_str("&quot;"),
            '\'' => safe.push_str("&#39;"),
            '\n' | '\t' => safe.push(' '),
            // What no page may hold, and what would turn the text around it.
            it if it.is_control() || is_invisible(it) => safe.push('\u{fffd}'),
            it => safe.push(it),
        }
    }
    safe
}

const fn is_invisible(letter: char) -> bool {
    matches!(letter, '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}' | '\u{fffe}' | '\u{ffff}')
}

/// A number with two digits behind the point at most.
fn short(number: f64) -> String {
    let text = format!("{number:.2}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_files_say_stays_text() {
        assert_eq!(
            escaped("<b a=\"1\">&'\u{0}\u{202e}"),
            "&lt;b a=&quot;1&quot;&gt;&amp;&#39;\u{fffd}\u{fffd}"
        );
        let mut drawing = Drawing::new("x", [0.0, 0.0, 1.0, 1.0], "<title>");
        drawing.text("t", [0.0, 0.0], "</svg>");
        assert_eq!(drawing.html().matches("svg>").count(), 1, "{}", drawing.html());
    }

    #[test]
    fn what_is_no_number_is_left_out() {
        let mut drawing = Drawing::new("x", [0.0, 0.0, 1.0, 1.0], "");
        drawing.circle("", [f64::NAN, 0.0], 1.0);
        drawing.line("", [0.0, f64::INFINITY], [0.0, 0.0]);
        drawing.corners("", &[[0.0, 0.0], [f64::NAN, 1.0]], true);
        assert_eq!(drawing.marks, "");
        assert_eq!([short(-0.001), short(1.5), short(10.0)], ["0", "1.5", "10"]);
    }
}
