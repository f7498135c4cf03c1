//! Boxes that a straight line meets, found by halving the set of boxes at its longest side.

use glam::DVec3;

/// A tree over boxes with sides along the axes.
pub(super) struct BoxTree {
    /// The root is the last one; children come before their parents.
    nodes: Vec<Node>,
}

struct Node {
    bounds: [DVec3; 2],
    content: Content,
}

enum Content {
    Boxes(Vec<usize>),
    Halves([usize; 2]),
}

/// Number of boxes that are not halved any more.
const FEW: usize = 4;

/// Widening of bounds, as a share of their largest coordinate, so that rounding loses none.
const MARGIN: f64 = 1e-9;

impl BoxTree {
    /// The tree over boxes, each of which has a lower and an upper corner.
    pub fn new(boxes: &[[DVec3; 2]]) -> Self {
        let mut tree = Self { nodes: Vec::new() };
        if !boxes.is_empty() {
            tree.add((0..boxes.len()).collect(), boxes);
        }
        tree
    }

    /// Adds a node over some boxes, and says where it is.
    fn add(&mut self, mut members: Vec<usize>, boxes: &[[DVec3; 2]]) -> usize {
        let empty = [DVec3::INFINITY, DVec3::NEG_INFINITY];
        let [lo, hi] = members.iter().fold(empty, |[lo, hi], k| [lo.min(boxes[*k][0]), hi.max(boxes[*k][1])]);
        let content = if members.len() <= FEW {
            Content::Boxes(members)
        } else {
            let size = (hi - lo).to_array();
            let axis = (0..3).max_by(|a, b| size[*a].total_cmp(&size[*b])).unwrap_or(0);
            let middle = |k: &usize| boxes[*k][0][axis] + boxes[*k][1][axis];
            members.sort_by(|a, b| middle(a).total_cmp(&middle(b)));
            let others = members.split_off(members.len() / 2);
            Content::Halves([self.add(members, boxes), self.add(others, boxes)])
        };
        let margin = MARGIN * lo.abs().max(hi.abs()).max_element();
        self.nodes.push(Node { bounds: [lo - margin, hi + margin], content });
        self.nodes.len() - 1
    }

    /// Calls `found` with the number of every box that the line `origin + t · direction` meets, and of some others.
    pub fn for_each_met(&self, origin: DVec3, direction: DVec3, mut found: impl FnMut(usize)) {
        let mut open: Vec<usize> = self.nodes.len().checked_sub(1).into_iter().collect();
        while let Some(node) = open.pop() {
            let node = &self.nodes[node];
            if !meets(node.bounds, origin, direction) {
                continue;
            }
            match &node.content {
                Content::Boxes(members) => members.iter().copied().for_each(&mut found),
                Content::Halves(halves) => open.extend(halves),
            }
        }
    }
}

/// Whether a line meets a box.
fn meets([lo, hi]: [DVec3; 2], origin: DVec3, direction: DVec3) -> bool {
    let [mut from, mut to] = [f64::NEG_INFINITY, f64::INFINITY];
    for a in 0..3 {
        if direction[a] == 0.0 {
            if origin[a] < lo[a] || origin[a] > hi[a] {
                return false;
            }
        } else {
            let ends = [lo, hi].map(|corner| (corner[a] - origin[a]) / direction[a]);
            from = from.max(ends[0].min(ends[1]));
            to = to.min(ends[0].max(ends[1]));
        }
    }
    from <= to
}

#[cfg(test)]
mod tests {
    use super::super::tests::random_point;
    use super::*;

    #[test]
    fn no_box_that_a_line_meets_is_missed() {
        for n in [0, 1, 5, 200] {
            let boxes: Vec<[DVec3; 2]> = (0..n)
                .map(|k| {
                    let corner = 5.0 * random_point(2 * k);
                    // Some are flat.
                    let size = random_point(2 * k + 1).abs() * DVec3::new(1.0, 1.0, (k % 3) as f64);
                    [corner, corner + size]
                })
                .collect();
            let tree = BoxTree::new(&boxes);
            let (mut n_met, mut n_found) = (0, 0);
            for k in 0..300 {
                let (origin, mut direction) = (4.0 * random_point(1000 + 2 * k), random_point(1001 + 2 * k));
                if k % 3 == 0 {
                    direction = DVec3::AXES[k % 9 / 3];
                }
                let mut found = vec![0; n];
                tree.for_each_met(origin, direction, |k| found[k] += 1);
                for (k, bounds) in boxes.iter().enumerate() {
                    let is_met = meets(*bounds, origin, direction);
                    assert!(found[k] <= 1 && (found[k] == 1 || !is_met), "{n}: box {k}");
                    n_met += usize::from(is_met);
                }
                n_found += found.iter().sum::<usize>();
            }
            assert!(n < 200 || (n_met > 100 && n_found < 300 * n / 4), "{n_met} met, {n_found} found");
        }
    }
}
