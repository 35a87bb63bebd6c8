//! Ctrl-C.

use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context;

static CANCELLED: AtomicBool = AtomicBool::new(false);
static AT_WORK: AtomicBool = AtomicBool::new(true);

/// What a shell reports for a program that Ctrl-C ended: 128 + SIGINT.
pub(crate) const EXIT_STATUS: u8 = 130;

/// From here on Ctrl-C asks the work to stop, which leaves no unfinished file; a second one ends the program at once.
pub(crate) fn listen() -> anyhow::Result<()> {
    let stop = || {
        if CANCELLED.swap(true, Ordering::Relaxed) || !AT_WORK.load(Ordering::Relaxed) {
            std::process::exit(EXIT_STATUS.into());
        }
    };
    ctrlc::set_handler(stop).context("cannot listen for Ctrl-C")
}

/// From here on Ctrl-C ends the program at once: nothing is unfinished.
pub(crate) fn stop_listening() {
    AT_WORK.store(false, Ordering::Relaxed);
}

/// While it lives, Ctrl-C ends the program at once.
#[derive(Debug)]
pub(crate) struct Interruptible(());

impl Interruptible {
    pub(crate) fn new() -> Self {
        AT_WORK.store(false, Ordering::Relaxed);
        Self(())
    }
}

impl Drop for Interruptible {
    fn drop(&mut self) {
        AT_WORK.store(true, Ordering::Relaxed);
    }
}

pub(crate) fn is_cancelled() -> bool {
    CANCELLED.load(Ordering::Relaxed)
}

/// Fails if Ctrl-C came: asked between the steps of a job that cannot be interrupted themselves.
pub(crate) fn check() -> Result<(), prt_bake::Error> {
    if is_cancelled() { Err(prt_bake::Error::Cancelled) } else { Ok(()) }
}
