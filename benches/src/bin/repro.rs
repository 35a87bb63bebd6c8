//! Redoes a table or a curve: `cargo run --release -p prt-benches --bin repro -- NAME`; without a name, the list.

use anyhow::{Result, bail};
use prt_benches::RUNS;

fn main() -> Result<()> {
    let mut arguments = std::env::args().skip(1);
    let Some(name) = arguments.next() else {
        list();
        return Ok(());
    };
    let Some(run) = RUNS.iter().find(|run| run.name == name) else {
        list();
        bail!("there is no run named {name}");
    };
    (run.run)(arguments.next().as_deref())
}

#[expect(clippy::print_stdout, reason = "the answer of the program")]
fn list() {
    for run in RUNS {
        println!("{:<22}{}", run.name, run.what);
    }
}
