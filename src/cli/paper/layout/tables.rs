//! The verb's tables for people.

use std::io::{self, Write};

use super::report::LayoutReport;
use crate::cli::printing::written::stdout;
use tactpad::lab::layout::placement::Candidate;
use tactpad::lab::layout::published::{AreaRow, PublishedPart};
use tactpad::lab::layout::study::{Simulated, SpacingAnswers};

/// A free distance is one whose range is longer than this share of it.
const FREE: f64 = 1e-6;

pub(super) fn print(report: &LayoutReport) -> io::Result<()> {
    write(&mut stdout(), report)
}

fn write(out: &mut impl Write, report: &LayoutReport) -> io::Result<()> {
    if let Some(pad) = &report.simulated {
        write_isolines(out, pad)?;
        writeln!(out)?;
    }
    write_spacing(out, &report.spacing)?;
    if let Some(pad) = &report.simulated {
        writeln!(out)?;
        write_placements(out, pad)?;
    }
    writeln!(out)?;
    write_areas(out, &report.area_per_channel)?;
    writeln!(out)?;
    write_accuracies(out, &report.area_per_channel)?;
    writeln!(out)?;
    write_parts(out, &report.parts, report.parts_usd)
}

fn write_isolines(out: &mut impl Write, pad: &Simulated) -> io::Result<()> {
    writeln!(out, "Effective regions: a module carries more than {} % of a press", 100.0 * pad.threshold)?;
    writeln!(
        out,
        "{:<8} {:>8} {:>8} {:>8} {:>8} {:>14}",
        "module", "r mm", "± mm", "from mm", "to mm", "on the plate"
    )?;
    for (module, isoline) in pad.isolines.iter().enumerate() {
        let Some(line) = isoline else {
            writeln!(out, "{module:<8} the isoline is not on the plate")?;
            continue;
        };
        let share = 100.0 * line.share_on_plate;
        let (nearest, farthest) = (line.nearest_mm, line.farthest_mm);
        writeln!(
            out,
            "{module:<8} {:>8.2} {:>8.2} {nearest:>8.2} {farthest:>8.2} {share:>12.0} %",
            line.radius_mm, line.spread_mm
        )?;
    }
    Ok(())
}

fn write_spacing(out: &mut impl Write, spacing: &SpacingAnswers) -> io::Result<()> {
    let [r1, r2, r3] = spacing.radii_mm;
    writeln!(
        out,
        "The paper's rule: cover most, no distance above the smaller radius; radii {r1:.3}, {r2:.3}, {r3:.3} mm"
    )?;
    writeln!(out, "{:<16} {:>10} {:>10} {:>10} {:>13}", "", "d1 mm", "d2 mm", "d3 mm", "area mm²")?;
    let answers = [
        ("particle swarm", spacing.swarm),
        ("grid search", spacing.grid),
        ("closed form", spacing.closed_form),
    ];
    for (name, answer) in answers {
        let [d1, d2, d3] = answer.distances_mm;
        writeln!(out, "{name:<16} {d1:>10.4} {d2:>10.4} {d3:>10.4} {:>13.4}", answer.area_mm2)?;
    }
    for (number, [low, high]) in (1..).zip(spacing.optimal_ranges_mm) {
        if high - low > FREE * high {
            writeln!(out, "d{number} may be from {low:.4} to {high:.4} mm: the area stays the same")?;
        }
    }
    if is_flat(spacing.closed_form.distances_mm) {
        writeln!(out, "the modules stand in a line, the one with the smallest region between the others")?;
    }
    Ok(())
}

fn is_flat(distances_mm: [f64; 3]) -> bool {
    let longest = distances_mm.into_iter().fold(0.0, f64::max);
    2.0 * longest >= distances_mm.iter().sum::<f64>() * (1.0 - FREE)
}

fn write_placements(out: &mut impl Write, pad: &Simulated) -> io::Result<()> {
    let ([fx, fy, fz], noise_uv) = (pad.press_n, pad.noise_uv);
    writeln!(out, "Location error at best (Cramér–Rao), press of {fx}, {fy}, {fz} N, noise {noise_uv} µV")?;
    writeln!(
        out,
        "{:<30} {:>9} {:>9} {:>9} {:>9} {:>12}",
        "modules", "radius mm", "turned °", "worst mm", "rms mm", "signal µV"
    )?;
    write_placement(out, "as built", Some(&pad.as_built))?;
    write_placement(out, "by the paper's rule", Some(&pad.by_rule))?;
    write_placement(out, "smallest worst error", pad.search.best.as_ref())?;
    let beside = pad.search.best_beside(&pad.as_built);
    write_placement(out, "with signals as built, or less", Some(&beside))?;
    if pad.search.best_is_at_an_end() {
        let [from, to] = pad.search.range.centre_radius_mm;
        writeln!(
            out,
            "the smallest worst error is at an end of the radii that were tried, {from:.1} to {to:.1} mm"
        )?;
    }
    Ok(())
}

