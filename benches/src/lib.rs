//! Research runs: each redoes a table or a curve from a command, `cargo run --release -p prt-benches --bin repro -- NAME`.

mod output;
mod plot;
mod runs;

pub use runs::{RUNS, Run};
