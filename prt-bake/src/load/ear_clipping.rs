//! Triangulation of one concave polygon in the plane.

use std::collections::VecDeque;

use glam::DVec2;

use super::corner_grid::CornerGrid;

/// Points and grid cells that may be looked at, for each corner of the polygon.
///
/// Polygons of up to 150 corners never reach it, and larger ones only if most of their corners crowd together in a
/// small part of them. It keeps the time linear: a million-corner polygon is given up after a few seconds. The stars,
/// combs, spirals and noisy circles tried need about 0.2 √n steps a corner, 225 for 10^6 corners.
const MAX_STEPS_PER_CORNER: usize = 2048;

/// Cuts ears off a polygon until a triangle is left. Its buffers serve one polygon after the other.
///
/// Each corner is tried once, and again only when a neighbour is cut off (no other corner can have become an ear), so a
/// polygon of n corners takes O(n) ear tests; a grid over the reflex corners keeps a test short. Corners in the middle of
/// a straight edge get triangles too, so no T-junction appears. Polygons that cross themselves have no right answer: what
/// is left when no ear can be found becomes a fan.
///
/// Written instead of using the crate `earcut` because that takes cubic time on polygons that touch themselves (8 s for
/// 4,000 corners) and drops corners on straight edges.
#[derive(Debug, Default)]
pub(super) struct EarClipper {
    previous: Vec<u32>,
    next: Vec<u32>,
    reflex: Vec<bool>,
    reflex_count: usize,
    /// The latest ticket of each corner; an entry of the queue with an older one is void.
    ticket: Vec<u32>,
    queue: VecDeque<(u32, u32)>,
    grid: CornerGrid,
}

impl EarClipper {
    /// Hands `points.len() - 2` triangles, as indices into `points`, to `emit`.
    ///
    /// - `points`: at least 3, finite, counter-clockwise
    ///
    /// # Errors
    /// Text that stands before "not supported", when [`MAX_STEPS_PER_CORNER`] is exceeded.
    pub(super) fn clip(&mut self, points: &[DVec2], mut emit: impl FnMut([u32; 3])) -> Result<(), String> {
        self.start(points);
        let mut remaining = points.len();
        let mut steps = MAX_STEPS_PER_CORNER * points.len();
        for strict in [true, false] {
            self.queue_all();
            while let Some(corner) = self.pop() {
                if remaining == 3 {
                    break;
                }
                let inspected = self.inspect(points, corner, strict, &mut steps);
                match inspected {
                    None => {
                        return Err(format!(
                            "a concave polygon of {} corners with so many crowded together is",
                            points.len()
                        ));
                    }
                    Some(false) => {}
                    Some(true) => {
                        emit([self.previous[corner as usize], corner, self.next[corner as usize]]);
                        self.cut_off(points, corner);
                        remaining -= 1;
                    }
                }
            }
        }
        self.emit_rest(emit);
        Ok(())
    }

    fn start(&mut self, points: &[DVec2]) {
        let n = points.len() as u32;
        self.previous = (0..n).map(|i| (i + n - 1) % n).collect();
        self.next = (0..n).map(|i| (i + 1) % n).collect();
        self.ticket = vec![0; n as usize];
        self.queue.clear();
        self.reflex =
            (0..n).map(|i| turn(points, self.previous[i as usize], i, self.next[i as usize]) <= 0.0).collect();
        self.fill_grid(points);
    }

    fn fill_grid(&mut self, points: &[DVec2]) {
        let reflex = &self.reflex;
        self.grid.fill(points, (0..reflex.len() as u32).filter(|&i| reflex[i as usize]));
        self.reflex_count = self.grid.len();
    }

    /// Queues every corner that is left; a corner that was cut off has itself as its neighbour.
    fn queue_all(&mut self) {
        self.queue.clear();
        for corner in 0..self.next.len() as u32 {
            if self.next[corner as usize] != corner {
                self.queue_again(corner);
            }
        }
    }

