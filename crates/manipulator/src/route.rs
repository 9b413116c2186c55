//! The cheapest way through layers of candidates, by dynamic programming (Viterbi 1967).

/// A way from one candidate of a layer to one of the next.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Link {
    pub(crate) from: usize,
    pub(crate) to: usize,
    pub(crate) cost: f64,
}

/// The route of least cost from the first layer, where candidate i costs `starts[i]` and an infinite cost forbids it, to a candidate of
/// the last that `may_end` there, one index a layer, with its cost. `links[k]` lead from layer k to layer k + 1.
pub(crate) fn cheapest(
    starts: &[f64],
    links: &[Vec<Link>],
    may_end: impl Fn(usize) -> bool,
) -> Option<(Vec<usize>, f64)> {
    let mut costs = starts.to_vec();
    let mut before: Vec<Vec<usize>> = Vec::with_capacity(links.len());
    for layer in links {
        let count = layer.iter().map(|link| link.to + 1).max()?;
        let (mut next, mut from) = (vec![f64::INFINITY; count], vec![0; count]);
        for link in layer {
            let cost = costs.get(link.from).copied().unwrap_or(f64::INFINITY) + link.cost;
            if cost < next[link.to] {
                (next[link.to], from[link.to]) = (cost, link.from);
            }
        }
        costs = next;
        before.push(from);
    }
    let ends = (0..costs.len()).filter(|&i| costs[i].is_finite() && may_end(i));
    let last = ends.min_by(|&a, &b| costs[a].total_cmp(&costs[b]))?;
    let mut route = vec![last];
    for from in before.iter().rev() {
        route.push(from[route[route.len() - 1]]);
    }
    route.reverse();
    Some((route, costs[last]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn link(from: usize, to: usize, cost: f64) -> Link {
        Link { from, to, cost }
    }

    /// The cheapest first step leads where everything after is dear.
    #[test]
    fn the_whole_way_counts_and_not_the_next_step() {
        let links = [
            vec![link(0, 0, 1.0), link(0, 1, 2.0), link(1, 1, 0.5)],
            vec![link(0, 0, 9.0), link(1, 0, 1.0), link(1, 1, 4.0)],
        ];
        let all = |_: usize| true;
        assert_eq!(cheapest(&[0.0, 5.0], &links, all), Some((vec![0, 1, 0], 3.0)));
        assert_eq!(cheapest(&[0.0, 0.0], &links, all), Some((vec![1, 1, 0], 1.5)));
        assert_eq!(cheapest(&[0.0, f64::INFINITY], &links, |end| end == 1), Some((vec![0, 1, 1], 6.0)));
    }

    #[test]
    fn where_the_links_break_off_there_is_no_route() {
        let broken = [vec![link(0, 0, 1.0)], vec![link(1, 0, 1.0)]];
        assert_eq!(cheapest(&[0.0], &broken, |_| true), None);
        assert_eq!(cheapest(&[0.0], &[vec![link(0, 0, 1.0)], Vec::new()], |_| true), None);
        assert_eq!(cheapest(&[f64::INFINITY], &[vec![link(0, 0, 1.0)]], |_| true), None);
        assert_eq!(cheapest(&[0.0], &[vec![link(0, 0, 1.0)]], |_| false), None);
    }
}
