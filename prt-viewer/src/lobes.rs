//! Zonal lobes as the crates hand them on: fitted, stored, shaded.

use anyhow::Context;
use prt_bake::ZonalTransfer;
use prt_gpu::{LobeShape, Lobes};
use sh_core::Order;
use sh_fit::LobeSet;

/// Fitted lobes as they are stored: one row a point.
pub(crate) fn stored(set: LobeSet) -> ZonalTransfer {
    let LobeSet { order, channels, lobe_count, explicit_count, explicit, axes, coeffs } = set;
    ZonalTransfer { order, rows: 1, channels, lobe_count, explicit_count, explicit, axes, coeffs, view_map: None }
}

/// Rows that were fitted one by one, of the same points, as they are stored.
///
/// # Panics
/// If there is no row, or the rows differ in shape.
pub(crate) fn interleaved(rows: &[LobeSet]) -> ZonalTransfer {
    let first = &rows[0];
    let points = first.point_count();
    let LobeSet { order, channels, lobe_count, explicit_count, .. } = *first;
    let mut transfer = ZonalTransfer {
        order,
        rows: rows.len(),
        channels,
        lobe_count,
        explicit_count,
        explicit: Vec::new(),
        axes: Vec::new(),
        coeffs: Vec::new(),
        view_map: None,
    };
    for point in 0..points {
        for row in rows {
            assert_eq!((row.lobe_count, row.explicit_count), (lobe_count, explicit_count), "rows of one shape");
            transfer.axes.extend_from_slice(row.axes_of(point));
            for channel in 0..channels {
                transfer.explicit.extend_from_slice(row.explicit_of(point, channel));
                transfer.coeffs.extend_from_slice(row.coeffs_of(point, channel));
            }
        }
    }
    transfer
}

/// Stored lobes as they are shaded.
///
/// # Errors
/// If they contradict themselves.
pub(crate) fn shaded(transfer: &ZonalTransfer) -> Result<Lobes<'_>, prt_gpu::Error> {
    let ZonalTransfer { order, rows, channels, lobe_count, explicit_count, explicit, axes, coeffs, view_map } =
        transfer;
    let shape = LobeShape {
        order: *order,
        rows: *rows,
        channels: *channels,
        lobe_count: *lobe_count,
        explicit_count: *explicit_count,
    };
    let map = view_map.as_ref().map(|map| prt_gpu::ViewMap { size: map.size, values: &map.values });
    Lobes::new(shape, explicit, axes, coeffs, map)
}

/// Unshadowed transfer of a diffuse surface as one lobe about each normal: exact, and able to follow a deformation.
///
/// # Errors
/// If a normal is not finite.
pub(crate) fn unshadowed(order: Order, normals: &[[f32; 3]]) -> anyhow::Result<ZonalTransfer> {
    let lobes = sh_fit::membrane_lobes(order, &vec![0.0; normals.len()], normals)
        .context("cannot make unshadowed transfer from the normals")?;
    Ok(stored(lobes))
}
