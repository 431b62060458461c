//! The plain words of controls and settings, for the page.

use std::collections::BTreeMap;

use axum::Json;
use axum::response::{IntoResponse, Response};
use serde_json::{Value, json};
use tactpad_core::pipeline::control::OutputDevice;
use tactpad_core::pipeline::mapping::plain::{controls, settings, values};

/// `GET /api/words`.
pub(super) async fn words() -> Response {
    Json(table()).into_response()
}

/// Settings by their places, choices of settings by theirs, controls by their devices and by how bindings write them.
fn table() -> Value {
    let devices = [OutputDevice::Gamepad, OutputDevice::Keyboard, OutputDevice::Pointer];
    let of_device = |device: OutputDevice| (device.name(), controls::table(device));
    let of_choice = |(place, words): &(&'static str, &'static [(&str, &str)])| {
        (*place, words.iter().copied().collect::<BTreeMap<_, _>>())
    };
    json!({
        "settings": settings::fields().collect::<BTreeMap<_, _>>(),
        "choices": values::CHOICES.iter().map(of_choice).collect::<BTreeMap<_, _>>(),
        "controls": devices.into_iter().map(of_device).collect::<BTreeMap<_, _>>(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_page_gets_words_units_and_controls() {
        let table = table();
        let setting =
            json!({"word": "less calming while the finger moves", "unit": "Hz per mm/s", "step": 0.01});
        assert_eq!(table["settings"]["access.tremor_per_mm"], setting);
        assert_eq!(table["choices"]["dpad.mode"]["8way"], "eight directions");
        assert_eq!(table["controls"]["gamepad"][0], json!(["BTN_SOUTH", "A"]));
    }
}
