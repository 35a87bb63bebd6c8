//! The program `prt`: bakes how a scene answers light, once, and relights it in real time.

mod arguments;
mod base_surface;
mod camera;
mod cancel;
mod demo_scene;
mod difference;
mod gloss;
mod laps;
mod lighting;
mod lobes;
mod memory;
mod model;
mod motion;
mod output;
mod output_file;
mod picture;
mod progress_bar;
mod renderer;
mod report;
mod shading;
mod showcase;
mod sky;
mod verb;
mod window;

use std::process::ExitCode;

use clap::Parser;

/// Bakes precomputed radiance transfer of a mesh, and relights it with soft shadows and interreflections.
///
/// Without a verb: bakes a built-in scene, renders it to prt-demo.png and opens it in a window.
///
/// Exit status: 0 done; 1 failed, with one message on the standard error; 2 wrong usage; 130 cancelled with Ctrl-C.
#[derive(Debug, Parser)]
#[command(name = "prt", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    verb: Option<Verb>,
    #[command(flatten)]
    main_job: verb::main_job::Arguments,
}

#[derive(Debug, clap::Subcommand)]
enum Verb {
    Bake(verb::bake::Arguments),
    Merge(verb::merge::Arguments),
    Fit(verb::fit::Arguments),
    Demo(verb::demo::Arguments),
    Render(verb::render::Arguments),
    View(verb::view::Arguments),
    Compare(verb::compare::Arguments),
    Info(verb::info::Arguments),
}

fn main() -> ExitCode {
    let cli = Cli::parse();
    let result = match &cli.verb {
        None => verb::main_job::run(&cli.main_job),
        Some(Verb::Bake(arguments)) => verb::bake::run(arguments),
        Some(Verb::Merge(arguments)) => verb::merge::run(arguments),
        Some(Verb::Fit(arguments)) => verb::fit::run(arguments),
        Some(Verb::Demo(arguments)) => verb::demo::run(arguments),
        Some(Verb::Render(arguments)) => verb::render::run(arguments),
        Some(Verb::View(arguments)) => verb::view::run(arguments),
        Some(Verb::Compare(arguments)) => verb::compare::run(arguments),
        Some(Verb::Info(arguments)) => verb::info::run(arguments),
    };
    match result {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => output::failure(&error),
    }
}
