//! The rows of a table, of whatever columns: whoever reads rows from a file reads them here.

use std::borrow::Cow;
use std::io::BufRead;

use super::ending::{LastCell, LastColumn, OpenEnd};
use super::error::{Fault, ReadError, short};
use super::lines::{Lines, cells};

/// A table that was begun: its first line names the columns.
pub struct Rows<R> {
    lines: Lines<R>,
    names: Vec<String>,
}

impl<R: BufRead> Rows<R> {
    /// Reads the first line that is not empty; `empty` is what is wrong if there is none.
    ///
    /// # Errors
    /// There is no line, or it is none of a table.
    pub fn begin(from: R, empty: Fault) -> Result<Self, ReadError> {
        let mut lines = Lines::new(from);
        let names = match lines.next_line()? {
            Some((line, header)) => {
                let names = cells(&header).ok_or(ReadError { line, fault: Fault::Quotation })?;
                names.iter().map(|name| name.trim().to_owned()).collect()
            }
            None => return Err(lines.error(empty)),
        };
        Ok(Self { lines, names })
    }

    /// The columns' names.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// What is wrong with the line that was read last.
    pub fn error(&self, fault: Fault) -> ReadError {
        self.lines.error(fault)
    }

    /// Hands on the cells of each line that is not empty, as many as there are columns, with the line's number; then says
    /// whether the last line may be cut off.
    ///
    /// # Errors
    /// The first line that is no row, or that `take` refuses.
    pub fn each(
        &mut self,
        mut take: impl FnMut(usize, &[Cow<'_, str>]) -> Result<(), Fault>,
    ) -> Result<Option<OpenEnd>, ReadError> {
        let mut last_column = LastColumn::default();
        while let Some((line, text)) = self.lines.next_line()? {
            let is_open = !text.ends_with(['\n', '\r']);
            let refused = |fault: Fault| {
                let fault = if is_open { Fault::InOpenLine(Box::new(fault)) } else { fault };
                ReadError { line, fault }
            };
            let cells = cells(&text).ok_or(Fault::Quotation).map_err(refused)?;
            if cells.len() != self.names.len() {
                return Err(refused(Fault::Width { found: cells.len(), named: self.names.len() }));
            }
            let cell = cells.last().map_or("", AsRef::as_ref);
            if !is_open {
                take(line, &cells).map_err(refused)?;
                last_column.see(cell);
                continue;
            }
            // A quotation mark that closes the cell is its end.
            let judged =
                if text.trim_end().ends_with('"') { LastCell::Whole } else { last_column.judge(cell) };
            let name = self.names.last().cloned().unwrap_or_default();
            if judged == LastCell::CutOff || cell.ends_with(char::REPLACEMENT_CHARACTER) {
                return Err(ReadError { line, fault: Fault::CutOff { name, text: short(cell) } });
            }
            take(line, &cells).map_err(refused)?;
            return Ok((judged == LastCell::Unknown).then(|| OpenEnd { line, name, text: short(cell) }));
        }
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The cells of all rows, and what may be cut off; or what is wrong, with its line.
    fn read(text: impl AsRef<[u8]>) -> Result<(Vec<Vec<String>>, Option<OpenEnd>), String> {
        let told = |error: ReadError| format!("{}: {}", error.line, error.fault);
        let mut rows = Rows::begin(text.as_ref(), Fault::NoHeader).map_err(told)?;
        let mut all = Vec::new();
        let read = rows.each(|_, cells| {
            all.push(cells.iter().map(|cell| cell.as_ref().to_owned()).collect());
            Ok(())
        });
        Ok((all, read.map_err(told)?))
    }

    #[test]
    fn a_file_that_ends_inside_its_last_cell_is_refused_or_told() {
        for whole in ["a,b\n1,2.5\n1,3.5", "a,b\n1,2.5\n1,3\n", "a,b\r\n1,2.5\r\n1,3\r", "a,b\n1,x\n2,\"y\""]
        {
            let (rows, open_end) = read(whole).unwrap();
            assert_eq!((rows.len(), open_end), (2, None), "{whole:?}");
        }
        for cut in
            ["a,b\n1,2.5\n1,3", "a,b\n1,2.5\n1,-", "a,b\n1,1.5e-05\n1,1.5e-0", "a,b\n1,1.5e-05\n1,1.5e"]
        {
            let why = read(cut).unwrap_err();
            assert!(why.starts_with("3: the file ends in this line, and its last b, "), "{why}");
            assert!(
                why.ends_with("copy the file anew, leave the line out, or end it if it is whole"),
                "{why}"
            );
        }
        let text = ["a,b\n1,x\n2,caf".as_bytes(), b"\xc3"].concat();
        assert!(read(text).unwrap_err().starts_with("3: the file ends in this line, and its last b, "));
        for (unknown, told) in [
            ("a,b\n1,12\n2,1", "its last b was read as \"1\""),
            ("a,b\n1,left\n2,le", "its last b was read as \"le\""),
            ("a,b\n1,left\n2,", "its last b was read as \"\""),
        ] {
            let open_end = read(unknown).unwrap().1.unwrap();
            assert!(open_end.line == 3 && open_end.to_string().contains(told), "{open_end}");
        }
    }

    #[test]
    fn a_file_that_ends_before_its_last_cell_says_so() {
        for (cut, why) in [
            ("a,b,c\n1,2,3\n1", "3: 1 values where the header names 3 columns; the file ends in this line"),
            ("a,b,c\n1,2,3\n1,2", "3: 2 values where the header names 3 columns; the file ends in this line"),
            ("a,b,c\n1,2,3\n1,2,\"x", "3: a quotation mark does not close, or"),
        ] {
            let told = read(cut).unwrap_err();
            assert!(told.starts_with(why) && told.ends_with("copy it anew or leave the line out"), "{told}");
        }
        // With its line end the line is whole, and wrong.
        assert!(!read("a,b,c\n1,2\n").unwrap_err().contains("the file ends"));
    }

    #[test]
    fn what_a_power_cut_a_packer_and_an_old_macintosh_leave_is_told() {
        for zeros in ["a,b\n1,2\n\0\0\0\0", "a,b\n1,2\n1,\0\0", "a,b\n1,2\n1,2\0\n"] {
            assert!(
                read(zeros).unwrap_err().starts_with("3: the line holds bytes that are zero"),
                "{zeros:?}"
            );
        }
        let macintosh = read("a,b\r1,2\r3,4\r").unwrap_err();
        assert!(macintosh.starts_with("1: a carriage return stands inside the line"), "{macintosh}");
        let many = ["a,b\n1,2\n".as_bytes(), &[0; 1 << 21]].concat();
        assert!(read(many).unwrap_err().starts_with("3: the line holds bytes that are zero"));
        for packed in
            [&b"\x1f\x8b\x08\x00\x00"[..], b"PK\x03\x04\x14", b"\xfd7zXZ\x00", b"\x28\xb5\x2f\xfd\x04"]
        {
            assert!(read(packed).unwrap_err().starts_with("1: the file is compressed, or a workbook"));
        }
    }
}