fn write_placement(out: &mut impl Write, name: &str, candidate: Option<&Candidate>) -> io::Result<()> {
    let Some(Candidate { placement, precision }) = candidate else {
        return writeln!(out, "{name:<30} none");
    };
    let (radius, turned) = (placement.centre_radius_mm, placement.rotation_deg);
    write!(out, "{name:<30} {radius:>9.2} {turned:>9.1} ")?;
    match precision {
        Some(found) => {
            writeln!(out, "{:>9.4} {:>9.4} {:>12.0}", found.worst_mm, found.rms_mm, found.largest_uv)
        }
        None => writeln!(out, "cannot be built"),
    }
}

fn write_areas(out: &mut impl Write, rows: &[AreaRow]) -> io::Result<()> {
    writeln!(out, "Area per channel, beside the paper's Table 7")?;
    let heads = ("work", "senses with", "channels", "cm²", "cm²/channel", "printed");
    writeln!(
        out,
        "{:<16} {:<34} {:>8} {:>7} {:>12} {:>8}",
        heads.0, heads.1, heads.2, heads.3, heads.4, heads.5
    )?;
    for AreaRow { work, area_per_channel_cm2 } in rows {
        let printed = work.printed_cm2.map_or_else(String::new, |printed| printed.to_string());
        writeln!(
            out,
            "{:<16} {:<34} {:>8} {:>7.3} {area_per_channel_cm2:>12.4} {printed:>8}",
            work.name, work.principle, work.channels, work.area_cm2
        )?;
    }
    Ok(())
}

fn write_accuracies(out: &mut impl Write, rows: &[AreaRow]) -> io::Result<()> {
    writeln!(out, "Accuracy, as each work reports it: other areas, loads and statistics, so no ranking")?;
    let mut line = |[name, place, is, force, of]: [&str; 5]| {
        writeln!(out, "{name:<16} {place:>8} {is:<13} {force:>7}  {of}")
    };
    line(["work", "place mm", "which is", "force N", "of"])?;
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |value| format!("{value:.2}"));
    for AreaRow { work, .. } in rows {
        let accuracy = &work.accuracy;
        let of = format!("{}{}", accuracy.of, accuracy.read_in.map_or("", |_| " *"));
        let (place, force) = (number(accuracy.location_mm), number(accuracy.force_n));
        line([work.name, &place, accuracy.location_is, &force, &of])?;
    }
    for source in rows.iter().filter_map(|row| row.work.accuracy.read_in) {
        writeln!(out, "* read in {source} itself; the others are as the paper's Table 7 cites them")?;
    }
    Ok(())
}

fn write_parts(out: &mut impl Write, parts: &[PublishedPart], sum_usd: f64) -> io::Result<()> {
    writeln!(out, "Parts, with the prices of the paper's Table 1")?;
    writeln!(out, "{:<16} {:>6} {:>6} {:>6}  here", "part", "number", "USD", "sum")?;
    for part in parts {
        let (name, quantity, here) = (part.name, part.quantity, part.here);
        writeln!(
            out,
            "{name:<16} {quantity:>6} {:>6.2} {:>6.2}  {here}",
            part.unit_price_usd,
            part.price_usd()
        )?;
    }
    writeln!(out, "{:<16} {:>6} {:>6} {sum_usd:>6.2}  (the paper's text says below 15)", "total", "", "")
}

#[cfg(test)]
mod tests {
    use super::*;
    use tactpad::lab::layout::placement::{Placement, Range, Search};
    use tactpad::lab::layout::precision::Precision;
    use tactpad::lab::layout::published::{PARTS, area_rows};
    use tactpad::lab::layout::region::Isoline;
    use tactpad::lab::layout::spacing::Spacing;

    fn candidate(centre_radius_mm: f64, worst_mm: f64, largest_uv: f64) -> Candidate {
        let precision = Precision { worst_mm, worst_at_mm: [29.0, 0.0], rms_mm: 0.8 * worst_mm, largest_uv };
        Candidate { placement: Placement { centre_radius_mm, rotation_deg: 0.0 }, precision: Some(precision) }
    }

