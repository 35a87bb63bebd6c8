use sh_core::Order;

use crate::texels::gutter::fill;
use crate::{Coverage, Metadata, TexelTransfer, TransferVectors};

const SIZE: usize = 11;

/// An atlas of order 1 with three channels, in which some texels were baked: `(column, row, value)`.
fn atlas(baked: &[(usize, usize, f32)], wraps: [bool; 2]) -> TexelTransfer {
    let mut atlas = TexelTransfer {
        metadata: Metadata::default(),
        width: SIZE,
        height: SIZE,
        wraps,
        v_up: false,
        coverage: vec![Coverage::Empty; SIZE * SIZE],
        transfer: TransferVectors::zero(SIZE * SIZE, 3, Order::new(1).unwrap()),
    };
    for &(column, row, value) in baked {
        let texel = row * SIZE + column;
        atlas.coverage[texel] = Coverage::Inside;
        atlas.transfer.values[3 * texel..][..3].copy_from_slice(&[value, 2.0 * value, 3.0 * value]);
    }
    atlas
}

#[test]
fn a_texel_spreads_in_a_disk() {
    let mut atlas = atlas(&[(5, 5, 0.7)], [false; 2]);
    fill(&mut atlas, 3);
    for texel in 0..SIZE * SIZE {
        let [x, y] = [texel % SIZE, texel / SIZE].map(|x| x.abs_diff(5));
        let (coverage, value) = match x * x + y * y {
            0 => (Coverage::Inside, 0.7),
            1..=9 => (Coverage::Filled, 0.7),
            _ => (Coverage::Empty, 0.0),
        };
        assert_eq!(atlas.coverage[texel], coverage);
        assert_eq!(atlas.transfer.values[3 * texel..][..3], [value, 2.0 * value, 3.0 * value]);
    }
}

#[test]
fn between_two_texels_the_nearer_counts_and_in_the_middle_both() {
    let mut atlas = atlas(&[(3, 5, 1.0), (7, 5, 4.0)], [false; 2]);
    fill(&mut atlas, 2);
    let row: Vec<f32> = (1..10).map(|column| atlas.transfer.values[3 * (5 * SIZE + column)]).collect();
    assert_eq!(row, [1.0, 1.0, 1.0, 1.0, 2.5, 4.0, 4.0, 4.0, 4.0]);
}

#[test]
fn the_gutter_wraps_round_where_the_atlas_does() {
    for wraps in [[false, false], [true, false], [false, true], [true, true]] {
        let mut atlas = atlas(&[(0, 0, 1.0)], wraps);
        fill(&mut atlas, 2);
        let is_filled = |column: usize, row: usize| atlas.coverage[row * SIZE + column] == Coverage::Filled;
        assert_eq!(is_filled(SIZE - 2, 0), wraps[0]);
        assert_eq!(is_filled(0, SIZE - 2), wraps[1]);
        assert_eq!(is_filled(SIZE - 1, SIZE - 1), wraps[0] && wraps[1]);
        assert!(is_filled(2, 0) && is_filled(0, 2) && !is_filled(3, 0));
    }
}

#[test]
fn no_gutter_changes_nothing() {
    let before = atlas(&[(5, 5, 0.7)], [true; 2]);
    let mut after = before.clone();
    fill(&mut after, 0);
    assert_eq!(after, before);
}
