//! The calibration's readings and derivatives held against the law of the channels.

use super::physical::free;
use super::*;
use tactpad_core::pad::channels::{ChannelChain, ChannelConditions};
use tactpad_core::pad::device::Device;
use tactpad_core::pad::field::PadField;
use tactpad_numeric::random::SplitMix64;

/// A pad that differs in everything, with this crosstalk, under some contacts; what is asked of each.
fn on_contacts(crosstalk: f64, ask: impl Fn(&ParameterLayout, &[f64], &Maps, &Measured)) {
    let (device, field) = (Device::nominal(), PadField::nominal());
    let (physical, sensitivities) = free(&field, &device, &device);
    let layout = ParameterLayout {
        physical,
        terms: TERMS,
        is_play: false,
        module_angles_deg: device.sites.angles_deg,
    };
    let mut random = SplitMix64::new(21);
    let mut around = |mean: f64, by: f64| mean + by * f64::from(random.uniform());
    let mut values: Vec<f64> = (0..layout.size()).map(|_| around(0.0, 0.01)).collect();
    values[ZEROS..GAINS].iter_mut().for_each(|value| *value = around(0.0, 50.0));
    values[GAINS..CROSSTALKS].iter_mut().for_each(|value| *value = around(1.0, 0.2));
    for (index, value) in values[CROSSTALKS..SHARES].iter_mut().enumerate() {
        *value = if index / CHANNELS == index % CHANNELS { 0.0 } else { around(0.0, crosstalk) };
    }
    values[GAIN_SLOPES..LOG_SCALE].iter_mut().for_each(|value| *value = around(0.0, 1e-3));
    for _ in 0..4 {
        let place_mm = [around(0.0, 15.0), around(0.0, 15.0)];
        let place = FieldAtPlace::of(&field, &sensitivities, device.plate.radius_mm(), place_mm);
        let force_n = [around(0.0, 0.5), around(0.0, 0.5), around(2.0, 1.0)];
        let contact = Measured {
            above_c: around(0.0, 8.0),
            to_come: around(0.5, 0.5),
            lags: std::array::from_fn(|_| std::array::from_fn(|_| around(0.0, 100.0))),
            crept_uv: std::array::from_fn(|_| around(0.0, 100.0)),
            ..Measured::unmeasured(place_mm, place, force_n)
        };
        ask(&layout, &values, &[[100.0; 3]; CHANNELS], &contact);
    }
}

#[test]
fn channels_read_by_the_law() {
    on_contacts(0.05, |layout, values, scale, contact| {
        let mut strains = layout.strain_maps(values, &contact.place, contact.knowledge);
        // What the gain makes the background of.
        let mut background = [[0.0; 3]; CHANNELS];
        layout.add_background(values, scale, &contact.place.terms, &mut background);
        for (channel, (map, background)) in strains.iter_mut().zip(background).enumerate() {
            map.iter_mut()
                .zip(background)
                .for_each(|(map, it)| *map += it / ParameterLayout::gain(values, channel));
        }
        let force_n = ParameterLayout::force_now_n(values, contact);
        let mut uv = strains.map(|map| response(&map, &force_n));
        let pairs = (0..CHANNELS).flat_map(|into| (0..CHANNELS).map(move |from| (into, from)));
        let memory = |channel| ParameterLayout::memory_uv(values, channel, &contact.lags, &contact.crept_uv);
        let chain = ChannelChain {
            gain: (0..CHANNELS).map(|channel| ParameterLayout::gain(values, channel)).collect(),
            gain_per_c: values[GAIN_SLOPES..LOG_SCALE].to_vec(),
            shares: pairs
                .map(|(into, from)| (into, from, values[CROSSTALKS + into * CHANNELS + from]))
                .collect(),
            offset: (0..CHANNELS).map(|channel| values[ZEROS + channel] + memory(channel)).collect(),
            ..ChannelChain::nominal(vec![1.0; CHANNELS])
        };
        chain.read(&mut uv, &ChannelConditions { above_c: contact.above_c, ..ChannelConditions::default() });
        for (read_uv, uv) in layout.readings(values, scale, contact).iter().zip(uv) {
            assert!((read_uv - uv).abs() < 1e-9, "{read_uv} {uv}");
        }
    });
}

#[test]
fn derivatives_are_the_differences_of_readings() {
    on_contacts(0.05, |layout, values, scale, contact| {
        let derived = layout.slopes(values, scale, contact).whole();
        for at in 0..layout.size() {
            let is_own = (CROSSTALKS..SHARES).contains(&at) && (at - CROSSTALKS).is_multiple_of(CHANNELS + 1);
            let is_of_rig = (RIG_AT..PHYSICAL).contains(&at) && at != RIG_AT + REFERENCE_GAIN;
            if is_own || is_of_rig {
                continue;
            }
            let step = 1e-4;
            let [below, above] = [-step, step].map(|by| {
                let mut values = values.to_vec();
                values[at] += by;
                layout.readings(&values, scale, contact)
            });
            for (channel, derivatives) in derived.iter().enumerate() {
                let difference = (above[channel] - below[channel]) / (2.0 * step);
                let off = (derivatives[at] - difference).abs();
                assert!(
                    off <= 1e-4 + 1e-5 * difference.abs(),
                    "{at} {channel}: {} {difference}",
                    derivatives[at]
                );
            }
        }
    });
}
