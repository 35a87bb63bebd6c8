//! The nearest of many points.

use glam::DVec3;

/// A point and its number.
type Numbered = (DVec3, u32);

/// Points sorted so that the median stands in the middle of every range, along x, y and z in turn: a k-d tree without pointers
/// (Bentley 1975).
#[derive(Debug)]
pub(super) struct NearestPoint(Vec<Numbered>);

impl NearestPoint {
    pub(super) fn new(mut points: Vec<Numbered>) -> Self {
        sort_by_medians(&mut points, 0);
        Self(points)
    }

    /// The number of the nearest point, the smallest of those at equal distance; `None` if there are no points.
    pub(super) fn find(&self, position: DVec3) -> Option<u32> {
        let mut best = (f64::INFINITY, u32::MAX);
        search(&self.0, 0, position, &mut best);
        (!self.0.is_empty()).then_some(best.1)
    }
}

fn sort_by_medians(points: &mut [Numbered], axis: usize) {
    if points.len() > 1 {
        let middle = points.len() / 2;
        let (before, _, after) =
            points.select_nth_unstable_by(middle, |a, b| a.0[axis].total_cmp(&b.0[axis]).then(a.1.cmp(&b.1)));
        sort_by_medians(before, (axis + 1) % 3);
        sort_by_medians(after, (axis + 1) % 3);
    }
}

/// Lowers `best`, squared distance and number, to the nearest of a range.
fn search(points: &[Numbered], axis: usize, position: DVec3, best: &mut (f64, u32)) {
    let middle = points.len() / 2;
    let Some(&(point, number)) = points.get(middle) else { return };
    let squared = point.distance_squared(position);
    if squared < best.0 || squared == best.0 && number < best.1 {
        *best = (squared, number);
    }
    let beyond = position[axis] - point[axis];
    let (near, far) = (&points[..middle], &points[middle + 1..]);
    let (near, far) = if beyond <= 0.0 { (near, far) } else { (far, near) };
    search(near, (axis + 1) % 3, position, best);
    if beyond * beyond <= best.0 {
        search(far, (axis + 1) % 3, position, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sampling::Random;

    #[test]
    fn finds_what_a_search_of_all_points_finds() {
        let mut random = Random::new(4);
        // On a coarse lattice many distances are equal and many coordinates are shared.
        let mut point = |cells: f64| DVec3::from_array([0; 3].map(|_| (random.unit() * cells).floor() / cells));
        for (count, cells) in [(1, 8.0), (2, 2.0), (500, 6.0), (2000, 1e9)] {
            let points: Vec<Numbered> = (0..count).map(|number| (point(cells), number)).collect();
            let tree = NearestPoint::new(points.clone());
            for _ in 0..200 {
                let position = point(1e6);
                let key = |&(point, number): &Numbered| (point.distance_squared(position), number);
                let truth = points.iter().map(key).min_by(|a, b| a.partial_cmp(b).expect("finite")).expect("some");
                assert_eq!(tree.find(position), Some(truth.1));
            }
        }
        assert_eq!(NearestPoint::new(Vec::new()).find(DVec3::ZERO), None);
    }
}
