//! The live core allocates nothing after it was made.

use tactpad::numeric::memory::{PlayOperator, Relaxation};
use tactpad::pad::device::Device;
use tactpad::pad::field::PadField;
use tactpad::pipeline::compensation::Compensation;
use tactpad::pipeline::compensation::hysteresis::PLAYS;
use tactpad::pipeline::compensation::thermal::Thermal;
use tactpad::pipeline::contact::Decoder;
use tactpad::pipeline::contact::inverse::Inverse;
use tactpad::pipeline::contact::uncertainty::Noise;
use tactpad::pipeline::health::Health;
use tactpad::pipeline::mapping::read::check::{self, OutputChoice};
use tactpad::pipeline::mapping::read::shipped;
use tactpad::pipeline::{NoProbe, Pipeline};
use tactpad::quantity::{CHANNELS, Contact, Strain};
use tactpad::time::HostInstant;
use tactpad::virtual_pad::firmware::VirtualPad;
use tactpad::virtual_pad::script::Script;

#[test]
fn ten_seconds_of_play_allocate_nothing() {
    for name in ["contra", "pointer"] {
        plays_without_allocating(name, tactpad::pipeline::shipped::decoder(), &Device::nominal());
    }
}

#[test]
fn hysteresis_warmth_and_warnings_allocate_nothing() {
    let plays = [PlayOperator { threshold: 300.0, share: 0.03 }; CHANNELS];
    let noise = Noise::of_channels([5.0; CHANNELS], [0.01; CHANNELS]);
    let thermal =
        Thermal { reference_c: 20.0, zero_uv_per_c: [50.0; CHANNELS], gain_per_c: [-5e-4; CHANNELS] };
    let creep = Relaxation { time_s: 8.0, share: 0.01 };
    let compensation =
        Compensation { zero_uv: None, thermal: Some(thermal), creep, hysteresis: [plays; PLAYS] };
    let decoder =
        Decoder::from(Inverse::new(PadField::nominal().signals, noise)).compensated_by(compensation);
    let mut device = Device::nominal();
    device.modules[1].gain[2] = 0.0;
    let health = plays_without_allocating("contra", decoder, &device);
    assert_eq!(health.channels_silent, 1, "{health:?}");
}

fn plays_without_allocating(name: &str, decoder: Decoder, device: &Device) -> Health {
    let read = shipped::text(name).and_then(|text| check::read(text, OutputChoice::AsWritten).0);
    let Some(profile) = read else { panic!("{name} is in order") };
    let script = Script::for_profile(&profile, 10_000_000);
    let mut device = device.clone();
    device.behaviour.noise.additive_uv = [6.0; CHANNELS];
    let mut pad = VirtualPad::of(script, &device, &PadField::nominal(), 3);
    let mut pipeline = Pipeline::new(decoder, profile);
    let mut bytes = Vec::new();
    for _ in 0..2 {
        pad.emit(10_000_000, &mut bytes);
    }
    // Some damage, so that the paths of faults are walked too.
    for place in (0..bytes.len()).step_by(60_007) {
        bytes[place] ^= 0x20;
    }
    let mut events = 0;
    let allocated = allocation_counter::measure(|| {
        for (ms, chunk) in bytes.chunks(60).enumerate() {
            let now = HostInstant::default().plus_us(1_000 * ms as u64);
            let mut rest = chunk;
            while !rest.is_empty() {
                let taken = pipeline.handle_bytes(now, rest, &mut NoProbe);
                events += pipeline.events().len();
                rest = &rest[taken..];
            }
            pipeline.handle_timeout(now);
            events += pipeline.events().len();
        }
        pipeline.handle_unplugged(HostInstant::default().plus_us(20_000_000));
    });
    assert!(events > 30 && pipeline.health().frames_damaged > 3, "{events} events, {:?}", pipeline.health());
    assert_eq!(allocated.count_total, 0, "{name}");
    *pipeline.health()
}

/// Channels of presses, and such as no pad gives.
fn strains() -> Vec<Strain> {
    let field = PadField::nominal().signals;
    let press = |index: u16| {
        let (x_mm, y_mm) = (f32::from(index % 31) - 15.0, f32::from(index / 31) - 5.0);
        field.strain_uv(&Contact { x_mm, y_mm, fz_n: f32::from(index % 7), ..Contact::default() })
    };
    let odd = [0.0, -0.0, 1e-40, 1e6, -1e30, f32::MAX, f32::INFINITY, f32::NAN];
    let all = odd.map(|uv| Strain { uv: [uv; CHANNELS] });
    let one = odd.map(|uv| Strain { uv: std::array::from_fn(|k| if k == 4 { uv } else { 200.0 }) });
    (0..300).map(press).chain(all).chain(one).collect()
}

#[test]
fn every_decoder_decodes_anything_without_allocating_and_gives_finite_numbers() {
    let strains = strains();
    for (name, decoder) in crate::decoders::each() {
        let mut all_finite = true;
        let (mut pressed, mut estimated) = (0, 0);
        let allocated = allocation_counter::measure(|| {
            for strain in &strains {
                let Contact { x_mm, y_mm, fx_n, fy_n, fz_n } = decoder.decode(strain);
                all_finite &= [x_mm, y_mm, fx_n, fy_n, fz_n].iter().all(|number| number.is_finite());
                pressed += u32::from(fz_n > 0.5);
                estimated += usize::from(decoder.inverse().is_some_and(|it| it.estimate(strain).is_some()));
            }
        });
        assert!(all_finite && pressed > 200, "{name}: {pressed} presses");
        assert!(estimated > 200 || decoder.inverse().is_none(), "{name}: {estimated} estimates");
        assert_eq!(allocated.count_total, 0, "{name}");
    }
}

#[test]
fn the_field_is_asked_without_allocating() {
    let field = PadField::nominal().signals;
    let mut sum = 0.0;
    let allocated = allocation_counter::measure(|| {
        for place in 0..1_000_u16 {
            let (x_mm, y_mm) = (f32::from(place % 61) - 30.0, f32::from(place / 61) - 8.0);
            sum += field.gains(x_mm, y_mm).dx[0][2];
        }
    });
    assert!(sum.is_finite() && sum != 0.0, "{sum}");
    assert_eq!(allocated.count_total, 0);
}
