//! The list of runs. Each is a file of its own.

mod embree;
mod error_against_order;
mod error_against_rays;
mod exponential;
mod ldprt_coherence;
mod ldprt_fig2;
mod ldprt_fig3;
mod ldprt_glossy;
mod ldprt_scattering;
mod ldprt_table;
mod ldprt_trade;
mod ldprt_wrinkle;
mod numbers;
mod peers;
mod rotation_trade;

use std::path::Path;

use anyhow::{Context, Result};
use prt_bake::{Mesh, MeshOptions, load_mesh};

/// One table or curve.
#[derive(Debug)]
pub struct Run {
    /// How it is called.
    pub name: &'static str,
    /// What it prints.
    pub what: &'static str,
    /// Makes it, for a mesh file or for its own choice.
    pub run: fn(Option<&str>) -> Result<()>,
}

/// All runs.
pub const RUNS: &[Run] = &[
    Run {
        name: "readme/numbers",
        what: "the table of the README: speed and accuracy of the main job",
        run: numbers::run,
    },
    Run {
        name: "sh-core/peers",
        what: "speed of sh-core beside other libraries; started by benches/peers/run.sh [README]",
        run: peers::run,
    },
    Run {
        name: "prt/embree",
        what: "the rays of a bake beside Embree's, and whether the answers agree; started by benches/embree/run.sh [MESH]",
        run: embree::run,
    },
    Run {
        name: "prt/error-against-rays",
        what: "error of shadowed transfer against rays and time, for fixed counts and target errors, five meshes, with plots [MESH]",
        run: error_against_rays::run,
    },
    Run {
        name: "prt/error-against-order",
        what: "share of the light of an environment that transfer of order 1 to 10 misses [MESH]",
        run: error_against_order::run,
    },
    Run {
        name: "sh/exponential",
        what: "error and time of the exponential of expansions, by method and order, for sets of blockers",
        run: exponential::run,
    },
    Run {
        name: "ldprt/scattering",
        what: "random walks in a translucent patch: slabs beside the adding-doubling method, error and time against paths",
        run: ldprt_scattering::run,
    },
    Run {
        name: "ldprt/table",
        what: "the light's table of zonal lobes: error and time for 16x8 to 256x128, with a plot",
        run: ldprt_table::run,
    },
    Run {
        name: "ldprt/fig4",
        what: "glossy transfer: error of the factored BRDF by rows, and of lobes by their number [MESH]",
        run: ldprt_glossy::run,
    },
    Run {
        name: "ldprt/wrinkle",
        what: "the wrinkle model: error of the 32×32 map of three lobes, fitted together and apart",
        run: ldprt_wrinkle::run,
    },
    Run {
        name: "ldprt/coherence",
        what: "error of lobes at vertices and at face centres, before and after they are made coherent [MESH]",
        run: ldprt_coherence::run,
    },
    Run {
        name: "kkp/trade",
        what: "rotation, exact and by Taylor polynomials: error against time, with a plot",
        run: rotation_trade::run,
    },
    Run {
        name: "ldprt/fig2",
        what: "zonal-lobe fits of random vectors, and error against starts [VECTORS]",
        run: ldprt_fig2::run,
    },
    Run { name: "ldprt/fig3", what: "zonal-lobe fits of the transfer of four meshes [MESH]", run: ldprt_fig3::run },
    Run {
        name: "ldprt/fit-trade",
        what: "zonal-lobe fits of a mesh: error against time for lobes, starts and methods, with a plot [MESH]",
        run: ldprt_trade::run,
    },
];

/// The mesh that was asked for, or a file of the test data.
fn mesh(asked: Option<&str>, data_file: &str) -> Result<Mesh> {
    let path = match asked {
        Some(path) => Path::new(path).to_owned(),
        None => prt_tests::data_path("this run", data_file).context("name a mesh file, or set PRT_DATA")?,
    };
    Ok(Mesh::new(load_mesh(&path)?, &MeshOptions::default())?.0)
}