    /// Puts a corner at the end of the queue, wherever it stood before. So neighbours are not cut off in a row, and
    /// the triangles stay as plump as the polygon allows.
    fn queue_again(&mut self, corner: u32) {
        let ticket = &mut self.ticket[corner as usize];
        *ticket = ticket.wrapping_add(1);
        self.queue.push_back((corner, *ticket));
    }

    fn pop(&mut self) -> Option<u32> {
        while let Some((corner, ticket)) = self.queue.pop_front() {
            if self.ticket[corner as usize] == ticket {
                return Some(corner);
            }
        }
        None
    }

    /// Whether a corner is an ear: it turns left, and no reflex corner lies in its triangle. `None`: out of steps.
    ///
    /// `strict` also counts corners on the triangle's border. Corners at the same place as one of the three do not
    /// count: bridges to holes run there.
    fn inspect(&self, points: &[DVec2], corner: u32, strict: bool, steps: &mut usize) -> Option<bool> {
        let (before, after) = (self.previous[corner as usize], self.next[corner as usize]);
        if turn(points, before, corner, after) <= 0.0 {
            return spend(steps, 1).then_some(false);
        }
        let triangle = [before, corner, after].map(|i| points[i as usize]);
        let mut blocked = false;
        for cell in self.grid.cells_over(triangle) {
            let members = self.grid.members(cell);
            if !spend(steps, 1 + members.len()) {
                return None;
            }
            blocked = blocked
                || members.iter().any(|&i| self.reflex[i as usize] && contains(triangle, points[i as usize], strict));
            if blocked {
                break;
            }
        }
        Some(!blocked)
    }

    fn cut_off(&mut self, points: &[DVec2], corner: u32) {
        let (before, after) = (self.previous[corner as usize], self.next[corner as usize]);
        self.next[before as usize] = after;
        self.previous[after as usize] = before;
        self.next[corner as usize] = corner;
        self.set_reflex(corner, false);
        for neighbour in [before, after] {
            let (a, b) = (self.previous[neighbour as usize], self.next[neighbour as usize]);
            self.set_reflex(neighbour, turn(points, a, neighbour, b) <= 0.0);
            self.queue_again(neighbour);
        }
        // Most of the grid is stale: as this halves it, all refills together cost as much as the first fill.
        if 2 * self.reflex_count < self.grid.len() {
            self.fill_grid(points);
        }
    }

    fn set_reflex(&mut self, corner: u32, reflex: bool) {
        let old = std::mem::replace(&mut self.reflex[corner as usize], reflex);
        self.reflex_count = self.reflex_count + usize::from(reflex) - usize::from(old);
    }

    /// A fan over the corners that are left: the last triangle, or what a polygon that crosses itself leaves.
    fn emit_rest(&self, mut emit: impl FnMut([u32; 3])) {
        let Some(first) = (0..self.next.len() as u32).find(|&i| self.next[i as usize] != i) else { return };
        let mut second = self.next[first as usize];
        while self.next[second as usize] != first {
            let third = self.next[second as usize];
            emit([first, second, third]);
            second = third;
        }
    }
}

fn spend(steps: &mut usize, cost: usize) -> bool {
    *steps = steps.saturating_sub(cost);
    *steps > 0
}

/// Twice the signed area of a triangle, positive when it turns left.
fn orientation(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    (b - a).perp_dot(c - a)
}

fn turn(points: &[DVec2], a: u32, b: u32, c: u32) -> f64 {
    orientation(points[a as usize], points[b as usize], points[c as usize])
}

