//! Tables that end before their end: a copy that broke off, a power cut, an editor that leaves off the last line end.

use tactpad::pipeline::shipped;

use super::{refuses_line, said, tactpad, with_file};

#[test]
fn a_table_that_is_cut_inside_its_last_number_is_refused_by_all_who_read_rows() {
    let contacts = b"x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,2.5\n0,0,0,0,3";
    let (_folder, path) = with_file("cut.csv", contacts);
    let place = format!("{}:3: ", path.display());
    let words = [place.as_str(), "ends in this line", "fz_n, \"3\"", "end it if it is whole"];
    for verb in ["replay --profile contra --contacts", "simulate --out - --contacts", "twin --out - --plan"] {
        refuses_line(&format!("{verb} {}", path.display()), &words);
    }
    let (folder, labels) = with_file("labels.csv", b"begin_s,end_s,meant\n1,2,right\n3");
    let capture = folder.path().join("c.cap");
    crate::recorded::write(&capture, shipped::STATICS, 1);
    let line = format!("tune {} --profile super-mario --labelled {}", capture.display(), labels.display());
    refuses_line(&line, &["labels.csv:3: ", "1 values where", "the file ends in this line"]);
}

#[test]
fn a_last_line_without_a_line_end_is_told_where_nobody_knows_whether_it_is_whole() {
    for (last, warning) in
        [("0,0,0,0,2.5", None), ("0,0,0,0,2.5\n", None), ("0,0,0,0,2.75", Some("\"2.75\""))]
    {
        let text = format!("x_mm,y_mm,fx_n,fy_n,fz_n\n0,0,0,0,1.5\n{last}");
        let (_folder, path) = with_file("contacts.csv", text.as_bytes());
        let line = format!("simulate --out - --contacts {}", path.display());
        let output = tactpad().args(line.split(' ')).output().unwrap();
        assert_eq!(output.status.code(), Some(0), "{}", said(&output));
        let told = format!("warning: {}:3: the file ends without a line end", path.display());
        assert_eq!(said(&output).contains(&told), warning.is_some(), "{last:?}: {}", said(&output));
        assert!(said(&output).contains(warning.unwrap_or_default()), "{}", said(&output));
    }
}
