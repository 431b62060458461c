//! Pages, clients and commands come and go: no descriptor and no thread of theirs stays.

use std::fs;
use std::io::Write;
use std::net::TcpStream;

use crate::running::comes_true;
use crate::shown::Shown;

/// So often all of them come and go.
const ROUNDS: usize = 40;

/// Live pages at once.
const PAGES: usize = 4;

/// How many descriptors and how many threads the bridge has.
fn counts(shown: &Shown) -> (usize, usize) {
    let count = |of: &str| fs::read_dir(format!("/proc/{}/{of}", shown.running.id())).unwrap().count();
    (count("fd"), count("task"))
}

fn come_and_go(shown: &Shown) {
    let pages: Vec<TcpStream> = (0..PAGES).map(|_| shown.live_page()).collect();
    assert_eq!(shown.ask("GET /", "").status, 200);
    shown.wait_until_playing();
    let mut half_asked = TcpStream::connect(&shown.host).unwrap();
    half_asked.write_all(b"PUT /api/profile/contra HTTP/1.1\r\nContent-Length: 900\r\n").unwrap();
    let mut watch = shown.running.ctl_begun("watch");
    assert!(shown.running.ctl("status").status.success());
    drop((pages, half_asked));
    watch.kill().unwrap();
    watch.wait().unwrap();
}

#[test]
fn clients_that_come_and_go_leave_nothing_behind() {
    let shown = Shown::start("virtual", "contra");
    shown.wait_until_playing();
    let alone = counts(&shown);
    // What is started with the first of them may stay.
    come_and_go(&shown);
    let is_as_few = |few: (usize, usize)| {
        let now = counts(&shown);
        now.0 <= few.0 && now.1 <= few.1
    };
    assert!(comes_true(|| is_as_few((alone.0 + 4, alone.1 + 4))), "{alone:?}, then {:?}", counts(&shown));
    let before = counts(&shown);
    (0..ROUNDS).for_each(|_| come_and_go(&shown));
    assert!(comes_true(|| is_as_few(before)), "{before:?} before, {:?} after", counts(&shown));
}