    fn pad() -> Simulated {
        let line = Isoline {
            radius_mm: 33.2,
            spread_mm: 2.5,
            nearest_mm: 29.7,
            farthest_mm: 40.25,
            share_on_plate: 0.24,
        };
        let grid = vec![candidate(8.0, 0.15, 5000.0), candidate(16.0, 0.18, 2300.0)];
        let range = Range {
            centre_radius_mm: [8.0, 16.0],
            radius_steps: 1,
            rotation_deg: [0.0; 2],
            rotation_steps: 0,
        };
        let unbuilt = Candidate { precision: None, ..candidate(28.0, 0.0, 0.0) };
        Simulated {
            threshold: 0.01,
            noise_uv: 6.0,
            isolines: [Some(line), None, Some(line)],
            outlines: [vec![], vec![], vec![]],
            press_n: [0.0, 0.0, 1.0],
            as_built: candidate(20.0, 0.19, 2400.0),
            by_rule: unbuilt,
            search: Search { range, best: grid.first().copied(), grid, refinement: vec![] },
        }
    }

    fn report(
        distances_mm: [f64; 3],
        optimal_ranges_mm: [[f64; 2]; 3],
        simulated: Option<Simulated>,
    ) -> LayoutReport {
        let answer = Spacing { distances_mm, area_mm2: 54.5 };
        let spacing = SpacingAnswers {
            radii_mm: [1.0, 3.0, 4.0],
            limits_mm: [1.0, 3.0, 1.0],
            swarm: answer,
            grid: answer,
            closed_form: answer,
            optimal_ranges_mm,
        };
        let area_per_channel = area_rows(60.0, None);
        LayoutReport { seed: 1, spacing, simulated, area_per_channel, parts: PARTS, parts_usd: 15.0 }
    }

    fn text(report: &LayoutReport) -> String {
        let mut bytes = Vec::new();
        write(&mut bytes, report).unwrap();
        String::from_utf8(bytes).unwrap()
    }

    /// The words of the line that begins so.
    fn words<'a>(text: &'a str, beginning: &str) -> Vec<&'a str> {
        let line = text.lines().find(|line| line.starts_with(beginning)).unwrap_or_default();
        line.split_whitespace().collect()
    }

    #[test]
    fn a_simulated_pad_fills_all_tables() {
        let distances = [1.0, 2.0, 1.0];
        let text = text(&report(distances, distances.map(|d| [d, d]), Some(pad())));
        assert_eq!(words(&text, "0   "), ["0", "33.20", "2.50", "29.70", "40.25", "24", "%"]);
        assert!(text.contains("1        the isoline is not on the plate"), "{text}");
        assert_eq!(words(&text, "as built")[2..], ["20.00", "0.0", "0.1900", "0.1520", "2400"]);
        assert_eq!(words(&text, "by the paper's rule")[4..], ["28.00", "0.0", "cannot", "be", "built"]);
        assert_eq!(words(&text, "smallest worst error")[3..], ["8.00", "0.0", "0.1500", "0.1200", "5000"]);
        assert_eq!(
            words(&text, "with signals as built, or less")[6..],
            ["16.00", "0.0", "0.1800", "0.1440", "2300"]
        );
        assert!(text.contains("at an end of the radii that were tried, 8.0 to 16.0 mm"), "{text}");
        assert_eq!(words(&text, "this pad")[4..], ["9", "28.274", "3.1416"]);
        assert!(text.contains("Mêda et al.          0.26 mean absolute    0.17"), "{text}");
        assert!(text.contains("the modules stand in a line"), "{text}");
    }

    #[test]
    fn without_a_pad_its_tables_are_left_out() {
        let text = text(&report([1.0, 1.9, 1.0], [[0.9, 1.0], [1.9, 1.9], [0.9, 1.0]], None));
        for absent in ["Effective regions", "Location error", "d2 may", "in a line"] {
            assert!(!text.contains(absent), "{absent}: {text}");
        }
        assert!(text.contains("d1 may be from 0.9000 to 1.0000 mm: the area stays the same"), "{text}");
        assert_eq!(words(&text, "particle swarm")[2..], ["1.0000", "1.9000", "1.0000", "54.5000"]);
        assert_eq!(words(&text, "the paper ")[5..], ["decoder", "9", "28.300", "3.1444", "3.14"]);
        assert_eq!(words(&text, "total")[..2], ["total", "15.00"]);
    }
}