fn contains(triangle: [DVec2; 3], point: DVec2, strict: bool) -> bool {
    let [a, b, c] = triangle;
    if point == a || point == b || point == c {
        return false;
    }
    let sides = [orientation(a, b, point), orientation(b, c, point), orientation(c, a, point)];
    if strict { sides.iter().all(|&side| side >= 0.0) } else { sides.iter().all(|&side| side > 0.0) }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;
    use proptest::prelude::*;

    fn on_circle(n: usize, radius: impl Fn(usize) -> f64) -> Vec<DVec2> {
        (0..n).map(|i| DVec2::from_angle(i as f64 / n as f64 * std::f64::consts::TAU) * radius(i)).collect()
    }

    fn spiral(n: usize) -> Vec<DVec2> {
        let at = |i: usize, offset: f64| {
            let angle = i as f64 / n as f64 * 60.0;
            DVec2::from_angle(angle) * (1.0 + angle + offset)
        };
        (0..n).rev().map(|i| at(i, 0.0)).chain((0..n).map(|i| at(i, 2.0))).collect()
    }

    fn area(points: &[DVec2]) -> f64 {
        (0..points.len()).map(|i| points[i].perp_dot(points[(i + 1) % points.len()])).sum::<f64>() / 2.0
    }

    fn assert_tiles(mut points: Vec<DVec2>) {
        if area(&points) < 0.0 {
            points.reverse();
        }
        let (mut sum, mut count) = (0.0, 0);
        EarClipper::default()
            .clip(&points, |[a, b, c]| {
                let part = turn(&points, a, b, c) / 2.0;
                assert!(part >= 0.0);
                sum += part;
                count += 1;
            })
            .unwrap();
        assert_eq!(count, points.len() - 2);
        assert!((sum / area(&points) - 1.0).abs() < 1e-9, "{sum} against {}", area(&points));
    }

    #[test]
    fn large_simple_polygons() {
        let noise = |i: usize| 1.0 + 1e-3 * ((i as f64 * 12.9898).sin() * 43_758.547).fract();
        for n in [7, 50, 1000, 100_000] {
            assert_tiles(on_circle(2 * n, |i| if i % 2 == 0 { 1.0 } else { 0.3 }));
            assert_tiles(on_circle(n, noise));
            assert_tiles(spiral(n));
        }
    }

    #[test]
    fn polygons_that_touch_or_cross_themselves_end() {
        let repeated = (0..100_000).map(|i| DVec2::new(f64::from(i % 3), f64::from(i % 3 / 2)));
        let zigzag = (0..100_000).map(|i| DVec2::new(f64::from(i % 2), f64::from(i)));
        let pentagrams = on_circle(5, |_| 1.0).into_iter().step_by(2).cycle().take(100_000);
        for points in [repeated.collect::<Vec<_>>(), zigzag.collect(), pentagrams.collect()] {
            let mut count = 0;
            let result = EarClipper::default().clip(&points, |_| count += 1);
            assert!(result.is_err() || count == points.len() - 2);
        }
    }

    /// A far corner makes the grid so coarse that all other reflex corners share a cell.
    fn crowded_star(n: usize) -> Vec<DVec2> {
        let scale = |i: usize| if i < 3 { 1.0 } else { 1e-6 };
        on_circle(n, |i| scale(i) * if i % 2 == 0 { 1.0 } else { 0.3 })
    }

    #[test]
    fn gives_up_in_time() {
        let small = crowded_star(2000);
        EarClipper::default().clip(&small, |_| ()).unwrap();
        let reason = EarClipper::default().clip(&crowded_star(100_000), |_| ()).unwrap_err();
        assert_eq!(reason, "a concave polygon of 100000 corners with so many crowded together is");
    }

    proptest! {
        /// Radii in order of angle make a simple polygon, whatever the radii are.
        #[test]
        fn random_simple_polygons(radii in prop::collection::vec(0.05f64..1.0, 3..60)) {
            assert_tiles(on_circle(radii.len(), |i| radii[i]));
        }

        #[test]
        fn any_points_give_all_triangles(points in prop::collection::vec((-4i8..4, -4i8..4), 3..60)) {
            let points: Vec<_> = points.into_iter().map(|(x, y)| DVec2::new(x.into(), y.into())).collect();
            let mut count = 0;
            EarClipper::default().clip(&points, |_| count += 1).unwrap();
            prop_assert_eq!(count, points.len() - 2);
        }
    }
}
